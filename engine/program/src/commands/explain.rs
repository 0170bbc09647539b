//! `engine explain`: why a step of a run was rewarded as it was; or what the code of an error means.

use std::io::IsTerminal;
use std::path::Path;

use engine::diagnostic::{Diagnostic, Result, all_codes, code_page, excerpt, nearest_name, printable};
use engine::experiment::{
    FactReasons, GuardReasons, Phase, Plan, Playback, RuleReasons, RunLog, StepReasons, UseReasons,
};
use insight::disk::{Together, is_there};
use insight::folder::{ExplainedStep, Side};
use insight::store::{RecordedRun, StoredRun};
use insight::words::short;
use serde::Serialize;

use super::explained_step::draw_step;
use super::sources::catalogue;
use super::value_chain::value_chain;
use super::words::{fact, icon, motion};
use crate::cli::ExplainArguments;
use crate::console::{Console, ConsoleError};

#[derive(Serialize)]
struct StepReport {
    behaviour: String,
    world: String,
    seed: u64,
    /// `learning` or `test`.
    phase: &'static str,
    #[serde(flatten)]
    reasons: StepReasons,
    /// What the filters keep at the end of the step, of those that keep something.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    kept: Vec<FilterKept>,
    /// What the robot saw when it chose, and at the end of the step: camera, filters, grid.
    pictures: [String; 2],
}

/// What a filter keeps, in words.
#[derive(Serialize)]
struct FilterKept {
    filter: &'static str,
    words: String,
}

pub(crate) fn run(arguments: &ExplainArguments, console: &mut Console) -> std::result::Result<u8, ConsoleError> {
    let topic = arguments.topic.to_uppercase();
    let is_code = topic.starts_with("E-") || topic.starts_with("W-");
    if is_code && !is_there(Path::new(&arguments.topic))? {
        if arguments.step.is_some() || arguments.test || arguments.out.is_some() {
            let error = Diagnostic::new("E-CODE", "the page of a code has no steps and no pictures");
            return Err(Box::new(error.help(format!("write: engine explain {}", printable(&topic)))).into());
        }
        return code(&topic, console);
    }
    let Some(step) = arguments.step else {
        let error = Diagnostic::new("E-LOG-STEP", "which step is to be explained?");
        return Err(Box::new(error.help("add --step N; engine replay RUN shows when each rule fired")).into());
    };
    let recorded = RecordedRun::load(Path::new(&arguments.topic), catalogue(&arguments.filters)?)?;
    let StoredRun { plan, seed, .. } = &recorded.stored;
    let (phase, ledger, name) = match arguments.test {
        false => (Phase::Learning, &recorded.log.learning, "learning"),
        true => (Phase::Test, &recorded.log.test, "test"),
    };
    let out = arguments.out.as_deref().unwrap_or(Path::new(&arguments.topic));
    let together = Together::into(out)?;
    let mut playback = recalling(plan, *seed, phase, &recorded.log)?;
    playback.seek(step)?;
    let shown = ExplainedStep { phase, step };
    let before = draw_step(shown, &playback, Side::Before)?;
    let Some(reasons) = StepReasons::of_next(&mut playback)? else {
        let message = format!("the log has {} steps of {name}, no step {step}", ledger.len());
        let error = Diagnostic::new("E-LOG-STEP", message).help("steps are counted from 0");
        return Err(Box::new(error).into());
    };
    if let Some(field) = playback.difference() {
        let message = format!("the run does not come out as it was recorded: step {step} of {name}: {field}");
        let error = Diagnostic::new("E-LOG-DIFFERS", message);
        return Err(Box::new(error.help("find where it begins to differ: engine replay RUN --verify")).into());
    }
    before.write(together.folder(), &shown.stem(Side::Before))?;
    draw_step(shown, &playback, Side::After)?.write(together.folder(), &shown.stem(Side::After))?;
    together.commit()?;
    let pictures =
        [Side::Before, Side::After].map(|side| out.join(format!("{}.png", shown.stem(side))).display().to_string());
    let (behaviour, world) = (plan.behaviour.name().to_owned(), plan.worlds.title());
    let kept = playback.cycle().kept_in_words().map(|(filter, words)| FilterKept { filter, words }).collect();
    let report = StepReport { behaviour, world, seed: *seed, phase: name, reasons, kept, pictures };
    console.json(&report)?;
    print(console, playback.plan(), &report)?;
    Ok(0)
}

