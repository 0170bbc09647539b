//! Errors while a script ran in plain words, in the user's own line.

use super::explain::{limit, lower, mistake, offset, plain_kind, unknown_fact, unknown_name};
use super::fact_table::names_in;
use super::functions::FUNCTIONS;
use super::sandbox;
use crate::diagnostic::{Diagnostic, SourceText, printable};
use rhai::{EvalAltResult, Position};

/// An error while the script ran.
pub(crate) fn explain(source: &SourceText, error: &EvalAltResult) -> Diagnostic {
    use EvalAltResult as E;
    let at = |code, position: &Position, message: String| mistake(source, code, *position, message, "here");
    if let Some((message, help)) = stopped(error) {
        return limit(source, error.position(), message).help(help);
    }
    match error {
        E::ErrorInFunctionCall(_, _, inner, position) if inner.position().is_none() => {
            let inner = explain(source, inner);
            let span = source.word_at(offset(source, *position));
            inner.at(source, span, "here")
        }
        E::ErrorInFunctionCall(_, _, inner, _) => explain(source, inner),
        E::ErrorVariableNotFound(name, position) => unknown_name(source, *position, name, &[]),
        E::ErrorFunctionNotFound(signature, position) => wrong_types(source, *position, signature),
        E::ErrorDotExpr(message, position) => no_part(source, *position, message),
        E::ErrorPropertyNotFound(key, position) => {
            at("E-SCRIPT-RUN", position, format!("the map has no key '{}'", printable(key)))
        }
        E::ErrorArrayBounds(count, index, position) => {
            at("E-SCRIPT-RUN", position, format!("the array has {count} values: there is no number {index}"))
        }
        E::ErrorMismatchDataType(wanted, found, position) => {
            let (wanted, found) = (plain_kind(wanted), plain_kind(found));
            at("E-SCRIPT-NAME", position, format!("this must be {wanted}, found {found}"))
        }
        E::ErrorIndexingType(kind, position) => {
            let kind = kind.split(' ').next().unwrap_or_default();
            at("E-SCRIPT-FACT", position, format!("{} cannot be read with [ ]", plain_kind(kind)))
        }
        E::ErrorFor(position) => {
            at("E-SCRIPT-NAME", position, "a loop needs a range or an array: for i in 0..9".to_owned())
        }
        E::ErrorRuntime(value, position) => at(
            "E-SCRIPT-RUN",
            position,
            printable(&value.clone().into_string().unwrap_or_else(|kind| format!("stopped with {kind}"))),
        ),
        E::ErrorArithmetic(message, position) => at("E-SCRIPT-RUN", position, lower(&printable(message))),
        E::ErrorAssignmentToConstant(name, position) => {
            at("E-SCRIPT-SYNTAX", position, format!("'{}' is read-only", printable(name)))
        }
        other => at("E-SCRIPT-RUN", &other.position(), lower(&printable(&other.to_string()))),
    }
}

fn wrong_types(source: &SourceText, position: Position, signature: &str) -> Diagnostic {
    let (name, kinds) = signature.split_once(" (").unwrap_or((signature, ""));
    let kinds: Vec<_> =
        kinds.trim_end_matches(')').split(", ").filter(|kind| !kind.is_empty()).map(plain_kind).collect();
    let with = if kinds.is_empty() { "without arguments".to_owned() } else { format!("with {}", kinds.join(" and ")) };
    let message = format!("'{}' cannot be used {with}", printable(name));
    let diagnostic = mistake(source, "E-SCRIPT-NAME", position, message, "here");
    match FUNCTIONS.iter().find(|row| row.name == name) {
        Some(row) => diagnostic.help(format!("write {}", row.form)),
        None => diagnostic,
    }
}

/// What stopped a script, if a limit did, and what to look for.
fn stopped(error: &EvalAltResult) -> Option<(String, &'static str)> {
    use EvalAltResult as E;
    Some(match error {
        E::ErrorTooManyOperations(_) => (
            format!("the script was stopped after {} operations", sandbox::MAX_OPERATIONS),
            "look for a loop that does not end; a step has a handful of operations to spend",
        ),
        E::ErrorStackOverflow(_) => (
            format!("functions call one another too deep: at most {}", sandbox::MAX_CALL_LEVELS),
            "look for a function that calls itself",
        ),
        E::ErrorDataTooLarge(what, _) => {
            let (what, most) = match what.to_lowercase() {
                what if what.contains("string") => ("a text", sandbox::MAX_TEXT_BYTES),
                what if what.contains("map") => ("a map", sandbox::MAX_MAP),
                _ => ("an array", sandbox::MAX_ARRAY),
            };
            (format!("{what} has grown too large: at most {most}"), "look for a loop that makes it longer each time")
        }
        E::ErrorTooManyVariables(_) => {
            (format!("there are too many variables: at most {}", sandbox::MAX_VARIABLES), "look for a `let` in a loop")
        }
        _ => return None,
    })
}

fn no_part(source: &SourceText, position: Position, message: &str) -> Diagnostic {
    let mut quoted = message.split('\'').skip(1).step_by(2);
    match (quoted.next(), quoted.next()) {
        (Some(key), Some(group)) if !names_in(group).is_empty() => unknown_fact(source, position, group, key),
        (Some(key), Some(kind)) => {
            let message = format!("{} has nothing called '{}'", plain_kind(kind), printable(key));
            mistake(source, "E-SCRIPT-FACT", position, message, "here")
        }
        _ => mistake(source, "E-SCRIPT-FACT", position, "this has no such part", "here"),
    }
}
