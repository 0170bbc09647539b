//! The Markov model of the states, fitted to recorded steps and solved.
//!
//! Every pair of state and action has its counts, and one imagined visit besides that does what the state does on average:
//! an action that was tried once and happened to go well is not yet believed. The best policy is found by policy
//! iteration and evaluated until nothing moves any more.

use std::collections::BTreeMap;

use super::trial::TrialStep;

/// Visits below which a state is hardly known.
const FEW_VISITS: u64 = 20;
/// A discount of 1 has no finite values.
const MOST_DISCOUNT: f64 = 0.999;
/// Rounds of improvement, and sweeps of each evaluation, at most.
const MOST_ROUNDS: usize = 100;
const MOST_SWEEPS: usize = 20_000;
const ROUGH: f64 = 1e-4;
const STILL: f64 = 1e-10;

/// How well the recorded steps cover the states.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub struct Coverage {
    /// States that the grid can have.
    pub states: usize,
    /// States that were met.
    pub states_seen: usize,
    /// Of these, those with fewer than 20 visits.
    pub states_hardly_seen: usize,
    /// Pairs of a state that was met and an action.
    pub pairs: usize,
    /// Of these, those that were never tried.
    pub pairs_untried: usize,
}

#[derive(Debug, Clone, Default)]
struct Pair {
    visits: f64,
    reward: f64,
    next: Vec<(usize, f64)>,
}

/// The model.
#[derive(Debug, Clone)]
pub struct Model {
    /// By number in the model: the state.
    states: Vec<usize>,
    /// By number, then by action.
    pairs: Vec<Vec<Pair>>,
    /// By number: all actions together, as shares.
    mean: Vec<Pair>,
}

impl Model {
    /// Fits the model to steps that had an end.
    #[must_use]
    pub fn fit(steps: &[TrialStep], actions: usize) -> Self {
        let mut numbers: BTreeMap<usize, usize> =
            steps.iter().flat_map(|step| [Some(step.state), step.next]).flatten().map(|state| (state, 0)).collect();
        for (number, slot) in numbers.values_mut().enumerate() {
            *slot = number;
        }
        let mut pairs = vec![vec![Pair::default(); actions]; numbers.len()];
        let mut mean = vec![Pair::default(); numbers.len()];
        for step in steps {
            let (Some(&from), Some(&to)) = (numbers.get(&step.state), step.next.and_then(|next| numbers.get(&next)))
            else {
                continue;
            };
            pairs[from][step.action].add(step.reward, to);
            mean[from].add(step.reward, to);
        }
        // A state that was only ever an end stays where it is.
        for (number, all) in mean.iter_mut().enumerate().filter(|(_, all)| all.visits == 0.0) {
            all.add(0.0, number);
        }
        Self { states: numbers.into_keys().collect(), pairs, mean }
    }

    /// How well the steps cover the states, out of all that there can be.
    #[must_use]
    pub fn coverage(&self, states: usize) -> Coverage {
        let visits = |actions: &Vec<Pair>| actions.iter().map(|pair| pair.visits).sum::<f64>();
        let pairs = self.pairs.iter().map(Vec::len).sum();
        Coverage {
            states,
            states_seen: self.states.len(),
            states_hardly_seen: self.pairs.iter().filter(|actions| visits(actions) < FEW_VISITS as f64).count(),
            pairs,
            pairs_untried: self.pairs.iter().flatten().filter(|pair| pair.visits == 0.0).count(),
        }
    }

    /// The best action of each state that was met, with its value.
    #[must_use]
    pub fn solve(&self, discount: f64) -> BTreeMap<usize, (usize, f64)> {
        let discount = discount.min(MOST_DISCOUNT);
        let mut policy: Vec<usize> = self.pairs.iter().map(|actions| most_visited(actions)).collect();
        let mut values = vec![0.0; self.states.len()];
        // Roughly at first: what a policy is worth to the last digit matters once it is nearly the best.
        for still in [ROUGH, STILL] {
            for _ in 0..MOST_ROUNDS {
                self.evaluate(&policy, discount, &mut values, still);
                let improve = |state: usize| self.improved(state, policy[state], discount, &values);
                let better: Vec<usize> = (0..policy.len()).map(improve).collect();
                if better == policy {
                    break;
                }
                policy = better;
            }
        }
        let best = policy.into_iter().zip(values);
        self.states.iter().copied().zip(best).collect()
    }

