//! `bins(x, [edges])` inside `state(...)`: a value told apart by ranges. Its first part is read from the tree, as conditions are;
//! its second is worked out with the set-up.

use super::compile::Compiler;
use super::positions::{first, span};
use super::rules::not_remembered;
use super::source::Code;
use super::spoilt::Spoilt;
use super::syntax::{Next, expect, is_form_of, wrong};
use crate::diagnostic::{Diagnostic, Mistakes, Result};
use crate::judge::compiled::Bins;
use crate::judge::explain;
use crate::judge::expression::{Number, Typed};
use crate::judge::views::number;
use rhai::{AST, ASTNode, Dynamic, Engine, Expr, ImmutableString, Position};

/// Most ranges of one value.
const MAX_EDGES: usize = 15;
const FORM: &str = "write bins(laser.front, [0.5, 1.0]), or bins(robot.contact)";

/// What `bins(...)` is while the set-up runs.
#[derive(Debug, Clone)]
pub(super) struct BinsToken {
    /// Where its value stands in the tree.
    pub position: Position,
    /// Its edges as written; nothing without them.
    pub edges: Option<Dynamic>,
}

/// A `bins(...)` with its edges.
#[derive(Debug, Clone)]
pub(super) struct WrittenBins {
    pub position: Position,
    /// As it stands in the script: `laser.front`.
    pub text: String,
    /// None for what is true or false.
    pub edges: Vec<f64>,
}

/// Teaches the form to an engine.
pub(super) fn register(engine: &mut Engine) {
    engine.register_custom_syntax_with_state_raw("bins", next, false, |context, inputs, _| {
        let position = inputs.first().map_or(Position::NONE, rhai::Expression::position);
        let edges = inputs.get(1).map(|edges| context.eval_expression_tree(edges)).transpose()?;
        Ok(Dynamic::from(BinsToken { position, edges }))
    });
}

fn next(symbols: &[ImmutableString], ahead: &str, _: &mut Dynamic) -> Next {
    match symbols {
        [.., last] if last.as_str() == ")" => Ok(None),
        [_] => expect("(", ahead, "after 'bins' comes a bracket: bins(laser.front, [0.5, 1.0])"),
        [_, _] if matches!(ahead, ")" | ",") => {
            wrong("bins needs a value to be told apart: bins(laser.front, [0.5, 1.0])")
        }
        [_, _] | [_, _, _, _] => Ok(Some("$expr$".into())),
        [_, _, _] if matches!(ahead, "," | ")") => Ok(Some(ahead.into())),
        [_, _, _, _, _] => {
            expect(")", ahead, "bins takes a value and the edges of its ranges: bins(laser.front, [0.5, 1.0])")
        }
        _ => wrong("bins takes a value and the edges of its ranges: bins(laser.front, [0.5, 1.0])"),
    }
}

/// Whether an expression is `bins(...)`.
pub(super) fn is_bins_expr(expr: &Expr) -> bool {
    is_form_of(expr, "bins")
}

impl WrittenBins {
    /// With its edges checked: 1 to 15 numbers that rise, or none.
    ///
    /// # Errors
    /// If they are something else.
    pub(super) fn new(code: &Code, ast: &AST, token: &BinsToken) -> Result<Self> {
        let (mut text, mut at) = (String::new(), token.position);
        with_value(ast, token.position, |value| {
            code.source.text[span(code, value)].clone_into(&mut text);
            at = first(value);
        });
        let wrong = |message: String, label: String| {
            explain::mistake(&code.source, "E-SCRIPT-SETTING", at, message, label).help(FORM).fail()
        };
        let Some(edges) = &token.edges else { return Ok(Self { position: token.position, text, edges: Vec::new() }) };
        let list = edges.clone().into_array().unwrap_or_default();
        let edges: Vec<f64> = list.iter().filter_map(number).filter(|edge| edge.is_finite()).collect();
        if edges.len() != list.len() || !(1..=MAX_EDGES).contains(&edges.len()) {
            let message = format!("the edges of bins are an array of 1 to {MAX_EDGES} numbers");
            return wrong(message, format!("of this value, found {}", list.len()));
        }
        match edges.windows(2).find(|pair| pair[0] >= pair[1]) {
            Some(pair) => wrong(
                "the edges of bins must rise".to_owned(),
                format!("of this value: {} stands before {}", pair[0], pair[1]),
            ),
            None => Ok(Self { position: token.position, text, edges }),
        }
    }
}

/// The values that the script's states tell apart, compiled; what is wrong with one is added to `mistakes`.
pub(super) fn bins(
    code: &Code,
    ast: &AST,
    written: &[WrittenBins],
    compiler: &mut Compiler<'_>,
    spoilt: &Spoilt<'_>,
    mistakes: &mut Mistakes,
) -> Vec<Bins> {
    let mut compiled = Vec::new();
    for one in written {
        with_value(ast, one.position, |value| {
            if spoilt.touches(&span(code, value), mistakes) {
                return;
            }
            let typed = compiler.clause(value);
            match bins_of(code, value, typed, one.edges.clone()) {
                Ok(bins) => compiled.push(bins),
                Err(wrong) => mistakes.add(wrong),
            }
        });
    }
    compiled
}

fn bins_of(code: &Code, value: &Expr, typed: Option<Typed>, edges: Vec<f64>) -> std::result::Result<Bins, Diagnostic> {
    let at = first(value);
    let wrong = |message: &str, label: &str, help: &str| {
        explain::mistake(&code.source, "E-SCRIPT-TYPE", at, message.to_owned(), label).help(help)
    };
    match typed {
        Some(Typed::Flag(flag)) if edges.is_empty() => Ok(Bins { of: Number::Truth(Box::new(flag)), edges: vec![0.5] }),
        Some(Typed::Flag(_)) => {
            Err(wrong("what is true or false has no ranges", "this is true or false", "leave the edges out"))
        }
        Some(_) if edges.is_empty() => Err(wrong("a number needs the edges of its ranges", "this is a number", FORM)),
        Some(Typed::Number(of) | Typed::Whole(of)) => Ok(Bins { of, edges }),
        None => Err(not_remembered(code, at)),
    }
}

/// Finds the value of the `bins(...)` at a place.
fn with_value(ast: &AST, position: Position, mut found: impl FnMut(&Expr)) {
    let mut open = true;
    ast.clone_statements_only().walk(&mut |path: &[ASTNode<'_>]| {
        if let Some(ASTNode::Expr(expr)) = path.last()
            && let Expr::Custom(custom, _) = expr
            && is_bins_expr(expr)
            && let Some(value) = custom.inputs.first().filter(|value| value.position() == position)
            && std::mem::take(&mut open)
        {
            found(value);
        }
        open
    });
}
