//! `engine runs`: the runs that stand here, listed, tagged, pruned.

use std::path::Path;
use std::time::{Duration, SystemTime};

use engine::diagnostic::printable;
use insight::folder::remove_run;
use insight::shelf::{NotDone, ShelvedRun, runs_under, tag_run};

use crate::cli::{RunsArguments, RunsCommand};
use crate::console::{Console, ConsoleError};

const DAY_S: u64 = 24 * 60 * 60;

pub(crate) fn run(arguments: &RunsArguments, console: &mut Console) -> Result<u8, ConsoleError> {
    match &arguments.command {
        None => {
            let runs = looked(&arguments.folder, console)?;
            console.json(&runs)?;
            list(console, &runs)?;
        }
        Some(RunsCommand::Tag { run, tag }) => {
            tag_run(run, tag.as_deref())?;
            match tag {
                Some(tag) => console.line(&format!("{} is tagged {}", run.display(), printable(tag)))?,
                None => console.line(&format!("{} has no tag any more", run.display()))?,
            }
        }
        Some(RunsCommand::Prune { folder, older, failed, yes }) => {
            let runs = looked(folder, console)?;
            let going: Vec<ShelvedRun> = runs
                .into_iter()
                // Who waits to be gone on with is not pruned: `engine run --force` replaces it.
                .filter(|run| !matches!(run.unfinished, Some(NotDone::Running(_) | NotDone::Killed)))
                .filter(|run| run.tag.is_none() && (!failed || run.success != Some(true)))
                .filter(|run| is_older(run, *older))
                .collect();
            list(console, &going)?;
            let bytes: u64 = going.iter().map(|run| run.bytes).sum();
            if *yes {
                for run in &going {
                    let kept = remove_run(&run.folder)?;
                    kept.iter().try_for_each(|path| {
                        console.line(&format!("kept:      {}, which the engine did not write", path.display()))
                    })?;
                }
                console.line(&format!("removed {} runs, {}", going.len(), size(bytes)))?;
            } else {
                console.line(&format!(
                    "{} runs, {}: nothing is removed yet; add --yes to remove them",
                    going.len(),
                    size(bytes)
                ))?;
            }
        }
    }
    Ok(0)
}

/// The runs; folders that cannot be read are named beside them.
fn looked(folder: &Path, console: &Console) -> Result<Vec<ShelvedRun>, ConsoleError> {
    let shelf = runs_under(folder)?;
    shelf.unread.iter().for_each(|why| console.note(&format!("left out: {}", why.message)));
    Ok(shelf.runs)
}

fn is_older(run: &ShelvedRun, days: Option<u64>) -> bool {
    let Some(days) = days else { return true };
    let age = Duration::from_secs(days.saturating_mul(DAY_S));
    SystemTime::now().duration_since(run.written).is_ok_and(|old| old >= age)
}

fn list(console: &mut Console, runs: &[ShelvedRun]) -> Result<(), ConsoleError> {
    if runs.is_empty() {
        return console.line("no runs");
    }
    let width = runs.iter().map(|run| run.folder.display().to_string().chars().count()).max().unwrap_or(0);
    let now = SystemTime::now();
    for run in runs {
        let tag = run.tag.as_ref().map_or(String::new(), |tag| format!("  [{}]", printable(tag)));
        let folder = run.folder.display().to_string();
        let line = format!("{folder:width$}  {}  {:>9}  {}{tag}", run.age(now), size(run.bytes), run.words());
        console.line(line.trim_end())?;
    }
    Ok(())
}

fn size(bytes: u64) -> String {
    match bytes {
        bytes if bytes >= 10 << 20 => format!("{} MiB", bytes >> 20),
        bytes => format!("{} KiB", bytes.div_ceil(1024)),
    }
}
