//! Several learned policies as one: by priority, or by the sum of their values.
//!
//! Let Q_i(a) be the values that policy i gives the actions in the state that it perceives now.
//!
//! * **priority**: policy i cares if max_a Q_i(a) - median_a Q_i(a) >= margin. The first one that cares decides; if none
//!   does, the last one decides. Q(a) = Q_i(a) of the one that decides.
//! * **sum**: Q(a) = sum over i of (Q_i(a) - mean_a Q_i(a)) / d_i. d_i is 1 or, if scaled, the root mean square of policy
//!   i's mean-free values over all states that it met: one number for each policy, so that what does not matter to it
//!   stays small.
//!
//! The action is drawn by softmax, equation (3), from Q(a) at the lowest temperature, by priority at that of the policy that decides
//! if it has one of its own. In a state that it never met a
//! policy has no values: it does not care, and adds nothing to a sum. Without any values, all actions are equally likely.

use std::collections::BTreeMap;

use super::q_table::best_of;
use super::{Policy, Softmax, any_of};
use crate::allowed::Allowed;
use crate::random::Random;
use crate::settings::{CombineSettings, CombineWay, LearnerSettings};
use crate::stats::Sorted;

/// Two or more policies over the same actions, each with states of its own.
#[derive(Debug, Clone)]
pub(crate) struct Combined {
    /// By policy and state; none where the policy never met the state.
    members: Vec<BTreeMap<usize, MemberRow>>,
    by_priority: bool,
    softmax: Softmax,
    sum: Vec<f64>,
    votes: Vec<Option<usize>>,
}

/// What one policy has to say in one state.
#[derive(Debug, Clone)]
struct MemberRow {
    /// Its values as they count: as learned (priority), or mean-free and scaled (sum).
    values: Vec<f64>,
    best: usize,
    cares: bool,
    /// The policy's own temperature.
    temperature: Option<f64>,
}

/// What the policies decided together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Decision {
    /// The action that was drawn.
    pub action: usize,
    /// The action with the greatest combined value; `None` if no policy that counts knows its state.
    pub preferred: Option<usize>,
    /// By priority: the policy that decided.
    pub decider: Option<usize>,
}

impl Combined {
    /// Combines policies in the order of their priority.
    #[must_use]
    pub(crate) fn new(policies: &[&Policy], settings: &CombineSettings, learner: &LearnerSettings) -> Self {
        let actions = policies.first().map_or(0, |policy| policy.actions());
        let by_priority = settings.way == CombineWay::Priority;
        let members = policies.iter().map(|policy| {
            let divisor = if settings.scaled { deviation(policy) } else { 1.0 };
            let row = |values: &[f64]| {
                let (best, greatest) = best_of(values);
                let median = values.iter().copied().collect::<Sorted>().midpoint_median().unwrap_or(0.0);
                let cares = greatest - median >= settings.margin;
                let values = if by_priority { values.to_vec() } else { mean_free(values, divisor) };
                MemberRow { values, best, cares, temperature: policy.temperature() }
            };
            policy.rows().map(|(state, known)| (state, row(&known.values))).collect()
        });
        Self {
            members: members.collect(),
            by_priority,
            softmax: Softmax::new(learner, actions),
            sum: vec![0.0; actions],
            votes: vec![None; policies.len()],
        }
    }

    /// How many states each policy met.
    pub(crate) fn known_states(&self) -> impl Iterator<Item = usize> {
        self.members.iter().map(BTreeMap::len)
    }

    /// By policy: its own best action in the last states; `None` where it did not know its state.
    #[must_use]
    pub(crate) fn votes(&self) -> &[Option<usize>] {
        &self.votes
    }