fn code(code: &str, console: &mut Console) -> std::result::Result<u8, ConsoleError> {
    let Some(page) = code_page(code) else {
        let error = Diagnostic::new("E-CODE", format!("there is no code '{}'", printable(code)));
        return Err(Box::new(match nearest_name(code, all_codes()) {
            Some(near) => error.help(format!("did you mean '{near}'?")),
            None => error.help("give the code as it stands in the brackets of the message: error[E-SCRIPT-FACT]"),
        })
        .into());
    };
    console.json(&serde_json::json!({ "code": code, "page": page }))?;
    console.line(&format!("{code}\n\n{page}"))?;
    Ok(0)
}

/// A phase of the run, with what learned: led along the steps of learning, or as it was before the test.
fn recalling<'a>(plan: &'a Plan, seed: u64, phase: Phase, log: &'a RunLog) -> Result<Playback<'a>> {
    let learning = || Playback::new(plan, seed, Phase::Learning, &log.learning)?.recalling();
    match phase {
        Phase::Learning => learning(),
        Phase::Test if plan.learns() => {
            Ok(Playback::new(plan, seed, phase, &log.test)?.with_recall(learning()?.into_recall()?))
        }
        Phase::Test => Playback::new(plan, seed, phase, &log.test),
    }
}

fn print(console: &mut Console, plan: &Plan, report: &StepReport) -> std::result::Result<(), ConsoleError> {
    let reasons = &report.reasons;
    let StepReport { behaviour, world, seed, phase, .. } = report;
    console.line(&format!(
        "step {} of {phase}, {} s: {behaviour} in {world}, seed {seed}",
        reasons.step,
        short(reasons.time_s)
    ))?;
    print_attempt(console, reasons)?;
    for param in plan.behaviour.params() {
        console.line(&format!("parameter: {} = {}", printable(&param.name), param.shown()))?;
    }
    let how = match reasons.explored {
        _ if !plan.learns() || reasons.used.is_some() => "",
        true => " (tried, not the best one known)",
        false => " (the best one known)",
    };
    console.line(&format!("action:    {}{how}", motion(reasons.motion)))?;
    if let Some(used) = &reasons.used {
        print_used(console, used)?;
    }
    print_guards(console, plan, &reasons.guards)?;
    let (_, columns) = plan.drawn_grid()?;
    let (from, to) = (icon(&reasons.state.cells, columns), icon(&reasons.next_state.cells, columns));
    for (line, (from, to)) in from.iter().zip(&to).enumerate() {
        let arrow = if line == 0 { "->" } else { "  " };
        let names = match line {
            0 => format!("    state {} -> state {}", reasons.state.index, reasons.next_state.index),
            _ => String::new(),
        };
        console.line(&format!("           {from}  {arrow}  {to}{names}"))?;
    }
    if plan.settings.has_parts() {
        let (from, to) = (&reasons.state.text, &reasons.next_state.text);
        console.line(&format!("           {from}\n           {to}"))?;
    }
    for kept in &report.kept {
        console.line(&format!("filter:    {}: {}", kept.filter, kept.words))?;
    }
    let [x_m, y_m, yaw_rad] = reasons.pose;
    let touched = if reasons.contact { ", touching something" } else { "" };
    let fallen = if reasons.fallen { ", fallen" } else { "" };
    console.line(&format!(
        "robot:     x {x_m:.2} m, y {y_m:.2} m, heading {:.0}°{touched}{fallen}",
        yaw_rad.to_degrees()
    ))?;
    if let Some([x_m, y_m, _]) = reasons.prey {
        console.line(&format!("prey:      x {x_m:.2} m, y {y_m:.2} m"))?;
    }
    let after = after(reasons);
    console.line(&format!("reward:    {}{after}", short(reasons.reward)))?;
    print_rules(console, plan, &reasons.rules)?;
    if let Some(value) = &reasons.value {
        value_chain(console, value)?;
    }
    console.line(&format!("\npictures:  {}\n           {}", report.pictures[0], report.pictures[1]))
}

/// What each rule said: those that fired, then the others.
fn print_rules(console: &mut Console, plan: &Plan, rules: &[RuleReasons]) -> std::result::Result<(), ConsoleError> {
    for rule in rules.iter().filter(|rule| rule.added.is_some()) {
        console.line("")?;
        console.line(&fired(plan, rule))?;
    }
    let silent: Vec<&RuleReasons> = rules.iter().filter(|rule| rule.added.is_none()).collect();
    if !silent.is_empty() {
        console.line("\nwhat did not fire:")?;
    }
    for rule in silent {
        console.line(&format!("  \"{}\" (line {}): {}", printable(&rule.name), rule.line, silence(rule)))?;
    }
    Ok(())
}

