//! Rules that never fired in the trial, always fired, were always forestalled, or wait too long.

use super::exploit::Exploits;
use super::trial::{FactTrial, RuleTrial};
use super::{Finding, LintTrial};
use engine::diagnostic::printable;
use engine::experiment::Plan;
use engine::judge::{FactId, Reach};
use engine::script::Condition;

/// Steps in which a rule must have been asked before anything is said about all of them.
const ENOUGH: u64 = 200;
/// A spin that fails so often in 1,000 steps does not escape, whichever rule it is that sees it.
const CAUGHT: f64 = 20.0;
/// Share of the steps of a spin in which a condition must hold for its persistence to be blamed.
const OFTEN: f64 = 0.25;

pub(super) fn check_firing(plan: &Plan, trial: &LintTrial, exploits: &Exploits, findings: &mut Vec<Finding>) {
    let (outline, Ok(judge)) = (plan.behaviour.outline(), plan.judge()) else { return };
    for (index, rule) in outline.rules.iter().enumerate() {
        let explained = |finding: &Finding| {
            let of_condition = matches!(finding.code, "W-UNIT" | "W-RULE-SHADOWED" | "W-NO-CHOICE");
            of_condition && rule.condition_span.contains(&finding.span.start)
        };
        if findings.iter().any(explained) {
            continue;
        }
        let seen = &trial.rules[index];
        let needed = u64::from(judge.held(index).1);
        let fixed = plan.behaviour.fixed_value(index).is_some() || rule.then.is_some();
        let found = match () {
            () if seen.fired == 0 => never(plan, index, seen, needed, trial),
            () if needed == 1 && fixed && seen.reached >= ENOUGH && seen.fired == seen.reached => {
                Some(always(plan, index, seen))
            }
            () => spun(plan, index, needed, exploits),
        };
        findings.extend(found);
    }
}

fn name(plan: &Plan, rule: usize) -> String {
    format!("rule \"{}\"", printable(&plan.behaviour.rules()[rule].name))
}

/// The first stage of a rule that belongs to stages of which the trial entered none.
fn never_entered<'a>(plan: &'a Plan, index: usize, trial: &LintTrial) -> Option<&'a str> {
    let (own, names) = (plan.behaviour.outline().rules[index].stages?, &plan.settings.stages);
    let within = plan.state_map().ok()?.states() / names.len().max(1);
    let is_own = |stage: usize| own & (1 << stage) != 0;
    if trial.transitions.iter().any(|step| is_own(step.state / within.max(1))) {
        return None;
    }
    names.iter().enumerate().find(|(stage, _)| is_own(*stage)).map(|(_, name)| name.as_str())
}

fn never(plan: &Plan, index: usize, seen: &RuleTrial, needed: u64, trial: &LintTrial) -> Option<Finding> {
    let (steps, goal) = (trial.steps(), plan.behaviour.fixed_value(index).is_some_and(|value| value > 0.0));
    let rule = &plan.behaviour.outline().rules[index];
    let (name, span) = (name(plan, index), rule.condition_span.clone());
    if seen.held > 0 && seen.forestalled == seen.held {
        if has_a_twin(plan, index) {
            return None;
        }
        let message = format!("{name} never fired: an earlier rule recovered each time");
        let label = format!("held in {} of {} steps, each time too late", seen.held, seen.looked);
        let help = "put it before the other rule, or make the two conditions exclude each other";
        return Some(Finding::warning(plan, "W-RULE-SHADOWED", span, message).say(label, help));
    }
    if let Some(stage) = never_entered(plan, index, trial) {
        if goal || may_be_rare(&seen.facts) {
            return None;
        }
        let message =
            format!("{name} never fired: the stage \"{}\" was not entered in {steps} steps", printable(stage));
        let help = "look at the rule that leads to this stage: its condition may be out of reach";
        let label = "was not asked for";
        return Some(Finding::warning(plan, "W-RULE-NEVER", span, message).say(label, help));
    }
    if needed > 1 && seen.held > 0 {
        let period_s = plan.settings.run.period_s;
        let message = format!("{name} never fired in {steps} steps: it waits too long");
        let label = format!(
            "held for {:.1} s in a row at most, and {:.1} s are asked for",
            seen.longest as f64 * period_s,
            needed as f64 * period_s
        );
        let help = "make the time after 'for' shorter, or the condition easier to meet";
        let place = rule.time_span.clone().unwrap_or(span);
        return Some(Finding::warning(plan, "W-PERSISTENCE", place, message).say(label, help));
    }
    // Goals are rare before anything is learned.
    if goal {
        return out_of_sight(plan, index, seen, steps);
    }
    if may_be_rare(&seen.facts) {
        return None;
    }
    let label = readings(&seen.facts);
    let message = format!("{name} never fired in {steps} steps");
    let help = "check the threshold and that the world has what the rule is about";
    Some(Finding::warning(plan, "W-RULE-NEVER", span, message).say(label, help))
}

