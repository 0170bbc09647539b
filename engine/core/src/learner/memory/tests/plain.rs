//! The definition: everything that is remembered is gone through from nothing in every fit, and nothing is kept.

use std::collections::{BTreeMap, BTreeSet};

use super::super::scale::ROUNDING;
use crate::allowed::Allowed;
use crate::geometry::Twist;
use crate::learner::Transition;
use crate::outcome::Ending;
use crate::settings::LearnerSettings;
use crate::state::Digit;

struct Record {
    transition: Transition,
    reward: f64,
    cut: bool,
    terminal: bool,
}

pub(super) struct Plain {
    settings: LearnerSettings,
    digits: Vec<Digit>,
    actions: Vec<Twist>,
    records: Vec<Record>,
    met: BTreeSet<usize>,
    age: usize,
    since_fit: usize,
    fits: usize,
    values: BTreeMap<(usize, usize), f64>,
    /// By state and action: sum of what frozen tables held, and of their weights.
    averaged: BTreeMap<(usize, usize), (f64, f64)>,
    /// As of the last fit.
    sums: BTreeMap<(usize, usize), [f64; 2]>,
    first_value: f64,
    pub(super) unit: f64,
    pub(super) mean: f64,
}

impl Plain {
    pub(super) fn new(settings: &LearnerSettings, digits: Vec<Digit>, actions: Vec<Twist>) -> Self {
        let (records, met, values, averaged, sums) = Default::default();
        let settings = settings.clone();
        let (age, since_fit, fits, first_value, unit, mean) = (0, 0, 0, 0.0, 0.0, 0.0);
        Self {
            settings,
            digits,
            actions,
            records,
            met,
            age,
            since_fit,
            fits,
            values,
            averaged,
            sums,
            first_value,
            unit,
            mean,
        }
    }

    pub(super) fn learn(&mut self, transition: &Transition, moved: bool) {
        self.meet(transition.state);
        self.meet(transition.next_state);
        let ended = transition.ending.is_some_and(Ending::is_terminal);
        let after = if ended { 0.0 } else { transition.next_potential };
        let reward = transition.reward + self.settings.memory_discount * after - transition.potential;
        let terminal = ended && self.settings.failure_is_terminal;
        self.records.push(Record { transition: *transition, reward, cut: transition.ending.is_some(), terminal });
        if self.records.len() > self.settings.memory_steps as usize {
            self.records.remove(0);
        }
        self.age += 1;
        self.since_fit += 1;
        if self.since_fit == 20 || (transition.ending.is_some() && transition.reward != 0.0) {
            self.fit();
        }
        if moved {
            self.records.last_mut().unwrap().cut = true;
        }
    }

    /// A state never met is valued by the sums of the last fit.
    fn meet(&mut self, state: usize) {
        if self.met.insert(state) {
            for action in 0..self.actions.len() {
                let value = self.valued(state, action);
                self.values.insert((state, action), value);
            }
        }
    }

    fn best(&self, state: usize, allowed: Allowed) -> f64 {
        let values = (0..self.actions.len()).filter(|action| allowed.contains(*action));
        values.map(|action| self.values[&(state, action)]).fold(f64::NEG_INFINITY, f64::max)
    }

    fn fit(&mut self) {
        self.since_fit = 0;
        self.sums.clear();
        let (discount, lambda) = (self.settings.memory_discount, self.settings.memory_lambda);
        let mut totals = [0.0; 3];
        let mut gain = None;
        for (back, record) in self.records.iter().rev().enumerate() {
            let step = &record.transition;
            let value = self.best(step.next_state, step.next_allowed);
            let follows = if record.cut { value } else { gain.unwrap_or(value) };
            let all = discount * ((1.0 - lambda) * value + lambda * follows);
            let now = record.reward + if record.terminal { 0.0 } else { all };
            gain = Some(now);
            // A half-life of 500 steps: these tests end before the knee.
            let weight = libm::exp2(-(back as f64) / 500.0);
            let sums = self.sums.entry((step.state, step.action)).or_default();
            sums[0] += weight * now;
            sums[1] += weight;
            for (total, more) in totals.iter_mut().zip([weight, weight * now, weight * now * now]) {
                *total += more;
            }
        }
        self.first_value = self.mean.max(0.0) - self.unit;
        let all: Vec<(usize, usize)> = self.values.keys().copied().collect();
        let decay = (1.0 - 1.0 / (1.0 + self.fits as f64 / 4.0)).min(0.99);
        for (state, action) in all {
            let value = self.valued(state, action);
            self.values.insert((state, action), value);
            let mean = self.averaged.entry((state, action)).or_default();
            *mean = (decay * mean.0 + value, decay * mean.1 + 1.0);
        }
        self.fits += 1;
        self.mean = totals[1] / totals[0];
        let square = totals[2] / totals[0];
        let variance = square - self.mean * self.mean;
        if variance > ROUNDING * square {
            self.unit = self.unit.max(variance.sqrt());
        }
    }

