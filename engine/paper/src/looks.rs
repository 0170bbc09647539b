//! What a trial looks at besides the figures of every test: bends, crossings, and what follows on each state.

use std::f64::consts::FRAC_PI_3;
use std::ops::ControlFlow;

use engine::experiment::{Cycle, Observer, Step};
use engine::geometry::{Pose, wrap_angle};
use engine::robot::Robot;

/// Bends are measured between pieces of this length, metres.
const PIECE_M: f64 = 0.5;
/// A way is open if the laser sees this far along it, metres; the corridor is 2 m wide.
const OPEN_M: f32 = 2.5;
/// A crossing lies behind the robot after this much path, metres.
const CROSSING_M: f64 = 3.0;
/// A state is often met from so many visits with its commonest action.
const OFTEN: usize = 20;
/// Ranges beyond this are alike when two situations are compared, metres.
const FAR_M: f32 = 4.0;

/// What a trial looks at, from the truth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Look {
    /// The figures of every test, nothing else.
    Figures,
    /// How much robot and prey turn on their way.
    Bends,
    /// Which way it goes at crossings.
    Crossings,
    /// What follows on each state.
    States,
}

/// What was seen; not a number where there was nothing to see.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// Mean turning per metre of path, robot over prey.
    pub turning_share: f64,
    /// Sharpest twentieth of the bends, robot over prey.
    pub sharpest_share: f64,
    /// Crossings left to the left, straight on and to the right.
    pub choices: [u64; 3],
    /// Share of often-met states that are aliased.
    pub aliased: f64,
    /// The most aliased state with two visits of it.
    pub twins: Option<Twins>,
}

/// Two visits of one state, with the same action, that went on differently.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Twins {
    /// The state.
    pub state: usize,
    /// The action.
    pub action: usize,
    /// How often the commonest next state followed, 0 to 1.
    pub agreement: f64,
    /// The steps at the end of which the two frames were taken.
    pub frames: [u64; 2],
    /// The states that followed.
    pub next: [usize; 2],
}

impl Seen {
    /// Share of the commonest choice at crossings.
    #[must_use]
    pub fn commonest_choice(&self) -> f64 {
        share_of_greatest(&self.choices)
    }

    /// Share of the commoner side among the turns.
    #[must_use]
    pub fn commoner_side(&self) -> f64 {
        share_of_greatest(&[self.choices[0], self.choices[2]])
    }
}

fn share_of_greatest(counts: &[u64]) -> f64 {
    let all: u64 = counts.iter().sum();
    if all == 0 { f64::NAN } else { counts.iter().copied().max().unwrap_or(0) as f64 / all as f64 }
}

/// Follows one test.
pub(super) struct Watcher {
    look: Look,
    robot: Bends,
    prey: Bends,
    crossing: Option<(f64, f64)>,
    last: Option<Pose>,
    choices: [u64; 3],
    visits: Vec<Visit>,
    before: Option<(u64, [f32; 3])>,
}

#[derive(Debug, Clone, Copy)]
struct Visit {
    state: usize,
    action: usize,
    next: usize,
    frame: u64,
    ranges: [f32; 3],
}

impl<R: Robot> Observer<R> for Watcher {
    fn stepped(&mut self, cycle: &Cycle<R>, step: &Step) -> ControlFlow<()> {
        self.watch(cycle, step);
        ControlFlow::Continue(())
    }
}

impl Watcher {
    pub(super) fn new(look: Look) -> Self {
        let (robot, prey) = (Bends::default(), Bends::default());
        Self { look, robot, prey, crossing: None, last: None, choices: [0; 3], visits: Vec::new(), before: None }
    }

    fn watch<R: Robot>(&mut self, cycle: &Cycle<R>, step: &Step) {
        let pose = cycle.robot().whereabouts().unwrap_or_default().pose;
        let scan = &cycle.observation().scan.ranges_m;
        let ranges = [scan[0], scan[scan.len() / 2], scan[scan.len() - 1]];
        match self.look {
            Look::Figures => {}
            Look::Bends => {
                self.robot.follow(pose);
                if let Some(prey) = cycle.robot().prey() {
                    self.prey.follow(prey);
                }
                if step.then.is_some() {
                    self.robot.jump();
                }
            }
            Look::Crossings => self.cross(pose, ranges, step.then.is_some()),
            Look::States => {
                if let Some((frame, ranges)) = self.before {
                    let Step { state, action, next_state: next, .. } = *step;
                    self.visits.push(Visit { state, action, next, frame, ranges });
                }
                self.before = step.then.is_none().then_some((step.index, ranges));
            }
        }
    }

    /// At a crossing at least two of right, ahead and left are open; what it chose shows when the crossing lies behind.
    fn cross(&mut self, pose: Pose, ranges: [f32; 3], failed: bool) {
        let moved = self.last.map_or(0.0, |last| pose.distance_m(last));
        let turned = self.last.map_or(0.0, |last| wrap_angle(pose.yaw_rad - last.yaw_rad));
        self.last = (!failed).then_some(pose);
        if failed {
            self.crossing = None;
            return;
        }
        if let Some((path_m, turn_rad)) = &mut self.crossing {
            *path_m += moved;
            *turn_rad += turned;
            if *path_m >= CROSSING_M {
                let choice = if *turn_rad > FRAC_PI_3 {
                    0
                } else if *turn_rad < -FRAC_PI_3 {
                    2
                } else {
                    1
                };
                self.choices[choice] += 1;
                self.crossing = None;
            }
        } else if ranges.iter().filter(|range| **range > OPEN_M).count() >= 2 {
            self.crossing = Some((0.0, 0.0));
        }
    }

