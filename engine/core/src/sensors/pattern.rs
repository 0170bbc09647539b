//! Textures: which of a surface's colours a place on it has.

use crate::world::scene::{Texture, Tiling};
use std::sync::LazyLock;

/// Pixels that are textured at once.
pub(super) const BATCH: usize = 32;
/// Lattice points of noise and tiles along each axis; then they repeat.
const LATTICE: usize = 128;

/// How the places of a surface choose among its colours; `per_m` is one over the texture's length.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Pattern {
    choice: TextureChoice,
    per_m: f32,
}

/// Grey levels that a texture's colours add to the plain one.
#[derive(Debug, Clone, Copy)]
pub(super) struct GreySteps {
    /// Of its first colour and of its last.
    pub(super) ends: [f64; 2],
    /// Whether there is none between them; else there is one for each whole level.
    pub(super) two: bool,
}

/// How the places of a surface choose among its colours.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
enum TextureChoice {
    #[default]
    Plain,
    Checker,
    Stripes,
    /// The amplitude, which is the middle colour's index.
    Noise(f32),
    Tiles(TileChoice),
}

/// How places choose among the colours of tiles.
#[derive(Debug, Clone, Copy, PartialEq)]
struct TileChoice {
    amplitude: f32,
    /// The index of the colour itself, and that of a joint.
    middle: f32,
    joint: u8,
    /// Width of a joint as a share of a tile's length.
    joint_share: f32,
    bricks: bool,
}

/// Adding 1.5 * 2^23 rounds a small number to a whole one, which then stands in the low bits.
const TO_WHOLE: f32 = 12_582_912.0;

/// The whole number below `value`, as bits and as a number. Only its low bits mean something far from the origin.
#[inline(always)]
fn floor(value: f32) -> (u32, f32) {
    let shifted = (value - 0.5) + TO_WHOLE;
    (shifted.to_bits(), shifted - TO_WHOLE)
}

impl Pattern {
    /// The pattern of a texture, and the grey levels that its colours add; nothing for one colour.
    pub(super) fn of(texture: &Texture) -> Option<(Self, GreySteps)> {
        let (choice, scale_m, ends) = match *texture {
            Texture::Plain => return None,
            Texture::Checker { amplitude, scale_m } => (TextureChoice::Checker, scale_m, [amplitude, -amplitude]),
            Texture::Stripes { amplitude, scale_m } => (TextureChoice::Stripes, scale_m, [amplitude, -amplitude]),
            Texture::Noise { amplitude, scale_m } => {
                let most = amplitude.round().clamp(0.0, 127.0);
                (TextureChoice::Noise(most as f32), scale_m, [-most, most])
            }
            Texture::Tiles(tiling) => tiles(&tiling, false),
            Texture::Bricks(tiling) => tiles(&tiling, true),
        };
        let two = matches!(choice, TextureChoice::Checker | TextureChoice::Stripes);
        Some((Self { choice, per_m: (1.0 / scale_m) as f32 }, GreySteps { ends, two }))
    }

    #[inline(always)]
    pub(super) fn is_plain(&self) -> bool {
        self.choice == TextureChoice::Plain
    }

    /// The colour of each place: its index in this look's palette. Places in metres along the surface's two axes.
    #[inline(always)]
    pub(super) fn choose(&self, along: &[f32; BATCH], across: &[f32; BATCH], indices: &mut [u8; BATCH]) {
        match self.choice {
            TextureChoice::Plain => *indices = [0; BATCH],
            TextureChoice::Checker => {
                for ((index, along), across) in indices.iter_mut().zip(along).zip(across) {
                    *index = ((floor(along * self.per_m).0 ^ floor(across * self.per_m).0) & 1) as u8;
                }
            }
            TextureChoice::Stripes => {
                for (index, across) in indices.iter_mut().zip(across) {
                    *index = (floor(across * self.per_m).0 & 1) as u8;
                }
            }
            TextureChoice::Noise(amplitude) => self.noise(amplitude, along, across, indices),
            TextureChoice::Tiles(tiles) => self.tiles(&tiles, along, across, indices),
        }
    }

