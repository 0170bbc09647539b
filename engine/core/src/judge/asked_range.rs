//! What a comparison with a constant asks of a number.

use super::expression::Comparison;

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
