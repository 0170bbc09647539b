//! What must not be relied upon after a mistake: names that it defines, and all that uses them.
//!
//! Whatever depends on a mistake is not looked at: it would only be told twice what is wrong once. So much is left out
//! rather than too little; what is left out is told after the next save.

use super::positions::{body_end, first};
use super::setup_table::SETUP;
use super::source::Code;
use super::syntax::is_rule;
use super::tree::Known;
use crate::diagnostic::Mistakes;
use crate::judge::explain;
use rhai::{AST, Stmt};
use std::collections::BTreeSet;
use std::ops::Range;

/// How often all that uses a spoilt name is looked for, each time with the names found before.
const MOST_ROUNDS: usize = 16;

/// Names that stand for nothing certain.
#[derive(Debug, Default)]
pub(super) struct Spoilt {
    names: BTreeSet<String>,
    lost: Vec<Range<usize>>,
    /// The bytes of each top-level statement.
    statements: Vec<Range<usize>>,
}

impl Spoilt {
    /// What the mistakes until now spoil, beside the names that nothing defines.
    pub(super) fn new(
        code: &Code,
        ast: &AST,
        known: &Known,
        undefined: &BTreeSet<String>,
        mistakes: &Mistakes,
    ) -> Self {
        let mut spoilt = Self::default();
        if !mistakes.is_empty() {
            spoilt.names.extend(undefined.iter().cloned());
            spoilt.lost.clone_from(&known.lost);
            spoilt.statements = statements(code, ast.statements());
            spoilt.spread(code, ast, known, mistakes);
        }
        spoilt
    }

    /// Whether a mistake, or something that one spoils, stands in these bytes.
    pub(super) fn touches(&self, code: &Code, bytes: &Range<usize>, mistakes: &Mistakes) -> bool {
        !mistakes.is_empty()
            && (mistakes.within(&code.source, bytes)
                || !self.names.is_empty() && words(&code.plain[bytes.clone()]).any(|word| self.names.contains(word)))
    }

    /// The same for the top-level statement with this number.
    pub(super) fn touches_statement(&self, code: &Code, number: usize, mistakes: &Mistakes) -> bool {
        self.statements.get(number).is_some_and(|bytes| self.touches(code, bytes, mistakes))
    }

    /// The number of the top-level statement that holds a byte.
    pub(super) fn statement_at(&self, at: usize) -> Option<usize> {
        self.statements.iter().position(|bytes| bytes.contains(&at))
    }

    /// Adds a name.
    pub(super) fn insert(&mut self, name: &str) {
        self.names.insert(name.to_owned());
    }

    /// Whether it is one of these names.
    pub(super) fn has(&self, name: &str) -> bool {
        self.names.contains(name)
    }

    /// The set-up calls that are not carried out.
    pub(super) fn setup_calls(&self, code: &Code, mistakes: &Mistakes) -> Vec<&'static str> {
        if mistakes.is_empty() {
            return Vec::new();
        }
        let calls = |bytes: &Range<usize>| {
            let text = &code.plain[bytes.clone()];
            // `laser` is facts too; a call has a bracket.
            let is_call = |word: &&str| text[end_of(text, word)..].trim_start().starts_with('(');
            let words: BTreeSet<&str> = words(text).filter(is_call).collect();
            SETUP.iter().map(|row| row.name).filter(move |name| words.contains(name)).collect::<Vec<_>>()
        };
        let spoilt = self.statements.iter().filter(|bytes| self.touches(code, bytes, mistakes));
        self.lost.iter().chain(spoilt).flat_map(calls).collect()
    }

    fn spread(&mut self, code: &Code, ast: &AST, known: &Known, mistakes: &Mistakes) {
        for bytes in &known.lost {
            let mut before = "";
            for word in words(&code.plain[bytes.clone()]) {
                if matches!(before, "let" | "const" | "fn") {
                    self.names.insert(word.to_owned());
                }
                before = word;
            }
        }
        let functions: Vec<(&str, Range<usize>)> = ast
            .iter_functions()
            .filter_map(|function| {
                let name = code.function(function.name)?;
                Some((function.name, name.start..body_end(&code.plain, name.start)))
            })
            .collect();
        let variables: BTreeSet<&str> = known.variables.iter().map(String::as_str).collect();
        for _ in 0..MOST_ROUNDS {
            let count = self.names.len();
            for (name, bytes) in &functions {
                if self.touches(code, bytes, mistakes) {
                    self.insert(name);
                }
            }
            for (number, statement) in ast.statements().iter().enumerate() {
                if self.touches_statement(code, number, mistakes) {
                    self.spread_from(code, number, statement, &variables);
                }
            }
            if self.names.contains("calibrate") {
                self.insert("calibrated");
            }
            if self.names.len() == count {
                return;
            }
        }
        // Nobody writes so: what is still uncertain is not worth the time.
        let functions = functions.iter().map(|(name, _)| *name);
        self.names.extend(variables.into_iter().chain(functions).chain(["calibrated"]).map(str::to_owned));
    }

    fn spread_from(&mut self, code: &Code, number: usize, statement: &Stmt, variables: &BTreeSet<&str>) {
        match statement {
            Stmt::FnCall(call, _) if SETUP.iter().any(|row| row.name == call.name) => {}
            Stmt::Var(variable, ..) => self.insert(&variable.0.name),
            rule if is_rule(rule) => {}
            // It may change any variable that it names.
            _ => {
                let text = &code.plain[self.statements[number].clone()];
                self.names.extend(words(text).filter(|word| variables.contains(word)).map(str::to_owned));
            }
        }
    }
}

/// The bytes of each statement: to its `;`, or to the next one.
fn statements(code: &Code, statements: &[Stmt]) -> Vec<Range<usize>> {
    let start = |statement: &Stmt| {
        let position = match statement {
            Stmt::Assignment(assignment) => first(&assignment.1.lhs),
            Stmt::Expr(expr) => first(expr),
            other => other.position(),
        };
        explain::offset(&code.source, position)
    };
    let starts: Vec<usize> = statements.iter().map(start).collect();
    let ends = starts.iter().skip(1).copied().chain([code.plain.len()]);
    starts.iter().zip(ends).map(|(&start, end)| code.statement_before(start, end.max(start))).collect()
}

/// The names in a text that do not stand behind a dot.
fn words(text: &str) -> impl Iterator<Item = &str> {
    let part = |c: char| c.is_alphanumeric() || c == '_';
    text.split(move |c| !part(c)).filter(move |word| {
        let at = end_of(text, word) - word.len();
        !word.is_empty() && (!text[..at].ends_with('.') || text[..at].ends_with(".."))
    })
}

/// Where a part of a text ends in it.
fn end_of(text: &str, part: &str) -> usize {
    part.as_ptr().addr() - text.as_ptr().addr() + part.len()
}
