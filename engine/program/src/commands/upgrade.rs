//! `engine upgrade`: a script of an older edition, written for the newest one.

use std::path::Path;

use engine::diagnostic::Diagnostic;
use engine::script::{Upgrade, upgrade};
use insight::compare::script_diff;
use insight::disk::write_atomic;
use serde::Serialize;

use crate::cli::UpgradeArguments;
use crate::console::{Console, ConsoleError};

#[derive(Serialize)]
struct UpgradeReport<'a> {
    changes: &'a [String],
    script: &'a str,
    written: bool,
}

pub(crate) fn run(arguments: &UpgradeArguments, console: &mut Console) -> Result<u8, ConsoleError> {
    let Upgrade { before, after, changes } = upgrade(&arguments.script)?;
    let changed = after != *before.text;
    if arguments.write && changed {
        write_over(&arguments.script, after.as_bytes())?;
    }
    console.json(&UpgradeReport { changes: &changes, script: &after, written: arguments.write && changed })?;
    if !changed {
        console.line("nothing to change: it is of the newest edition")?;
        return Ok(0);
    }
    for change in &changes {
        console.line(change)?;
    }
    console.line(&format!("\n{}", script_diff(&before.text, &after).trim_end()))?;
    let path = arguments.script.display();
    match arguments.write {
        true => console.line(&format!("\nwritten to {path}"))?,
        false => console.line(&format!("\nnothing is written yet: engine upgrade {path} --write"))?,
    }
    Ok(0)
}

/// Puts other bytes into a file that is there: behind a link, and with the rights that it had.
fn write_over(path: &Path, bytes: &[u8]) -> Result<(), Box<Diagnostic>> {
    let disk = |error| Box::new(Diagnostic::disk("write", path, &error));
    let file = std::fs::canonicalize(path).map_err(disk)?;
    let rights = std::fs::metadata(&file).map_err(disk)?.permissions();
    if rights.readonly() {
        return Err(disk(std::io::ErrorKind::PermissionDenied.into()));
    }
    write_atomic(&file, bytes)?;
    std::fs::set_permissions(&file, rights).map_err(disk)
}
