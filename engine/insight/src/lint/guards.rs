//! Guards that never held, neither while the robot drove at random nor by what it had learned so far.

use std::sync::atomic::AtomicBool;

use super::fired::{may_be_rare, readings};
use super::trial::{RANDOM_STEPS, RuleTrial, SEED};
use super::{Finding, LintTrial};
use engine::allowed::Allowed;
use engine::diagnostic::{Result, printable};
use engine::experiment::{Choice, Chooser, Cycle, Each, Plan, Step, test_choices};
use engine::learner::Policy;
use engine::random::{Random, Stream};

pub(super) fn check_guards(
    plan: &Plan,
    trial: &LintTrial,
    stop: &AtomicBool,
    findings: &mut Vec<Finding>,
) -> Result<()> {
    let names: Vec<&str> = plan.behaviour.guards().map(|guard| guard.name.as_str()).collect();
    if names.is_empty() {
        return Ok(());
    }
    let mut plan = plan.clone();
    plan.settings.run.test_steps = RANDOM_STEPS;
    let mut guards = vec![Guard::default(); names.len()];
    for learned in [None, trial.learned.as_ref()] {
        let mut driver =
            Driver { learned, actions: plan.settings.actions.len(), random: Random::new(SEED, Stream::Test) };
        let mut watch = Each(|cycle: &Cycle<_>, _: &Step| {
            for (index, guard) in guards.iter_mut().enumerate() {
                let parts = cycle.judge().guard_evidence(index);
                guard.seen.looked += 1;
                guard.seen.held += u64::from(cycle.guard_holds(index));
                for part in parts {
                    guard.end = guard.end.max(part.span.end);
                    guard.start = guard.start.min(part.span.start);
                    part.facts.into_iter().for_each(|fact| guard.seen.read(fact.into()));
                }
            }
        });
        test_choices(&plan, SEED, stop, &mut driver, &mut watch)?;
    }
    for (name, Guard { seen, start, end }) in names.into_iter().zip(&guards) {
        if seen.held > 0 || *start >= *end || may_be_rare(&seen.facts) {
            continue;
        }
        let message = format!("guard \"{}\" never held in {} steps", printable(name), seen.looked);
        let help = "check the threshold and that the world has what the guard is about";
        findings.push(Finding::warning(&plan, "W-GUARD-NEVER", *start..*end, message).say(readings(&seen.facts), help));
    }
    Ok(())
}

/// What one guard was in the steps, and where its condition stands.
#[derive(Debug, Clone)]
struct Guard {
    seen: RuleTrial,
    start: usize,
    end: usize,
}

impl Default for Guard {
    fn default() -> Self {
        Self { seen: RuleTrial::default(), start: usize::MAX, end: 0 }
    }
}

/// Chooses by what was learned; in a state that it does not know, or without it, at random.
struct Driver<'a> {
    learned: Option<&'a Policy>,
    /// How many there are.
    actions: usize,
    random: Random,
}

impl Chooser for Driver<'_> {
    fn choose(&mut self, states: &[usize], allowed: Allowed) -> Result<Choice> {
        let known = self.learned.zip(states.first()).and_then(|(policy, state)| policy.best(*state));
        let action = match known {
            Some((action, _)) if allowed.contains(action) => action,
            _ => {
                let may = || (0..self.actions).filter(|action| allowed.contains(*action));
                may().nth(self.random.below(may().count().max(1) as u32) as usize).unwrap_or(0)
            }
        };
        Ok(Choice { action, explored: known.is_none() })
    }
}
