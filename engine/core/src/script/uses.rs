//! Uses of learned policies, checked and compiled: `use "dock" in "approach" when CONDITION;`

use super::compile::Compiler;
use super::parts::parts;
use super::positions::{first, span};
use super::rules::stage;
use super::source::Code;
use super::spoilt::Spoilt;
use super::syntax::{Forms, Next, form, is_form_of, wrong};
use crate::diagnostic::{Diagnostic, Mistakes, Result, nearest_name, printable};
use crate::judge::explain;
use crate::judge::expression::{Flag, Typed};
use crate::judge::rule::RuleText;
use crate::judge::uses::CompiledUse;
use crate::settings::PolicySettings;
use rhai::{AST, Dynamic, Expr, ImmutableString, Position, Stmt};

/// Most uses of one script.
const MOST_USES: usize = 32;

/// A use as it stands in the script's tree.
struct WrittenUse<'a> {
    name: (ImmutableString, Position),
    position: Position,
    stages: Vec<(ImmutableString, Position)>,
    condition: Option<&'a Expr>,
}

/// The next symbol of a use.
pub(super) fn next_of_use(symbols: &[ImmutableString], ahead: &str, _: &mut Dynamic) -> Next {
    let last = symbols.last().map_or("", |symbol| symbol.as_str());
    let (text, is_end) = (ahead.starts_with('"'), matches!(ahead, ";" | "{EOF}"));
    match (last, symbols.len()) {
        ("use", 1) if text => Ok(Some("$string$".into())),
        ("use", 1) => wrong("a use needs the name of a policy in quotes: use \"dock\" when ..."),
        ("in" | ",", _) if text => Ok(Some("$string$".into())),
        ("in" | ",", _) => wrong("after 'in' comes the name of a stage in quotes: use \"dock\" in \"approach\";"),
        ("when", _) if is_end => wrong("after 'when' comes a condition"),
        ("when", _) => Ok(Some("$expr$".into())),
        ("$expr$", _) if matches!(ahead, "for" | "once" | "=>" | "then") => {
            wrong("a use holds as long as its condition does: it has no 'for', 'once', value or 'then'")
        }
        ("$expr$", _) => Ok(None),
        (_, 2) if ahead == "in" => Ok(Some("in".into())),
        (_, count) if ahead == "," && count > 2 => Ok(Some(",".into())),
        _ if ahead == "when" => Ok(Some("when".into())),
        _ if is_end => Ok(None),
        _ => wrong("after the name of a policy comes 'when' and a condition, or 'in' and the name of a stage"),
    }
}

/// Whether an expression is a use.
pub(super) fn is_use_expr(expr: &Expr) -> bool {
    is_form_of(expr, "use")
}

fn written_uses(statements: &[Stmt]) -> Vec<WrittenUse<'_>> {
    let written = statements.iter().filter_map(|statement| {
        let (_, custom, position) = form(statement).filter(|(expr, ..)| is_use_expr(expr))?;
        let names = custom.tokens.iter().filter(|token| *token == "$string$").count();
        let text = |input: &'_ Expr| match input {
            Expr::StringConstant(text, at) => Some((text.clone(), *at)),
            _ => None,
        };
        let mut names = custom.inputs.iter().take(names).filter_map(text);
        let (name, stages) = (names.next()?, names.collect());
        let condition = custom.tokens.iter().any(|token| token == "$expr$").then(|| custom.inputs.last()).flatten();
        Some(WrittenUse { name, position, stages, condition })
    });
    written.collect()
}

/// How many uses are written, at least; one that the parser refused is not in the tree.
pub(super) fn count(ast: &AST, forms: Forms) -> usize {
    written_uses(ast.statements()).len().max(usize::from(forms.uses))
}