    fn kernel(&self, one: usize, other: usize) -> f64 {
        let (one, other) = (&self.actions[one], &self.actions[other]);
        let turn = (one.angular_rad_per_s - other.angular_rad_per_s) / 0.3;
        let speed = (one.linear_m_per_s - other.linear_m_per_s) / 0.1;
        let like = libm::exp(-(turn * turn + speed * speed) / 2.0);
        if like < 0.05 { 0.0 } else { like }
    }

    /// Sum and tries over the states that `agree`, spread over similar actions.
    fn pooled(&self, action: usize, agree: impl Fn(usize) -> bool) -> [f64; 2] {
        let mut pooled = [0.0; 2];
        for ((state, tried), [sum, tries]) in &self.sums {
            if agree(*state) {
                pooled[0] += self.kernel(*tried, action) * sum;
                pooled[1] += self.kernel(*tried, action) * tries;
            }
        }
        pooled
    }

    fn digit(&self, state: usize, at: usize) -> usize {
        let below: usize = self.digits[..at].iter().map(|digit| digit.values).product();
        state / below % self.digits[at].values
    }

    /// Sub-tuples level by level, lowest first, written out anew.
    fn levels(&self) -> Vec<Vec<Vec<usize>>> {
        let digits =
            |part: usize| -> Vec<usize> { (0..self.digits.len()).filter(|at| self.digits[*at].part == part).collect() };
        let parts: BTreeSet<usize> = self.digits.iter().map(|digit| digit.part).collect();
        let (views, single): (Vec<_>, Vec<_>) = parts.into_iter().map(digits).partition(|digits| digits.len() > 1);
        let single = single.concat();
        let mut pairs = Vec::new();
        for view in &views {
            match view[..] {
                [a, b, c] => pairs.extend([vec![a, b], vec![a, c], vec![b, c]]),
                _ => pairs.push(view.clone()),
            }
        }
        let with = |own: &Vec<usize>| [own.clone(), single.clone()].concat();
        let mut levels = vec![pairs.clone()];
        if !single.is_empty() {
            levels.push(pairs.iter().map(with).collect());
        }
        if views.len() > 1 {
            levels.push(views.iter().map(with).collect());
        }
        levels
    }

    fn valued(&self, state: usize, action: usize) -> f64 {
        let mut value = self.first_value;
        for (level, tuples) in self.levels().iter().enumerate() {
            let behind = if level == 0 { 5.0 } else { 2.0 };
            let each = tuples.iter().map(|digits| {
                let agree = |other: usize| digits.iter().all(|at| self.digit(other, *at) == self.digit(state, *at));
                let [sum, tries] = self.pooled(action, agree);
                (sum + behind * value) / (tries + behind)
            });
            value = each.sum::<f64>() / tuples.len() as f64;
        }
        let [sum, tries] = self.pooled(action, |other| other == state);
        value = (sum + 2.0 * value) / (tries + 2.0);
        let [sum, tries] = self.sums.get(&(state, action)).copied().unwrap_or_default();
        (sum + 4.0 * value) / (tries + 4.0)
    }

    pub(super) fn value(&self, state: usize, action: usize) -> f64 {
        self.values[&(state, action)]
    }

    pub(super) fn frozen(&self, state: usize, action: usize) -> f64 {
        match self.averaged.get(&(state, action)) {
            Some((sum, weight)) => sum / weight,
            None => self.values.get(&(state, action)).copied().unwrap_or_else(|| self.valued(state, action)),
        }
    }
}
