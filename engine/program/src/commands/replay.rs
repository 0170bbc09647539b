//! `engine replay`: a recorded run again, step by step; with `--verify`, from its seed alone.

use engine::diagnostic::{Diagnostic, Result, printable};
use engine::experiment::{Ledger, Phase, Plan, Playback, Record, RuleScore};
use engine::learner::Carry;
use engine::outcome::Ending;
use engine::outcome::Then;
use insight::store::{RecordedRun, StoredRun};
use insight::words::short;
use serde::Serialize;

use super::sources::catalogue;
use super::verify::{differs, verify};
use super::words::{direction, motion};
use crate::cli::ReplayArguments;
use crate::console::{Console, ConsoleError};

/// Steps that are listed if no end is named.
const LISTED: usize = 20;

#[derive(Serialize)]
struct ReplayReport {
    behaviour: String,
    world: String,
    seed: u64,
    /// `learning` or `test`.
    phase: &'static str,
    /// Steps that were done, and how many of them, from the first, are in the log.
    steps: u64,
    kept: usize,
    /// Where the reward was swapped while the robot learned.
    swaps: Vec<SwapEntry>,
    rules: Vec<RuleScoreEntry>,
    /// Of a run in several worlds, or with values that are drawn: its attempts, in their order.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    attempts: Vec<AttemptEntry>,
    listed: Vec<StepEntry>,
}

/// One attempt, from the step with which it began.
#[derive(Serialize)]
struct AttemptEntry {
    step: usize,
    world: String,
    drawn: Vec<(String, String)>,
    /// How it ended: `failure`, `goal`, `restart` or `hop`; null of the last one.
    ending: Option<&'static str>,
}

#[derive(Serialize)]
struct SwapEntry {
    /// The first step under the new reward.
    step: u64,
    /// What became of the table: `keep`, `decay` or `reset`.
    table: Carry,
}

#[derive(Serialize)]
struct RuleScoreEntry {
    name: String,
    #[serde(flatten)]
    score: RuleScore,
    first_step: Option<usize>,
    last_step: Option<usize>,
}

#[derive(Serialize)]
struct StepEntry {
    step: usize,
    state: u32,
    action: u16,
    motion: [f64; 2],
    next_state: u32,
    reward: f64,
    rules: Vec<(String, f64)>,
    recover: bool,
    /// What the script said then: `recover`, `fail`, `goal` or `restart`.
    #[serde(skip_serializing_if = "Option::is_none")]
    then: Option<&'static str>,
    explored: bool,
    /// The learned policy that chose, where the script uses one.
    #[serde(skip_serializing_if = "Option::is_none")]
    used: Option<String>,
    contact: bool,
    beam: Option<u16>,
    beam_angle_deg: Option<f64>,
    nearest_m: f32,
    pose: [f64; 3],
}

pub(crate) fn run(arguments: &ReplayArguments, console: &mut Console) -> std::result::Result<u8, ConsoleError> {
    if arguments.verify {
        return verify(&arguments.run, &catalogue(&arguments.filters)?, console);
    }
    let recorded = RecordedRun::load(&arguments.run, catalogue(&arguments.filters)?)?;
    let RecordedRun { stored: StoredRun { plan, seed, .. }, log, .. } = &recorded;
    let (phase, ledger, name) = match arguments.test {
        false => (Phase::Learning, &log.learning, "learning"),
        true => (Phase::Test, &log.test, "test"),
    };
    let listed = listed(arguments, ledger, name)?;
    play(plan, *seed, phase, ledger, name)?;
    let report = ReplayReport {
        behaviour: plan.behaviour.name().to_owned(),
        world: plan.worlds.title(),
        seed: *seed,
        phase: name,
        steps: ledger.steps(),
        kept: ledger.len(),
        swaps: swaps(plan, phase),
        rules: rules(plan, phase, ledger),
        attempts: attempts(plan, ledger),
        listed: listed.filter_map(|step| entry(plan_of(plan, phase, step), ledger, step)).collect(),
    };
    console.json(&report)?;
    print(console, &report)?;
    Ok(0)
}

