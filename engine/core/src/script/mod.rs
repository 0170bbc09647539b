//! The language of scripts: from a script's text to what can be judged, with all that is wrong in it.
//!
//! A script sets up, names rules over facts, and may have functions. [`Behaviour`] is a script that has been loaded and
//! checked; the file `draft.rs` has one as far as it can be understood, with its mistakes, and the order of the stages.
//! What is judged in every step, and how, is the room `judge`.

mod access;
mod actions;
mod behaviour;
mod bodies;
mod compile;
mod compile_facts;
mod cost;
mod draft;
mod editions;
mod fact_names;
mod form;
mod grammar;
mod guards;
mod is_key;
mod known;
mod measurable;
mod measures;
mod memory;
mod named_body;
mod names;
mod outline;
mod own_doing;
mod params;
mod parts;
mod positions;
mod reader;
mod reference;
mod reference_json;
mod refused;
mod rehearsal;
mod robot_setup;
mod rules;
mod setup;
mod setup_stages;
mod setup_table;
mod setup_views;
mod setup_worlds;
mod source;
mod spoilt;
mod starts;
mod state_parts;
mod stops;
mod success;
mod syntax;
mod top_level;
mod tree;
mod types;
mod unknown;
mod unread;
mod upgrade;
mod uses;
mod view_names;
mod words;

pub use behaviour::Behaviour;
pub use cost::Dear;
pub(crate) use draft::Draft;
pub use grammar::grammar;
pub(crate) use measurable::Nameable;
pub use named_body::BodyFiles;
pub use outline::{BeamLoop, Compared, Condition, Gathers, NamedFact, RuleOutline, ScriptOutline, UnusedName};
pub(crate) use params::no_param;
pub use params::{Param, ParamValues};
pub use reference::{definitions, reference};
pub use reference_json::reference_json;
pub(crate) use unread::Unread;
pub use upgrade::{Upgrade, upgrade};

#[cfg(test)]
mod tests;
