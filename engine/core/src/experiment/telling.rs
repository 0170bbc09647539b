//! What a script is told of a step.

use super::Eyes;
use crate::geometry::Twist;
use crate::judge::Judge;
use crate::saved::{Passed, Passing};
use crate::sensors::observation::Observation;
use crate::settings::LaserSettings;

/// What is known of a step besides what was sensed.
#[derive(Debug, Clone, Copy)]
pub(super) struct StepTold {
    /// The action's number in the script's list, or [`crate::judge::NO_ACTION`].
    pub action: usize,
    pub twist: Twist,
    /// Steps of the run, and of the attempt.
    pub step: u64,
    pub since_recovery: u64,
    /// The state before it is judged.
    pub state: usize,
}

/// What of the laser is told.
#[derive(Debug, Clone, Copy)]
pub(super) struct LaserTold {
    range_m: (f64, f64),
    view_deg: f64,
}

impl LaserTold {
    pub(super) fn of(laser: &LaserSettings) -> Self {
        Self { range_m: (laser.min_range_m, laser.max_range_m), view_deg: laser.field_of_view_deg }
    }

    pub(super) fn pass(&mut self, by: &mut Passing<'_>) -> Passed {
        by.number(&mut self.range_m.1)
    }

    /// From now on the laser reaches so far, metres.
    pub(super) fn reaches(&mut self, max_range_m: f64) {
        self.range_m.1 = max_range_m;
    }
}

/// Fills in the facts of a judge, as seen through its eyes. Allocates nothing after the first time.
pub(super) fn tell(judge: &mut Judge, eyes: &mut Eyes, observation: &Observation, laser: LaserTold, told: StepTold) {
    let facts = judge.facts_mut();
    facts.ranges_m.clone_from(&observation.scan.ranges_m);
    eyes.tell(&mut facts.views);
    facts.ground = observation.ground.unwrap_or_default();
    facts.state = told.state;
    facts.action = told.action;
    facts.action_linear_m_per_s = told.twist.linear_m_per_s;
    facts.action_angular_rad_per_s = told.twist.angular_rad_per_s;
    facts.contact = observation.contact;
    facts.fallen = observation.fallen;
    facts.linear_m_per_s = observation.odometry.linear_m_per_s;
    facts.angular_rad_per_s = observation.odometry.angular_rad_per_s;
    facts.step = told.step;
    facts.since_recovery = told.since_recovery;
    (facts.laser_range_m, facts.laser_view_deg) = (laser.range_m, laser.view_deg);
}
