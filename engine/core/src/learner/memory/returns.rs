//! The returns that followed the remembered steps, and their sums by state and action.
//!
//! Backwards from the latest step, `G = r + discount ((1 - lambda) V + lambda G)`; after the latest step, and where the robot
//! was put elsewhere, `G = V`. V is the value of the best action that may be taken at the step's end. A fit renews the
//! returns of the latest steps and of one block of the others, and adds only the differences to the sums.

use super::kernel::TwistKernel;
use super::past::{Follows, PastStep, PastSteps};
use super::pools::Pools;
use super::scale::ReturnTotals;
use super::{BLOCK_STEPS, RECENT_STEPS};
use crate::allowed::Allowed;
use crate::learner::Mirror;
use crate::learner::q_table::{best_among, best_of};

/// The latest table: a row for each state that was met.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct LatestTable {
    pub(super) actions: usize,
    pub(super) values: Vec<f64>,
    /// By row: the value of its best action.
    best: Vec<f64>,
}

impl LatestTable {
    pub(super) fn new(actions: usize) -> Self {
        Self { actions, values: Vec::new(), best: Vec::new() }
    }

    /// Forgets all values.
    pub(super) fn clear(&mut self) {
        self.values.fill(0.0);
        self.best.fill(0.0);
    }

    /// Makes room for one more row.
    pub(super) fn meet(&mut self) {
        self.values.resize(self.values.len() + self.actions, 0.0);
        self.best.push(0.0);
    }

    pub(super) fn row(&self, row: usize) -> &[f64] {
        &self.values[row * self.actions..(row + 1) * self.actions]
    }

    pub(super) fn row_mut(&mut self, row: usize) -> &mut [f64] {
        &mut self.values[row * self.actions..(row + 1) * self.actions]
    }

    /// Notes the best value of a row that was changed.
    pub(super) fn settle(&mut self, row: usize) {
        self.best[row] = best_of(self.row(row)).1;
    }

    /// The value of a state: that of its best action that may be taken.
    fn value(&self, row: usize, allowed: Allowed) -> f64 {
        if allowed.is_all() { self.best[row] } else { best_among(self.row(row), allowed).1 }
    }
}

/// The mirror image of each row, where left is learned for right.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ImageRows {
    pub(super) mirror: Mirror,
    pub(super) rows: Vec<u32>,
}

impl ImageRows {
    /// The image of a step's state and action; nothing if that is itself.
    fn of(&self, step: &PastStep) -> Option<(usize, usize)> {
        let own = (step.row as usize, step.action as usize);
        let image = (self.rows[own.0] as usize, self.mirror.action(own.1));
        (image != own).then_some(image)
    }
}

/// How returns are made of what follows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Discounts {
    pub(super) discount: f64,
    pub(super) lambda: f64,
}

/// Weighted sums of returns by row and action, as they were met and spread over similar actions.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ReturnSums {
    pub(super) actions: usize,
    pub(super) sums: Vec<f64>,
    pub(super) tries: Vec<f64>,
    pub(super) spread_sums: Vec<f64>,
    pub(super) spread_tries: Vec<f64>,
    /// By row: whether its sums changed since they were spread.
    pub(super) changed: Vec<bool>,
    pub(super) totals: ReturnTotals,
    /// How far back the block is that is renewed next.
    pub(super) block: usize,
    room: [Vec<f64>; 2],
}

impl ReturnSums {
    pub(super) fn new(actions: usize) -> Self {
        Self {
            actions,
            sums: Vec::new(),
            tries: Vec::new(),
            spread_sums: Vec::new(),
            spread_tries: Vec::new(),
            changed: Vec::new(),
            totals: ReturnTotals::default(),
            block: 0,
            room: [vec![0.0; actions], vec![0.0; actions]],
        }
    }

    /// Makes room for one more row.
    pub(super) fn meet(&mut self) {
        let all = [&mut self.sums, &mut self.tries, &mut self.spread_sums, &mut self.spread_tries];
        for sums in all {
            sums.resize(sums.len() + self.actions, 0.0);
        }
        self.changed.push(false);
    }

