//! A script of an older edition, written for the newest one so that it goes on to mean what it meant.
//!
//! What an edition decides is written out, and words of version 1 that have a clearer one are replaced where a constant says
//! which. Nothing else is touched: comments, order and layout stay.

use super::draft::Draft;
use super::named_body::beside;
use super::params::ParamValues;
use super::{Behaviour, source};
use crate::diagnostic::{Diagnostic, Result, SourceText, printable};
use crate::outcome::Then;
use crate::settings::Edition;
use std::ops::Range;
use std::path::Path;

/// A script before and after.
#[derive(Debug, Clone)]
pub struct Upgrade {
    /// Its text as it stands.
    pub before: SourceText,
    /// Its text for the newest edition.
    pub after: String,
    /// What was changed, a line for each.
    pub changes: Vec<String>,
}

/// One change: what goes, and what comes in its place.
type Edit = (Range<usize>, String);

/// Upgrades a script. One that says no edition is taken to be of the first, of which no script could say it.
///
/// # Errors
/// If the file is no script, or there is a mistake in it.
pub fn upgrade(path: &Path) -> Result<Upgrade> {
    let name = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let before = source::read(path)?;
    let bodies = beside(path);
    let read = |text: SourceText, edition| {
        Draft::read(&name, text, &bodies, &ParamValues::new(), edition).and_then(Draft::end)
    };
    let old = read(before.clone(), Edition::FIRST)?;
    let (mut edits, mut changes) = outcomes(&old);
    if old.edition() < Edition::NEWEST || old.place_of("edition").is_none() {
        edits.push(newest(&old, &mut changes));
    }
    edits.sort_by_key(|(span, _)| std::cmp::Reverse(span.start));
    // Places are counted behind a byte order mark.
    let (mark, text) = match before.text.strip_prefix('\u{feff}') {
        Some(text) => ("\u{feff}", text),
        None => ("", &*before.text),
    };
    let mut after = text.to_owned();
    for (span, text) in edits {
        after.replace_range(span, &if before.text.contains("\r\n") { text.replace('\n', "\r\n") } else { text });
    }
    after.insert_str(0, mark);
    // What it set and how its attempts end must be what they were.
    let new = read(SourceText::new(path, after.clone()), Edition::NEWEST)?;
    let mut settings = old.settings().clone();
    if settings.worlds.is_empty() && settings.randomise.is_empty() {
        // A word for an outcome decides how long the robot stays in one of several worlds, and nothing in one.
        settings.run.stay_steps = new.settings().run.stay_steps;
    }
    if *new.settings() != settings || new.rules().len() != old.rules().len() {
        let message = format!("'{}' cannot be upgraded by itself", printable(&path.display().to_string()));
        let help = format!(
            "write edition({}); into it, and learner(\"ttd\"); if it names no learner",
            Edition::NEWEST.number()
        );
        return Diagnostic::new("E-SCRIPT-FILE", message).help(help).fail();
    }
    Ok(Upgrade { before, after, changes })
}

/// `then recover` with a value whose sign is written: what it comes to.
fn outcomes(behaviour: &Behaviour) -> (Vec<Edit>, Vec<String>) {
    let (compiled, mut edits, mut changes) = (behaviour.compiled(), Vec::new(), Vec::new());
    let Ok(code) = source::check_text(compiled.source.clone()) else { return (edits, changes) };
    // The reward of a step is the sum over the rules that fired: those above that end nothing must not turn it.
    let (mut least, mut most) = (0.0_f64, 0.0_f64);
    for (index, rule) in compiled.rules.iter().enumerate() {
        let (below, above) = (least, most);
        let fixed = behaviour.fixed_value(index);
        if rule.then.is_none() {
            least += fixed.map_or(f64::NEG_INFINITY, |value| value.min(0.0));
            most += fixed.map_or(f64::INFINITY, |value| value.max(0.0));
        }
        if rule.then != Some(Then::Recover) {
            continue;
        }
        let Ok(value) = code.source.text[rule.value_span.clone()].trim().parse::<f64>() else { continue };
        let sure = match value {
            negative if negative < 0.0 => negative + above < 0.0,
            positive if positive > 0.0 => positive + below > 0.0,
            _ => below == 0.0 && above == 0.0,
        };
        if !sure {
            continue;
        }
        let word = match value {
            below if below < 0.0 => "fail",
            above if above > 0.0 => "goal",
            _ => "restart",
        };
        let end = code.statement(rule.value_span.end).end;
        let Some(at) = code.plain[rule.value_span.end..end].find("recover") else { continue };
        let at = rule.value_span.end + at;
        let (line, _) = code.source.position(at);
        changes.push(format!("line {line}: then recover -> then {word}, since its value is {value}"));
        edits.push((at..at + "recover".len(), word.to_owned()));
    }
    (edits, changes)
}

/// The line that says the newest edition, with what the older one decided.
fn newest(behaviour: &Behaviour, changes: &mut Vec<String>) -> Edit {
    let (number, source) = (Edition::NEWEST.number(), behaviour.source());
    let mut lines = vec![format!("edition({number});")];
    changes.push(format!("edition({number});"));
    let whence = match behaviour.place_of("edition") {
        Some(_) => "by its edition",
        None => "in edition 1, of which a script that says none is taken to be",
    };
    for (group, key, word) in behaviour.edition().defaults() {
        if behaviour.place_of(&format!("{group}.{key}")).is_none() {
            lines.push(format!("{group}(#{{ {key}: \"{word}\" }});"));
            changes.push(format!("{group}.{key} was \"{word}\" {whence}: written out"));
        }
    }
    if let Some(span) = behaviour.place_of("edition") {
        // The word of the call: up to the semicolon it is this call.
        let end = source.text[span.start..].find(';').map_or(span.end, |at| span.start + at + 1);
        return (span.start..end, lines.join(" "));
    }
    let code = source::check_text(source.clone());
    let start = code.map_or(0, |code| code.plain.len() - code.plain.trim_start().len());
    (start..start, lines.join("\n") + "\n")
}
