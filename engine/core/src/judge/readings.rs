//! What a condition reads, part by part: so that a reward can name the fact and the beam behind it.

use super::expression::{Flag, Inputs, Number, Slot, Typed};
use super::fact_table::{Fact, Getter};
use super::facts::{decimal, greatest, least};
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
    pub unit: &'static str,
    pub look: Look,
}

/// Which beam to name.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Look {
    Nowhere,
    One(usize),
    Middle,
    Last,
    Least(usize, usize),
    Greatest(usize, usize),
    Worst(usize, usize, usize),
}

/// From the first beam to the last.
pub(crate) const ALL: (usize, usize) = (0, usize::MAX);

/// Which beam to name with a fact.
pub(crate) fn look_of_fact(fact: &Fact) -> Look {
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
    pub(crate) fn evidence(&self, inputs: Inputs<'_>) -> Evidence {
        let facts = self.readings.iter().filter_map(|reading| reading.read(inputs)).collect();
        Evidence { span: self.span.clone(), holds: self.holds(inputs), facts }
    }

    fn holds(&self, inputs: Inputs<'_>) -> Option<bool> {
        self.flag.as_ref().map(|flag| flag.holds(inputs))
    }
}

/// The first beam that a condition's parts name, those that do not hold left out. Allocates nothing.
pub(crate) fn beam(parts: &[Part], inputs: Inputs<'_>) -> Option<usize> {
    let holding = parts.iter().filter(|part| part.holds(inputs) != Some(false));
    holding.flat_map(|part| &part.readings).find_map(|reading| reading.look.beam(inputs))
}

impl Reading {
    /// A fact by its whole name.
    pub(crate) fn of_fact(fact: &Fact) -> Self {
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
