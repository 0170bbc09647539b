//! The mean of the last tables: what is frozen.
//!
//! A learner corrects itself at once, a frozen table cannot, and single tables flip between actions that are nearly as good.

/// At most so many tables count.
const MOST_DECAY: f64 = 0.99;

/// By row: a decaying sum of its values, and of the weights.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct AveragedTable {
    pub(super) sums: Vec<f64>,
    pub(super) weights: Vec<f64>,
    pub(super) tables: u64,
}

impl AveragedTable {
    /// Room for one more row.
    pub(super) fn meet(&mut self, actions: usize) {
        self.sums.resize(self.sums.len() + actions, 0.0);
        self.weights.push(0.0);
    }

    /// Takes in one more table: a quarter of all count, 100 at most.
    pub(super) fn add(&mut self, values: &[f64]) {
        let decay = (1.0 - 1.0 / (1.0 + self.tables as f64 / 4.0)).min(MOST_DECAY);
        self.tables += 1;
        for (sum, value) in self.sums.iter_mut().zip(values) {
            *sum = decay * *sum + value;
        }
        for weight in &mut self.weights {
            *weight = decay * *weight + 1.0;
        }
    }

    /// The mean of a row's values; nothing if it was in no table yet.
    pub(super) fn row(&self, row: usize, actions: usize) -> Option<impl Iterator<Item = f64> + '_> {
        let weight = self.weights[row];
        let sums = &self.sums[row * actions..(row + 1) * actions];
        (weight > 0.0).then(|| sums.iter().map(move |sum| sum / weight))
    }

    /// Forgets all tables.
    pub(super) fn clear(&mut self) {
        self.sums.fill(0.0);
        self.weights.fill(0.0);
        self.tables = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_table_stands_alone_and_later_ones_are_mixed_by_hand_computed_weights() {
        let mut mean = AveragedTable::default();
        mean.meet(1);
        let row = |mean: &AveragedTable, row| mean.row(row, 1).and_then(|mut values| values.next());
        assert_eq!(row(&mean, 0), None);
        mean.add(&[-1.0]);
        assert_eq!(row(&mean, 0), Some(-1.0));
        // The second table decays the first by 1 - 1 / 1.25 = 0.2: (0.2 * -1 + 0) / 1.2.
        mean.add(&[0.0]);
        assert!(row(&mean, 0).is_some_and(|value| (value - -1.0 / 6.0).abs() < 1e-15));
        // A row that comes later has a mean of its own tables.
        mean.meet(1);
        mean.add(&[0.0, -3.0]);
        assert_eq!(row(&mean, 1), Some(-3.0));
    }
}
