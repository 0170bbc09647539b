//! `engine rescore`: a recorded run under another script, and what its learner would have learned instead.

use std::path::Path;
use std::sync::Arc;

use engine::diagnostic::{Diagnostic, Result, printable};
use engine::experiment::{Plan, Rescored, RuleChange, RuleScore, plan_with_rules_of, rescore};
use engine::learner::Policy;
use engine::script::Behaviour;
use insight::disk::Together;
use insight::folder::write_json;
use insight::report::{PolicyDiffData, PolicyState, StateChange, policy_diff};
use insight::store::{RecordedRun, StoredRun};
use insight::words::short;
use serde::Serialize;

use super::sources::catalogue;
use super::words::{icon, motion, signed};
use crate::cli::RescoreArguments;
use crate::console::{Console, ConsoleError};

/// Changed states that a person is shown.
const SHOWN: usize = 12;

#[derive(Serialize)]
struct RescoreReport {
    behaviour: String,
    script: String,
    world: String,
    seed: u64,
    /// Steps in the log, and how many the run did: a log holds the first million.
    steps: usize,
    steps_done: u64,
    passes: u64,
    /// By rule; null where a script has no such rule.
    rules: Vec<RuleChange>,
    reward_before: f64,
    reward_after: f64,
    /// Steps whose reward changes.
    steps_changed: u64,
    /// Steps in which only the new script asks for recovery, and only the old one did.
    new_recoveries: u64,
    old_recoveries: u64,
    /// Steps after which the new script would have handed the robot to another policy, or to none.
    other_hands: u64,
    /// States that the record visits.
    states_visited: usize,
    /// Those whose best action changes, the most visited first.
    states_changed: Vec<RescoredState>,
}

#[derive(Serialize)]
struct RescoredState {
    state: usize,
    /// Which cells are filled, row by row from the top left.
    cells: Vec<bool>,
    visits: u64,
    before: ChosenAction,
    after: ChosenAction,
    /// By how much the new reward values the new action above the old one; next to nothing is a draw.
    gain: f64,
}

/// The best action of a state.
#[derive(Serialize)]
struct ChosenAction {
    action: usize,
    /// Forward speed, m/s, and turning speed, rad/s.
    motion: [f64; 2],
    value: f64,
    /// How often the record has this action in this state: 0 means that its value is only the first guess.
    tried: u64,
}

pub(crate) fn run(arguments: &RescoreArguments, console: &mut Console) -> std::result::Result<u8, ConsoleError> {
    let RecordedRun { stored: StoredRun { plan, seed, .. }, log, .. } =
        RecordedRun::load(&arguments.run, catalogue(&arguments.filters)?)?;
    if log.learning.is_empty() {
        let message =
            format!("'{}' combines policies: it learned nothing that could be rescored", plan.behaviour.name());
        let error = Diagnostic::new("E-RESCORE", message).help("give a run that learned");
        return Err(Box::new(error).into());
    }
    if !plan.earlier.is_empty() {
        let message = "the reward of this run was swapped while it learned: there is no one reward to compare with";
        let error = Diagnostic::new("E-RESCORE", message);
        return Err(Box::new(error.help("run the behaviour again, and rescore that run")).into());
    }
    let script = Behaviour::load(&arguments.script)?;
    // A parameter that both scripts have is what it was in the run.
    let mut values = plan.behaviour.param_values();
    values.retain(|name, value| script.params().iter().any(|own| own.name == *name && own.check(*value).is_ok()));
    let script = if values.is_empty() { script } else { script.with_values(&values)? };
    let new = plan_with_rules_of(&plan, Arc::new(script))?;
    let rescored = rescore(&plan, &new, seed, &log.learning, arguments.passes)?;
    let states_changed = rescored.changed_states();
    let states_changed = states_changed.iter().filter_map(|state| entry(&plan, &rescored, *state).transpose());
    let report = RescoreReport {
        behaviour: plan.behaviour.name().to_owned(),
        script: new.behaviour.source().path.display().to_string(),
        world: plan.worlds.title(),
        seed,
        steps: log.learning.len(),
        steps_done: log.learning.steps(),
        passes: arguments.passes,
        rules: rescored.rules.clone(),
        reward_before: rescored.reward_before,
        reward_after: rescored.reward_after,
        steps_changed: rescored.steps_changed,
        new_recoveries: rescored.new_recoveries,
        old_recoveries: rescored.old_recoveries,
        other_hands: rescored.other_hands,
        states_visited: rescored.policy_before.states_met(),
        states_changed: states_changed.collect::<Result<_>>()?,
    };
    let default = arguments.run.join(format!("rescore-{}", new.behaviour.name()));
    let out = arguments.out.as_deref().unwrap_or(&default);
    write(out, &plan, &report)?;
    console.json(&report)?;
    print(console, &plan, &report, out)?;
    Ok(0)
}

fn entry(plan: &Plan, rescored: &Rescored, state: usize) -> Result<Option<RescoredState>> {
    let choice = |policy: &Policy| {
        let (action, value) = policy.best(state)?;
        let twist = plan.settings.actions[action];
        let motion = [twist.linear_m_per_s, twist.angular_rad_per_s];
        Some(ChosenAction { action, motion, value, tried: rescored.tries(state, action) })
    };
    let (Some(before), Some(after)) = (choice(&rescored.policy_before), choice(&rescored.policy_after)) else {
        return Ok(None);
    };
    let row = rescored.policy_after.row(state);
    let gain = row.map_or(0.0, |row| after.value - row.values[before.action]);
    let cells = plan.state_map()?.describe(state).cells.map_or_else(Vec::new, |cells| cells.filled);
    Ok(Some(RescoredState { state, cells, visits: rescored.visits(state), before, after, gain }))
}

