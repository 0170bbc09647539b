//! Why an action has its value: each thing that stands behind it, with what it knows, and the very steps.

use super::learner::MemoryLearner;
use super::{FIRST_WEIGHT, POOLED_WEIGHT, SIMILAR_WEIGHT};

/// What a link of the chain knows of.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ChainLink {
    /// Nothing: what is expected where nothing is known.
    FirstValue,
    /// All states that agree in these digits, lowest first.
    Digits(Vec<usize>),
    /// Similar actions in the state.
    SimilarActions,
    /// The action in the state.
    OwnTries,
}

/// How the value of an action in a state comes about, from what is behind to what speaks first.
#[derive(Debug, Clone, PartialEq)]
pub struct ValueChain {
    /// Each link: how many tries it has, the latest counting most; the mean of their returns, if there are any; and the value
    /// by it, with what stands behind it.
    pub links: Vec<(ChainLink, f64, Option<f64>, f64)>,
    /// The value.
    pub value: f64,
    /// The remembered steps of this action in this state, the latest first.
    pub tries: Vec<PastTry>,
}

/// One remembered step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PastTry {
    /// Its number, from 0.
    pub step: u64,
    /// The return that followed it.
    pub gain: f64,
    /// How much it counts, by that of the latest step.
    pub weight: f64,
}

impl MemoryLearner {
    /// How the value of an action in a state comes about now.
    #[must_use]
    pub fn chain(&self, state: usize, action: usize) -> ValueChain {
        let (mut members, mut links) = (Vec::new(), Vec::new());
        self.pools.members(state, &mut members);
        let mean = |tries: f64, sum: f64| (tries > 0.0).then(|| sum / tries);
        let mut value = self.pools.first_value();
        links.push((ChainLink::FirstValue, 0.0, None, value));
        let levels = self.pools.levels();
        for (level, range) in levels.ranges().enumerate() {
            for at in range.clone() {
                let [tries, sum, by] = self.pools.known(level, members[at], action, value);
                links.push((ChainLink::Digits(levels.tuples[at].digits.clone()), tries, mean(tries, sum), by));
            }
            value = self.pools.level_value(level, &members[range], action, value);
        }
        let Some(row) = self.met.row(state) else { return ValueChain { links, value, tries: Vec::new() } };
        let at = row * self.table.actions + action;
        let pooled_weight = if self.pools.has_levels() { POOLED_WEIGHT } else { FIRST_WEIGHT };
        let own = [
            (ChainLink::SimilarActions, self.sums.spread_tries[at], self.sums.spread_sums[at], pooled_weight),
            (ChainLink::OwnTries, self.sums.tries[at], self.sums.sums[at], SIMILAR_WEIGHT),
        ];
        for (link, tries, sum, behind) in own {
            let (tries, sum) = (tries * self.today, sum * self.today);
            value = (sum + behind * value) / (tries + behind);
            links.push((link, tries, mean(tries, sum), value));
        }
        ValueChain { links, value, tries: self.tries(row, action) }
    }

    fn tries(&self, row: usize, action: usize) -> Vec<PastTry> {
        let own =
            self.past.iter().enumerate().filter(|(_, step)| (step.row as usize, step.action as usize) == (row, action));
        let latest = self.past.total().saturating_sub(1);
        let one = own.map(|(back, step)| PastTry {
            step: latest - back as u64,
            gain: step.gain,
            weight: step.weight * self.today,
        });
        one.collect()
    }
}
