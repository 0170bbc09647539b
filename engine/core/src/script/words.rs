//! Words of other languages where the parser gave up, with what is written here.

use crate::diagnostic::{Diagnostic, SourceText, nearest_name};
use crate::outcome::Then;
use std::ops::Range;

/// What other languages write, and what is written here.
const OPERATORS: &[(&str, &str)] = &[("and", "&&"), ("or", "||"), ("not", "!"), ("is", "=="), ("elif", "else if")];

/// Units that people write behind a number: how many of ours one is, and what ours is called.
const UNITS: &[(&str, f64, &str)] = &[
    ("mm", 0.001, "metres"),
    ("cm", 0.01, "metres"),
    ("m", 1.0, "metres"),
    ("km", 1000.0, "metres"),
    ("deg", std::f64::consts::PI / 180.0, "radians"),
    ("degrees", std::f64::consts::PI / 180.0, "radians"),
    ("rad", 1.0, "radians"),
    ("ms", 0.001, "seconds"),
    ("s", 1.0, "seconds"),
    ("sec", 1.0, "seconds"),
    ("min", 60.0, "seconds"),
];

/// What begins a statement with a name behind it.
const NAMED: &[&str] = &["rule", "success"];

/// How an attempt can end: words that people write in the place of `rule`.
const ENDS: &[&str] = &["goal", "fail", "failure", "restart", "recover", "penalty"];

/// What is wrong at a byte at which the parser gave up, if a word of another language stands there or just before it.
pub(super) fn foreign_word(source: &SourceText, at: usize) -> Option<Diagnostic> {
    let here = source.word_at(at);
    let before = word_before(&source.text, at);
    operator(source, &here)
        .or_else(|| operator(source, &before))
        .or_else(|| unit(source, &before, &here))
        .or_else(|| end_as_rule(source, &before, &here))
        .or_else(|| statement(source, &before, &here))
        .or_else(|| then(source, &here))
        .or_else(|| recovery(source, &before, &here))
}

fn wrong(source: &SourceText, at: &Range<usize>, message: String, label: &str, help: String) -> Diagnostic {
    Diagnostic::new("E-SCRIPT-WORD", message).at(source, at.clone(), label).help(help)
}

fn operator(source: &SourceText, word: &Range<usize>) -> Option<Diagnostic> {
    let found = &source.text[word.clone()];
    let (_, ours) = OPERATORS.iter().find(|(theirs, _)| theirs.eq_ignore_ascii_case(found))?;
    Some(wrong(source, word, format!("'{found}' is written '{ours}'"), "not a word here", format!("write {ours}")))
}

fn unit(source: &SourceText, number: &Range<usize>, word: &Range<usize>) -> Option<Diagnostic> {
    let text = &source.text;
    let unit = &text[word.clone()];
    // The digits before a point belong to the number.
    let whole = match text[..number.start].strip_suffix('.') {
        Some(rest) => word_before(text, rest.len()),
        None => number.clone(),
    };
    let number = whole.start.min(number.start)..number.end;
    let written = &text[number.clone()];
    let value: f64 = written.parse().ok().filter(|value: &f64| value.is_finite())?;
    let (_, factor, ours) = UNITS.iter().find(|(theirs, ..)| *theirs == unit)?;
    let converted = (value * factor * 1e6).round() / 1e6;
    let is_time = &text[word_before(text, number.start)] == "for";
    let help = match (*ours, is_time) {
        ("seconds", true) => format!("write for {converted} seconds"),
        ("radians", _) if unit.starts_with("deg") => {
            format!("write {written} for a fact whose name ends in _deg, {converted:?} for one in radians")
        }
        _ => format!("write {converted:?} ({ours})"),
    };
    let message = if is_time {
        format!("a time is in steps or seconds, not '{unit}'")
    } else {
        "a number has no unit here".to_owned()
    };
    Some(wrong(source, word, message, "not a word here", help))
}

/// `goal "x" when ...` for a rule.
fn end_as_rule(source: &SourceText, word: &Range<usize>, next: &Range<usize>) -> Option<Diagnostic> {
    let (text, found) = (&source.text, &source.text[word.clone()]);
    let is_first = !text[..word.start].trim_end().ends_with("then");
    let quoted = text[next.clone()].starts_with('"') && is_first && ENDS.contains(&found);
    if !quoted {
        return None;
    }
    let name = text[next.start + 1..].split(['"', '\n']).next().unwrap_or_default();
    let (value, then) = match found {
        "goal" => ("1", "goal"),
        "restart" => ("0", "restart"),
        "recover" => ("-1", "recover"),
        _ => ("-1", "fail"),
    };
    let help = format!("write rule \"{name}\" when CONDITION => {value} then {then};");
    Some(wrong(source, word, format!("'{found}' stands at the end of a rule"), "no statement begins so", help))
}

/// `rul "a" when ...`, or `success when ...`: a word that begins a statement, misspelt or without a name behind it.
fn statement(source: &SourceText, word: &Range<usize>, next: &Range<usize>) -> Option<Diagnostic> {
    let (text, found) = (&source.text, &source.text[word.clone()]);
    let begins = text[..word.start].trim_end();
    if !(begins.is_empty() || begins.ends_with([';', '}']) || text[begins.len()..word.start].contains('\n')) {
        return None;
    }
    if text[next.clone()] == *"when" && NAMED.contains(&found) {
        let help = format!("write {found} \"name\" when ...");
        return Some(wrong(source, next, format!("after '{found}' comes its name"), "no name", help));
    }
    let named = text[next.start..].starts_with('"');
    let near = nearest_name(found, NAMED.iter().copied()).filter(|near| named && *near != found)?;
    Some(wrong(
        source,
        word,
        format!("no statement begins with '{found}'"),
        "not known",
        format!("did you mean '{near}'?"),
    ))
}

/// `-1 the recover`, `-1 recover`: the end of a rule without its `then`.
fn then(source: &SourceText, word: &Range<usize>) -> Option<Diagnostic> {
    let (text, found) = (&source.text, &source.text[word.clone()]);
    let ends = |word: &str| Then::of(word).is_some();
    if ends(found) {
        let help = format!("write then {found}");
        return Some(wrong(source, word, format!("before '{found}' comes 'then'"), "not here", help));
    }
    let next: String = text[word.end..].trim_start().chars().take_while(|c| c.is_alphanumeric()).collect();
    let near = nearest_name(found, ["then"]).filter(|near| ends(&next) && *near != found)?;
    Some(wrong(source, word, format!("'{found}' has no meaning here"), "not known", format!("did you mean '{near}'?")))
}

/// `then recover("start")`.
fn recovery(source: &SourceText, word: &Range<usize>, next: &Range<usize>) -> Option<Diagnostic> {
    let text = &source.text;
    let recovers = text[word.clone()] == *"recover" && text[..word.start].trim_end().ends_with("then");
    if !recovers || !text[next.clone()].starts_with('(') {
        return None;
    }
    let argument = text[next.end..].split(')').next().unwrap_or_default().trim();
    let place = if argument.starts_with('"') { argument } else { "\"nearest\"" };
    let help = format!("write 'then recover', and at the top of the script recovery({place});");
    Some(wrong(source, next, "'then recover' takes no argument".to_owned(), "not here", help))
}

/// The bytes of the word that ends before a byte, blanks between them left out.
fn word_before(text: &str, at: usize) -> Range<usize> {
    let end = text[..at].trim_end().len();
    let word = text[..end].chars().rev().take_while(|c| c.is_alphanumeric() || *c == '_');
    end - word.map(char::len_utf8).sum::<usize>()..end
}
