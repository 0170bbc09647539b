//! Closed ways of right angles: a rectangle with some of its corners cut out.

use crate::random::Random;

/// The shortest side that is left, metres: two corridors side by side keep a wall between them.
const LEAST_SIDE_M: f64 = 3.2;

/// A rectangle of such a size, metres, each of its corners cut out with even chances, but not all of them; anticlockwise.
pub(super) fn outline(random: &mut Random, sizes_m: [f64; 2]) -> Vec<[f64; 2]> {
    let tenth = |metres: f64| (metres * 10.0).round() / 10.0;
    let [width, height] = [0, 1].map(|_| tenth(random.between(sizes_m[0], sizes_m[1])));
    let uncut = random.below(4);
    let mut points = Vec::new();
    let corners = [[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]];
    // Anticlockwise: the direction in which each corner is reached; the next one is that in which it is left.
    let ways = [[0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]];
    for (index, [x, y]) in corners.into_iter().enumerate() {
        let (to, from) = (ways[index], ways[(index + 1) % 4]);
        let (is_cut, shares) = (random.below(2) == 1, [random.unit(), random.unit()]);
        let cut = |way: [f64; 2], share: f64| {
            let side = if way[0] == 0.0 { height } else { width };
            let most = 0.5 * (side - LEAST_SIDE_M);
            tenth(LEAST_SIDE_M + share * (most - LEAST_SIDE_M))
        };
        if !is_cut || index as u32 == uncut {
            points.push([x, y]);
            continue;
        }
        let (before, after) = (cut(to, shares[0]), cut(from, shares[1]));
        points.push([x - to[0] * before, y - to[1] * before]);
        points.push([x - to[0] * before + from[0] * after, y - to[1] * before + from[1] * after]);
        points.push([x + from[0] * after, y + from[1] * after]);
    }
    points
}

/// The way beside a closed anticlockwise one of right angles, so far to its left; to its right if that is negative.
pub(super) fn beside(closed: &[[f64; 2]], left_m: f64) -> Vec<[f64; 2]> {
    let count = closed.len();
    let normal = |from: [f64; 2], to: [f64; 2]| {
        let (x, y) = (to[0] - from[0], to[1] - from[1]);
        let length = (x * x + y * y).sqrt();
        [-y / length, x / length]
    };
    let moved = |index: usize| {
        let (last, here, next) = (closed[(index + count - 1) % count], closed[index], closed[(index + 1) % count]);
        let (before, after) = (normal(last, here), normal(here, next));
        [here[0] + left_m * (before[0] + after[0]), here[1] + left_m * (before[1] + after[1])]
    };
    (0..count).map(moved).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_moved_to_its_left_is_smaller_by_that_on_each_side() {
        let square = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];
        assert_eq!(beside(&square, 1.0), [[1.0, 1.0], [3.0, 1.0], [3.0, 3.0], [1.0, 3.0]]);
        assert_eq!(beside(&square, -0.5)[2], [4.5, 4.5]);
    }
}
