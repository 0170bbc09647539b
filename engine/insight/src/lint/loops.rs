//! Loops over beams in a script, where one call of the engine does the same some thirty times faster.

use super::Finding;
use engine::experiment::Plan;
use engine::script::Gathers;

pub(super) fn check_loops(plan: &Plan, findings: &mut Vec<Finding>) {
    for found in &plan.behaviour.outline().loops {
        let (from, to) = found.beams.unwrap_or((0, plan.settings.laser.beams as i64 - 1));
        let sector = format!("facts.laser.sector({from}, {to})");
        let instead = match found.gathers {
            Gathers::Count => format!("{sector}.count_below(0.5), with your own limit in metres"),
            Gathers::Sum => format!("{sector}.mean, or .excess(facts.calibrated) against expected ranges"),
            Gathers::Other => format!("{sector}.nearest or .farthest"),
        };
        let message = "a loop over beams makes every step slow";
        findings.push(
            Finding::warning(plan, "W-LOOP", found.span.clone(), message)
                .say("runs in the interpreter, beam by beam, in every step", format!("write {instead}")),
        );
    }
}
