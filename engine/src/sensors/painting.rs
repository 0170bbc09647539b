//! Turns visible faces into pixels, in the order of the image's memory.

use super::canvas::Canvas;
use super::texture::{BATCH, Look, Looks};
use super::view::Affine;

/// A face of the frame at hand.
#[derive(Debug, Clone, Copy)]
pub(super) struct Drawn {
    /// Index of its look.
    pub(super) look: usize,
    /// Texture coordinates times nearness; nothing for a plain look.
    pub(super) coordinates: [Affine; 2],
}

/// Paints an image from its first pixel to its last.
pub(super) struct Painter<'a, C> {
    canvas: C,
    looks: &'a Looks,
    drawn: &'a [Drawn],
    nearness: &'a [Affine],
    /// A stretch of one plain face from `start` that is not painted yet.
    pending: Option<u32>,
    start: usize,
}

impl<'a, C: Canvas> Painter<'a, C> {
    pub(super) fn new(canvas: C, looks: &'a Looks, drawn: &'a [Drawn], nearness: &'a [Affine]) -> Self {
        Self { canvas, looks, drawn, nearness, pending: None, start: 0 }
    }

    /// Pixels `from..to` of a row show `face`; `base` is the number of the row's first pixel.
    pub(super) fn stretch(&mut self, face: u32, base: usize, row: usize, (from, to): (usize, usize)) {
        if from >= to || self.pending == Some(face) {
            return;
        }
        self.flush(base + from);
        let look = self.look(face);
        if look.is_plain() {
            self.pending = Some(face);
            return;
        }
        let drawn = &self.drawn[face as usize];
        let affine = [drawn.coordinates[0], drawn.coordinates[1], self.nearness[face as usize]];
        for first in (from..to).step_by(BATCH) {
            // Values at the batch's start in double precision keep the steps within it exact enough.
            let starts = affine.map(|value| value.at(first as f64 + 0.5, row as f64 + 0.5) as f32);
            let steps = affine.map(|value| value.0[0] as f32);
            let (mut along, mut across) = ([0.0; BATCH], [0.0; BATCH]);
            for (place, (along, across)) in along.iter_mut().zip(&mut across).enumerate() {
                let step = place as f32;
                let distance = 1.0 / (starts[2] + step * steps[2]);
                *along = (starts[0] + step * steps[0]) * distance;
                *across = (starts[1] + step * steps[1]) * distance;
            }
            self.batch(look, base + first, BATCH.min(to - first), (&along, &across));
        }
        self.start = base + to;
    }

    /// Up to [`BATCH`] pixels from number `first` on show `face`, seen along rays through any places of the view.
    pub(super) fn scattered(&mut self, face: u32, first: usize, xs: &[f32], ys: &[f32]) {
        if self.pending == Some(face) {
            return;
        }
        self.flush(first);
        let look = self.look(face);
        if look.is_plain() {
            self.pending = Some(face);
            return;
        }
        let coordinates = self.drawn[face as usize].coordinates;
        let [along, across, nearness] =
            [coordinates[0], coordinates[1], self.nearness[face as usize]].map(|value| value.0.map(|part| part as f32));
        let (mut u, mut v) = ([0.0; BATCH], [0.0; BATCH]);
        for ((x, y), (u, v)) in xs.iter().zip(ys).zip(u.iter_mut().zip(&mut v)) {
            let distance = 1.0 / (nearness[0] * x + nearness[1] * y + nearness[2]);
            *u = (along[0] * x + along[1] * y + along[2]) * distance;
            *v = (across[0] * x + across[1] * y + across[2]) * distance;
        }
        self.batch(look, first, xs.len(), (&u, &v));
        self.start = first + xs.len();
    }

    fn look(&self, face: u32) -> &'a Look {
        self.looks.get(self.drawn[face as usize].look)
    }

    fn batch(&mut self, look: &Look, first: usize, count: usize, (along, across): (&[f32; BATCH], &[f32; BATCH])) {
        let mut indices = [0; BATCH];
        look.choose(along, across, &mut indices);
        self.canvas.spots(self.looks, look, first, &indices[..count]);
    }

    /// Paints the pending stretch up to pixel number `end`.
    pub(super) fn flush(&mut self, end: usize) {
        if let Some(face) = self.pending.take() {
            self.canvas.fill(self.look(face), self.start..end);
        }
        self.start = end;
    }
}
