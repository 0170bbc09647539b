//! ACT. The narrow door between the step loop and whatever moves.
//!
//! The loop takes observations and gives twists; it cannot tell the simulator from a real robot. Truth (poses, routes)
//! does not pass through this door.

mod recovery;
mod simulated;

use crate::diagnostic::Result;
use crate::geometry::Twist;
use crate::sensors::observation::Observation;

pub use recovery::Recovery;
pub use simulated::SimulatedRobot;

/// What the step loop needs of a robot.
pub trait Robot {
    /// Fills `observation` with what the sensors measure now. The image comes in the format that it has, or in colour.
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
}
