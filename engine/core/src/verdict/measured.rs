//! What a test measures: the figures of one policy.

use serde::{Deserialize, Serialize};

use super::asked::AskedFigure;
use super::totals::{MeasureTotal, RuleTotal, StageTotal};

/// The frozen policy, judged by the script and by the truth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TestFigures {
    /// Steps of the test.
    pub steps: u64,
    /// Attempts that ended in a failure.
    pub failures: u64,
    /// Attempts that ended in a goal.
    pub goals: u64,
    /// Attempts that ended in neither, such as by a time that was up.
    pub restarts: u64,
    /// Failures for 1,000 steps.
    pub failures_per_1000: f64,
    /// Attempts that were broken off by going on elsewhere, see `run.stay_steps`; absent if none was.
    #[serde(default, skip_serializing_if = "is_none_of")]
    pub hops: u64,
    /// Goals as a share of all attempts that ended, broken off ones included; 0 if none did.
    pub goal_rate: f64,
    /// Goals in whose last step the body touched something or the robot fell; absent if there was none.
    #[serde(default, skip_serializing_if = "is_none_of")]
    pub goal_crashes: u64,
    /// Upper median duration of the attempts that ended in a goal, seconds; null if none did.
    pub goal_s: Option<f64>,
    /// Sum of the rewards for 1,000 steps.
    pub reinforcement_per_1000: f64,
    /// Length of the path, metres; being put somewhere is no path.
    pub distance_m: f64,
    /// Signed progress along the world's lap route, on it and between interventions, metres; null without one.
    pub net_route_m: Option<f64>,
    /// That progress in lengths of the route.
    pub laps: Option<f64>,
    /// Share of the steps that end farther from the route than its half width; null without a route.
    pub off_route: Option<f64>,
    /// Mean distance from the route, metres; null without one.
    pub route_offset_m: Option<f64>,
    /// Progress along the route in either direction, without a route the path, over failures + 1, metres.
    pub metres_per_failure: f64,
    /// Progress along the route in either direction, without a route the path, over failures + restarts + 1, metres.
    #[serde(default)]
    pub metres_per_intervention: f64,
    /// Steps in which the body touched something.
    pub contacts: u64,
    /// Steps in 1,000 in whose choice a guard took an action away; absent in a script without guards.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub forbidden_per_1000: Option<f64>,
    /// Path length over time, m/s.
    pub mean_speed: f64,
    /// True if no attempt lasted 20 s, so that the shares of spells say nothing; absent else.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub no_spells: bool,
    /// Share of spells of 20 s with a full turn on a radius below 0.3 m.
    pub spinning: f64,
    /// Share of spells with less than 0.2 m of path.
    pub standing: f64,
    /// Share of spells that went round in a circle.
    pub circling: f64,
    /// Share of the other spells that end within a quarter of their path of where they began, as going to and fro does.
    pub returning: f64,
    /// Share of the other spells that stay within a circle of 0.6 m, as wriggling on the spot does.
    #[serde(default)]
    pub lingering: f64,
    /// Share of spells with backward progress along the route; null without one.
    pub backwards: Option<f64>,
    /// Median distance between the robot and the prey, metres, centre to centre; null without one.
    pub prey_distance_m: Option<f64>,
    /// Whether the robot makes half of 0.2 m/s net along the route, in either direction; null without a route. Says nothing of
    /// failures: see the verdict.
    pub does_task: Option<bool>,
    /// What each rule did.
    pub rules: Vec<RuleTotal>,
    /// Changes of the stage that rules made.
    #[serde(default)]
    pub stages: u64,
    /// Of these, changes to the first stage.
    #[serde(default)]
    pub rounds: u64,
    /// In how many attempts each stage was entered.
    #[serde(default)]
    pub stage_rates: Vec<StageTotal>,
    /// What each measure came to.
    #[serde(default)]
    pub measures: Vec<MeasureTotal>,
    /// What only the conditions of success ask for, such as the gap to a mover that they name.
    #[serde(default)]
    pub asked: Vec<AskedFigure>,
}

/// Whether a count is 0.
#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde passes it so")]
fn is_none_of(count: &u64) -> bool {
    *count == 0
}

impl TestFigures {
    /// How many attempts had an outcome.
    #[must_use]
    pub fn attempts(&self) -> u64 {
        self.failures + self.goals + self.restarts
    }

    /// Crashes as a share of the goals; 0 without goals.
    #[must_use]
    pub fn goal_crash_rate(&self) -> f64 {
        self.goal_crashes as f64 / self.goals.max(1) as f64
    }

    /// A count for 1,000 steps.
    #[must_use]
    pub fn per_1000(&self, count: u64) -> f64 {
        count as f64 * 1000.0 / self.steps.max(1) as f64
    }

    /// Share of spells without getting anywhere: spinning, standing, circling, returning or lingering.
    #[must_use]
    pub fn idle(&self) -> f64 {
        self.spinning + self.standing + self.circling + self.returning + self.lingering
    }
}
