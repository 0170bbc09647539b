//! `engine upgrade`: a script of an older edition, written for the newest one.

use engine::script::{Upgrade, upgrade};
use insight::compare::script_diff;
use insight::report::write_atomic;
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
        write_atomic(&arguments.script, after.as_bytes())?;
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
