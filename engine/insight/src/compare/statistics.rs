//! How sure a figure is, and whether two runs differ by more than chance: exact, without a distribution that is assumed.

use engine::stats::Sorted;

/// Two runs of more seeds than these together are not tested by rank: counting all ways to deal them takes too long.
pub(super) const MOST_RANKED: usize = 200;
/// The share of intervals that hold the true value.
const CONFIDENCE: f64 = 0.95;
/// The standard normal's quantile at 0.975.
const Z: f64 = 1.959_963_984_540_054;
/// Probabilities that are equal but for rounding.
const ROUNDING: f64 = 1e-9;

/// The 95 % interval of a share, after Wilson (1927).
pub(super) fn share_interval(hits: usize, all: usize) -> [f64; 2] {
    let (n, share) = (all as f64, hits as f64 / all as f64);
    let (square, scale) = (Z * Z / n, 1.0 + Z * Z / n);
    let middle = (share + 0.5 * square) / scale;
    let half = Z / scale * (share * (1.0 - share) / n + 0.25 * square / n).sqrt();
    // Exact at the ends, whatever rounding makes of them.
    let (low, high) = (middle - half, middle + half);
    [if hits == 0 { 0.0 } else { low }, if hits == all { 1.0 } else { high }]
}

/// An interval that holds the true median in 95 % of all samples at least, whatever the distribution: from the k-th least to
/// the k-th greatest value. Nothing for fewer than six values.
pub(super) fn median_interval(values: &Sorted, count: usize) -> Option<[f64; 2]> {
    // P(fewer than k of n values lie below the median) is binomial with one half.
    let (mut chance, mut below, mut k) = (0.5_f64.powi(count as i32), 0.0, 0);
    while below + chance <= 0.5 * (1.0 - CONFIDENCE) {
        below += chance;
        k += 1;
        chance *= (count - k + 1) as f64 / k as f64;
    }
    let at = |index: usize| values.upper_quantile((index as f64 + 0.5) / count as f64);
    (k > 0).then(|| Some([at(k - 1)?, at(count - k)?])).flatten()
}

/// Fisher's exact test, two-sided: how likely two shares differ so much if they are the same in truth.
pub(super) fn fisher(hits: [usize; 2], all: [usize; 2]) -> f64 {
    let (total, drawn) = (all[0] + all[1], hits[0] + hits[1]);
    // The ways to deal the hits, `first` of them to the first run: each from the one before it.
    let least = drawn.saturating_sub(all[1]);
    let most = drawn.min(all[0]);
    let mut ways = vec![1.0_f64];
    for first in least..most {
        let up = (all[0] - first) as f64 * (drawn - first) as f64;
        let down = (first + 1) as f64 * (total + first + 1 - all[0] - drawn) as f64;
        ways.push(ways.last().copied().unwrap_or(1.0) * up / down);
    }
    let seen = ways.get(hits[0] - least).copied().unwrap_or(0.0);
    let as_rare = ways.iter().filter(|way| **way <= seen * (1.0 + ROUNDING));
    as_rare.sum::<f64>() / ways.iter().sum::<f64>()
}

/// The exact test by ranks of Wilcoxon, Mann and Whitney, two-sided, ties shared: how likely the values of two runs are so far
/// apart if they come from one distribution. Nothing for one value on either side, or for too many.
pub(super) fn rank_test(a: &[f64], b: &[f64]) -> Option<f64> {
    if a.len() < 2 || b.len() < 2 || a.len() + b.len() > MOST_RANKED {
        return None;
    }
    let mut all: Vec<(f64, bool)> =
        a.iter().map(|value| (*value, true)).chain(b.iter().map(|value| (*value, false))).collect();
    all.sort_by(|x, y| x.0.total_cmp(&y.0));
    // Twice the ranks, so that shared ones are whole.
    let mut ranks = vec![0; all.len()];
    let mut from = 0;
    while from < all.len() {
        let to = from + all[from..].iter().take_while(|(value, _)| value.total_cmp(&all[from].0).is_eq()).count();
        ranks[from..to].fill(from + to + 1);
        from = to;
    }
    let seen: usize = ranks.iter().zip(&all).filter(|(_, (_, first))| *first).map(|(rank, _)| rank).sum();
    // How many ways there are to choose so many of the values with that sum of ranks.
    let most: usize = ranks.iter().sum();
    let mut ways = vec![vec![0.0_f64; most + 1]; a.len() + 1];
    ways[0][0] = 1.0;
    for rank in ranks {
        for chosen in (1..=a.len()).rev() {
            let (fewer, same) = ways.split_at_mut(chosen);
            for (to, from) in same[0][rank..].iter_mut().zip(&fewer[chosen - 1]) {
                *to += from;
            }
        }
    }
    let middle = a.len() as f64 * (all.len() + 1) as f64;
    let far = |sum: usize| (sum as f64 - middle).abs() >= (seen as f64 - middle).abs() - ROUNDING;
    let row = &ways[a.len()];
    let rare: f64 = row.iter().enumerate().filter(|(sum, _)| far(*sum)).map(|(_, ways)| ways).sum();
    Some(rare / row.iter().sum::<f64>())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(found: f64, wanted: f64) {
        assert!((found - wanted).abs() < 5e-5, "{found} is not {wanted}");
    }

    #[test]
    fn a_share_of_few_is_not_sure() {
        // Wilson's interval of 8 of 10, by hand: middle (0.8 + 0.19207) / 1.38415, half 1.41601 x 0.15985.
        let [low, high] = share_interval(8, 10);
        close(low, 0.49016);
        close(high, 0.94332);
        let [low, high] = share_interval(10, 10);
        assert!((low - 0.72247).abs() < 5e-5 && high == 1.0, "{low} {high}");
    }

    #[test]
    fn the_median_lies_between_the_order_statistics_that_the_binomial_names() {
        let of = |count: usize| median_interval(&(1..=count).map(|value| value as f64).collect(), count);
        // Of five values all lie on one side in 1 of 16 samples; of six in 1 of 32, which is few enough.
        assert_eq!((of(5), of(6)), (None, Some([1.0, 6.0])));
        assert_eq!(of(30), Some([10.0, 21.0]));
    }

    #[test]
    fn fisher_counts_the_tables_that_are_as_rare() {
        // The tea: 3 of 4 cups right on either side; 1 + 16 of 70 ways on each end.
        close(fisher([3, 1], [4, 4]), 34.0 / 70.0);
        close(fisher([4, 0], [4, 4]), 2.0 / 70.0);
        close(fisher([5, 5], [10, 10]), 1.0);
        close(fisher([0, 0], [10, 10]), 1.0);
    }

    #[test]
    fn ranks_that_do_not_overlap_are_as_rare_as_the_ways_to_deal_them() {
        // One of the 20 ways to choose three of six on each end.
        close(rank_test(&[1.0, 2.0, 3.0], &[4.0, 5.0, 6.0]).unwrap(), 0.1);
        close(rank_test(&[1.0, 2.0, 6.0], &[3.0, 4.0, 5.0]).unwrap(), 1.0 - 6.0 / 20.0);
        close(rank_test(&[2.0; 4], &[2.0; 5]).unwrap(), 1.0);
        assert_eq!(rank_test(&[1.0], &[2.0, 3.0]), None);
    }
}
