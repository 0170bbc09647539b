//! The family `rooms`: one wall around, inner and outer corners, things that stand by the wall.

use super::obstacles::by_the_wall;
use super::outline::{beside, outline};
use super::{lap, starts, surroundings, wall};
use crate::random::Random;

/// The lap is so far off the wall, metres.
const OFF_M: f64 = 0.6;
/// Half of a wall's thickness, metres.
const HALF_M: f64 = 0.05;

pub(super) fn room(random: &mut Random) -> String {
    let around = surroundings(random);
    let faces = outline(random, [10.0, 13.0]);
    let things = by_the_wall(random, &faces, 0.2);
    let way = beside(&faces, OFF_M);
    [around, wall(&beside(&faces, -HALF_M)), things, lap(&way), starts(&way, 1)].concat()
}
