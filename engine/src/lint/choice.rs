//! Rewards that do not depend on what the robot does.

use super::{Finding, Trial};
use crate::experiment::Plan;

const HELP: &str = "let a rule or 'fn reward' depend on where the actions lead: laser, camera, robot or action";

/// What can be read from the script.
pub(super) fn written(plan: &Plan, findings: &mut Vec<Finding>) {
    let (outline, actions) = (plan.behaviour.outline(), &plan.settings.actions);
    if actions.iter().all(|action| *action == actions[0]) && plan.settings.policies.is_empty() {
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

/// What the trial shows: the same reward in every step.
pub(super) fn observed(plan: &Plan, trial: &Trial, findings: &mut Vec<Finding>) {
    let Some(first) = trial.transitions.first().map(|step| step.reward) else { return };
    let constant = trial.transitions.iter().all(|step| step.reward == first && !step.recover);
    // Rules that never fired have a finding of their own.
    let fired = trial.rules.iter().any(|rule| rule.fired > 0);
    if constant && fired && findings.iter().all(|finding| finding.code != "W-NO-CHOICE") {
        let message = format!("every one of {} steps was rewarded alike, by {first}", trial.transitions.len());
        let label = "no action was ever better than another";
        findings.push(Finding::warning(plan, "W-NO-CHOICE", place(plan), message).say(label, HELP));
    }
}

fn place(plan: &Plan) -> std::ops::Range<usize> {
    let outline = plan.behaviour.outline();
    let rule = outline.rules.first().map(|rule| rule.condition_span.clone());
    outline.reward.clone().or(rule).unwrap_or(0..0)
}
