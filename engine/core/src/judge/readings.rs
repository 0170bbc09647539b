//! What a condition reads, part by part: so that a reward can name the fact and the beam behind it.

use super::expression::{BeamSpan, Flag, Slot, StepFacts, Typed};
use super::fact_columns::Beam;
use super::fact_table::{Fact, FactId};
use super::facts::{decimal, greatest, least};
use std::ops::Range;

/// A part of a condition, with what it read in one step.
#[derive(Debug, Clone, PartialEq)]
pub struct PartRead {
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
    /// Which fact it is; nothing for what was calibrated.
    pub id: Option<FactId>,
    /// Its value; flags are 0 or 1.
    pub value: f64,
    /// The unit, in words; empty for flags.
    pub unit: &'static str,
    /// The beam of the laser that made it so.
    pub beam: Option<usize>,
}

/// A part of a condition that is true or false by itself: what stands between `&&` and `||`.
#[derive(Debug)]
pub(crate) struct Part {
    pub span: Range<usize>,
    pub flag: Option<Flag>,
    pub readings: Vec<Reading>,
}

/// A fact that a part reads.
#[derive(Debug)]
pub(crate) struct Reading {
    pub name: String,
    pub typed: Typed,
    /// Nothing for what was calibrated.
    pub id: Option<FactId>,
    pub look: BeamSought,
}

/// Which beam to name.
#[derive(Debug, Clone, Copy)]
pub(crate) enum BeamSought {
    Nowhere,
    One(usize),
    /// The one of a bearing, and of two that are equally near the lesser.
    Towards(f64),
    Given(f64),
    Least(BeamSpan),
    Greatest(BeamSpan),
    Worst(usize, usize, usize),
}

/// From the first beam to the last.
pub(crate) const ALL: BeamSpan = BeamSpan::Numbers(0, usize::MAX);

impl Part {
    /// What it read.
    pub(crate) fn evidence(&self, inputs: StepFacts<'_>) -> PartRead {
        let facts = self.readings.iter().filter_map(|reading| reading.read(inputs)).collect();
        PartRead { span: self.span.clone(), holds: self.holds(inputs), facts }
    }

    fn holds(&self, inputs: StepFacts<'_>) -> Option<bool> {
        self.flag.as_ref().map(|flag| flag.holds(inputs))
    }
}

/// The first beam that a condition's parts name, those that do not hold left out. Allocates nothing.
pub(crate) fn beam(parts: &[Part], inputs: StepFacts<'_>) -> Option<usize> {
    let holding = parts.iter().filter(|part| part.holds(inputs) != Some(false));
    holding.flat_map(|part| &part.readings).find_map(|reading| reading.look.beam(inputs))
}

impl Reading {
    /// A fact that is read without arguments, by its whole name, of this view if it is one of a view; nothing for others.
    pub(crate) fn of_fact(fact: &Fact, name: String, view: usize) -> Option<Self> {
        let typed = Typed::of_fact(fact, view)?;
        Some(Self { name, typed, id: Some(fact.id), look: BeamSought::of(fact.beam, ALL) })
    }

    fn read(&self, inputs: StepFacts<'_>) -> Option<FactRead> {
        let value = match &self.typed {
            Typed::Number(number) | Typed::Whole(number) => number.value(inputs),
            Typed::Flag(flag) => f64::from(u8::from(flag.holds(inputs))),
        };
        // An array that was calibrated is no number.
        let unit = self.id.map_or("number", |id| id.fact().unit.words());
        let read = FactRead { name: self.name.clone(), id: self.id, value, unit, beam: self.look.beam(inputs) };
        (!value.is_nan()).then_some(read)
    }
}

impl BeamSought {
    /// For a fact of the beams `from` to `to`; what an expression gives too (a beam, expected ranges) is not known here.
    pub(crate) const fn of(beam: Beam, span: BeamSpan) -> Self {
        match beam {
            Beam::Without | Beam::Given | Beam::Worst => Self::Nowhere,
            Beam::Right => Self::Towards(-90.0),
            Beam::Front => Self::Towards(0.0),
            Beam::Left => Self::Towards(90.0),
            Beam::Nearest => Self::Least(span),
            Beam::Farthest => Self::Greatest(span),
        }
    }

    fn beam(self, inputs: StepFacts<'_>) -> Option<usize> {
        let ranges_m = &inputs.facts.ranges_m;
        let last = ranges_m.len().checked_sub(1)?;
        let find = |span: BeamSpan, choose: fn(&[f32]) -> f32| {
            let (from, to) = span.numbers(inputs.facts);
            let sector = ranges_m.get(from..=to.min(last))?;
            let wanted = choose(sector);
            sector.iter().position(|range| *range == wanted).map(|beam| from + beam)
        };
        match self {
            Self::Nowhere => None,
            Self::One(beam) => Some(beam),
            Self::Towards(bearing_deg) => Some(inputs.facts.beam_towards(bearing_deg)),
            Self::Given(bearing_deg) => Some(inputs.facts.beam_at(bearing_deg)),
            Self::Least(span) => find(span, least),
            Self::Greatest(span) => find(span, greatest),
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
