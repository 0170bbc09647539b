//! The figures of a run, as `summary.json` holds them.

use serde::{Deserialize, Serialize};

use super::{CombinationFigures, Learned, Origin, Plan, Tally, TestRun, UseFigures, WorldFigures};
use crate::learner::Policy;
use crate::stats::Sorted;
use crate::verdict::{BaseLines, ConditionVerdict, FigureVerdict, RuleTotal, SuccessVerdict, TestFigures};

/// One seed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Name of the behaviour.
    pub behaviour: String,
    /// Name of the world that it was learned in.
    pub world: String,
    /// The seed.
    pub seed: u64,
    /// The run that it goes on from; absent if it began with nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from: Option<FromRun>,
    /// Steps of learning that were done.
    pub steps: u64,
    /// Steps of learning and testing for each second of wall clock.
    pub steps_per_second: f64,
    /// The first step from which four windows of 400 steps in a row are good, see [`crate::verdict::Success::learned_at`]; null
    /// if there is none, or if it cannot be told from this script.
    pub learned_at: Option<u64>,
    /// Sum of the rewards of each window of 400 steps.
    pub reinforcement_per_400: Vec<f64>,
    /// Of a script that widens its starts: when each came into use; absent from others.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub starts: Vec<StartJoined>,
    /// What each rule did while learning.
    pub rules: Vec<RuleTotal>,
    /// How many states were visited; of a combination, how many its policies know.
    pub states_seen: usize,
    /// Whether it is a success, and why.
    pub verdict: SuccessVerdict,
    /// The frozen policy's test.
    pub test: TestFigures,
    /// The test of robots that know nothing, or do not look, over as many steps.
    #[serde(flatten)]
    pub base_lines: BaseLines,
    /// SHA-256 over every step of learning and the learned table.
    pub state_hash: String,
    /// SHA-256 over the values of what was learned, see [`Policy::digest`]; absent if nothing was, and from older runs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub policy_sha256: Option<String>,
    /// SHA-256 over the records of the log, as its last digest; absent if none was kept.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub log_sha256: Option<String>,
    /// Whether it was stopped before its steps were done.
    pub interrupted: bool,
    /// The policies that were combined and where they disagree; absent from a behaviour that learns. Nothing was learned
    /// then: `steps` is 0, `learned_at` null, the curve empty, and rules and hash are those of the test.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub combination: Option<CombinationFigures>,
    /// The learned policies that the script uses and how much each drove in the test; absent from a script that uses none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub uses: Vec<UseFigures>,
    /// What the test did in each of several worlds; absent from a run in one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub worlds: Vec<WorldFigures>,
}

impl Summary {
    /// The figures of one seed; nothing was learned by a behaviour that combines policies. The log's digest and how long
    /// it took are not known here.
    #[must_use]
    pub fn new(plan: &Plan, seed: u64, learned: Option<&Learned>, tested: &TestRun, lines: &BaseLines) -> Self {
        let test = tested.figures.clone();
        let curve = learned.map_or_else(Vec::new, |learned| learned.tally.curve());
        let steps = learned.map_or(0, |learned| learned.steps);
        let wanted = if plan.learns() { plan.learning_steps() } else { 0 };
        let success = plan.success();
        Self {
            behaviour: plan.behaviour.name().to_owned(),
            world: plan.worlds.title(),
            seed,
            from: plan.origin_of(seed).map(|origin| FromRun::of(origin, plan)),
            steps,
            steps_per_second: 0.0,
            learned_at: learned.and_then(|learned| success.learned_at(&learned.tally.counts())),
            reinforcement_per_400: curve,
            starts: learned.map_or_else(Vec::new, |learned| starts_joined(plan, learned)),
            rules: rule_totals(plan, learned.map_or(&tested.tally, |learned| &learned.tally)),
            states_seen: learned.map_or_else(
                || {
                    let used = plan.used.iter().map(|used| &used.policy);
                    plan.members.iter().map(|member| &member.policy).chain(used).map(Policy::states_met).sum()
                },
                |learned| learned.policy.states_met(),
            ),
            interrupted: steps < wanted || test.steps < plan.settings.run.test_steps,
            state_hash: learned.map_or(&tested.state_hash, |learned| &learned.state_hash).clone(),
            policy_sha256: learned.map(|learned| learned.policy.digest().to_string()),
            log_sha256: None,
            verdict: success.verdict(&test, lines),
            base_lines: lines.clone(),
            uses: tested.uses.clone(),
            worlds: tested.worlds.clone(),
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
}

/// The run that learning went on from.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct FromRun {
    /// Its folder, behaviour, world and seed.
    pub run: String,
    /// Steps that were learned in it, and in those that it goes on from.
    pub steps: u64,
    /// SHA-256 over every step of it and what it learned.
    pub state_hash: String,
    /// What was carried on of it, in words.
    pub carried: String,
}

impl FromRun {
    fn of(origin: &Origin, plan: &Plan) -> Self {
        let (steps, state_hash) = (origin.steps(), origin.state_hash.clone());
        Self { run: origin.name(), steps, state_hash, carried: origin.carried(plan) }
    }
}

/// When a start came into use.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct StartJoined {
    /// Its name in the world.
    pub name: String,
    /// After how many steps of learning; null if it never did.
    pub joined_at: Option<u64>,
}

