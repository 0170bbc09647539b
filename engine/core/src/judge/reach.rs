//! Whether a rule can fire at all, and a guard or a use hold: intervals through its condition.

use super::asked_range::{ANYWHERE, AskedRange, Interval, may_hold, words};
use super::expression::{Arithmetic, BeamSpan, Flag, Number};
use super::fact_columns::Reach;
use super::fact_table::FactId;
use super::facts::{Facts, decimal};
use super::guards::CompiledGuard;
use super::readings::Part;
use super::rule::{Clause, CompiledRule};
use super::uses::CompiledUse;
use crate::diagnostic::{Diagnostic, Result, SourceText, printable};
use crate::settings::LaserSettings;
use std::ops::Range;

/// The least and the greatest that the laser can measure, beam by beam.
///
/// Every fact of the laser grows with its ranges, so these two scans bound them all.
pub(crate) struct Limits {
    low: Facts,
    high: Facts,
    laser: LaserSettings,
}

impl Limits {
    /// For a laser whose floor is at most `drop_m` below the robot's own ground; infinite where that is not known.
    ///
    /// A beam at the angle `a` from the front falls by `sin(tilt) cos(a)` for each metre, so it meets the floor at the
    /// latest after `(height + drop) / (sin(tilt) cos(a))`. Noise may add six deviations to that.
    pub(crate) fn new(laser: &LaserSettings, drop_m: f64) -> Self {
        let fan = laser.fan();
        let fall = libm::sin(laser.tilt_deg.to_radians());
        let longest = |beam: usize| {
            // The beams to the sides are level; rounding must not make them fall.
            let fall = fall * libm::cos(fan.bearing_rad(beam)) - 1e-9;
            let floor_m = if fall > 0.0 { (laser.height_m + drop_m) / fall } else { f64::INFINITY };
            (floor_m + 6.0 * laser.noise_m).clamp(laser.min_range_m, laser.max_range_m.max(laser.min_range_m)) as f32
        };
        let facts = |ranges_m: Vec<f32>| Facts { ranges_m, laser_view_deg: fan.view_deg, ..Facts::default() };
        let low = facts(vec![laser.min_range_m as f32; fan.beams]);
        Self { low, high: facts((0..fan.beams).map(longest).collect()), laser: laser.clone() }
    }

    fn of_beams(&self, from: usize, to: usize, of: impl Fn(&[f32]) -> f64) -> Interval {
        let bound = |facts: &Facts| facts.ranges_m.get(from..=to).map(&of);
        match (bound(&self.low), bound(&self.high)) {
            (Some(low), Some(high)) => (low, high),
            _ => (self.laser.min_range_m, self.laser.max_range_m),
        }
    }
}

/// Checks that a rule's condition can hold within the limits.
///
/// # Errors
/// If it never can, with the values that it would have to take.
pub(crate) fn check_rule(source: &SourceText, rule: &CompiledRule, limits: &Limits) -> Result<()> {
    let Clause::Native(condition) = &rule.condition else { return Ok(()) };
    let never = || ("E-SCRIPT-RULE", format!("{} can never fire", rule.shown()));
    check(source, never, condition, rule.condition_span.clone(), limits)
}

/// Checks that a guard's condition can hold within the limits.
///
/// # Errors
/// As [`check_rule`].
pub(crate) fn check_guard(source: &SourceText, guard: &CompiledGuard, limits: &Limits) -> Result<()> {
    let never = || ("E-SCRIPT-GUARD", format!("guard \"{}\" can never hold", printable(&guard.text.name)));
    check(source, never, &guard.condition, bounds(&guard.parts), limits)
}

/// Checks that a use's condition, if it has one, can hold within the limits.
///
/// # Errors
/// As [`check_rule`].
pub(crate) fn check_use(source: &SourceText, one: &CompiledUse, limits: &Limits) -> Result<()> {
    let Some(condition) = &one.condition else { return Ok(()) };
    let never = || ("E-SCRIPT-USE", format!("this use of \"{}\" can never hold", printable(&one.text.name)));
    check(source, never, condition, bounds(&one.parts), limits)
}

/// The bytes from the first part of a condition to its last.
fn bounds(parts: &[Part]) -> Range<usize> {
    let start = parts.iter().map(|part| part.span.start).min().unwrap_or(0);
    start..parts.iter().map(|part| part.span.end).max().unwrap_or(start)
}