fn listed(arguments: &ReplayArguments, ledger: &Ledger, name: &str) -> Result<std::ops::Range<usize>> {
    let Some(from) = arguments.from else { return Ok(0..0) };
    let to = arguments.to.unwrap_or(from.saturating_add(LISTED - 1).min(ledger.len().saturating_sub(1)));
    if from < ledger.len() && from <= to && to < ledger.len() {
        return Ok(from..to + 1);
    }
    let message = format!("there are no steps {from} to {to}: the log has {} steps of {name}", ledger.len());
    Diagnostic::new("E-LOG-STEP", message).help("steps are counted from 0").fail()
}

/// Plays every recorded action and compares every step.
fn play(plan: &Plan, seed: u64, phase: Phase, ledger: &Ledger, name: &str) -> Result<()> {
    let mut playback = Playback::new(plan, seed, phase, ledger)?;
    while let Some(step) = playback.advance()? {
        if let Some(field) = playback.difference() {
            return differs(&format!("step {} of {name}: {field}", step.index)).fail();
        }
    }
    Ok(())
}

fn swaps(plan: &Plan, phase: Phase) -> Vec<SwapEntry> {
    let swaps = plan.swaps().filter(|_| phase == Phase::Learning);
    swaps.map(|(step, table, ..)| SwapEntry { step, table }).collect()
}

/// What was drawn for each attempt, and how it ended.
fn attempts(plan: &Plan, ledger: &Ledger) -> Vec<AttemptEntry> {
    let (mut attempts, mut begins) = (Vec::<AttemptEntry>::new(), true);
    for step in 0..ledger.len() {
        let (Some(attempt), Some(record)) = (ledger.attempt(step), ledger.record(step)) else { break };
        if std::mem::take(&mut begins) {
            let drawn = plan.settings.randomise.iter().zip(&attempt.drawn);
            let drawn = drawn.map(|(varied, drawn)| (varied.key.clone(), varied.shown(*drawn))).collect();
            let world = plan.worlds.layouts().get(attempt.world).map_or_else(String::new, |layout| layout.name.clone());
            attempts.push(AttemptEntry { step, world, drawn, ending: None });
        }
        let ending = record.ending().map(Ending::word).or(attempt.hop.then_some("hop"));
        begins = ending.is_some();
        if let Some(last) = attempts.last_mut() {
            last.ending = ending;
        }
    }
    attempts
}

/// The plan under which a step was done.
fn plan_of(plan: &Plan, phase: Phase, step: usize) -> &Plan {
    match phase {
        Phase::Learning => plan.leg_of(step as u64),
        Phase::Test => plan,
    }
}

fn rules(plan: &Plan, phase: Phase, ledger: &Ledger) -> Vec<RuleScoreEntry> {
    let entry = |name: String| RuleScoreEntry { name, score: RuleScore::default(), first_step: None, last_step: None };
    let mut rules: Vec<RuleScoreEntry> = plan.rule_names().into_iter().map(entry).collect();
    for step in 0..ledger.len() {
        for (rule, value) in ledger.fired(step) {
            let name = &plan_of(plan, phase, step).behaviour.rules()[rule].name;
            let Some(entry) = rules.iter_mut().find(|entry| entry.name == *name) else { continue };
            let RuleScoreEntry { score, first_step, last_step, .. } = entry;
            score.fired += 1;
            score.total += value;
            first_step.get_or_insert(step);
            *last_step = Some(step);
        }
    }
    rules
}

