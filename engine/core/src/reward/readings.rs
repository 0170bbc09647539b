//! What a condition reads, part by part: so that a reward can name the fact and the beam behind it.

use super::chain::{Chain, Link};
use super::compile::{Compiler, Typed};
use super::explain::offset;
use super::expression::{Flag, Inputs, Number, Slot};
use super::fact_table::{self, FACTS, Fact, Getter};
use super::facts::{decimal, greatest, least};
use super::source::Code;
use rhai::{AST, ASTNode, Expr};
use std::ops::Range;

/// A part of a condition, with what it read in one step.
#[derive(Debug, Clone, PartialEq)]
pub struct Evidence {
    /// Its bytes in the script.
    pub span: Range<usize>,
    /// Whether it held; nothing where only the whole condition was judged.
    pub holds: Option<bool>,
    /// The facts that it read.
    pub facts: Vec<FactRead>,
}

/// One fact as it was read in one step.
#[derive(Debug, Clone, PartialEq)]
pub struct FactRead {
    /// As it stands in the script: `laser.sector(50, 130).nearest`.
    pub name: String,
    /// Its value; flags are 0 or 1.
    pub value: f64,
    /// The unit, in words; empty for flags.
    pub unit: &'static str,
    /// The beam of the laser that made it so.
    pub beam: Option<usize>,
}

/// A part of a condition that is true or false by itself: what stands between `&&` and `||`.
#[derive(Debug)]
pub(super) struct Part {
    span: Range<usize>,
    flag: Option<Flag>,
    readings: Vec<Reading>,
}

#[derive(Debug)]
struct Reading {
    name: String,
    typed: Typed,
    unit: &'static str,
    look: Look,
}

/// Which beam to name.
#[derive(Debug, Clone, Copy)]
enum Look {
    Nowhere,
    One(usize),
    Middle,
    Last,
    Least(usize, usize),
    Greatest(usize, usize),
    Worst(usize, usize, usize),
}

const ALL: (usize, usize) = (0, usize::MAX);

/// The parts of a condition.
pub(super) fn parts(code: &Code, condition: &Expr, compiler: &mut Compiler<'_>) -> Vec<Part> {
    let uses = compiler.needs.slot_uses.len();
    let mut parts = Vec::new();
    add(code, condition, compiler, &mut parts);
    compiler.needs.slot_uses.truncate(uses);
    parts
}

/// `fn reward` as one part: what its body reads. The order of the tree is not that of the text, so it is sorted.
pub(super) fn function_parts(code: &Code, ast: &AST, name: &Range<usize>, compiler: &mut Compiler<'_>) -> Vec<Part> {
    let body = name.start..body_end(code, name.start);
    let uses = compiler.needs.slot_uses.len();
    let mut found = Vec::new();
    ast.clone_functions_only().walk(&mut |path: &[ASTNode<'_>]| {
        if let Some(ASTNode::Expr(expr)) = path.last() {
            collect(code, expr, compiler, &mut found);
        }
        true
    });
    compiler.needs.slot_uses.truncate(uses);
    found.retain(|(start, _)| body.contains(start));
    found.sort_by_key(|(start, _)| *start);
    let mut readings: Vec<Reading> = Vec::new();
    for (_, reading) in found {
        if !readings.iter().any(|known| known.name == reading.name) {
            readings.push(reading);
        }
    }
    // Under another name than 'facts' only whole names are found.
    let text = &code.plain[body];
    let is_named = |fact: &&Fact| {
        let after = |at: usize| text[at..].chars().next().is_none_or(|c| !c.is_alphanumeric() && c != '_');
        text.match_indices(&fact.name()).any(|(at, found)| after(at + found.len()))
    };
    for fact in FACTS.iter().filter(is_named) {
        if !readings.iter().any(|known| known.name == fact.name()) {
            readings.push(Reading::of_fact(fact));
        }
    }
    vec![Part { span: name.clone(), flag: None, readings }]
}