fn write(out: &Path, plan: &Plan, report: &RescoreReport) -> Result<()> {
    let together = Together::into(out)?;
    let folder = together.folder();
    write_json(&folder.join("rescore.json"), report)?;
    let state = |entry: &RescoredState, choice: &ChosenAction| PolicyState {
        state: entry.state,
        cells: entry.cells.clone(),
        visits: entry.visits,
        best: plan.settings.actions[choice.action],
        value: choice.value,
    };
    let change = |entry: &RescoredState| StateChange {
        before: state(entry, &entry.before),
        after: state(entry, &entry.after),
        tried: [entry.before.tried, entry.after.tried],
    };
    let states: Vec<StateChange> = report.states_changed.iter().map(change).collect();
    let title = format!("{}, seed {}, under {}", report.behaviour, report.seed, printable(&report.script));
    let (rows, columns) = plan.drawn_grid()?;
    policy_diff(&PolicyDiffData { title: &title, rows, columns, states: &states })?.write(folder, "policy-diff")?;
    together.commit()
}

fn print(
    console: &mut Console,
    plan: &Plan,
    report: &RescoreReport,
    out: &Path,
) -> std::result::Result<(), ConsoleError> {
    let RescoreReport { behaviour, world, seed, steps, .. } = report;
    console.line(&format!("{behaviour} in {world}, seed {seed}: {steps} steps under {}", printable(&report.script)))?;
    console.line(&format!("{:20} {:>15} {:>21} {:>9}", "", "fired", "total", ""))?;
    let heads = ["before", "after", "before", "after", "change"];
    console.line(&format!(
        "{:20} {:>7} {:>7} {:>10} {:>10} {:>9}",
        "rule", heads[0], heads[1], heads[2], heads[3], heads[4]
    ))?;
    for RuleChange { name, before, after } in &report.rules {
        let fired = |score: &Option<RuleScore>| score.map_or("-".to_owned(), |score| score.fired.to_string());
        let total = |score: &Option<RuleScore>| score.map_or("-".to_owned(), |score| short(score.total));
        let change = after.unwrap_or_default().total - before.unwrap_or_default().total;
        console.line(&format!(
            "{:20} {:>7} {:>7} {:>10} {:>10} {:>9}",
            printable(name),
            fired(before),
            fired(after),
            total(before),
            total(after),
            signed(change)
        ))?;
    }
    let change = report.reward_after - report.reward_before;
    console.line(&format!(
        "{:20} {:>7} {:>7} {:>10} {:>10} {:>9}",
        "all",
        "",
        "",
        short(report.reward_before),
        short(report.reward_after),
        signed(change)
    ))?;
    console.line(&format!("changed:   the reward of {} steps", report.steps_changed))?;
    if report.steps_done > report.steps as u64 {
        console.line(&format!("note:      the log holds only the beginning of {} steps", report.steps_done))?;
    }
    if report.new_recoveries > 0 {
        console.line(&format!(
            "note:      {} steps would have ended in recovery; the recorded robot went on from there",
            report.new_recoveries
        ))?;
    }
    if report.old_recoveries > 0 {
        console.line(&format!(
            "note:      {} recoveries would not have happened; the recorded robot was put back all the same",
            report.old_recoveries
        ))?;
    }
    if report.other_hands > 0 {
        console.line(&format!(
            "note:      after {} steps another policy would have driven, or none; the recorded one drove on",
            report.other_hands
        ))?;
    }
    print_states(console, plan, report)?;
    console.line(&format!("results:   {}", out.display()))
}

fn print_states(console: &mut Console, plan: &Plan, report: &RescoreReport) -> std::result::Result<(), ConsoleError> {
    let changed = &report.states_changed;
    let passes = if report.passes == 1 { String::new() } else { format!(" in {} passes of Q-learning", report.passes) };
    console.line(&format!(
        "learned:   {} of {} states change their best action when the same steps are learned anew{passes}",
        changed.len(),
        report.states_visited
    ))?;
    let guesses = changed.iter().filter(|entry| entry.after.tried == 0).count();
    if guesses > 0 {
        console.line(&format!("note:      {guesses} of these to an action that the record never tried there"))?;
    }
    let (_, columns) = plan.drawn_grid()?;
    for entry in changed.iter().take(SHOWN) {
        let guess = |choice: &ChosenAction| match choice.tried {
            0 => "never tried there: a guess".to_owned(),
            1 => format!("tried once, value {}", short(choice.value)),
            tried => format!("tried {tried} times, value {}", short(choice.value)),
        };
        let words = [
            format!("state {}, {} visits", entry.state, entry.visits),
            format!("  before: {} ({})", motion(entry.before.motion), guess(&entry.before)),
            format!(
                "  after:  {} ({}; {} better than the old one)",
                motion(entry.after.motion),
                guess(&entry.after),
                short(entry.gain)
            ),
        ];
        let cells = icon(&entry.cells, columns);
        let blank = " ".repeat(2 * columns.max(1) - 1);
        console.line("")?;
        for line in 0..cells.len().max(words.len()) {
            let cells = cells.get(line).unwrap_or(&blank);
            console.line(format!("  {cells}   {}", words.get(line).map_or("", String::as_str)).trim_end())?;
        }
    }
    if changed.len() > SHOWN {
        console.line(&format!("\n  ... and {} more, in the picture", changed.len() - SHOWN))?;
    }
    if changed.is_empty() { Ok(()) } else { console.line("") }
}
