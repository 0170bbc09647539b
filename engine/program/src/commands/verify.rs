//! `engine replay --verify`: learned and tested again from the seed alone, and every step and every figure compared.

use std::path::Path;
use std::sync::atomic::Ordering;

use engine::diagnostic::{Diagnostic, Result};
use engine::experiment::{Decider, Learned, Overrides, Plan, RunLog, Summary, run_seed};
use insight::folder::{CURVE_FILE, curve_of};
use insight::store::{POLICY_FILE, RUN_FILE, RecordedRun, policy_to_toml};
use serde::Serialize;
use serde_json::Value;

use super::stop::{INTERRUPTED, on_ctrl_c};
use crate::console::{Console, ConsoleError};

/// Figures of `summary.json` that are not the run's: how fast it was, and whether it was stopped.
const OF_THE_MOMENT: [&str; 2] = ["steps_per_second", "interrupted"];
/// Of a run that was stopped these were measured on fewer steps than were asked for.
const OF_WHOLE_RUNS: [&str; 2] = ["verdict", "untrained"];

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

/// Learns and tests again from the seed alone.
pub(super) fn verify(
    folder: &Path,
    recorded: &RecordedRun,
    console: &mut Console,
) -> std::result::Result<u8, ConsoleError> {
    let RecordedRun { stored, log, summary } = recorded;
    let (plan, seed) = (&stored.plan, stored.seed);
    let stop = on_ctrl_c()?;
    // A run that was stopped is done again as far as it came; one that a failure ended, until it fails again.
    let steps = match summary {
        Some(_) => Overrides {
            steps: Some(log.learning.last_leg().0),
            test_steps: Some(log.test.steps()),
            ..Overrides::default()
        },
        None => Overrides::default(),
    };
    let plan = plan.clone().with_changes(&steps)?;
    let mut again = RunLog::new(&plan);
    let (learned, figures, state_hash) = match run_seed(&plan, seed, &stop, &|_| (), &mut again) {
        Ok(run) => (run.learned, Some(run.summary.clone()), run.summary.state_hash),
        // A run that a failure ended fails again, at the same step.
        Err(broken) if summary.is_none() => {
            let state_hash = broken.learned.as_ref().map_or_else(String::new, |learned| learned.state_hash.clone());
            (broken.learned, None, state_hash)
        }
        Err(broken) => return Err(broken.error.into()),
    };
    if stop.load(Ordering::Relaxed) {
        return Ok(INTERRUPTED);
    }
    compare_logs(log, &again)?;
    if let (Decider::Learned(policy), Some(learned)) = (&stored.decider, &learned)
        && learned.policy != *policy
    {
        return Err(Box::new(differs("the table in policy.toml")).into());
    }
    if let (Some(written), Some(figures)) = (summary, &figures) {
        compare_figures(written, figures)?;
    }
    compare_files(folder, &plan, learned.as_ref())?;
    let verified = Verified {
        behaviour: plan.behaviour.name().to_owned(),
        seed,
        reproduced: true,
        learning_steps: log.learning.steps(),
        test_steps: log.test.steps(),
        log_sha256: again.sha256(),
        state_hash,
    };
    console.json(&verified)?;
    console.line(&format!(
        "reproduced bit for bit: {} steps of learning and {} of the test, and every figure",
        verified.learning_steps, verified.test_steps
    ))?;
    console.line(&format!("log:       sha256 {}", verified.log_sha256))?;
    console.line(&format!("state:     sha256 {}", verified.state_hash))?;
    Ok(0)
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

/// Every figure that was published.
fn compare_figures(written: &Summary, again: &Summary) -> Result<()> {
    let value = |summary: &Summary| {
        serde_json::to_value(summary)
            .map_err(|error| Box::new(Diagnostic::new("E-IO", format!("cannot write the figures as JSON: {error}"))))
    };
    let (mut old, mut new) = (value(written)?, value(again)?);
    let stopped = if written.interrupted { &OF_WHOLE_RUNS[..] } else { &[] };
    for figure in OF_THE_MOMENT.iter().chain(stopped) {
        old.as_object_mut().and_then(|all| all.remove(*figure));
        new.as_object_mut().and_then(|all| all.remove(*figure));
    }
    match first_difference("", &old, &new) {
        None => Ok(()),
        Some((place, old, new)) => {
            forged("summary.json", &format!("{place} is {old} there, and comes out as {new}")).fail()
        }
    }
}

/// The place of the first value that differs, with both values.
fn first_difference(place: &str, old: &Value, new: &Value) -> Option<(String, Value, Value)> {
    match (old, new) {
        (Value::Object(old), Value::Object(new)) if old.keys().eq(new.keys()) => old.iter().find_map(|(key, value)| {
            let place = if place.is_empty() { key.clone() } else { format!("{place}.{key}") };
            first_difference(&place, value, &new[key])
        }),
        (Value::Array(old), Value::Array(new)) if old.len() == new.len() => (old.iter().zip(new).enumerate())
            .find_map(|(index, (old, new))| first_difference(&format!("{place}[{index}]"), old, new)),
        _ => (old != new).then(|| (place.to_owned(), old.clone(), new.clone())),
    }
}

/// The table with all its fields; and the curve, where its file is still there: it is only for people and spreadsheets.
fn compare_files(folder: &Path, plan: &Plan, learned: Option<&Learned>) -> Result<()> {
    let (Some(learned), Ok(run)) = (learned, std::fs::read_to_string(folder.join(RUN_FILE))) else { return Ok(()) };
    let table = policy_to_toml(plan, &learned.policy, Some(&run))?;
    for (name, again) in [(POLICY_FILE, table), (CURVE_FILE, curve_of(plan, learned))] {
        let Ok(written) = std::fs::read_to_string(folder.join(name)) else { continue };
        let differs = written.lines().zip(again.lines()).position(|(old, new)| old != new);
        let line = differs.unwrap_or_else(|| written.lines().count().min(again.lines().count())) + 1;
        if written != again {
            return forged(name, &format!("line {line} differs")).fail();
        }
    }
    Ok(())
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
        assert_eq!(first_difference("", &json!({ "a": 1 }), &json!({ "b": 1 })).unwrap().0, "");
    }
}
