//! What of a judge goes on from step to step, for checkpoints.

use super::facts::{Facts, StageFacts};
use super::judging::{Judge, StageNow};
use super::view_facts::{LineFacts, PatchFacts, ViewFacts};
use crate::saved::{Passed, Passing, Unfit};
use std::sync::Arc;

impl Judge {
    /// Passes what is remembered from step to step.
    pub(crate) fn pass(&mut self, by: &mut Passing<'_>) -> Passed {
        by.all(&mut self.held, Passing::small)?;
        by.all(&mut self.spent, Passing::flag)?;
        self.stage.pass(by)?;
        self.odometry.pass(by)?;
        by.all(&mut self.digits, Passing::size)?;
        by.flag(&mut self.is_taken)?;
        by.flag(&mut self.is_past)?;
        self.present.memory.pass(by)?;
        for facts in [&mut self.present.facts, &mut self.present.previous] {
            Arc::make_mut(facts).pass(by)?;
        }
        self.pass_calibrated(by)?;
        if self.stage.index > 0 && self.stage.index >= self.present.compiled.stages.len() { Err(Unfit) } else { Ok(()) }
    }
}

impl StageNow {
    fn pass(&mut self, by: &mut Passing<'_>) -> Passed {
        by.size(&mut self.index)?;
        by.whole(&mut self.steps)?;
        by.numbers([&mut self.distance_m, &mut self.turned_rad])
    }
}

impl Facts {
    fn pass(&mut self, by: &mut Passing<'_>) -> Passed {
        let Self { laser_range_m: (least_m, greatest_m), .. } = self;
        by.numbers([least_m, greatest_m, &mut self.action_linear_m_per_s, &mut self.action_angular_rad_per_s])?;
        by.numbers([
            &mut self.linear_m_per_s,
            &mut self.angular_rad_per_s,
            &mut self.laser_view_deg,
            &mut self.attempt_s,
        ])?;
        by.all(&mut self.ranges_m, Passing::single)?;
        by.list(&mut self.views, |by, view| view.pass(by))?;
        by.size(&mut self.state)?;
        by.size(&mut self.action)?;
        by.flag(&mut self.contact)?;
        by.flag(&mut self.fallen)?;
        by.whole(&mut self.step)?;
        by.whole(&mut self.since_recovery)?;
        for colour in self.ground.as_flattened_mut() {
            let mut level = u32::from(*colour);
            by.small(&mut level)?;
            *colour = u8::try_from(level).map_err(|_| Unfit)?;
        }
        self.odometry.pass(by)?;
        let StageFacts { index, steps, seconds, distance_m, turned_deg } = &mut self.stage;
        by.size(index)?;
        by.whole(steps)?;
        by.numbers([seconds, distance_m, turned_deg])
    }
}

impl ViewFacts {
    fn pass(&mut self, by: &mut Passing<'_>) -> Passed {
        by.list(&mut self.cells, Passing::single)?;
        by.list(&mut self.areas_px, Passing::small)?;
        by.size(&mut self.grid.0)?;
        by.size(&mut self.grid.1)?;
        by.size(&mut self.index)?;
        by.flag(&mut self.seen)?;
        by.number(&mut self.coverage)?;
        let PatchFacts { size, bearing_deg, elevation_deg, offset, left_deg, right_deg, floor_m } = &mut self.patch;
        by.numbers([size, bearing_deg, elevation_deg, offset, left_deg, right_deg, floor_m])?;
        let LineFacts { seen, offset_m, heading_deg } = &mut self.line;
        by.flag(seen)?;
        by.numbers([offset_m, heading_deg])
    }
}
