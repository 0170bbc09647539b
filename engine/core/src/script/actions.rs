//! The actions of a script: read, and held against what the robot's drive can do.

use super::source::Code;
use crate::geometry::Twist;
use crate::judge::views::number;
use crate::settings::{MAX_ACTIONS, RobotSettings};
use rhai::Dynamic;
use std::ops::Range;

/// How actions are written.
pub(super) const FORM: &str = "actions([[0.4, 0.2], [0.4, 0.0]]); with forward speed in m/s and turning speed in rad/s";

/// What `actions(...)` lists: nothing in the place of what is no pair of numbers.
///
/// # Errors
/// If there are none or too many, in words.
pub(super) fn listed(actions: Dynamic) -> Result<Vec<Option<Twist>>, String> {
    let list = actions.into_array().unwrap_or_default();
    if list.is_empty() || list.len() > MAX_ACTIONS {
        return Err(format!("there must be 1 to {MAX_ACTIONS} actions, found {}", list.len()));
    }
    let pair = |action: Dynamic| match action.into_array().unwrap_or_default().iter().map(number).collect::<Vec<_>>()[..]
    {
        [Some(linear), Some(angular)] => Some(Twist::new(linear, angular)),
        _ => None,
    };
    Ok(list.into_iter().map(pair).collect())
}

/// The actions that the drive cannot do, each by its number with why and what to write.
pub(super) fn refused(actions: &[Twist], robot: &RobotSettings) -> Vec<(usize, String, String)> {
    let why = |(index, action): (usize, &Twist)| {
        let Twist { linear_m_per_s, angular_rad_per_s } = robot.drive.nearest(*action);
        let help = format!("the nearest that it can do is [{linear_m_per_s}, {angular_rad_per_s}]");
        Some((index, robot.drive.refuses(*action)?, help))
    };
    actions.iter().enumerate().filter_map(why).collect()
}

/// Where one action stands in the list that a call begins at; nothing if the list is not written there.
pub(super) fn place(code: &Code, call: usize, index: usize) -> Option<Range<usize>> {
    let (mut depth, mut count, mut begin) = (0, 0, None);
    for (at, letter) in code.plain[call..].char_indices() {
        match letter {
            '[' => {
                depth += 1;
                if depth == 2 {
                    begin = (count == index).then_some(call + at);
                    count += 1;
                }
            }
            ']' => {
                if let (2, Some(begin)) = (depth, begin) {
                    return Some(begin..call + at + 1);
                }
                depth -= 1;
            }
            ';' => return None,
            _ => {}
        }
    }
    None
}
