//! Places in a script, and what is wrong there in plain words: unknown names, limits, kinds of values.

use super::fact_table::{GROUPS, OTHER_NAMES, is_group, names_in};
use crate::diagnostic::{Diagnostic, SourceText, nearest_name, printable};
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
    let message = format!("there is nothing called '{}'", printable(name));
    let known = GROUPS.iter().map(|(group, _)| *group).chain(["facts", "calibrated"]);
    let diagnostic = mistake_at(source, "E-SCRIPT-NAME", at, message, "not known");
    let near = nearest_name(name, own_names.iter().map(String::as_str).chain(known));
    let fact = GROUPS.iter().map(|(group, _)| *group).find(|group| names_in(group).contains(&name));
    match (near, fact) {
        (Some(near), _) => diagnostic.help(format!("did you mean '{near}'?")),
        (None, Some(group)) => diagnostic.help(format!("did you mean '{group}.{name}'?")),
        (None, None) => diagnostic.help(format!("define it first: let {} = ...;", printable(name))),
    }
}

/// A fact that does not exist, with the nearest that does.
pub(crate) fn unknown_fact(source: &SourceText, position: Position, group: &str, key: &str) -> Diagnostic {
    let names = names_in(group);
    let other = OTHER_NAMES.iter().find(|(wrong, right)| *wrong == key && names.contains(right)).map(|row| row.1);
    let message = format!("'{group}' has no fact '{}'", printable(key));
    let diagnostic = mistake(source, "E-SCRIPT-FACT", position, message, "not known");
    match nearest_name(key, names.iter().copied()).or(other) {
        Some(near) => diagnostic.help(format!("did you mean '{near}'?")),
        None => diagnostic.help(format!("it has: {}", names.join(", "))),
    }
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
