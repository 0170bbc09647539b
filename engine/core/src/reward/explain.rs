//! The parser's errors and unknown names in plain words, in the user's own line.

use super::fact_table::{GROUPS, OTHER_NAMES, names_in};
use super::functions::FUNCTIONS;
use super::sandbox;
use super::setup::SETUP;
use super::syntax::OURS;
use crate::diagnostic::{Diagnostic, SourceText, nearest_name, printable};
use rhai::{LexError, ParseError, ParseErrorType, Position};

/// The byte offset of a position; the end if it has none.
pub(super) fn offset(source: &SourceText, position: Position) -> usize {
    match (position.line(), position.position()) {
        (Some(line), column) => source.offset(line, column.unwrap_or(1)),
        (None, _) => source.text.trim_end().len(),
    }
}

/// A mistake in the script at a position, the word there underlined.
pub(super) fn mistake(
    source: &SourceText,
    code: &'static str,
    position: Position,
    message: impl Into<String>,
    label: impl Into<String>,
) -> Diagnostic {
    mistake_at(source, code, offset(source, position), message, label)
}

fn mistake_at(
    source: &SourceText,
    code: &'static str,
    at: usize,
    message: impl Into<String>,
    label: impl Into<String>,
) -> Diagnostic {
    Diagnostic::new(code, message).at(source, source.word_at(at), label)
}

/// An error of the parser.
pub(super) fn syntax(source: &SourceText, error: &ParseError, own_names: &[String]) -> Diagnostic {
    let ParseError(kind, position) = error;
    let at = |message: String, label: &str| mistake(source, "E-SCRIPT-SYNTAX", *position, message, label);
    match &**kind {
        ParseErrorType::BadInput(LexError::ImproperSymbol(mark, message)) if mark == OURS => {
            mistake(source, "E-SCRIPT-RULE", *position, message, "found this")
        }
        ParseErrorType::VariableUndefined(name) => unknown_name(source, *position, name, own_names),
        ParseErrorType::Reserved(word)
        | ParseErrorType::UnknownOperator(word)
        | ParseErrorType::BadInput(LexError::ImproperSymbol(word, _)) => {
            let help = match word.as_str() {
                "**" | "**=" => "write pow(x, y), or x * x",
                "print" | "debug" => "`engine check` shows the facts and the rules that fire",
                "===" => "write == to compare",
                "=" => "write == to compare",
                _ => "choose another word",
            };
            let what = if sandbox::is_refused(word) { "cannot be used in a script" } else { "has no meaning here" };
            at(format!("'{}' {what}", printable(word)), "not here").help(help)
        }
        ParseErrorType::UnexpectedEOF => at("the script ends too early".to_owned(), "something is missing here")
            .help("look for a bracket that is never closed"),
        ParseErrorType::MissingToken(token, _) if token == ";" => {
            at("a ';' is missing before this".to_owned(), "a new statement begins here")
                .help("end every statement with ';'")
        }
        ParseErrorType::MissingToken(token, _) => {
            at(format!("'{}' is missing here", printable(token)), "expected before this")
        }
        ParseErrorType::ExprExpected(_) => at("a value or a condition is missing here".to_owned(), "found this"),
        kind if let Some(most) = most_of(kind) => limit(source, *position, most),
        ParseErrorType::PropertyExpected => {
            at("after '.' comes the name of a fact or a function".to_owned(), "this is neither")
        }
        ParseErrorType::VariableExists(name) => {
            at(format!("'{}' is defined twice", printable(name)), "the second time").help("choose another name")
        }
        ParseErrorType::AssignmentToConstant(name) => {
            at(format!("'{}' is a constant: it cannot be changed", printable(name)), "changed here")
                .help("define it with 'let' instead of 'const'")
        }
        ParseErrorType::DuplicatedProperty(name) => mistake(
            source,
            "E-SCRIPT-SETTING",
            *position,
            format!("'{}' is given twice", printable(name)),
            "again here",
        ),
        ParseErrorType::FnDuplicatedDefinition(name, _) => {
            at(format!("the function '{}' is defined twice", printable(name)), "the second time")
        }
        other => at(lower(&printable(&other.to_string())), "here"),
    }
}

