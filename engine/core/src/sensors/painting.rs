//! Turns the list of what is seen into pixels, in the order of the image's memory.

use super::canvas::PixelCanvas;
use super::lens::Fisheye;
use super::pattern::BATCH;
use super::shadows::Shadows;
use super::stretches::{Stretch, Stretches};
use super::texture::{Looks, TextureLook};
use super::view::Affine;
use dispatch::Work;

/// A face of the frame at hand.
#[derive(Debug, Clone, Copy)]
pub(super) struct Drawn {
    /// Index of its look.
    pub(super) look: usize,
    /// Whether one colour is all there is.
    pub(super) plain: bool,
    /// Texture coordinates times nearness; nothing for a plain look.
    pub(super) coordinates: [Affine; 2],
}

/// A frame to paint. All of it is one piece of work, so that all of it is compiled for each processor.
pub(super) struct Painting<'a, C> {
    pub(super) canvas: C,
    pub(super) stretches: &'a Stretches,
    pub(super) looks: &'a Looks,
    pub(super) drawn: &'a [Drawn],
    pub(super) nearness: &'a [Affine],
    pub(super) size_px: [usize; 2],
    pub(super) lens: Option<&'a Fisheye>,
    pub(super) shadows: Option<&'a Shadows>,
}

/// Texture coordinates of a batch of places, along and across, metres.
type Places = [[f32; BATCH]; 2];

impl<C: PixelCanvas> Work for Painting<'_, C> {
    type Output = ();

    #[inline(always)]
    fn run(mut self) {
        let list = self.stretches.list();
        let [width, height] = self.size_px;
        for (index, stretch) in list.iter().enumerate() {
            let first = stretch.first as usize;
            let end = list.get(index + 1).map_or(width * height, |next| next.first as usize);
            let look = self.looks.get(self.drawn[stretch.face as usize].look);
            if look.is_plain() {
                self.canvas.fill(look, first..end);
                continue;
            }
            let mut from = first;
            while from < end {
                let count = BATCH.min(end - from);
                let places = match self.lens {
                    None => self.places_in_row(*stretch, from),
                    Some(lens) => {
                        self.places_through(*stretch, &lens.xs[from..from + count], &lens.ys[from..from + count])
                    }
                };
                match look.sheet.zip(self.shadows) {
                    None => self.spots(look, from, count, &places),
                    Some((sheet, shadows)) => self.shaded(look, (sheet, shadows), from, count, &places),
                }
                from += count;
            }
        }
    }
}

impl<C: PixelCanvas> Painting<'_, C> {
    /// The three values of a face that are affine over the image: along, across, nearness.
    #[inline(always)]
    fn affine(&self, stretch: Stretch) -> [Affine; 3] {
        let [along, across] = self.drawn[stretch.face as usize].coordinates;
        [along, across, self.nearness[stretch.face as usize]]
    }

    /// What pixels from number `first` on see of a face, in one row of the image.
    #[inline(always)]
    fn places_in_row(&self, stretch: Stretch, first: usize) -> Places {
        let (column, row) = (first % self.size_px[0], first / self.size_px[0]);
        // Values at the batch's start in double precision keep the steps within it exact enough.
        let affine = self.affine(stretch);
        let starts = affine.map(|value| value.at(column as f64 + 0.5, row as f64 + 0.5) as f32);
        let steps = affine.map(|value| value.0[0] as f32);
        let mut places = [[0.0; BATCH]; 2];
        let [us, vs] = &mut places;
        for (place, (u, v)) in us.iter_mut().zip(vs).enumerate() {
            let step = place as f32;
            let distance = 1.0 / (starts[2] + step * steps[2]);
            *u = (starts[0] + step * steps[0]) * distance;
            *v = (starts[1] + step * steps[1]) * distance;
        }
        places
    }

    /// Paints along rays through any places of the view.
    #[inline(always)]
    fn places_through(&self, stretch: Stretch, xs: &[f32], ys: &[f32]) -> Places {
        let [along, across, nearness] = self.affine(stretch).map(|value| value.0.map(|part| part as f32));
        let mut places = [[0.0; BATCH]; 2];
        let [us, vs] = &mut places;
        for ((x, y), (u, v)) in xs.iter().zip(ys).zip(us.iter_mut().zip(vs)) {
            let distance = 1.0 / (nearness[0] * x + nearness[1] * y + nearness[2]);
            *u = (along[0] * x + along[1] * y + along[2]) * distance;
            *v = (across[0] * x + across[1] * y + across[2]) * distance;
        }
        places
    }

    /// Paints what lies all in the sun or all in the shade as if there were nothing else.
    #[inline(always)]
    fn shaded(
        &mut self,
        look: &TextureLook,
        (sheet, shadows): (u32, &Shadows),
        first: usize,
        count: usize,
        places: &Places,
    ) {
        let [along, across] = places;
        // Places in a row of the image lie on a line: between its ends.
        let ends = [[along[0], across[0]], [along[count - 1], across[count - 1]]];
        let all = if self.lens.is_none() { shadows.same_between(sheet, &ends) } else { None };
        let Some(hidden) = all else {
            let (mut indices, mut hidden) = ([0; BATCH], [0; BATCH]);
            look.places.choose(along, across, &mut indices);
            shadows.hidden(sheet, along, across, &mut hidden);
            self.canvas.shaded(self.looks.shades(sheet), first, count, &hidden, &indices);
            return;
        };
        let look = if hidden { self.looks.dark(sheet) } else { look };
        if look.places.is_plain() {
            self.canvas.fill(look, first..first + count);
        } else {
            self.spots(look, first, count, places);
        }
    }

    #[inline(always)]
    fn spots(&mut self, look: &TextureLook, first: usize, count: usize, [along, across]: &Places) {
        let mut indices = [0; BATCH];
        look.places.choose(along, across, &mut indices);
        self.canvas.spots(self.looks, look, first, count, &indices);
    }
}
