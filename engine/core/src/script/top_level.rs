//! The top level of a script, run once: its set-up calls are written down, its constants found.

use super::setup::Log;
use super::source::Code;
use super::spoilt::Spoilt;
use super::stops::stop_places;
use super::tree::Tree;
use crate::diagnostic::{Diagnostic, Kind, MOST_MISTAKES, Mistakes};
use crate::judge::explain::offset;
use crate::judge::sandbox::MAX_OPERATIONS;
use crate::judge::{budget, running};
use rhai::{AST, Engine, EvalAltResult, Expr, Position, Scope, Stmt};
use std::collections::BTreeSet;

/// Runs all statements that no mistake spoils; one that fails is told, and the others run again without it.
///
/// # Errors
/// If a limit stops the script, or it cannot be told which statement failed.
pub(super) fn run(
    engine: &Engine,
    code: &Code,
    tree: &Tree,
    log: &Log,
    spoilt: &mut Spoilt<'_>,
    mistakes: &mut Mistakes,
) -> Result<Scope<'static>, Diagnostic> {
    let mut scope = Scope::new();
    if mistakes.is_empty() {
        budget::refill(MAX_OPERATIONS);
        match engine.run_ast_with_scope(&mut scope, &tree.ast) {
            Ok(()) => return Ok(scope),
            Err(mut error) => add(code, &tree.ast, &mut error, log, mistakes)?,
        }
    }
    let mut failed = BTreeSet::new();
    for _ in 0..=MOST_MISTAKES {
        spoilt.spread(mistakes);
        let sound = |number: usize| !failed.contains(&number) && !spoilt.touches_statement(number, mistakes);
        let statements = tree.ast.statements().iter().enumerate();
        let statements = statements.filter_map(|(number, statement)| match (sound(number), statement) {
            (true, statement) => Some(statement.clone()),
            (false, Stmt::Var(..)) => Some(empty(statement)),
            _ => None,
        });
        let ast = AST::new(statements.collect::<Vec<_>>(), tree.ast.shared_lib().clone());
        log.clear();
        scope.clear();
        budget::refill(MAX_OPERATIONS);
        let Err(mut error) = engine.run_ast_with_scope(&mut scope, &ast) else { return Ok(scope) };
        add(code, &tree.ast, &mut error, log, mistakes)?;
        // Where it was called from the top level, not where in a function it failed.
        let number = spoilt.statement_at(offset(&code.source, error.position()));
        if !number.is_some_and(|number| failed.insert(number)) {
            return Err(running::explain(&code.source, &error));
        }
    }
    Ok(scope)
}

fn add(
    code: &Code,
    ast: &AST,
    error: &mut EvalAltResult,
    log: &Log,
    mistakes: &mut Mistakes,
) -> Result<(), Diagnostic> {
    stop_places(ast).move_into_called(error, &code.source);
    let wrong = running::explain(&code.source, error);
    if wrong.kind() == Kind::Limit || log.is_full() {
        return Err(wrong);
    }
    mistakes.add(wrong);
    Ok(())
}

/// The definition of a variable without its value: later ones are found by counting.
fn empty(statement: &Stmt) -> Stmt {
    let mut statement = statement.clone();
    if let Stmt::Var(variable, ..) = &mut statement {
        variable.1 = Expr::Unit(Position::NONE);
    }
    statement
}
