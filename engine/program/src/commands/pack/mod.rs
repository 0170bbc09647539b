//! `engine pack`: share a behaviour.

mod fetch;
mod inspect;
mod install;
mod keys;
mod list;
mod make;
pub(super) mod places;
#[cfg(feature = "share")]
mod registry;
mod share;
mod statements;
mod verify;

use crate::cli::{PackArguments, PackCommand};
use crate::console::{Console, ConsoleError};

pub(crate) fn run(arguments: &PackArguments, console: &mut Console) -> Result<u8, ConsoleError> {
    match &arguments.command {
        PackCommand::New(arguments) => make::new(arguments, console),
        PackCommand::Check(arguments) => make::check_folder(arguments, console),
        PackCommand::Build(arguments) => make::build(arguments, console),
        PackCommand::Keygen(arguments) => keys::keygen(arguments, console),
        PackCommand::Sign(arguments) => keys::sign(arguments, console),
        PackCommand::Trust(arguments) => keys::trust(arguments, console),
        PackCommand::Rotate(arguments) => statements::rotate(arguments, console),
        PackCommand::Revoke(arguments) => statements::revoke(arguments, console),
        PackCommand::Verify(arguments) => verify::verify(arguments, console),
        PackCommand::Inspect(arguments) => inspect::inspect(arguments, console),
        PackCommand::Install(arguments) => install::install(arguments, console),
        PackCommand::List(arguments) => list::list(arguments, console),
        PackCommand::Remove(arguments) => list::remove(arguments, console),
        PackCommand::Push(arguments) => share::push(arguments, console),
        PackCommand::Pull(arguments) => share::pull(arguments, console),
    }
}
