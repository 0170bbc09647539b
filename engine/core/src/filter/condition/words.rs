//! The words of a condition: numbers, names and signs, each with its place.

use std::ops::Range;

use super::ConditionError;
use crate::diagnostic::printable;

/// What stands at a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Word<'a> {
    Number(f32),
    Name(&'a str),
    Sign(&'static str),
    End,
}

/// Signs, the longer ones first.
const SIGNS: [&str; 18] =
    ["&&", "||", "==", "!=", "<=", ">=", "**", "<", ">", "+", "-", "*", "/", "(", ")", "!", ",", "="];

/// The words of a text, the last one its end.
///
/// # Errors
/// If a character or a number is none of a condition's.
pub(super) fn words(text: &str) -> Result<Vec<(Word<'_>, Range<usize>)>, ConditionError> {
    let mut words = Vec::new();
    let mut at = 0;
    while let Some(first) = text[at..].chars().next() {
        let tail = &text[at..];
        let (word, length) = if first.is_whitespace() {
            at += first.len_utf8();
            continue;
        } else if first.is_ascii_digit() || first == '.' {
            number(tail, at)?
        } else if first.is_alphabetic() || first == '_' {
            let length = tail.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(tail.len());
            (Word::Name(&tail[..length]), length)
        } else if let Some(sign) = SIGNS.iter().find(|sign| tail.starts_with(**sign)) {
            (Word::Sign(sign), sign.len())
        } else {
            let help = match first {
                '&' => "'and' is written &&",
                '|' => "'or' is written ||",
                _ => "a condition has numbers, names, + - * /, < <= > >= == !=, && || ! and parentheses",
            };
            let message = format!("'{}' means nothing in a condition over pixels", printable(&first.to_string()));
            return Err(ConditionError::new(message, "found this", help, at..at + first.len_utf8()));
        };
        words.push((word, at..at + length));
        at += length;
    }
    words.push((Word::End, text.len()..text.len()));
    Ok(words)
}

fn number(tail: &str, at: usize) -> Result<(Word<'_>, usize), ConditionError> {
    let length = tail.find(|c: char| !c.is_alphanumeric() && c != '.' && c != '_').unwrap_or(tail.len());
    match tail[..length].parse::<f32>() {
        Ok(number) if number.is_finite() => Ok((Word::Number(number), length)),
        _ => {
            let message = format!("'{}' is no number", printable(&tail[..length]));
            let help = "write digits and at most one point, without a unit: 60, 1.5";
            Err(ConditionError::new(message, "found this", help, at..at + length))
        }
    }
}
