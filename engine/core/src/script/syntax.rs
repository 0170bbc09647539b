//! The forms that the language adds to Rhai: rules, conditions of success, measures, guards, uses.
//!
//! ```text
//! rule "name" [in "stage", ...] when CONDITION [for N steps | for N seconds] [once] => VALUE [per second]
//!             [then recover | fail | goal | restart [to "place"]] [then stage "name"];
//! success "name" when CONDITION;
//! measure name = EXPRESSION;
//! forbid "name" when CONDITION => CONDITION OF THE ACTION;
//! use "policy" [in "stage", ...] [when CONDITION];
//! ```

use super::guards::next_of_forbid;
use super::source::Code;
use super::state_parts;
use super::uses::next_of_use;
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
    /// The stages in which it is judged; none for all.
    pub stages: Vec<(&'a str, Position)>,
    pub condition: &'a Expr,
    pub time: Option<(&'a Expr, TimeUnit)>,
    pub once: bool,
    pub value: &'a Expr,
    pub per_second: bool,
    pub then: Option<Then>,
    /// Where the next attempt begins.
    pub to_place: Option<(&'a str, Position)>,
    /// The stage that it leads to.
    pub to_stage: Option<(&'a str, Position)>,
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

/// A measure as it stands in the script's tree: `measure name = EXPRESSION;`
#[derive(Debug)]
pub(super) struct WrittenMeasure<'a> {
    pub name: &'a str,
    pub name_position: Position,
    pub expression: &'a Expr,
}

/// The forms that a script has besides rules. The parser takes the first word of a form wherever it stands, so each is taught
/// only to a script with such a statement: in others the word stays the script's own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Forms {
    pub success: bool,
    pub measure: bool,
    pub bins: bool,
    pub forbid: bool,
    pub uses: bool,
}

impl Forms {
    /// The forms that a script has.
    pub(super) fn of(code: &Code) -> Self {
        let named = |tail: &str| {
            let name = tail.trim_start_matches(|c: char| c.is_alphanumeric() || c == '_');
            name.len() < tail.len() && name.trim_start().starts_with('=') && !name.trim_start().starts_with("==")
        };
        Self {
            success: begins_a_statement(code, "success", |tail| tail.starts_with('"')),
            measure: begins_a_statement(code, "measure", named),
            bins: begins_a_statement(code, "state", |tail| tail.starts_with('('))
                && code.names("bins")
                && !code.defines("bins"),
            forbid: begins_a_statement(code, "forbid", |tail| tail.starts_with('"')),
            uses: begins_a_statement(code, "use", |tail| tail.starts_with('"')),
        }
    }
}

/// Whether a statement begins with a word, followed by something that the form needs.
pub(super) fn begins_a_statement(code: &Code, word: &str, follows: impl Fn(&str) -> bool) -> bool {
    let ends = |text: &str| text.trim_end().is_empty() || text.trim_end().ends_with([';', '}']);
    let spaced = |tail: &str| tail.starts_with(|c: char| c.is_whitespace() || matches!(c, '"' | '('));
    code.plain.match_indices(word).any(|(at, _)| {
        let tail = &code.plain[at + word.len()..];
        ends(&code.plain[..at]) && spaced(tail) && follows(tail.trim_start())
    })
}

/// Teaches the forms to an engine. Running them does nothing: they are read from the tree.
pub(super) fn register(engine: &mut Engine, forms: Forms) {
    engine.register_custom_syntax_with_state_raw("rule", next, false, |_, _, _| Ok(Dynamic::UNIT));
    if forms.success {
        engine.register_custom_syntax_with_state_raw("success", next_of_success, false, |_, _, _| Ok(Dynamic::UNIT));
    }
    if forms.bins {
        state_parts::register(engine);
    }
    if forms.measure {
        engine.register_custom_syntax_with_state_raw("measure", next_of_measure, false, |_, _, _| Ok(Dynamic::UNIT));
    }
    if forms.forbid {
        engine.register_custom_syntax_with_state_raw("forbid", next_of_forbid, false, |_, _, _| Ok(Dynamic::UNIT));
    }
    if forms.uses {
        engine.register_custom_syntax_with_state_raw("use", next_of_use, false, |_, _, _| Ok(Dynamic::UNIT));
    }
}

pub(super) type Next = Result<Option<ImmutableString>, ParseError>;

pub(super) fn expect(word: &str, ahead: &str, message: &str) -> Next {
    if ahead == word { Ok(Some(word.into())) } else { wrong(message) }
}

pub(super) fn wrong(message: &str) -> Next {
    Err(LexError::ImproperSymbol(OURS.to_owned(), message.to_owned()).into_err(Position::NONE))
}

/// What of a rule has been read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Read {
    Rule,
    Name,
    In,
    Stage,
    When,
    Condition,
    For,
    Time,
    Unit,
    Once,
    Arrow,
    Value,
    Per,
    Second,
    Then,
    ThenStage,
    Outcome,
    To,
    End,
}

fn next(_: &[ImmutableString], ahead: &str, state: &mut Dynamic) -> Next {
    let read = state.clone().try_cast::<Read>().unwrap_or(Read::Rule);
    let (symbol, read) = match step(read, ahead) {
        Ok(Some(next)) => next,
        Ok(None) => return Ok(None),
        Err(message) => return wrong(message),
    };
    *state = Dynamic::from(read);
    Ok(Some(symbol.into()))
}

/// What is wrong with a word of a rule that stands where another one should.
fn out_of_order(read: Read, ahead: &str) -> Option<&'static str> {
    const ORDER: &str = "the order of a rule is: in, when, for, once, =>, per second, then";
    Some(match (read, ahead) {
        (Read::Name | Read::Stage, "for" | "once" | "per" | "then" | "=>") => ORDER,
        (Read::Condition, "in" | "per" | "then") | (Read::Once, "for" | "in" | "per") => ORDER,
        (Read::Value, "once" | "for" | "in" | "when") => ORDER,
        (Read::Condition, ",") => "conditions are joined with '&&' (and) or '||' (or), and a number has a point: 0.25",
        (Read::Value | Read::Second, "to") => "'to' stands behind what ends the attempt: then fail to \"nearest\"",
        (Read::Outcome | Read::End, "then") => "a rule has one 'then': write a second rule",
        _ => return None,
    })
}

