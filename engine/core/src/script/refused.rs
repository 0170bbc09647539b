//! What the parser refuses, and functions that do not exist, in plain words, in the user's own line.

use super::setup_table::SETUP;
use super::syntax::OURS;
use super::words::foreign_word;
use crate::diagnostic::{Diagnostic, SourceText, nearest_name, printable};
use crate::judge::explain::{limit, lower, mistake, mistake_at, offset, unknown_name};
use crate::judge::functions::{FUNCTIONS, WINDOWS};
use crate::judge::sandbox;
use rhai::{LexError, ParseError, ParseErrorType, Position};

/// An error of the parser.
pub(super) fn syntax(source: &SourceText, error: &ParseError, own_names: &[String]) -> Diagnostic {
    let ParseError(kind, position) = error;
    let limited = most_of(kind).is_some() || matches!(**kind, ParseErrorType::VariableUndefined(_));
    if let Some(wrong) = foreign_word(source, offset(source, *position)).filter(|_| !limited) {
        return wrong;
    }
    let at = |message: String, label: &str| mistake(source, "E-SCRIPT-SYNTAX", *position, message, label);
    match &**kind {
        ParseErrorType::BadInput(LexError::ImproperSymbol(mark, message)) if mark == OURS => {
            form(source, *position, message)
        }
        ParseErrorType::AssignmentToInvalidLHS(_) if let Some(at) = assigned(source, offset(source, *position)) => {
            assignment(source, at)
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
            let (message, label, help) = end_missing(is_decimal_comma(source, *position));
            at(message.to_owned(), label).help(help)
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

/// A rule, a measure or a success that goes on otherwise than it should.
fn form(source: &SourceText, position: Position, message: &str) -> Diagnostic {
    let wrong = mistake(source, "E-SCRIPT-RULE", position, message, "found this");
    let assigns = source.text[offset(source, position)..].starts_with("= ");
    if assigns { wrong.help("write == to compare") } else { wrong }
}

fn assignment(source: &SourceText, at: usize) -> Diagnostic {
    Diagnostic::new("E-SCRIPT-SYNTAX", "'=' gives a variable a value, and does not compare")
        .at(source, at..at + 1, "not here")
        .help("write == to compare")
}

/// Where the first `=` alone stands in the statement from a byte on.
fn assigned(source: &SourceText, from: usize) -> Option<usize> {
    let text = &source.text[from..];
    let statement = &text[..text.find(';').unwrap_or(text.len())];
    let alone = |at: usize| {
        let (before, after) = (statement[..at].chars().next_back(), statement[at + 1..].chars().next());
        !before.is_some_and(|c| "=<>!+-*/".contains(c)) && !after.is_some_and(|c| "=>".contains(c))
    };
    statement.match_indices('=').map(|(at, _)| at).find(|at| alone(*at)).map(|at| from + at)
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

/// A function that does not exist, with the nearest that does.
pub(super) fn unknown_function_at(source: &SourceText, at: usize, name: &str, own: &[String]) -> Diagnostic {
    let known = FUNCTIONS.iter().chain(WINDOWS).map(|row| row.name).chain(SETUP.iter().map(|row| row.name));
    let near = nearest_name(name, known.chain(own.iter().map(String::as_str)));
    let message = format!("there is no function '{}' in a script", printable(name));
    let diagnostic = mistake_at(source, "E-SCRIPT-NAME", at, message, "not known");
    if let Some(row) = WINDOWS.iter().find(|row| row.name == name) {
        let help = format!("name it outside of the function: measure m = {}; and read facts.m here", row.form);
        return diagnostic.help(help);
    }
    match (near, name) {
        (Some(near), _) => diagnostic.help(format!("did you mean '{near}'?")),
        (None, "bins") => {
            diagnostic.help("it stands inside state(...): state(\"camera\", bins(laser.front, [0.5, 1.0]));")
        }
        (None, "print" | "debug") => diagnostic.help("`engine check` shows the facts and the rules that fire"),
        (None, _) => {
            let names: Vec<_> = FUNCTIONS.iter().map(|row| row.name).collect();
            diagnostic.help(format!("there are: {}", names.join(", ")))
        }
    }
}

/// What is said where a statement should end: message, mark and the way out.
fn end_missing(decimal_comma: bool) -> (&'static str, &'static str, &'static str) {
    match decimal_comma {
        true => ("a number has a point, not a comma", "a comma", "write 0.25, not 0,25"),
        false => ("a ';' is missing before this", "a new statement begins here", "end every statement with ';'"),
    }
}

/// Whether a comma between two digits stands here.
fn is_decimal_comma(source: &SourceText, position: Position) -> bool {
    let (before, after) = source.text.split_at_checked(offset(source, position)).unwrap_or_default();
    let is_digit = |c: Option<char>| c.is_some_and(|c| c.is_ascii_digit());
    is_digit(before.chars().next_back()) && after.strip_prefix(',').is_some_and(|rest| is_digit(rest.chars().next()))
}
