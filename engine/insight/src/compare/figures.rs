//! The figures of runs beside one another.

use serde::Serialize;

use super::side::{Side, SideSeed};
use super::statistics::{fisher, median_interval, rank_test, share_interval};
use engine::stats::Sorted;

/// How many seeds of one run succeed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SuccessSide {
    /// Seeds that succeed.
    pub hits: usize,
    /// All seeds.
    pub seeds: usize,
    /// The 95 % interval of the share (Wilson); null for one seed.
    pub interval: Option<[f64; 2]>,
    /// How likely the share differs so much from the first run's by chance (Fisher's exact test, two-sided); null for the first
    /// run and where both have one seed.
    pub chance: Option<f64>,
}

/// One figure over all runs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ComparedFigure {
    /// Its name.
    pub name: &'static str,
    /// Decimal places to show.
    #[serde(skip)]
    pub places: usize,
    /// Run by run.
    pub sides: Vec<FigureSide>,
}

/// One figure of one run; null stands for never, or for what this run does not have.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FigureSide {
    /// The upper median of the seeds.
    pub median: Option<f64>,
    /// The 95 % interval of the median; null for fewer than six seeds.
    pub interval: Option<[Option<f64>; 2]>,
    /// The least and the greatest of the seeds.
    pub range: [Option<f64>; 2],
    /// How likely the values lie so far from the first run's by chance (exact rank test, two-sided); null for the first run and
    /// where either has one seed.
    pub chance: Option<f64>,
}

/// A figure of a seed: its name, places, and value; infinite for never, NaN for what it does not have.
type Measure = (&'static str, usize, fn(&SideSeed) -> f64);

const MEASURES: &[Measure] = &[
    ("learned at step", 0, |seed| seed.summary.learned_at.map_or(f64::INFINITY, |step| step as f64)),
    ("failures per 1000", 1, |seed| seed.summary.test.failures_per_1000),
    ("goals, % of attempts", 0, |seed| {
        if seed.summary.test.attempts() > 0 { 100.0 * seed.summary.test.goal_rate } else { f64::NAN }
    }),
    ("laps", 1, |seed| seed.summary.test.laps.map_or(f64::NAN, f64::abs)),
    ("metres per failure", 0, |seed| seed.summary.test.metres_per_failure),
    ("mean speed, m/s", 3, |seed| seed.summary.test.mean_speed),
    ("contacts", 0, |seed| seed.summary.test.contacts as f64),
    ("reward per 1000", 1, |seed| seed.summary.test.reinforcement_per_1000),
    ("states met", 0, |seed| seed.summary.states_seen as f64),
];

pub(super) fn successes(sides: &[Side]) -> Vec<SuccessSide> {
    let count =
        |side: &Side| (side.seeds.iter().filter(|seed| seed.summary.verdict.is_success()).count(), side.seeds.len());
    let first = sides.first().map_or((0, 0), count);
    let side = |(index, side): (usize, &Side)| {
        let (hits, seeds) = count(side);
        let several = seeds > 1 || first.1 > 1;
        SuccessSide {
            hits,
            seeds,
            interval: (seeds > 1).then(|| share_interval(hits, seeds)),
            chance: (index > 0 && several).then(|| fisher([first.0, hits], [first.1, seeds])),
        }
    };
    sides.iter().enumerate().map(side).collect()
}

/// Every figure that some run has.
pub(super) fn figures(sides: &[Side]) -> Vec<ComparedFigure> {
    let goals = sides.iter().flat_map(|side| &side.seeds).any(|seed| seed.summary.test.goals > 0);
    let measures = MEASURES.iter().filter(|(name, ..)| goals || !name.starts_with("goals"));
    let figures = measures.map(|(name, places, of)| {
        let values: Vec<Vec<f64>> =
            sides.iter().map(|side| side.seeds.iter().map(of).filter(|value| !value.is_nan()).collect()).collect();
        let sides = values.iter().enumerate().map(|(index, own)| FigureSide::new(own, (index > 0).then(|| &values[0])));
        ComparedFigure { name, places: *places, sides: sides.collect() }
    });
    figures.filter(|figure| figure.sides.iter().any(|side| side.range != [None; 2] || side.median.is_some())).collect()
}

impl FigureSide {
    fn new(values: &[f64], first: Option<&Vec<f64>>) -> Self {
        let finite = |value: f64| value.is_finite().then_some(value);
        let sorted: Sorted = values.iter().copied().collect();
        Self {
            median: sorted.upper_median().and_then(finite),
            interval: median_interval(&sorted, values.len()).map(|ends| ends.map(finite)),
            range: [0.0, 1.0].map(|share| sorted.upper_quantile(share).and_then(finite)),
            chance: first.and_then(|first| rank_test(first, values)),
        }
    }
}
