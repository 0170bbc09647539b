//! Conditions and values as small native trees: what a rule costs is what they cost.

use super::fact_columns::Getter;
use super::fact_table::{Fact, FactId};
use super::facts::{self, Facts};
use super::memory::Memory;
use super::view_facts::ViewFacts;

/// A part of what `fn calibrate` returned, as rules read it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Slot {
    Number(f64),
    Numbers(Vec<f64>),
    Other,
}

/// What a tree reads.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StepFacts<'a> {
    pub facts: &'a Facts,
    /// Those of the step before.
    pub previous: &'a Facts,
    pub slots: &'a [Slot],
    pub memory: &'a Memory,
}

/// Some neighbouring beams of the laser.
#[derive(Debug, Clone, Copy)]
pub(crate) enum BeamSpan {
    /// From one number to another, both included.
    Numbers(usize, usize),
    /// From one bearing to another, degrees.
    Bearings(f64, f64),
}

/// An operator between two numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Arithmetic {
    Add,
    Subtract,
    Multiply,
    Divide,
    Remainder,
}

/// A comparison of two numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Comparison {
    /// `<`
    Less,
    /// `<=`
    LessOrEqual,
    /// `>`
    Greater,
    /// `>=`
    GreaterOrEqual,
    /// `==`
    Equal,
    /// `!=`
    Unequal,
}

/// A tree with a number as its value.
#[derive(Debug, Clone)]
pub(crate) enum Number {
    Constant(f64),
    Fact(fn(&Facts) -> f64, FactId),
    Whole(fn(&Facts) -> i64, FactId),
    Beam(usize),
    /// Of a view, the first one being 0.
    View(usize, fn(&ViewFacts) -> f64, FactId),
    ViewWhole(usize, fn(&ViewFacts) -> i64, FactId),
    /// View, row, column.
    Cell(usize, usize, usize),
    /// View, and some of its rows or columns.
    Band(usize, fn(&ViewFacts, usize, usize) -> f64, (usize, usize)),
    BeamAt(f64),
    Sector(BeamSpan, fn(&[f32]) -> f64),
    CountBelow(BeamSpan, Box<Number>),
    /// How many beams met anything.
    Hits(BeamSpan),
    Excess(usize, usize, usize),
    /// 1 for true, 0 for false.
    Truth(Box<Flag>),
    /// The first where it holds, else the second.
    Choose(Box<Flag>, Box<[Number; 2]>),
    /// A number of the step before.
    Before(Box<Number>),
    /// What was worked out before the rules: a measure or a window.
    Remembered(usize),
    /// How often a rule has fired, and how long ago.
    Fired(usize),
    Since(usize),
    Calibrated(usize),
    Negate(Box<Number>),
    Binary(Arithmetic, Box<[Number; 2]>),
    OfOne(fn(f64) -> f64, Box<Number>),
    OfTwo(fn(f64, f64) -> f64, Box<[Number; 2]>),
}

/// A tree that is true or false.
#[derive(Debug, Clone)]
pub(crate) enum Flag {
    Constant(bool),
    Fact(fn(&Facts) -> bool),
    View(usize, fn(&ViewFacts) -> bool),
    Hit(usize),
    HitAt(f64),
    Stage(usize),
    Before(Box<Flag>),
    Remembered(usize),
    Compare(Comparison, Box<[Number; 2]>),
    Same(Box<[Flag; 2]>),
    Not(Box<Flag>),
    And(Vec<Flag>),
    Or(Vec<Flag>),
}

/// A native tree with its kind. Whole numbers are told apart because their division and overflow differ.
#[derive(Debug, Clone)]
pub(crate) enum Typed {
    Number(Number),
    Whole(Number),
    Flag(Flag),
}

