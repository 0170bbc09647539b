//! What a test counts of stages and measures.

use std::ops::ControlFlow;

use super::{Cycle, Observer, Plan, Step};
use crate::verdict::{MeasureTotal, StageTotal};

/// Looks on while a test runs.
#[derive(Debug)]
pub(super) struct Staged {
    names: Vec<String>,
    /// The stages that rules have entered in the present attempt, a bit for each.
    entered: u32,
    /// For each stage, in how many attempts it was entered.
    attempts: Vec<u64>,
    /// Attempts that have ended.
    ended: u64,
    measures: Vec<MeasureTotal>,
    steps: u64,
}

impl Staged {
    /// Of a plan's stages and measures.
    pub(super) fn new(plan: &Plan) -> Self {
        let names = plan.settings.stages.clone();
        let measure = |name: &str| MeasureTotal {
            name: name.to_owned(),
            mean: 0.0,
            least: f64::INFINITY,
            greatest: f64::NEG_INFINITY,
        };
        let measures = plan.behaviour.measures().map(measure).collect();
        Self { entered: 0, attempts: vec![0; names.len()], names, ended: 0, measures, steps: 0 }
    }

    fn end_attempt(&mut self) {
        let entered = std::mem::take(&mut self.entered);
        for (stage, attempts) in self.attempts.iter_mut().enumerate() {
            *attempts += u64::from(entered & (1 << stage) != 0);
        }
        self.ended += 1;
    }

    /// The figures: of stages with the unfinished attempt, of measures over all steps.
    pub(super) fn finish(mut self) -> (Vec<StageTotal>, Vec<MeasureTotal>) {
        self.end_attempt();
        let all = self.ended as f64;
        let rate = |(name, attempts): (String, u64)| StageTotal { name, rate: attempts as f64 / all };
        let steps = self.steps.max(1) as f64;
        let measures = self.measures.into_iter().map(|sum| MeasureTotal { mean: sum.mean / steps, ..sum });
        (self.names.into_iter().zip(self.attempts).map(rate).collect(), measures.collect())
    }
}

impl<R> Observer<R> for Staged {
    fn stepped(&mut self, cycle: &Cycle<R>, step: &Step) -> ControlFlow<()> {
        self.steps += 1;
        if let Some(stage) = step.entered {
            self.entered |= 1 << stage;
        }
        for (measure, value) in self.measures.iter_mut().zip(cycle.measures()) {
            measure.mean += value;
            measure.least = measure.least.min(value);
            measure.greatest = measure.greatest.max(value);
        }
        if step.then.is_some() {
            self.end_attempt();
        }
        ControlFlow::Continue(())
    }
}
