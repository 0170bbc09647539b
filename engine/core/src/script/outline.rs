//! What a script says, told apart for whoever looks for mistakes in it: comparisons, conditions, loops, names.

use super::bodies;
use super::chain::{Chain, Link};
use super::positions::first;
use super::source::Code;
use super::syntax::{WrittenRule, written_rules};
use crate::judge::explain::offset;
use crate::judge::expression::{Arithmetic, Comparison};
use crate::judge::fact_table::GROUPS;
use crate::judge::rule::Rule;
use rhai::{AST, Expr, Position, Scope};
use std::ops::Range;

/// A fact against a fixed number.
#[derive(Debug, Clone, PartialEq)]
pub struct Compared {
    /// The fact as its path, without spaces and without `facts.`: `laser.sector(50,130).nearest`.
    pub fact: String,
    /// Whether its absolute value is compared.
    pub absolute: bool,
    /// How; the fact stands on the left.
    pub comparison: Comparison,
    /// With what.
    pub limit: f64,
    /// Its bytes in the script, from the left side's first to the end of its line's expression at most.
    pub span: Range<usize>,
}

/// A condition as far as it is understood.
#[derive(Debug, Clone, PartialEq)]
pub enum Condition {
    /// A fact against a number.
    Compare(Compared),
    /// A fact that is true or false, and whether it is denied.
    Flag(String, bool),
    /// All of these.
    All(Vec<Condition>),
    /// Any of these.
    Any(Vec<Condition>),
    /// Something else.
    Other,
}

/// One rule.
#[derive(Debug, Clone, PartialEq)]
pub struct RuleOutline {
    /// Its condition.
    pub condition: Condition,
    /// The bytes of the condition.
    pub condition_span: Range<usize>,
    /// The bytes of the value.
    pub value_span: Range<usize>,
    /// The bytes of the time after `for`.
    pub time_span: Option<Range<usize>>,
    /// Whether it ends with `then recover`.
    pub recover: bool,
}

/// What a loop over the beams of the laser gathers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Gathers {
    /// How many there are of something.
    Count,
    /// A sum.
    Sum,
    /// Something else, most often the least.
    Other,
}

/// A loop in a function that reads the laser beam by beam.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BeamLoop {
    /// The bytes of its first line, from its first word.
    pub span: Range<usize>,
    /// The beams that it goes over, where these are plain numbers.
    pub beams: Option<(i64, i64)>,
    /// What it gathers.
    pub gathers: Gathers,
}

/// Something that stands in the script and that nothing uses.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnusedName {
    /// What it is: `constant`, `variable` or `function`.
    pub what: &'static str,
    /// Its name.
    pub name: String,
    /// The bytes of the name where it is defined.
    pub span: Range<usize>,
}

/// What a script says.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Outline {
    /// The rules in their order.
    pub rules: Vec<RuleOutline>,
    /// Comparisons in functions.
    pub comparisons: Vec<Compared>,
    /// Loops over beams in `fn reward` and what it calls.
    pub loops: Vec<BeamLoop>,
    /// The groups of facts that rules and `fn reward` read, in the order of the alphabet.
    pub groups: Vec<String>,
    /// Where the name of `fn reward` stands.
    pub reward: Option<Range<usize>>,
    /// Whether `fn reward` can ask for recovery.
    pub reward_recovers: bool,
    /// Names that nothing uses.
    pub unused: Vec<UnusedName>,
}

impl Outline {
    /// Whether anything can ask for recovery.
    #[must_use]
    pub fn recovers(&self) -> bool {
        self.reward_recovers || self.rules.iter().any(|rule| rule.recover)
    }

    /// Every comparison: of rules, then of functions.
    pub fn all_comparisons(&self) -> impl Iterator<Item = &Compared> {
        self.rules.iter().flat_map(|rule| rule.condition.comparisons()).chain(&self.comparisons)
    }

    pub(super) fn new(code: &Code, ast: &AST, constants: &Scope<'static>, rules: &[Rule]) -> Self {
        let mut outline = Self::default();
        let reader = Reader { code, constants };
        for (rule, written) in rules.iter().zip(written_rules(ast.statements())) {
            outline.rules.push(reader.rule(rule, &written));
        }
        bodies::read(&reader, ast, &mut outline);
        outline
    }
}

impl Condition {
    /// The comparisons in it.
    #[must_use]
    pub fn comparisons(&self) -> Vec<&Compared> {
        match self {
            Self::Compare(compared) => vec![compared],
            Self::All(parts) | Self::Any(parts) => parts.iter().flat_map(Self::comparisons).collect(),
            _ => Vec::new(),
        }
    }
}

/// Reads expressions of one script.
pub(super) struct Reader<'a> {
    pub code: &'a Code,
    pub constants: &'a Scope<'static>,
}

