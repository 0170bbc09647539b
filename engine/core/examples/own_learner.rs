//! A learner of one's own: it remembers what each action brought in each state, and nothing of what came later.
//! `cargo run --release -p engine --example own_learner`.

#![allow(clippy::print_stdout, reason = "an example shows what it found")]

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use engine::allowed::Allowed;
use engine::experiment::{Cycle, Learning, Ledger, Overrides, Phase, Plan, test};
use engine::learner::{Carry, Learner, Mirror, Policy, PolicyRow, Task, Transition};
use engine::random::Random;
use engine::saved::{Loading, Saving, Unfit};
use engine::script::Behaviour;
use engine::settings::LearnerSettings;

/// The mean reward of each action in each state.
struct Bandit {
    actions: usize,
    sums: Vec<f64>,
    tries: Vec<u64>,
    random: Random,
}

impl Bandit {
    fn new(task: Task) -> Self {
        let (actions, random) = (task.actions.len(), task.random);
        let pairs = task.states * actions;
        Self { actions, sums: vec![0.0; pairs], tries: vec![0; pairs], random }
    }

    /// What the actions of a state brought on average; 0 where one was not tried.
    fn means(&self, state: usize) -> impl Iterator<Item = f64> + '_ {
        let pairs = state * self.actions..(state + 1) * self.actions;
        pairs.map(|pair| self.sums[pair] / self.tries[pair].max(1) as f64)
    }

    fn best(&self, state: usize, allowed: Allowed) -> usize {
        let better = |best: (usize, f64), now: (usize, f64)| if now.1 > best.1 { now } else { best };
        let means = self.means(state).enumerate().filter(|(action, _)| allowed.contains(*action));
        means.fold((0, f64::NEG_INFINITY), better).0
    }
}

impl Learner for Bandit {
    fn choose(&mut self, state: usize, allowed: Allowed) -> (usize, bool) {
        let best = self.best(state, allowed);
        let any = self.random.below(allowed.count(self.actions) as u32) as usize;
        let action = if self.random.unit() < 0.1 { allowed.nth(any).unwrap_or(best) } else { best };
        (action, action != best)
    }

    fn visit(&mut self, _: usize) {}

    fn learn(&mut self, transition: &Transition) {
        let pair = transition.state * self.actions + transition.action;
        self.sums[pair] += transition.reward;
        self.tries[pair] += 1;
    }

    fn forget(&mut self) {}

    fn swap(&mut self, _: &LearnerSettings, _: Option<Mirror>, carry: Carry) {
        if carry == Carry::Reset {
            self.sums.fill(0.0);
            self.tries.fill(0);
        }
    }

    fn policy(&self) -> Policy {
        let row = |state: usize| {
            let visits = self.tries[state * self.actions..][..self.actions].iter().sum();
            (visits > 0).then(|| PolicyRow { visits, values: self.means(state).collect() })
        };
        Policy::new(self.actions, (0..self.sums.len() / self.actions).map(row).collect())
    }

    fn numbers(&self, each: &mut dyn FnMut(f64)) {
        self.sums.iter().for_each(|sum| each(*sum));
    }

    fn save(&self, to: &mut Saving) {
        to.numbers(&self.sums);
        to.wholes(&self.tries);
        to.random(&self.random);
    }

    fn load(&mut self, from: &mut Loading<'_>) -> Result<(), Unfit> {
        from.numbers(&mut self.sums)?;
        from.wholes(&mut self.tries)?;
        from.random(&mut self.random)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scripts/avoid.rhai");
    let plan = Plan::new(Arc::new(Behaviour::load(&script)?), &Overrides::default())?;
    let (seed, never) = (1, AtomicBool::new(false));
    let cycle = Cycle::new(&plan, Phase::Learning.robot(&plan, seed)?)?;
    let bandit = Bandit::new(plan.task(cycle.state_map(), seed)?);
    let mut learning = Learning::with(&plan, seed, cycle, bandit);
    learning.run(plan.settings.run.steps, &never, &|_| (), &mut Ledger::off())?;
    let learned = learning.finish();
    let tested = test(&plan, &learned.policy, seed, &never)?;
    println!("{} failures in {} steps of the test", tested.figures.failures, tested.figures.steps);
    Ok(())
}