    pub(super) fn finish(mut self) -> Seen {
        let (aliased, twins) = aliases(&self.visits);
        Seen {
            turning_share: self.robot.mean_rad_per_m() / self.prey.mean_rad_per_m(),
            sharpest_share: self.robot.sharpest_rad() / self.prey.sharpest_rad(),
            choices: self.choices,
            aliased,
            twins,
        }
    }
}

/// Changes of direction along a path, piece by piece.
#[derive(Default)]
struct Bends {
    from: Option<[f64; 2]>,
    direction_rad: Option<f64>,
    bends_rad: Vec<f64>,
}

impl Bends {
    fn follow(&mut self, pose: Pose) {
        let [x, y] = *self.from.get_or_insert([pose.x_m, pose.y_m]);
        let (dx, dy) = (pose.x_m - x, pose.y_m - y);
        if dx * dx + dy * dy < PIECE_M * PIECE_M {
            return;
        }
        let direction_rad = libm::atan2(dy, dx);
        if let Some(before_rad) = self.direction_rad {
            self.bends_rad.push(wrap_angle(direction_rad - before_rad).abs());
        }
        (self.direction_rad, self.from) = (Some(direction_rad), Some([pose.x_m, pose.y_m]));
    }

    fn jump(&mut self) {
        (self.from, self.direction_rad) = (None, None);
    }

    fn mean_rad_per_m(&self) -> f64 {
        self.bends_rad.iter().sum::<f64>() / (self.bends_rad.len() as f64 * PIECE_M)
    }

    fn sharpest_rad(&mut self) -> f64 {
        self.bends_rad.sort_by(f64::total_cmp);
        self.bends_rad.get(self.bends_rad.len() * 19 / 20).copied().unwrap_or(f64::NAN)
    }
}

/// The share of often-met states that are aliased, and the most aliased of them with its two most different visits.
fn aliases(visits: &[Visit]) -> (f64, Option<Twins>) {
    let mut sorted = visits.to_vec();
    sorted.sort_by_key(|visit| (visit.state, visit.action, visit.next, visit.frame));
    let (mut often, mut aliased, mut worst) = (0_u64, 0_u64, None::<(f64, &[Visit])>);
    for state in sorted.chunk_by(|a, b| a.state == b.state) {
        let Some(common) = state.chunk_by(|a, b| a.action == b.action).max_by_key(|visits| visits.len()) else {
            continue;
        };
        if common.len() < OFTEN {
            continue;
        }
        let follows = common.chunk_by(|a, b| a.next == b.next).map(<[Visit]>::len).max().unwrap_or(0);
        let agreement = follows as f64 / common.len() as f64;
        often += 1;
        aliased += u64::from(agreement < 0.5);
        if worst.is_none_or(|(least, _)| agreement < least) {
            worst = Some((agreement, common));
        }
    }
    let twins = worst.and_then(|(agreement, visits)| twins(agreement, visits));
    (if often == 0 { f64::NAN } else { aliased as f64 / often as f64 }, twins)
}

fn twins(agreement: f64, visits: &[Visit]) -> Option<Twins> {
    let apart = |a: &Visit, b: &Visit| -> f32 {
        a.ranges.iter().zip(&b.ranges).map(|(a, b)| (a.min(FAR_M) - b.min(FAR_M)).abs()).sum()
    };
    let mut best: Option<(f32, &Visit, &Visit)> = None;
    for (index, a) in visits.iter().enumerate() {
        for b in &visits[index + 1..] {
            let apart = apart(a, b);
            if a.next != b.next && best.is_none_or(|(most, ..)| apart > most) {
                best = Some((apart, a, b));
            }
        }
    }
    let (_, a, b) = best?;
    Some(Twins { state: a.state, action: a.action, agreement, frames: [a.frame, b.frame], next: [a.next, b.next] })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_corner_is_one_bend_of_a_quarter_turn() {
        let mut bends = Bends::default();
        for step in 0..=20 {
            bends.follow(Pose::new(f64::from(step) * 0.1, 0.0, 0.0));
        }
        for step in 1..=20 {
            bends.follow(Pose::new(2.0, f64::from(step) * 0.1, 0.0));
        }
        // Eight pieces of half a metre, seven places where they meet.
        let quarter = std::f64::consts::FRAC_PI_2;
        assert!((bends.bends_rad.iter().sum::<f64>() - quarter).abs() < 1e-9, "{:?}", bends.bends_rad);
        assert!((bends.sharpest_rad() - quarter).abs() < 0.3);
    }

    #[test]
    fn a_state_is_aliased_if_nothing_follows_in_half_of_the_cases() {
        let visit = |state, next, frame| Visit { state, action: 1, next, frame, ranges: [next as f32, 1.0, 1.0] };
        let visits: Vec<_> = (0..30_u64)
            .flat_map(|frame| [visit(5, (frame % 3) as usize, frame), visit(9, usize::from(frame % 4 == 0), frame)])
            .collect();
        let (aliased, twins) = aliases(&visits);
        assert_eq!(aliased, 0.5);
        let twins = twins.unwrap();
        assert_eq!((twins.state, twins.next), (5, [0, 2]));
    }

    #[test]
    fn shares_of_choices_are_taken_of_all_crossings() {
        let seen = Seen {
            turning_share: f64::NAN,
            sharpest_share: f64::NAN,
            choices: [6, 2, 2],
            aliased: f64::NAN,
            twins: None,
        };
        assert_eq!((seen.commonest_choice(), seen.commoner_side()), (0.6, 0.75));
    }
}
