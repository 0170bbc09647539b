//! Which face is seen where: for each row of the image a sorted list of runs, the nearest face in each.
//!
//! One over the distance is affine over the image, so two faces change places at most once within a row; comparing
//! them at the ends of their common part is exact, and no depth is stored for single pixels.

use super::view::Affine;
use dispatch::{Processor, compiled_for_each_processor};

/// Pixels `start..end` of a row that show one face.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Run {
    pub(super) start: u16,
    pub(super) end: u16,
    /// Index into the drawn faces.
    pub(super) face: u32,
}

/// The runs of every row.
#[derive(Debug, Clone)]
pub(super) struct Spans {
    width_px: usize,
    rows: Vec<Vec<Run>>,
    /// First pixel of the polygon at hand in each row, and one past its last.
    bounds: [Vec<u16>; 2],
    rebuilt: Vec<Run>,
    /// What was done since all runs were forgotten: rows of faces, and runs that were looked at or moved for them.
    work: u64,
    processor: Processor,
}

/// The nearest whole number of `value` clamped to 0..=`limit`, which is below 2^31.
///
/// Adding 1.5 * 2^52 leaves that number in the low bits; unlike a rounding call it works on several rows at once.
#[inline(always)]
fn nearest_whole(value: f64, limit: f64) -> u32 {
    (value.max(0.0).min(limit) + 6_755_399_441_055_744.0).to_bits() as u32
}

impl Spans {
    pub(super) fn new(width_px: usize, height_px: usize) -> Self {
        Self {
            width_px,
            rows: (0..height_px).map(|_| Vec::with_capacity(64)).collect(),
            bounds: [vec![0; height_px], vec![0; height_px]],
            rebuilt: Vec::with_capacity(64),
            work: 0,
            processor: Processor::best(),
        }
    }

    /// Forgets all runs.
    pub(super) fn clear(&mut self) {
        self.work = 0;
        for row in &mut self.rows {
            row.clear();
        }
    }

    /// What was done since then, counted: the same on every machine.
    pub(super) fn work(&self) -> u64 {
        self.work
    }

    /// The runs of a row from left to right; what lies between them shows no face.
    pub(super) fn row(&self, row: usize) -> &[Run] {
        &self.rows[row]
    }

    /// Draws a convex polygon, its corners in pixels and anticlockwise as seen. A pixel belongs to it if its centre does.
    ///
    /// `nearness` holds one over the distance for every face drawn so far and, at `face`, for this one. Where two are
    /// equally near the later one is seen.
    pub(super) fn draw(&mut self, corners: &[[f64; 2]], face: u32, nearness: &[Affine]) {
        let (mut top, mut bottom) = (f64::INFINITY, f64::NEG_INFINITY);
        let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
        for corner in corners {
            (left, right) = (left.min(corner[0]), right.max(corner[0]));
            (top, bottom) = (top.min(corner[1]), bottom.max(corner[1]));
        }
        let height = self.rows.len() as f64;
        let (first, last) = (nearest_whole(top, height) as usize, nearest_whole(bottom, height) as usize);
        if first >= last || right <= 0.0 || left >= self.width_px as f64 {
            return;
        }
        let mut from = corners[corners.len() - 1];
        for &to in corners {
            self.trace(from, to);
            from = to;
        }
        let overlay = Overlay { face, nearness };
        self.work += (last - first) as u64;
        for row in first..last {
            let [start, end] = [self.bounds[0][row], self.bounds[1][row]];
            if start < end {
                let run = Run { start, end, face };
                let runs = &mut self.rows[row];
                if runs.last().is_none_or(|last| last.end <= start) {
                    runs.push(run);
                } else {
                    self.work += runs.len() as u64;
                    overlay.insert(runs, &mut self.rebuilt, run, row);
                }
            }
        }
    }

    /// Notes where an edge crosses the rows' middles. Down-going edges bound the polygon on the left.
    fn trace(&mut self, from: [f64; 2], to: [f64; 2]) {
        let on_left = from[1] < to[1];
        // Always from the top: a neighbour that shares the edge gets the same numbers.
        let (top, bottom) = if on_left { (from, to) } else { (to, from) };
        let (width, height) = (self.width_px as f64, self.rows.len() as f64);
        let (first, last) = (nearest_whole(top[1], height) as usize, nearest_whole(bottom[1], height) as usize);
        if first >= last {
            return;
        }
        let slope = (bottom[0] - top[0]) / (bottom[1] - top[1]);
        let from_top = 0.5 - top[1];
        let bounds = &mut self.bounds[usize::from(!on_left)][first..last];
        cross_rows(self.processor, bounds, first as i32, [top[0], from_top, slope], width);
    }
}