fn entry(plan: &Plan, ledger: &Ledger, step: usize) -> Option<StepEntry> {
    let Record { state, next_state, action, driver, reward, then, explored, contact, beam, nearest_m, pose, .. } =
        ledger.record(step)?;
    let twist = *plan.motions().get(usize::from(action))?;
    let name = |rule: usize| plan.behaviour.rules()[rule].name.clone();
    let fan = plan.settings.laser.fan();
    Some(StepEntry {
        step,
        state,
        action,
        motion: [twist.linear_m_per_s, twist.angular_rad_per_s],
        next_state,
        reward,
        rules: ledger.fired(step).map(|(rule, value)| (name(rule), value)).collect(),
        recover: then.is_some(),
        then: then.map(Then::word),
        explored,
        used: driver.and_then(|by| plan.behaviour.uses().nth(usize::from(by))).map(|(text, _)| text.name.clone()),
        contact,
        beam,
        beam_angle_deg: beam.map(|beam| fan.bearing_deg(usize::from(beam))),
        nearest_m,
        pose: [pose.x_m, pose.y_m, pose.yaw_rad],
    })
}

fn print(console: &mut Console, report: &ReplayReport) -> std::result::Result<(), ConsoleError> {
    let ReplayReport { behaviour, world, seed, phase, steps, kept, .. } = report;
    console.line(&format!("behaviour: {behaviour} in {world}, seed {seed}"))?;
    let of = if *steps == *kept as u64 { String::new() } else { format!(" of {steps}") };
    console.line(&format!("played:    {kept}{of} steps of {phase}; each is the recorded one, bit for bit"))?;
    for SwapEntry { step, table } in &report.swaps {
        console.line(&format!("swapped:   the reward before step {step}; of the table: {}", table.name()))?;
    }
    console.line(&format!("{:20} {:>8} {:>10} {:>8} {:>8}", "rule", "fired", "total", "first", "last"))?;
    let step = |step: Option<usize>| step.map_or("-".to_owned(), |step| step.to_string());
    for RuleScoreEntry { name, score, first_step, last_step } in &report.rules {
        console.line(&format!(
            "{:20} {:>8} {:>10} {:>8} {:>8}",
            printable(name),
            score.fired,
            short(score.total),
            step(*first_step),
            step(*last_step)
        ))?;
    }
    print_attempts(console, &report.attempts)?;
    if report.listed.is_empty() {
        return console
            .line("steps:     list them with --from N --to N; the reasons of one: engine explain RUN --step N");
    }
    console.line(&format!("{:>6} {:>6} {:>6}  {:28} {:>7}  because", "step", "state", "next", "action", "reward"))?;
    for step in &report.listed {
        console.line(&format!(
            "{:>6} {:>6} {:>6}  {:28} {:>7}  {}",
            step.step,
            step.state,
            step.next_state,
            motion(step.motion),
            short(step.reward),
            because(step)
        ))?;
    }
    Ok(())
}

/// The first attempts, each with its world and what was drawn.
fn print_attempts(console: &mut Console, attempts: &[AttemptEntry]) -> std::result::Result<(), ConsoleError> {
    for AttemptEntry { step, world, drawn, ending } in attempts.iter().take(LISTED) {
        let drawn: Vec<String> = drawn.iter().map(|(key, value)| format!("{} {value}", printable(key))).collect();
        let drawn = if drawn.is_empty() { String::new() } else { format!(", {}", drawn.join(", ")) };
        let ending = ending.map_or(String::new(), |ending| format!(": {ending}"));
        console.line(&format!("attempt:   from step {step} in {}{drawn}{ending}", printable(world)))?;
    }
    match attempts.len().saturating_sub(LISTED) {
        0 => Ok(()),
        more => console.line(&format!("           ... and {more} more, with --json")),
    }
}

fn because(step: &StepEntry) -> String {
    let rules: Vec<String> = step.rules.iter().map(|(name, _)| format!("\"{}\"", printable(name))).collect();
    let beam = step.beam.zip(step.beam_angle_deg);
    let beam = beam.map_or(String::new(), |(beam, angle)| format!(", beam {beam}, {}", direction(angle)));
    let recover = step.then.map_or(String::new(), |then| format!(", then {then}"));
    let used = step.used.as_ref().map_or(String::new(), |name| format!(" (use \"{}\")", printable(name)));
    format!("{}{beam}{recover}{used}", rules.join(" and "))
}
