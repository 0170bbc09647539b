//! `engine replay --verify`: learned, tested and drawn again from the seed alone, and every step, figure and file compared.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use engine::diagnostic::{Diagnostic, Result, printable};
use engine::experiment::{
    Checkpoints, Decider, Learned, Overrides, Plan, RunLog, SeedRun, Spread, Summary, run_only_seed,
};
use engine::filter::Catalogue;
use insight::disk::is_there;
use insight::folder::{CURVE_FILE, DISAGREEMENTS_FILE, Redrawn, RunFolder, SeedResult, curve_of, disagreements_of};
use insight::lint::check_behaviour_until;
use insight::store::{
    LOG_FILE, POLICY_FILE, RUN_FILE, RecordedRun, SUMMARY_FILE, policy_to_toml, read_stored, seed_folders,
};
use serde::Serialize;
use serde_json::Value;

use super::explained_step::redraw_steps;
use super::stop::{INTERRUPTED, on_ctrl_c};
use crate::console::{Console, ConsoleError};

/// Figures of `summary.json` that are not the run's: how fast it was, and whether it was stopped.
const OF_THE_MOMENT: [&str; 2] = ["steps_per_second", "interrupted"];
/// Of a run that was stopped these were measured on fewer steps than were asked for.
const OF_WHOLE_RUNS: [&str; 3] = ["verdict", "untrained", "blind"];

#[derive(Serialize)]
struct Verified {
    behaviour: String,
    seed: u64,
    reproduced: bool,
    learning_steps: u64,
    test_steps: u64,
    log_sha256: String,
    state_hash: String,
}

/// Learns and tests again from the seed alone: one seed, or each of many and the figures above them.
pub(super) fn verify(
    folder: &Path,
    filters: &Arc<Catalogue>,
    console: &mut Console,
) -> std::result::Result<u8, ConsoleError> {
    let (stop, seeds) = (on_ctrl_c()?, seed_folders(folder));
    if seeds.is_empty() || is_there(&folder.join(LOG_FILE))? {
        let Some(again) = verify_seed(folder, filters, &stop)? else { return Ok(INTERRUPTED) };
        let drawn = again.shown.map(|(plan, result)| compare_drawn(folder, &plan, &[result], &stop)).transpose()?;
        let drawn = with_explained(drawn, again.explained);
        if stop.load(Ordering::Relaxed) {
            return Ok(INTERRUPTED);
        }
        console.json(&again.verified)?;
        return print(console, &again.verified, &drawn).map(|()| 0);
    }
    check_first_run(folder, &seeds)?;
    let (mut summaries, mut verified, mut shown, mut explained) = (Vec::new(), Vec::new(), Vec::new(), 0);
    for (seed, folder) in seeds {
        let Some(again) = verify_seed(&folder, filters, &stop)? else { return Ok(INTERRUPTED) };
        console.line(&format!("seed {seed}: the same"))?;
        summaries.extend(again.written);
        verified.push(again.verified);
        explained += again.explained;
        // The page reads the logs from their files again.
        shown.extend(again.shown.map(|(plan, result)| (plan, SeedResult { log: None, ..result })));
    }
    let spread = as_json(&Spread::new(summaries))?;
    compare_values(folder, &read_json(&folder.join(SUMMARY_FILE))?, &spread)?;
    let (mut plans, results): (Vec<Plan>, Vec<SeedResult>) = shown.into_iter().unzip();
    let drawn = plans.pop().map(|plan| compare_drawn(folder, &plan, &results, &stop)).transpose()?;
    let drawn = with_explained(drawn, explained);
    if stop.load(Ordering::Relaxed) {
        return Ok(INTERRUPTED);
    }
    console.json(&verified)?;
    console.line(&format!("reproduced bit for bit: {} seeds, and every figure above them", verified.len()))?;
    print_drawn(console, &drawn)?;
    Ok(0)
}

