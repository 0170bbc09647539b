//! Places in a script, and what is wrong there in plain words: unknown names, limits, kinds of values.

use super::fact_table::{GROUPS, OTHER_NAMES, is_group, names_in};
use super::withheld::{measured, withheld};
use crate::diagnostic::{Diagnostic, SourceText, nearest_name, printable};
use crate::settings::{SETTINGS, Settings};
use rhai::Position;

/// The byte offset of a position; the end if it has none.
pub(crate) fn offset(source: &SourceText, position: Position) -> usize {
    match (position.line(), position.position()) {
        (Some(line), column) => source.offset(line, column.unwrap_or(1)),
        (None, _) => source.text.trim_end().len(),
    }
}

/// A mistake in the script at a position, the word there underlined.
pub(crate) fn mistake(
    source: &SourceText,
    code: &'static str,
    position: Position,
    message: impl Into<String>,
    label: impl Into<String>,
) -> Diagnostic {
    mistake_at(source, code, offset(source, position), message, label)
}

/// A mistake in the script at a byte, the word there underlined.
pub(crate) fn mistake_at(
    source: &SourceText,
    code: &'static str,
    at: usize,
    message: impl Into<String>,
    label: impl Into<String>,
) -> Diagnostic {
    Diagnostic::new(code, message).at(source, source.word_at(at), label)
}

/// A variable that does not exist, at a position.
pub(crate) fn unknown_name(source: &SourceText, position: Position, name: &str, own_names: &[String]) -> Diagnostic {
    unknown_name_at(source, offset(source, position), name, own_names)
}

/// A variable that does not exist, with the nearest that does.
pub(crate) fn unknown_name_at(source: &SourceText, at: usize, name: &str, own_names: &[String]) -> Diagnostic {
    let own = nearest_name(name, own_names.iter().map(String::as_str));
    // A single letter is more often a variable that is not defined yet.
    if let Some(help) = withheld(name).filter(|_| own.is_none() && name.len() > 1) {
        return only_the_simulator_knows(source, at, name, help);
    }
    let message = format!("there is nothing called '{}'", printable(name));
    let known = GROUPS.iter().map(|(group, _)| *group).chain(["facts", "calibrated"]);
    let diagnostic = mistake_at(source, "E-SCRIPT-NAME", at, message, "not known");
    let fact = GROUPS.iter().map(|(group, _)| *group).find(|group| names_in(group).contains(&name));
    let fact = fact.map(|group| format!("{group}.{name}")).or_else(|| measured(name).map(str::to_owned));
    let near = own.or_else(|| nearest_name(name, known)).map(str::to_owned).or(fact);
    let truth = matches!(name, "True" | "False" | "TRUE" | "FALSE").then(|| name.to_lowercase());
    match truth.or(near) {
        Some(near) => diagnostic.help(format!("did you mean '{near}'?")),
        // `red.seen`: what is read of it is a fact.
        None if source.text[at..].strip_prefix(name).is_some_and(|rest| rest.starts_with('.')) => diagnostic
            .help(format!("a view of this name is made by view(\"{0}\", filter(\"colour\"));", printable(name))),
        // As other languages write it, and as the reference names it: `laser[beam]`.
        None if source.text[..at].ends_with("laser[") => diagnostic.help(BEAMS),
        None => diagnostic.help(format!("define it first: let {} = ...;", printable(name))),
    }
}

/// How the beams of the laser are read.
pub(crate) const BEAMS: &str =
    "a beam has a whole number, from 0 on the right: laser[90]; what lies ahead or to a side has a name: laser.front";

/// A word for what a script is not told, with what there is instead.
fn only_the_simulator_knows(source: &SourceText, at: usize, name: &str, help: String) -> Diagnostic {
    let message = format!("only the simulator knows '{}': a script sees what the robot measures", printable(name));
    mistake_at(source, "E-SCRIPT-TRUTH", at, message, "not to be had").help(help)
}