fn starts_joined(plan: &Plan, learned: &Learned) -> Vec<StartJoined> {
    let starts = &plan.settings.starts;
    let names = starts.names.iter().filter(|_| starts.widen.is_some()).enumerate();
    names
        .map(|(index, name)| StartJoined { name: name.clone(), joined_at: learned.joined.get(index).copied() })
        .collect()
}

/// What is counted has no column for a rule that only earlier legs had, unless it was counted in these legs.
pub(super) fn rule_totals(plan: &Plan, tally: &Tally) -> Vec<RuleTotal> {
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
    /// How many seeds learned: have a `learned_at`.
    pub converged: usize,
    /// How many seeds are a success.
    pub successes: usize,
    /// The conditions of success.
    pub conditions: Vec<ConditionSpread>,
    /// The median seed's figures, each taken on its own.
    pub median: Figures,
    /// The worst seed's figures, each taken on its own.
    pub worst: Figures,
    /// Every seed.
    pub seeds: Vec<Summary>,
}

/// One condition of success over many seeds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ConditionSpread {
    /// Its name.
    pub name: String,
    /// What must hold.
    pub condition: String,
    /// In how many seeds it holds.
    pub held: usize,
    /// In how many it holds of a robot that knows nothing.
    pub untrained: usize,
    /// The figures that it reads.
    pub figures: Vec<FigureSpread>,
}

/// One figure of a condition over many seeds; null where a seed's test does not have it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FigureSpread {
    /// Its name.
    pub name: String,
    /// The upper median.
    pub median: Option<f64>,
    /// The least.
    pub least: Option<f64>,
    /// The greatest.
    pub greatest: Option<f64>,
    /// The upper median of robots that know nothing.
    pub untrained: Option<f64>,
}

/// The figures that a spread is told by.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    /// Null stands for never, and never is later than any step.
    pub learned_at: Option<u64>,
    /// Failures in 1,000 steps of the test.
    pub failures_per_1000: f64,
    /// Goals as a share of the attempts of the test; null where no seed reached one.
    pub goals_share: Option<f64>,
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
                goals_share: seeds
                    .iter()
                    .any(|seed| seed.test.goals > 0)
                    .then(|| pick(false, &|seed| seed.test.goal_rate)),
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
        let converged = seeds.iter().filter(|seed| seed.learned_at.is_some()).count();
        let successes = seeds.iter().filter(|seed| seed.verdict.is_success()).count();
        let conditions = conditions(&seeds);
        Self { behaviour, world, converged, successes, conditions, median, worst, seeds }
    }
}

/// The conditions, which are alike in all seeds of a run.
fn conditions(seeds: &[Summary]) -> Vec<ConditionSpread> {
    let of = |seed: &Summary, index: usize| seed.verdict.conditions.get(index).cloned();
    let first = seeds.first().map_or(&[][..], |seed| &seed.verdict.conditions);
    let spread = |(index, condition): (usize, &ConditionVerdict)| {
        let all: Vec<ConditionVerdict> = seeds.iter().filter_map(|seed| of(seed, index)).collect();
        let figure = |(at, figure): (usize, &FigureVerdict)| {
            let values = |get: fn(&FigureVerdict) -> Option<f64>| -> Sorted {
                all.iter().filter_map(|condition| get(condition.figures.get(at)?)).collect()
            };
            let own = values(|figure| figure.value);
            FigureSpread {
                name: figure.name.clone(),
                median: own.upper_median(),
                least: own.upper_quantile(0.0),
                greatest: own.upper_quantile(1.0),
                untrained: values(|figure| figure.untrained).upper_median(),
            }
        };
        ConditionSpread {
            name: condition.name.clone(),
            condition: condition.condition.clone(),
            held: all.iter().filter(|condition| condition.holds).count(),
            untrained: all.iter().filter(|condition| condition.untrained).count(),
            figures: condition.figures.iter().enumerate().map(figure).collect(),
        }
    };
    first.iter().enumerate().map(spread).collect()
}