fn check(
    source: &SourceText,
    never: impl FnOnce() -> (&'static str, String),
    condition: &Flag,
    span: Range<usize>,
    limits: &Limits,
) -> Result<()> {
    let Some(why) = impossible(condition, limits) else { return Ok(()) };
    let help = match limits.laser.tilt_deg > 0.0 {
        _ if excludes_itself(condition) => "write || between them where either will do, or turn one of the comparisons",
        true => {
            "the laser looks down and meets the floor: check laser.tilt_deg and laser.height_m; ranges are in metres"
        }
        false => "ranges are in metres, shares from 0 to 1, angles in radians",
    };
    let (code, message) = never();
    Diagnostic::new(code, message).at(source, span, why).help(help).fail()
}

/// Why a condition never holds; nothing if it can.
fn impossible(flag: &Flag, limits: &Limits) -> Option<String> {
    match flag {
        Flag::Constant(false) => Some("this is always false".to_owned()),
        Flag::And(all) => all.iter().find_map(|part| impossible(part, limits)).or_else(|| contradiction(all)),
        Flag::Or(any) => {
            any.iter().map(|part| impossible(part, limits)).collect::<Option<Vec<_>>>()?.into_iter().next()
        }
        Flag::Compare(comparison, pair) => {
            let (a, b) = (interval(&pair[0], limits), interval(&pair[1], limits));
            let possible = may_hold(*comparison, a, b);
            let fact = if matches!(pair[0], Number::Constant(_)) { b } else { a };
            (!possible).then(|| format!("this is {}", words(fact)))
        }
        _ => None,
    }
}

/// What a comparison with a constant asks of a fact.
#[derive(Clone, Copy)]
struct Asked {
    fact: (FactId, usize),
    range: AskedRange,
}

impl Asked {
    fn of(flag: &Flag) -> Option<Self> {
        let Flag::Compare(comparison, pair) = flag else { return None };
        let fact = |number: &Number| match number {
            Number::Fact(_, fact) | Number::Whole(_, fact) => Some((*fact, 0)),
            Number::View(view, _, fact) | Number::ViewWhole(view, _, fact) => Some((*fact, *view)),
            _ => None,
        };
        let (fact, comparison, limit) = match (&pair[0], &pair[1]) {
            (read, Number::Constant(limit)) => (fact(read)?, *comparison, *limit),
            (Number::Constant(limit), read) => (fact(read)?, comparison.turned(), *limit),
            _ => return None,
        };
        Some(Self { fact, range: AskedRange::of(comparison, limit)? })
    }

    /// Whether nothing can be as both ask.
    fn excludes(&self, other: &Self) -> bool {
        self.fact == other.fact && self.range.excludes(&other.range)
    }
}

/// Whether a condition cannot hold for what it asks alone.
fn excludes_itself(condition: &Flag) -> bool {
    matches!(condition, Flag::And(all) if contradiction(all).is_some())
}

/// Why parts of a condition exclude one another, if two do.
fn contradiction(all: &[Flag]) -> Option<String> {
    let asked: Vec<Asked> = all.iter().filter_map(Asked::of).collect();
    let pairs = asked.iter().enumerate().flat_map(|(index, one)| asked[..index].iter().map(move |other| (other, one)));
    let excluded = pairs.into_iter().any(|(one, other)| one.excludes(other));
    excluded.then(|| "one part of this excludes another".to_owned())
}

/// Between which values a number lies; wider where nothing better is known.
fn interval(number: &Number, limits: &Limits) -> Interval {
    match number {
        Number::Constant(value) => (*value, *value),
        Number::Fact(of, fact) => match fact.fact().reach {
            Reach::Laser => (of(&limits.low), of(&limits.high)),
            reach => reach.bounds(),
        },
        Number::Whole(_, fact) | Number::View(_, _, fact) | Number::ViewWhole(_, _, fact) => fact.fact().reach.bounds(),
        Number::CountBelow(..) => FactId::SectorCountBelow.fact().reach.bounds(),
        Number::Beam(beam) => limits.of_beams(*beam, *beam, |ranges_m| decimal(ranges_m[0])),
        Number::Sector(BeamSpan::Numbers(from, to), of) => limits.of_beams(*from, *to, of),
        Number::Before(of) => interval(of, limits),
        Number::Cell(..) => FactId::CameraCell.fact().reach.bounds(),
        Number::Negate(of) => {
            let (low, high) = interval(of, limits);
            (-high, -low)
        }
        Number::Binary(Arithmetic::Add, pair) => {
            let (a, b) = (interval(&pair[0], limits), interval(&pair[1], limits));
            (a.0 + b.0, a.1 + b.1)
        }
        Number::Binary(Arithmetic::Subtract, pair) => {
            let (a, b) = (interval(&pair[0], limits), interval(&pair[1], limits));
            (a.0 - b.1, a.1 - b.0)
        }
        _ => ANYWHERE,
    }
}
