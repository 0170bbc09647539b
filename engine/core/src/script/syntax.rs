//! The forms of a rule and of a success: `rule "name" when CONDITION [for N steps | for N seconds] => VALUE [then recover | fail | goal | restart];`

use crate::outcome::Then;
use rhai::{CustomExpr, Dynamic, Engine, Expr, ImmutableString, LexError, ParseError, Position, Stmt};

/// Marks an error message as ours: it is shown as it stands.
pub(super) const OURS: &str = "rule";

/// The unit of a persistence.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum TimeUnit {
    Steps,
    Seconds,
}

/// A rule as it stands in the script's tree.
#[derive(Debug)]
pub(super) struct WrittenRule<'a> {
    pub name: &'a str,
    pub name_position: Position,
    pub position: Position,
    pub condition: &'a Expr,
    pub time: Option<(&'a Expr, TimeUnit)>,
    pub value: &'a Expr,
    pub then: Option<Then>,
    /// How many top-level variables stand before it.
    pub variables: usize,
}

/// A condition of success as it stands in the script's tree: `success "name" when CONDITION;`
#[derive(Debug)]
pub(super) struct WrittenSuccess<'a> {
    pub name: &'a str,
    pub name_position: Position,
    pub condition: &'a Expr,
}

/// Teaches the forms to an engine. Running them does nothing: they are read from the tree. The parser takes the first word of
/// a form wherever it stands, so `success` is taught only to a script that has such a statement.
pub(super) fn register(engine: &mut Engine, with_success: bool) {
    engine.register_custom_syntax_with_state_raw("rule", next, false, |_, _, _| Ok(Dynamic::UNIT));
    if with_success {
        engine.register_custom_syntax_with_state_raw("success", next_of_success, false, |_, _, _| Ok(Dynamic::UNIT));
    }
}

type Next = Result<Option<ImmutableString>, ParseError>;

fn expect(word: &str, ahead: &str, message: &str) -> Next {
    if ahead == word { Ok(Some(word.into())) } else { wrong(message) }
}

fn wrong(message: &str) -> Next {
    Err(LexError::ImproperSymbol(OURS.to_owned(), message.to_owned()).into_err(Position::NONE))
}

fn next(symbols: &[ImmutableString], ahead: &str, _: &mut Dynamic) -> Next {
    let expression = || Ok(Some("$expr$".into()));
    let Some(tail) = symbols.get(2..) else {
        return match ahead.starts_with('"') {
            true => Ok(Some("$string$".into())),
            false => wrong("a rule needs a name in quotes: rule \"too close\" when ..."),
        };
    };
    let before = tail.len().checked_sub(2).map_or("", |index| tail[index].as_str());
    match (tail.last().map_or("", |last| last.as_str()), before) {
        ("", _) => expect("when", ahead, "after the rule's name comes 'when' and a condition"),
        ("when", _) if matches!(ahead, "for" | "=>" | ";") => wrong("after 'when' comes a condition"),
        ("when", _) => expression(),
        ("for", _) => expression(),
        ("=>", _) if matches!(ahead, "then" | ";" | "{EOF}") => {
            wrong("this rule has no value: after '=>' comes a number, such as -1")
        }
        ("=>", _) => expression(),
        ("$expr$", "when") if ahead == "for" => Ok(Some("for".into())),
        ("$expr$", "when") => {
            expect("=>", ahead, "after the condition comes 'for N steps', 'for N seconds', or '=>' and a value")
        }
        ("$expr$", "for") if matches!(ahead, "steps" | "step" | "seconds" | "second") => Ok(Some(ahead.into())),
        ("$expr$", "for") => wrong("a time needs its unit: 'for 10 steps' or 'for 5 seconds'"),
        ("$expr$", "=>") if ahead == "then" => Ok(Some("then".into())),
        ("$expr$", "=>") => Ok(None),
        ("steps" | "step" | "seconds" | "second", _) => {
            expect("=>", ahead, "this rule has no value: after the time comes '=>' and a number, such as -1")
        }
        ("then", _) if Then::of(ahead).is_some() => Ok(Some(ahead.into())),
        ("then", _) => wrong("after 'then' comes recover, fail, goal or restart"),
        _ => Ok(None),
    }
}

fn next_of_success(symbols: &[ImmutableString], ahead: &str, _: &mut Dynamic) -> Next {
    match symbols {
        [_] if ahead.starts_with('"') => Ok(Some("$string$".into())),
        [_] => wrong("a condition of success needs a name in quotes: success \"drives round\" when ..."),
        [_, _] => expect("when", ahead, "after the name of a success comes 'when' and a condition"),
        [_, _, _] if matches!(ahead, ";" | "{EOF}") => wrong("after 'when' comes a condition: test.laps >= 5"),
        [_, _, _] => Ok(Some("$expr$".into())),
        _ => Ok(None),
    }
}

/// Whether an expression is a rule.
pub(super) fn is_rule_expr(expr: &Expr) -> bool {
    matches!(expr, Expr::Custom(custom, _) if custom.tokens.first().is_some_and(|word| word == "rule"))
}

/// Whether an expression is a condition of success.
pub(super) fn is_success_expr(expr: &Expr) -> bool {
    matches!(expr, Expr::Custom(custom, _) if custom.tokens.first().is_some_and(|word| word == "success"))
}

/// Whether a statement is a rule or a condition of success.
pub(super) fn is_form(statement: &Stmt) -> bool {
    matches!(statement, Stmt::Expr(expr) if matches!(**expr, Expr::Custom(..)))
}

/// The conditions of success that stand at the top level, in their order.
pub(super) fn written_successes(statements: &[Stmt]) -> Vec<WrittenSuccess<'_>> {
    statements.iter().filter_map(written_success).collect()
}

fn written_success(statement: &Stmt) -> Option<WrittenSuccess<'_>> {
    let Stmt::Expr(expr) = statement else { return None };
    let (Expr::Custom(custom, _), true) = (&**expr, is_success_expr(expr)) else { return None };
    let [Expr::StringConstant(name, name_position), condition] = custom.inputs.as_slice() else { return None };
    Some(WrittenSuccess { name, name_position: *name_position, condition })
}

/// The rules that stand at the top level, in their order.
pub(super) fn written_rules(statements: &[Stmt]) -> Vec<WrittenRule<'_>> {
    let mut variables = 0;
    let mut rules = Vec::new();
    for statement in statements {
        match statement {
            Stmt::Var(variable, ..) if variable.2.is_none() => variables += 1,
            Stmt::Expr(expr) => {
                if let (Expr::Custom(custom, position), true) = (&**expr, is_rule_expr(expr)) {
                    rules.extend(read(custom, *position, variables));
                }
            }
            _ => {}
        }
    }
    rules
}

fn read(custom: &CustomExpr, position: Position, variables: usize) -> Option<WrittenRule<'_>> {
    let (Expr::StringConstant(name, name_position), rest) = custom.inputs.split_first()? else {
        return None;
    };
    let word = |wanted: &[&str]| custom.tokens.iter().skip(2).any(|token| wanted.contains(&token.as_str()));
    let unit = if word(&["seconds", "second"]) { TimeUnit::Seconds } else { TimeUnit::Steps };
    let (condition, time, value) = match rest {
        [condition, value] => (condition, None, value),
        [condition, time, value] => (condition, Some((time, unit)), value),
        _ => return None,
    };
    let then = custom.tokens.last().and_then(|last| Then::of(last));
    let name_position = *name_position;
    Some(WrittenRule { name, name_position, position, condition, time, value, then, variables })
}
