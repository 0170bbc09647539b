//! Strangers' text at the border: no character that controls a terminal, turns a line around or begins a formula leaves the
//! engine as it is.

use std::borrow::Cow;
use std::fmt::Write;

/// Whether a character is not seen and does something: the control characters of C0 and C1, and those that set the direction
/// of text or end a line otherwise.
#[must_use]
pub fn is_hidden(c: char) -> bool {
    let turns = matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    c.is_control() || turns || matches!(c, '\u{2028}' | '\u{2029}')
}

/// Text on its way to a terminal: lines, tabs and the colours that the engine itself writes (`ESC [ numbers m`) stay, every
/// other hidden character is written out, as `\u{9b}`.
#[must_use]
pub fn for_terminal(text: &str) -> Cow<'_, str> {
    let plain = |c: char| matches!(c, '\n' | '\t');
    if !text.chars().any(|c| is_hidden(c) && !plain(c)) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len() + 16);
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let colour = colour_of(rest);
        let (taken, after) = rest.split_at(colour.unwrap_or(c.len_utf8()));
        // The end of a line of another system.
        let ends = c == '\r' && after.starts_with('\n');
        if colour.is_some() || plain(c) || !is_hidden(c) {
            out.push_str(taken);
        } else if !ends {
            out.extend(c.escape_unicode());
        }
        rest = after;
    }
    Cow::Owned(out)
}

/// The bytes of a colour sequence at the beginning of a text.
fn colour_of(text: &str) -> Option<usize> {
    let numbers = text.strip_prefix("\u{1b}[")?;
    let length = numbers.find(|c: char| !(c.is_ascii_digit() || c == ';'))?;
    (length <= 20 && numbers[length..].starts_with('m')).then_some(2 + length + 1)
}

/// A JSON document on its way to a terminal: hidden characters stand in its texts only, where `\u009b` says the same.
#[must_use]
pub fn for_json(document: &str) -> Cow<'_, str> {
    let hides = |c: char| is_hidden(c) && !matches!(c, '\n' | '\t' | '\r');
    if !document.chars().any(hides) {
        return Cow::Borrowed(document);
    }
    let mut out = String::with_capacity(document.len() + 16);
    for c in document.chars() {
        if hides(c) {
            // Writing into a String cannot fail.
            let _ = write!(out, "\\u{:04x}", u32::from(c));
        } else {
            out.push(c);
        }
    }
    Cow::Owned(out)
}

/// A text as one field of comma-separated values (RFC 4180): hidden characters written out, and an apostrophe before what a
/// spreadsheet would take for a formula.
#[must_use]
pub fn for_table(field: &str) -> String {
    let mut out = String::with_capacity(field.len() + 2);
    if field.starts_with(['=', '+', '-', '@', '\t', '\r', '＝', '＋', '－', '＠']) {
        out.push('\'');
    }
    for c in field.chars() {
        if is_hidden(c) { out.extend(c.escape_unicode()) } else { out.push(c) }
    }
    if out.contains([',', '"', ';']) { format!("\"{}\"", out.replace('"', "\"\"")) } else { out }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_lines_tabs_and_colours_reach_a_terminal() {
        assert_eq!(for_terminal("a\tb\r\nc"), "a\tb\nc");
        assert_eq!(for_terminal("\u{1b}[1;31mred\u{1b}[0m"), "\u{1b}[1;31mred\u{1b}[0m");
        assert_eq!(for_terminal("\u{1b}[2J\u{1b}]0;x\u{7}"), "\\u{1b}[2J\\u{1b}]0;x\\u{7}");
        assert_eq!(for_terminal("\u{9b}31m\u{202e}\r\u{1b}"), "\\u{9b}31m\\u{202e}\\u{d}\\u{1b}");
    }

    #[test]
    fn a_document_says_the_same_without_hidden_characters() {
        let words = "a\u{9b}b\u{202e}c\u{85}";
        let document = for_json(&serde_json::to_string(words).unwrap_or_default()).into_owned();
        assert_eq!(document, "\"a\\u009bb\\u202ec\\u0085\"");
        assert_eq!(serde_json::from_str::<String>(&document).unwrap(), words);
    }

    #[test]
    fn a_field_begins_no_formula_and_no_other_field() {
        assert_eq!(for_table("=cmd|' /C calc'!A0"), "'=cmd|' /C calc'!A0");
        assert_eq!([for_table("-1"), for_table("@x"), for_table("\tx")], ["'-1", "'@x", "'\\u{9}x"]);
        assert_eq!(for_table("a,b\"c\nd"), "\"a,b\"\"c\\u{a}d\"");
        assert_eq!(for_table("contact"), "contact");
    }
}
