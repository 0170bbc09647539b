//! Set-up that nothing reads: settings without effect, constants and functions that nothing uses.

use super::Finding;
use engine::experiment::Plan;
use engine::settings::{CombineWay, DrawnFrom, LearnerKind, LearnerSettings, RecoverTo, SETTINGS, UNNAMED_VIEW};

pub(super) fn check_setup(plan: &Plan, findings: &mut Vec<Finding>) {
    for row in SETTINGS {
        let name = row.name();
        let Some(span) = plan.behaviour.place_of(&name) else { continue };
        let Some((why, help)) = idle(plan, &name) else { continue };
        let message = format!("{name} is set, but nothing reads it");
        findings.push(Finding::warning(plan, "W-UNUSED", span, message).say(why, help));
    }
    for varied in &plan.settings.randomise {
        let Some(span) = plan.behaviour.place_of(&format!("randomise.{}", varied.key)) else { continue };
        if let Some(value) = always_drawn(&varied.from) {
            let message = format!("{} is drawn for each attempt, and is always {value}", varied.key);
            let finding = Finding::warning(plan, "W-UNUSED", span, message);
            findings
                .push(finding.say("nothing varies", "give a least and a greatest value, or set it without drawing"));
            continue;
        }
        let Some((why, help)) = idle(plan, &varied.key) else { continue };
        let message = format!("{} is drawn for each attempt, but nothing reads it", varied.key);
        findings.push(Finding::warning(plan, "W-UNUSED", span, message).say(why, help));
    }
    for unused in &plan.behaviour.outline().unused {
        let (what, name) = (unused.what, &unused.name);
        let message = match name.as_str() {
            "calibrate" => "what 'fn calibrate' returns is never read".to_owned(),
            _ => format!("the {what} '{name}' is never used"),
        };
        let help = match name.as_str() {
            "calibrate" => "read it as 'calibrated' in a rule, or take the function out".to_owned(),
            _ => format!("use it, or take it out; look for a name that should be '{name}'"),
        };
        findings.push(
            Finding::warning(plan, "W-UNUSED", unused.span.clone(), message).say("defined here and nowhere read", help),
        );
    }
    same_actions(plan, findings);
    blind_starts(plan, findings);
}

/// Views that see nothing where every attempt begins.
fn blind_starts(plan: &Plan, findings: &mut Vec<Finding>) {
    for view in plan.blind_at_the_starts().unwrap_or_default() {
        let Some(view) = plan.settings.views().nth(view) else { continue };
        let last = view.filters.len().saturating_sub(1);
        let Some(span) = plan.behaviour.place_of(&view.place(&format!("filter:{last}"))) else { continue };
        let what = if view.name == UNNAMED_VIEW {
            "the filters see".to_owned()
        } else {
            format!("view \"{}\" sees", view.name)
        };
        let message = format!("{what} nothing from any start: what is looked for comes into sight only on the way");
        let help =
            "if that is not meant, check the filter's parameters and the camera's tilt, or add a start that sees it";
        findings.push(Finding::warning(plan, "W-FILTER-BLIND", span, message).say("sees nothing at the starts", help));
    }
}

/// The one value that is drawn, if it is always the same.
fn always_drawn(from: &DrawnFrom) -> Option<String> {
    match from {
        DrawnFrom::Range(low, high) => (low == high).then(|| low.to_string()),
        DrawnFrom::OneOf(values) => {
            let first = values.first()?;
            values.iter().all(|value| value == first).then(|| first.to_string())
        }
    }
}

