//! The rules of a script, checked and compiled.

use super::compile::Compiler;
use super::parts::parts;
use super::positions::span;
use super::source::Code;
use super::spoilt::Spoilt;
use super::syntax::{TimeUnit, WrittenRule, written_rules};
use crate::diagnostic::{Diagnostic, Mistakes, Result, nearest_name, printable};
use crate::judge::explain;
use crate::judge::expression::{Flag, Number, Typed};
use crate::judge::functions::WINDOWS;
use crate::judge::rule::{Clause, CompiledRule, Persistence, RuleText, ScriptClause};
use rhai::{AST, ASTNode, Expr, Module, Position, Shared, Stmt};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// Longest persistence.
const MAX_TIME: f64 = 1e6;
/// Most rules of one script.
pub(super) const MOST_RULES: usize = 256;

/// Every rule without a mistake in it.
pub(super) fn rules(
    code: &Code,
    ast: &AST,
    compiler: &mut Compiler<'_>,
    spoilt: &Spoilt<'_>,
    mistakes: &mut Mistakes,
) -> Vec<CompiledRule> {
    let mut rules: Vec<CompiledRule> = Vec::new();
    let mut lines: BTreeMap<&str, usize> = BTreeMap::new();
    let has_reward = ast.iter_functions().any(|function| function.name == "reward");
    let written = written_rules(ast.statements());
    for written in &written {
        let name_at = |message: String, label: &str| {
            explain::mistake(&code.source, "E-SCRIPT-RULE", written.name_position, message, label)
        };
        let (line, _) = code.source.position(explain::offset(&code.source, written.position));
        if let Some(before) = lines.get(written.name) {
            let wrong =
                name_at(format!("there are two rules called \"{}\"", printable(written.name)), "the second one");
            mistakes.add(wrong.help(format!("choose another name; the first is in line {before}")));
        } else if written.name == "reward" && has_reward {
            mistakes.add(name_at("a rule cannot be called \"reward\" beside 'fn reward'".to_owned(), "here"));
        }
        lines.entry(written.name).or_insert(line);
        rules.extend(compiled(code, written, ast.shared_lib(), compiler, spoilt, mistakes));
    }
    if let Some(one_too_many) = written.get(MOST_RULES) {
        let at = one_too_many.name_position;
        let message = format!("a script may have {MOST_RULES} rules, found {}", written.len());
        let wrong = explain::mistake(&code.source, "E-SCRIPT-LIMIT", at, message, "one too many");
        mistakes.add(wrong.help("join some by ||, or judge in 'fn reward'"));
    }
    rules
}

/// Checks and compiles a rule; nothing if there is a mistake in it. Each is added to `mistakes`: an empty name, a
/// condition that is not true or false, a value that is not a number, a time that cannot be one.
fn compiled(
    code: &Code,
    written: &WrittenRule<'_>,
    library: &Shared<Module>,
    compiler: &mut Compiler<'_>,
    spoilt: &Spoilt<'_>,
    mistakes: &mut Mistakes,
) -> Option<CompiledRule> {
    let source = &code.source;
    let count = mistakes.count();
    if written.name.trim().is_empty() {
        let message = "a rule's name must not be empty";
        mistakes.add(explain::mistake(source, "E-SCRIPT-RULE", written.name_position, message, "no name"));
    }
    let start = explain::offset(source, written.position);
    let text = source.text[code.statement(start)].trim_end_matches(';').trim_end().to_owned();
    let (line, _) = source.position(start);
    let condition_span = span(code, written.condition);
    let value_span = span(code, written.value);
    let time_span = written.time.map_or(0..0, |(time, _)| span(code, time));
    let sound = |span: &Range<usize>, mistakes: &Mistakes| !spoilt.touches(span, mistakes);
    let condition = sound(&condition_span, mistakes)
        .then(|| condition(code, written, &condition_span, library, compiler))
        .and_then(|condition| mistakes.take(condition));
    let value = sound(&value_span, mistakes)
        .then(|| value(code, written, &value_span, library, compiler))
        .and_then(|value| mistakes.take(value));
    let persistence = sound(&time_span, mistakes)
        .then(|| persistence(code, written, compiler))
        .and_then(|persistence| mistakes.take(persistence));
    let (condition, value, persistence) = (condition?, value?, persistence?);
    if mistakes.count() > count {
        return None;
    }
    let stages = stages(code, written, &compiler.script.stages, mistakes);
    let to_stage = written.to_stage.map(|named| stage(code, named, &compiler.script.stages, mistakes));
    Some(CompiledRule {
        text: RuleText { name: written.name.to_owned(), line, text },
        condition,
        condition_span,
        persistence,
        value,
        value_span,
        then: written.then,
        to_place: written.to_place.map(|(place, at)| (place.to_owned(), quoted(code, at))),
        stages: stages?,
        once: written.once,
        per_second: written.per_second,
        to_stage: match to_stage {
            None => None,
            Some(stage) => Some(stage?),
        },
        parts: parts(code, written.condition, compiler),
    })
}

/// The text in quotes that begins at a position, quotes included.
fn quoted(code: &Code, at: Position) -> Range<usize> {
    let from = explain::offset(&code.source, at);
    let length = code.source.text[from..].bytes().skip(1).position(|byte| byte == b'"');
    from..from + length.map_or(1, |length| length + 2)
}

/// The stages that a rule is for, as bits; nothing within if it is for all, nothing at all if one is not known.
#[allow(clippy::option_option, reason = "the outer one is whether it is right, the inner one whether it is asked for")]
fn stages(code: &Code, written: &WrittenRule<'_>, known: &[String], mistakes: &mut Mistakes) -> Option<Option<u32>> {
    let named: Vec<Option<usize>> = written.stages.iter().map(|named| stage(code, *named, known, mistakes)).collect();
    let bits = named.into_iter().try_fold(0, |bits, stage| stage.map(|stage| bits | (1 << stage)))?;
    Some((!written.stages.is_empty()).then_some(bits))
}