fn most_of(kind: &ParseErrorType) -> Option<String> {
    Some(match kind {
        ParseErrorType::ExprTooDeep => {
            format!("brackets or operators are nested too deep: at most {}", sandbox::MAX_NESTING)
        }
        ParseErrorType::TooManyFunctions => format!("a script may have {} functions", sandbox::MAX_FUNCTIONS),
        ParseErrorType::LiteralTooLarge(_, most) => format!("this is too long: at most {most}"),
        _ => return None,
    })
}

pub(super) fn unknown_name(source: &SourceText, position: Position, name: &str, own_names: &[String]) -> Diagnostic {
    unknown_name_at(source, offset(source, position), name, own_names)
}

/// A variable that does not exist, with the nearest that does.
pub(super) fn unknown_name_at(source: &SourceText, at: usize, name: &str, own_names: &[String]) -> Diagnostic {
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
pub(super) fn unknown_fact(source: &SourceText, position: Position, group: &str, key: &str) -> Diagnostic {
    let names = names_in(group);
    let other = OTHER_NAMES.iter().find(|(wrong, right)| *wrong == key && names.contains(right)).map(|row| row.1);
    let message = format!("'{group}' has no fact '{}'", printable(key));
    let diagnostic = mistake(source, "E-SCRIPT-FACT", position, message, "not known");
    match nearest_name(key, names.iter().copied()).or(other) {
        Some(near) => diagnostic.help(format!("did you mean '{near}'?")),
        None => diagnostic.help(format!("it has: {}", names.join(", "))),
    }
}

/// A function that does not exist, with the nearest that does.
pub(super) fn unknown_function_at(source: &SourceText, at: usize, name: &str, own: &[String]) -> Diagnostic {
    let known = FUNCTIONS.iter().map(|row| row.name).chain(SETUP.iter().map(|row| row.name));
    let near = nearest_name(name, known.chain(own.iter().map(String::as_str)));
    let message = format!("there is no function '{}' in a script", printable(name));
    let diagnostic = mistake_at(source, "E-SCRIPT-NAME", at, message, "not known");
    match (near, name) {
        (Some(near), _) => diagnostic.help(format!("did you mean '{near}'?")),
        (None, "print" | "debug") => diagnostic.help("`engine check` shows the facts and the rules that fire"),
        (None, _) => {
            let names: Vec<_> = FUNCTIONS.iter().map(|row| row.name).collect();
            diagnostic.help(format!("there are: {}", names.join(", ")))
        }
    }
}

pub(super) fn limit(source: &SourceText, position: Position, message: String) -> Diagnostic {
    mistake(source, "E-SCRIPT-LIMIT", position, message, "stopped here")
}

/// A kind of value in plain words.
pub(super) fn plain_kind(kind: &str) -> String {
    match kind.trim_start_matches('&').trim_start_matches("mut ") {
        "i64" | "INT" => "a whole number".to_owned(),
        "f64" | "FLOAT" => "a number".to_owned(),
        "bool" => "true or false".to_owned(),
        "()" => "nothing".to_owned(),
        "array" | "Array" => "an array".to_owned(),
        "map" | "Map" => "a map".to_owned(),
        kind if kind.to_lowercase().contains("str") => "a text".to_owned(),
        kind if kind.starts_with("range") => "a range".to_owned(),
        kind if kind == "sector" || kind == "facts" || GROUPS.iter().any(|(group, _)| *group == kind) => {
            format!("'{kind}' as a whole")
        }
        kind if kind.starts_with("Fn") => "a function".to_owned(),
        _ => "something else".to_owned(),
    }
}

pub(super) fn lower(text: &str) -> String {
    let mut chars = text.chars();
    chars.next().map_or(String::new(), |first| first.to_lowercase().chain(chars).collect())
}
