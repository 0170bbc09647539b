//! What a comparison with a constant asks of a number, and whether one can hold between bounds.

use super::expression::Comparison;

/// Least and greatest value.
pub(crate) type Interval = (f64, f64);

pub(crate) const ANYWHERE: Interval = (f64::NEG_INFINITY, f64::INFINITY);

/// Bounds in words, such as `never less than 0`.
pub(crate) fn words((low, high): Interval) -> String {
    match (low.is_finite(), high.is_finite()) {
        (true, true) if low == high => format!("always {low}"),
        (true, true) => format!("always between {low} and {high}"),
        (true, false) => format!("never less than {low}"),
        _ => format!("never more than {high}"),
    }
}

/// Whether a comparison can hold of some number between two bounds, each included, and some number between two others.
pub(crate) fn may_hold(comparison: Comparison, a: Interval, b: Interval) -> bool {
    match comparison {
        Comparison::Less => a.0 < b.1,
        Comparison::LessOrEqual => a.0 <= b.1,
        Comparison::Greater => a.1 > b.0,
        Comparison::GreaterOrEqual => a.1 >= b.0,
        Comparison::Equal => a.0 <= b.1 && b.0 <= a.1,
        Comparison::Unequal => true,
    }
}

/// At least and at most so much, and whether the bound itself will do.
#[derive(Debug, Clone, Copy)]
pub(crate) struct AskedRange {
    from: (f64, bool),
    to: (f64, bool),
}

impl AskedRange {
    /// Of a number that stands on the left of the comparison; nothing of `!=`, which leaves two ranges.
    pub(crate) fn of(comparison: Comparison, limit: f64) -> Option<Self> {
        let (least, most) = ((f64::NEG_INFINITY, true), (f64::INFINITY, true));
        let (from, to) = match comparison {
            Comparison::Less => (least, (limit, false)),
            Comparison::LessOrEqual => (least, (limit, true)),
            Comparison::Greater => ((limit, false), most),
            Comparison::GreaterOrEqual => ((limit, true), most),
            Comparison::Equal => ((limit, true), (limit, true)),
            Comparison::Unequal => return None,
        };
        Some(Self { from, to })
    }

    /// Whether nothing can be as both ask.
    pub(crate) fn excludes(&self, other: &Self) -> bool {
        let beyond = |low: (f64, bool), high: (f64, bool)| low.0 > high.0 || low.0 == high.0 && !(low.1 && high.1);
        beyond(self.from, other.to) || beyond(other.from, self.to)
    }
}
