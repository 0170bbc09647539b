//! The family `corridors`: a closed corridor of one width, with things that stand by its outer wall.

use super::obstacles::by_the_wall;
use super::outline::{beside, outline};
use super::{lap, starts, surroundings, wall};
use crate::random::Random;

/// Half of a wall's thickness, metres.
const HALF_M: f64 = 0.05;

pub(super) fn corridor(random: &mut Random) -> String {
    let around = surroundings(random);
    let middle = outline(random, [10.0, 13.0]);
    let half_m = 0.5 * random.between(1.6, 2.4);
    let things = by_the_wall(random, &beside(&middle, -half_m), 0.3);
    let walls = [-half_m - HALF_M, half_m + HALF_M].map(|left_m| wall(&beside(&middle, left_m)));
    [around, walls.concat(), things, lap(&middle), starts(&middle, 1)].concat()
}