fn add(code: &Code, expr: &Expr, compiler: &mut Compiler<'_>, parts: &mut Vec<Part>) {
    if let Expr::And(all, _) | Expr::Or(all, _) = expr {
        return all.iter().for_each(|part| add(code, part, compiler, parts));
    }
    let start = offset(&code.source, super::rule::first(expr));
    let flag = match compiler.expression(expr) {
        Some(Typed::Flag(flag)) => Some(flag),
        _ => None,
    };
    parts.push(Part { span: start..part_end(code, start), flag, readings: readings(code, expr, compiler) });
}

fn readings(code: &Code, expr: &Expr, compiler: &mut Compiler<'_>) -> Vec<Reading> {
    let mut found = Vec::new();
    expr.walk(&mut Vec::new(), &mut |path: &[ASTNode<'_>]| {
        if let Some(ASTNode::Expr(expr)) = path.last() {
            collect(code, expr, compiler, &mut found);
        }
        true
    });
    found.into_iter().map(|(_, reading)| reading).collect()
}

/// Adds what an expression reads, with where it begins, if it is one fact.
fn collect(code: &Code, expr: &Expr, compiler: &mut Compiler<'_>, found: &mut Vec<(usize, Reading)>) {
    let Some(chain) = Chain::of(expr) else { return };
    let start = offset(&code.source, chain.position);
    // The outermost of a chain comes first; its parts begin where it begins.
    if found.iter().any(|(known, _)| *known == start) {
        return;
    }
    let typed = compiler.range(expr).map(Typed::Number).or_else(|| compiler.expression(expr));
    if let (Some(typed), Some((unit, look))) = (typed, describe(&chain, compiler)) {
        let name = code.source.text[start..chain_end(code, start)].trim_start_matches("facts.").to_owned();
        found.push((start, Reading { name, typed, unit, look }));
    }
}

/// The unit of a fact, and which beam to name with it.
fn describe(chain: &Chain<'_>, compiler: &mut Compiler<'_>) -> Option<(&'static str, Look)> {
    match chain.group()? {
        ("calibrated", _) => Some(("number", Look::Nowhere)),
        ("laser", []) => Some(("metres", Look::Least(ALL.0, ALL.1))),
        ("laser", [Link::Index(beam)]) => Some(("metres", Look::One(compiler.beam(beam)?))),
        ("laser", [Link::Call(call, _), rest @ ..]) => {
            let (from, to) = compiler.sector(call)?;
            Some(match rest {
                [] | [Link::Property("nearest", _)] => ("metres", Look::Least(from, to)),
                [Link::Property("farthest", _)] => ("metres", Look::Greatest(from, to)),
                [Link::Call(call, _)] if call.name == "count_below" => ("beams", Look::Least(from, to)),
                [Link::Call(call, _)] if call.name == "excess" => match compiler.expected(from, to, call) {
                    Some(slot) => ("metres", Look::Worst(from, to, slot)),
                    None => ("metres", Look::Nowhere),
                },
                _ => ("metres", Look::Nowhere),
            })
        }
        ("camera", [Link::Call(..)]) => Some(("share", Look::Nowhere)),
        (group, [Link::Property(key, _)]) => fact_table::find(group, key).map(|fact| (fact.unit, look_of_fact(fact))),
        _ => None,
    }
}

fn look_of_fact(fact: &Fact) -> Look {
    match (fact.group, fact.key) {
        ("laser", "nearest" | "nearest_beam") => Look::Least(ALL.0, ALL.1),
        ("laser", "farthest") => Look::Greatest(ALL.0, ALL.1),
        ("laser", "right") => Look::One(0),
        ("laser", "front") => Look::Middle,
        ("laser", "left") => Look::Last,
        _ => Look::Nowhere,
    }
}

impl Part {
    /// What it read.
    pub(super) fn evidence(&self, inputs: Inputs<'_>) -> Evidence {
        let facts = self.readings.iter().filter_map(|reading| reading.read(inputs)).collect();
        Evidence { span: self.span.clone(), holds: self.holds(inputs), facts }
    }

    fn holds(&self, inputs: Inputs<'_>) -> Option<bool> {
        self.flag.as_ref().map(|flag| flag.holds(inputs))
    }
}

