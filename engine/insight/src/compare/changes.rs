//! What was changed from one run to another: settings, actions, filters, the world, and the lines of the script.

use std::collections::BTreeSet;

use engine::experiment::Plan;
use engine::settings::{SETTINGS, Settings, Value};
use serde::Serialize;
use similar::{ChangeTag, TextDiff};

use crate::words::short;

/// What differs.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Changes {
    /// Settings, actions, filters and world.
    pub settings: Vec<SettingChange>,
    /// Lines of the script, those that went and those that came.
    pub lines: Vec<LineChange>,
}

/// A setting that differs.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct SettingChange {
    /// Its name, such as `camera.tilt_deg`.
    pub name: String,
    /// In the first run.
    pub before: String,
    /// In the other.
    pub after: String,
}

/// A line of the script that only one run has.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LineChange {
    /// Whether only the other run has it; else only the first has it.
    pub added: bool,
    /// Its number in its own script, from 1.
    pub line: usize,
    /// The line.
    pub text: String,
}

impl Changes {
    pub(super) fn new(first: &Plan, other: &Plan) -> Self {
        let scripts = [first, other].map(|plan| plan.behaviour.source().text.as_ref());
        Self { settings: settings(first, other), lines: lines(scripts[0], scripts[1]) }
    }

    /// Whether nothing differs.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.settings.is_empty() && self.lines.is_empty()
    }
}

fn settings(first: &Plan, other: &Plan) -> Vec<SettingChange> {
    let (a, b) = (&first.settings, &other.settings);
    let word = |value: Value| match value {
        Value::Flag(flag) => flag.to_string(),
        Value::Text(text) => text,
        Value::Number(number) => short(number),
    };
    let rows = SETTINGS.iter().map(|row| (row.name(), word((row.get)(a)), word((row.get)(b))));
    let further = [
        ("world".to_owned(), first.worlds.title(), other.worlds.title()),
        ("randomise".to_owned(), drawn(a), drawn(b)),
        ("actions".to_owned(), actions(a), actions(b)),
        ("filters".to_owned(), filters(a), filters(b)),
    ];
    let of = |plan: &Plan, name: &str| {
        let param = plan.behaviour.params().iter().find(|param| param.name == name);
        param.map_or("none".to_owned(), |param| short(param.value))
    };
    let mut names: Vec<&str> =
        [first, other].iter().flat_map(|plan| plan.behaviour.params()).map(|param| param.name.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    let params = names.into_iter().map(|name| (name.to_owned(), of(first, name), of(other, name)));
    let mut changes: Vec<SettingChange> = params
        .chain(further)
        .chain(rows)
        .filter(|(_, before, after)| before != after)
        .map(|(name, before, after)| SettingChange { name, before, after })
        .collect();
    for name in policies(first).chain(policies(other)).map(|(name, _)| name).collect::<BTreeSet<_>>() {
        let of = |plan| policies(plan).find(|(own, _)| *own == name).map(|(_, text)| text);
        let (before, after) = match (of(first), of(other)) {
            (Some(before), Some(after)) if before == after => continue,
            (before, after) => {
                (before.map_or("none", |_| "as it was").to_owned(), after.map_or("none", |_| "another one").to_owned())
            }
        };
        changes.push(SettingChange { name: format!("policy \"{name}\""), before, after });
    }
    let texts = [first, other].map(|plan| plan.worlds.layouts().iter().map(|layout| &layout.source.text));
    if first.worlds.title() == other.worlds.title() && !Iterator::eq(texts[0].clone(), texts[1].clone()) {
        let (before, after) = ("as it was".to_owned(), "another text".to_owned());
        changes.push(SettingChange { name: "world file".to_owned(), before, after });
    }
    changes
}

/// The policies that a script uses or combines, each by its name with its text.
fn policies(plan: &Plan) -> impl Iterator<Item = (&str, &str)> {
    let used = plan.used.iter().map(|used| (used.name.as_str(), &*used.texts[0].text));
    used.chain(plan.members.iter().map(|member| (member.name.as_str(), &*member.source.text)))
}

/// What is drawn for each attempt.
fn drawn(settings: &Settings) -> String {
    let entries: Vec<String> =
        settings.randomise.iter().map(|varied| format!("{} {}", varied.key, varied.from.words())).collect();
    if entries.is_empty() { "nothing".to_owned() } else { entries.join(", ") }
}

fn actions(settings: &Settings) -> String {
    let action = |twist: &engine::geometry::Twist| format!("[{}, {}]", twist.linear_m_per_s, twist.angular_rad_per_s);
    settings.actions.iter().map(action).collect::<Vec<_>>().join(" ")
}

fn filters(settings: &Settings) -> String {
    let filter = |filter: &engine::settings::FilterSettings| {
        let parameters = filter.shown().iter().map(|shown| format!(" {shown}")).collect::<String>();
        format!("{}{parameters}", filter.name)
    };
    settings.view.filters.iter().map(filter).collect::<Vec<_>>().join(", ")
}

fn lines(before: &str, after: &str) -> Vec<LineChange> {
    let difference = TextDiff::from_lines(before, after);
    let changed = difference.iter_all_changes().filter_map(|change| {
        let (added, index) = match change.tag() {
            ChangeTag::Equal => return None,
            ChangeTag::Delete => (false, change.old_index()),
            ChangeTag::Insert => (true, change.new_index()),
        };
        Some(LineChange { added, line: index? + 1, text: change.value().trim_end().to_owned() })
    });
    changed.collect()
}

/// Two scripts as one text: the lines that differ with three around them, `-` before and `+` after.
#[must_use]
pub fn script_diff(before: &str, after: &str) -> String {
    TextDiff::from_lines(before, after).unified_diff().context_radius(3).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_that_only_one_script_has_are_told_with_their_numbers() {
        let changed = lines("a\nb\nc\n", "a\nc\nd\n");
        let told: Vec<_> = changed.iter().map(|change| (change.added, change.line, change.text.as_str())).collect();
        assert_eq!(told, [(false, 2, "b"), (true, 3, "d")]);
        assert!(lines("a\nb", "a\nb\n").len() <= 2 && lines("a\n", "a\n").is_empty());
    }
}
