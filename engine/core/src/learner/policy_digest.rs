//! The digest of what a policy knows: its values, not the text that they were written in.

use sha2::{Digest as _, Sha256};

use super::Policy;
use crate::digest::Digest;

/// Stands before everything else, so that the digest of a policy is none of anything else.
const WHAT: &[u8] = b"policy 1\n";

/// Numbers as bytes, each list with its length before it, so that no two policies give the same bytes.
struct Hasher(Sha256);

impl Hasher {
    fn count(&mut self, count: usize) {
        self.0.update((count as u64).to_le_bytes());
    }

    fn counts(&mut self, counts: &[u64]) {
        self.count(counts.len());
        counts.iter().for_each(|count| self.0.update(count.to_le_bytes()));
    }

    fn numbers(&mut self, numbers: &[f64]) {
        self.count(numbers.len());
        numbers.iter().for_each(|number| self.0.update(number.to_bits().to_le_bytes()));
    }
}

impl Policy {
    /// SHA-256 over all that it chooses by: how many actions and states there are, each row with its visits, the temperature,
    /// what answers for states without a row, and what its eyes kept.
    #[must_use]
    pub fn digest(&self) -> Digest {
        let mut hasher = Hasher(Sha256::new_with_prefix(WHAT));
        hasher.count(self.actions());
        hasher.count(self.states());
        hasher.count(self.rows().count());
        for (state, row) in self.rows() {
            hasher.count(state);
            hasher.counts(&[row.visits]);
            hasher.numbers(&row.values);
        }
        hasher.numbers(self.temperature().as_slice());
        if let Some(sums) = self.pools().map(super::Pools::to_sums) {
            hasher.count(sums.digits.len());
            sums.digits.iter().flatten().for_each(|digit| hasher.count(*digit));
            hasher.numbers(&[sums.first_value]);
            hasher.count(sums.tuple.len());
            for tuple in &sums.tuple {
                hasher.counts(&tuple.keys);
                hasher.numbers(&tuple.sums);
                hasher.numbers(&tuple.tries);
            }
        }
        hasher.count(self.kept().len());
        hasher.0.update(self.kept());
        Digest::from(<[u8; 32]>::from(hasher.0.finalize()))
    }
}

#[cfg(test)]
mod tests {
    use crate::learner::{Policy, PolicyRow};

    #[test]
    fn whatever_a_policy_chooses_by_changes_its_digest() {
        let row = |visits, values: [f64; 2]| Some(PolicyRow { visits, values: values.to_vec() });
        let policy = || Policy::new(2, vec![row(3, [0.5, -1.0]), None, row(1, [0.0, 0.25])]);
        let others = [
            Policy::new(2, vec![row(4, [0.5, -1.0]), None, row(1, [0.0, 0.25])]),
            Policy::new(2, vec![row(3, [0.5, -1.0]), row(1, [0.0, 0.25]), None]),
            Policy::new(2, vec![row(3, [-1.0, 0.5]), None, row(1, [0.0, 0.25])]),
            Policy::new(2, vec![row(3, [0.5, -1.0]), None, row(1, [0.0, 0.25]), None]),
            policy().at_temperature(0.1),
            policy().keeping(vec![0]),
        ];
        assert_eq!(policy().digest(), policy().digest());
        let digests: std::collections::BTreeSet<_> = others.iter().chain([&policy()]).map(Policy::digest).collect();
        assert_eq!(digests.len(), 7);
    }
}
