//! How a lit surface looks: its colours, and which of them a place on it has.

use super::luma::weight;
use crate::geometry::Vector3;
use crate::world::scene::{Light, Material, Texture};
use std::sync::LazyLock;

/// Pixels that are textured at once.
pub(super) const BATCH: usize = 32;
/// Pixels in a prepared stretch of plain colour.
pub(super) const PATTERN_PX: usize = 16;
/// Lattice points of the noise texture along each axis; then it repeats.
const LATTICE: usize = 128;

/// How the places of a surface choose among its colours.
#[derive(Debug, Clone, Copy, PartialEq)]
enum TextureChoice {
    Plain,
    Checker,
    Stripes,
    /// The amplitude, which is the middle colour's index.
    Noise(f32),
}

/// The finished colours of one face.
#[derive(Debug, Clone)]
pub(super) struct TextureLook {
    /// One stretch of the plain colour.
    pub(super) pattern: [u8; PATTERN_PX * 3],
    /// The plain colour's weighted sum, 256 times its luma.
    pub(super) weight: u16,
    /// The weighted sum of the first colour in the palette, and how much more that of each next one is; true unless a
    /// colour is black or white in some channel.
    pub(super) weights: [u16; 2],
    choice: TextureChoice,
    per_m: f32,
    /// First colour of this look in the palette.
    palette_start: usize,
}

/// Looks and their colours, four bytes each so that a colour is one word.
#[derive(Debug, Clone, Default)]
pub(super) struct Looks {
    looks: Vec<TextureLook>,
    palette: Vec<[u8; 4]>,
    range: Extremes,
}

/// The least and the greatest byte of some colours.
#[derive(Debug, Clone, Copy)]
struct Extremes(u8, u8);

/// How far a list of looks has come.
#[derive(Debug, Clone, Copy)]
pub(super) struct PaintMark {
    pub(super) looks: usize,
    colours: usize,
    range: Extremes,
}

impl Default for Extremes {
    fn default() -> Self {
        Self(u8::MAX, 0)
    }
}

impl Looks {
    /// The look with this index.
    #[inline(always)]
    pub(super) fn get(&self, index: usize) -> &TextureLook {
        &self.looks[index]
    }

    /// Colours of a look.
    pub(super) fn palette(&self, look: &TextureLook) -> &[[u8; 4]] {
        &self.palette[look.palette_start..]
    }

    /// Whether every channel keeps so far from black and white that `most` may be added to it or taken from it.
    pub(super) fn keep_within(&self, most: u8) -> bool {
        self.range.0 >= most && self.range.1 <= u8::MAX - most
    }

    /// What there is now.
    pub(super) fn mark(&self) -> PaintMark {
        PaintMark { looks: self.looks.len(), colours: self.palette.len(), range: self.range }
    }

    /// Makes room for so many looks more.
    pub(super) fn reserve(&mut self, looks: usize) {
        self.looks.reserve(looks);
        self.palette.reserve(looks);
    }

    /// Forgets what came after a mark.
    pub(super) fn truncate(&mut self, mark: PaintMark) {
        self.looks.truncate(mark.looks);
        self.palette.truncate(mark.colours);
        self.range = mark.range;
    }

    /// Adds one plain colour.
    pub(super) fn push_plain(&mut self, colour: [u8; 3]) {
        let mut pattern = [0; PATTERN_PX * 3];
        for pixel in pattern.chunks_exact_mut(3) {
            pixel.copy_from_slice(&colour);
        }
        let palette_start = self.palette.len();
        let weight = weight(colour);
        self.looks.push(TextureLook {
            pattern,
            weight,
            weights: [0; 2],
            choice: TextureChoice::Plain,
            per_m: 0.0,
            palette_start,
        });
        self.widen(colour);
    }

    fn widen(&mut self, colour: [u8; 3]) {
        let [red, green, blue] = colour;
        self.range.0 = self.range.0.min(red).min(green).min(blue);
        self.range.1 = self.range.1.max(red).max(green).max(blue);
    }

    fn push_colour(&mut self, colour: [u8; 3]) {
        let [red, green, blue] = colour;
        self.palette.push([red, green, blue, 0]);
        self.widen(colour);
    }

    /// Adds the look of a material on a surface with the unit normal `normal`.
    pub(super) fn push(&mut self, material: &Material, light: &Light, normal: &Vector3) {
        let brightness = light.on(normal);
        let lit = material.colour.map(|channel| (f64::from(channel) * brightness).round().clamp(0.0, 255.0));
        let lighter = |by: f64| lit.map(|channel| (channel + by).round().clamp(0.0, 255.0) as u8);
        self.push_plain(lighter(0.0));
        let (choice, amplitude, scale_m) = match material.texture {
            Texture::Plain => return,
            Texture::Checker { amplitude, scale_m } => (TextureChoice::Checker, amplitude, scale_m),
            Texture::Stripes { amplitude, scale_m } => (TextureChoice::Stripes, amplitude, scale_m),
            Texture::Noise { amplitude, scale_m } => {
                let amplitude = amplitude.round().clamp(0.0, 127.0);
                (TextureChoice::Noise(amplitude as f32), amplitude, scale_m)
            }
        };
        if let TextureChoice::Noise(amplitude) = choice {
            let most = amplitude as i32;
            (-most..=most).for_each(|by| self.push_colour(lighter(f64::from(by))));
        } else {
            [amplitude, -amplitude].into_iter().for_each(|by| self.push_colour(lighter(by)));
        }
        if let Some(look) = self.looks.last_mut() {
            (look.choice, look.per_m) = (choice, (1.0 / scale_m) as f32);
            let of = |index: usize| {
                self.palette.get(look.palette_start + index).map_or(0, |[r, g, b, _]| weight([*r, *g, *b]))
            };
            look.weights = [of(0), of(1).wrapping_sub(of(0))];
        }
    }
}

/// Adding 1.5 * 2^23 rounds a small number to a whole one, which then stands in the low bits.
const TO_WHOLE: f32 = 12_582_912.0;

/// The whole number below `value`, as bits and as a number. Only its low bits mean something far from the origin.
#[inline(always)]
fn floor(value: f32) -> (u32, f32) {
    let shifted = (value - 0.5) + TO_WHOLE;
    (shifted.to_bits(), shifted - TO_WHOLE)
}

impl TextureLook {
    /// Whether one colour is all there is.
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
        let material = Material { name: String::new(), colour: [100; 3], texture, laser: true };
        let light = Light { towards: Vector3::z(), ambient: 1.0, gain: 1.0 };
        let mut looks = Looks::default();
        looks.push(&material, &light, &Vector3::z());
        let (mut along, mut across, mut indices) = ([0.0; BATCH], [0.0; BATCH], [0; BATCH]);
        for (place, &(x, y)) in places.iter().enumerate() {
            (along[place], across[place]) = (x, y);
        }
        looks.get(0).choose(&along, &across, &mut indices);
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
}