impl Typed {
    /// A fact that is read without arguments, of this view if it is one of a view; nothing for others.
    pub(crate) const fn of_fact(fact: &Fact, view: usize) -> Option<Self> {
        match fact.get {
            Getter::Number(get) => Some(Self::Number(Number::Fact(get, fact.id))),
            Getter::Whole(get) => Some(Self::Whole(Number::Whole(get, fact.id))),
            Getter::Flag(get) => Some(Self::Flag(Flag::Fact(get))),
            Getter::ViewNumber(get) => Some(Self::Number(Number::View(view, get, fact.id))),
            Getter::ViewWhole(get) => Some(Self::Whole(Number::ViewWhole(view, get, fact.id))),
            Getter::ViewFlag(get) => Some(Self::Flag(Flag::View(view, get))),
            Getter::Sector(_) | Getter::Hits | Getter::Call(..) => None,
        }
    }
}

impl Number {
    // Most rules compare a fact with a constant: these two are worth a way of their own, without a call.
    #[inline]
    pub(crate) fn value(&self, inputs: StepFacts<'_>) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::Fact(get, _) => get(inputs.facts),
            tree => tree.branch(inputs),
        }
    }

    fn branch(&self, inputs: StepFacts<'_>) -> f64 {
        match self {
            Self::Constant(_) | Self::Fact(..) => self.value(inputs),
            Self::Whole(get, _) => get(inputs.facts) as f64,
            Self::Beam(beam) => inputs.facts.beam_m(*beam),
            Self::View(view, get, _) => get(inputs.facts.view(*view)),
            Self::ViewWhole(view, get, _) => get(inputs.facts.view(*view)) as f64,
            Self::Cell(view, row, column) => inputs.facts.view(*view).cell(*row, *column),
            Self::Band(view, get, (from, to)) => get(inputs.facts.view(*view), *from, *to),
            Self::BeamAt(bearing) => inputs.facts.beam_m(inputs.facts.beam_at(*bearing)),
            Self::Sector(span, get) => get(span.ranges_m(inputs.facts)),
            Self::CountBelow(span, limit) => {
                facts::count_below(span.ranges_m(inputs.facts), limit.value(inputs)) as f64
            }
            Self::Hits(span) => facts::count_below(span.ranges_m(inputs.facts), inputs.facts.laser_range_m.1) as f64,
            Self::Truth(flag) => f64::from(u8::from(flag.holds(inputs))),
            Self::Choose(flag, pair) => pair[usize::from(!flag.holds(inputs))].value(inputs),
            Self::Before(of) => of.value(inputs.before()),
            Self::Remembered(index) => inputs.memory.value(*index),
            Self::Fired(rule) => inputs.memory.fired(*rule),
            Self::Since(rule) => inputs.memory.since_s(*rule),
            Self::Excess(from, to, slot) => match inputs.slots.get(*slot) {
                Some(Slot::Numbers(expected)) => facts::excess(inputs.facts.sector_m(*from, *to), expected),
                _ => f64::NAN,
            },
            Self::Calibrated(slot) => match inputs.slots.get(*slot) {
                Some(Slot::Number(value)) => *value,
                _ => f64::NAN,
            },
            Self::Negate(of) => -of.value(inputs),
            Self::Binary(operator, pair) => operator.apply(pair[0].value(inputs), pair[1].value(inputs)),
            Self::OfOne(function, of) => function(of.value(inputs)),
            Self::OfTwo(function, pair) => function(pair[0].value(inputs), pair[1].value(inputs)),
        }
    }
}

impl Flag {
    pub(crate) fn holds(&self, inputs: StepFacts<'_>) -> bool {
        match self {
            Self::Constant(value) => *value,
            Self::Fact(get) => get(inputs.facts),
            Self::View(view, get) => get(inputs.facts.view(*view)),
            Self::Hit(beam) => inputs.facts.hit(*beam),
            Self::HitAt(bearing) => inputs.facts.hit(inputs.facts.beam_at(*bearing)),
            Self::Stage(stage) => inputs.facts.stage.index == *stage,
            Self::Before(of) => of.holds(inputs.before()),
            Self::Remembered(index) => inputs.memory.value(*index) != 0.0,
            Self::Compare(comparison, pair) => comparison.holds(pair[0].value(inputs), pair[1].value(inputs)),
            Self::Same(pair) => pair[0].holds(inputs) == pair[1].holds(inputs),
            Self::Not(of) => !of.holds(inputs),
            Self::And(all) => all.iter().all(|flag| flag.holds(inputs)),
            Self::Or(any) => any.iter().any(|flag| flag.holds(inputs)),
        }
    }
}

