//! `engine world new`: the file that a world made by rule stands for.

use std::path::PathBuf;

use engine::diagnostic::{Diagnostic, printable};
use engine::world::{FAMILIES, FamilyRange};
use insight::disk::write_atomic;

use crate::cli::{WorldArguments, WorldCommand};
use crate::console::{Console, ConsoleError};

pub(crate) fn run(arguments: &WorldArguments, console: &mut Console) -> Result<u8, ConsoleError> {
    let WorldCommand::New { world, out } = &arguments.what;
    let (name, text) = text_of(world)?;
    let path = out.clone().unwrap_or_else(|| PathBuf::from(format!("{}.toml", name.replace(':', "-"))));
    let shown = path.display().to_string();
    if insight::disk::is_there(&path)? {
        let error = Diagnostic::new("E-NEW", format!("'{}' exists already", printable(&shown)));
        return Err(Box::new(error.help("choose another file: --out FILE")).into());
    }
    write_atomic(&path, text.as_bytes())?;
    console.line(&format!("wrote the world {name} to {shown}"))?;
    console.line(&format!("next:  engine run SCRIPT --world {shown}"))?;
    Ok(0)
}

/// The one world of a name, and its text.
fn text_of(world: &str) -> engine::diagnostic::Result<(String, String)> {
    let wrong = |message: String, help: String| Diagnostic::new("E-WORLD-FILE", message).help(help).fail();
    match FamilyRange::of(world) {
        Some(Ok(range)) if range.count() > 1 => wrong(
            format!("'{}' are {} worlds", printable(world), range.count()),
            format!("write one, such as {}:7", FAMILIES[1]),
        ),
        Some(Ok(range)) => Ok(range.texts().next().unwrap_or_default()),
        Some(Err((message, help))) => wrong(message, help),
        None => wrong(
            format!("'{}' is no world that is made by rule", printable(world)),
            format!(
                "write a family and a number, such as {}:7; the families are: {}",
                FAMILIES[1],
                FAMILIES.join(", ")
            ),
        ),
    }
}