/// Facts of a function's argument that do not exist, at a position.
pub(crate) fn unknown_group(source: &SourceText, position: Position, name: &str) -> Diagnostic {
    if let Some(help) = withheld(name) {
        return only_the_simulator_knows(source, offset(source, position), name, help);
    }
    let groups: Vec<_> = GROUPS.iter().map(|row| row.0).collect();
    let owner = groups.iter().find(|group| names_in(group).contains(&name));
    let fact = measured(name).map(str::to_owned).or_else(|| owner.map(|owner| format!("{owner}.{name}")));
    let near = nearest_name(name, groups.iter().copied()).map(str::to_owned).or(fact);
    let help = match near {
        Some(near) => format!("did you mean '{near}'?"),
        None => format!("there are: {}", groups.join(", ")),
    };
    let message = format!("there are no facts called '{}'", printable(name));
    mistake(source, "E-SCRIPT-FACT", position, message, "not known").help(help)
}

/// A fact that does not exist, with the nearest that does.
///
/// `group` is written as the first and listed as the second: they differ for a view with a name.
pub(crate) fn unknown_fact(
    source: &SourceText,
    position: Position,
    (group, listed): (&str, &str),
    key: &str,
) -> Diagnostic {
    let names = names_in(listed);
    let near = nearest_name(key, names.iter().copied());
    if let (Some(help), None, false) = (withheld(key), near, matches!(group, "laser" | "camera")) {
        return only_the_simulator_knows(source, offset(source, position), key, help);
    }
    let other = OTHER_NAMES.iter().find(|(wrong, right)| *wrong == key && names.contains(right)).map(|row| row.1);
    let setting = setting_of(group, key);
    if let Some((key, default)) = setting.as_ref().filter(|_| near.or(other).is_none()) {
        let message = format!("'{group}.{key}' is a setting: a rule cannot read it");
        let help = format!("write its value: {default}, unless {group}(#{{ {key}: ... }}) says otherwise");
        return mistake(source, "E-SCRIPT-FACT", position, message, "not a fact").help(help);
    }
    let message = format!("'{group}' has no fact '{}'", printable(key));
    let diagnostic = mistake(source, "E-SCRIPT-FACT", position, message, "not known");
    // `bearing` for `bearing_deg`.
    let whole = names.iter().find(|name| name.strip_prefix(key).is_some_and(|rest| rest.starts_with('_'))).copied();
    match (near.or(other).or(whole), setting) {
        (Some(near), Some((key, _))) if near != key && names.contains(&key) => diagnostic.help(format!("did you mean '{near}' or '{key}'?")),
        (Some(near), Some((key, default))) if near != key => diagnostic.help(format!(
            "did you mean '{near}'? '{group}.{key}' is a setting, which a rule cannot read: write its value, {default} by default"
        )),
        (Some(near), _) => diagnostic.help(format!("did you mean '{near}'?")),
        (None, _) => diagnostic.help(format!("it has: {}", names.join(", "))),
    }
}

/// The setting that a word after the name of a group stands for, with its default: `max` and `max_range` for `max_range_m`.
fn setting_of(group: &str, word: &str) -> Option<(&'static str, String)> {
    let of_group = || SETTINGS.iter().filter(|row| row.group == group);
    let begins = |key: &str| key.strip_prefix(word).is_some_and(|rest| rest.starts_with('_'));
    let row = of_group().find(|row| row.key == word).or_else(|| of_group().find(|row| begins(row.key)))?;
    Some((row.key, (row.get)(&Settings::default()).to_string()))
}

/// A limit that stopped a script.
pub(crate) fn limit(source: &SourceText, position: Position, message: String) -> Diagnostic {
    mistake(source, "E-SCRIPT-LIMIT", position, message, "stopped here")
}

/// A kind of value in plain words.
pub(crate) fn plain_kind(kind: &str) -> String {
    match kind.trim_start_matches('&').trim_start_matches("mut ") {
        "i64" | "INT" => "a whole number".to_owned(),
        "f64" | "FLOAT" => "a number".to_owned(),
        "bool" => "true or false".to_owned(),
        "()" => "nothing".to_owned(),
        "array" | "Array" => "an array".to_owned(),
        "map" | "Map" => "a map".to_owned(),
        kind if kind.to_lowercase().contains("str") => "a text".to_owned(),
        kind if kind.starts_with("range") => "a range".to_owned(),
        kind if kind == "sector" || kind == "facts" || is_group(kind) => {
            format!("'{kind}' as a whole")
        }
        kind if kind.starts_with("Fn") => "a function".to_owned(),
        _ => "something else".to_owned(),
    }
}

/// A text with its first letter small.
pub(crate) fn lower(text: &str) -> String {
    let mut chars = text.chars();
    chars.next().map_or(String::new(), |first| first.to_lowercase().chain(chars).collect())
}
