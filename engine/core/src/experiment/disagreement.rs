//! Where policies that are combined disagree: pairs of states in which their best actions differ.

use serde::{Deserialize, Serialize};

use super::Plan;
use crate::learner::{Combined, Decision};
use crate::settings::CombineWay;

/// Most pairs of states for which memory is taken at the start.
const RESERVED: usize = 1 << 16;
/// The most frequent disagreements that stand in the summary.
const LISTED: usize = 10;

/// Two policies, the states that they perceived at the same time, and the two actions that they wanted.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Disagreement {
    /// The two policies, by their place in the script.
    pub policies: [usize; 2],
    /// The state that each of them perceived.
    pub states: [usize; 2],
    /// The best action of each of them there.
    pub actions: [usize; 2],
    /// In how many steps.
    pub steps: u64,
    /// In how many of these the combination preferred the first one's action, and the second one's.
    pub won: [u64; 2],
}

/// Counts votes over a test.
#[derive(Debug, Clone)]
pub struct Disagreements {
    /// In the order of policies and states, so that a pair is found by bisection.
    rows: Vec<Disagreement>,
    steps: u64,
    disagreeing: u64,
    decided: Vec<u64>,
}

impl Disagreements {
    /// Counts nothing yet; memory is taken for the states that the policies know, as far as that is reasonable.
    #[must_use]
    pub(super) fn new(combined: &Combined, steps: u64) -> Self {
        let known: Vec<usize> = combined.known_states().collect();
        let pairs = known.iter().enumerate().flat_map(|(index, a)| known[index + 1..].iter().map(move |b| a * b));
        let visited = usize::try_from(steps).unwrap_or(usize::MAX).saturating_mul(known.len() * known.len());
        let rows = Vec::with_capacity(pairs.sum::<usize>().min(visited).min(RESERVED));
        Self { rows, steps: 0, disagreeing: 0, decided: vec![0; known.len()] }
    }

    /// Counts one decision: what each policy perceived, what each wanted, and what was decided.
    pub(super) fn count(&mut self, states: &[usize], votes: &[Option<usize>], decision: &Decision) {
        self.steps += 1;
        if let Some(decider) = decision.decider {
            self.decided[decider] += 1;
        }
        let mut disagree = false;
        for (first, vote) in votes.iter().enumerate() {
            for (second, other) in votes.iter().enumerate().skip(first + 1) {
                if let (Some(vote), Some(other)) = (*vote, *other)
                    && vote != other
                {
                    disagree = true;
                    let row = self.row([first, second], [states[first], states[second]], [vote, other]);
                    row.steps += 1;
                    row.won[0] += u64::from(decision.preferred == Some(vote));
                    row.won[1] += u64::from(decision.preferred == Some(other));
                }
            }
        }
        self.disagreeing += u64::from(disagree);
    }

    fn row(&mut self, policies: [usize; 2], states: [usize; 2], actions: [usize; 2]) -> &mut Disagreement {
        let found = self.rows.binary_search_by_key(&(policies, states), |row| (row.policies, row.states));
        let index = found.unwrap_or_else(|index| {
            self.rows.insert(index, Disagreement { policies, states, actions, steps: 0, won: [0; 2] });
            index
        });
        &mut self.rows[index]
    }

    /// All of them, the most frequent first.
    #[must_use]
    pub fn by_frequency(&self) -> Vec<Disagreement> {
        let mut rows = self.rows.clone();
        rows.sort_by_key(|row| (std::cmp::Reverse(row.steps), row.policies, row.states));
        rows
    }
}

/// A combination, as `summary.json` tells it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CombinationFigures {
    /// `priority` or `sum`.
    pub way: String,
    /// The policies in their order.
    pub policies: Vec<MemberFigures>,
    /// Share of the steps in which at least two policies that knew their state had different best actions.
    pub disagree: f64,
    /// How many pairs of states these steps were in.
    pub disagreements: usize,
    /// The ten most frequent of these; `disagreements.csv` has all.
    pub most_frequent: Vec<DisagreementFigures>,
}