/// The next symbol of a rule and what has been read with it; nothing at its end.
fn step(read: Read, ahead: &str) -> Result<Option<(&str, Read)>, &'static str> {
    const EXPRESSION: &str = "$expr$";
    const TEXT: &str = "$string$";
    if let Some(message) = out_of_order(read, ahead) {
        return Err(message);
    }
    let text = ahead.starts_with('"');
    Ok(Some(match read {
        Read::Rule if text => (TEXT, Read::Name),
        Read::Rule => return Err("a rule needs a name in quotes: rule \"too close\" when ..."),
        Read::Name if ahead == "in" => (ahead, Read::In),
        Read::In if text => (TEXT, Read::Stage),
        Read::In => {
            return Err("after 'in' comes the name of a stage in quotes: rule \"found\" in \"search\" when ...");
        }
        Read::Stage if ahead == "," => (ahead, Read::In),
        Read::Name | Read::Stage if ahead == "when" => (ahead, Read::When),
        Read::Name => return Err("after the rule's name comes 'when' and a condition"),
        Read::Stage => return Err("after the stages comes 'when' and a condition"),
        Read::When if matches!(ahead, "for" | "=>" | ";") => return Err("after 'when' comes a condition"),
        Read::When => (EXPRESSION, Read::Condition),
        Read::Condition if ahead == "for" => (ahead, Read::For),
        Read::For => (EXPRESSION, Read::Time),
        Read::Time if matches!(ahead, "steps" | "step" | "seconds" | "second") => (ahead, Read::Unit),
        Read::Time => return Err("a time needs its unit: 'for 10 steps' or 'for 5 seconds'"),
        Read::Condition | Read::Unit if ahead == "once" => (ahead, Read::Once),
        Read::Condition | Read::Unit | Read::Once if ahead == "=>" => (ahead, Read::Arrow),
        Read::Condition => {
            return Err("after the condition comes 'for N steps', 'for N seconds', 'once', or '=>' and a value");
        }
        Read::Unit => return Err("this rule has no value: after the time comes '=>' and a number, such as -1"),
        Read::Once => return Err("this rule has no value: after 'once' comes '=>' and a number, such as 1"),
        Read::Arrow if matches!(ahead, "then" | "per" | ";" | "{EOF}") => {
            return Err("this rule has no value: after '=>' comes a number, such as -1");
        }
        Read::Arrow => (EXPRESSION, Read::Value),
        Read::Value if ahead == "per" => (ahead, Read::Per),
        Read::Per if ahead == "second" => (ahead, Read::Second),
        Read::Per => return Err("a value is for one step, or 'per second'"),
        Read::Value | Read::Second if ahead == "then" => (ahead, Read::Then),
        Read::Then if ahead == "stage" => (ahead, Read::ThenStage),
        Read::Then if Then::of(ahead).is_some() => (ahead, Read::Outcome),
        Read::Outcome if ahead == "to" => (ahead, Read::To),
        Read::To if text => (TEXT, Read::End),
        Read::To => {
            return Err(
                "after 'to' comes the name of a start in quotes, or \"nearest\", \"random\", \"start\", \"behind\"",
            );
        }
        Read::Then => return Err("after 'then' comes recover, fail, goal, restart, or stage \"name\""),
        Read::ThenStage if text => (TEXT, Read::End),
        Read::ThenStage => return Err("after 'then stage' comes the name of a stage in quotes"),
        Read::Value | Read::Second | Read::Outcome | Read::End => return Ok(None),
    }))
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