/// Why a setting has no effect, and what to do about it.
fn idle(plan: &Plan, name: &str) -> Option<(String, &'static str)> {
    let (settings, outline) = (&plan.settings, plan.behaviour.outline());
    let (learner, combines) = (&settings.learner, !plan.learns());
    let reads_ground = plan.judge().is_ok_and(|judge| judge.reads_ground());
    let reads_laser = outline.groups.iter().any(|group| group == "laser");
    let (group, key) = name.split_once('.')?;
    if group == "learner"
        && !combines
        && let Some(why) = learner.unread(key)
    {
        return Some(why);
    }
    if let Some(why) = idle_in_a_table(learner, name) {
        return Some(why);
    }
    let why = match (group, key) {
        // A used policy looks through the same camera.
        ("camera" | "light" | "grid", _) if !plan.looks() && !plan.behaviour.hands_over() => (
            "neither the rules nor the states look through the camera".to_owned(),
            "take it out, or read a fact of the camera, such as camera.seen",
        ),
        ("colour", _) if !plan.looks() && !plan.behaviour.hands_over() && !reads_ground => (
            "neither the camera nor the ground is looked at".to_owned(),
            "take it out, or read a fact of the camera or of the ground",
        ),
        ("laser", _) if !reads_laser => ("no rule reads the laser".to_owned(), "take it out, or read laser.nearest"),
        ("learner", "failure_is_terminal" | "replay") | ("recovery", _) if !outline.recovers() => {
            ("no rule recovers".to_owned(), "add 'then recover' to a rule, or take it out")
        }
        ("recovery", "distance_m") if settings.recovery.to != RecoverTo::Behind => (
            format!("recovery is to \"{}\"", settings.recovery.to.word()),
            "write recovery(\"behind\", ...), or take it out",
        ),
        ("light", "softness_deg") if !has_shadows(plan) => {
            ("nothing throws a shadow".to_owned(), "set light.shadows = true, or take it out")
        }
        ("run", "stay_steps") if !plan.varies() => {
            ("there is one world, and nothing is drawn".to_owned(), "take it out, or add worlds or randomise")
        }
        ("movers", _) if plan.worlds.layouts().iter().all(|layout| layout.movers.is_empty()) => {
            (format!("nothing drives by itself in world '{}'", plan.layout.name), "take it out, or use another world")
        }
        ("combine", "margin") if settings.combine.way == CombineWay::Sum => {
            ("policies are combined by sum".to_owned(), "take it out, or write combine(\"priority\", ...)")
        }
        ("combine", "scaled") if settings.combine.way == CombineWay::Priority => {
            ("policies are combined by priority".to_owned(), "take it out, or write combine(\"sum\", ...)")
        }
        ("learner", key) if combines && !matches!(key, "temperature_end" | "kind") => {
            ("policies are combined, nothing is learned".to_owned(), "take it out")
        }
        ("run", "steps") if combines => ("policies are combined, nothing is learned".to_owned(), "take it out"),
        ("robot", "tick_s") if settings.robot.tick_s >= settings.run.period_s => {
            ("a tick is not shorter than the time between two actions".to_owned(), "set it below run.period_s")
        }
        ("grid", "fill") if settings.view.grid.rows == 1 => {
            ("a grid of one row has nothing to fill".to_owned(), "take it out, or use more rows")
        }
        _ => return None,
    };
    Some(why)
}

/// Why a setting of a learner with a table has no effect under its kind and its other settings, and what to do about it.
fn idle_in_a_table(learner: &LearnerSettings, name: &str) -> Option<(String, &'static str)> {
    let kind = |kinds: &[LearnerKind]| kinds.contains(&learner.kind);
    let why = match name {
        "learner.window" if kind(&[LearnerKind::Q, LearnerKind::SarsaLambda]) => (
            format!("learner \"{}\" has no window", learner.kind.word()),
            "take it out, or write learner(\"ttd\", ...)",
        ),
        "learner.trace_decay" if kind(&[LearnerKind::Q]) => {
            ("learner \"q\" has no traces".to_owned(), "take it out, or write learner(\"ttd\", ...)")
        }
        "learner.trace_decay" if learner.window == 1 && kind(&[LearnerKind::Ttd, LearnerKind::TtdCichosz]) => {
            ("a window of 1 has no earlier states".to_owned(), "set learner.window to 3 or more, or take it out")
        }
        "learner.cooling_visits" if learner.temperature <= learner.temperature_end => (
            "the temperature is the lowest from the start".to_owned(),
            "set learner.temperature higher, or take it out",
        ),
        _ => return None,
    };
    Some(why)
}

/// Whether the sun throws shadows in one of the worlds.
fn has_shadows(plan: &Plan) -> bool {
    let drawn = plan.settings.randomise.iter().any(|varied| varied.key == "light.shadows");
    let in_file = |layout: &std::sync::Arc<engine::world::Layout>| layout.scene.parts().light.shadows;
    plan.settings.camera.light.shadows || drawn || plan.worlds.layouts().iter().any(in_file)
}

fn same_actions(plan: &Plan, findings: &mut Vec<Finding>) {
    let actions = &plan.settings.actions;
    let Some(span) = plan.behaviour.place_of("actions") else { return };
    let twice = (1..actions.len()).find(|index| actions[..*index].contains(&actions[*index]));
    let one = actions.iter().all(|action| *action == actions[0]);
    if let (Some(index), false) = (twice, one) {
        let action = actions[index];
        let message = format!("action {index} stands twice in the list");
        let label = format!("[{}, {}] again", action.linear_m_per_s, action.angular_rad_per_s);
        findings.push(Finding::warning(plan, "W-UNUSED", span, message).say(label, "keep one of the two"));
    }
}