/// Above the folders of its seeds, a run has the `run.toml` of the first of them.
fn check_first_run(folder: &Path, seeds: &[(u64, PathBuf)]) -> Result<()> {
    let Some((seed, first)) = seeds.first() else { return Ok(()) };
    let (above, below) = (read_stored(&folder.join(RUN_FILE))?, read_stored(&first.join(RUN_FILE))?);
    if above.text == below.text {
        return Ok(());
    }
    let line = first_line_that_differs(&above.text, &below.text);
    forged(RUN_FILE, &format!("line {line} is not that of seed {seed}, the first one")).fail()
}

/// What one seed came to, its figures as they were written, and what its pictures show; nothing of a run that failed.
struct Again {
    verified: Verified,
    written: Option<Summary>,
    shown: Option<(Plan, SeedResult)>,
    /// Pictures of explained steps that came out the same.
    explained: usize,
}

/// One seed; nothing if it was stopped.
fn verify_seed(folder: &Path, filters: &Arc<Catalogue>, stop: &AtomicBool) -> Result<Option<Again>> {
    let RecordedRun { stored, log, summary } = RecordedRun::load(folder, Arc::clone(filters))?;
    let (plan, seed) = (&stored.plan, stored.seed);
    // A run that was stopped is done again as far as it came; one that a failure ended, until it fails again.
    let steps = match &summary {
        Some(_) => Overrides {
            steps: Some(log.learning.last_leg().0),
            test_steps: Some(log.test.steps()),
            ..Overrides::default()
        },
        None => Overrides::default(),
    };
    let plan = plan.clone().with_changes(&steps)?;
    let mut again = RunLog::new(&plan);
    let (run, broken) = match run_only_seed(&plan, seed, stop, &|_| (), &mut again, Checkpoints::NONE) {
        Ok(run) => (Some(run), None),
        // A run that a failure ended fails again, at the same step.
        Err(broken) if summary.is_none() => (None, broken.learned),
        Err(broken) => return Err(broken.error),
    };
    let learned = run.as_ref().map_or(broken.as_ref(), |run| run.learned.as_ref());
    if stop.load(Ordering::Relaxed) {
        return Ok(None);
    }
    compare_logs(&log, &again)?;
    if let (Decider::Learned(policy), Some(learned)) = (&stored.decider, learned)
        && learned.policy != *policy
    {
        return differs("the table in policy.toml").fail();
    }
    if let (Some(written), Some(run)) = (&summary, &run) {
        compare_figures(folder, written, &run.summary, stored.plan.settings.run.test_steps)?;
    }
    compare_files(folder, &plan, learned)?;
    if let Some(table) = run.as_ref().and_then(|run| disagreements_of(&plan, &run.tested)) {
        compare_file(folder, DISAGREEMENTS_FILE, &table)?;
    }
    let explained = redraw_steps(folder, &plan, seed, &again)?;
    refuse_different(folder, &explained)?;
    let learned_hash = || learned.map_or_else(String::new, |learned| learned.state_hash.clone());
    let state_hash = run.as_ref().map_or_else(learned_hash, |run| run.summary.state_hash.clone());
    let verified = Verified {
        behaviour: plan.behaviour.name().to_owned(),
        seed,
        reproduced: true,
        learning_steps: log.learning.steps(),
        test_steps: log.test.steps(),
        log_sha256: again.sha256(),
        state_hash,
    };
    // What is drawn of a run that was stopped is drawn of its own figures, and of the steps that were asked for.
    let shown = run.zip(summary.clone()).map(|(run, summary)| {
        let run = SeedRun { summary, ..run };
        (stored.plan.clone(), SeedResult { run, log: Some(again) })
    });
    Ok(Some(Again { verified, written: summary, shown, explained: explained.same }))
}

/// Draws pictures and pages again.
fn compare_drawn(folder: &Path, plan: &Plan, results: &[SeedResult], stop: &AtomicBool) -> Result<Redrawn> {
    let of_run = RunFolder::of_run(folder, !is_there(&folder.join(LOG_FILE))?);
    let checked = if of_run.shows_check() { check_behaviour_until(plan, 0, stop)? } else { None };
    let redrawn = of_run.redraw(plan, results, checked.as_ref())?;
    if !stop.load(Ordering::Relaxed) {
        refuse_different(folder, &redrawn)?;
    }
    Ok(redrawn)
}