    /// Decides in the states that the policies perceive, one for each policy, in their order.
    pub(crate) fn choose(&mut self, states: &[usize], allowed: Allowed, random: &mut Random) -> Decision {
        for ((vote, member), state) in self.votes.iter_mut().zip(&self.members).zip(states) {
            *vote = member.get(state).map(|row| row.best);
        }
        if self.by_priority {
            self.choose_by_priority(states, allowed, random)
        } else {
            self.choose_by_sum(states, allowed, random)
        }
    }

    fn choose_by_priority(&mut self, states: &[usize], allowed: Allowed, random: &mut Random) -> Decision {
        let rows = self.members.iter().zip(states).map(|(member, state)| member.get(state));
        let last = self.members.len().saturating_sub(1);
        let caring = rows.enumerate().find(|(index, row)| *index == last || row.is_some_and(|row| row.cares));
        let decider = caring.map(|(index, _)| index);
        match caring.and_then(|(_, row)| row) {
            Some(row) => {
                let action = match row.temperature {
                    Some(temperature) => self.softmax.choose_at(&row.values, allowed, temperature, random),
                    None => self.softmax.choose(&row.values, allowed, u64::MAX, random),
                };
                Decision { action, preferred: Some(row.best), decider }
            }
            None => Decision { action: any_of(self.sum.len(), allowed, random), preferred: None, decider },
        }
    }