/// Which learned policy chose the action, and why it did.
fn print_used(console: &mut Console, used: &UseReasons) -> std::result::Result<(), ConsoleError> {
    let read: Vec<&FactReasons> = used.parts.iter().flat_map(|part| &part.facts).collect();
    let why = if read.is_empty() { String::new() } else { format!(", since {}", facts(read)) };
    let UseReasons { name, line, state, text, .. } = used;
    console.line(&format!("use:       \"{}\" (line {line}) drives{why}; its state {state}: {text}", printable(name)))
}

/// In which world a step was done, and what was drawn for its attempt.
fn print_attempt(console: &mut Console, reasons: &StepReasons) -> std::result::Result<(), ConsoleError> {
    if let Some(world) = &reasons.world_name {
        console.line(&format!("world:     {}", printable(world)))?;
    }
    for (key, value) in &reasons.drawn {
        console.line(&format!("drawn:     {} = {value}", printable(key)))?;
    }
    Ok(())
}

/// What followed on a step.
fn after(reasons: &StepReasons) -> String {
    let to = reasons.to.as_ref().map_or(String::new(), |to| format!(" to \"{}\"", printable(to)));
    match (reasons.then, reasons.hop) {
        (Some(then), _) => format!(", then {then}{to}"),
        (None, true) => ", then a hop: the attempt is broken off here, which is no outcome".to_owned(),
        (None, false) => String::new(),
    }
}

/// What guards took away when the action was chosen, and why.
fn print_guards(console: &mut Console, plan: &Plan, guards: &[GuardReasons]) -> std::result::Result<(), ConsoleError> {
    for guard in guards {
        let read: Vec<&FactReasons> = guard.parts.iter().flat_map(|part| &part.facts).collect();
        let why = if read.is_empty() { String::new() } else { format!(", since {}", facts(read)) };
        console.line(&format!(
            "guard:     \"{}\" (line {}) forbade {}{why}",
            printable(&guard.name),
            guard.line,
            forbidden(plan, &guard.actions)
        ))?;
    }
    Ok(())
}

/// The actions that a guard took away, in words.
fn forbidden(plan: &Plan, actions: &[usize]) -> String {
    let all = plan.motions();
    let shown = actions.iter().take(4).filter_map(|action| all.get(*action));
    let shown: Vec<String> =
        shown.map(|twist| format!("[{}, {}]", twist.linear_m_per_s, twist.angular_rad_per_s)).collect();
    let more = if actions.len() > 4 { ", ..." } else { "" };
    format!("{} of {} actions: {}{more}", actions.len(), all.len(), shown.join(" "))
}

/// A rule that fired, in its own line of the script.
fn fired(plan: &Plan, rule: &RuleReasons) -> String {
    let added = rule.added.map_or(String::new(), short);
    let long = if rule.needed > 1 { format!(", having held for {} steps", rule.needed) } else { String::new() };
    let what = if rule.name == "reward" { "fn reward".to_owned() } else { format!("\"{}\"", printable(&rule.name)) };
    let parts = rule.parts.iter().filter(|part| part.holds != Some(false));
    let places: Vec<_> = parts.map(|part| (part.span[0]..part.span[1], facts(&part.facts))).collect();
    let colour = std::io::stdout().is_terminal() && std::env::var_os("NO_COLOR").is_none();
    excerpt(&format!("{what} added {added}{long}"), plan.behaviour.source(), &places, colour)
}

fn facts<'a>(read: impl IntoIterator<Item = &'a FactReasons>) -> String {
    let words: Vec<String> = read.into_iter().map(fact).collect();
    if words.is_empty() { "this held".to_owned() } else { words.join("; ") }
}

fn silence(rule: &RuleReasons) -> String {
    if !rule.asked {
        return "not asked, the step had ended with recovery".to_owned();
    }
    let parts: Vec<String> =
        rule.parts.iter().filter(|part| !part.facts.is_empty()).map(|part| facts(&part.facts)).collect();
    let held = match (rule.held, rule.needed) {
        _ if rule.spent => "'once': it has fired, and its condition has held ever since; ".to_owned(),
        (_, 0 | 1) => String::new(),
        (held, needed) => format!("held for {held} of {needed} steps; "),
    };
    format!("{held}{}", parts.join("; "))
}
