//! Boxes and cylinders that stand by a wall.

use super::sides;
use crate::random::Random;
use std::fmt::Write;

/// Nothing stands nearer to a corner, metres.
const FROM_CORNER_M: f64 = 1.6;

/// At most one thing by each side of a closed anticlockwise wall that is long enough, on its left: the wall's face is there,
/// and it stands out by at most `out_m`.
pub(super) fn by_the_wall(random: &mut Random, face: &[[f64; 2]], out_m: f64) -> String {
    let mut text = String::new();
    for (from, to) in sides(face) {
        let (x, y) = (to[0] - from[0], to[1] - from[1]);
        let length = (x * x + y * y).sqrt();
        let (stands, is_round, along) = (random.below(2) == 1, random.below(2) == 1, random.unit());
        let (depth, height) = (random.between(0.5, 1.0) * out_m, random.between(0.2, 0.9));
        if !stands || length < 2.0 * FROM_CORNER_M + 0.5 {
            continue;
        }
        let [ahead, left] = [[x / length, y / length], [-y / length, x / length]];
        let at = FROM_CORNER_M + along * (length - 2.0 * FROM_CORNER_M);
        let place = |aside: f64| [from[0] + at * ahead[0] + aside * left[0], from[1] + at * ahead[1] + aside * left[1]];
        let [x, y] = place(0.5 * depth);
        if is_round {
            let _ = write!(
                text,
                "[[cylinder]]\ncentre_m = [{x:.2}, {y:.2}]\nradius_m = {:.3}\nheight_m = {height:.2}\nmaterial = \"wall\"\n\n",
                0.5 * depth
            );
        } else {
            // Along a side of x its length lies along x.
            let (long, wide) = if ahead[0].abs() > 0.5 { (0.4, depth) } else { (depth, 0.4) };
            let _ = write!(
                text,
                "[[box]]\ncentre_m = [{x:.2}, {y:.2}]\nsize_m = [{long:.2}, {wide:.2}, {height:.2}]\nmaterial = \"wall\"\n\n"
            );
        }
    }
    text
}
