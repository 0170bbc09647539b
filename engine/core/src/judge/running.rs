//! Errors while a script ran in plain words, in the user's own line.

use super::explain::{BEAMS, limit, mistake, offset, plain_kind, unknown_fact, unknown_name};
use super::fact_table::{is_group, names_in};
use super::functions::FUNCTIONS;
use super::stopped::stopped;
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
            let key = printable(key);
            at("E-SCRIPT-RUN", position, format!("the map has no key '{key}'"))
                .help(format!("ask first whether it is there: map.contains(\"{key}\")"))
        }
        E::ErrorArrayBounds(count, index, position) => {
            let help = match count.checked_sub(1) {
                None => "ask first whether there is any: array.len() > 0".to_owned(),
                Some(last) => format!("they are counted from 0: 0 to {last}"),
            };
            at("E-SCRIPT-RUN", position, format!("the array has {count} values: there is no number {index}")).help(help)
        }
        E::ErrorMismatchDataType(wanted, found, position) => {
            let (wanted, found) = (plain_kind(wanted), plain_kind(found));
            at("E-SCRIPT-NAME", position, format!("this must be {wanted}, found {found}"))
        }
        E::ErrorIndexingType(kind, position) => {
            let kind = kind.split(' ').next().unwrap_or_default();
            let wrong = at("E-SCRIPT-FACT", position, format!("{} cannot be read with [ ]", plain_kind(kind)));
            match kind {
                "laser" => wrong.help(BEAMS),
                group if is_group(group) => {
                    wrong.help(format!("its facts have names: write a dot and one of them after {group}"))
                }
                _ => wrong,
            }
        }
        E::ErrorFor(position) => {
            at("E-SCRIPT-NAME", position, "a loop needs a range or an array: for i in 0..9".to_owned())
        }
        E::ErrorRuntime(value, position) => at(
            "E-SCRIPT-RUN",
            position,
            printable(&value.clone().into_string().unwrap_or_else(|kind| format!("stopped with {kind}"))),
        ),
        E::ErrorArithmetic(message, position) => {
            let (message, help) = arithmetic(message);
            at("E-SCRIPT-RUN", position, message).help(help)
        }
        E::ErrorAssignmentToConstant(name, position) => {
            at("E-SCRIPT-SYNTAX", position, format!("'{}' is read-only", printable(name)))
        }
        other => other_failure(source, other),
    }
}

/// Kinds of failure that few scripts meet.
fn other_failure(source: &SourceText, error: &EvalAltResult) -> Diagnostic {
    use EvalAltResult as E;
    let at = |code, message: &str| mistake(source, code, error.position(), message, "here");
    match error {
        E::ErrorUnboundThis(_) => at("E-SCRIPT-NAME", "'this' stands for nothing here")
            .help("give the function an argument, and read that: fn reward(facts) { -facts.laser.right }"),
        E::ErrorStringBounds(count, index, _) => {
            at("E-SCRIPT-RUN", &format!("the text has {count} characters: there is no number {index}"))
        }
        E::ErrorBitFieldBounds(..) => at("E-SCRIPT-NAME", "a number cannot be read with [ ]"),
        E::ErrorIndexNotFound(index, _) => {
            at("E-SCRIPT-RUN", &format!("there is no value '{}' in this", printable(&index.to_string())))
        }
        E::ErrorNonPureMethodCallOnConstant(name, _) => {
            let name = name.split(' ').next().unwrap_or_default();
            let message = format!("'{}' would change what must stay the same", printable(name));
            at("E-SCRIPT-SYNTAX", &message).help("copy it first: let copy = ...;")
        }
        E::ErrorVariableExists(name, _) => {
            at("E-SCRIPT-SYNTAX", &format!("'{}' is defined twice", printable(name))).help("choose another name")
        }
        _ => at("E-SCRIPT-RUN", "the script cannot go on here"),
    }
}

/// A calculation that has no result, in plain words, and what to write. The interpreter's words are `What: 1 + 2`.
fn arithmetic(words: &str) -> (String, String) {
    let (what, sum) = words.split_once(": ").unwrap_or((words, ""));
    let by_zero = sum.ends_with(" 0");
    let (what, help) = match what.to_lowercase() {
        what if what.contains("division") && what.contains("zero") && by_zero => {
            let helped = "see that the divisor is never 0: divide by max(1, x)";
            (
                if what.contains("modulo") { "there is no remainder of a division by 0" } else { "a division by 0" },
                helped,
            )
        }
        what if what.contains("overflow") => (
            "a whole number has grown too large",
            "calculate with fractions: write one of the numbers as 1.0 or to_float(x)",
        ),
        what if what.starts_with("sign of") => ("this number is none (NaN): it has no sign", ""),
        what if what.contains("step") => ("a range needs steps that are not 0", "write range(0, 10, 1)"),
        _ => ("this cannot be calculated", "look for a number that is too large, too small or none"),
    };
    let message = if sum.is_empty() { what.to_owned() } else { format!("{what}: {}", printable(sum)) };
    (message, help.to_owned())
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

fn no_part(source: &SourceText, position: Position, message: &str) -> Diagnostic {
    let mut quoted = message.split('\'').skip(1).step_by(2);
    match (quoted.next(), quoted.next()) {
        (Some(key), Some(group)) if !names_in(group).is_empty() => unknown_fact(source, position, (group, group), key),
        (Some(key), Some(kind)) => {
            let message = format!("{} has nothing called '{}'", plain_kind(kind), printable(key));
            mistake(source, "E-SCRIPT-FACT", position, message, "here")
        }
        _ => mistake(source, "E-SCRIPT-FACT", position, "this has no such part", "here"),
    }
}
