//! What the rules and functions of a script cost the interpreter, and the line that is dear.

use super::Behaviour;
use super::rehearsal::place;
use crate::diagnostic::Diagnostic;
use crate::judge::budget;
use crate::judge::evaluate::Present;
use crate::judge::rule::{Clause, CompiledRule};
use crate::judge::sandbox::MAX_OPERATIONS;
use crate::settings::Settings;
use std::ops::Range;

/// At so many places of its work it is asked in which line a rule is.
const SAMPLES: u64 = 16;

/// A rule or function that takes much of what a step may cost.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Dear {
    /// The bytes of the script where most of the work is done.
    pub span: Range<usize>,
    /// The operations of one step.
    pub operations: u64,
    /// The operations that all rules of a step may take together.
    pub most: u64,
}

impl Behaviour {
    /// The rules, and last `fn reward`, that take at least so many operations of a step, each at the line in which it spends
    /// most of them; on an empty place or in a tight corner, whichever is dearer. What never runs in the interpreter costs
    /// nothing.
    #[must_use]
    pub fn dear_lines(&self, settings: &Settings, at_least: u64) -> Vec<Dear> {
        let mut judge = self.unchecked_judge(settings.run.period_s, settings.laser.fan());
        let mut dear: Vec<Dear> = Vec::new();
        for cornered in [false, true] {
            place(&mut judge, settings, cornered);
            if judge.calibrate().is_err() {
                return dear;
            }
            for clause in clauses(judge.present()) {
                let (operations, _) = spent(judge.present(), &clause, MAX_OPERATIONS);
                if operations < at_least {
                    continue;
                }
                let Some(span) = dearest_place(judge.present(), &clause, operations) else { continue };
                match dear.iter_mut().find(|known| known.span == span) {
                    Some(known) => known.operations = known.operations.max(operations),
                    None => dear.push(Dear { span, operations, most: MAX_OPERATIONS }),
                }
            }
        }
        budget::refill(MAX_OPERATIONS);
        dear.sort_by_key(|dear| dear.span.start);
        dear
    }
}

/// What the interpreter is asked in a step.
enum Asked<'a> {
    Condition(&'a CompiledRule),
    Value(&'a CompiledRule),
    Reward(&'a Range<usize>),
}

fn clauses(present: &Present) -> Vec<Asked<'_>> {
    let mut asked = Vec::new();
    for rule in &present.compiled.rules {
        if matches!(rule.condition, Clause::Script(_)) {
            asked.push(Asked::Condition(rule));
        }
        if matches!(rule.value, Clause::Script(_)) {
            asked.push(Asked::Value(rule));
        }
    }
    asked.extend(present.compiled.reward.as_ref().map(Asked::Reward));
    asked
}

/// The operations that it took of so many, and where it stopped.
fn spent(present: &Present, asked: &Asked<'_>, operations: u64) -> (u64, Option<Box<Diagnostic>>) {
    budget::refill(operations);
    let failed = match asked {
        Asked::Condition(rule) => present.condition(rule).err(),
        Asked::Value(rule) => present.value(rule).err(),
        Asked::Reward(span) => present.reward(span).err(),
    };
    (operations - budget::left(), failed)
}

/// Where it is most often when it is stopped after one part of its work, after two, and so on.
fn dearest_place(present: &Present, asked: &Asked<'_>, operations: u64) -> Option<Range<usize>> {
    let source = &present.compiled.source;
    let mut seen: Vec<(usize, Range<usize>, usize)> = Vec::new();
    for sample in 1..=SAMPLES {
        let (_, stopped) = spent(present, asked, operations * sample / (SAMPLES + 1));
        let Some(place) = stopped.and_then(|stopped| stopped.place) else { continue };
        let (line, _) = source.position(place.span.start);
        match seen.iter_mut().find(|(known, ..)| *known == line) {
            Some((_, _, times)) => *times += 1,
            None => seen.push((line, place.span.clone(), 1)),
        }
    }
    // Of lines that are as dear as one another the first.
    let most = seen.iter().map(|(_, _, times)| *times).max()?;
    seen.into_iter().find(|(_, _, times)| *times == most).map(|(_, span, _)| span)
}
