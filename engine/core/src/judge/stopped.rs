//! A script that a limit stopped: what is said of it, and the line at which it stopped.

use super::explain::offset;
use super::{budget, sandbox};
use crate::diagnostic::SourceText;
use rhai::{AST, Dynamic, Engine, EvalAltResult, Position, Scope};

/// What stopped a script, if a limit did, and what to look for.
pub(crate) fn stopped(error: &EvalAltResult) -> Option<(String, &'static str)> {
    use EvalAltResult as E;
    Some(match error {
        E::ErrorTooManyOperations(_) | E::ErrorTerminated(..) => (
            format!("the script was stopped after {} operations", sandbox::MAX_OPERATIONS),
            "look for a loop that does not end, and for arrays or maps that are read or compared in one",
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

/// Where in a script a limit can stop it: the interpreter forgets the line on its way out of a function.
#[derive(Debug, Default)]
pub(crate) struct StopPlaces {
    /// The functions that judge.
    pub bodies: Vec<FunctionBody>,
    /// The loop of each function that has only one.
    pub loops: Vec<(String, Position)>,
}

/// A function of one argument as a program of its own: at the top level the interpreter keeps the line.
#[derive(Debug)]
pub(crate) struct FunctionBody {
    pub name: String,
    pub argument: String,
    pub ast: AST,
}

impl StopPlaces {
    /// A failure moved to the line where a limit stopped `function` on the facts, which is found by running it again with
    /// the operations that it had.
    pub(crate) fn placed_in(
        &self,
        error: Box<EvalAltResult>,
        engine: &Engine,
        function: &str,
        facts: impl Into<Dynamic>,
        operations: u64,
    ) -> Box<EvalAltResult> {
        let body = self.bodies.iter().find(|body| body.name == function).filter(|_| stopped(&error).is_some());
        let Some(body) = body else { return error };
        let mut scope = Scope::new();
        scope.push_dynamic(body.argument.as_str(), facts.into());
        budget::refill(operations);
        match engine.eval_ast_with_scope::<Dynamic>(&mut scope, &body.ast) {
            Err(again) if stopped(&again).is_some() => again,
            _ => error,
        }
    }

    /// Moves the failure into the loop of a function, if it stopped where this is called and it has no other loop.
    pub(crate) fn move_into_called(&self, error: &mut EvalAltResult, source: &SourceText) {
        if !matches!(
            error,
            EvalAltResult::ErrorTooManyOperations(_)
                | EvalAltResult::ErrorTerminated(..)
                | EvalAltResult::ErrorDataTooLarge(..)
        ) {
            return;
        }
        let called = &source.text[source.word_at(offset(source, error.position()))];
        if let Some((_, place)) = self.loops.iter().find(|(name, _)| name == called) {
            error.set_position(*place);
        }
    }
}