    /// Counts a step with its return, or takes it away again if `sign` is -1.
    pub(super) fn count(&mut self, step: &PastStep, images: Option<&ImageRows>, sign: f64) {
        let (weight, gain) = (sign * step.weight, step.gain);
        self.totals.weight += weight;
        self.totals.sum += weight * gain;
        self.totals.squares += weight * gain * gain;
        self.credit(step, images, weight, weight * gain);
    }

    fn credit(&mut self, step: &PastStep, images: Option<&ImageRows>, tries: f64, sum: f64) {
        let own = Some((step.row as usize, step.action as usize));
        for (row, action) in own.into_iter().chain(images.and_then(|images| images.of(step))) {
            let at = row * self.actions + action;
            self.tries[at] += tries;
            self.sums[at] += sum;
            self.changed[row] = true;
        }
    }

    /// Forgets all sums.
    pub(super) fn clear(&mut self) {
        let all = [&mut self.sums, &mut self.tries, &mut self.spread_sums, &mut self.spread_tries];
        all.into_iter().for_each(|sums| sums.fill(0.0));
        self.changed.fill(true);
        self.totals = ReturnTotals::default();
    }

    /// Renews the returns of the latest steps, and of the next block of the others.
    pub(super) fn renew(
        &mut self,
        past: &mut PastSteps,
        table: &LatestTable,
        images: Option<&ImageRows>,
        by: Discounts,
    ) {
        let recent = past.len().min(RECENT_STEPS);
        self.renew_between(past, table, images, by, 0..recent);
        if past.len() > recent {
            let from = if (recent..past.len()).contains(&self.block) { self.block } else { recent };
            self.block = (from + BLOCK_STEPS).min(past.len());
            self.renew_between(past, table, images, by, from..self.block);
        }
    }

    /// Renews the returns of all steps.
    pub(super) fn renew_all(
        &mut self,
        past: &mut PastSteps,
        table: &LatestTable,
        images: Option<&ImageRows>,
        by: Discounts,
    ) {
        let all = 0..past.len();
        self.renew_between(past, table, images, by, all);
    }

    /// Of the steps from so many to so many before the latest, the latest first.
    fn renew_between(
        &mut self,
        past: &mut PastSteps,
        table: &LatestTable,
        images: Option<&ImageRows>,
        Discounts { discount, lambda }: Discounts,
        backs: std::ops::Range<usize>,
    ) {
        let (now, later) = (discount * (1.0 - lambda), discount * lambda);
        let mut following = backs.start.checked_sub(1).map(|back| past.back(back).gain);
        for back in backs {
            let step = past.back_mut(back);
            let value = table.value(step.next_row as usize, step.next_allowed);
            let gain = match step.follows {
                Follows::Next => step.reward + now * value + later * following.unwrap_or(value),
                Follows::Value => step.reward + now * value + later * value,
                Follows::Nothing => step.reward,
            };
            following = Some(gain);
            let before = std::mem::replace(&mut step.gain, gain);
            let change = step.weight * (gain - before);
            self.totals.sum += change;
            self.totals.squares += change * (gain + before);
            let step = *step;
            self.credit(&step, images, 0.0, change);
        }
    }

    /// Spreads the rows that changed over similar actions, and hands the differences to their sub-tuples.
    pub(super) fn spread(&mut self, kernel: &TwistKernel, pools: &mut Pools, members: &[u32]) {
        let (actions, width) = (self.actions, pools.levels().tuples.len());
        let [sums, tries] = &mut self.room;
        for row in 0..self.changed.len() {
            if !std::mem::take(&mut self.changed[row]) {
                continue;
            }
            let of_row = row * actions..(row + 1) * actions;
            kernel.spread([&self.sums[of_row.clone()], &self.tries[of_row.clone()]], [sums, tries]);
            for (action, at) in of_row.enumerate() {
                let change = [sums[action] - self.spread_sums[at], tries[action] - self.spread_tries[at]];
                (self.spread_sums[at], self.spread_tries[at]) = (sums[action], tries[action]);
                if change != [0.0; 2] {
                    pools.add(&members[row * width..(row + 1) * width], action, change[0], change[1]);
                }
            }
        }
    }
}
