//! The unit in which first values and temperatures are told: the greatest spread that the returns have had.

/// Hottest and coldest choice, shares of the unit.
pub(super) const HOT: f64 = 0.04;
pub(super) const COLD: f64 = 0.004;
/// Visits of a state until it is coldest.
pub(super) const COOLING_VISITS: u64 = 50;

/// What rounding may leave of a variance, as a share of the mean square.
pub(super) const ROUNDING: f64 = 1e-12;

/// Weighted sums over all remembered returns.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct ReturnTotals {
    pub(super) weight: f64,
    pub(super) sum: f64,
    pub(super) squares: f64,
}

/// What is usual, and how far returns lie from it.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct ReturnScale {
    /// The greatest deviation of the returns so far; 0 before the first fit.
    pub(super) unit: f64,
    /// Their mean now.
    pub(super) mean: f64,
}

impl ReturnScale {
    /// Takes in the returns as they are now.
    pub(super) fn update(&mut self, totals: &ReturnTotals) {
        if totals.weight > 0.0 {
            self.mean = totals.sum / totals.weight;
            let square = totals.squares / totals.weight;
            let variance = square - self.mean * self.mean;
            // Of returns that are all alike, only what rounding left.
            if variance > ROUNDING * square {
                self.unit = self.unit.max(variance.sqrt());
            }
        }
    }

    /// What is expected of what nobody tried: a unit below what is usual, or below 0 where that is less than nothing. Below
    /// its own bad habits a robot would be content with them.
    #[must_use]
    pub(super) fn first_value(&self) -> f64 {
        self.mean.max(0.0) - self.unit
    }

    /// The temperature that is a share of the unit; above 0 even before there is a unit.
    #[must_use]
    pub(super) fn temperature(&self, share: f64) -> f64 {
        (share * self.unit).max(f64::MIN_POSITIVE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_unit_is_the_greatest_spread_so_far_and_the_mean_is_todays() {
        let mut scale = ReturnScale::default();
        // Returns -2 and 0, the second with three times the weight: mean -0.5, variance 1 - 0.25.
        scale.update(&ReturnTotals { weight: 4.0, sum: -2.0, squares: 4.0 });
        assert_eq!((scale.mean, scale.unit), (-0.5, 0.75_f64.sqrt()));
        assert_eq!(scale.first_value(), -scale.unit);
        // All returns 1: the spread of before stays the unit, and what is usual is worth 1.
        scale.update(&ReturnTotals { weight: 2.0, sum: 2.0, squares: 2.0 });
        let alike = ReturnTotals { weight: 0.3, sum: 0.3 * 0.1, squares: 0.3 * 0.1 * 0.1 };
        let mut new = ReturnScale::default();
        new.update(&alike);
        assert_eq!(new.unit, 0.0);
        assert_eq!(scale.first_value(), 1.0 - 0.75_f64.sqrt());
        assert!((scale.temperature(COLD) - 0.003_464_101).abs() < 1e-8);
    }
}