/// A goal of which something that it needs neither held nor changed in any step: there is no way towards it.
fn out_of_sight(plan: &Plan, index: usize, seen: &RuleTrial, steps: u64) -> Option<Finding> {
    let rule = &plan.behaviour.outline().rules[index];
    // What a rule remembers, and stages, begin to change only on the way to a goal.
    let measured = |fact: &FactTrial| fact.id.is_some_and(|id| !matches!(id.fact().group, "stage" | "time"));
    let still = |fact: &FactTrial| !fact.held && fact.least == fact.greatest && measured(fact);
    let any = matches!(rule.condition, Condition::Any(_));
    let out = if any { !seen.facts.is_empty() && seen.facts.iter().all(still) } else { seen.facts.iter().any(still) };
    if !out {
        return None;
    }
    let never: Vec<FactTrial> = seen.facts.iter().filter(|fact| still(fact)).cloned().collect();
    let message = format!("the goal of {} was never met in {steps} steps, nor came nearer", name(plan, index));
    let help = "check that the world has what the goal is about, and that the robot can get to where it is measured";
    Some(Finding::warning(plan, "W-RULE-NEVER", rule.condition_span.clone(), message).say(readings(&never), help))
}

/// Whether a condition reads accidents of the body, or nothing but the end of one's patience.
pub(super) fn may_be_rare(facts: &[FactTrial]) -> bool {
    let row = |fact: &FactTrial| fact.id.map(FactId::fact);
    let accident = |fact| row(fact).is_some_and(|row| row.reach == Reach::Accident);
    let patience = |fact| row(fact).is_some_and(|row| row.group == "time");
    facts.iter().all(patience) || facts.iter().any(accident)
}

/// What the facts of a condition were, in words.
pub(super) fn readings(facts: &[FactTrial]) -> String {
    let of = |FactTrial { name, unit, least, greatest, .. }: &FactTrial| match *unit {
        "" if least == greatest => format!("{name} was always {}", *least > 0.5),
        "" => format!("{name} was true and false"),
        unit => format!("{name} was {least:.2} to {greatest:.2} {unit}"),
    };
    let read: Vec<String> = facts.iter().map(of).collect();
    if read.is_empty() { "never held".to_owned() } else { read.join("; ") }
}

/// Whether an earlier rule that recovers does just the same: then it does not matter which of the two fires.
fn has_a_twin(plan: &Plan, index: usize) -> bool {
    let (rules, value) = (&plan.behaviour.outline().rules, plan.behaviour.fixed_value(index));
    let same =
        |earlier: usize| rules[earlier].then == rules[index].then && plan.behaviour.fixed_value(earlier) == value;
    rules[index].then.is_some() && value.is_some() && (0..index).any(same)
}

fn always(plan: &Plan, index: usize, seen: &RuleTrial) -> Finding {
    let rule = &plan.behaviour.outline().rules[index];
    let name = name(plan, index);
    let message = format!("{name} fired in every one of {} steps", seen.reached);
    let help = "a value that comes always teaches nothing: tighten the condition, or let the value depend on a fact";
    Finding::warning(plan, "W-RULE-ALWAYS", rule.condition_span.clone(), message).say("held every time", help)
}

/// A rule whose condition holds most of the time that the robot spins in place, and yet never for long enough.
fn spun(plan: &Plan, index: usize, needed: u64, exploits: &Exploits) -> Option<Finding> {
    let rule = &plan.behaviour.outline().rules[index];
    let spins = exploits.behaviours.iter().filter(|exploit| exploit.cheat && exploit.behaviour.starts_with("spin"));
    let spins: Vec<&RuleTrial> = spins.filter_map(|exploit| exploit.rules.get(index)).collect();
    let escapes = |seen: &&RuleTrial| seen.fired == 0 && seen.held as f64 >= OFTEN * seen.looked as f64;
    // Whatever spins is caught by another rule.
    let caught = exploits.behaviours.iter().filter(|exploit| exploit.cheat && exploit.behaviour.starts_with("spin"));
    if caught.clone().count() > 0 && caught.clone().all(|exploit| exploit.failures_per_1000 >= CAUGHT) {
        return None;
    }
    if needed < 2 || rule.stages.is_some() || spins.is_empty() || !spins.iter().all(escapes) {
        return None;
    }
    let period_s = plan.settings.run.period_s;
    let longest = spins.iter().map(|seen| seen.longest).max().unwrap_or(0);
    let message = format!("a robot that spins in place never meets {}", name(plan, index));
    let label = format!("spinning meets it for {:.1} s at most", longest as f64 * period_s);
    let help = format!("write 'for {:.1} seconds' or less", longest.saturating_sub(1).max(1) as f64 * period_s);
    let span = rule.time_span.clone().unwrap_or_else(|| rule.condition_span.clone());
    Some(Finding::warning(plan, "W-PERSISTENCE", span, message).say(label, help))
}
