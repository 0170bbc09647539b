//! Rewards whose size does not suit the softmax of a table: one of them decides for good, or none can be told from nothing. The
//! learner `memory` finds its own unit, so that every size suits it.

use super::{Finding, LintTrial};
use engine::diagnostic::printable;
use engine::experiment::Plan;
use engine::settings::LearnerKind;

/// Odds at the hottest below which an action that was punished once is as good as never tried again.
const NEVER_AGAIN: f64 = 1e-6;

/// The greatest reward, either way, after which an action may still be tried again while the state is hot.
///
/// One step moves a value by `step_size * reward`; at the first temperature that changes the odds of the action by the
/// factor `exp(-step_size * reward / temperature)`.
fn most(plan: &Plan) -> f64 {
    let learner = &plan.settings.learner;
    if learner.kind == LearnerKind::Memory {
        return f64::INFINITY;
    }
    -libm::log(NEVER_AGAIN) * learner.temperature / learner.step_size.max(1e-9)
}

/// The least reward that the coolest softmax can tell from nothing.
fn least(plan: &Plan) -> f64 {
    let learner = &plan.settings.learner;
    if learner.kind == LearnerKind::Memory { 0.0 } else { learner.temperature_end }
}

/// Rules with a fixed value.
pub(super) fn written(plan: &Plan, findings: &mut Vec<Finding>) {
    let outline = plan.behaviour.outline();
    let values: Vec<Option<f64>> = (0..outline.rules.len()).map(|rule| plan.behaviour.fixed_value(rule)).collect();
    let all_small = outline.reward.is_none() && values.iter().all(|value| value.is_some_and(|v| v.abs() < least(plan)));
    let some = values.iter().any(|value| value.is_some_and(|value| value != 0.0));
    for ((rule, text), value) in outline.rules.iter().zip(plan.behaviour.rules()).zip(values) {
        let Some(value) = value else { continue };
        let name = printable(&text.name);
        if value.abs() > most(plan) {
            findings.push(large(plan, rule.value_span.clone(), &format!("rule \"{name}\""), value));
        } else if all_small && some && value != 0.0 {
            findings.push(small(plan, rule.value_span.clone(), &format!("rule \"{name}\""), value));
        } else if value == 0.0
            && rule.then.is_none()
            && rule.leads_to.is_none()
            && !outline.remembered.contains(&text.name)
        {
            let message = format!("rule \"{name}\" adds 0 and does not recover: it does nothing");
            let help = "give it a value, such as -1, or take it out";
            findings.push(Finding::warning(plan, "W-UNUSED", rule.value_span.clone(), message).say("no effect", help));
        }
    }
}

/// Values that depend on the step, as the trial saw them.
pub(super) fn observed(plan: &Plan, trial: &LintTrial, findings: &mut Vec<Finding>) {
    let outline = plan.behaviour.outline();
    for (index, text) in plan.behaviour.rules().iter().enumerate() {
        let span = outline.rules.get(index).map(|rule| rule.value_span.clone()).or_else(|| outline.reward.clone());
        let (None, Some(span)) = (plan.behaviour.fixed_value(index), span) else { continue };
        let what = match index == outline.rules.len() {
            true => "'fn reward'".to_owned(),
            false => format!("rule \"{}\"", printable(&text.name)),
        };
        let value = trial.rules[index].largest;
        let only = plan.behaviour.rules().len() == 1;
        if value.abs() > most(plan) {
            findings.push(large(plan, span, &what, value));
        } else if only && value != 0.0 && value.abs() < least(plan) {
            findings.push(small(plan, span, &what, value));
        }
    }
}

fn large(plan: &Plan, span: std::ops::Range<usize>, what: &str, value: f64) -> Finding {
    let learner = &plan.settings.learner;
    let moved = learner.step_size * value;
    let message = format!("{what} gives {value:.4}: one such step decides for good");
    let label = format!("moves a value by {moved:.3}, {:.0} temperatures", (moved / learner.temperature).abs());
    let help = format!(
        "the softmax begins at a temperature of {}: keep rewards between -1 and 1, or raise learner.temperature with them",
        learner.temperature
    );
    Finding::warning(plan, "W-SCALE", span, message).say(label, help)
}

fn small(plan: &Plan, span: std::ops::Range<usize>, what: &str, value: f64) -> Finding {
    let end = plan.settings.learner.temperature_end;
    let message = format!("{what} gives {value}: too little for the learner to see");
    let help = format!("the softmax cools down to a temperature of {end}: use rewards of about 1, such as -1");
    Finding::warning(plan, "W-SCALE", span, message).say(format!("less than the coolest temperature, {end}"), help)
}