impl Reader<'_> {
    fn rule(&self, rule: &Rule, written: &WrittenRule<'_>) -> RuleOutline {
        RuleOutline {
            condition: self.condition(written.condition),
            condition_span: rule.condition_span.clone(),
            value_span: rule.value_span.clone(),
            time_span: written.time.map(|(time, _)| {
                let start = self.at(first(time));
                let tail = &self.code.plain[start..];
                start..start + tail[..tail.find("=>").unwrap_or(0)].trim_end().len()
            }),
            recover: rule.recover,
        }
    }

    pub(super) fn at(&self, position: Position) -> usize {
        offset(&self.code.source, position)
    }

    fn condition(&self, expr: &Expr) -> Condition {
        let parts = |parts: &[Expr]| parts.iter().map(|part| self.condition(part)).collect();
        match expr {
            Expr::And(all, _) => Condition::All(parts(all)),
            Expr::Or(any, _) => Condition::Any(parts(any)),
            Expr::FnCall(call, _) if call.name == "!" && call.args.len() == 1 => match self.condition(&call.args[0]) {
                Condition::Flag(fact, denied) => Condition::Flag(fact, !denied),
                Condition::Compare(compared) => {
                    Condition::Compare(Compared { comparison: compared.comparison.denied(), ..compared })
                }
                _ => Condition::Other,
            },
            Expr::FnCall(..) => self.compared(expr, &|_| None).map_or(Condition::Other, Condition::Compare),
            _ => self.fact(expr).map_or(Condition::Other, |fact| Condition::Flag(fact, false)),
        }
    }

    /// A comparison of a fact with a fixed number; `local` knows what local variables stand for.
    pub(super) fn compared(&self, expr: &Expr, local: &dyn Fn(&str) -> Option<Local>) -> Option<Compared> {
        let Expr::FnCall(call, _) = expr else { return None };
        let (comparison, [a, b]) = (Comparison::of(&call.name)?, call.args.as_slice()) else { return None };
        let (side, comparison, limit) = match (self.number(a, local), self.number(b, local)) {
            (None, Some(limit)) => (a, comparison, limit),
            (Some(limit), None) => (b, comparison.turned(), limit),
            _ => return None,
        };
        let (fact, absolute) = match side {
            Expr::FnCall(call, _) if call.name == "abs" && call.args.len() == 1 => (&call.args[0], true),
            fact => (fact, false),
        };
        let named = |name: &str| match local(name) {
            Some(Local::Fact(fact)) => Some(fact),
            _ => None,
        };
        let fact =
            self.fact(fact).or_else(|| Chain::of(fact).filter(|c| c.links.is_empty()).and_then(|c| named(c.root)))?;
        let start = self.at(first(expr));
        Some(Compared { fact, absolute, comparison, limit, span: start..self.expression_end(start) })
    }

    /// A number that does not depend on the step.
    pub(super) fn number(&self, expr: &Expr, local: &dyn Fn(&str) -> Option<Local>) -> Option<f64> {
        match expr {
            Expr::FloatConstant(value, _) => Some(**value),
            Expr::IntegerConstant(value, _) => Some(*value as f64),
            Expr::FnCall(call, _) => match (call.name.as_str(), call.args.as_slice()) {
                ("-", [of]) => self.number(of, local).map(|value| -value),
                (name, [a, b]) => {
                    let operator = Arithmetic::of(name)?;
                    Some(operator.apply(self.number(a, local)?, self.number(b, local)?))
                }
                _ => None,
            },
            Expr::Variable(..) => {
                let chain = Chain::of(expr).filter(|chain| chain.links.is_empty())?;
                if let Some(Local::Number(value)) = local(chain.root) {
                    return Some(value);
                }
                let value = self.constants.get(chain.root)?;
                value.as_float().ok().or_else(|| value.as_int().ok().map(|value| value as f64))
            }
            _ => None,
        }
    }

    /// The path of a fact.
    pub(super) fn fact(&self, expr: &Expr) -> Option<String> {
        let chain = Chain::of(expr)?;
        let is_group = |name: &str| GROUPS.iter().any(|(group, _)| *group == name);
        let (group, links) = match chain.links.split_first() {
            _ if is_group(chain.root) => (chain.root, chain.links.as_slice()),
            Some((Link::Property(group, _), rest)) if is_group(group) => (*group, rest),
            _ => return None,
        };
        let mut path = group.to_owned();
        // The laser, or a sector of it, compared with a number means its nearest.
        let nearest = match links {
            [] => group == "laser",
            [Link::Call(call, _)] => call.name == "sector",
            _ => false,
        };
        let plain = |expr: &Expr| self.number(expr, &|_| None);
        for link in links {
            match link {
                Link::Property(key, _) => path.push_str(&format!(".{key}")),
                Link::Index(beam) => path.push_str(&format!("[{}]", plain(beam)?)),
                Link::Call(call, _) => {
                    let arguments: Option<Vec<String>> =
                        call.args.iter().map(|argument| plain(argument).map(|value| value.to_string())).collect();
                    path.push_str(&format!(".{}({})", call.name, arguments.unwrap_or_default().join(",")));
                }
            }
        }
        if nearest {
            path.push_str(".nearest");
        }
        Some(path)
    }

    /// Where an expression that begins at `start` ends, at the end of its line at the latest.
    fn expression_end(&self, start: usize) -> usize {
        let tail = self.code.plain[start..].lines().next().unwrap_or_default();
        let mut depth = 0_i32;
        for (index, c) in tail.char_indices() {
            let rest = &tail[index..];
            match c {
                '(' | '[' => depth += 1,
                ')' | ']' => depth -= 1,
                _ => {}
            }
            let stop = ["&&", "||", "=>", ";", ",", "{", " for ", " then "].iter().any(|stop| rest.starts_with(stop));
            if depth < 0 || depth == 0 && stop {
                return start + tail[..index].trim_end().len();
            }
        }
        start + tail.trim_end().len()
    }
}

/// What a local variable of a function stands for.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Local {
    Number(f64),
    Fact(String),
}
