//! The narrow door between the step loop and whatever moves.
//!
//! The loop takes observations and gives twists; it cannot tell the simulator from a real robot. What a robot may know
//! beside its sensors, where it truly is, serves tests, records and pictures only: no script, state or learner sees it.

mod journey;
mod recovery;
mod simulated;
mod site;
mod starts_in_use;
mod variation;
mod work;

use crate::diagnostic::Result;
use crate::geometry::{Pose, Twist};
use crate::outcome::Destination;
use crate::saved::{Passed, Passing, Unfit};
use crate::sensors::observation::{Image, Observation};

pub use simulated::SimulatedRobot;
pub(crate) use site::seed_of_world;
pub(crate) use variation::speeds_of_movers;

/// What the step loop needs of a robot.
pub trait Robot {
    /// Fills `observation` with what the sensors measure now. The image comes in the format that it has when it is handed
    /// in, which is what the observation asks for, or in colour, which every filter chain takes. The ground is looked at
    /// only where the observation has room for its colours.
    ///
    /// # Errors
    /// If a sensor is broken: a blank or frozen camera.
    fn observe(&mut self, observation: &mut Observation) -> Result<()>;

    /// Moves with a commanded twist for one control period.
    ///
    /// # Errors
    /// If the robot cannot be commanded.
    fn act(&mut self, twist: Twist) -> Result<()>;

    /// Goes, or is put, to a safe pose at rest.
    ///
    /// # Errors
    /// If there is no safe pose.
    fn recover(&mut self) -> Result<()>;

    /// Goes, or is put, to a safe pose after an attempt about which something may be known: where the next one is to begin. A
    /// robot that cannot tell places apart goes to the usual one.
    ///
    /// # Errors
    /// As [`Robot::recover`].
    fn recover_after(&mut self, _ended: Ended) -> Result<()> {
        self.recover()
    }

    /// Where the robot is, if anything but its own sensors knows: the truth of a simulator, or a localiser in a mapped
    /// place. Without an answer, a test has no laps, paths or distances.
    fn whereabouts(&self) -> Option<Whereabouts> {
        None
    }

    /// Of a robot that goes from world to world, the number of the one where it is: 0 is the home world.
    fn world_index(&self) -> usize {
        0
    }

    /// What was drawn for the present attempt, in the order of `randomise`: numbers; of words and flags, which of them it is.
    fn drawn(&self) -> &[f64] {
        &[]
    }

    /// The greatest range of its laser, metres, if that changes from attempt to attempt.
    fn laser_max_range_m(&self) -> Option<f64> {
        None
    }

    /// The world's start at which it was put last, by its index there; nothing if it was put elsewhere.
    fn start(&self) -> Option<usize> {
        None
    }

    /// How many of the starts that its script lists are in use by now.
    fn starts_in_use(&self) -> usize {
        0
    }

    /// Where the thing with this index among those that drive by themselves is, if there is one and its place is known.
    fn mover(&self, _index: usize) -> Option<Pose> {
        None
    }

    /// Where the first of them is.
    fn prey(&self) -> Option<Pose> {
        self.mover(0)
    }

    /// Least distance between the robot's body and that of the thing with this index among those that drive by themselves,
    /// seen from above, metres; 0 where they touch. `None` where nobody knows.
    fn gap_m(&self, _mover: usize) -> Option<f64> {
        None
    }

    /// Passes all that goes on: a robot made for the same plan and seed that takes it in goes on as this one would.
    ///
    /// # Errors
    /// If it does not fit; a robot that cannot be left and taken up again always refuses.
    fn pass(&mut self, _by: &mut Passing<'_>) -> Passed {
        Err(Unfit)
    }

    /// The last observation's image in colour, for pictures, if it can be had; else the observation's own image serves.
    fn photograph(&self) -> Option<Image> {
        None
    }
}

/// What is said of an attempt when it has ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Ended {
    /// Where the next one is to begin; nothing for the usual place.
    pub to: Option<Destination>,
    /// Whether it went well: it ended in a goal or, where there are none, in a restart or after 400 steps. Nothing if it was
    /// broken off before that could be told.
    pub good: Option<bool>,
}

/// Where a robot is in its world.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Whereabouts {
    /// Place and heading on the floor plan: metres, metres, radians.
    pub pose: Pose,
    /// Height of the ground under its centre, metres.
    pub z_m: f64,
}
