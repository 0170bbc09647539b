//! Set-up calls whose argument is a list: actions and stages.

use super::setup::SetupReader;
use crate::diagnostic::{Result, printable};
use crate::geometry::Twist;
use crate::judge::views::number;
use rhai::Dynamic;

/// Most actions.
const MAX_ACTIONS: usize = 64;
/// Most stages.
const MAX_STAGES: usize = 16;
/// Fastest forward motion of an action, m/s.
const MAX_LINEAR: f64 = 2.0;
/// Fastest turn of an action, rad/s.
const MAX_ANGULAR: f64 = 6.0;

impl SetupReader<'_> {
    pub(super) fn actions(&self, actions: Dynamic) -> Result<Vec<Twist>> {
        let form = "actions([[0.4, 0.2], [0.4, 0.0]]); with forward speed in m/s and turning speed in rad/s";
        let list = actions.into_array().unwrap_or_default();
        if list.is_empty() || list.len() > MAX_ACTIONS {
            let message = format!("there must be 1 to {MAX_ACTIONS} actions, found {}", list.len());
            return self.wrong(self.call, message, "set here", form);
        }
        let mut twists = Vec::new();
        for (index, action) in list.into_iter().enumerate() {
            let pair = action.into_array().unwrap_or_default();
            let [Some(linear), Some(angular)] = pair.iter().map(number).collect::<Vec<_>>()[..] else {
                return self.wrong(self.call, format!("action {index} is not a pair of numbers"), "set here", form);
            };
            let within = |value: f64, most: f64| (-most..=most).contains(&value);
            if !within(linear, MAX_LINEAR) || !within(angular, MAX_ANGULAR) {
                let message = format!(
                    "action {index} is [{linear}, {angular}]: at most {MAX_LINEAR} m/s and {MAX_ANGULAR} rad/s, either way"
                );
                return self.wrong(self.call, message, "set here", form);
            }
            twists.push(Twist::new(linear, angular));
        }
        Ok(twists)
    }

    pub(super) fn stages(&self, stages: Dynamic) -> Result<Vec<String>> {
        let form = "stages([\"search\", \"approach\"]);";
        let list = stages.into_array().unwrap_or_default();
        if !(2..=MAX_STAGES).contains(&list.len()) {
            let message = format!("there must be 2 to {MAX_STAGES} stages, found {}", list.len());
            return self.wrong(self.call, message, "set here", form);
        }
        let mut names: Vec<String> = Vec::new();
        for stage in list {
            let name = self.word(stage, form)?;
            if names.contains(&name) {
                return self.wrong(
                    self.call,
                    format!("there are two stages \"{}\"", printable(&name)),
                    "set here",
                    form,
                );
            }
            names.push(name);
        }
        Ok(names)
    }
}
