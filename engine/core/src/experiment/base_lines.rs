//! The base lines of a test: what a robot that knows nothing, and robots that do not look, do over the same steps.

use std::sync::atomic::AtomicBool;

use super::testing::test_without_looking;
use super::{Choice, Chooser, Plan, TestRun, WINDOW_STEPS};
use crate::allowed::Allowed;
use crate::diagnostic::Result;
use crate::geometry::Twist;
use crate::learner::any_of;
use crate::random::{Random, Stream};
use crate::verdict::{BaseLines, BlindFigures, TestFigures};

/// Steps after which a robot that does not look, and fails too often, is not tested on.
const GLANCE_STEPS: u64 = 2 * WINDOW_STEPS;
/// So many failures in 1,000 steps are too many, and twice those of the test.
const MOST_FAILURES: f64 = 20.0;
/// So many other robots that know nothing: what holds of one in two holds of none of these in one case of eight.
const OTHERS: u64 = 3;

/// What stands beside a test. Robots that do not look are asked only if it is a success without them.
///
/// # Errors
/// If a sensor, a filter or the script fails.
pub fn base_lines(plan: &Plan, seed: u64, tested: &TestRun, stop: &AtomicBool) -> Result<BaseLines> {
    Ahead { untrained: test_untrained(plan, seed, stop)?, glances: Vec::new() }.beside(plan, seed, tested, stop)
}

/// The base lines that do not depend on the test, for measuring while the robot still learns.
pub(super) struct Ahead {
    untrained: TestFigures,
    /// Of each robot that always does one action, its first steps; empty if they are measured when they are asked for.
    glances: Vec<TestFigures>,
}

impl Ahead {
    /// Measures them.
    ///
    /// # Errors
    /// As [`base_lines`].
    pub(super) fn of(plan: &Plan, seed: u64, stop: &AtomicBool) -> Result<Self> {
        let untrained = test_untrained(plan, seed, stop)?;
        let (glance, asked) = (glance(plan), !plan.success().conditions().is_empty());
        let robots = constant_robots(&plan.motions()).into_iter().filter(|_| asked);
        let glances = robots.map(|(_, weights)| test_blind(&glance, weights, seed, stop)).collect::<Result<_>>()?;
        Ok(Self { untrained, glances })
    }

    /// These and the rest, once the test is done: as [`base_lines`], to the bit.
    ///
    /// # Errors
    /// As [`base_lines`].
    pub(super) fn beside(self, plan: &Plan, seed: u64, tested: &TestRun, stop: &AtomicBool) -> Result<BaseLines> {
        let mut lines = BaseLines::of_untrained(self.untrained);
        if plan.success().verdict(&tested.figures, &lines).is_success() {
            lines.blind = best_blind(plan, seed, tested, &lines.untrained, self.glances, stop)?;
            if plan.success().reads_rewards() {
                lines.untrained_others = others(plan, seed, stop)?;
            }
        }
        Ok(lines)
    }
}

/// Tests a policy that knows no state, in the plan's test: every action is equally likely.
///
/// # Errors
/// As [`base_lines`].
pub fn test_untrained(plan: &Plan, seed: u64, stop: &AtomicBool) -> Result<TestFigures> {
    test_blind(plan, vec![1; plan.motions().len()], seed, stop)
}

/// Other robots that know nothing, in the same test.
fn others(plan: &Plan, seed: u64, stop: &AtomicBool) -> Result<Vec<TestFigures>> {
    let other = |number: u64| {
        let mut robot = Blind::new(vec![1; plan.motions().len()], seed.wrapping_add(number));
        test_without_looking(plan, seed, stop, &mut robot)
    };
    (1..=OTHERS).map(other).collect()
}

/// Tests a robot that does not look.
fn test_blind(plan: &Plan, weights: Vec<u64>, seed: u64, stop: &AtomicBool) -> Result<TestFigures> {
    test_without_looking(plan, seed, stop, &mut Blind::new(weights, seed))
}

/// The plan with a test so short that a robot that does not look is not gone on with if it fails too often.
fn glance(plan: &Plan) -> Plan {
    let mut glance = plan.clone();
    glance.settings.run.test_steps = plan.settings.run.test_steps.min(GLANCE_STEPS);
    glance
}

