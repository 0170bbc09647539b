//! How a lit surface looks: its colours.

use super::luma::weight;
use super::pattern::Pattern;
use crate::geometry::Vector3;
use crate::world::scene::{Light, Material};

/// How much of the sun may be hidden from a place: none of it, one eighth, ..., all of it.
pub(super) const LEVELS: usize = 9;

/// Pixels in a prepared stretch of plain colour.
pub(super) const PATTERN_PX: usize = 16;

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
    pub(super) places: Pattern,
    /// First colour of this look in the palette.
    palette_start: usize,
    /// Grey levels that the first colour of the palette adds to the plain one, and how many more each next one adds.
    offsets: [i16; 2],
    /// Where shadows may fall on it: the number of its sheet and of its shades.
    pub(super) sheet: Option<u32>,
}

/// The plain colour of a look, and its weighted sum, for each share of the sun that is hidden; and what its texture adds.
#[derive(Debug, Clone)]
pub(super) struct Shades {
    pub(super) colours: [[u8; 3]; LEVELS],
    pub(super) weights: [u16; LEVELS],
    pub(super) offsets: [i16; 2],
}

/// Looks and their colours, four bytes each so that a colour is one word.
#[derive(Debug, Clone, Default)]
pub(super) struct Looks {
    looks: Vec<TextureLook>,
    palette: Vec<[u8; 4]>,
    /// By sheet.
    shades: Vec<Shades>,
    /// By sheet: how it looks where all of the sun is hidden.
    dark: Vec<TextureLook>,
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
            places: Pattern::default(),
            palette_start,
            offsets: [0; 2],
            sheet: None,
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

    /// Adds the look of a material on a surface that is so bright, by [`Light::on`].
    pub(super) fn push(&mut self, material: &Material, brightness: f64) {
        let lit = lit(material, brightness);
        self.push_plain(lighter(lit, 0.0));
        let Some((pattern, steps)) = Pattern::of(&material.texture) else { return };
        let [first, last] = steps.ends;
        if steps.two {
            [first, last].into_iter().for_each(|by| self.push_colour(lighter(lit, by)));
        } else {
            (first as i32..=last as i32).for_each(|by| self.push_colour(lighter(lit, f64::from(by))));
        }
        if let Some(look) = self.looks.last_mut() {
            look.places = pattern;
            let of = |index: usize| {
                self.palette.get(look.palette_start + index).map_or(0, |[r, g, b, _]| weight([*r, *g, *b]))
            };
            look.weights = [of(0), of(1).wrapping_sub(of(0))];
            look.offsets = [whole(first), if steps.two { whole(last) - whole(first) } else { 1 }];
        }
    }

    /// Lets shadows fall on the last look, a material on a surface with the unit normal `normal`; its sheet is the next one.
    pub(super) fn shade(&mut self, material: &Material, light: &Light, normal: &Vector3) {
        let share = |level: usize| 1.0 - level as f64 / (LEVELS - 1) as f64;
        let colour = |level| lighter(lit(material, light.partly_on(normal, share(level))), 0.0);
        let colours: [[u8; 3]; LEVELS] = std::array::from_fn(colour);
        let Some(look) = self.looks.last_mut() else { return };
        let offsets = look.offsets;
        let last = self.palette.len().saturating_sub(look.palette_start + 1) as i16;
        look.sheet = Some(self.shades.len() as u32);
        self.push(material, light.partly_on(normal, 0.0));
        self.dark.extend(self.looks.pop());
        self.shades.push(Shades { colours, weights: colours.map(weight), offsets });
        for by in [offsets[0], offsets[0] + offsets[1] * last] {
            colours.into_iter().for_each(|colour| self.widen(lighter(colour.map(f64::from), f64::from(by))));
        }
    }

    /// The look of a sheet where all of the sun is hidden.
    #[inline(always)]
    pub(super) fn dark(&self, sheet: u32) -> &TextureLook {
        &self.dark[sheet as usize]
    }

    /// The shades of a sheet.
    pub(super) fn shades(&self, sheet: u32) -> &Shades {
        &self.shades[sheet as usize]
    }
}

/// A material's colour at a brightness.
fn lit(material: &Material, brightness: f64) -> [f64; 3] {
    material.colour.map(|channel| (f64::from(channel) * brightness).round().clamp(0.0, 255.0))
}

/// A colour so many grey levels lighter.
fn lighter(colour: [f64; 3], by: f64) -> [u8; 3] {
    colour.map(|channel| (channel + by).round().clamp(0.0, 255.0) as u8)
}

/// Whole grey levels, rounded as on a channel in the middle.
fn whole(by: f64) -> i16 {
    ((128.0 + by).round() - 128.0) as i16
}

impl TextureLook {
    /// Whether one colour is all there is.
    #[inline(always)]
    pub(super) fn is_plain(&self) -> bool {
        self.places.is_plain() && self.sheet.is_none()
    }
}
