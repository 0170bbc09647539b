//! Where a limit can stop a script: the bodies of the functions that judge, and the loops of all.

use crate::judge::stopped::{FunctionBody, StopPlaces};
use rhai::{AST, ASTNode, Stmt};

/// The places of a script's tree.
pub(super) fn stop_places(ast: &AST) -> StopPlaces {
    let mut places = StopPlaces::default();
    for function in ast.iter_functions() {
        let (body, loops) = body_and_loops(ast, function.name);
        if let [only] = loops[..] {
            places.loops.push((function.name.to_owned(), only));
        }
        if let ("reward" | "calibrate", [argument]) = (function.name, function.params.as_slice()) {
            let (name, argument) = (function.name.to_owned(), (*argument).to_owned());
            places.bodies.push(FunctionBody { name, argument, ast: AST::new(body, ast.shared_lib().clone()) });
        }
    }
    places
}

fn body_and_loops(ast: &AST, function: &str) -> (Vec<Stmt>, Vec<rhai::Position>) {
    let (mut body, mut loops) = (Vec::new(), Vec::new());
    let mut only = ast.clone_functions_only();
    only.retain_functions(|_, _, name, _| name == function);
    only.walk(&mut |path: &[ASTNode<'_>]| {
        if let [ASTNode::Stmt(statement)] = path {
            body.push(Stmt::clone(statement));
        }
        if let Some(ASTNode::Stmt(Stmt::While(_, place) | Stmt::Do(_, _, place) | Stmt::For(_, place))) = path.last() {
            loops.push(*place);
        }
        true
    });
    (body, loops)
}