/// One policy of a combination.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MemberFigures {
    /// What the script calls it.
    pub name: String,
    /// The behaviour that it learned.
    pub behaviour: String,
    /// Share of the steps that it decided; null for a sum.
    pub decided: Option<f64>,
}

/// One pair of states in which two policies disagree.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DisagreementFigures {
    /// The names of the two policies.
    pub policies: [String; 2],
    /// The state that each of them perceived.
    pub states: [usize; 2],
    /// The number of the best action of each of them.
    pub actions: [usize; 2],
    /// These actions as forward speed in m/s and turning speed in rad/s.
    pub motions: [[f64; 2]; 2],
    /// In how many steps.
    pub steps: u64,
    /// In how many of these the combination preferred the first one's action, and the second one's.
    pub won: [u64; 2],
}

impl CombinationFigures {
    pub(super) fn new(plan: &Plan, counted: &Disagreements) -> Self {
        let (members, steps) = (&plan.members, counted.steps.max(1) as f64);
        let by_sum = plan.settings.combine.way == CombineWay::Sum;
        let policies = members.iter().zip(&counted.decided).map(|(member, decided)| MemberFigures {
            name: member.name.clone(),
            behaviour: member.behaviour.clone(),
            decided: (!by_sum).then(|| *decided as f64 / steps),
        });
        let motion = |action: usize| {
            let twist = plan.settings.actions[action];
            [twist.linear_m_per_s, twist.angular_rad_per_s]
        };
        let listed = counted.by_frequency().into_iter().take(LISTED).map(|row| DisagreementFigures {
            policies: row.policies.map(|policy| members[policy].name.clone()),
            states: row.states,
            actions: row.actions,
            motions: row.actions.map(motion),
            steps: row.steps,
            won: row.won,
        });
        Self {
            way: plan.settings.combine.way.word().to_owned(),
            policies: policies.collect(),
            disagree: counted.disagreeing as f64 / steps,
            disagreements: counted.rows.len(),
            most_frequent: listed.collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counted(votes: &[[Option<usize>; 2]], preferred: usize) -> Disagreements {
        let mut counted = Disagreements { rows: Vec::new(), steps: 0, disagreeing: 0, decided: vec![0; 2] };
        for votes in votes {
            let decision = Decision { action: 0, preferred: Some(preferred), decider: Some(1) };
            counted.count(&[4, 7], votes, &decision);
        }
        counted
    }

    #[test]
    fn only_different_wishes_of_policies_that_know_their_state_disagree() {
        let votes = [[Some(1), Some(1)], [None, Some(2)], [Some(1), Some(2)], [Some(1), Some(2)]];
        let counted = counted(&votes, 2);
        assert_eq!((counted.steps, counted.disagreeing, counted.decided.as_slice()), (4, 2, &[0, 4][..]));
        let row = Disagreement { policies: [0, 1], states: [4, 7], actions: [1, 2], steps: 2, won: [0, 2] };
        assert_eq!(counted.rows, [row]);
    }

    #[test]
    fn a_third_action_lets_neither_win() {
        assert_eq!(counted(&[[Some(1), Some(2)]], 5).rows[0].won, [0, 0]);
    }

    #[test]
    fn three_policies_disagree_in_pairs() {
        let mut counted = Disagreements { rows: Vec::new(), steps: 0, disagreeing: 0, decided: vec![0; 3] };
        let decision = Decision { action: 2, preferred: Some(2), decider: Some(1) };
        counted.count(&[0, 1, 2], &[Some(1), Some(2), Some(2)], &decision);
        let pairs: Vec<_> = counted.rows.iter().map(|row| (row.policies, row.won)).collect();
        assert_eq!(pairs, [([0, 1], [0, 1]), ([0, 2], [0, 1])]);
        assert_eq!(counted.disagreeing, 1);
    }
}
