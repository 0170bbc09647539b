//! One rule: when it holds, for how long, and what it is worth.

use super::compile::{Compiler, Typed};
use super::explain;
use super::expression::{Flag, Number};
use super::readings::{self, Part};
use super::source::Code;
use super::spoilt::Spoilt;
use super::syntax::{TimeUnit, WrittenRule};
use crate::diagnostic::{Diagnostic, Mistakes, Result, printable};
use rhai::{AST, ASTNode, Expr, Module, Position, Shared, Stmt};
use std::collections::BTreeSet;
use std::ops::Range;

/// A rule as the user wrote it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RuleText {
    /// Its name; `reward` for the function.
    pub name: String,
    /// The line where it begins, from 1.
    pub line: usize,
    /// Its text.
    pub text: String,
}

/// How long a condition must hold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Persistence {
    Steps(u32),
    Seconds(f64),
}

/// Longest persistence.
const MAX_TIME: f64 = 1e6;

impl Persistence {
    /// The number of steps, at least 1.
    pub(super) fn steps(self, period_s: f64) -> u32 {
        match self {
            Self::Steps(steps) => steps,
            // 0.9 / 0.3 is a little more than 3 in floating point.
            Self::Seconds(seconds) => ((seconds / period_s - 1e-9).ceil().max(1.0)) as u32,
        }
    }
}

/// A condition or a value: native, or left to the interpreter.
#[derive(Debug)]
pub(super) enum Clause<T> {
    Native(T),
    Script(ScriptClause),
}

/// An expression for the interpreter.
#[derive(Debug)]
pub(super) struct ScriptClause {
    pub ast: AST,
    /// How many top-level variables it was parsed after: the parser counts variables from the last one.
    pub variables: usize,
    /// The facts that it reads.
    pub roots: BTreeSet<String>,
}

/// A rule, ready to be judged.
#[derive(Debug)]
pub(super) struct Rule {
    pub text: RuleText,
    pub condition: Clause<Flag>,
    pub condition_span: Range<usize>,
    pub persistence: Persistence,
    pub value: Clause<Number>,
    pub value_span: Range<usize>,
    pub recover: bool,
    /// What the condition reads.
    pub parts: Vec<Part>,
}

impl Rule {
    /// What it adds whenever it fires; nothing if that depends on the step.
    pub(super) fn fixed_value(&self) -> Option<f64> {
        match self.value {
            Clause::Native(Number::Constant(value)) => Some(value),
            _ => None,
        }
    }

    /// Checks and compiles a rule; nothing if there is a mistake in it. Each is added to `mistakes`: an empty name, a
    /// condition that is none, a value that is no number, a time that is no time.
    pub(super) fn new(
        code: &Code,
        written: &WrittenRule<'_>,
        library: &Shared<Module>,
        compiler: &mut Compiler<'_>,
        spoilt: &Spoilt,
        mistakes: &mut Mistakes,
    ) -> Option<Self> {
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
        let sound = |span: &Range<usize>, mistakes: &Mistakes| !spoilt.touches(code, span, mistakes);
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
        let text = RuleText { name: written.name.to_owned(), line, text };
        let (recover, parts) = (written.recover, readings::parts(code, written.condition, compiler));
        Some(Self { text, condition, condition_span, persistence, value, value_span, recover, parts })
    }

    /// `rule "too close"`, safe for a terminal.
    pub(super) fn shown(&self) -> String {
        format!("rule \"{}\"", printable(&self.text.name))
    }
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
        None => Ok(Clause::Script(script(written, written.condition, library))),
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
        None => Ok(Clause::Script(script(written, written.value, library))),
    }
}

fn script(written: &WrittenRule<'_>, expr: &Expr, library: &Shared<Module>) -> ScriptClause {
    let mut roots = BTreeSet::new();
    expr.walk(&mut Vec::new(), &mut |path: &[ASTNode<'_>]| {
        if let Some(ASTNode::Expr(Expr::Variable(variable, None, _))) = path.last() {
            roots.insert(variable.1.to_string());
        }
        true
    });
    let statement = Stmt::Expr(Box::new(expr.clone()));
    ScriptClause { ast: AST::new([statement], library.clone()), variables: written.variables, roots }
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

/// The bytes of an expression: from its first token to what ends it.
fn span(code: &Code, expr: &Expr) -> Range<usize> {
    let start = explain::offset(&code.source, first(expr));
    let tail = &code.plain[start..];
    let mut depth = 0_i32;
    let mut before = ' ';
    for (index, c) in tail.char_indices() {
        match c {
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth -= 1,
            _ => {}
        }
        let word = !before.is_alphanumeric() && before != '_' && before != '.';
        let rest = &tail[index..];
        let stop = matches!(c, ';' | ',') || rest.starts_with("=>") || word && ends_expression(rest);
        if depth < 0 || depth == 0 && stop {
            return start..start + tail[..index].trim_end().len();
        }
        before = c;
    }
    start..start + tail.trim_end().len()
}

// An operator's own position is the operator's; what is underlined begins with its left side.
pub(super) fn first(expr: &Expr) -> Position {
    match expr {
        Expr::FnCall(call, _) if call.is_operator_call() && call.args.len() == 2 => first(&call.args[0]),
        Expr::And(parts, _) | Expr::Or(parts, _) => parts.first().map_or(Position::NONE, first),
        other => other.start_position(),
    }
}

fn ends_expression(rest: &str) -> bool {
    ["for", "then", "steps", "step", "seconds", "second"].iter().any(|word| {
        rest.strip_prefix(word).is_some_and(|tail| !tail.starts_with(|c: char| c.is_alphanumeric() || c == '_'))
    })
}
