//! `engine reference`: the page of the script language, from the tables that the engine uses.

use crate::cli::ReferenceArguments;
use crate::console::{Console, ConsoleError};

pub(crate) fn run(arguments: &ReferenceArguments, console: &mut Console) -> Result<u8, ConsoleError> {
    let text = if arguments.definitions { engine::script::definitions() } else { engine::script::reference() };
    console.raw(&text)?;
    Ok(0)
}
