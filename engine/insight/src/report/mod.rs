//! What a run leaves for people: pictures, tables, and files that are never half written.
//!
//! Every picture is laid out once on a list of marks and then written twice: as SVG text and as PNG bytes.

mod axes;
mod canvas;
mod certainty;
mod certified;
mod csv;
mod curve;
mod curves;
mod disagreements;
mod frame;
mod glyphs;
mod growth;
mod paths;
mod picture;
mod plan;
mod policy;
mod policy_diff;
mod raster;
mod route;
mod sheet;
mod trajectory;
mod vector;
mod worlds;

pub use certainty::certainty_grid;
pub(crate) use certified::MOST_PANELS;
pub use certified::{CertifiedData, certified};
pub use csv::{CurveRow, curve_csv};
pub use curve::{CurveData, learning_curve};
pub use curves::{CurveGroup, CurveStyle, compared_curves, has_bands};
pub use disagreements::disagreements_csv;
pub use frame::{FrameData, FramePanel, frame, snapshot_frame};
pub use growth::{GrowthGroup, growth};
pub use paths::{PathsData, paths};
pub use picture::Picture;
pub use plan::WorldPlan;
pub use policy::{PolicyData, PolicyState, policy};
pub use policy_diff::{PolicyDiffData, StateChange, policy_diff};
pub use trajectory::{TrajectoryData, trajectories};
pub use worlds::{WorldPanel, world_trajectories};

#[cfg(test)]
mod tests;
