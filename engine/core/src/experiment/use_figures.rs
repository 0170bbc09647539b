//! How much the policies that a script uses drove in a test.

use serde::{Deserialize, Serialize};

use super::{Plan, Step};

/// One policy that a script uses, as `summary.json` tells it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct UseFigures {
    /// What the script calls it.
    pub name: String,
    /// The behaviour that it learned.
    pub behaviour: String,
    /// Share of the steps of the test in which it drove.
    pub drove: f64,
    /// How often it took over in 1,000 steps.
    pub takeovers_per_1000: f64,
}

/// Counts who drives.
#[derive(Debug, Clone)]
pub(super) struct UseCounts {
    /// By use: its policy.
    policies: Vec<usize>,
    steps: u64,
    /// By policy: steps, and how often it took over.
    drove: Vec<(u64, u64)>,
    last: Option<usize>,
}

impl UseCounts {
    pub(super) fn new(plan: &Plan) -> Self {
        let policies = plan.behaviour.uses().map(|(_, policy)| policy).collect();
        Self { policies, steps: 0, drove: vec![(0, 0); plan.used.len()], last: None }
    }

    pub(super) fn count(&mut self, step: &Step) {
        self.steps += 1;
        let policy = step.driver.and_then(|by| self.policies.get(by).copied());
        if let Some((steps, takeovers)) = policy.and_then(|policy| self.drove.get_mut(policy)) {
            *steps += 1;
            *takeovers += u64::from(self.last != policy);
        }
        // After a recovery it takes over anew.
        self.last = policy.filter(|_| step.then.is_none());
    }

    pub(super) fn figures(&self, plan: &Plan) -> Vec<UseFigures> {
        let steps = self.steps.max(1) as f64;
        let figures = plan.used.iter().zip(&self.drove).map(|(used, (drove, takeovers))| UseFigures {
            name: used.name.clone(),
            behaviour: used.plan.behaviour.name().to_owned(),
            drove: *drove as f64 / steps,
            takeovers_per_1000: 1000.0 * *takeovers as f64 / steps,
        });
        figures.collect()
    }
}
