//! Guards of a script, checked and compiled: `forbid "name" when CONDITION => ACTIONS;`

use super::compile::Compiler;
use super::parts::parts;
use super::positions::{first, span};
use super::source::Code;
use super::spoilt::Spoilt;
use super::syntax::{Next, expect, form, is_form_of, wrong};
use crate::diagnostic::{Diagnostic, Mistakes, Result, printable};
use crate::geometry::Twist;
use crate::judge::explain;
use crate::judge::expression::{Flag, Typed};
use crate::judge::functions::WINDOWS;
use crate::judge::guards::CompiledGuard;
use crate::judge::rule::RuleText;
use rhai::{AST, ASTNode, Dynamic, Expr, ImmutableString, Position, Stmt};
use std::collections::BTreeMap;

/// Most guards of one script.
const MOST_GUARDS: usize = 32;

/// A guard as it stands in the script's tree.
struct WrittenGuard<'a> {
    name: &'a str,
    name_position: Position,
    position: Position,
    condition: &'a Expr,
    forbids: &'a Expr,
}

/// The next symbol of a guard.
pub(super) fn next_of_forbid(symbols: &[ImmutableString], ahead: &str, _: &mut Dynamic) -> Next {
    let is_end = matches!(ahead, ";" | "{EOF}");
    match symbols.len() {
        1 if ahead.starts_with('"') => Ok(Some("$string$".into())),
        1 => wrong("a guard needs a name in quotes: forbid \"ahead\" when ..."),
        2 => expect("when", ahead, "after the name of a guard comes 'when' and a condition"),
        3 if is_end || ahead == "=>" => wrong("after 'when' comes a condition"),
        3 => Ok(Some("$expr$".into())),
        4 if matches!(ahead, "for" | "once" | "in") => {
            wrong("a guard holds as long as its condition does: it has no 'for', 'once' or 'in'")
        }
        4 => expect(
            "=>",
            ahead,
            "after the condition comes '=>' and what no action may be: \
             forbid \"ahead\" when laser.front < 0.4 => action.linear > 0",
        ),
        5 if is_end => wrong("after '=>' comes what no action may be: action.linear > 0"),
        5 => Ok(Some("$expr$".into())),
        _ if matches!(ahead, "then" | "per") => wrong("a guard has no value and ends nothing: that is a rule's"),
        _ => Ok(None),
    }
}

/// Whether an expression is a guard.
pub(super) fn is_guard_expr(expr: &Expr) -> bool {
    is_form_of(expr, "forbid")
}

fn written_guards(statements: &[Stmt]) -> Vec<WrittenGuard<'_>> {
    let written = statements.iter().filter_map(|statement| {
        let (_, custom, position) = form(statement).filter(|(expr, ..)| is_guard_expr(expr))?;
        let [Expr::StringConstant(name, name_position), condition, forbids] = custom.inputs.as_slice() else {
            return None;
        };
        Some(WrittenGuard { name, name_position: *name_position, position, condition, forbids })
    });
    written.collect()
}

/// Every guard without a mistake in it.
pub(super) fn guards(
    code: &Code,
    ast: &AST,
    compiler: &mut Compiler<'_>,
    spoilt: &Spoilt<'_>,
    mistakes: &mut Mistakes,
) -> Vec<CompiledGuard> {
    let mut guards = Vec::new();
    let mut lines: BTreeMap<&str, usize> = BTreeMap::new();
    let written = written_guards(ast.statements());
    for (number, written) in written.iter().enumerate() {
        let (line, _) = code.source.position(explain::offset(&code.source, written.position));
        let named = |message: String, label: &str| {
            explain::mistake(&code.source, "E-SCRIPT-GUARD", written.name_position, message, label)
        };
        if written.name.trim().is_empty() {
            mistakes
                .add(named("a guard's name must not be empty".to_owned(), "no name").help("name what it keeps from"));
        } else if let Some(before) = lines.get(written.name) {
            let message = format!("there are two guards called \"{}\"", printable(written.name));
            let help = format!("choose another name; the first is in line {before}");
            mistakes.add(named(message, "the second one").help(help));
        }
        lines.entry(written.name).or_insert(line);
        if number == MOST_GUARDS {
            let message = format!("a script may have {MOST_GUARDS} guards");
            let wrong =
                explain::mistake(&code.source, "E-SCRIPT-LIMIT", written.name_position, message, "one too many");
            mistakes.add(wrong.help("join some by || on the left side"));
        }
        guards.extend(compiled(code, written, compiler, spoilt, mistakes));
    }
    guards
}

