//! What has to be learned and tested for a claim, as plain data. Equal jobs are done once.

use super::looks::{Look, Seen};
use engine::experiment::{Summary, WINDOW_STEPS};
use engine::verdict::TestFigures;

/// Learning one script under several seeds, each followed by the script's own test.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Learn {
    /// The script's name, without ending.
    pub script: &'static str,
    /// `KEY=VALUE` changes, besides the learner: see [`Learn::changes`].
    pub set: &'static [&'static str],
    /// Steps to learn; `None` is what the script says.
    pub steps: Option<u64>,
    /// Steps of the test.
    pub test_steps: u64,
    /// At most this many seeds, since some jobs are long.
    pub most_seeds: u64,
}

impl Learn {
    /// A script as it is, under every seed.
    #[must_use]
    pub const fn script(script: &'static str) -> Self {
        Self { script, set: &[], steps: None, test_steps: 3_000, most_seeds: u64::MAX }
    }

    /// This job with changed settings.
    #[must_use]
    pub const fn set(self, set: &'static [&'static str]) -> Self {
        Self { set, ..self }
    }

    /// All changes to the script: the paper's learner, unless the job names another one, then its own.
    pub fn changes(self) -> impl Iterator<Item = &'static str> {
        let named = self.set.iter().any(|pair| pair.starts_with("learner.kind="));
        (!named).then_some("learner.kind=ttd").into_iter().chain(self.set.iter().copied())
    }

    /// This job for another number of steps, under at most so many seeds.
    #[must_use]
    pub const fn long(self, steps: u64, most_seeds: u64) -> Self {
        Self { steps: Some(steps), most_seeds, ..self }
    }

    /// This job under at most so many seeds.
    #[must_use]
    pub const fn seeds(self, most_seeds: u64) -> Self {
        Self { most_seeds, ..self }
    }
}

/// A further test of each frozen policy.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Trial {
    /// Another world.
    pub world: Option<&'static str>,
    /// `KEY=VALUE` changes.
    pub set: &'static [&'static str],
    /// Steps of the test.
    pub steps: u64,
    /// What is looked at besides the figures of every test.
    pub look: Look,
}

/// The number of one seed that a claim is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Metric {
    /// First step of four good windows; infinite stands for never.
    LearnedAt,
    /// Reinforcement of the first 400 steps.
    FirstWindow,
    /// Mean reinforcement per 400 steps over the last four windows of learning.
    LastWindows,
    /// Failures in 1,000 steps of the test.
    Failures,
    /// Net speed along the route in the test, m/s, in either direction.
    NetSpeed,
    /// 1 if the test had no failure at all, else 0.
    NeverLost,
    /// Median distance to the prey in the test, metres, centre to centre.
    PreyDistance,
    /// How many states the grid has.
    States,
    /// Mean turning per metre of path, robot over prey.
    TurningShare,
    /// Sharpest twentieth of the bends, robot over prey.
    SharpestShare,
    /// Share of the commonest of left, right and straight on at crossings.
    CommonestChoice,
    /// Share of the commoner side among the turns at crossings.
    CommonerSide,
    /// Share of often-met states whose commonest action has no next state that follows in half of the cases.
    Aliased,
}

/// How a metric is written, and which way is better.
#[derive(Debug, Clone, Copy)]
pub struct Manner {
    /// The unit, after the number.
    pub unit: &'static str,
    /// Digits behind the point.
    pub decimals: usize,
    /// Whether less is better.
    pub low_is_good: bool,
}

impl Metric {
    /// How it is written.
    #[must_use]
    pub const fn manner(self) -> Manner {
        let (unit, decimals, low_is_good) = match self {
            Self::LearnedAt => ("steps", 0, true),
            Self::FirstWindow | Self::LastWindows => ("per 400 steps", 1, false),
            Self::Failures => ("failures per 1,000 steps", 1, true),
            Self::NetSpeed => ("m/s", 3, false),
            Self::NeverLost => ("", 0, false),
            Self::PreyDistance => ("m", 2, true),
            Self::States => ("states", 0, true),
            Self::TurningShare | Self::SharpestShare => ("of the prey's", 2, true),
            Self::CommonestChoice | Self::CommonerSide | Self::Aliased => ("", 2, true),
        };
        Manner { unit, decimals, low_is_good }
    }

    /// Whether one seed's number counts among the good ones, and what that means in words.
    #[must_use]
    pub fn good(self, value: f64) -> (bool, &'static str) {
        match self {
            Self::LearnedAt => (value.is_finite(), "learned"),
            Self::LastWindows => (value >= -1.0, "end at -1 or better"),
            Self::Failures => (value == 0.0, "without a failure"),
            Self::NetSpeed => (value >= 0.1, "make 0.1 m/s or more"),
            Self::NeverLost => (value == 1.0, "without a failure"),
            _ => (value.is_finite(), "measured"),
        }
    }

    /// Whether the number is computed by this command only, not shown by `engine run` or `engine test`.
    #[must_use]
    pub const fn is_looked_at(self) -> bool {
        matches!(
            self,
            Self::States
                | Self::TurningShare
                | Self::SharpestShare
                | Self::CommonestChoice
                | Self::CommonerSide
                | Self::Aliased
        )
    }

    /// The number of one seed; not a number if this seed has none.
    #[must_use]
    pub fn of(self, learned: &Summary, states: usize, test: &TestFigures, seen: Option<&Seen>) -> f64 {
        let seconds = test.distance_m / test.mean_speed;
        let curve = &learned.reinforcement_per_400;
        let look = |of: fn(&Seen) -> f64| seen.map_or(f64::NAN, of);
        match self {
            Self::LearnedAt => learned.learned_at.map_or(f64::INFINITY, |step| step as f64),
            Self::FirstWindow => curve.first().copied().unwrap_or(f64::NAN),
            Self::LastWindows => {
                let whole = &curve[..(learned.steps / WINDOW_STEPS) as usize];
                let last = &whole[whole.len().saturating_sub(4)..];
                last.iter().sum::<f64>() / last.len() as f64
            }
            Self::Failures => test.failures_per_1000,
            Self::NetSpeed => test.net_route_m.map_or(f64::NAN, |net_m| net_m.abs() / seconds),
            Self::NeverLost => f64::from(u8::from(test.failures == 0)),
            Self::PreyDistance => test.prey_distance_m.unwrap_or(f64::NAN),
            Self::States => states as f64,
            Self::TurningShare => look(|seen| seen.turning_share),
            Self::SharpestShare => look(|seen| seen.sharpest_share),
            Self::CommonestChoice => look(Seen::commonest_choice),
            Self::CommonerSide => look(Seen::commoner_side),
            Self::Aliased => look(|seen| seen.aliased),
        }
    }
}
