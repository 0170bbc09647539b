//! `engine reference`: the script language as a page, as definitions or as data, from the tables that the engine uses.

use crate::cli::ReferenceArguments;
use crate::console::{Console, ConsoleError};

pub(crate) fn run(arguments: &ReferenceArguments, console: &mut Console) -> Result<u8, ConsoleError> {
    let text = match arguments {
        ReferenceArguments { json: true, .. } => format!("{:#}\n", engine::script::reference_json()),
        ReferenceArguments { grammar: true, .. } => format!("{:#}\n", engine::script::grammar()),
        ReferenceArguments { definitions: true, .. } => engine::script::definitions(),
        _ => engine::script::reference(),
    };
    console.raw(&text)?;
    Ok(0)
}
