//! Views and states: a state of too many values, and values that read what may not be seen.

use super::Finding;
use engine::experiment::Plan;
use engine::settings::{LearnerKind, ViewSettings};

/// A table of more states than this is hardly ever filled.
const LARGE: usize = 4096;
/// Facts of a view that read as a far value where nothing is seen.
const FAR_UNSEEN: [&str; 8] =
    ["bearing_deg", "elevation_deg", "offset", "left_deg", "right_deg", "floor_m", "line_offset_m", "line_heading_deg"];
/// Whoever bounds a value has thought of the far one.
const BOUNDS: [&str; 4] = ["min(", "max(", "clamp(", "if "];

pub(super) fn check_views(plan: &Plan, findings: &mut Vec<Finding>) {
    large_state(plan, findings);
    for index in 0..plan.behaviour.outline().rules.len() {
        unseen(plan, index, findings);
    }
}

fn large_state(plan: &Plan, findings: &mut Vec<Finding>) {
    let place = ["state", "stages"].into_iter().find_map(|place| plan.behaviour.place_of(place));
    let named = |view: &ViewSettings| plan.behaviour.place_of(&format!("view \"{}\"", view.name));
    let (Some(span), Ok(map)) = (place.or_else(|| plan.settings.views().find_map(named)), plan.state_map()) else {
        return;
    };
    let states = map.states();
    let pools = plan.settings.learner.kind == LearnerKind::Memory;
    if plan.settings.has_parts() && states > LARGE && !pools {
        let message = format!("there are {states} states: most of them will never be met twice");
        let help = "write learner(#{ kind: \"memory\" }), which lets each part stand in for the whole, or use fewer parts, \
                    smaller grids, fewer edges or fewer stages";
        findings.push(Finding::warning(plan, "W-STATE-LARGE", span, message).say("too fine", help));
    }
}

/// A value that reads where something lies, under a condition that does not ask whether it is seen.
fn unseen(plan: &Plan, index: usize, findings: &mut Vec<Finding>) {
    let (outline, text) = (plan.behaviour.outline(), &plan.behaviour.source().text);
    let rule = &outline.rules[index];
    let whole = |span: &std::ops::Range<usize>| outline.with_measures(text, &text[span.clone()]);
    let (condition, value) = (whole(&rule.condition_span), whole(&rule.value_span));
    if BOUNDS.iter().any(|bound| value.contains(bound)) {
        return;
    }
    let read = plan.settings.views().find_map(|view| {
        let asked = condition.contains(&format!("{}.", view.name));
        let fact = FAR_UNSEEN.iter().map(|key| format!("{}.{key}", view.name)).find(|fact| value.contains(fact));
        fact.filter(|_| !asked).map(|fact| (fact, &view.name))
    });
    if let Some((fact, view)) = read {
        let message = format!("the value reads {fact} even where the view \"{view}\" sees nothing");
        let help = format!("ask for it in the condition: when {view}.seen => ...; or bound the value with min or max");
        let say = "then it is as far off as can be, and so is the value";
        findings.push(Finding::warning(plan, "W-UNSEEN", rule.value_span.clone(), message).say(say, help));
    }
}