    /// Each tile has the value of a lattice point; joints lie along the lower and the left edges of tiles.
    #[inline(always)]
    fn tiles(&self, tiles: &TileChoice, along: &[f32; BATCH], across: &[f32; BATCH], indices: &mut [u8; BATCH]) {
        let lattice = lattice();
        let (rows, shift) = if tiles.bricks { (2.0, 0.5) } else { (1.0, 0.0) };
        let mut cells = [0_u32; BATCH];
        let mut joints = [false; BATCH];
        for place in 0..BATCH {
            let y = across[place] * self.per_m;
            let (row, low) = floor(y * rows);
            let x = along[place] * self.per_m + if row & 1 == 1 { shift } else { 0.0 };
            let (column, left) = floor(x);
            cells[place] = (row % LATTICE as u32) * LATTICE as u32 + column % LATTICE as u32;
            joints[place] = x - left < tiles.joint_share || y * rows - low < tiles.joint_share * rows;
        }
        for place in 0..BATCH {
            let value = (lattice[cells[place] as usize % (LATTICE * LATTICE)] << 24) as i32 >> 24;
            let tile = tiles.middle + tiles.amplitude * value as f32 * (1.0 / 127.0);
            indices[place] = if joints[place] { tiles.joint } else { (tile + TO_WHOLE).to_bits() as u8 };
        }
    }

    /// Value noise: the lattice's values, blended smoothly.
    #[inline(always)]
    fn noise(&self, amplitude: f32, along: &[f32; BATCH], across: &[f32; BATCH], indices: &mut [u8; BATCH]) {
        let lattice = lattice();
        let mut cells = [0_u32; BATCH];
        let mut shares = [[0.0_f32; BATCH]; 2];
        for place in 0..BATCH {
            let (x, y) = (along[place] * self.per_m, across[place] * self.per_m);
            let ((column, left), (row, low)) = (floor(x), floor(y));
            cells[place] = (row % LATTICE as u32) * LATTICE as u32 + column % LATTICE as u32;
            shares[0][place] = smooth(x - left);
            shares[1][place] = smooth(y - low);
        }
        let mut corners = [0_u32; BATCH];
        for (corners, cell) in corners.iter_mut().zip(cells) {
            *corners = lattice[cell as usize % (LATTICE * LATTICE)];
        }
        for place in 0..BATCH {
            let (right, up) = (shares[0][place], shares[1][place]);
            let corner = |shift: u32| ((corners[place] << shift) as i32 >> 24) as f32;
            let low = corner(24) + (corner(16) - corner(24)) * right;
            let high = corner(8) + (corner(0) - corner(8)) * right;
            let value = (low + (high - low) * up) * (1.0 / 127.0);
            // The horizon may leave no number here; the clamp turns that into the darkest colour.
            let index = (amplitude + amplitude * value).max(0.0).min(2.0 * amplitude);
            indices[place] = (index + TO_WHOLE).to_bits() as u8;
        }
    }
}

/// The choice of tiles, their length, and the grey levels of their darkest and their lightest colour.
fn tiles(tiling: &Tiling, bricks: bool) -> (TextureChoice, f64, [f64; 2]) {
    let (most, joint) = (tiling.amplitude.round(), tiling.joint.round());
    let middle = most.max(joint);
    let choice = TileChoice {
        amplitude: most as f32,
        middle: middle as f32,
        joint: (middle - joint) as u8,
        joint_share: (tiling.joint_m / tiling.scale_m) as f32,
        bricks,
    };
    (TextureChoice::Tiles(choice), tiling.scale_m, [-middle, most])
}

/// 3 t^2 - 2 t^3: level at both ends.
#[inline(always)]
fn smooth(share: f32) -> f32 {
    share * share * (3.0 - 2.0 * share)
}

/// For each cell of the lattice the values at its four corners, -127 to 127, one in each byte from the lowest up: low
/// left, low right, high left, high right.
fn lattice() -> &'static [u32; LATTICE * LATTICE] {
    static CELLS: LazyLock<Box<[u32; LATTICE * LATTICE]>> = LazyLock::new(|| {
        let mut cells = Box::new([0; LATTICE * LATTICE]);
        for (index, cell) in cells.iter_mut().enumerate() {
            let (column, row) = (index % LATTICE, index / LATTICE);
            let corners = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(right, up)| lattice_value(column + right, row + up));
            *cell = u32::from_le_bytes(corners.map(|value| value as u8));
        }
        cells
    });
    &CELLS
}

