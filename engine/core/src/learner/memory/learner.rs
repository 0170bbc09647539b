//! The learner itself: it chooses, remembers, and every few steps values all that it remembers anew.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::ageing::weight_at;
use super::averaged::AveragedTable;
use super::kernel::TwistKernel;
use super::met::StatesMet;
use super::past::{Follows, PastStep, PastSteps};
use super::pools::{PooledRow, Pools};
use super::returns::{Discounts, ImageRows, LatestTable, ReturnSums};
use super::scale::{COLD, COOLING_VISITS, HOT, ReturnScale};
use super::{FIRST_WEIGHT, FIT_STEPS, POOLED_WEIGHT, SIMILAR_WEIGHT};
use crate::allowed::Allowed;
use crate::learner::q_table::best_among;
use crate::learner::softmax::temperature;
use crate::learner::{Carry, Learner, Mirror, Policy, PolicyRow, Rejudged, Softmax, Task, Transition};
use crate::outcome::Ending;
use crate::random::Random;
use crate::saved::{Loading, Saving, Unfit};
use crate::settings::LearnerSettings;

/// A policy has a row for each of so many states; over more, it answers for states never met from what it keeps of their parts.
const MOST_ROWS: usize = 4_096;

/// A learner that remembers its last steps.
pub struct MemoryLearner {
    pub(super) states: usize,
    pub(super) met: StatesMet,
    pub(super) visits: Vec<u64>,
    pub(super) past: PastSteps,
    pub(super) sums: ReturnSums,
    pub(super) pools: Pools,
    /// By row: the entries of its sub-tuples.
    pub(super) members: Vec<u32>,
    pub(super) table: LatestTable,
    pub(super) averaged: AveragedTable,
    pub(super) scale: ReturnScale,
    pub(super) kernel: TwistKernel,
    images: Option<ImageRows>,
    softmax: Softmax,
    discounts: Discounts,
    failure_is_terminal: bool,
    pub(super) random: Random,
    /// Steps since the learner began, or since its age was forgotten.
    pub(super) age: u64,
    pub(super) since_fit: u64,
    /// What one try of the latest step weighs, inverted.
    pub(super) today: f64,
}

impl MemoryLearner {
    /// A learner that knows nothing yet.
    #[must_use]
    pub(in crate::learner) fn new(settings: &LearnerSettings, task: Task) -> Self {
        let Task { digits, states, actions, mirror, random } = task;
        Self {
            states,
            met: StatesMet::default(),
            visits: Vec::new(),
            past: PastSteps::new(settings.memory_steps as usize),
            sums: ReturnSums::new(actions.len()),
            pools: Pools::new(digits, actions.len()),
            members: Vec::new(),
            table: LatestTable::new(actions.len()),
            averaged: AveragedTable::default(),
            scale: ReturnScale::default(),
            kernel: TwistKernel::new(&actions),
            images: mirror.map(|mirror| ImageRows { mirror, rows: Vec::new() }),
            softmax: Softmax::new(settings, actions.len()),
            discounts: discounts(settings),
            failure_is_terminal: settings.failure_is_terminal,
            random,
            age: 0,
            since_fit: 0,
            today: 1.0,
        }
    }

    /// The greatest spread of returns so far: first values and temperatures are told in it.
    #[must_use]
    pub fn unit(&self) -> f64 {
        self.scale.unit
    }

    /// The row of a state. One that was never met gets a row, and its mirror image too, from what is known of its parts.
    fn row_of(&mut self, state: usize) -> usize {
        if let Some(row) = self.met.row(state) {
            return row;
        }
        let row = self.open_row(state);
        self.value_row(row);
        let image = self.images.as_ref().map(|images| images.mirror.state(state));
        if let Some(image) = image.filter(|image| *image != state) {
            let image_row = self.open_row(image);
            self.value_row(image_row);
            self.pair_images(row, image_row);
        }
        row
    }

    /// Makes a row without values; it is its own image until it is paired with another.
    pub(super) fn open_row(&mut self, state: usize) -> usize {
        let row = self.met.meet(state);
        self.visits.push(0);
        self.pools.meet(state, &mut self.members);
        self.sums.meet();
        self.table.meet();
        self.averaged.meet(self.table.actions);
        if let Some(images) = &mut self.images {
            images.rows.push(row as u32);
        }
        row
    }

    /// Forgets which rows are images of one another.
    pub(super) fn clear_images(&mut self) {
        if let Some(images) = &mut self.images {
            images.rows.clear();
        }
    }

