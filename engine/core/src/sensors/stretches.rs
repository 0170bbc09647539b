//! The image as a list: from which pixel on which face is seen.

use super::lens::Fisheye;
use super::pattern::BATCH;
use super::spans::Spans;
use super::view::{Affine, Pinhole};

/// Numbers of the three things that are always there, among drawn faces and looks alike.
pub(super) const SKY_FACE: u32 = 0;
pub(super) const FLOOR_FACE: u32 = 1;
pub(super) const OUTSIDE_LENS: u32 = 2;

/// Pixels that show one face, up to the next stretch.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stretch {
    /// Number of the first pixel, counted row by row.
    pub(super) first: u32,
    pub(super) face: u32,
}

/// The stretches of a frame in the order of its pixels. One of a plain face may run over rows; one of a textured face
/// ends with its row, and through a lens after [`BATCH`] pixels.
#[derive(Debug, Clone)]
pub(super) struct Stretches {
    list: Vec<Stretch>,
    /// The face that the last stretch shows, if it is plain.
    plain: Option<u32>,
}

/// What is seen where in the pinhole view.
pub(super) struct Sight<'a> {
    pub(super) pinhole: Pinhole,
    pub(super) spans: &'a Spans,
    /// One over the distance of the floor.
    pub(super) floor: Affine,
}

impl Stretches {
    /// None yet, with room for those of most images of that height.
    pub(super) fn with_room(height_px: usize) -> Self {
        Self { list: Vec::with_capacity(32 * height_px), plain: None }
    }

    pub(super) fn list(&self) -> &[Stretch] {
        &self.list
    }

    /// Lists what the pinhole view itself shows.
    pub(super) fn see(&mut self, sight: &Sight<'_>, is_plain: impl Fn(u32) -> bool) {
        self.clear();
        let width = sight.pinhole.width_px;
        for row in 0..sight.pinhole.height_px {
            let base = row * width;
            let floor = sight.floor_of(row);
            let mut from = 0;
            for run in sight.spans.row(row) {
                let (start, end) = (usize::from(run.start), usize::from(run.end));
                self.background(base, (from, start), floor, &is_plain);
                self.push(base + start, run.face, is_plain(run.face));
                from = end;
            }
            self.background(base, (from, width), floor, &is_plain);
        }
    }

    /// Lists what rows of `width_px` pixels show through a lens.
    pub(super) fn see_through(
        &mut self,
        lens: &Fisheye,
        width_px: usize,
        sight: &Sight<'_>,
        is_plain: impl Fn(u32) -> bool,
    ) {
        self.clear();
        let mut first = 0;
        for (xs, ys) in lens.xs.chunks(width_px).zip(lens.ys.chunks(width_px)) {
            let mut column = 0;
            while column < xs.len() {
                let face = sight.seen_at(xs[column], ys[column]);
                let most = xs.len().min(column + BATCH);
                let same = (column + 1..most).find(|&next| sight.seen_at(xs[next], ys[next]) != face).unwrap_or(most);
                self.push(first + column, face, is_plain(face));
                column = same;
            }
            first += xs.len();
        }
    }

    fn clear(&mut self) {
        self.list.clear();
        self.plain = None;
    }

    fn push(&mut self, first: usize, face: u32, plain: bool) {
        if self.plain != Some(face) {
            self.list.push(Stretch { first: first as u32, face });
            self.plain = plain.then_some(face);
        }
    }

    /// Pixels of a row in which no solid is seen: sky, and the floor within its own part of the row.
    fn background(
        &mut self,
        base: usize,
        (from, to): (usize, usize),
        floor: (usize, usize),
        is_plain: &impl Fn(u32) -> bool,
    ) {
        if from >= to {
            return;
        }
        let (first, last) = (floor.0.clamp(from, to), floor.1.clamp(from, to));
        for (from, to, face) in [(from, first, SKY_FACE), (first, last, FLOOR_FACE), (last, to, SKY_FACE)] {
            if from < to {
                self.push(base + from, face, is_plain(face));
            }
        }
    }
}

impl Sight<'_> {
    /// The pixels of a row below the horizon.
    pub(super) fn floor_of(&self, row: usize) -> (usize, usize) {
        let width = self.pinhole.width_px;
        let at = |pixel: f64| self.floor.at(pixel, row as f64 + 0.5);
        let (left, right) = (at(0.5), at(width as f64 - 0.5));
        if left > 0.0 && right > 0.0 {
            return (0, width);
        }
        if left <= 0.0 && right <= 0.0 {
            return (0, 0);
        }
        let crossing = (-at(0.0) / self.floor.0[0] + 0.5).clamp(0.0, width as f64) as usize;
        if left > 0.0 { (0, crossing) } else { (crossing, width) }
    }

    /// The face at a place of the pinhole view.
    fn seen_at(&self, x: f32, y: f32) -> u32 {
        if x.is_nan() {
            return OUTSIDE_LENS;
        }
        let (column, row) = (x as u16, y as usize);
        match self.spans.row(row).iter().find(|run| column < run.end) {
            Some(run) if run.start <= column => run.face,
            _ if self.floor.at(f64::from(x), f64::from(y)) > 0.0 => FLOOR_FACE,
            _ => SKY_FACE,
        }
    }
}