/// What was drawn again must be what stands in the folder.
fn refuse_different(folder: &Path, redrawn: &Redrawn) -> Result<()> {
    if redrawn.different.is_empty() {
        return Ok(());
    }
    let folder = printable(&folder.display().to_string());
    let message = format!("'{folder}' shows what the run does not: drawn again, {} differs", named(&redrawn.different));
    let help = "steps and figures come out as they were recorded, so it was changed after the run, or drawn by another \
                engine than this one: see 'engine' in run.toml, and run it again";
    Diagnostic::new("E-LOG-DIFFERS", message).help(help).fail()
}

/// Counts the pictures of explained steps among those that were drawn again.
fn with_explained(drawn: Option<Redrawn>, explained: usize) -> Redrawn {
    let drawn = drawn.unwrap_or_default();
    Redrawn { same: drawn.same + explained, ..drawn }
}

fn named(files: &[PathBuf]) -> String {
    let names: Vec<String> = files.iter().map(|file| printable(&file.display().to_string())).collect();
    names.join(", ")
}

fn print_drawn(console: &mut Console, drawn: &Redrawn) -> std::result::Result<(), ConsoleError> {
    let Redrawn { same, missing, .. } = drawn;
    console.line(&format!("drawn:     {same} pictures and pages again, each the same byte for byte"))?;
    if missing.is_empty() {
        return Ok(());
    }
    console.line(&format!("           not there, so not compared: {}", named(missing)))
}

fn print(console: &mut Console, verified: &Verified, drawn: &Redrawn) -> std::result::Result<(), ConsoleError> {
    console.line(&format!(
        "reproduced bit for bit: {} steps of learning and {} of the test, and every figure",
        verified.learning_steps, verified.test_steps
    ))?;
    print_drawn(console, drawn)?;
    console.line(&format!("log:       sha256 {}", verified.log_sha256))?;
    console.line(&format!("state:     sha256 {}", verified.state_hash))
}

pub(super) fn differs(what: &str) -> Diagnostic {
    Diagnostic::new("E-LOG-DIFFERS", format!("the run does not come out as it was recorded: {what}"))
        .help("this engine, or a filter, is not the one that recorded the run: compare 'engine' in run.toml")
}

fn forged(file: &str, what: &str) -> Diagnostic {
    Diagnostic::new("E-LOG-DIFFERS", format!("{file} does not say what the run gives: {what}"))
        .help("every step comes out as it was recorded, so the file was changed after the run; run it again")
}

fn compare_logs(log: &RunLog, again: &RunLog) -> Result<()> {
    for (name, old, new) in [("learning", &log.learning, &again.learning), ("the test", &log.test, &again.test)] {
        if let Some((step, field)) = old.first_difference(new) {
            return differs(&format!("step {step} of {name}: {field}")).fail();
        }
    }
    Ok(())
}

/// Every figure that was published, as it stands in the file; `asked` are the steps of a whole test.
fn compare_figures(folder: &Path, written: &Summary, again: &Summary, asked: u64) -> Result<()> {
    let (mut old, mut new) = (read_json(&folder.join(SUMMARY_FILE))?, as_json(again)?);
    // A run that says so, and yet has all that was asked for, is compared as a whole.
    let whole = [&written.test, &written.base_lines.untrained].iter().all(|test| test.steps >= asked);
    let stopped = if written.interrupted && !whole { &OF_WHOLE_RUNS[..] } else { &[] };
    for figure in OF_THE_MOMENT.iter().chain(stopped) {
        old.as_object_mut().and_then(|all| all.remove(*figure));
        new.as_object_mut().and_then(|all| all.remove(*figure));
    }
    // Older runs in several worlds did not tell them apart.
    if old.get(BY_WORLD).is_none() {
        new.as_object_mut().and_then(|all| all.remove(BY_WORLD));
    }
    compare_values(folder, &old, &new)
}

