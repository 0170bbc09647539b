//! The figures of a run, as `summary.json` holds them.

use serde::{Deserialize, Serialize};

use super::truth::{Spells, Truth};
use super::{CombinationFigures, Learned, Plan, Tally, TestRun, WINDOW_STEPS};
use crate::stats::Sorted;

/// Reinforcement of a window from which it counts as learned.
const GOOD_WINDOW: f64 = -1.0;
/// How many such windows in a row are asked for.
const GOOD_WINDOWS: usize = 4;
/// A policy does its task if it makes this much of 0.2 m/s net along the route.
const TASK_SPEED_M_PER_S: f64 = 0.5 * 0.2;
/// A combination is good up to so many failures in 1,000 steps of its test.
const FEW_FAILURES: f64 = 10.0;

/// One seed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Name of the behaviour.
    pub behaviour: String,
    /// Name of the world that it was learned in.
    pub world: String,
    /// The seed.
    pub seed: u64,
    /// Steps of learning that were done.
    pub steps: u64,
    /// Steps of learning and testing for each second of wall clock.
    pub steps_per_second: f64,
    /// The first step from which four windows of 400 steps each have a reinforcement of -1 or better.
    pub learned_at: Option<u64>,
    /// Sum of the rewards of each window of 400 steps.
    pub reinforcement_per_400: Vec<f64>,
    /// What each rule did while learning.
    pub rules: Vec<RuleTotal>,
    /// How many states were visited; of a combination, how many its policies know.
    pub states_seen: usize,
    /// The frozen policy's test.
    pub test: TestFigures,
    /// SHA-256 over every step of learning and the learned table.
    pub state_hash: String,
    /// SHA-256 over the records of the log, as its last digest; absent if none was kept.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub log_sha256: Option<String>,
    /// Whether it was stopped before its steps were done.
    pub interrupted: bool,
    /// The policies that were combined and where they disagree; absent from a behaviour that learns. Nothing was learned
    /// then: `steps` is 0, `learned_at` null, the curve empty, and rules and hash are those of the test.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub combination: Option<CombinationFigures>,
}

/// What one rule did.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RuleTotal {
    /// The rule's name.
    pub name: String,
    /// How often it fired.
    pub fired: u64,
    /// Sum of what it added.
    pub total: f64,
}

/// The frozen policy, judged by the script and by the truth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TestFigures {
    /// Steps of the test.
    pub steps: u64,
    /// Steps in which the script asked for recovery without a reward.
    pub failures: u64,
    /// Steps in which it asked for recovery after a reward above 0: goals reached.
    pub goals: u64,
    /// Failures for 1,000 steps.
    pub failures_per_1000: f64,
    /// Sum of the rewards for 1,000 steps.
    pub reinforcement_per_1000: f64,
    /// Length of the path, metres.
    pub distance_m: f64,
    /// Signed progress along the world's lap route, metres; null without one.
    pub net_route_m: Option<f64>,
    /// That progress in lengths of the route.
    pub laps: Option<f64>,
    /// Steps in which the body touched something.
    pub contacts: u64,
    /// Path length over time, m/s.
    pub mean_speed: f64,
    /// Share of spells of 20 s with a full turn on a radius below 0.3 m.
    pub spinning: f64,
    /// Share of spells with less than 0.2 m of path.
    pub standing: f64,
    /// Share of spells that went round in a circle.
    pub circling: f64,
    /// Share of spells with backward progress along the route; null without one.
    pub backwards: Option<f64>,
    /// Median distance between the robot and the prey, metres, centre to centre; null without one.
    pub prey_distance_m: Option<f64>,
    /// Whether the robot does more than avoid punishment: half of 0.2 m/s net along the route, in either direction; null
    /// without a route.
    pub does_task: Option<bool>,
}

