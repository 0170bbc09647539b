//! A learner as bytes, for checkpoints: what is remembered and all sums, so that it goes on bit for bit.

use super::averaged::AveragedTable;
use super::learner::MemoryLearner;
use super::past::{Follows, PastStep};
use super::returns::{LatestTable, ReturnSums};
use crate::allowed::Allowed;
use crate::saved::{Loading, Saving, Unfit};

impl MemoryLearner {
    pub(super) fn write(&self, to: &mut Saving) {
        let states: Vec<u64> = self.met.states().iter().map(|state| *state as u64).collect();
        to.wholes(&states);
        to.wholes(&self.visits);
        let ReturnSums { sums, tries, spread_sums, spread_tries, changed, totals, block, .. } = &self.sums;
        let AveragedTable { sums: averaged, weights, tables } = &self.averaged;
        for numbers in [sums, tries, spread_sums, spread_tries, &self.table.values, averaged, weights] {
            to.numbers(numbers);
        }
        changed.iter().for_each(|changed| to.whole(u64::from(*changed)));
        for number in [totals.weight, totals.sum, totals.squares, self.scale.unit, self.scale.mean, self.today] {
            to.number(number);
        }
        for whole in [*tables, *block as u64, self.age, self.since_fit] {
            to.whole(whole);
        }
        self.pools.write(to);
        to.whole(self.past.total());
        to.whole(self.past.len() as u64);
        (0..self.past.len()).rev().for_each(|back| write_step(self.past.back(back), to));
        to.random(&self.random);
    }

    pub(super) fn read(&mut self, from: &mut Loading<'_>) -> Result<(), Unfit> {
        self.begin_again();
        let rows = from.index(self.states.saturating_add(1))?;
        for _ in 0..rows {
            let state = from.index(self.states)?;
            if self.met.row(state).is_some() {
                return Err(Unfit);
            }
            self.open_row(state);
        }
        self.pair_all();
        from.wholes(&mut self.visits)?;
        let ReturnSums { sums, tries, spread_sums, spread_tries, changed, totals, block, .. } = &mut self.sums;
        let AveragedTable { sums: averaged, weights, tables } = &mut self.averaged;
        for numbers in [sums, tries, spread_sums, spread_tries, &mut self.table.values, averaged, weights] {
            from.numbers(numbers)?;
        }
        for changed in changed {
            *changed = from.index(2)? == 1;
        }
        let scale = &mut self.scale;
        let single = [
            &mut totals.weight,
            &mut totals.sum,
            &mut totals.squares,
            &mut scale.unit,
            &mut scale.mean,
            &mut self.today,
        ];
        for number in single {
            *number = from.number()?;
        }
        *tables = from.whole()?;
        *block = from.index(usize::MAX)?;
        self.age = from.whole()?;
        self.since_fit = from.whole()?;
        (0..rows).for_each(|row| self.table.settle(row));
        self.pools.read(from)?;
        let total = from.whole()?;
        let count = from.index(self.past.most() + 1)?;
        let (actions, mut steps) = (self.table.actions, Vec::with_capacity(count.min(1 << 16)));
        for _ in 0..count {
            steps.push(read_step(from, rows, actions)?);
        }
        self.past.restore(steps.into_iter(), total);
        from.random(&mut self.random)
    }

    /// Knows nothing.
    fn begin_again(&mut self) {
        let actions = self.table.actions;
        (self.met, self.visits, self.members) = Default::default();
        (self.sums, self.table) = (ReturnSums::new(actions), LatestTable::new(actions));
        (self.averaged, self.scale) = Default::default();
        self.pools = self.pools.emptied();
        self.past.clear();
        self.clear_images();
    }
}

fn write_step(step: &PastStep, to: &mut Saving) {
    for whole in [step.row, step.action, step.next_row] {
        to.whole(u64::from(whole));
    }
    to.whole(Follows::ALL.iter().position(|follows| *follows == step.follows).unwrap_or(0) as u64);
    to.whole(step.next_allowed.bits());
    for number in [step.reward, step.weight, step.gain] {
        to.number(number);
    }
}

fn read_step(from: &mut Loading<'_>, rows: usize, actions: usize) -> Result<PastStep, Unfit> {
    let (row, action, next_row) = (from.index(rows)? as u32, from.index(actions)? as u32, from.index(rows)? as u32);
    let follows = Follows::ALL[from.index(Follows::ALL.len())?];
    let next_allowed = Allowed::of_bits(from.whole()?);
    let (reward, weight, gain) = (from.number()?, from.number()?, from.number()?);
    Ok(PastStep { row, action, next_row, follows, reward, next_allowed, weight, gain })
}