compiled_for_each_processor! {
    /// Where a line crosses rows from `first` on: its place at the top, the first row's distance from there, its slope.
    fn cross_rows<'a>(bounds: &'a mut [u16], first: i32, line: [f64; 3], width: f64) {
        let [top, from_top, slope] = line;
        for (bound, row) in bounds.iter_mut().zip(first..) {
            *bound = nearest_whole(top + (f64::from(row) + from_top) * slope, width) as u16;
        }
    }
}

/// A face on its way into the rows.
struct Overlay<'a> {
    face: u32,
    nearness: &'a [Affine],
}

impl Overlay<'_> {
    /// Puts `new` among the sorted `runs`; whichever is nearer keeps each pixel.
    fn insert(&self, runs: &mut Vec<Run>, rebuilt: &mut Vec<Run>, new: Run, row: usize) {
        let before = runs.iter().take_while(|run| run.end <= new.start).count();
        if self.insert_alone(runs, before, new, row) {
            return;
        }
        rebuilt.clear();
        let mut placed = new.start;
        for &old in &runs[before..] {
            if old.start >= new.end {
                push(rebuilt, Run { start: placed, ..new });
                placed = new.end;
                push(rebuilt, old);
                continue;
            }
            let (start, end) = (old.start.max(new.start), old.end.min(new.end));
            push(rebuilt, Run { end: start, ..old });
            push(rebuilt, Run { start: placed, end: start, ..new });
            let (split, new_first) = self.compare(old.face, start, end, row);
            let (first, second) = if new_first { (new, old) } else { (old, new) };
            push(rebuilt, Run { start, end: split, ..first });
            push(rebuilt, Run { start: split, end, ..second });
            push(rebuilt, Run { start: end, ..old });
            placed = end;
        }
        push(rebuilt, Run { start: placed, ..new });
        runs.truncate(before);
        runs.extend_from_slice(rebuilt);
    }

    /// The usual cases, in place: `new` meets nothing, or the run at `at` alone and on one side of it throughout.
    fn insert_alone(&self, runs: &mut Vec<Run>, at: usize, new: Run, row: usize) -> bool {
        let old = runs[at];
        if new.end <= old.start {
            runs.insert(at, new);
            return true;
        }
        if new.start < old.start || old.end < new.end {
            return false;
        }
        let (split, new_first) = self.compare(old.face, new.start, new.end, row);
        if split < new.end {
            return false;
        }
        if new_first {
            runs[at] = new;
            if new.end < old.end {
                runs.insert(at + 1, Run { start: new.end, ..old });
            }
            if old.start < new.start {
                runs.insert(at, Run { end: new.start, ..old });
            }
        }
        true
    }

    /// Where within `start..end` the nearer face changes, and whether the new one is nearer before that.
    fn compare(&self, old: u32, start: u16, end: u16, row: usize) -> (u16, bool) {
        let lead = self.nearness[self.face as usize].minus(&self.nearness[old as usize]);
        let at = |pixel: f64| lead.at(pixel, row as f64 + 0.5);
        // Faces in one plane differ by rounding alone.
        let nearer = |lead: f64| lead > -1e-9;
        let (first, last) = (nearer(at(f64::from(start) + 0.5)), nearer(at(f64::from(end) - 0.5)));
        if first == last {
            return (end, first);
        }
        let crossing = -(lead.at(0.0, row as f64 + 0.5)) / lead.0[0];
        let split = nearest_whole(crossing, f64::from(end)) as u16;
        (split.clamp(start + 1, end - 1), first)
    }
}

/// Appends a run unless it is empty, as one with the last if that shows the same face up to there.
fn push(runs: &mut Vec<Run>, run: Run) {
    if run.start >= run.end {
        return;
    }
    match runs.last_mut() {
        Some(last) if last.face == run.face && last.end == run.start => last.end = run.end,
        _ => runs.push(run),
    }
}
