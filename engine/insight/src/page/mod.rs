//! The page of a run: one document of data, and the HTML that shows it, with or without a server.
//!
//! [`Document`] is the contract between this program and `web/*.js`; the page reads nothing else. Lengths are metres, times
//! seconds, angles radians anticlockwise, pixels rows from the top left. Numbers by step are little-endian arrays in base64:
//!
//! | field of a [`Track`] | each step | unit |
//! |---|---|---|
//! | `x`, `y`, `movers[].x`, `movers[].y` | i16 | [`Document::unit_m`] metres, at the end of the step, before any recovery |
//! | `yaw`, `movers[].yaw` | i16 | milliradians |
//! | `state`, `next_state` | u32 | as the grid numbers them |
//! | `action` | u8 | index into `actions` |
//! | `driver` | u8 | 0 the script's own choice, else 1 and the index into `uses`; empty for a script without uses |
//! | `flags` | u8 | 1 recover, 2 contact, 4 fallen, 8 explored, 16 broken off after its longest stay |
//! | `world` | u16 | 0 is `world`, the others are `further_worlds`; absent in one world |
//! | `reward` | f32 | sum of what the rules added |
//! | `fired` | bits | rule `r` is bit `r % 8` of byte `r / 8`; `ceil(rules / 8)` bytes a step |
//! | `beam`, `nearest_beam` | u16 | beam behind the last rule that fired (65535 none); beam with the least range |
//! | `nearest` | u16 | millimetres |
//! | `measures[]` | f32 | the script's measures, in the order of `measures`; may end before the steps do |
//! | `scan` | u8 | every [`ScanShape::every`]th beam, 255 the laser's longest range; may end before the steps do |
//!
//! A track of more than [`MOST_TRACK_STEPS`] steps holds the first and the last half of as many: `spans` says which.

mod checked;
mod document;
mod ground;
mod html;
mod picture;
mod seed;
mod shot;
mod track;

pub use checked::{CheckView, FindingView};
pub(crate) use document::median_seed;
pub use document::{Document, RuleView, SettingView};
pub use ground::{Ground, MoverOutline, SolidOutline};
pub use html::{Page, page};
pub use picture::mask_png;
pub use seed::{SeedData, SeedView, StateRow};
pub use shot::{Shot, ShotMaker, StagePicture, recall_of, shot_of};
pub use track::{MOST_TRACK_STEPS, Moments, MoverTrack, ScanShape, Track};

#[cfg(test)]
mod colours;
#[cfg(test)]
mod tests;
