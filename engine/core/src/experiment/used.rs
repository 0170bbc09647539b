//! Policies that a script uses: each with all that it was learned with, its own script too, and whether it fits this one.

use super::{Leg, Plan};
use crate::diagnostic::SourceText;
use crate::geometry::Twist;
use crate::learner::Policy;
use crate::settings::SETTINGS;
use std::sync::Arc;

/// Most actions that a script and the policies that it uses have together.
const MOST_ACTIONS: usize = 64;
/// Groups of settings that say what robot it is.
const OF_THE_ROBOT: [&str; 4] = ["robot", "camera", "laser", "ground"];
/// Of these, settings that a policy learned under can be otherwise: they are about chance, and how finely motion is worked out.
const OF_CHANCE: [&str; 6] = ["noise", "noise_m", "speed_noise", "tick_s", "depth_noise", "depth_holes"];

/// A policy that a script uses.
#[derive(Clone)]
pub struct UsedPolicy {
    /// What the script calls it.
    pub name: String,
    /// The run that learned it: its script, views, state, stages and actions.
    pub plan: Plan,
    /// What it learned.
    pub policy: Policy,
    /// The texts of its `policy.toml` and of the `run.toml` beside it.
    pub texts: [SourceText; 2],
}

impl UsedPolicy {
    /// Steps of a robot with this period that one of its own takes; nothing if they do not fit.
    pub(super) fn every(&self, period_s: f64) -> Option<u32> {
        let times = self.plan.settings.run.period_s / period_s;
        let whole = times.round();
        (whole >= 1.0 && (times - whole).abs() < 1e-6).then_some(whole as u32)
    }

    /// Whether it can drive the robot of a plan.
    ///
    /// # Errors
    /// What keeps it from that, and what to write instead.
    pub fn fits(&self, plan: &Plan) -> Result<(), [String; 2]> {
        let (own, other) = (&plan.settings, &self.plan.settings);
        if !self.plan.members.is_empty() || self.plan.behaviour.hands_over() {
            let why = "is made of other policies itself".to_owned();
            return Err([why, "name those here, each by a policy(...) of its own".to_owned()]);
        }
        if (other.robot.body, other.robot.drive) != (own.robot.body, own.robot.drive) {
            let why = "was learned on another body".to_owned();
            return Err([why, "learn it again on the body of this script: robot(...)".to_owned()]);
        }
        let robots = SETTINGS.iter().filter(|row| OF_THE_ROBOT.contains(&row.group) && !OF_CHANCE.contains(&row.key));
        let differing = robots.filter(|row| (row.get)(own) != (row.get)(other)).map(|row| {
            let (name, group, key) = (row.name(), row.group, row.key);
            let (there, here) = ((row.get)(other), (row.get)(own));
            (format!("{name} {there}, this script has {here}"), format!("{group}(#{{ {key}: {there} }})"))
        });
        let (mut differ, mut write): (Vec<String>, Vec<String>) = differing.unzip();
        if self.every(own.run.period_s).is_none() {
            let (there, here) = (other.run.period_s, own.run.period_s);
            differ.push(format!("a step of {there} s, which is no whole number of this script's steps of {here} s"));
            write.push(format!("run(#{{ period_s: {there} }})"));
        }
        if !differ.is_empty() {
            let help = format!(
                "write {}; or learn it again as this robot, with --set camera.tilt_deg=..., run.period_s=... and so on",
                write.join("; ")
            );
            return Err([format!("was learned with {}", differ.join("; ")), help]);
        }
        Ok(())
    }
}

impl Plan {
    /// The plan with the policies that its script uses.
    #[must_use]
    pub fn with_used(self, used: Vec<Arc<UsedPolicy>>) -> Self {
        // What is learned under other rules first has them too.
        let leg = |leg: Leg| Leg { plan: Self { used: used.clone(), ..leg.plan }, ..leg };
        let earlier = self.earlier.into_iter().map(leg).collect();
        Self { used, earlier, ..self }
    }

    /// All that the robot may be told to do: the script's own actions, then those of the policies that it uses that are none
    /// of them.
    #[must_use]
    pub fn motions(&self) -> Vec<Twist> {
        let mut motions = self.settings.actions.clone();
        for twist in self.used.iter().flat_map(|used| &used.plan.settings.actions) {
            if !motions.contains(twist) {
                motions.push(*twist);
            }
        }
        motions
    }

    /// How many actions there are too many.
    #[must_use]
    pub fn motions_beyond_limit(&self) -> usize {
        self.motions().len().saturating_sub(MOST_ACTIONS)
    }

    /// Where each action of a used policy stands among the motions.
    pub(super) fn motions_of(&self, used: &UsedPolicy) -> Vec<usize> {
        let motions = self.motions();
        let place = |twist: &Twist| motions.iter().position(|motion| motion == twist);
        used.plan.settings.actions.iter().filter_map(place).collect()
    }
}
