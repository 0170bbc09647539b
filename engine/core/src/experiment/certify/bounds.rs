//! How sure a share or a rate is: exact bounds of a share and of a count, and an interval of a rate over clusters.
//!
//! All intervals are two-sided and hold the true value in 95 % of all samples: their upper end alone does in 97.5 %.

/// The chance that the true value lies beyond one end.
const TAIL: f64 = 0.025;
/// Halvings of a bracket: more change nothing.
const HALVINGS: usize = 200;

/// The exact interval of a share, after Clopper and Pearson (1934): `hits` of `all`; 0 to 1 of none.
#[must_use]
pub fn share_bounds(hits: u64, all: u64) -> [f64; 2] {
    let (hits, misses) = (hits as f64, all.saturating_sub(hits) as f64);
    // P(at least so many hits) = I_p(hits, misses + 1), and P(at most so many) = 1 - I_p(hits + 1, misses).
    let low = if hits > 0.0 { solve(0.0, 1.0, TAIL, |p| beta(p, hits, misses + 1.0)) } else { 0.0 };
    let high = if misses > 0.0 { solve(0.0, 1.0, 1.0 - TAIL, |p| beta(p, hits + 1.0, misses)) } else { 1.0 };
    [low, high]
}

/// The exact interval of the mean of a Poisson count, after Garwood (1936).
#[must_use]
pub fn count_bounds(count: u64) -> [f64; 2] {
    let most = count as f64 + 20.0 + 10.0 * (count as f64).sqrt();
    // P(more than `below` events) grows with the mean.
    let low = if count > 0 { solve(0.0, most, TAIL, |mean| 1.0 - at_most(count - 1, mean)) } else { 0.0 };
    [low, solve(0.0, most, 1.0 - TAIL, |mean| 1.0 - at_most(count, mean))]
}

/// Events for each step over clusters of steps that are like one another, such as the worlds of a test: the rate, and its
/// interval. A cluster is its events and its steps; there is one at least, with a step.
///
/// The deviation is that of a ratio over clusters (Cochran 1977, 6.4) with Student's t. Where few clusters have events, that is
/// too narrow: no end lies within the exact interval of all events as one Poisson count.
#[must_use]
pub fn rate_bounds(clusters: &[(u64, u64)]) -> (f64, [f64; 2]) {
    let (events, steps) = clusters.iter().fold((0, 0), |(events, steps), one| (events + one.0, steps + one.1));
    let (all, rate) = (steps.max(1) as f64, events as f64 / steps.max(1) as f64);
    let [low, high] = count_bounds(events).map(|count| count / all);
    let n = clusters.len() as f64;
    if n < 2.0 {
        return (rate, [low, high]);
    }
    let off = |(events, steps): &(u64, u64)| *events as f64 - rate * *steps as f64;
    let squares: f64 = clusters.iter().map(|one| off(one) * off(one)).sum();
    let reach = student(n - 1.0) * (n / (n - 1.0) * squares).sqrt() / all;
    (rate, [low.min(rate - reach).max(0.0), high.max(rate + reach)])
}

/// The quantile of Student's t at 0.975, for so many degrees of freedom.
pub(super) fn student(freedom: f64) -> f64 {
    // P(|T| > t) = I_x(freedom / 2, 1 / 2) at x = freedom / (freedom + t^2).
    let within = |t: f64| 1.0 - beta(freedom / (freedom + t * t), 0.5 * freedom, 0.5);
    solve(0.0, 1000.0, 1.0 - 2.0 * TAIL, within)
}

/// Where a function that does not fall reaches a value, between two places.
fn solve(low: f64, high: f64, value: f64, of: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (low, high);
    for _ in 0..HALVINGS {
        let middle = f64::midpoint(low, high);
        if middle <= low || middle >= high {
            break;
        }
        if of(middle) < value { low = middle } else { high = middle }
    }
    f64::midpoint(low, high)
}

/// P(at most `count` events) of a Poisson distribution: summed from its greatest term down.
fn at_most(count: u64, mean: f64) -> f64 {
    let log_term = |events: f64| events * libm::log(mean) - mean - libm::lgamma(events + 1.0);
    if mean <= 0.0 {
        return 1.0;
    }
    let top = (count as f64).min(mean.floor());
    let first = libm::exp(log_term(top));
    let (mut sum, mut term, mut events) = (first, first, top);
    while events > 0.0 && term > sum * f64::EPSILON {
        term *= events / mean;
        sum += term;
        events -= 1.0;
    }
    (term, events) = (first, top);
    while events < count as f64 && term > sum * f64::EPSILON {
        events += 1.0;
        term *= mean / events;
        sum += term;
    }
    sum.min(1.0)
}