/// The first beam that a condition's parts name, those that do not hold left out. Allocates nothing.
pub(super) fn beam(parts: &[Part], inputs: Inputs<'_>) -> Option<usize> {
    let holding = parts.iter().filter(|part| part.holds(inputs) != Some(false));
    holding.flat_map(|part| &part.readings).find_map(|reading| reading.look.beam(inputs))
}

impl Reading {
    fn of_fact(fact: &Fact) -> Self {
        let typed = match fact.get {
            Getter::Number(get) => Typed::Number(Number::Fact(get, fact.reach)),
            Getter::Whole(get) => Typed::Whole(Number::Whole(get)),
            Getter::Flag(get) => Typed::Flag(Flag::Fact(get)),
        };
        Self { name: fact.name(), typed, unit: fact.unit, look: look_of_fact(fact) }
    }

    fn read(&self, inputs: Inputs<'_>) -> Option<FactRead> {
        let value = match &self.typed {
            Typed::Number(number) | Typed::Whole(number) => number.value(inputs),
            Typed::Flag(flag) => f64::from(u8::from(flag.holds(inputs))),
        };
        // An array that was calibrated is no number.
        let read = FactRead { name: self.name.clone(), value, unit: self.unit, beam: self.look.beam(inputs) };
        (!value.is_nan()).then_some(read)
    }
}

impl Look {
    fn beam(self, inputs: Inputs<'_>) -> Option<usize> {
        let ranges_m = &inputs.facts.ranges_m;
        let last = ranges_m.len().checked_sub(1)?;
        let find = |from: usize, to: usize, choose: fn(&[f32]) -> f32| {
            let sector = ranges_m.get(from..=to.min(last))?;
            let wanted = choose(sector);
            sector.iter().position(|range| *range == wanted).map(|beam| from + beam)
        };
        match self {
            Self::Nowhere => None,
            Self::One(beam) => Some(beam),
            Self::Middle => Some(ranges_m.len() / 2),
            Self::Last => Some(last),
            Self::Least(from, to) => find(from, to, least),
            Self::Greatest(from, to) => find(from, to, greatest),
            Self::Worst(from, to, slot) => {
                let Some(Slot::Numbers(expected)) = inputs.slots.get(slot) else { return None };
                let sector = inputs.facts.sector_m(from, to).iter().zip(expected).enumerate();
                let excess = sector.map(|(beam, (range, expected))| (from + beam, decimal(*range) - expected));
                // The rightmost of equals, as with the nearest.
                excess.reduce(|a, b| if b.1 > a.1 { b } else { a }).map(|(beam, _)| beam)
            }
        }
    }
}

fn part_end(code: &Code, start: usize) -> usize {
    let stops = ["&&", "||", "=>", ";", ","];
    let keyword = |tail: &str, word: &str| {
        let rest = tail.strip_prefix(char::is_whitespace).and_then(|tail| tail.trim_start().strip_prefix(word));
        rest.is_some_and(|rest| rest.starts_with(char::is_whitespace))
    };
    end(code, start, |tail| stops.iter().any(|stop| tail.starts_with(stop)) || keyword(tail, "for"))
}

fn chain_end(code: &Code, start: usize) -> usize {
    let part = |c: char| c.is_alphanumeric() || matches!(c, '_' | '.' | '(' | '[');
    end(code, start, |tail| !tail.starts_with(part))
}

fn body_end(code: &Code, start: usize) -> usize {
    let open = code.plain[start..].find('{').map_or(code.plain.len(), |at| start + at);
    end(code, open + 1, |_| false)
}

/// Where a text ends: at the first `stop` outside of brackets, or where a bracket closes that was not opened in it.
fn end(code: &Code, start: usize, stop: impl Fn(&str) -> bool) -> usize {
    let tail = code.plain.get(start..).unwrap_or_default();
    let mut depth = 0_i32;
    for (index, c) in tail.char_indices() {
        match c {
            ')' | ']' | '}' if depth == 0 => return start + tail[..index].trim_end().len(),
            ')' | ']' | '}' => {
                depth -= 1;
                continue;
            }
            _ if depth == 0 && stop(&tail[index..]) => return start + tail[..index].trim_end().len(),
            '(' | '[' | '{' => depth += 1,
            _ => {}
        }
    }
    start + tail.trim_end().len()
}
