//! What a condition of success computes from figures: a small tree, with no step in it.

use std::sync::Arc;

use super::asked::Request;
use super::figures::{Source, TestFigure};
use super::measured::TestFigures;
use super::window::WindowCounts;
use crate::judge::expression::{Arithmetic, Comparison};

/// Whose figure is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Subject {
    /// The policy that was learned: `test`.
    Test,
    /// A policy that knows nothing: `untrained`.
    Untrained,
}

impl Subject {
    /// The word of a script.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Test => "test",
            Self::Untrained => "untrained",
        }
    }
}

/// A figure as it is asked for.
#[derive(Debug, Clone)]
pub(crate) struct FigureUse {
    pub subject: Subject,
    pub figure: &'static TestFigure,
    pub of: FigureOf,
    /// Whether it is the script's own word: the reward, or what reads nothing but what the robot itself does.
    pub of_reward: bool,
}

/// What a figure is of.
#[derive(Debug, Clone)]
pub(crate) enum FigureOf {
    /// The whole test.
    Whole,
    /// The rule with this number.
    Rule(usize),
    /// The stage with this number.
    Stage(usize),
    /// The measure with this number.
    Measure(usize),
    /// What is measured since it is asked for.
    Request(Arc<Request>),
}

/// Both sides' figures.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SideBySide<'a> {
    pub test: &'a TestFigures,
    pub untrained: &'a TestFigures,
    /// How long the test took, seconds of the robot.
    pub seconds: f64,
}

/// A tree with a number or a truth value; the compiler of scripts keeps the two apart.
#[derive(Debug, Clone)]
pub(crate) enum Term {
    Constant(f64),
    TestFigure(FigureUse),
    Negate(Box<Term>),
    Binary(Arithmetic, Box<[Term; 2]>),
    OfOne(fn(f64) -> f64, Box<Term>),
    OfTwo(fn(f64, f64) -> f64, Box<[Term; 2]>),
    Flag(bool),
    Compare(Comparison, Box<[Term; 2]>),
    Not(Box<Term>),
    And(Vec<Term>),
    Or(Vec<Term>),
}

impl Term {
    /// The number; nothing if a figure is missing.
    fn value(&self, read: &dyn Fn(&FigureUse) -> Option<f64>) -> Option<f64> {
        let pair = |pair: &[Self; 2]| Some((pair[0].value(read)?, pair[1].value(read)?));
        match self {
            Self::Constant(value) => Some(*value),
            Self::TestFigure(figure) => read(figure),
            Self::Negate(of) => Some(-of.value(read)?),
            Self::Binary(operator, sides) => pair(sides).map(|(a, b)| operator.apply(a, b)),
            Self::OfOne(function, of) => Some(function(of.value(read)?)),
            Self::OfTwo(function, sides) => pair(sides).map(|(a, b)| function(a, b)),
            flag => flag.holds(read).map(f64::from),
        }
    }

    /// Whether it holds; nothing if a figure is missing.
    fn holds(&self, read: &dyn Fn(&FigureUse) -> Option<f64>) -> Option<bool> {
        match self {
            Self::Flag(value) => Some(*value),
            Self::Compare(comparison, sides) => Some(comparison.holds(sides[0].value(read)?, sides[1].value(read)?)),
            Self::Not(of) => Some(!of.holds(read)?),
            Self::And(all) => all.iter().try_fold(true, |all, one| Some(all & one.holds(read)?)),
            Self::Or(any) => any.iter().try_fold(false, |any, one| Some(any | one.holds(read)?)),
            number => Some(number.value(read)? != 0.0),
        }
    }

    /// Whether it holds of a test; a figure that is missing holds nothing.
    pub(crate) fn holds_in(&self, measured: SideBySide<'_>) -> bool {
        self.holds(&|figure| figure.read(measured)).unwrap_or(false)
    }

    /// Whether it holds of one side's figures of the reward and the other side's other figures.
    pub(super) fn holds_by_rewards(&self, rewards: SideBySide<'_>, others: SideBySide<'_>) -> bool {
        self.holds(&|figure| figure.read(if figure.of_reward { rewards } else { others })).unwrap_or(false)
    }

    /// Whether it holds of a window of learning.
    pub(crate) fn holds_in_window(&self, counts: &WindowCounts<'_>) -> bool {
        self.holds(&|asked| Some(asked.figure.window?(counts, asked.of.number()))).unwrap_or(false)
    }

    /// All figures that it reads, in their order.
    pub(crate) fn figures(&self) -> Vec<FigureUse> {
        match self {
            Self::Constant(_) | Self::Flag(_) => Vec::new(),
            Self::TestFigure(figure) => vec![figure.clone()],
            Self::Negate(of) | Self::OfOne(_, of) | Self::Not(of) => of.figures(),
            Self::Binary(_, sides) | Self::OfTwo(_, sides) | Self::Compare(_, sides) => {
                sides.iter().flat_map(Self::figures).collect()
            }
            Self::And(parts) | Self::Or(parts) => parts.iter().flat_map(Self::figures).collect(),
        }
    }
}

impl FigureUse {
    /// Whether both ask for the same figure of the same side.
    pub(super) fn is_same(&self, other: &Self) -> bool {
        let of = |asked: &Self| (asked.subject, asked.figure.name, asked.of.number());
        of(self) == of(other) && self.of.request() == other.of.request()
    }

    /// Whether a test cannot have it, whatever the robot does.
    pub(super) fn is_unmeasured(&self, measured: SideBySide<'_>) -> bool {
        matches!(self.figure.source, Source::Spells(_)) && self.read(measured).is_none()
    }

    /// Its value in a test.
    pub(crate) fn read(&self, measured: SideBySide<'_>) -> Option<f64> {
        let test = match self.subject {
            Subject::Test => measured.test,
            Subject::Untrained => measured.untrained,
        };
        match self.figure.source {
            Source::Test(get) => Some(get(test)),
            Source::Route(get) => get(test),
            Source::Spells(get) => (!test.no_spells).then(|| get(test)),
            Source::Goal(get) => Some(get(test).unwrap_or(measured.seconds)),
            Source::Rule(get) => test.rules.get(self.of.number()).map(|rule| get(test, rule)),
            Source::Stage(get) => test.stage_rates.get(self.of.number()).map(get),
            Source::Measure(get) => test.measures.get(self.of.number()).map(get),
            Source::Asked(_) => {
                let name = self.of.request()?.to_string();
                test.asked.iter().find(|asked| asked.name == name)?.value
            }
        }
    }
}

impl FigureOf {
    /// The number of the rule, stage or measure that is named; 0 where none is.
    fn number(&self) -> usize {
        if let Self::Rule(index) | Self::Stage(index) | Self::Measure(index) = self { *index } else { 0 }
    }

    /// What is to be measured.
    pub(crate) fn request(&self) -> Option<&Arc<Request>> {
        if let Self::Request(request) = self { Some(request) } else { None }
    }

    /// A figure's name with what stands in its parentheses, for a test with these rules.
    pub(super) fn written(&self, figure: &TestFigure, test: &TestFigures) -> String {
        let named = |name: Option<&str>| match name {
            Some(name) => format!("{}(\"{name}\")", figure.name),
            None => figure.name.to_owned(),
        };
        match self {
            Self::Whole => named(None),
            Self::Rule(index) => named(test.rules.get(*index).map(|rule| rule.name.as_str())),
            Self::Stage(index) => named(test.stage_rates.get(*index).map(|stage| stage.name.as_str())),
            Self::Measure(index) => named(test.measures.get(*index).map(|measure| measure.name.as_str())),
            Self::Request(request) => request.to_string(),
        }
    }
}
