//! What the robot senses: the camera's image and the laser's ranges, drawn from the true world.
//!
//! Both sensors work from the flat faces of solids (`surface`). The camera finds which face is seen in which run of
//! each row (`view`, `drawing`, `spans`), lists the runs pixel by pixel (`stretches`) and
//! colours them (`texture`, `pattern`, `shadows`, `painting`, `canvas`, `tint`, `luma`). Three sensors look at the ground (`ground`). Images from elsewhere come as
//! photographs (`photograph`, with the cargo feature `photographs`).

pub mod observation;

mod camera;
mod canvas;
#[cfg(feature = "photographs")]
mod depth_photograph;
mod drawing;
mod ground;
mod laser;
mod lens;
mod luma;
mod noise;
mod painting;
mod pattern;
#[cfg(feature = "photographs")]
mod photograph;
mod rays;
mod shadows;
mod sheet;
mod spans;
mod stretches;
mod surface;
mod texture;
mod tint;
mod view;
mod watch;

#[cfg(test)]
mod tests;

pub use camera::Camera;
#[cfg(feature = "photographs")]
pub use depth_photograph::load_depth;
pub use ground::{GroundColours, GroundSensors};
pub use laser::Laser;
#[cfg(feature = "photographs")]
pub use photograph::{load_photograph, photograph_files, photograph_of};
pub use rays::CameraRays;
pub use watch::CameraWatch;
pub(crate) use watch::self_test;
