//! Rewards that do not depend on what the robot does.

use super::{Exploit, Exploits, Finding, LintTrial};
use engine::experiment::{Plan, WINDOW_STEPS};

/// Rewards at random that are needed to tell them from those of another behaviour.
const ENOUGH_EVENTS: usize = 20;

const HELP: &str = "let a rule or 'fn reward' depend on where the actions lead: laser, camera, robot or action";

/// What can be read from the script.
pub(super) fn written(plan: &Plan, findings: &mut Vec<Finding>) {
    let (outline, actions) = (plan.behaviour.outline(), &plan.settings.actions);
    if actions.iter().all(|action| *action == actions[0]) && plan.learns() {
        let span = plan.behaviour.place_of("actions").unwrap_or(0..0);
        let message = "all actions are the same: there is nothing to choose";
        findings.push(
            Finding::warning(plan, "W-NO-CHOICE", span, message)
                .say("one action", "give at least two, such as actions([[0.3, 0.3], [0.3, -0.3]])"),
        );
    }
    if outline.groups.iter().all(|group| group == "time") {
        let message = "the reward does not depend on what the robot does";
        let label = if outline.groups.is_empty() { "reads no fact at all" } else { "reads nothing but the time" };
        findings.push(Finding::warning(plan, "W-NO-CHOICE", place(plan), message).say(label, HELP));
    }
}

/// What the trial shows: the same reward in every step, or for every way of driving.
pub(super) fn observed(plan: &Plan, trial: &LintTrial, exploits: &Exploits, findings: &mut Vec<Finding>) {
    let Some(first) = trial.transitions.first().map(|step| step.reward) else { return };
    let constant = trial.transitions.iter().all(|step| step.reward == first && !step.recover);
    // Rules that never fired have a finding of their own, and so has what makes them fire always.
    let fired = trial.rules.iter().any(|rule| rule.fired > 0);
    let explained = |finding: &Finding| matches!(finding.code, "W-NO-CHOICE" | "W-UNIT" | "W-RULE-ALWAYS");
    if !fired || findings.iter().any(explained) {
        return;
    }
    if constant {
        let message = format!("every one of {} steps was rewarded alike, by {first}", trial.transitions.len());
        let label = "no action was ever better than another";
        findings.push(Finding::warning(plan, "W-NO-CHOICE", place(plan), message).say(label, HELP));
    } else if let Some(mean) = alike(trial, exploits).filter(|_| !reads_the_action(plan)) {
        let message = "whatever the robot does, it is rewarded alike";
        let earned = mean * WINDOW_STEPS as f64;
        let label =
            format!("at random it earns {earned:.1} in 400 steps; the best, spinning and turning back the same");
        findings.push(Finding::warning(plan, "W-NO-CHOICE", place(plan), message).say(label, HELP));
    }
}

/// Whether the reward reads what was commanded, which no chance can hide.
fn reads_the_action(plan: &Plan) -> bool {
    plan.behaviour.outline().groups.iter().any(|group| group == "action")
}

/// What a step earns at random, if no other behaviour earns more or less than chance explains.
fn alike(trial: &LintTrial, exploits: &Exploits) -> Option<f64> {
    let rewards: Vec<f64> = trial.random().iter().map(|step| step.reward).collect();
    let count = rewards.len() as f64;
    let mean = rewards.iter().sum::<f64>() / count;
    let common = rewards.iter().filter(|reward| **reward != 0.0).count() >= ENOUGH_EVENTS;
    let variance = rewards.iter().map(|reward| (reward - mean) * (reward - mean)).sum::<f64>() / count;
    let same = |exploit: &Exploit| {
        let chance = (variance / count + exploit.variance / exploit.steps as f64).sqrt();
        (exploit.reward_per_400 / WINDOW_STEPS as f64 - mean).abs() <= 3.0 * chance
    };
    let alike = |exploit: &Exploit| same(exploit) && fires_alike(trial, exploit);
    (common && exploits.behaviours.iter().all(alike)).then_some(mean)
}

/// Whether every rule fires about as often in one way of driving as in the whole trial: where one does not, what the robot does
/// counts, however rare and small that is beside what it cannot help yet.
fn fires_alike(trial: &LintTrial, exploit: &Exploit) -> bool {
    exploit.rules.iter().zip(&trial.rules).all(|(own, all)| {
        let expected = all.fired as f64 * exploit.steps as f64 / trial.steps().max(1) as f64;
        (own.fired as f64 - expected).abs() <= 3.0 * expected.sqrt() + 3.0
    })
}

/// Where the reward begins: `fn reward`, or the first rule.
pub(super) fn place(plan: &Plan) -> std::ops::Range<usize> {
    let outline = plan.behaviour.outline();
    let rule = outline.rules.first().map(|rule| rule.condition_span.clone());
    outline.reward.clone().or(rule).unwrap_or(0..0)
}