fn next_of_measure(symbols: &[ImmutableString], ahead: &str, _: &mut Dynamic) -> Next {
    match symbols {
        [_] => Ok(Some("$ident$".into())),
        [_, _] => expect("=", ahead, "after the name of a measure comes '=' and an expression"),
        [_, _, _] if matches!(ahead, ";" | "{EOF}") => {
            wrong("after '=' comes an expression: measure gap = laser.front;")
        }
        [_, _, _] => Ok(Some("$expr$".into())),
        _ => Ok(None),
    }
}

pub(super) fn is_form_of(expr: &Expr, word: &str) -> bool {
    matches!(expr, Expr::Custom(custom, _) if custom.tokens.first().is_some_and(|first| first == word))
}

/// Whether an expression is a rule.
pub(super) fn is_rule_expr(expr: &Expr) -> bool {
    is_form_of(expr, "rule")
}

/// Whether an expression is a condition of success.
pub(super) fn is_success_expr(expr: &Expr) -> bool {
    is_form_of(expr, "success")
}

/// Whether an expression is a measure.
pub(super) fn is_measure_expr(expr: &Expr) -> bool {
    is_form_of(expr, "measure")
}

/// The form that a statement is.
pub(super) fn form(statement: &Stmt) -> Option<(&Expr, &CustomExpr, Position)> {
    let Stmt::Expr(expr) = statement else { return None };
    let Expr::Custom(custom, position) = &**expr else { return None };
    Some((expr, custom, *position))
}

/// Whether a statement is a form.
pub(super) fn is_form(statement: &Stmt) -> bool {
    form(statement).is_some()
}

/// The conditions of success that stand at the top level, in their order.
pub(super) fn written_successes(statements: &[Stmt]) -> Vec<WrittenSuccess<'_>> {
    let written = statements.iter().filter_map(|statement| {
        let (_, custom, _) = form(statement).filter(|(expr, ..)| is_success_expr(expr))?;
        let [Expr::StringConstant(name, name_position), condition] = custom.inputs.as_slice() else { return None };
        Some(WrittenSuccess { name, name_position: *name_position, condition })
    });
    written.collect()
}

/// The measures that stand at the top level, in their order.
pub(super) fn written_measures(statements: &[Stmt]) -> Vec<WrittenMeasure<'_>> {
    let written = statements.iter().filter_map(|statement| {
        let (_, custom, _) = form(statement).filter(|(expr, ..)| is_measure_expr(expr))?;
        let [Expr::Variable(name, _, name_position), expression] = custom.inputs.as_slice() else { return None };
        Some(WrittenMeasure { name: &name.1, name_position: *name_position, expression })
    });
    written.collect()
}

/// The rules that stand at the top level, in their order.
pub(super) fn written_rules(statements: &[Stmt]) -> Vec<WrittenRule<'_>> {
    let mut variables = 0;
    let mut rules = Vec::new();
    for statement in statements {
        if matches!(statement, Stmt::Var(variable, ..) if variable.2.is_none()) {
            variables += 1;
        }
        if let Some((_, custom, position)) = form(statement).filter(|(expr, ..)| is_rule_expr(expr)) {
            rules.extend(read(custom, position, variables));
        }
    }
    rules
}

/// A rule from its words and what stands between them.
fn read(custom: &CustomExpr, position: Position, variables: usize) -> Option<WrittenRule<'_>> {
    let mut inputs = custom.inputs.iter();
    let (mut word, mut name, mut stages, mut to_stage, mut to_place) = ("rule", None, Vec::new(), None, None);
    let (mut condition, mut time, mut unit, mut value, mut then) = (None, None, TimeUnit::Steps, None, None);
    let (mut once, mut per_second) = (false, false);
    for token in custom.tokens.iter().skip(1) {
        match token.as_str() {
            "$string$" => {
                let Expr::StringConstant(text, position) = inputs.next()? else { return None };
                match word {
                    "in" | "," => stages.push((text.as_str(), *position)),
                    "to" => to_place = Some((text.as_str(), *position)),
                    "stage" => to_stage = Some((text.as_str(), *position)),
                    _ => name = Some((text.as_str(), *position)),
                }
            }
            "$expr$" => {
                let expr = inputs.next()?;
                match word {
                    "when" => condition = Some(expr),
                    "for" => time = Some(expr),
                    _ => value = Some(expr),
                }
            }
            known => {
                match (word, known) {
                    ("per", _) => per_second = true,
                    ("then", known) => then = Then::of(known),
                    (_, "seconds" | "second") => unit = TimeUnit::Seconds,
                    (_, "once") => once = true,
                    _ => {}
                }
                word = known;
            }
        }
    }
    let (name, name_position) = name?;
    let (condition, value, time) = (condition?, value?, time.map(|time| (time, unit)));
    Some(WrittenRule {
        name,
        name_position,
        position,
        stages,
        condition,
        time,
        once,
        value,
        per_second,
        then,
        to_place,
        to_stage,
        variables,
    })
}