    /// Each state's value under a policy, until none moves by more than `still` in a sweep.
    fn evaluate(&self, policy: &[usize], discount: f64, values: &mut [f64], still: f64) {
        let rows: Vec<Pair> = policy.iter().enumerate().map(|(state, action)| self.row(state, *action)).collect();
        for _ in 0..MOST_SWEEPS {
            let mut moved = 0.0_f64;
            for (state, row) in rows.iter().enumerate() {
                let value = row.reward + discount * row.follow(values);
                moved = moved.max((value - values[state]).abs());
                values[state] = value;
            }
            if moved <= still {
                return;
            }
        }
    }

    /// A pair with its imagined visit, as expected reward and shares of what follows.
    fn row(&self, state: usize, action: usize) -> Pair {
        let (pair, all) = (&self.pairs[state][action], &self.mean[state]);
        let count = pair.visits + 1.0;
        let mut next: BTreeMap<usize, f64> = pair.next.iter().map(|(to, visits)| (*to, visits / count)).collect();
        for (to, visits) in &all.next {
            *next.entry(*to).or_default() += visits / (all.visits * count);
        }
        let reward = (pair.reward + all.reward / all.visits) / count;
        Pair { visits: 1.0, reward, next: next.into_iter().collect() }
    }

    fn value(&self, state: usize, action: usize, discount: f64, values: &[f64]) -> f64 {
        let (pair, all) = (&self.pairs[state][action], &self.mean[state]);
        let imagined = (all.reward + discount * all.follow(values)) / all.visits;
        (pair.reward + discount * pair.follow(values) + imagined) / (pair.visits + 1.0)
    }

    fn improved(&self, state: usize, present: usize, discount: f64, values: &[f64]) -> usize {
        let mut best = (present, self.value(state, present, discount, values));
        for (action, pair) in self.pairs[state].iter().enumerate().filter(|(_, pair)| pair.visits > 0.0) {
            let value = self.value(state, action, discount, values);
            let scale = 1e-9 * (1.0 + best.1.abs());
            let tie = (value - best.1).abs() <= scale && pair.visits > self.pairs[state][best.0].visits;
            if value > best.1 + scale || tie {
                best = (action, value);
            }
        }
        best.0
    }
}

impl Pair {
    fn add(&mut self, reward: f64, next: usize) {
        self.visits += 1.0;
        self.reward += reward;
        match self.next.iter_mut().find(|(known, _)| *known == next) {
            Some((_, count)) => *count += 1.0,
            None => self.next.push((next, 1.0)),
        }
    }

    fn follow(&self, values: &[f64]) -> f64 {
        self.next.iter().map(|(next, count)| count * values[*next]).sum()
    }
}

fn most_visited(actions: &[Pair]) -> usize {
    let most = actions
        .iter()
        .enumerate()
        .fold((0, 0.0), |best, (action, pair)| if pair.visits > best.1 { (action, pair.visits) } else { best });
    most.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two states: action 0 stays, action 1 changes sides; state 1 pays 1 for each step that begins there.
    fn steps() -> Vec<TrialStep> {
        let one = |state: usize, action: usize| TrialStep {
            state,
            action,
            reward: state as f64,
            recover: false,
            ending: None,
            contact: false,
            next: Some(if action == 0 { state } else { 1 - state }),
        };
        (0..4_000).map(|index| one(index / 2 % 2, index % 2)).collect()
    }

    #[test]
    fn the_best_policy_goes_where_it_is_paid_and_stays() {
        let model = Model::fit(&steps(), 2);
        let best = model.solve(0.9);
        assert_eq!((best[&0].0, best[&1].0), (1, 0));
        // 1 / (1 - 0.9) in state 1 and 0.9 of that in state 0, less what the imagined visit of 1,001 takes.
        assert!((best[&1].1 - 10.0).abs() < 0.1 && (best[&0].1 - 9.0).abs() < 0.1, "{best:?}");
    }

    #[test]
    fn coverage_counts_what_was_never_tried() {
        let only_stays: Vec<_> = steps().into_iter().filter(|step| step.action == 0).collect();
        let coverage = Model::fit(&only_stays, 2).coverage(64);
        assert_eq!((coverage.states_seen, coverage.pairs, coverage.pairs_untried), (2, 4, 2));
    }

    #[test]
    fn one_lucky_visit_is_not_believed() {
        let step = |action, reward| TrialStep {
            state: 0,
            action,
            reward,
            recover: false,
            ending: None,
            contact: false,
            next: Some(0),
        };
        let mut steps = vec![step(0, 0.9); 100];
        steps.push(step(1, 1.0));
        steps.extend(vec![step(2, -1.0); 100]);
        assert_eq!(Model::fit(&steps, 3).solve(0.9)[&0].0, 0);
    }
}
