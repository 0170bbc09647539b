//! Middle values of a few numbers. Every convention in use has a name here, since they differ for an even count:
//!
//! | of 1, 2, 3, 10 | is | used for |
//! |---|---|---|
//! | [`Sorted::upper_median`], [`Sorted::upper_quantile`] | 3 | what stands in `summary.json`, in the table of many seeds, in the claims of the paper and under `engine bench`: always the value of a seed, a run or a round that there was |
//! | [`Sorted::quantile`] at 0.5 | 2.5 | the bands and the middle line of learning curves, in pictures and in the terminal: no jumps from window to window |
//! | [`Sorted::midpoint_median`] | 2.5 | how far the best action of a state stands out, where policies are combined by priority |

/// Numbers in ascending order, as [`f64::total_cmp`] has it.
#[derive(Debug, Clone, PartialEq)]
pub struct Sorted(Vec<f64>);

impl FromIterator<f64> for Sorted {
    fn from_iter<I: IntoIterator<Item = f64>>(values: I) -> Self {
        let mut values: Vec<f64> = values.into_iter().collect();
        values.sort_by(f64::total_cmp);
        Self(values)
    }
}

impl Sorted {
    /// The value that a share of the values, 0 to 1, stays below: the upper one where it falls between two, the greatest
    /// at 1. `None` without values.
    #[must_use]
    pub fn upper_quantile(&self, share: f64) -> Option<f64> {
        let at = (share * self.0.len() as f64).floor() as usize;
        self.0.get(at.min(self.0.len().checked_sub(1)?)).copied()
    }

    /// The middle value, the upper one of two. `None` without values.
    #[must_use]
    pub fn upper_median(&self) -> Option<f64> {
        self.upper_quantile(0.5)
    }

    /// The value below which a share of the values, 0 to 1, lies, interpolated between its neighbours. `None` without values.
    #[must_use]
    pub fn quantile(&self, share: f64) -> Option<f64> {
        let at = share * self.0.len().checked_sub(1)? as f64;
        let (low, high) = (self.0.get(at.floor() as usize)?, self.0.get(at.ceil() as usize)?);
        Some(low + (high - low) * (at - at.floor()))
    }

    /// The middle value, halfway between two. `None` without values.
    ///
    /// It may differ from [`Sorted::quantile`] at 0.5 in the last bit.
    #[must_use]
    pub fn midpoint_median(&self) -> Option<f64> {
        let last = self.0.len().checked_sub(1)?;
        Some(f64::midpoint(*self.0.get(last / 2)?, *self.0.get(last.div_ceil(2))?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sorted(values: &[f64]) -> Sorted {
        values.iter().copied().collect()
    }

    #[test]
    fn of_an_even_count_the_conventions_differ_and_of_an_odd_one_they_agree() {
        let even = sorted(&[10.0, 1.0, 3.0, 2.0]);
        assert_eq!(
            (even.upper_median(), even.quantile(0.5), even.midpoint_median()),
            (Some(3.0), Some(2.5), Some(2.5))
        );
        let odd = sorted(&[7.0, 1.0, 3.0]);
        assert_eq!((odd.upper_median(), odd.quantile(0.5), odd.midpoint_median()), (Some(3.0), Some(3.0), Some(3.0)));
    }

    #[test]
    fn quartiles_are_values_or_lie_between_them() {
        let five = sorted(&[1.0, 2.0, 3.0, 4.0, 5.0]);
        assert_eq!((five.upper_quantile(0.25), five.upper_quantile(0.75)), (Some(2.0), Some(4.0)));
        assert_eq!((five.quantile(0.25), five.quantile(0.9)), (Some(2.0), Some(4.6)));
        let four = sorted(&[1.0, 2.0, 3.0, 4.0]);
        assert_eq!((four.upper_quantile(0.25), four.upper_quantile(0.75)), (Some(2.0), Some(4.0)));
        assert_eq!((four.quantile(0.25), four.quantile(0.75)), (Some(1.75), Some(3.25)));
    }

    #[test]
    fn the_ends_are_the_least_and_the_greatest_value() {
        let values = sorted(&[-1.0, f64::INFINITY, -3.0]);
        assert_eq!((values.upper_quantile(0.0), values.upper_quantile(1.0)), (Some(-3.0), Some(f64::INFINITY)));
        assert_eq!((values.quantile(0.0), values.quantile(0.5)), (Some(-3.0), Some(-1.0)));
    }

    #[test]
    fn without_values_there_is_no_middle_and_nan_comes_last() {
        let none = sorted(&[]);
        assert_eq!((none.upper_median(), none.quantile(0.5), none.midpoint_median()), (None, None, None));
        assert_eq!(sorted(&[f64::NAN, 1.0, 2.0]).upper_median(), Some(2.0));
    }
}
