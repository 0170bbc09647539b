//! What must not be relied upon after a mistake: names that it defines, and all that uses them.
//!
//! Whatever depends on a mistake is not looked at: it would only be told twice what is wrong once. So much is left out
//! rather than too little; what is left out is told after the next save.

use super::positions::{body_end, first};
use super::setup_table::SETUP;
use super::source::Code;
use super::syntax::is_form;
use super::tree::Tree;
use crate::diagnostic::Mistakes;
use crate::judge::explain::offset;
use rhai::Stmt;
use std::collections::BTreeSet;
use std::ops::Range;

/// How often all that uses a spoilt name is looked for, each time with the names found before.
const MOST_ROUNDS: usize = 16;

/// Names that stand for nothing certain: none at first, and more with each stage that finds mistakes.
#[derive(Debug)]
pub(super) struct Spoilt<'a> {
    code: &'a Code,
    names: BTreeSet<String>,
    /// The bytes of what could not be parsed.
    lost: Vec<Range<usize>>,
    /// The bytes of each top-level statement, and what it defines.
    statements: Vec<(Range<usize>, Defines)>,
    /// The functions with their bytes, from the name to the last bracket.
    functions: Vec<(String, Range<usize>)>,
    /// The names of the top-level variables.
    variables: BTreeSet<String>,
}

/// What a mistake in a top-level statement leaves undefined.
#[derive(Debug)]
enum Defines {
    /// Nothing that has a name: a set-up call, a rule.
    Nothing,
    /// One variable.
    Variable(String),
    /// It may change any variable that it names.
    Anything,
}

impl<'a> Spoilt<'a> {
    /// Of a script in which nothing is known to be wrong, but for what could not be parsed.
    pub(super) fn new(code: &'a Code, tree: &Tree) -> Self {
        let functions = tree.ast.iter_functions().filter_map(|function| {
            let name = code.function(function.name)?;
            Some((function.name.to_owned(), name.start..body_end(&code.plain, name.start)))
        });
        let lost = tree.known.lost.clone();
        Self {
            code,
            names: lost.iter().flat_map(|bytes| defined_in(&code.plain[bytes.clone()])).collect(),
            lost,
            statements: statements(code, tree.ast.statements()),
            functions: functions.collect(),
            variables: tree.known.variables.iter().cloned().collect(),
        }
    }

    /// Whether a mistake, or something that one spoils, stands in these bytes.
    pub(super) fn touches(&self, bytes: &Range<usize>, mistakes: &Mistakes) -> bool {
        let names_one = || words(&self.code.plain[bytes.clone()]).any(|word| self.names.contains(word));
        !mistakes.is_empty() && (mistakes.within(&self.code.source, bytes) || !self.names.is_empty() && names_one())
    }

    /// Whether a mistake, or something that one spoils, stands in the top-level statement with this number.
    pub(super) fn touches_statement(&self, number: usize, mistakes: &Mistakes) -> bool {
        self.statements.get(number).is_some_and(|(bytes, _)| self.touches(bytes, mistakes))
    }

    /// The number of the top-level statement that holds a byte.
    pub(super) fn statement_at(&self, at: usize) -> Option<usize> {
        self.statements.iter().position(|(bytes, _)| bytes.contains(&at))
    }

    /// Adds a name.
    pub(super) fn insert(&mut self, name: impl Into<String>) {
        self.names.insert(name.into());
    }

    /// Whether it is one of these names.
    pub(super) fn has(&self, name: &str) -> bool {
        self.names.contains(name)
    }

    /// The set-up calls that are not carried out.
    pub(super) fn setup_calls(&self, mistakes: &Mistakes) -> Vec<&'static str> {
        let calls = |bytes: &Range<usize>| {
            let text = &self.code.plain[bytes.clone()];
            // `laser` is facts too; a call has a bracket.
            let is_call = |word: &&str| text[end_of(text, word)..].trim_start().starts_with('(');
            let words: BTreeSet<&str> = words(text).filter(is_call).collect();
            SETUP.iter().map(|row| row.name).filter(move |name| words.contains(name)).collect::<Vec<_>>()
        };
        let statements = self.statements.iter().map(|(bytes, _)| bytes);
        let spoilt = statements.filter(|bytes| self.touches(bytes, mistakes));
        self.lost.iter().chain(spoilt).flat_map(calls).collect()
    }

    /// Adds the names that the mistakes until now spoil, and all that use them.
    pub(super) fn spread(&mut self, mistakes: &Mistakes) {
        if mistakes.is_empty() {
            return;
        }
        for _ in 0..MOST_ROUNDS {
            let count = self.names.len();
            for number in 0..self.functions.len() {
                if self.touches(&self.functions[number].1, mistakes) {
                    self.insert(self.functions[number].0.clone());
                }
            }
            for number in 0..self.statements.len() {
                if self.touches_statement(number, mistakes) {
                    self.names.extend(self.defined_by(number));
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
        let functions = self.functions.iter().map(|(name, _)| name.clone());
        self.names.extend(self.variables.iter().cloned().chain(functions).chain(["calibrated".to_owned()]));
    }

    fn defined_by(&self, number: usize) -> Vec<String> {
        let (bytes, defines) = &self.statements[number];
        match defines {
            Defines::Nothing => Vec::new(),
            Defines::Variable(name) => vec![name.clone()],
            Defines::Anything => {
                let named = words(&self.code.plain[bytes.clone()]);
                named.filter(|word| self.variables.contains(*word)).map(str::to_owned).collect()
            }
        }
    }
}

/// The names that a text defines which cannot be parsed.
fn defined_in(text: &str) -> Vec<String> {
    let (names, after) = (words(text), words(text).skip(1));
    names
        .zip(after)
        .filter(|(before, _)| matches!(*before, "let" | "const" | "fn"))
        .map(|(_, name)| name.to_owned())
        .collect()
}

/// The bytes of each statement, to its `;` or to the next one, and what it defines.
fn statements(code: &Code, statements: &[Stmt]) -> Vec<(Range<usize>, Defines)> {
    let start = |statement: &Stmt| {
        let position = match statement {
            Stmt::Assignment(assignment) => first(&assignment.1.lhs),
            Stmt::Expr(expr) => first(expr),
            other => other.position(),
        };
        offset(&code.source, position)
    };
    let defines = |statement: &Stmt| match statement {
        Stmt::FnCall(call, _) if SETUP.iter().any(|row| row.name == call.name) => Defines::Nothing,
        Stmt::Var(variable, ..) => Defines::Variable(variable.0.name.to_string()),
        form if is_form(form) => Defines::Nothing,
        _ => Defines::Anything,
    };
    let starts: Vec<usize> = statements.iter().map(start).collect();
    let ends = starts.iter().skip(1).copied().chain([code.plain.len()]);
    let bytes = starts.iter().zip(ends).map(|(&start, end)| code.statement_before(start, end.max(start)));
    bytes.zip(statements.iter().map(defines)).collect()
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
