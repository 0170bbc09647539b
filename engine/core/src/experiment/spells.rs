//! Spells of 20 s of a test: in which of them the robot got nowhere, and how.

use std::f64::consts::TAU;

use crate::geometry::{Pose, wrap_angle};

/// Seconds over which spinning, standing and circling are judged.
pub(super) const SPELL_S: f64 = 20.0;
/// Turning tighter than this radius on average is spinning, metres.
const SPIN_RADIUS_M: f64 = 0.3;
/// A spell with less path than this is standing, metres.
const STANDING_M: f64 = 0.2;
/// A spell within a box of this diagonal is lingering, metres: little more than a speed of 0.05 m/s covers in 20 s.
const LINGERING_M: f64 = 1.2;

/// Counts of spells of 20 s.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Spells {
    /// All whole spells.
    pub(super) all: u64,
    /// Full turn or more on a radius below 0.3 m.
    pub(super) spinning: u64,
    /// Less than 0.2 m of path and no full turn.
    pub(super) standing: u64,
    /// Full turn or more on a wider radius, ending within a quarter of the path of where it began.
    pub(super) circling: u64,
    /// None of these, but ending within a quarter of the path of where it began: to and fro.
    pub(super) returning: u64,
    /// None of these, but within a box of 1.2 m from corner to corner: wriggling on the spot.
    pub(super) lingering: u64,
    /// Net progress along the route below zero.
    pub(super) backwards: u64,
}

/// The spell that has not ended.
#[derive(Debug, Clone, Copy)]
pub(super) struct Spell {
    /// Its steps.
    pub(super) steps: u64,
    path_m: f64,
    turn_rad: f64,
    from: Pose,
    last: Pose,
    /// The box around the path, metres.
    low_m: [f64; 2],
    high_m: [f64; 2],
    net_from_m: f64,
}

impl Spell {
    /// Begins at a pose, after so much progress along the route.
    pub(super) fn new(from: Pose, net_from_m: f64) -> Self {
        let here_m = [from.x_m, from.y_m];
        Self { steps: 0, path_m: 0.0, turn_rad: 0.0, from, last: from, low_m: here_m, high_m: here_m, net_from_m }
    }

    /// One step further.
    pub(super) fn follow(&mut self, pose: Pose) {
        self.steps += 1;
        self.path_m += pose.distance_m(self.last);
        self.turn_rad += wrap_angle(pose.yaw_rad - self.last.yaw_rad);
        self.last = pose;
        for (axis, here_m) in [pose.x_m, pose.y_m].into_iter().enumerate() {
            self.low_m[axis] = self.low_m[axis].min(here_m);
            self.high_m[axis] = self.high_m[axis].max(here_m);
        }
    }

    /// Counts it, with the progress along the route at its end, if there is one.
    pub(super) fn count(&self, net_m: Option<f64>, spells: &mut Spells) {
        let Self { path_m, turn_rad, from, net_from_m, .. } = *self;
        let (turned, away_m) = (turn_rad.abs() >= TAU, self.last.distance_m(from));
        spells.all += 1;
        if turned && path_m < SPIN_RADIUS_M * turn_rad.abs() {
            spells.spinning += 1;
        } else if turned && away_m < 0.25 * path_m {
            spells.circling += 1;
        } else if path_m < STANDING_M {
            spells.standing += 1;
        } else if away_m < 0.25 * path_m {
            spells.returning += 1;
        } else if self.extent_m() < LINGERING_M {
            spells.lingering += 1;
        }
        spells.backwards += u64::from(net_m.is_some_and(|net_m| net_m < net_from_m));
    }

    /// Diagonal of the box around the path.
    fn extent_m(&self) -> f64 {
        let [width_m, height_m] = [0, 1].map(|axis| self.high_m[axis] - self.low_m[axis]);
        (width_m * width_m + height_m * height_m).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What 40 steps along these positions count as; the robot does not turn.
    fn counted(position_m: impl Fn(f64) -> (f64, f64)) -> Spells {
        let pose = |(x_m, y_m): (f64, f64)| Pose { x_m, y_m, yaw_rad: 0.0 };
        let (mut spell, mut spells) = (Spell::new(pose(position_m(0.0)), 0.0), Spells::default());
        (1..=40).for_each(|step| spell.follow(pose(position_m(f64::from(step)))));
        spell.count(None, &mut spells);
        spells
    }

    #[test]
    fn who_stays_within_a_circle_of_60_cm_lingers_and_who_leaves_it_gets_along() {
        let (along, lingers) =
            (Spells { all: 1, ..Spells::default() }, Spells { all: 1, lingering: 1, ..Spells::default() });
        // 1.0 m and 1.6 m in 20 s.
        assert_eq!(counted(|step| (0.025 * step, 0.0)), lingers);
        assert_eq!(counted(|step| (0.04 * step, 0.0)), along);
        // 0.9 m along and as much across: 1.27 m apart.
        assert_eq!(counted(|step| (0.0225 * step, 0.0225 * step)), along);
    }

    #[test]
    fn going_to_and_fro_is_returning_and_drifting_meanwhile_is_lingering() {
        // Ahead by 10 cm, back by 10 and by 4: 40 steps make 4.0 m of path to no place, or 2.8 m of path and 1.2 m less 10 cm.
        let sway = |back_m: f64| move |step: f64| ((step / 2.0).ceil() * 0.1 - (step / 2.0).floor() * back_m, 0.0);
        assert_eq!(counted(sway(0.1)), Spells { all: 1, returning: 1, ..Spells::default() });
        assert_eq!(counted(sway(0.05)), Spells { all: 1, lingering: 1, ..Spells::default() });
    }
}
