//! What a script calls a goal or a success, and whoever meets it without doing anything.

use std::ops::Range;
use std::sync::atomic::AtomicBool;

use super::choice::place;
use super::exploit::cheats;
use super::trial::LintTrial;
use super::{Finding, read_flags};
use engine::allowed::Allowed;
use engine::diagnostic::{Result, printable};
use engine::experiment::{Choice, Chooser, Plan, in_parallel, test_choices, test_untrained};
use engine::judge::FactId;
use engine::outcome::{Ending, Then};
use engine::script::RuleOutline;

/// The seed of the tests.
const SEED: u64 = 0xd0_0e;
/// Steps in which a value must have been given before anything is said about all of them.
const ENOUGH: u64 = 200;
/// Goals of the trial before anything is said about all of them.
const ENOUGH_GOALS: usize = 10;

/// Goals by accident: a crash that pays.
pub(super) fn check_goals(plan: &Plan, findings: &mut Vec<Finding>) {
    let rules = plan.behaviour.outline().rules.iter().enumerate();
    for (index, rule) in rules {
        let pays = plan.behaviour.fixed_value(index).is_some_and(|value| value > 0.0);
        let goal = rule.then == Some(Then::Goal) || rule.then == Some(Then::Recover) && pays;
        let accident = |fact: FactId| matches!(fact, FactId::RobotContact | FactId::RobotFallen);
        if goal && read_flags(&rule.condition).any(accident) {
            let name = printable(&plan.behaviour.rules()[index].name);
            let message = format!("rule \"{name}\" calls an accident a goal");
            let label = "ends the attempt with something good";
            let help = "is a crash a goal? write 'then fail', or leave the attempt going on";
            findings
                .push(Finding::warning(plan, "W-GOAL-CONTACT", rule.condition_span.clone(), message).say(label, help));
        }
    }
}

/// Goals that came with a contact in the trial, whatever the script calls them.
pub(super) fn check_goals_met(plan: &Plan, trial: &LintTrial, findings: &mut Vec<Finding>) {
    let goals = || trial.transitions.iter().filter(|step| step.ending == Some(Ending::Goal));
    let (all, touching) = (goals().count(), goals().filter(|step| step.contact).count());
    if all < ENOUGH_GOALS || 2 * touching <= all || findings.iter().any(|finding| finding.code == "W-GOAL-CONTACT") {
        return;
    }
    let outline = plan.behaviour.outline();
    let pays = |rule: &&RuleOutline| matches!(rule.then, Some(Then::Goal | Then::Recover));
    let rule = outline.rules.iter().find(pays).map(|rule| rule.condition_span.clone());
    let span = rule.filter(|_| outline.reward.is_none()).unwrap_or_else(|| place(plan));
    let message = format!("{touching} of {all} goals in the trial came with a contact");
    let help = "is a crash a goal? ask for a distance that is farther from the wall, or write 'then fail'";
    findings.push(Finding::warning(plan, "W-GOAL-CONTACT", span, message).say("what is reached here", help));
}

/// Values that read what is measured, and are always the same.
pub(super) fn check_values(plan: &Plan, trial: &LintTrial, findings: &mut Vec<Finding>) {
    let outline = plan.behaviour.outline();
    for (index, text) in plan.behaviour.rules().iter().enumerate() {
        let span = outline.rules.get(index).map(|rule| rule.value_span.clone()).or_else(|| outline.reward.clone());
        let (None, Some(span)) = (plan.behaviour.fixed_value(index), span) else { continue };
        let rule = &trial.rules[index];
        let same = rule.values.filter(|(least, greatest)| rule.fired >= ENOUGH && least == greatest);
        let Some((value, _)) = same.filter(|_| !is_switched_off(plan, &span)) else { continue };
        let what = if index == outline.rules.len() {
            "'fn reward'".to_owned()
        } else {
            format!("rule \"{}\"", printable(&text.name))
        };
        let message = format!("{what} gave {value} in every one of {} steps, whatever it reads", rule.fired);
        let help = "look for a min and a max that are exchanged, or for a limit that is never passed";
        findings.push(Finding::warning(plan, "W-VALUE-CONSTANT", span, message).say("always the same", help));
    }
}

/// Whether a value is multiplied with a constant that its author has set to 0.
fn is_switched_off(plan: &Plan, span: &Range<usize>) -> bool {
    let text = &plan.behaviour.source().text;
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let is_zero = |word: &str| {
        text.split(&format!("const {word} =")).nth(1).is_some_and(|value| {
            value.split(';').next().is_some_and(|value| value.trim().parse::<f64>().is_ok_and(|value| value == 0.0))
        })
    };
    text[span.clone()].split(|c| !is_word(c)).any(|word| !word.is_empty() && is_zero(word))
}

/// A success, the script's own or the default, that a robot meets which knows nothing, or which does not look.
pub(super) fn check_success(plan: &Plan, threads: usize, stop: &AtomicBool, findings: &mut Vec<Finding>) -> Result<()> {
    let success = plan.success();
    if success.conditions().is_empty() {
        return Ok(());
    }
    let own = success.conditions().iter().find_map(|condition| condition.span.clone());
    let span = own.unwrap_or_else(|| place(plan));
    let (untrained, cheats) = (test_untrained(plan, SEED, stop)?, cheats(plan));
    let jobs: Vec<u64> = (0..cheats.len() as u64).collect();
    let tested = in_parallel(&jobs, threads, |job| {
        let mut blind = Blind { choose: &cheats[job as usize].1, step: 0 };
        Ok(test_choices(plan, SEED, stop, &mut blind, &mut ())?.figures)
    })?;
    let blind = cheats.iter().zip(&tested).find(|(_, figures)| success.is_met_by(figures, &untrained));
    let who = if success.is_met_by(&untrained, &untrained) {
        "a robot that knows nothing".to_owned()
    } else if let Some(((name, _), _)) = blind {
        format!("a robot that does not look ('{name}')")
    } else {
        return Ok(());
    };
    let message = format!("{who} meets every condition of success");
    let help = "name what it must do: test.laps >= 3, or test.metres_per_failure > 5 * untrained.metres_per_failure";
    findings.push(Finding::warning(plan, "W-SUCCESS-IDLE", span, message).say("not enough", help));
    Ok(())
}

/// A cheat in the whole test.
struct Blind<'a> {
    choose: &'a (dyn Fn(u64, usize) -> usize + Send + Sync),
    step: u64,
}

impl Chooser for Blind<'_> {
    fn choose(&mut self, _: &[usize], _: Allowed) -> Result<Choice> {
        let action = (self.choose)(self.step, 0);
        self.step += 1;
        Ok(Choice { action, explored: false })
    }
}