/// The figures of each of several worlds.
const BY_WORLD: &str = "worlds";

fn compare_values(folder: &Path, old: &Value, new: &Value) -> Result<()> {
    let name = folder.join(SUMMARY_FILE).display().to_string();
    match first_difference("", old, new) {
        None => Ok(()),
        Some((place, old, new)) => forged(&name, &format!("{place} is {old} there, and comes out as {new}")).fail(),
    }
}

fn as_json(value: &impl Serialize) -> Result<Value> {
    serde_json::to_value(value)
        .map_err(|error| Box::new(Diagnostic::new("E-IO", format!("cannot write the figures as JSON: {error}"))))
}

fn read_json(path: &Path) -> Result<Value> {
    let text = read_stored(path)?;
    serde_json::from_str(&text.text).map_err(|error| Box::new(forged(&path.display().to_string(), &error.to_string())))
}

/// The place of the first value that differs, with both values.
fn first_difference(place: &str, old: &Value, new: &Value) -> Option<(String, Value, Value)> {
    match (old, new) {
        (Value::Object(old), Value::Object(new)) => old.keys().chain(new.keys()).find_map(|key| {
            let place = if place.is_empty() { key.clone() } else { format!("{place}.{key}") };
            // One that is not there differs from any.
            let of = |all: &serde_json::Map<String, Value>| all.get(key).cloned();
            match (of(old), of(new)) {
                (Some(old), Some(new)) => first_difference(&place, &old, &new),
                (old, new) => Some((place, old.unwrap_or("nothing".into()), new.unwrap_or("nothing".into()))),
            }
        }),
        (Value::Array(old), Value::Array(new)) if old.len() == new.len() => (old.iter().zip(new).enumerate())
            .find_map(|(index, (old, new))| first_difference(&format!("{place}[{index}]"), old, new)),
        _ => (old != new).then(|| (place.to_owned(), old.clone(), new.clone())),
    }
}

/// The table with all its fields, and the curve.
fn compare_files(folder: &Path, plan: &Plan, learned: Option<&Learned>) -> Result<()> {
    let (Some(learned), Ok(run)) = (learned, std::fs::read_to_string(folder.join(RUN_FILE))) else { return Ok(()) };
    compare_file(folder, POLICY_FILE, &policy_to_toml(plan, &learned.policy, Some(&run))?)?;
    // A run that a failure ended has no curve.
    if !is_there(&folder.join(CURVE_FILE))? && !is_there(&folder.join(SUMMARY_FILE))? {
        return Ok(());
    }
    compare_file(folder, CURVE_FILE, &curve_of(plan, learned))
}

/// One text, as it comes out again.
fn compare_file(folder: &Path, name: &str, again: &str) -> Result<()> {
    match std::fs::read_to_string(folder.join(name)) {
        Ok(written) if written == again => Ok(()),
        Ok(written) => forged(name, &format!("line {} differs", first_line_that_differs(&written, again))).fail(),
        Err(_) => forged(name, "it is not there").fail(),
    }
}

/// Lines are counted from 1.
fn first_line_that_differs(one: &str, other: &str) -> usize {
    let differs = one.lines().zip(other.lines()).position(|(one, other)| one != other);
    differs.unwrap_or_else(|| one.lines().count().min(other.lines().count())) + 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn the_first_figure_that_differs_is_named_with_both_values() {
        let (old, new) = (json!({ "a": [1, { "b": 2 }] }), json!({ "a": [1, { "b": 3 }] }));
        assert_eq!(first_difference("", &old, &new), Some(("a[1].b".to_owned(), json!(2), json!(3))));
        assert_eq!(first_difference("", &old, &old), None);
        assert_eq!(first_difference("", &json!({ "a": 1 }), &json!({ "a": 1, "b": 1 })).unwrap().0, "b");
    }
}