    /// Pairs all rows with their images, where left is learned for right.
    pub(super) fn pair_all(&mut self) {
        for row in 0..self.met.states().len() {
            let image = self.images.as_ref().map(|images| images.mirror.state(self.met.states()[row]));
            if let Some(image_row) = image.and_then(|image| self.met.row(image)) {
                self.pair_images(row, image_row);
            }
        }
    }

    fn pair_images(&mut self, row: usize, image: usize) {
        if let Some(images) = &mut self.images {
            images.rows[row] = image as u32;
            images.rows[image] = row as u32;
        }
    }

    fn count_visit(&mut self, state: usize) -> usize {
        let row = self.row_of(state);
        self.visits[row] += 1;
        let image = self.images.as_ref().map(|images| images.rows[row] as usize);
        if let Some(image) = image.filter(|image| *image != row) {
            self.visits[image] += 1;
        }
        row
    }

    /// Values a row: sub-tuples, behind similar actions, behind its own tries.
    fn value_row(&mut self, row: usize) {
        let (width, actions, today) = (self.pools.levels().tuples.len(), self.table.actions, self.today);
        let pooled_weight = if self.pools.has_levels() { POOLED_WEIGHT } else { FIRST_WEIGHT };
        let values = self.table.row_mut(row);
        self.pools.row(&self.members[row * width..(row + 1) * width], values);
        let of_row = row * actions..(row + 1) * actions;
        let ReturnSums { sums, tries, spread_sums, spread_tries, .. } = &self.sums;
        let spread = spread_sums[of_row.clone()].iter().zip(&spread_tries[of_row.clone()]);
        let own = sums[of_row.clone()].iter().zip(&tries[of_row]);
        for ((value, (spread_sum, spread_tries)), (sum, tries)) in values.iter_mut().zip(spread).zip(own) {
            let similar = (spread_sum * today + pooled_weight * *value) / (spread_tries * today + pooled_weight);
            *value = (sum * today + SIMILAR_WEIGHT * similar) / (tries * today + SIMILAR_WEIGHT);
        }
        self.table.settle(row);
    }

    /// What a step earned, with what delayed rules built up or lost, and what flows back into it.
    pub(super) fn earned(&self, transition: &Transition) -> (f64, Follows) {
        let ended = transition.ending.is_some_and(Ending::is_terminal);
        let follows = match transition.ending {
            None => Follows::Next,
            Some(_) if ended && self.failure_is_terminal => Follows::Nothing,
            Some(_) => Follows::Value,
        };
        let next_potential = if ended { 0.0 } else { transition.next_potential };
        (transition.reward + self.discounts.discount * next_potential - transition.potential, follows)
    }

    /// Values all that is remembered anew.
    fn fit(&mut self) {
        self.since_fit = 0;
        self.sums.renew(&mut self.past, &self.table, self.images.as_ref(), self.discounts);
        self.value();
    }

    /// As [`Self::fit`], with the returns of all remembered steps renewed.
    pub(super) fn fit_all(&mut self) {
        self.since_fit = 0;
        self.sums.renew_all(&mut self.past, &self.table, self.images.as_ref(), self.discounts);
        self.value();
    }

    /// Values all states by the returns as they are.
    fn value(&mut self) {
        self.sums.spread(&self.kernel, &mut self.pools, &self.members);
        self.pools.settle(self.scale.first_value(), self.today);
        for row in 0..self.visits.len() {
            self.value_row(row);
        }
        self.averaged.add(&self.table.values);
        self.scale.update(&self.sums.totals);
    }

    /// This learner with another stream of random numbers.
    #[must_use]
    pub(in crate::learner) fn with_random(self, random: Random) -> Self {
        Self { random, ..self }
    }

    /// Keeps the memory, but not how old it is nor how often each state was visited: what is known leads on, and is tried again.
    fn rejuvenate(&mut self) {
        self.visits.fill(0);
        (self.age, self.today) = (0, 1.0);
        self.averaged.clear();
        self.recount(|back, _| weight_at(-(back as f64)));
    }

    /// Counts all remembered steps from nothing, and values them.
    fn recount(&mut self, weight: impl Fn(usize, f64) -> f64) {
        self.count_all(weight);
        self.fit();
    }

    /// Counts all remembered steps from nothing, each with a weight by how far back it is and what it weighed.
    pub(super) fn count_all(&mut self, weight: impl Fn(usize, f64) -> f64) {
        self.sums.clear();
        self.pools.clear();
        for back in 0..self.past.len() {
            let step = self.past.back_mut(back);
            step.weight = weight(back, step.weight);
            let step = *step;
            self.sums.count(&step, self.images.as_ref(), 1.0);
        }
    }

