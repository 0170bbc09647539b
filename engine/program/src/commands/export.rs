//! `engine export`: a learned policy as source code for other programs.

use engine::diagnostic::Result;
use engine::experiment::Decider;
use insight::store::{RecordedRun, StoredRun, run_to_toml};
use serde::Serialize;

use super::sources::catalogue;
use crate::cli::ExportArguments;
use crate::console::{Console, ConsoleError};

#[derive(Serialize)]
struct ExportReport {
    behaviour: String,
    /// The folder.
    out: String,
    files: Vec<&'static str>,
    /// Frames of the kit.
    frames: usize,
}

pub(crate) fn run(arguments: &ExportArguments, console: &mut Console) -> std::result::Result<u8, ConsoleError> {
    let report = exported(arguments)?;
    console.json(&report)?;
    console.line(&format!("exported:  {} to {}: {}", report.behaviour, report.out, report.files.join(", ")))?;
    console.line(&format!("kit:       {} frames of the run's own test", report.frames))?;
    console.line(&format!("check:     cd {} && cc -O3 -o check check.c policy.c && ./check", report.out))?;
    console.line(&format!("           cd {} && python3 check.py", report.out))?;
    Ok(0)
}

fn exported(arguments: &ExportArguments) -> Result<ExportReport> {
    let RecordedRun { stored: StoredRun { plan, seed, decider }, log, .. } =
        RecordedRun::load(&arguments.run, catalogue(&arguments.filters)?)?;
    let run = run_to_toml(&plan, seed)?;
    let port = match &decider {
        Decider::Learned(policy) => export::port(&plan, policy, seed, &log.test, &run)?,
        Decider::Combined => return Err(export::no_table(plan.behaviour.name())),
    };
    port.write(&arguments.out, arguments.force)?;
    Ok(ExportReport {
        behaviour: plan.behaviour.name().to_owned(),
        out: arguments.out.display().to_string(),
        files: port.files.iter().map(|(name, _)| *name).collect(),
        frames: port.frames,
    })
}
