//! Guards: what an action must never do while something holds.

use super::expression::{Flag, StepFacts};
use super::facts::Facts;
use super::memory::Memory;
use super::readings::Part;
use super::rule::RuleText;
use crate::allowed::Allowed;
use crate::geometry::Twist;
use std::ops::Range;

/// A guard, ready to be asked.
#[derive(Debug)]
pub(crate) struct CompiledGuard {
    pub text: RuleText,
    /// While this holds ...
    pub condition: Flag,
    /// ... actions of which this holds are not taken; it reads the action alone.
    pub forbids: Flag,
    pub forbids_span: Range<usize>,
    /// What the condition reads.
    pub parts: Vec<Part>,
}

impl CompiledGuard {
    /// Of which actions its right side holds.
    pub(crate) fn forbidden(&self, actions: &[Twist]) -> Allowed {
        let (memory, mut facts) = (Memory::new(&[], 0, 1.0), Facts::default());
        let mut forbidden = Allowed::NONE;
        for (index, twist) in actions.iter().enumerate() {
            facts.action = index;
            facts.action_linear_m_per_s = twist.linear_m_per_s;
            facts.action_angular_rad_per_s = twist.angular_rad_per_s;
            let inputs = StepFacts { facts: &facts, previous: &facts, slots: &[], memory: &memory };
            if self.forbids.holds(inputs) {
                forbidden = forbidden.with(index);
            }
        }
        forbidden
    }
}

/// What guards leave at one moment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Leave {
    /// The actions that may be taken: at least one.
    pub allowed: Allowed,
    /// The guards that hold, a bit for each, the first one the lowest.
    pub guards: u32,
}

impl Leave {
    /// Whether a guard holds.
    pub(crate) const fn holds(self, guard: usize) -> bool {
        guard < 32 && self.guards & (1 << guard) != 0
    }
}

/// The guards of a script over a set of actions; empty if it has none.
#[derive(Debug, Clone, Default)]
pub(crate) struct Guarding {
    /// By guard: what it takes away.
    forbidden: Vec<Allowed>,
    /// The script's own actions, the slowest first: least forward speed, then least turn, either way.
    by_speed: Vec<usize>,
}

impl Guarding {
    /// Over these actions, the first `own` of which are the script's: one of those is always left.
    pub(crate) fn new(guards: &[CompiledGuard], actions: &[Twist], own: usize) -> Self {
        if guards.is_empty() {
            return Self::default();
        }
        let speed = |action: &usize| {
            let Twist { linear_m_per_s: linear, angular_rad_per_s: angular } = actions[*action];
            (linear.abs(), angular.abs())
        };
        let mut by_speed: Vec<usize> = (0..actions.len().min(own)).collect();
        by_speed.sort_by(|a, b| {
            let ((linear, angular), (other_linear, other_angular)) = (speed(a), speed(b));
            linear.total_cmp(&other_linear).then(angular.total_cmp(&other_angular))
        });
        Self { forbidden: guards.iter().map(|guard| guard.forbidden(actions)).collect(), by_speed }
    }

    /// What a guard takes away.
    pub(crate) fn forbidden(&self, guard: usize) -> Allowed {
        self.forbidden.get(guard).copied().unwrap_or(Allowed::NONE)
    }

    /// What is left of the actions in the present facts; if nothing were, the slowest action.
    pub(crate) fn leave(&self, guards: &[CompiledGuard], inputs: StepFacts<'_>) -> Leave {
        let mut leave = Leave::default();
        for (index, (guard, forbidden)) in guards.iter().zip(&self.forbidden).enumerate() {
            if guard.condition.holds(inputs) {
                leave.guards |= 1 << index;
                leave.allowed = leave.allowed.without(*forbidden);
            }
        }
        if leave.guards != 0 && !self.by_speed.iter().any(|action| leave.allowed.contains(*action)) {
            leave.allowed = self.by_speed.first().map_or(Allowed::ALL, |slowest| leave.allowed.with(*slowest));
        }
        leave
    }

    /// An action, or the slowest one that may be taken in its place.
    pub(crate) fn instead_of(&self, action: usize, allowed: Allowed) -> usize {
        if allowed.contains(action) {
            return action;
        }
        self.by_speed.iter().copied().find(|action| allowed.contains(*action)).unwrap_or(action)
    }
}
