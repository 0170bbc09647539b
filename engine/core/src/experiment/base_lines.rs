//! The base lines of a test: what a robot that knows nothing, and robots that do not look, do over the same steps.

use std::sync::atomic::AtomicBool;

use super::{Choice, Chooser, Plan, TestRun, WINDOW_STEPS, test_choices};
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

/// What stands beside a test. Robots that do not look are asked only if it is a success without them.
///
/// # Errors
/// If a sensor, a filter or the script fails.
pub fn base_lines(plan: &Plan, seed: u64, tested: &TestRun, stop: &AtomicBool) -> Result<BaseLines> {
    let mut lines = BaseLines::of_untrained(test_untrained(plan, seed, stop)?);
    if plan.success().verdict(&tested.figures, &lines).is_success() {
        lines.blind = best_blind(plan, seed, tested, &lines, stop)?;
    }
    Ok(lines)
}

/// Tests a policy that knows no state, in the plan's test: every action is equally likely.
///
/// # Errors
/// As [`base_lines`].
pub fn test_untrained(plan: &Plan, seed: u64, stop: &AtomicBool) -> Result<TestFigures> {
    let mut chooser = Blind::new(vec![1; plan.motions().len()], seed);
    Ok(test_choices(plan, seed, stop, &mut chooser, &mut ())?.figures)
}

/// The first robot that meets every condition without looking; else the one that fails least.
fn best_blind(
    plan: &Plan,
    seed: u64,
    tested: &TestRun,
    lines: &BaseLines,
    stop: &AtomicBool,
) -> Result<Option<BlindFigures>> {
    let (success, mut glance) = (plan.success(), plan.clone());
    glance.settings.run.test_steps = plan.settings.run.test_steps.min(GLANCE_STEPS);
    let most = MOST_FAILURES.max(2.0 * tested.figures.failures_per_1000);
    let mut best: Option<BlindFigures> = None;
    for (does, weights) in blind_robots(&plan.motions(), &tested.chosen) {
        let test = |plan: &Plan| test_choices(plan, seed, stop, &mut Blind::new(weights.clone(), seed), &mut ());
        let mut figures = test(&glance)?.figures;
        if figures.failures_per_1000 <= most {
            figures = test(plan)?.figures;
        }
        let done = figures.steps == tested.figures.steps && success.is_met_by(&figures, &lines.untrained);
        if done || best.as_ref().is_none_or(|best| figures.failures_per_1000 < best.test.failures_per_1000) {
            best = Some(BlindFigures { does: does.to_owned(), test: figures });
        }
        if done {
            break;
        }
    }
    Ok(best)
}

/// Robots that do not look, each with how often it does each action: as often as the robot that was tested, or always one.
fn blind_robots(actions: &[Twist], chosen: &[u64]) -> Vec<(&'static str, Vec<u64>)> {
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
    let mut robots = vec![("the same actions as often, in any state", chosen.to_vec())];
    let constant = [
        ("drives straight on", least(&ahead)),
        ("spins left", least(&turning(1.0))),
        ("spins right", least(&turning(-1.0))),
    ];
    robots.extend(constant.into_iter().filter_map(|(does, action)| Some((does, always(action?)))));
    robots
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
        let robots = blind_robots(&actions, &[5, 0, 0, 0, 2]);
        let weights: Vec<_> = robots.iter().map(|(_, weights)| weights.as_slice()).collect();
        assert_eq!(weights, [&[5, 0, 0, 0, 2], &[0, 1, 0, 0, 0], &[0, 0, 0, 0, 1], &[0, 0, 0, 1, 0]]);
    }
}
