//! Whether a condition of success can hold at all: between which values each figure lies, and what its parts ask of it.

use super::asked::Probe;
use super::figures::{Source, TestFigure};
use super::term::{FigureUse, Term};
use crate::judge::asked_range::{ANYWHERE, AskedRange, Interval, may_hold, words};
use crate::judge::expression::Arithmetic;
const NOT_NEGATIVE: Interval = (0.0, f64::INFINITY);

/// Why a condition never holds, whatever a test comes to; nothing if it may.
pub(crate) fn why_never(term: &Term) -> Option<String> {
    match term {
        Term::Flag(false) => Some("this is always false".to_owned()),
        Term::And(all) => all.iter().find_map(why_never).or_else(|| {
            let parts = (1..all.len()).flat_map(|index| all[..index].iter().map(move |before| (before, &all[index])));
            let excluded = parts.into_iter().any(|(one, other)| exclude(one, other));
            excluded.then(|| "one part of this excludes another".to_owned())
        }),
        Term::Or(any) => any.iter().map(why_never).collect::<Option<Vec<_>>>()?.into_iter().next(),
        Term::Compare(comparison, sides) => {
            let (a, b) = (interval(&sides[0]), interval(&sides[1]));
            let possible = may_hold(*comparison, a, b);
            let read = if matches!(sides[0], Term::Constant(_)) { b } else { a };
            (!possible).then(|| format!("this is {}", words(read)))
        }
        _ => None,
    }
}

/// Whether two conditions never hold of the same test, by what they ask of one figure.
pub(crate) fn exclude(one: &Term, other: &Term) -> bool {
    let (one, other) = (asked(one), asked(other));
    one.iter().any(|(figure, range)| other.iter().any(|(same, beside)| figure.is_same(same) && range.excludes(beside)))
}

/// What a condition asks of figures for sure: each of its parts if all must hold.
fn asked(term: &Term) -> Vec<(&FigureUse, AskedRange)> {
    match term {
        Term::And(all) => all.iter().flat_map(asked).collect(),
        Term::Compare(comparison, sides) => {
            let range = match &**sides {
                [Term::TestFigure(figure), Term::Constant(limit)] => {
                    AskedRange::of(*comparison, *limit).map(|range| (figure, range))
                }
                [Term::Constant(limit), Term::TestFigure(figure)] => {
                    AskedRange::of(comparison.turned(), *limit).map(|range| (figure, range))
                }
                _ => None,
            };
            range.into_iter().collect()
        }
        _ => Vec::new(),
    }
}

/// Between which values a number lies; wider where nothing better is known.
fn interval(term: &Term) -> Interval {
    match term {
        Term::Constant(value) => (*value, *value),
        Term::TestFigure(asked) => asked.figure.bounds(),
        Term::Negate(of) => {
            let (low, high) = interval(of);
            (-high, -low)
        }
        Term::Binary(Arithmetic::Add, sides) => {
            let (a, b) = (interval(&sides[0]), interval(&sides[1]));
            (a.0 + b.0, a.1 + b.1)
        }
        Term::Binary(Arithmetic::Subtract, sides) => {
            let (a, b) = (interval(&sides[0]), interval(&sides[1]));
            (a.0 - b.1, a.1 - b.0)
        }
        _ => ANYWHERE,
    }
}

impl TestFigure {
    /// Between which values it lies in every test.
    fn bounds(&self) -> Interval {
        match self.source {
            _ if self.unit == "share" => (0.0, 1.0),
            // A step has one ending, one contact, one firing of a rule; it may have several changes of the stage.
            Source::Rule(_) => (0.0, 1000.0),
            Source::Test(_) => match self.name {
                "failures_per_1000" | "goals_per_1000" | "restarts_per_1000" | "contacts_per_1000"
                | "forbidden_per_1000" => (0.0, 1000.0),
                "reward_per_1000" => ANYWHERE,
                _ => NOT_NEGATIVE,
            },
            Source::Goal(_) | Source::Asked(Probe::GapError | Probe::ContactsWith | Probe::Visits | Probe::Gates) => {
                NOT_NEGATIVE
            }
            Source::Route(_) if self.name == "route_offset_m" => NOT_NEGATIVE,
            _ => ANYWHERE,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_figure_of_a_share_is_one_and_no_figure_of_a_way_has_an_end() {
        for figure in super::super::FIGURES {
            let (low, high) = figure.bounds();
            assert!(low < high, "{}", figure.name);
            assert_eq!((low, high) == (0.0, 1.0), figure.unit == "share", "{}", figure.name);
        }
        let of = |name| TestFigure::of(name).unwrap().bounds();
        assert_eq!(of("laps"), ANYWHERE);
        assert_eq!(of("distance_m"), NOT_NEGATIVE);
        assert_eq!(of("failures_per_1000"), (0.0, 1000.0));
    }
}