    fn choose_by_sum(&mut self, states: &[usize], allowed: Allowed, random: &mut Random) -> Decision {
        self.sum.fill(0.0);
        for row in self.members.iter().zip(states).filter_map(|(member, state)| member.get(state)) {
            for (sum, value) in self.sum.iter_mut().zip(&row.values) {
                *sum += value;
            }
        }
        let preferred = self.votes.iter().any(Option::is_some).then(|| best_of(&self.sum).0);
        Decision { action: self.softmax.choose(&self.sum, allowed, u64::MAX, random), preferred, decider: None }
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

fn mean_free(values: &[f64], divisor: f64) -> Vec<f64> {
    let mean = mean(values);
    values.iter().map(|value| (value - mean) / divisor).collect()
}

/// Root mean square of the mean-free values of all known states; 1 if they are all equal.
fn deviation(policy: &Policy) -> f64 {
    let free: Vec<f64> = policy.rows().flat_map(|(_, row)| mean_free(&row.values, 1.0)).collect();
    let squares: Vec<f64> = free.iter().map(|value| value * value).collect();
    let deviation = mean(&squares).sqrt();
    if deviation > 0.0 { deviation } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learner::PolicyRow;
    use crate::random::Stream;
    use crate::settings::Settings;

    /// States 0, 1, ... with these values; a state without values was never met.
    fn policy(rows: &[&[f64]]) -> Policy {
        let row = |values: &&[f64]| (!values.is_empty()).then(|| PolicyRow { visits: 9, values: values.to_vec() });
        Policy::new(3, rows.iter().map(row).collect())
    }

    fn combined(policies: &[Policy], way: CombineWay, margin: f64, scaled: bool) -> Combined {
        let policies: Vec<&Policy> = policies.iter().collect();
        let settings = CombineSettings { way, margin, scaled };
        Combined::new(&policies, &settings, &Settings::default().learner)
    }

    fn decide(combined: &mut Combined, states: &[usize]) -> Decision {
        combined.choose(states, Allowed::ALL, &mut Random::new(1, Stream::Test))
    }

    #[test]
    fn the_first_policy_decides_only_where_it_cares() {
        // In state 0 the best lies 0.5 above the median, in state 1 only 0.04.
        let first = policy(&[&[-1.0, -0.5, -1.2], &[-0.5, -0.46, -0.6]]);
        let second = policy(&[&[0.0, -2.0, -2.0]]);
        let mut both = combined(&[first, second], CombineWay::Priority, 0.05, false);
        assert_eq!(decide(&mut both, &[0, 0]), Decision { action: 1, preferred: Some(1), decider: Some(0) });
        assert_eq!(decide(&mut both, &[1, 0]), Decision { action: 0, preferred: Some(0), decider: Some(1) });
        assert_eq!(both.votes(), [Some(1), Some(0)]);
    }

    #[test]
    fn the_policy_that_decides_chooses_at_its_own_temperature() {
        // At 100 its three values are as good as equal, at the settings' 0.009 only the best one is taken.
        let first = || policy(&[&[0.0, 0.1, 0.2]]);
        let actions = |first: Policy| {
            let mut both = combined(&[first, policy(&[&[]])], CombineWay::Priority, 0.05, false);
            let mut random = Random::new(1, Stream::Test);
            (0..100).map(|_| both.choose(&[0, 0], Allowed::ALL, &mut random).action).collect::<Vec<_>>()
        };
        assert!(actions(first()).iter().all(|action| *action == 2));
        let hot = actions(first().at_temperature(100.0));
        assert!((0..3).all(|action| hot.iter().filter(|chosen| **chosen == action).count() > 20));
    }

    #[test]
    fn a_gap_of_exactly_the_margin_is_enough() {
        let policies = [policy(&[&[0.25, 0.0, -1.0]]), policy(&[&[0.0, 0.0, 5.0]])];
        assert_eq!(decide(&mut combined(&policies, CombineWay::Priority, 0.25, false), &[0, 0]).decider, Some(0));
        assert_eq!(decide(&mut combined(&policies, CombineWay::Priority, 0.2501, false), &[0, 0]).decider, Some(1));
    }

    #[test]
    fn a_state_never_met_is_left_to_the_next_policy() {
        let policies = [policy(&[&[]]), policy(&[&[0.0, 9.0, 0.0], &[]])];
        let mut both = combined(&policies, CombineWay::Priority, 0.0, false);
        assert_eq!(decide(&mut both, &[0, 0]), Decision { action: 1, preferred: Some(1), decider: Some(1) });
        assert_eq!(both.votes(), [None, Some(1)]);
        // The last one decides whether it knows anything or not.
        let blind = decide(&mut both, &[0, 1]);
        assert_eq!((blind.preferred, blind.decider), (None, Some(1)));
    }

    #[test]
    fn a_sum_prefers_what_suits_both() {
        // Mean-free: [1, 0.5, -1.5] and [-1.5, 0.5, 1]; their sum [-0.5, 1, -0.5].
        let policies = [policy(&[&[11.0, 10.5, 8.5]]), policy(&[&[-1.5, 0.5, 1.0]])];
        let mut both = combined(&policies, CombineWay::Sum, 0.0, false);
        assert_eq!(decide(&mut both, &[0, 0]), Decision { action: 1, preferred: Some(1), decider: None });
        assert_eq!(both.sum, [-0.5, 1.0, -0.5]);
        assert_eq!(both.votes(), [Some(0), Some(2)]);
    }

    #[test]
    fn scaling_lets_a_policy_of_small_values_be_heard() {
        // The same opinions, a hundred times as loud in the first policy.
        let policies = [policy(&[&[100.0, 0.0, -100.0]]), policy(&[&[-1.0, 0.5, 0.5]])];
        assert_eq!(decide(&mut combined(&policies, CombineWay::Sum, 0.0, false), &[0, 0]).preferred, Some(0));
        let mut scaled = combined(&policies, CombineWay::Sum, 0.0, true);
        assert_eq!(decide(&mut scaled, &[0, 0]).preferred, Some(1));
        // 100 / sqrt(20000 / 3) = 1.2247 and -1 / sqrt(1.5 / 3) = -1.4142.
        assert!((scaled.sum[0] - (1.224_745 - std::f64::consts::SQRT_2)).abs() < 1e-6);
    }

    #[test]
    fn a_sum_of_nothing_prefers_nothing() {
        let policies = [policy(&[&[]]), policy(&[&[]])];
        assert_eq!(decide(&mut combined(&policies, CombineWay::Sum, 0.0, false), &[0, 0]).preferred, None);
    }
}