impl TestFigures {
    /// What was counted, and what the truth says; a robot that does not know where it is has gone nowhere.
    pub(super) fn new(plan: &Plan, steps: u64, tally: &Tally, truth: Option<&Truth>) -> Self {
        let seconds = (steps as f64 * plan.settings.run.period_s).max(f64::MIN_POSITIVE);
        let lap_m = plan.layout.lap.map(|lap| plan.layout.routes[lap].length_m());
        let per_1000 = |count: f64| count * 1000.0 / steps.max(1) as f64;
        let spells = truth.map_or_else(Spells::default, |truth| truth.spells);
        let share = |count: u64| count as f64 / spells.all.max(1) as f64;
        let net_route_m = truth.and_then(Truth::net_m);
        let distance_m = truth.map_or(0.0, |truth| truth.distance_m);
        let prey_m = truth.map_or(&[][..], |truth| &truth.prey_m);
        Self {
            steps,
            failures: tally.failures,
            goals: tally.goals,
            failures_per_1000: per_1000(tally.failures as f64),
            reinforcement_per_1000: per_1000(tally.curve().iter().sum()),
            distance_m,
            net_route_m,
            laps: net_route_m.zip(lap_m).map(|(net_m, lap_m)| net_m / lap_m),
            contacts: tally.contacts,
            mean_speed: distance_m / seconds,
            spinning: share(spells.spinning),
            standing: share(spells.standing),
            circling: share(spells.circling),
            backwards: net_route_m.map(|_| share(spells.backwards)),
            prey_distance_m: prey_m.iter().map(|distance| f64::from(*distance)).collect::<Sorted>().upper_median(),
            does_task: net_route_m.map(|net_m| net_m.abs() / seconds >= TASK_SPEED_M_PER_S),
        }
    }
}

impl Summary {
    /// The figures of one seed; nothing was learned by a behaviour that combines policies. The log's digest and how long
    /// it took are not known here.
    #[must_use]
    pub fn new(plan: &Plan, seed: u64, learned: Option<&Learned>, tested: &TestRun) -> Self {
        let test = tested.figures.clone();
        let curve = learned.map_or_else(Vec::new, |learned| learned.tally.curve());
        let steps = learned.map_or(0, |learned| learned.steps);
        let (wanted, whole) = (if plan.learns() { plan.learning_steps() } else { 0 }, (steps / WINDOW_STEPS) as usize);
        Self {
            behaviour: plan.behaviour.name().to_owned(),
            world: plan.layout.name.clone(),
            seed,
            steps,
            steps_per_second: 0.0,
            learned_at: learned_at(&curve[..whole]),
            reinforcement_per_400: curve,
            rules: rule_totals(plan, learned.map_or(&tested.tally, |learned| &learned.tally)),
            states_seen: learned.map_or_else(
                || plan.members.iter().map(|member| member.policy.states_met()).sum(),
                |learned| learned.policy.states_met(),
            ),
            interrupted: steps < wanted || test.steps < plan.settings.run.test_steps,
            state_hash: learned.map_or(&tested.state_hash, |learned| &learned.state_hash).clone(),
            log_sha256: None,
            combination: tested.combination.as_ref().map(|combination| combination.figures.clone()),
            test,
        }
    }

    /// The figures with how fast they were made: `seconds` of wall clock for all steps of learning and testing.
    #[must_use]
    pub fn timed(mut self, seconds: f64) -> Self {
        self.steps_per_second = ((self.steps + self.test.steps) as f64 / seconds.max(1e-9)).round();
        self
    }

    /// Whether it was learned and, in a world with a route, gets along it. A combination learns nothing: instead, it must
    /// fail at most 10 times in 1,000 steps of its test.
    #[must_use]
    pub fn is_good(&self) -> bool {
        let fails_little = match self.combination {
            Some(_) => self.test.failures_per_1000 <= FEW_FAILURES,
            None => self.learned_at.is_some(),
        };
        fails_little && self.test.does_task != Some(false)
    }
}

