//! What stands beside an exported policy, for the person who uses it.

use std::fmt::Write;

use engine::digest::Digest;
use engine::experiment::Plan;
use engine::learner::Policy;

use crate::model::{Model, Told};
use crate::names;
use crate::text::filled;

const README: &str = include_str!("../templates/README.md");

pub(crate) fn readme(model: &Model, plan: &Plan, policy: &Policy, frames: usize, run: &str) -> String {
    let camera = &plan.settings.camera;
    let temperature = policy.temperature().unwrap_or(plan.settings.learner.temperature_end);
    let values = [
        ("BEHAVIOUR", model.behaviour.clone()),
        ("RUN_SHA256", Digest::of(run.as_bytes()).to_string()),
        ("FRAMES", frames.to_string()),
        ("WIDTH", model.size_px.0.to_string()),
        ("HEIGHT", model.size_px.1.to_string()),
        (
            "PIXEL",
            if model.channels == 1 { "brightness in one byte" } else { "red, green and blue in three bytes" }
                .to_owned(),
        ),
        ("FIELD", camera.field_of_view_deg.to_string()),
        ("LENS", format!("lens \"{}\"", camera.lens.word())),
        ("HEIGHT_M", camera.height_m.to_string()),
        ("FORWARD", camera.forward_m.to_string()),
        ("TILT", camera.tilt_deg.to_string()),
        ("PERIOD", model.period_s.to_string()),
        ("ACTIONS", model.actions.len().to_string()),
        ("TEMPERATURE", format!("{temperature:.4}")),
        ("TOLD", told(model)),
    ];
    let values: Vec<(&str, &str)> = values.iter().map(|(name, text)| (*name, text.as_str())).collect();
    filled(README, &values)
}

/// What the program has to say besides the image.
fn told(model: &Model) -> String {
    let (digits, guards) = (names::digits(model), names::guards(model));
    let mut text = String::new();
    if !digits.is_empty() {
        text.push_str("\nThe state has parts that no image shows. The program says them, in this order, a byte each:\n\n| digit | values | how it comes about |\n|---|---|---|\n");
    }
    for digit in &digits {
        let how = match &digit.how {
            Told::Edges(edges) => format!("how many of these it has reached: {edges:?}"),
            Told::Flag => "1 where it holds, else 0".to_owned(),
            Told::Stages(stages) => format!("the number of the stage: {}", stages.join(", ")),
        };
        let _ = writeln!(text, "| `{}` | {} | {how} |", digit.script, digit.values);
    }
    if !guards.is_empty() {
        text.push_str("\nThe script forbids actions while something holds. The program asks that, and sets a bit for each guard that does:\n\n| bit | guard | its text in the script |\n|---|---|---|\n");
    }
    for (bit, (_, name, condition)) in guards.iter().enumerate() {
        let _ = writeln!(text, "| {bit} | {name} | `{condition}` |");
    }
    text
}