fn compiled(
    code: &Code,
    written: &WrittenGuard<'_>,
    compiler: &mut Compiler<'_>,
    spoilt: &Spoilt<'_>,
    mistakes: &mut Mistakes,
) -> Option<CompiledGuard> {
    let (condition_span, forbids_span) = (span(code, written.condition), span(code, written.forbids));
    let condition = (!spoilt.touches(&condition_span, mistakes)).then(|| match compiler.clause(written.condition) {
        Some(Typed::Flag(flag)) => Ok(flag),
        Some(_) => Diagnostic::new("E-SCRIPT-GUARD", "a condition must be true or false")
            .at(&code.source, condition_span.clone(), "this is a number")
            .help("compare it: laser.front < 0.4")
            .fail(),
        None => {
            let message = "a guard reads facts, measures, numbers and the functions of the table only".to_owned();
            explain::mistake(&code.source, "E-SCRIPT-GUARD", first(written.condition), message, "something else")
                .help("write the condition out: laser.front < 0.4 && robot.linear > 0.1")
                .fail()
        }
    });
    let condition = condition.and_then(|condition| mistakes.take(condition));
    let forbids = (!spoilt.touches(&forbids_span, mistakes)).then(|| forbids(code, written.forbids, compiler));
    let forbids = forbids.and_then(|forbids| mistakes.take(forbids));
    let (condition, forbids) = (condition?, forbids?);
    let start = explain::offset(&code.source, written.position);
    let (line, _) = code.source.position(start);
    let text = code.source.text[code.statement(start)].trim_end_matches(';').trim_end().to_owned();
    let parts = parts(code, written.condition, compiler);
    let text = RuleText { name: written.name.to_owned(), line, text };
    Some(CompiledGuard { text, condition, forbids, forbids_span, parts })
}

/// The right side: of the action alone, so that it is known before anything is measured.
fn forbids(code: &Code, expr: &Expr, compiler: &mut Compiler<'_>) -> Result<Flag> {
    let help = "compare action.linear or action.angular with a number; what is measured stands before '=>'";
    if let Some(at) = foreign(expr, compiler) {
        let message = "what a guard forbids is said of the action alone".to_owned();
        return explain::mistake(&code.source, "E-SCRIPT-GUARD", at, message, "no property of an action")
            .help(help)
            .fail();
    }
    match compiler.clause(expr) {
        Some(Typed::Flag(flag)) => Ok(flag),
        _ => Diagnostic::new("E-SCRIPT-GUARD", "what a guard forbids must be true or false of an action")
            .at(&code.source, span(code, expr), "this is neither")
            .help(help)
            .fail(),
    }
}

/// The first thing in an expression that is neither of the action nor a constant.
fn foreign(expr: &Expr, compiler: &Compiler<'_>) -> Option<Position> {
    let mut found = None;
    expr.walk(&mut Vec::new(), &mut |path: &[ASTNode<'_>]| {
        let at = match path.last() {
            Some(ASTNode::Expr(Expr::Variable(variable, _, at))) => {
                let name = variable.1.as_str();
                (name != "action" && compiler.constants.get(name).is_none()).then_some(*at)
            }
            Some(ASTNode::Expr(Expr::FnCall(call, at))) => {
                WINDOWS.iter().any(|row| row.name == call.name).then_some(*at)
            }
            _ => None,
        };
        found = found.or(at);
        true
    });
    found
}

/// Checks that each guard takes some of the actions away, and leaves some.
///
/// # Errors
/// For the first that does not.
pub(super) fn check_actions(
    source: &crate::diagnostic::SourceText,
    guards: &[CompiledGuard],
    actions: &[Twist],
    hands_over: bool,
) -> Result<()> {
    for guard in guards {
        let forbidden = guard.forbidden(actions).count(actions.len());
        let (message, help) = match forbidden {
            // It may be about what a policy does that is used.
            0 if hands_over => continue,
            0 => ("this guard forbids nothing: none of the actions is so", "forbid what an action of this script does"),
            count if count == actions.len() => (
                "this guard forbids every action",
                "leave one, such as one that stands still: actions([..., [0.0, 0.0]]);",
            ),
            _ => continue,
        };
        let label = format!("true of {forbidden} of {} actions", actions.len());
        return Diagnostic::new("E-SCRIPT-GUARD", message)
            .at(source, guard.forbids_span.clone(), label)
            .help(help)
            .fail();
    }
    Ok(())
}
