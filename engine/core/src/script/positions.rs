//! Where expressions and bodies begin and end in the text: the parser keeps only where they start.

use super::source::Code;
use crate::judge::explain::offset;
use rhai::{Expr, Position};
use std::ops::Range;

/// Where an expression begins in the text.
///
/// The position of an operator is its own; what is underlined begins with its left side.
pub(super) fn first(expr: &Expr) -> Position {
    match expr {
        Expr::FnCall(call, _) if call.is_operator_call() && call.args.len() == 2 => first(&call.args[0]),
        Expr::And(parts, _) | Expr::Or(parts, _) => parts.first().map_or(Position::NONE, first),
        other => other.start_position(),
    }
}

/// Where the first body in braces after `start` ends, its last brace included.
pub(super) fn body_end(plain: &str, start: usize) -> usize {
    let mut depth = 0_i32;
    for (index, c) in plain[start..].char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth == 1 => return start + index + 1,
            '}' => depth -= 1,
            _ => {}
        }
    }
    plain.len()
}

/// The end of an operand: of its last name, number or bracket.
pub(super) fn operand_end(code: &Code, expr: &Expr) -> usize {
    let start = match expr {
        Expr::FnCall(call, _) if call.is_operator_call() && !call.args.is_empty() => {
            return call.args.last().map_or(0, |last| operand_end(code, last));
        }
        Expr::And(parts, _) | Expr::Or(parts, _) => return parts.last().map_or(0, |last| operand_end(code, last)),
        other => offset(&code.source, first(other)),
    };
    let mut depth = 0_i32;
    for (index, c) in code.plain[start..].char_indices() {
        match c {
            '(' | '[' => depth += 1,
            ')' | ']' if depth > 0 => depth -= 1,
            _ if depth > 0 || c.is_alphanumeric() || matches!(c, '_' | '.') => {}
            _ => return start + index,
        }
    }
    code.plain.len()
}

/// The bytes of an expression: from its first token to what ends it.
pub(super) fn span(code: &Code, expr: &Expr) -> Range<usize> {
    let start = offset(&code.source, first(expr));
    let tail = &code.plain[start..];
    let mut depth = 0_i32;
    let mut before = ' ';
    for (index, c) in tail.char_indices() {
        match c {
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth -= 1,
            _ => {}
        }
        let word = !before.is_alphanumeric() && before != '_' && before != '.';
        let rest = &tail[index..];
        let stop = matches!(c, ';' | ',') || rest.starts_with("=>") || word && ends_expression(rest);
        if depth < 0 || depth == 0 && stop {
            return start..start + tail[..index].trim_end().len();
        }
        before = c;
    }
    start..start + tail.trim_end().len()
}

fn ends_expression(rest: &str) -> bool {
    ["for", "once", "per", "then", "steps", "step", "seconds", "second"].iter().any(|word| {
        rest.strip_prefix(word).is_some_and(|tail| !tail.starts_with(|c: char| c.is_alphanumeric() || c == '_'))
    })
}

/// Where a comparison that begins at `start` ends, at the end of its line at the latest.
pub(super) fn line_end(code: &Code, start: usize) -> usize {
    let tail = code.plain[start..].lines().next().unwrap_or_default();
    let mut depth = 0_i32;
    for (index, c) in tail.char_indices() {
        let rest = &tail[index..];
        match c {
            '(' | '[' => depth += 1,
            ')' | ']' => depth -= 1,
            _ => {}
        }
        let stop = ["&&", "||", "=>", ";", ",", "{", " for ", " then ", " once ", " per "]
            .iter()
            .any(|stop| rest.starts_with(stop));
        if depth < 0 || depth == 0 && stop {
            return start + tail[..index].trim_end().len();
        }
    }
    start + tail.trim_end().len()
}

/// Where a part of a condition ends: before `&&`, `||`, `for` or `=>`.
pub(super) fn part_end(code: &Code, start: usize) -> usize {
    let stops = ["&&", "||", "=>", ";", ","];
    let keyword = |tail: &str, word: &str| {
        let rest = tail.strip_prefix(char::is_whitespace).and_then(|tail| tail.trim_start().strip_prefix(word));
        rest.is_some_and(|rest| rest.starts_with(char::is_whitespace))
    };
    end(code, start, |tail| {
        stops.iter().any(|stop| tail.starts_with(stop)) || keyword(tail, "for") || keyword(tail, "once")
    })
}

/// Where a fact with its path ends.
pub(super) fn access_end(code: &Code, start: usize) -> usize {
    let part = |c: char| c.is_alphanumeric() || matches!(c, '_' | '.' | '(' | '[');
    end(code, start, |tail| !tail.starts_with(part))
}

/// Where a text ends: at the first `stop` outside of brackets, or where a bracket closes that was not opened in it.
fn end(code: &Code, start: usize, stop: impl Fn(&str) -> bool) -> usize {
    let tail = code.plain.get(start..).unwrap_or_default();
    let mut depth = 0_i32;
    for (index, c) in tail.char_indices() {
        match c {
            ')' | ']' | '}' if depth == 0 => return start + tail[..index].trim_end().len(),
            ')' | ']' | '}' => {
                depth -= 1;
                continue;
            }
            _ if depth == 0 && stop(&tail[index..]) => return start + tail[..index].trim_end().len(),
            '(' | '[' | '{' => depth += 1,
            _ => {}
        }
    }
    start + tail.trim_end().len()
}