/// The regularised incomplete beta function I_x(a, b), by Lentz's continued fraction (Press et al., Numerical Recipes, 6.4).
fn beta(x: f64, a: f64, b: f64) -> f64 {
    if x <= 0.0 || x >= 1.0 {
        return x.clamp(0.0, 1.0);
    }
    let log_front = libm::lgamma(a + b) - libm::lgamma(a) - libm::lgamma(b) + a * libm::log(x) + b * libm::log1p(-x);
    let front = libm::exp(log_front);
    // It converges fast below the mean, and the function is symmetric.
    if x < (a + 1.0) / (a + b + 2.0) {
        front * fraction(x, a, b) / a
    } else {
        1.0 - front * fraction(1.0 - x, b, a) / b
    }
}

fn fraction(x: f64, a: f64, b: f64) -> f64 {
    const TINY: f64 = 1e-300;
    let away = |value: f64| if value.abs() < TINY { TINY } else { value };
    let (mut c, mut d) = (1.0, 1.0 / away(1.0 - (a + b) * x / (a + 1.0)));
    let mut all = d;
    for part in 1..100_000_u32 {
        let m = f64::from(part);
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        let mut last = 1.0;
        for term in [even, odd] {
            d = 1.0 / away(1.0 + term * d);
            c = away(1.0 + term / c);
            last = c * d;
            all *= last;
        }
        if (last - 1.0).abs() < 4.0 * f64::EPSILON {
            break;
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(found: [f64; 2], wanted: [f64; 2]) {
        let near = |(found, wanted): (f64, f64)| (found - wanted).abs() < 6e-5 * wanted.abs().max(1.0);
        assert!(found.into_iter().zip(wanted).all(near), "{found:?} is not {wanted:?}");
    }

    #[test]
    fn the_bounds_of_a_share_are_those_that_clopper_and_pearson_published() {
        // Of none and of all in closed form: 1 - 0.025^(1/n).
        close(share_bounds(0, 10), [0.0, 0.3085]);
        close(share_bounds(10, 10), [0.6915, 1.0]);
        close(share_bounds(8, 10), [0.4439, 0.9748]);
        close(share_bounds(1, 20), [0.0013, 0.2487]);
        close(share_bounds(81, 263), [0.2527, 0.3676]);
        close(share_bounds(1000, 1000), [libm::pow(0.025, 1e-3), 1.0]);
        assert_eq!(share_bounds(0, 0), [0.0, 1.0]);
    }

    #[test]
    fn the_bounds_of_a_count_are_those_that_garwood_published() {
        // Of no event: -ln 0.025.
        close(count_bounds(0), [0.0, 3.6889]);
        close(count_bounds(1), [0.0253, 5.5716]);
        close(count_bounds(10), [4.7954, 18.3904]);
        close(count_bounds(100), [81.3640, 121.6271]);
    }

    #[test]
    fn students_quantiles_are_those_of_every_table() {
        close([student(1.0), student(4.0)], [12.7062, 2.7764]);
        close([student(10.0), student(999.0)], [2.2281, 1.9623]);
    }

    #[test]
    fn a_rate_over_worlds_is_as_sure_as_the_worlds_are_alike() {
        // Five worlds of 100 steps: 10, 20, 30, 40, 50 events; the rate is 0.3. Off by 20, 10, 0, 10, 20: 1000 in squares, so
        // a deviation of sqrt(5/4 x 1000) / 500 = 0.07071, times t of 4 degrees, 2.7764: 0.19632.
        let clusters = [10, 20, 30, 40, 50].map(|events| (events, 100));
        let (rate, bounds) = rate_bounds(&clusters);
        assert!((rate - 0.3).abs() < 1e-12);
        close(bounds, [0.3 - 0.19632, 0.3 + 0.19632]);
    }

    #[test]
    fn a_rate_is_never_surer_than_its_events_as_one_count() {
        // All worlds alike: no spread over worlds, but 10 events are no surer than Garwood says.
        let (rate, bounds) = rate_bounds(&[(2, 100); 5]);
        assert!((rate - 0.02).abs() < 1e-12);
        close(bounds.map(|bound| bound * 500.0), [4.7954, 18.3904]);
        let (rate, [low, high]) = rate_bounds(&[(0, 1000); 3]);
        assert!(rate == 0.0 && low == 0.0 && (high * 3000.0 - 3.6889).abs() < 1e-3);
        close(rate_bounds(&[(1, 10)]).1.map(|bound| bound * 10.0), [0.0253, 5.5716]);
    }
}
