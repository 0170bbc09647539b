//! A script that a limit stopped: what is said of it, and the line at which it stopped.

use super::explain::offset;
use super::sandbox;
use crate::diagnostic::SourceText;
use rhai::{AST, ASTNode, Dynamic, Engine, EvalAltResult, Scope, Stmt};

/// What stopped a script, if a limit did, and what to look for.
pub(crate) fn stopped(error: &EvalAltResult) -> Option<(String, &'static str)> {
    use EvalAltResult as E;
    Some(match error {
        E::ErrorTooManyOperations(_) => (
            format!("the script was stopped after {} operations", sandbox::MAX_OPERATIONS),
            "look for a loop that does not end; a step has a handful of operations to spend",
        ),
        E::ErrorStackOverflow(_) => (
            format!("functions call one another too deep: at most {}", sandbox::MAX_CALL_LEVELS),
            "look for a function that calls itself",
        ),
        E::ErrorDataTooLarge(what, _) => {
            let (what, most, unit) = match what.to_lowercase() {
                what if what.contains("string") => ("a text", sandbox::MAX_TEXT_BYTES, "bytes"),
                what if what.contains("map") => ("a map", sandbox::MAX_MAP, "keys"),
                _ => ("an array", sandbox::MAX_ARRAY, "values"),
            };
            let message = format!("{what} has grown too large: at most {most} {unit}");
            (message, "look for a loop that makes it longer each time")
        }
        E::ErrorTooManyVariables(_) => {
            (format!("there are too many variables: at most {}", sandbox::MAX_VARIABLES), "look for a `let` in a loop")
        }
        _ => return None,
    })
}

/// The same failure at the line where a limit stopped `function` on the facts.
///
/// The interpreter forgets the line on its way out of a function, and keeps it at the top level: the body is run again as one.
pub(crate) fn placed_in(
    error: Box<EvalAltResult>,
    engine: &Engine,
    ast: &AST,
    function: &str,
    facts: impl Into<Dynamic>,
) -> Box<EvalAltResult> {
    let Some(argument) = ast.iter_functions().find(|known| known.name == function && known.params.len() == 1) else {
        return error;
    };
    if stopped(&error).is_none() {
        return error;
    }
    let body = AST::new(body(ast, function), ast.shared_lib().clone());
    let mut scope = Scope::new();
    scope.push_dynamic(argument.params[0], facts.into());
    match engine.eval_ast_with_scope::<Dynamic>(&mut scope, &body) {
        Err(again) if stopped(&again).is_some() => again,
        _ => error,
    }
}

/// Moves the failure into the loop of a function, if it stopped where this is called and it has no other loop.
pub(crate) fn move_into_called(error: &mut EvalAltResult, source: &SourceText, ast: &AST) {
    if !matches!(error, EvalAltResult::ErrorTooManyOperations(_) | EvalAltResult::ErrorDataTooLarge(..)) {
        return;
    }
    let called = &source.text[source.word_at(offset(source, error.position()))];
    let mut loops = Vec::new();
    functions_of_name(ast, called).walk(&mut |path: &[ASTNode<'_>]| {
        if let Some(ASTNode::Stmt(Stmt::While(_, position) | Stmt::Do(_, _, position) | Stmt::For(_, position))) =
            path.last()
        {
            loops.push(*position);
        }
        true
    });
    if let [only] = loops[..] {
        error.set_position(only);
    }
}

fn body(ast: &AST, function: &str) -> Vec<Stmt> {
    let mut body = Vec::new();
    functions_of_name(ast, function).walk(&mut |path: &[ASTNode<'_>]| {
        if let [ASTNode::Stmt(statement)] = path {
            body.push(Stmt::clone(statement));
        }
        true
    });
    body
}

/// The functions of this name alone.
fn functions_of_name(ast: &AST, function: &str) -> AST {
    let mut only = ast.clone_functions_only();
    only.retain_functions(|_, _, name, _| name == function);
    only
}
