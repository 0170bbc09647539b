//! Expressions of a script read for its outline: conditions, comparisons, numbers, facts.

use super::access::{Access, Link, fact_of};
use super::outline::{Compared, Condition, NamedFact, RuleOutline};
use super::positions::{first, line_end};
use super::source::Code;
use super::syntax::{WrittenMeasure, WrittenRule};
use crate::judge::explain::offset;
use crate::judge::expression::{Arithmetic, Comparison};
use crate::judge::fact_table::FactId;
use crate::judge::rule::CompiledRule;
use rhai::{Expr, Position, Scope};

/// Reads expressions of one script.
pub(super) struct OutlineReader<'a> {
    pub code: &'a Code,
    pub constants: &'a Scope<'static>,
    /// The measures: a fact that a measure stands for is the measure's.
    pub measures: Vec<WrittenMeasure<'a>>,
}

impl<'a> OutlineReader<'a> {
    /// The outline of one rule.
    pub(super) fn rule(&self, rule: &CompiledRule, written: &WrittenRule<'_>) -> RuleOutline {
        RuleOutline {
            condition: self.condition(written.condition),
            condition_span: rule.condition_span.clone(),
            value_span: rule.value_span.clone(),
            time_span: written.time.map(|(time, _)| {
                let start = self.at(first(time));
                let tail = &self.code.plain[start..];
                start..start + tail[..tail.find("=>").unwrap_or(0)].trim_end().len()
            }),
            then: rule.then,
            stages: rule.stages,
            leads_to: rule.to_stage,
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
            _ => match (self.measure(expr), self.fact(expr)) {
                (Some(measure), _) => self.condition(measure),
                (None, fact) => fact.map_or(Condition::Other, |fact| Condition::Flag(fact, false)),
            },
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
            self.fact(fact).or_else(|| Access::of(fact).filter(|c| c.links.is_empty()).and_then(|c| named(c.root)))?;
        let start = self.at(first(expr));
        Some(Compared { fact, absolute, comparison, limit, span: start..line_end(self.code, start) })
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
                let access = Access::of(expr).filter(|access| access.links.is_empty())?;
                if let Some(Local::Number(value)) = local(access.root) {
                    return Some(value);
                }
                let value = self.constants.get(access.root)?;
                value.as_float().ok().or_else(|| value.as_int().ok().map(|value| value as f64))
            }
            _ => None,
        }
    }

    /// What a measure stands for, where one is named; it reads only those above it.
    fn measure(&self, expr: &Expr) -> Option<&'a Expr> {
        let access = Access::of(expr).filter(|access| access.links.is_empty())?;
        self.measures.iter().find(|measure| measure.name == access.root).map(|measure| measure.expression)
    }

    /// A fact with its path.
    pub(super) fn fact(&self, expr: &Expr) -> Option<NamedFact> {
        if let Some(measure) = self.measure(expr) {
            return self.fact(measure);
        }
        let access = Access::of(expr)?;
        let is_group = |name: &str| self.code.views.group_of(name).is_some();
        let (group, links) = match access.links.split_first() {
            _ if is_group(access.root) => (access.root, access.links.as_slice()),
            Some((Link::Property(group, _), rest)) if is_group(group) => (*group, rest),
            _ => return None,
        };
        let fact = fact_of(self.code.views.group_of(group)?, links)?;
        let mut path = group.to_owned();
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
        // The laser, or a sector of it, compared with a number means its nearest.
        if matches!(
            (fact.id, links.last()),
            (FactId::LaserNearest, None) | (FactId::SectorNearest, Some(Link::Call(..)))
        ) {
            path.push_str(".nearest");
        }
        Some(NamedFact { id: fact.id, path })
    }
}

/// What a local variable of a function stands for.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Local {
    Number(f64),
    Fact(NamedFact),
}
