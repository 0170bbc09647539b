//! Whether a rule can fire at all: intervals through its condition.

use super::expression::{Arithmetic, Comparison, Flag, Number};
use super::rule::{Clause, Rule};
use crate::diagnostic::{Diagnostic, Kind, Result, SourceText};
use crate::settings::LaserSettings;

type Interval = (f64, f64);

const ANYWHERE: Interval = (f64::NEG_INFINITY, f64::INFINITY);

/// Checks that a rule's condition can hold with this laser.
///
/// # Errors
/// If it never can, with the values that it would have to take.
pub(super) fn check(source: &SourceText, rule: &Rule, laser: &LaserSettings) -> Result<()> {
    let Clause::Native(condition) = &rule.condition else { return Ok(()) };
    let Some(why) = impossible(condition, laser) else { return Ok(()) };
    Diagnostic::new(Kind::Input, "E-SCRIPT-RULE", format!("{} can never fire", rule.shown()))
        .at(source, rule.condition_span.clone(), why)
        .help("ranges are in metres, shares from 0 to 1, angles in radians")
        .into()
}

/// Why a condition never holds; nothing if it can.
fn impossible(flag: &Flag, laser: &LaserSettings) -> Option<String> {
    match flag {
        Flag::Constant(false) => Some("this is always false".to_owned()),
        Flag::And(all) => all.iter().find_map(|part| impossible(part, laser)),
        Flag::Or(any) => any.iter().map(|part| impossible(part, laser)).collect::<Option<Vec<_>>>()?.into_iter().next(),
        Flag::Compare(comparison, pair) => {
            let (a, b) = (interval(&pair[0], laser), interval(&pair[1], laser));
            let possible = match comparison {
                Comparison::Less => a.0 < b.1,
                Comparison::LessOrEqual => a.0 <= b.1,
                Comparison::Greater => a.1 > b.0,
                Comparison::GreaterOrEqual => a.1 >= b.0,
                Comparison::Equal => a.0 <= b.1 && b.0 <= a.1,
                Comparison::Unequal => true,
            };
            let fact = if matches!(pair[0], Number::Constant(_)) { b } else { a };
            (!possible).then(|| format!("this is {}", words(fact)))
        }
        _ => None,
    }
}

fn words((low, high): Interval) -> String {
    match (low.is_finite(), high.is_finite()) {
        (true, true) if low == high => format!("always {low}"),
        (true, true) => format!("always between {low} and {high}"),
        (true, false) => format!("never less than {low}"),
        _ => format!("never more than {high}"),
    }
}

/// Between which values a number lies; wider where nothing better is known.
fn interval(number: &Number, laser: &LaserSettings) -> Interval {
    let of_laser = (laser.min_range_m, laser.max_range_m);
    match number {
        Number::Constant(value) => (*value, *value),
        Number::Fact(_, reach) => reach.bounds(laser),
        Number::Whole(_) | Number::CountBelow(..) => (0.0, f64::INFINITY),
        Number::Beam(_) | Number::Sector(..) => of_laser,
        Number::Cell(..) => (0.0, 1.0),
        Number::Negate(of) => {
            let (low, high) = interval(of, laser);
            (-high, -low)
        }
        Number::Binary(Arithmetic::Add, pair) => {
            let (a, b) = (interval(&pair[0], laser), interval(&pair[1], laser));
            (a.0 + b.0, a.1 + b.1)
        }
        Number::Binary(Arithmetic::Subtract, pair) => {
            let (a, b) = (interval(&pair[0], laser), interval(&pair[1], laser));
            (a.0 - b.1, a.1 - b.0)
        }
        _ => ANYWHERE,
    }
}