/// What is counted has no column for a rule that only earlier legs had, unless it was counted in these legs.
fn rule_totals(plan: &Plan, tally: &Tally) -> Vec<RuleTotal> {
    let total = |(index, (name, fired)): (usize, (String, &u64))| RuleTotal {
        name,
        fired: *fired,
        total: (0..tally.windows.len()).map(|window| tally.by_rule(window)[index]).sum(),
    };
    plan.rule_names().into_iter().zip(&tally.fired).enumerate().map(total).collect()
}

/// Many seeds of one behaviour.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Name of the behaviour.
    pub behaviour: String,
    /// Name of the world.
    pub world: String,
    /// How many seeds learned; of a combination, how many are good.
    pub converged: usize,
    /// The median seed's figures, each taken on its own.
    pub median: Figures,
    /// The worst seed's figures, each taken on its own.
    pub worst: Figures,
    /// Every seed.
    pub seeds: Vec<Summary>,
}

/// The figures that a spread is told by.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    /// Null stands for never, and never is later than any step.
    pub learned_at: Option<u64>,
    /// Failures in 1,000 steps of the test.
    pub failures_per_1000: f64,
    /// Laps of the test, in whichever direction; null without a route.
    pub laps: Option<f64>,
    /// Median distance to the prey, metres; null without one.
    pub prey_distance_m: Option<f64>,
    /// Contacts in the test.
    pub contacts: f64,
    /// Share of spells spinning.
    pub spinning: f64,
}

impl Spread {
    /// The spread of at least one seed.
    #[must_use]
    pub fn new(seeds: Vec<Summary>) -> Self {
        let figures = |of: &dyn Fn(Sorted, bool) -> Option<f64>| {
            let pick = |worst_is_high: bool, value: &dyn Fn(&Summary) -> f64| {
                of(seeds.iter().map(value).collect(), worst_is_high).unwrap_or(f64::NAN)
            };
            let learned_at = pick(true, &|seed| seed.learned_at.map_or(f64::INFINITY, |step| step as f64));
            // Which way round is the script's affair.
            let laps = pick(false, &|seed| seed.test.laps.map_or(f64::NAN, f64::abs));
            let prey = pick(true, &|seed| seed.test.prey_distance_m.unwrap_or(f64::NAN));
            Figures {
                learned_at: learned_at.is_finite().then_some(learned_at as u64),
                failures_per_1000: pick(true, &|seed| seed.test.failures_per_1000),
                laps: (!laps.is_nan()).then_some(laps),
                prey_distance_m: (!prey.is_nan()).then_some(prey),
                contacts: pick(true, &|seed| seed.test.contacts as f64),
                spinning: pick(true, &|seed| seed.test.spinning),
            }
        };
        let median = figures(&|values, _| values.upper_median());
        let worst = figures(&|values, worst_is_high| values.upper_quantile(if worst_is_high { 1.0 } else { 0.0 }));
        let (behaviour, world) =
            seeds.first().map_or_else(Default::default, |seed| (seed.behaviour.clone(), seed.world.clone()));
        let converged = seeds
            .iter()
            .filter(|seed| seed.learned_at.is_some() || (seed.combination.is_some() && seed.is_good()))
            .count();
        Self { behaviour, world, converged, median, worst, seeds }
    }
}

/// The first step from which four windows in a row have a reinforcement of -1 or better; only whole windows count.
#[must_use]
pub fn learned_at(curve: &[f64]) -> Option<u64> {
    let good = |windows: &[f64]| windows.iter().all(|window| *window >= GOOD_WINDOW);
    curve.windows(GOOD_WINDOWS).position(good).map(|index| index as u64 * WINDOW_STEPS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_learned_at_the_start_of_four_good_windows() {
        assert_eq!(learned_at(&[-12.0, -5.0, -1.0, 0.0, -1.0, 0.0, -3.0]), Some(800));
        assert_eq!(learned_at(&[-12.0, -1.0, 0.0, -2.0, 0.0, -1.0]), None);
        assert_eq!(learned_at(&[0.0, 0.0, 0.0]), None);
    }
}