    /// The row of a policy: the mean of the last tables, the latest one where there is none yet.
    fn frozen_row(&self, row: usize) -> PolicyRow {
        let values = match self.averaged.row(row, self.table.actions) {
            Some(mean) => mean.collect(),
            None => self.table.row(row).to_vec(),
        };
        PolicyRow { visits: self.visits[row], values }
    }
}

fn discounts(settings: &LearnerSettings) -> Discounts {
    Discounts { discount: settings.memory_discount, lambda: settings.memory_lambda }
}

impl Learner for MemoryLearner {
    /// By softmax at a temperature that is a share of the unit, and falls with the visits of the state.
    fn choose(&mut self, state: usize, allowed: Allowed) -> (usize, bool) {
        let row = self.count_visit(state);
        let share = temperature(HOT, COLD, COOLING_VISITS, self.visits[row] - 1);
        let (values, temperature) = (self.table.row(row), self.scale.temperature(share));
        let action = self.softmax.choose_at(values, allowed, temperature, &mut self.random);
        (action, best_among(values, allowed).0 != action)
    }

    fn visit(&mut self, state: usize) {
        self.count_visit(state);
    }

    fn learn(&mut self, transition: &Transition) {
        let Transition { state, action, reward, next_state, ending, .. } = *transition;
        let (row, next_row) = (self.row_of(state), self.row_of(next_state));
        let (earned, follows) = self.earned(transition);
        self.age += 1;
        self.since_fit += 1;
        let weight = weight_at(self.age as f64);
        self.today = 1.0 / weight;
        let step = PastStep {
            row: row as u32,
            action: action as u32,
            next_row: next_row as u32,
            follows,
            reward: earned,
            next_allowed: transition.next_allowed,
            weight,
            gain: 0.0,
        };
        self.sums.count(&step, self.images.as_ref(), 1.0);
        if let Some(forgotten) = self.past.push(step) {
            self.sums.count(&forgotten, self.images.as_ref(), -1.0);
        }
        if self.since_fit == FIT_STEPS || (ending.is_some() && reward != 0.0) {
            self.fit();
        }
    }

    /// What comes next does not follow from the latest step.
    fn forget(&mut self) {
        if self.past.len() > 0 && self.past.back(0).follows == Follows::Next {
            self.past.back_mut(0).follows = Follows::Value;
        }
    }

    /// Another reward keeps all, forgets visits and age, or forgets everything.
    fn swap(&mut self, settings: &LearnerSettings, mirror: Option<Mirror>, carry: Carry) {
        self.forget();
        self.discounts = discounts(settings);
        self.failure_is_terminal = settings.failure_is_terminal;
        let rows = (0..self.visits.len() as u32).collect();
        let images = mirror.map(|mirror| ImageRows { mirror, rows });
        let forgotten = self.past.resize(settings.memory_steps as usize);
        let changed = forgotten || images.is_some() != self.images.is_some();
        self.images = images;
        self.pair_all();
        match carry {
            Carry::Keep if changed => self.recount(|_, weight| weight),
            Carry::Keep => {}
            Carry::Decay => self.rejuvenate(),
            // What comes next is told by `rescore`.
            Carry::Rescore => {}
            Carry::Reset => {
                self.past.clear();
                self.scale = ReturnScale::default();
                self.rejuvenate();
                self.averaged.clear();
            }
        }
    }

    fn rescore(&mut self, steps: &[Rejudged]) {
        self.judge_anew(steps);
    }

    fn policy(&self) -> Policy {
        let actions = self.table.actions;
        let met = self.met.states().iter().enumerate();
        let mut rows: BTreeMap<usize, PolicyRow> = met.map(|(row, state)| (*state, self.frozen_row(row))).collect();
        let pools = if self.states > MOST_ROWS { self.pools.frozen().map(Arc::new) } else { None };
        let mut room = PooledRow::default();
        for state in 0..if pools.is_none() { self.states } else { 0 } {
            rows.entry(state).or_insert_with(|| {
                self.pools.answer(state, &mut room);
                PolicyRow { visits: 0, values: room.values.clone() }
            });
        }
        let policy = Policy::of_states(actions, self.states, rows);
        policy.at_temperature(self.scale.temperature(COLD)).answering(pools)
    }

    fn numbers(&self, each: &mut dyn FnMut(f64)) {
        let all = self.table.values.iter().chain(&self.averaged.sums).chain([&self.scale.unit, &self.scale.mean]);
        all.for_each(|number| each(*number));
    }

    fn save(&self, to: &mut Saving) {
        self.write(to);
    }

    fn load(&mut self, from: &mut Loading<'_>) -> Result<(), Unfit> {
        self.read(from)
    }
}
