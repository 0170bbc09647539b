//! Lines that take much of what a step may cost.

use super::Finding;
use engine::experiment::Plan;
use engine::script::Dear;

/// From so many operations of a step a line is dear: a tenth of what all rules may take together.
const DEAR: u64 = 10_000;

pub(super) fn check_cost(plan: &Plan, findings: &mut Vec<Finding>) {
    for Dear { span, operations, most } in plan.behaviour.dear_lines(&plan.settings, DEAR) {
        let message = format!("a step of this costs {operations} of the {most} operations that a step may cost");
        let help = "do less in the loop, and read long arrays and maps outside of it: each costs by its length";
        findings.push(Finding::warning(plan, "W-COST", span, message).say("most of them are spent here", help));
    }
}