/// The value of a lattice point: evenly spread over -127 to 127.
fn lattice_value(column: usize, row: usize) -> i8 {
    let mut hash = ((row % LATTICE) * LATTICE + column % LATTICE) as u32;
    hash = (hash ^ 0x5bd1_e995).wrapping_mul(0x85eb_ca6b);
    hash = (hash ^ (hash >> 13)).wrapping_mul(0xc2b2_ae35);
    (((hash ^ (hash >> 16)) % 255) as i32 - 127) as i8
}

#[cfg(test)]
mod tests {
    use super::*;

    fn indices(texture: Texture, places: &[(f32, f32)]) -> Vec<u8> {
        let (mut along, mut across, mut indices) = ([0.0; BATCH], [0.0; BATCH], [0; BATCH]);
        for (place, &(x, y)) in places.iter().enumerate() {
            (along[place], across[place]) = (x, y);
        }
        Pattern::of(&texture).unwrap().0.choose(&along, &across, &mut indices);
        indices[..places.len()].to_vec()
    }

    #[test]
    fn a_checker_alternates_along_both_axes_and_repeats_after_two_squares() {
        let texture = Texture::Checker { amplitude: 20.0, scale_m: 0.5 };
        let places = [(0.2, 0.2), (0.7, 0.2), (0.7, 0.7), (1.2, 0.2), (-0.2, 0.2), (-0.2, -0.2), (10.2, 20.2)];
        assert_eq!(indices(texture, &places), [0, 1, 0, 0, 1, 0, 0]);
    }

    #[test]
    fn stripes_run_across_the_second_axis_alone() {
        let texture = Texture::Stripes { amplitude: 20.0, scale_m: 0.1 };
        assert_eq!(indices(texture, &[(0.0, 0.05), (7.3, 0.05), (0.0, 0.15), (0.0, -0.05)]), [0, 0, 1, 1]);
    }

    #[test]
    fn noise_is_the_lattice_value_at_a_lattice_point_and_repeats_after_the_lattice() {
        let texture = Texture::Noise { amplitude: 127.0, scale_m: 1.0 };
        let found = indices(texture, &[(3.0, 5.0), (3.0 + LATTICE as f32, 5.0), (3.5, 5.0), (f32::NAN, 0.0)]);
        let here = i32::from(lattice_value(3, 5));
        let right = i32::from(lattice_value(4, 5));
        assert_eq!(i32::from(found[0]), 127 + here);
        assert_eq!(found[1], found[0]);
        assert!((i32::from(found[2]) - 127 - (here + right) / 2).abs() <= 1);
    }

    #[test]
    fn tiles_have_a_value_each_and_joints_along_two_of_their_edges() {
        // Half-metre tiles with joints of 5 cm, 40 levels darker; a tile is at most 6 off the middle, index 40.
        let tiling = Tiling { amplitude: 6.0, scale_m: 0.5, joint_m: 0.05, joint: 40.0 };
        let places = [(0.02, 0.2), (0.3, 0.04), (0.06, 0.06), (0.49, 0.49), (0.52, 0.3), (-0.47, 0.3)];
        let found = indices(Texture::Tiles(tiling), &places);
        assert_eq!([found[0], found[1], found[4], found[5]], [0; 4]);
        let tile = 40.0 + 6.0 * f64::from(lattice_value(0, 0)) / 127.0;
        assert_eq!([found[2], found[3]], [tile.round() as u8; 2]);
    }

    #[test]
    fn bricks_are_half_as_high_as_long_and_every_second_row_is_shifted() {
        let tiling = Tiling { amplitude: 0.0, scale_m: 0.2, joint_m: 0.01, joint: 24.0 };
        // In the lowest row a brick begins at 0, in the next one, from 0.1 m up, at 0.1 m.
        let places = [(0.005, 0.05), (0.105, 0.05), (0.005, 0.15), (0.105, 0.15), (0.05, 0.105)];
        assert_eq!(indices(Texture::Bricks(tiling), &places), [0, 24, 24, 0, 0]);
    }
}
