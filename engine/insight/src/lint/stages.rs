//! Stages that nothing enters, and stages that nothing leaves.

use super::Finding;
use engine::diagnostic::printable;
use engine::experiment::Plan;
use engine::outcome::Then;
use engine::script::RuleOutline;

pub(super) fn check_stages(plan: &Plan, findings: &mut Vec<Finding>) {
    let (outline, stages) = (plan.behaviour.outline(), &plan.settings.stages);
    let Some(span) = plan.behaviour.place_of("stages") else { return };
    // What a function returns is seen in a step only.
    if outline.reward.is_some() {
        return;
    }
    for (index, stage) in stages.iter().enumerate() {
        let (stage, rules) = (printable(stage), &outline.rules);
        let within = || rules.iter().filter(|rule| rule.stages.is_none_or(|bits| bits & (1 << index) != 0));
        let leaves = |rule: &RuleOutline| rule.leads_to.is_some_and(|to| to != index) || rule.then == Some(Then::Goal);
        if index > 0 && !rules.iter().any(|rule| rule.leads_to == Some(index)) {
            let message = format!("no rule enters stage \"{stage}\": the robot is never about it");
            let help = format!("let a rule lead there: ... then stage \"{stage}\"; or take the stage out");
            findings.push(Finding::warning(plan, "W-STAGE-DEAD", span.clone(), message).say("named here", help));
        } else if !within().any(leaves) {
            let message = format!("no rule leaves stage \"{stage}\", and it has no goal");
            let help = "let a rule end it: ... then goal; or then stage with the next one";
            findings.push(Finding::warning(plan, "W-STAGE-END", span.clone(), message).say("named here", help));
        }
    }
}