impl<'a> StepFacts<'a> {
    /// The step before in the place of the present one; what is remembered stays as it is.
    fn before(self) -> Self {
        Self { facts: self.previous, ..self }
    }
}

impl BeamSpan {
    /// The numbers of its first and its last beam.
    pub(crate) fn numbers(self, facts: &Facts) -> (usize, usize) {
        match self {
            Self::Numbers(from, to) => (from, to),
            Self::Bearings(from, to) => facts.beams_between(from, to),
        }
    }

    fn ranges_m(self, facts: &Facts) -> &[f32] {
        let (from, to) = self.numbers(facts);
        facts.sector_m(from, to)
    }
}

impl Arithmetic {
    pub(crate) fn of(symbol: &str) -> Option<Self> {
        Some(match symbol {
            "+" => Self::Add,
            "-" => Self::Subtract,
            "*" => Self::Multiply,
            "/" => Self::Divide,
            "%" => Self::Remainder,
            _ => return None,
        })
    }

    pub(crate) fn apply(self, a: f64, b: f64) -> f64 {
        match self {
            Self::Add => a + b,
            Self::Subtract => a - b,
            Self::Multiply => a * b,
            Self::Divide => a / b,
            Self::Remainder => a % b,
        }
    }
}

impl Comparison {
    /// All of them, each with its symbol.
    pub(crate) const ALL: [(&str, Self); 6] = [
        ("<", Self::Less),
        ("<=", Self::LessOrEqual),
        (">", Self::Greater),
        (">=", Self::GreaterOrEqual),
        ("==", Self::Equal),
        ("!=", Self::Unequal),
    ];

    pub(crate) fn of(symbol: &str) -> Option<Self> {
        Self::ALL.iter().find(|(known, _)| *known == symbol).map(|(_, comparison)| *comparison)
    }

    /// The comparison with its sides exchanged.
    pub(crate) const fn turned(self) -> Self {
        match self {
            Self::Less => Self::Greater,
            Self::LessOrEqual => Self::GreaterOrEqual,
            Self::Greater => Self::Less,
            Self::GreaterOrEqual => Self::LessOrEqual,
            same => same,
        }
    }

    /// What holds where this does not.
    pub(crate) const fn denied(self) -> Self {
        match self {
            Self::Less => Self::GreaterOrEqual,
            Self::LessOrEqual => Self::Greater,
            Self::Greater => Self::LessOrEqual,
            Self::GreaterOrEqual => Self::Less,
            Self::Equal => Self::Unequal,
            Self::Unequal => Self::Equal,
        }
    }

    /// Whether it says which of two numbers is the greater one.
    pub(crate) const fn orders(self) -> bool {
        !matches!(self, Self::Equal | Self::Unequal)
    }

    pub(crate) fn holds(self, a: f64, b: f64) -> bool {
        match self {
            Self::Less => a < b,
            Self::LessOrEqual => a <= b,
            Self::Greater => a > b,
            Self::GreaterOrEqual => a >= b,
            Self::Equal => are_equal(a, b),
            Self::Unequal => !are_equal(a, b),
        }
    }
}

/// Numbers that differ by rounding only are equal; infinity is equal to itself alone, NaN to nothing.
fn are_equal(a: f64, b: f64) -> bool {
    let scale = if a * b == 0.0 { 1.0 } else { a.abs().max(b.abs()) };
    a == b || (a - b).abs() / scale <= f64::EPSILON
}