/// The number of a stage; a mistake if there is none of this name.
pub(super) fn stage(
    code: &Code,
    (name, at): (&str, Position),
    known: &[String],
    mistakes: &mut Mistakes,
) -> Option<usize> {
    let found = known.iter().position(|stage| stage == name);
    if found.is_none() {
        let message = format!("there is no stage \"{}\"", printable(name));
        let help = match nearest_name(name, known.iter().map(String::as_str)) {
            Some(near) => format!("did you mean \"{}\"?", printable(near)),
            None if known.is_empty() => format!("name the stages first: stages([\"{}\", \"...\"]);", printable(name)),
            None => format!("there are: {}", printable(&known.join(", "))),
        };
        mistakes.add(explain::mistake(&code.source, "E-SCRIPT-STAGE", at, message, "not known").help(help));
    }
    found
}

/// Whether an expression reads what only a native tree can remember.
fn remembers(expr: &Expr, own: &[String]) -> Option<Position> {
    let mut found = None;
    expr.walk(&mut Vec::new(), &mut |path: &[ASTNode<'_>]| {
        if let Some(ASTNode::Expr(Expr::FnCall(call, position))) = path.last()
            && WINDOWS.iter().any(|row| row.name == call.name)
            && !own.iter().any(|own| *own == call.name.as_str())
        {
            found = found.or(Some(*position));
        }
        true
    });
    found
}

/// The mistake of something that cannot be remembered.
pub(super) fn not_remembered(code: &Code, at: Position) -> Diagnostic {
    let message = "only facts, numbers and the functions of the table can be remembered";
    let help = "give it a name of its own: measure m = ...; and read m here";
    explain::mistake(&code.source, "E-SCRIPT-WINDOW", at, message, "cannot be remembered").help(help)
}

fn wrong(code: &Code, message: &str, span: &Range<usize>, label: &str) -> Diagnostic {
    Diagnostic::new("E-SCRIPT-RULE", message).at(&code.source, span.clone(), label)
}

fn condition(
    code: &Code,
    written: &WrittenRule<'_>,
    span: &Range<usize>,
    library: &Shared<Module>,
    compiler: &mut Compiler<'_>,
) -> Result<Clause<Flag>> {
    match compiler.clause(written.condition) {
        Some(Typed::Flag(flag)) => Ok(Clause::Native(flag)),
        None => script(code, written, written.condition, library, compiler),
        Some(_) => wrong(code, "a condition must be true or false", span, "this is a number")
            .help("compare it: laser.nearest < 0.25")
            .fail(),
    }
}

fn value(
    code: &Code,
    written: &WrittenRule<'_>,
    span: &Range<usize>,
    library: &Shared<Module>,
    compiler: &mut Compiler<'_>,
) -> Result<Clause<Number>> {
    match compiler.clause(written.value) {
        Some(Typed::Number(Number::Constant(value)) | Typed::Whole(Number::Constant(value))) if !value.is_finite() => {
            wrong(code, "a rule's value must be a finite number", span, "too large").fail()
        }
        Some(Typed::Number(number) | Typed::Whole(number)) => Ok(Clause::Native(number)),
        Some(Typed::Flag(_)) => wrong(code, "a rule's value must be a number", span, "this is true or false")
            .help("write a number, such as -1")
            .fail(),
        None => script(code, written, written.value, library, compiler),
    }
}

fn script<T>(
    code: &Code,
    written: &WrittenRule<'_>,
    expr: &Expr,
    library: &Shared<Module>,
    compiler: &Compiler<'_>,
) -> Result<Clause<T>> {
    if let Some(at) = remembers(expr, &compiler.script.own) {
        return not_remembered(code, at).fail();
    }
    let mut roots = BTreeSet::new();
    expr.walk(&mut Vec::new(), &mut |path: &[ASTNode<'_>]| {
        if let Some(ASTNode::Expr(Expr::Variable(variable, None, _))) = path.last() {
            roots.insert(variable.1.to_string());
        }
        true
    });
    let statement = Stmt::Expr(Box::new(expr.clone()));
    let (ast, variables) = (AST::new([statement], library.clone()), written.variables);
    Ok(Clause::Script(ScriptClause { ast, variables, roots }))
}

fn persistence(code: &Code, written: &WrittenRule<'_>, compiler: &mut Compiler<'_>) -> Result<Persistence> {
    let Some((time, unit)) = written.time else {
        return Ok(Persistence::Steps(1));
    };
    let span = span(code, time);
    let wrong =
        |message: &str, label: String| Diagnostic::new("E-SCRIPT-RULE", message).at(&code.source, span.clone(), label);
    let number = match compiler.expression(time) {
        Some(Typed::Number(Number::Constant(number)) | Typed::Whole(Number::Constant(number))) => number,
        _ => return wrong("the time of a rule must be a plain number", "found something else".to_owned()).fail(),
    };
    if !(number > 0.0 && number <= MAX_TIME) {
        let message = format!("the time of a rule must be greater than 0 and at most {MAX_TIME}");
        return wrong(&message, format!("found {number}")).help("leave out 'for ...' to fire at once").fail();
    }
    match unit {
        TimeUnit::Seconds => Ok(Persistence::Seconds(number)),
        TimeUnit::Steps if number.fract() == 0.0 => Ok(Persistence::Steps(number as u32)),
        TimeUnit::Steps => wrong("steps are counted in whole numbers", format!("found {number}"))
            .help("write 'seconds' instead")
            .fail(),
    }
}
