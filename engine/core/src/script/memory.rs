//! Functions that want to remember: what they change outside of themselves, which is the same in every step.

use super::access::{Access, Link};
use super::source::Code;
use crate::diagnostic::{Mistakes, printable};
use crate::judge::explain::{mistake, offset};
use rhai::{AST, ASTNode, Expr, Position, Stmt};
use std::collections::BTreeSet;

/// What a script can do instead.
const INSTEAD: &str =
    "variables remember nothing between steps: write fired(\"rule\") or since(\"rule\"), a measure, or stages";

/// Adds each outer variable that a function or a rule changes, at the first place: the interpreter would find out only in the
/// step that comes by there, or never.
pub(super) fn check_memory(code: &Code, ast: &AST, mistakes: &mut Mistakes) {
    // A switch is not walked in the same order each time.
    let mut changes: Vec<(usize, Position, String)> = Vec::new();
    ast.clone_functions_only().walk(&mut |path: &[ASTNode<'_>]| {
        if let Some((name, position)) = changed(path).or_else(|| this(path)) {
            changes.push((offset(&code.source, position), position, name.to_owned()));
        }
        true
    });
    changes.extend(in_rules(code, ast));
    changes.sort_unstable();
    let mut told = BTreeSet::new();
    for (_, position, name) in changes {
        if !told.insert(name.clone()) {
            continue;
        }
        let name = printable(&name);
        let (message, label, help) = match name.as_str() {
            "this" => ("'this' stands for nothing in a function".to_owned(), "nothing", INSTEAD.to_owned()),
            _ => (
                format!("'{name}' stands outside of what changes it: it is the same in every step"),
                "cannot be changed here",
                format!("{INSTEAD}; within one step: let own = {name};"),
            ),
        };
        mistakes.add(mistake(&code.source, "E-SCRIPT-MEMORY", position, message, label).help(help));
    }
}

/// What rules change of the variables of the top level, those left out whose names a rule gives to variables of its own.
fn in_rules(code: &Code, ast: &AST) -> Vec<(usize, Position, String)> {
    let (mut outer, mut own, mut changes) = (BTreeSet::new(), BTreeSet::new(), Vec::new());
    ast.clone_statements_only().walk(&mut |path: &[ASTNode<'_>]| {
        let in_rule = path.iter().any(|node| matches!(node, ASTNode::Expr(Expr::Custom(..))));
        match path.last() {
            Some(ASTNode::Stmt(Stmt::Var(variable, ..))) => {
                let names = if in_rule { &mut own } else { &mut outer };
                names.insert(variable.0.name.to_string());
            }
            Some(ASTNode::Stmt(Stmt::Assignment(assignment))) if in_rule => {
                changes
                    .extend(Access::of(&assignment.1.lhs).map(|access| {
                        (offset(&code.source, access.position), access.position, access.root.to_owned())
                    }));
            }
            _ => {}
        }
        true
    });
    changes.retain(|(_, _, name)| outer.contains(name) && !own.contains(name));
    changes
}

/// The outer variable that a statement or a call changes.
fn changed<'a>(path: &'a [ASTNode<'_>]) -> Option<(&'a str, Position)> {
    let access = match path.last()? {
        ASTNode::Stmt(Stmt::Assignment(assignment)) => Access::of(&assignment.1.lhs)?,
        ASTNode::Expr(expr @ (Expr::Dot(..) | Expr::Index(..))) => {
            let access = Access::of(expr)?;
            let pushes = access.links.iter().any(|link| matches!(link, Link::Call(call, _) if call.name == "push"));
            pushes.then_some(access)?
        }
        _ => return None,
    };
    (!access.is_local).then_some((access.root, access.position))
}

fn this(path: &[ASTNode<'_>]) -> Option<(&'static str, Position)> {
    match path.last()? {
        ASTNode::Expr(Expr::ThisPtr(position)) => Some(("this", *position)),
        _ => None,
    }
}
