//! Of a test in several worlds: what was done in each.

use serde::{Deserialize, Serialize};

use super::{Plan, Step};
use crate::outcome::Endings;
use crate::world::Layout;
use std::sync::Arc;

/// What a test did in one world.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WorldFigures {
    /// Its name.
    pub world: String,
    /// Steps that were done in it.
    pub steps: u64,
    /// Attempts in it that ended in a failure.
    pub failures: u64,
    /// Failures for 1,000 of its steps; 0 if none was done.
    pub failures_per_1000: f64,
    /// Attempts in it that ended in a goal.
    pub goals: u64,
    /// Attempts in it that ended in neither.
    pub restarts: u64,
}

/// Counts by world; none of a plan with one world alone.
#[derive(Debug, Clone)]
pub(super) struct WorldCounts(Vec<(u64, Endings)>);

impl WorldCounts {
    pub(super) fn new(plan: &Plan) -> Self {
        let worlds = if plan.worlds.further().is_empty() { 0 } else { plan.worlds.layouts().len() };
        Self(vec![(0, Endings::default()); worlds])
    }

    /// Counts one step that was done in a world.
    pub(super) fn count(&mut self, world: usize, step: &Step) {
        if let Some((steps, endings)) = self.0.get_mut(world) {
            *steps += 1;
            endings.count(step.ending());
        }
    }

    /// The figures, in the order of the worlds.
    pub(super) fn figures(&self, plan: &Plan) -> Vec<WorldFigures> {
        let of = |(layout, (steps, endings)): (&Arc<Layout>, &(u64, Endings))| WorldFigures {
            world: layout.name.clone(),
            steps: *steps,
            failures: endings.failures,
            failures_per_1000: 1000.0 * endings.failures as f64 / (*steps).max(1) as f64,
            goals: endings.goals,
            restarts: endings.restarts,
        };
        plan.worlds.layouts().iter().zip(&self.0).map(of).collect()
    }
}
