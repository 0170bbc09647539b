//! From the text of a script to its tree; a statement that cannot be parsed is left out, so that the rest is looked at.

use super::refused;
use super::source::Code;
use super::syntax::{Forms, written_measures};
use crate::diagnostic::{Diagnostic, Kind, Mistakes};
use crate::judge::explain;
use crate::judge::fact_table::GROUPS;
use crate::judge::sandbox::MAX_VARIABLES;
use rhai::{AST, Engine, Scope, Stmt};
use std::ops::Range;

/// The most bytes that are parsed over and over to find further mistakes, and the most times.
const MOST_BYTES: usize = 4 << 20;
const MOST_TIMES: usize = 64;
/// The most variables that a script may define, those of functions among them.
const MOST_DEFINITIONS: usize = 1024;

/// A script's tree.
#[derive(Debug)]
pub(super) struct Tree {
    pub ast: AST,
    pub known: Known,
    /// Why the parser refuses it with every name checked; nothing if it does not.
    pub refused: Option<Box<Diagnostic>>,
}

/// What is known of a script's top level.
#[derive(Debug)]
pub(super) struct Known {
    /// Names of the variables.
    pub variables: Vec<String>,
    /// Names of the measures.
    pub measures: Vec<String>,
    /// Statements that are not in the tree, since they cannot be parsed.
    pub lost: Vec<Range<usize>>,
}

/// The script's tree. Functions see the names of top-level variables as constants, so those are collected first.
///
/// # Errors
/// If nothing after a mistake can be understood.
pub(super) fn tree(engine: &mut Engine, code: &Code, mistakes: &mut Mistakes) -> Result<Tree, Diagnostic> {
    few_definitions(code)?;
    engine.set_strict_variables(false);
    let (ast, lost, text) = parsed(engine, code, mistakes)?;
    let forms = Forms::of(code);
    let variables: Vec<String> = ast.statements().iter().filter_map(variable).collect();
    engine.set_strict_variables(true);
    let mut scope = Scope::new();
    let groups = GROUPS.iter().map(|(group, _)| *group).filter(|group| !code.defines(group));
    for name in groups.chain(["facts", "calibrated"]) {
        scope.push(name, ());
    }
    if forms.success {
        scope.push("test", ()).push("untrained", ());
    }
    let measures: Vec<String> =
        written_measures(ast.statements()).iter().map(|measure| measure.name.to_owned()).collect();
    for name in &measures {
        scope.push(name.as_str(), ());
    }
    for name in code.views.all() {
        scope.push(name, ());
    }
    for name in &variables {
        scope.push(name.as_str(), ());
    }
    let (ast, refused) = match engine.compile_with_scope(&scope, text.as_ref().unwrap_or(&code.parsed)) {
        Ok(ast) => (ast, None),
        Err(error) => (ast, Some(Box::new(refused::syntax(&code.source, &error, &variables)))),
    };
    Ok(Tree { ast, known: Known { variables, measures, lost }, refused })
}

/// Checks that no more variables are defined than anyone needs: the parser compares each with all before it.
fn few_definitions(code: &Code) -> Result<(), Diagnostic> {
    let part = |c: char| c.is_alphanumeric() || c == '_';
    let mut words = code.plain.split(|c| !part(c)).filter(|word| matches!(*word, "let" | "const"));
    let Some(word) = words.nth(MOST_DEFINITIONS) else { return Ok(()) };
    let at = word.as_ptr().addr() - code.plain.as_ptr().addr();
    Err(Diagnostic::new("E-SCRIPT-LIMIT", "there are too many variables".to_owned())
        .at(&code.source, at..at + word.len(), "one too many")
        .help(format!("a script may define {MOST_DEFINITIONS}, and have {MAX_VARIABLES} at one time")))
}

/// The tree without the statements that cannot be parsed, these, and the text without them if there are any.
type Parsed = (AST, Vec<Range<usize>>, Option<String>);

fn parsed(engine: &Engine, code: &Code, mistakes: &mut Mistakes) -> Result<Parsed, Diagnostic> {
    let mut lost: Vec<Range<usize>> = Vec::new();
    let mut text = None;
    let mut times = (MOST_BYTES / code.parsed.len().max(1)).min(MOST_TIMES);
    loop {
        let error = match engine.compile(text.as_ref().unwrap_or(&code.parsed)) {
            Ok(ast) => return Ok((ast, lost, text)),
            Err(error) => error,
        };
        let mistake = refused::syntax(&code.source, &error, &[]);
        let at = explain::offset(&code.source, error.position());
        let statement = statement_around(&code.plain, at).filter(|found| !lost.contains(found));
        let Some(statement) = statement.filter(|_| times > 0 && mistake.kind() != Kind::Limit) else {
            return Err(mistake);
        };
        mistakes.add(mistake);
        lost.push(statement);
        text = Some(without(&code.parsed, &lost));
        times -= 1;
    }
}

/// The text with blanks for these bytes, one for each character: what remains keeps its lines and columns.
fn without(text: &str, lost: &[Range<usize>]) -> String {
    let is_lost = |at: usize| lost.iter().any(|bytes| bytes.contains(&at));
    text.char_indices().map(|(at, c)| if c != '\n' && is_lost(at) { ' ' } else { c }).collect()
}

/// The top-level statement around a byte, if all brackets up to its end are paired.
///
/// A bracket too many or too few changes what every later statement belongs to: then nothing after it can be trusted.
fn statement_around(plain: &str, at: usize) -> Option<Range<usize>> {
    let mut start = 0;
    let mut open = Vec::new();
    for (index, c) in plain.char_indices() {
        match c {
            '(' => open.push(')'),
            '[' => open.push(']'),
            '{' => open.push('}'),
            ')' | ']' | '}' if open.pop() != Some(c) => return None,
            _ => {}
        }
        let begins = |word: &str| {
            let rest = plain[start..].trim_start().strip_prefix(word);
            rest.is_some_and(|rest| rest.starts_with(char::is_whitespace))
        };
        let ends = open.is_empty() && (c == ';' || c == '}' && (begins("fn") || begins("private")));
        if ends && at <= index {
            return Some(start..index + 1);
        }
        if ends {
            start = index + 1;
        }
    }
    (open.is_empty() && start < plain.len()).then_some(start..plain.len())
}

fn variable(statement: &Stmt) -> Option<String> {
    match statement {
        Stmt::Var(variable, ..) => Some(variable.0.name.to_string()),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn around<'a>(text: &'a str, mark: &str) -> Option<&'a str> {
        statement_around(text, text.find(mark).unwrap()).map(|range| text[range].trim())
    }

    #[test]
    fn a_statement_ends_with_its_semicolon_and_a_function_with_its_bracket() {
        let text = "world(1);\nfn f(x) { if x { 1 } else { 2 } }\nlet a = if b { 1 } else { 2 };\nlast";
        assert_eq!(around(text, "world"), Some("world(1);"));
        assert_eq!(around(text, "else { 2 } }"), Some("fn f(x) { if x { 1 } else { 2 } }"));
        assert_eq!(around(text, "else { 2 };"), Some("let a = if b { 1 } else { 2 };"));
        assert_eq!(around(text, "last"), Some("last"));
    }

    #[test]
    fn brackets_that_are_not_paired_make_what_follows_unknown() {
        assert_eq!(around("a; b(; c;", "c"), None);
        assert_eq!(around("a; b); c;", "c"), None);
        assert_eq!(around("a; b(]); c;", "c"), None);
        assert_eq!(around("a; b(]); c;", "a"), Some("a;"));
    }
}