/// Every use without a mistake in it. `policies` are those that the script names; nothing if they could not be read.
pub(super) fn uses(
    code: &Code,
    ast: &AST,
    policies: Option<&[PolicySettings]>,
    compiler: &mut Compiler<'_>,
    spoilt: &Spoilt<'_>,
    mistakes: &mut Mistakes,
) -> Vec<CompiledUse> {
    let mut uses: Vec<CompiledUse> = Vec::new();
    let written = written_uses(ast.statements());
    for (number, one) in written.iter().enumerate() {
        let named = |message: &str, label: &str| {
            explain::mistake(&code.source, "E-SCRIPT-USE", one.name.1, message.to_owned(), label)
        };
        if number == MOST_USES {
            let message = format!("a script may have {MOST_USES} uses");
            let wrong = explain::mistake(&code.source, "E-SCRIPT-LIMIT", one.name.1, message, "one too many");
            mistakes.add(wrong.help("join some by || in their conditions"));
        }
        if let Some(always) = uses.last().filter(|before| before.is_always()) {
            let message = "this use is never asked: the one above it always holds";
            let help = format!("put it above line {}, or give that one a condition", always.text.line);
            mistakes.add(named(message, "never asked").help(help));
            break;
        }
        uses.extend(compiled(code, one, policies, compiler, spoilt, mistakes));
    }
    uses
}

fn compiled(
    code: &Code,
    written: &WrittenUse<'_>,
    policies: Option<&[PolicySettings]>,
    compiler: &mut Compiler<'_>,
    spoilt: &Spoilt<'_>,
    mistakes: &mut Mistakes,
) -> Option<CompiledUse> {
    let policy = policies.map(|policies| policy(code, &written.name, policies)).and_then(|found| mistakes.take(found));
    let known = &compiler.script.stages;
    let stages: Vec<_> = written.stages.iter().map(|named| stage(code, (&named.0, named.1), known, mistakes)).collect();
    let stages = stages.into_iter().try_fold(0_u32, |bits, stage| stage.map(|stage| bits | (1 << stage)));
    let read = written.condition.map(|expr| {
        let fine = !spoilt.touches(&span(code, expr), mistakes);
        let flag = fine.then(|| condition(code, expr, compiler)).and_then(|found| mistakes.take(found));
        flag.map(|flag| (flag, parts(code, expr, compiler)))
    });
    let (condition, parts) = match read {
        Some(read) => read.map(|(flag, parts)| (Some(flag), parts))?,
        None => (None, Vec::new()),
    };
    let start = explain::offset(&code.source, written.position);
    let (line, _) = code.source.position(start);
    let text = code.source.text[code.statement(start)].trim_end_matches(';').trim_end().to_owned();
    let text = RuleText { name: written.name.0.to_string(), line, text };
    let stages = (!written.stages.is_empty()).then_some(stages?);
    Some(CompiledUse { text, policy: policy?, stages, condition, parts })
}

fn policy(code: &Code, (name, at): &(ImmutableString, Position), policies: &[PolicySettings]) -> Result<usize> {
    if let Some(found) = policies.iter().position(|policy| policy.name == *name) {
        return Ok(found);
    }
    let message = format!("there is no policy \"{}\"", printable(name));
    let wrong = explain::mistake(&code.source, "E-SCRIPT-USE", *at, message, "not named by any policy(...)");
    let near = nearest_name(name, policies.iter().map(|policy| policy.name.as_str()));
    wrong
        .help(match near {
            Some(near) => format!("did you mean \"{}\"?", printable(near)),
            None => format!("name it first: policy(\"{}\", \"runs/NAME/1\");", printable(name)),
        })
        .fail()
}

fn condition(code: &Code, expr: &Expr, compiler: &mut Compiler<'_>) -> Result<Flag> {
    match compiler.clause(expr) {
        Some(Typed::Flag(flag)) => Ok(flag),
        Some(_) => Diagnostic::new("E-SCRIPT-USE", "a condition must be true or false")
            .at(&code.source, span(code, expr), "this is a number")
            .help("compare it: blue.size > 0.1")
            .fail(),
        None => {
            let message = "a use reads facts, measures, numbers and the functions of the table only".to_owned();
            explain::mistake(&code.source, "E-SCRIPT-USE", first(expr), message, "something else")
                .help("write the condition out: blue.size > 0.1 && laser.front < 2.0")
                .fail()
        }
    }
}
