//! A rule, ready to be judged: when it holds, for how long, and what it is worth.

use super::expression::{Flag, Number};
use super::readings::Part;
use crate::diagnostic::printable;
use crate::outcome::Then;
use rhai::AST;
use std::collections::BTreeSet;
use std::ops::Range;

/// A rule as the user wrote it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RuleText {
    /// Its name; `reward` for the function.
    pub name: String,
    /// The line where it begins, from 1.
    pub line: usize,
    /// Its text.
    pub text: String,
}

/// How long a condition must hold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Persistence {
    Steps(u32),
    Seconds(f64),
}

impl Persistence {
    /// The number of steps, at least 1.
    pub(crate) fn steps(self, period_s: f64) -> u32 {
        match self {
            Self::Steps(steps) => steps,
            // 0.9 / 0.3 is a little more than 3 in floating point.
            Self::Seconds(seconds) => ((seconds / period_s - 1e-9).ceil().max(1.0)) as u32,
        }
    }
}

/// A condition or a value: native, or left to the interpreter.
#[derive(Debug)]
pub(crate) enum Clause<T> {
    Native(T),
    Script(ScriptClause),
}

/// An expression for the interpreter.
#[derive(Debug)]
pub(crate) struct ScriptClause {
    pub ast: AST,
    /// How many top-level variables it was parsed after: the parser counts variables from the last one.
    pub variables: usize,
    /// The facts that it reads.
    pub roots: BTreeSet<String>,
}

/// A rule, ready to be judged.
#[derive(Debug)]
pub(crate) struct CompiledRule {
    pub text: RuleText,
    pub condition: Clause<Flag>,
    pub condition_span: Range<usize>,
    pub persistence: Persistence,
    pub value: Clause<Number>,
    pub value_span: Range<usize>,
    pub then: Option<Then>,
    /// Where the next attempt begins, and where that is written.
    pub to_place: Option<(String, Range<usize>)>,
    /// The stages in which it is judged, a bit for each; nothing for all.
    pub stages: Option<u32>,
    /// Whether it fires once each time its condition comes true.
    pub once: bool,
    /// Whether its value is for one second, not for one step.
    pub per_second: bool,
    /// The stage that it leads to.
    pub to_stage: Option<usize>,
    /// What the condition reads.
    pub parts: Vec<Part>,
}

impl CompiledRule {
    /// What it adds whenever it fires; nothing if that depends on the step.
    pub(crate) fn fixed_value(&self) -> Option<f64> {
        match self.value {
            Clause::Native(Number::Constant(value)) => Some(value),
            _ => None,
        }
    }

    /// Whether it is judged in a stage.
    pub(crate) fn is_in(&self, stage: usize) -> bool {
        self.stages.is_none_or(|stages| stages & (1 << stage) != 0)
    }

    /// `rule "too close"`, safe for a terminal.
    pub(crate) fn shown(&self) -> String {
        format!("rule \"{}\"", printable(&self.text.name))
    }
}
