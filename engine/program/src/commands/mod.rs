//! One file for each command.

mod behaviour;
pub(crate) mod bench;
pub(crate) mod certify;
pub(crate) mod check;
pub(crate) mod compare;
pub(crate) mod explain;
pub(crate) mod filter;
pub(crate) mod new;
pub(crate) mod pack;
pub(crate) mod plugins;
mod print;
pub(crate) mod reference;
pub(crate) mod replay;
pub(crate) mod reproduce;
pub(crate) mod rescore;
pub(crate) mod run;
pub(crate) mod runs;
pub(crate) mod sources;
mod stop;
pub(crate) mod test;
pub(crate) mod upgrade;
mod value_chain;
mod verify;
pub(crate) mod watch;
mod words;
pub(crate) mod world;
