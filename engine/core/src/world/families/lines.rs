//! The family `lines`: a yellow line on an open floor, bent this way and that, closed.

use super::{lap, points, starts, surroundings};
use crate::random::Random;
use std::f64::consts::TAU;

/// Points of the line.
const POINTS: u32 = 24;

pub(super) fn line(random: &mut Random) -> String {
    let around = surroundings(random);
    let radius_m = random.between(4.5, 6.5);
    // Two and three waves on the way round.
    let waves = [(2.0, 0.22), (3.0, 0.12)]
        .map(|(count, most)| (count, random.between(0.3, 1.0) * most, random.between(0.0, TAU)));
    let point = |index: u32| {
        let angle = TAU * f64::from(index) / f64::from(POINTS);
        let share: f64 = waves.iter().map(|(count, height, from)| height * libm::cos(count * angle + from)).sum();
        let out_m = radius_m * (1.0 + share);
        [out_m * libm::cos(angle), out_m * libm::sin(angle)]
    };
    let way: Vec<[f64; 2]> = (0..POINTS).map(point).collect();
    let yellow = "[[material]]\nname = \"yellow\"\ncolour = [230, 200, 30]\n\n".to_owned();
    let paint =
        format!("[[paint]]\npoints_m = {}\nclosed = true\nwidth_m = 0.1\nmaterial = \"yellow\"\n\n", points(&way));
    [around, yellow, paint, lap(&way), starts(&way, 6)].concat()
}