/// The first robot that meets every condition without looking; else the one that fails least. `glances` are those of the
/// constant robots, if they were measured before.
fn best_blind(
    plan: &Plan,
    seed: u64,
    tested: &TestRun,
    untrained: &TestFigures,
    glances: Vec<TestFigures>,
    stop: &AtomicBool,
) -> Result<Option<BlindFigures>> {
    let (success, glance) = (plan.success(), glance(plan));
    let most = MOST_FAILURES.max(2.0 * tested.figures.failures_per_1000);
    let as_tested = ("the same actions as often, in any state", tested.chosen.clone());
    let robots = std::iter::once(as_tested).chain(constant_robots(&plan.motions()));
    // The first robot depends on the test.
    let glances = std::iter::once(None).chain(glances.into_iter().map(Some)).chain(std::iter::repeat(None));
    let mut best: Option<BlindFigures> = None;
    for ((does, weights), glanced) in robots.zip(glances) {
        let mut figures = match glanced {
            Some(figures) => figures,
            None => test_blind(&glance, weights.clone(), seed, stop)?,
        };
        if figures.failures_per_1000 <= most {
            figures = test_blind(plan, weights, seed, stop)?;
        }
        let done = figures.steps == tested.figures.steps && success.is_met_by(&figures, untrained);
        if done || best.as_ref().is_none_or(|best| figures.failures_per_1000 < best.test.failures_per_1000) {
            best = Some(BlindFigures { does: does.to_owned(), test: figures });
        }
        if done {
            break;
        }
    }
    Ok(best)
}

/// Robots that always do one action, each with how often it does each of them.
fn constant_robots(actions: &[Twist]) -> Vec<(&'static str, Vec<u64>)> {
    let least = |cost: &dyn Fn(&Twist) -> f64| {
        let costs = actions.iter().map(cost).enumerate().filter(|(_, cost)| cost.is_finite());
        costs.reduce(|a, b| if b.1 < a.1 { b } else { a }).map(|(index, _)| index)
    };
    let turning = |side: f64| {
        move |twist: &Twist| {
            let turn = side * twist.angular_rad_per_s;
            if turn > 0.0 { twist.linear_m_per_s.abs() / turn - 1e-6 * turn } else { f64::INFINITY }
        }
    };
    // Of those that turn least, the fastest.
    let ahead = |twist: &Twist| {
        let fast = twist.linear_m_per_s > 0.0;
        if fast { twist.angular_rad_per_s.abs() - 1e-6 * twist.linear_m_per_s } else { f64::INFINITY }
    };
    let always = |action: usize| (0..actions.len()).map(|other| u64::from(other == action)).collect();
    let constant = [
        ("drives straight on", least(&ahead)),
        ("spins left", least(&turning(1.0))),
        ("spins right", least(&turning(-1.0))),
    ];
    constant.into_iter().filter_map(|(does, action)| Some((does, always(action?)))).collect()
}

/// Chooses by weights alone.
struct Blind {
    weights: Vec<u64>,
    random: Random,
}

impl Blind {
    fn new(weights: Vec<u64>, seed: u64) -> Self {
        Self { weights, random: Random::new(seed, Stream::Untrained) }
    }
}

impl Chooser for Blind {
    fn choose(&mut self, _: &[usize], allowed: Allowed) -> Result<Choice> {
        let given = |(action, weight): (usize, &u64)| if allowed.contains(action) { *weight } else { 0 };
        let weights = || self.weights.iter().enumerate().map(given);
        let sum: u64 = weights().sum();
        if sum == 0 {
            let action = any_of(self.weights.len(), allowed, &mut self.random);
            return Ok(Choice { action, explored: true });
        }
        let mut left = u64::from(self.random.below(u32::try_from(sum).unwrap_or(u32::MAX)));
        let takes = |weight: u64| {
            let taken = left < weight;
            left = left.saturating_sub(weight);
            taken
        };
        let action = weights().position(takes).unwrap_or(0);
        Ok(Choice { action, explored: true })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_does_not_look_does_each_action_as_often_as_its_weight_says() {
        let mut blind = Blind::new(vec![1, 0, 3], 7);
        let mut counts = [0; 3];
        for _ in 0..4000 {
            counts[blind.choose(&[0], Allowed::ALL).unwrap().action] += 1;
        }
        // 1,000 and 3,000 within four times the spread of sqrt(4000 / 4 * 3 / 4) = 27.
        assert!((892..=1108).contains(&counts[0]) && counts[1] == 0, "{counts:?}");
    }

    #[test]
    fn the_constant_robots_are_the_straightest_fast_action_and_the_tightest_turns() {
        let actions = [(0.2, 0.0), (0.4, 0.0), (0.4, 0.8), (0.05, -0.8), (0.05, 0.8)];
        let actions = actions.map(|(linear, angular)| Twist::new(linear, angular));
        let robots = constant_robots(&actions);
        let weights: Vec<_> = robots.iter().map(|(_, weights)| weights.as_slice()).collect();
        assert_eq!(weights, [&[0, 1, 0, 0, 0], &[0, 0, 0, 0, 1], &[0, 0, 0, 1, 0]]);
    }
}
