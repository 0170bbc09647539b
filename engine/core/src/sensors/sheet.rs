//! A flat surface cut into cells, and polygons drawn over them.

use super::pattern::BATCH;
use super::surface::Face;
use crate::geometry::Vector3;
use std::ops::Range;

/// Length of a cell where there is room, metres.
const CELL_M: f64 = 0.015;
/// Most cells of the floor, and of all faces together: where they would be more, they are larger.
const MOST_CELLS: f64 = 4_000_000.0;
/// Cells along the edge of a block.
const BLOCK: usize = 16;
/// Most blocks that are looked at to find whether places are all alike.
const MOST_BLOCKS: usize = 12;
/// Fewest cells from edge to edge: the outermost of a floor keep clear.
const LEAST_CELLS: usize = 3;
/// Adding 1.5 * 2^23 rounds a small number to a whole one, which then stands in the low bits.
const TO_WHOLE: f32 = 12_582_912.0;

/// A surface and its cells, row by row.
#[derive(Debug, Clone)]
pub(super) struct Sheet {
    /// Its plane: `normal * point = offset_m`.
    pub(super) normal: Vector3,
    pub(super) offset_m: f64,
    origin: Vector3,
    along: Vector3,
    across: Vector3,
    /// Least and greatest place along both axes, metres.
    low: [f64; 2],
    high: [f64; 2],
    /// Around it in world axes.
    min: [f32; 3],
    max: [f32; 3],
    /// Whether it is the floor, whose outermost cells stand for all beyond.
    endless: bool,
    first: usize,
    columns: usize,
    rows: usize,
    per_m: f64,
    /// Row by row: what its cells have in common, of blocks of the cells.
    blocks: Vec<Common>,
}

/// What the cells of a block have in common.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Common {
    Sun,
    Shade,
    Nothing,
}

/// The cells of one sheet, and which of them were drawn on.
pub(super) struct Cells<'a> {
    all: &'a mut [u8],
    pub(super) drawn: Area,
    /// Rows of polygons that were drawn, and every sixteenth cell of them.
    pub(super) work: u64,
}

/// A rectangle of cells: from the first column and row to those before the last.
#[derive(Debug, Clone, Copy)]
pub(super) struct Area {
    first: [usize; 2],
    last: [usize; 2],
}

impl Area {
    const NONE: Self = Self { first: [usize::MAX; 2], last: [0; 2] };

    fn hold(&mut self, columns: &Range<usize>, row: usize) {
        self.first = [self.first[0].min(columns.start), self.first[1].min(row)];
        self.last = [self.last[0].max(columns.end), self.last[1].max(row + 1)];
    }

    /// Whether there is a cell in it.
    pub(super) fn is_some(&self) -> bool {
        self.last[0] > 0
    }

    fn meets_blocks(&self, low: [usize; 2], high: [usize; 2]) -> bool {
        (0..2).all(|axis| self.first[axis] < (high[axis] + 1) * BLOCK && low[axis] * BLOCK < self.last[axis])
    }
}

impl Sheet {
    /// The floor between least and greatest coordinates; a dot if shadows lie nowhere.
    pub(super) fn of_floor(bounds: Option<[[f64; 2]; 2]>) -> Self {
        let edge = 2.0 * CELL_M;
        let [low, high] = bounds.unwrap_or_default();
        let (low, high) = (low.map(|value| value - edge), high.map(|value| value + edge));
        Self {
            normal: Vector3::z(),
            offset_m: 0.0,
            origin: Vector3::zeros(),
            along: Vector3::x(),
            across: Vector3::y(),
            low,
            high,
            min: [low[0] as f32, low[1] as f32, 0.0],
            max: [high[0] as f32, high[1] as f32, 0.0],
            endless: true,
            first: 0,
            columns: 0,
            rows: 0,
            per_m: 0.0,
            blocks: Vec::new(),
        }
    }

    /// A face with these corners.
    pub(super) fn of_face(face: &Face, vertices: &[Vector3]) -> Self {
        let axes = [face.along, face.across()];
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        let (mut min, mut max) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        for vertex in vertices {
            for (axis, direction) in axes.iter().enumerate() {
                let place = direction.dot(&(vertex - face.origin));
                (low[axis], high[axis]) = (low[axis].min(place), high[axis].max(place));
            }
            for axis in 0..3 {
                let place = vertex[axis] as f32;
                (min[axis], max[axis]) = (min[axis].min(place), max[axis].max(place));
            }
        }
        let [along, across] = axes;
        let (normal, offset_m, origin) = (face.normal, face.offset_m, face.origin);
        let floor = Self::of_floor(None);
        Self { normal, offset_m, origin, along, across, low, high, min, max, endless: false, ..floor }
    }

    fn area(&self) -> f64 {
        (self.high[0] - self.low[0]) * (self.high[1] - self.low[1])
    }

    /// Gives cells to all sheets, and says how many there are.
    pub(super) fn lay_out(sheets: &mut [Self]) -> usize {
        let faces: f64 = sheets.iter().filter(|sheet| !sheet.endless).map(Self::area).sum();
        let mut first = 0;
        for sheet in sheets {
            let area = if sheet.endless { sheet.area() } else { faces };
            let cell_m = (area / MOST_CELLS).sqrt().max(CELL_M);
            let count = |axis: usize| {
                let cells = libm::ceil((sheet.high[axis] - sheet.low[axis]) / cell_m) as usize;
                cells.max(LEAST_CELLS)
            };
            (sheet.first, sheet.columns, sheet.rows, sheet.per_m) = (first, count(0), count(1), 1.0 / cell_m);
            first += sheet.columns * sheet.rows;
        }
        first
    }

    /// Where its cells stand among all.
    pub(super) fn range(&self) -> Range<usize> {
        self.first..self.first + self.columns * self.rows
    }

    /// Its cells among all.
    pub(super) fn cells<'a>(&self, all: &'a mut [u8]) -> Cells<'a> {
        Cells { all: &mut all[self.range()], drawn: Area::NONE, work: 0 }
    }

    /// Makes an area of some cells as it is in others.
    pub(super) fn restore(&self, area: &Area, cells: &mut [u8], from: &[u8]) {
        for row in area.first[1]..area.last[1] {
            let row = self.first + row * self.columns;
            let cells_of_row = row + area.first[0]..row + area.last[0];
            cells[cells_of_row.clone()].copy_from_slice(&from[cells_of_row]);
        }
    }

    /// Whether something within these bounds may stand between the surface and a sun.
    pub(super) fn may_be_shaded_by(&self, sun: &Vector3, min: &[f32; 3], max: &[f32; 3]) -> bool {
        sweep_meets(&self.min, &self.max, sun, min, max)
    }

    /// Looks which blocks of its cells are all alike.
    pub(super) fn survey(&mut self, all: &[u8]) {
        let cells = &all[self.range()];
        let per_row = self.columns.div_ceil(BLOCK);
        self.blocks.clear();
        for block in 0..per_row * self.rows.div_ceil(BLOCK) {
            let (left, top) = (block % per_row * BLOCK, block / per_row * BLOCK);
            let columns = left..self.columns.min(left + BLOCK);
            let mut rows = (top..self.rows.min(top + BLOCK)).map(|row| &cells[row * self.columns..][columns.clone()]);
            let first = cells[top * self.columns + left];
            let alike = matches!(first, 0 | u8::MAX) && rows.all(|row| row.iter().all(|cell| *cell == first));
            self.blocks.push(match (alike, first) {
                (false, _) => Common::Nothing,
                (true, 0) => Common::Sun,
                (true, _) => Common::Shade,
            });
        }
    }

    /// Whether all cells within a rectangle that holds two places lie in the shade, or all in the sun; nothing if that is not
    /// known. `changed` has been drawn on since the cells were surveyed.
    #[inline(always)]
    pub(super) fn same_between(&self, ends: &[[f32; 2]; 2], changed: Option<&Area>) -> Option<bool> {
        let (from, to) = (self.block_of(ends[0]), self.block_of(ends[1]));
        let (left, right) = (from[0].min(to[0]), from[0].max(to[0]));
        let (low, high) = (from[1].min(to[1]), from[1].max(to[1]));
        if (right - left + 1) * (high - low + 1) > MOST_BLOCKS
            || changed.is_some_and(|area| area.meets_blocks([left, low], [right, high]))
        {
            return None;
        }
        let per_row = self.columns.div_ceil(BLOCK);
        let common = *self.blocks.get(low * per_row + left)?;
        for row in low..=high {
            let blocks = self.blocks.get(row * per_row + left..=row * per_row + right)?;
            if blocks.iter().any(|block| *block != common) {
                return None;
            }
        }
        (common != Common::Nothing).then_some(common == Common::Shade)
    }

    #[inline(always)]
    fn block_of(&self, place: [f32; 2]) -> [usize; 2] {
        let per_m = self.per_m as f32;
        let block = |axis: usize, cells: usize| {
            let cell = ((place[axis] - self.low[axis] as f32) * per_m).max(0.0).min((cells - 1) as f32);
            whole_below(cell) as usize / BLOCK
        };
        [block(0, self.columns), block(1, self.rows)]
    }

    /// How many bits are set in the cells of places, metres along both axes.
    #[inline(always)]
    pub(super) fn read(&self, cells: &[u8], along: &[f32; BATCH], across: &[f32; BATCH], counts: &mut [u8; BATCH]) {
        let per_m = self.per_m as f32;
        let low = self.low.map(|low| low as f32);
        let (last_column, last_row) = ((self.columns - 1) as f32, (self.rows - 1) as f32);
        let columns = self.columns as u32;
        let mut indices = [0_u32; BATCH];
        for ((index, along), across) in indices.iter_mut().zip(along).zip(across) {
            let column = whole_below(((along - low[0]) * per_m).max(0.0).min(last_column));
            let row = whole_below(((across - low[1]) * per_m).max(0.0).min(last_row));
            *index = row * columns + column;
        }
        for (count, index) in counts.iter_mut().zip(indices) {
            *count = cells.get(index as usize).copied().unwrap_or(0);
        }
        for count in counts {
            *count = count.count_ones() as u8;
        }
    }
}

/// The whole number below a small positive one.
#[inline(always)]
fn whole_below(value: f32) -> u32 {
    let nearest = value + TO_WHOLE;
    (nearest.to_bits() & 0x003F_FFFF) - u32::from(nearest - TO_WHOLE > value)
}

impl Cells<'_> {
    /// Sets the bits in all cells.
    pub(super) fn fill(&mut self, bits: u8) {
        self.all.iter_mut().for_each(|cell| *cell |= bits);
    }

    /// Sets the bits in all cells whose middles lie within a convex polygon of points in the sheet's plane.
    pub(super) fn draw(&mut self, sheet: &Sheet, polygon: &mut [Vector3], bits: u8) {
        let edge = usize::from(sheet.endless);
        let (mut top, mut bottom) = (f64::INFINITY, f64::NEG_INFINITY);
        for point in polygon.iter_mut() {
            let from = *point - sheet.origin;
            let place = |axis: &Vector3, low: f64| (axis.dot(&from) - low) * sheet.per_m;
            let (x, y) = (place(&sheet.along, sheet.low[0]), place(&sheet.across, sheet.low[1]));
            (top, bottom) = (top.min(y), bottom.max(y));
            (point.x, point.y) = (x, y);
        }
        self.work += polygon.len() as u64;
        let within = |value: f64, count: usize| (value + 0.5).clamp(edge as f64, (count - edge) as f64) as usize;
        for row in within(top, sheet.rows)..within(bottom, sheet.rows) {
            let middle = row as f64 + 0.5;
            let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
            let mut from = polygon[polygon.len() - 1];
            for &to in polygon.iter() {
                if (from.y <= middle) != (to.y <= middle) {
                    let x = from.x + (to.x - from.x) * ((middle - from.y) / (to.y - from.y));
                    (left, right) = (left.min(x), right.max(x));
                }
                from = to;
            }
            let columns = within(left, sheet.columns)..within(right, sheet.columns);
            let base = row * sheet.columns;
            self.work += 2 + columns.len() as u64 / 16;
            if let Some(cells) = self.all.get_mut(base + columns.start..base + columns.end) {
                cells.iter_mut().for_each(|cell| *cell |= bits);
                self.drawn.hold(&columns, row);
            }
        }
    }
}

/// Whether the box from `from_min` to `from_max`, moved along `way` as far as you like, meets the other box.
pub(super) fn sweep_meets(
    from_min: &[f32; 3],
    from_max: &[f32; 3],
    way: &Vector3,
    min: &[f32; 3],
    max: &[f32; 3],
) -> bool {
    let (mut enter, mut leave) = (0.0_f32, f32::INFINITY);
    for axis in 0..3 {
        let speed = way[axis] as f32;
        // A hundredth of a millimetre and more, so that rounding never loses anything.
        let loose = 1e-5 * (1.0 + min[axis].abs().max(max[axis].abs()));
        let (near, far) = (min[axis] - from_max[axis] - loose, max[axis] - from_min[axis] + loose);
        if speed.abs() < 1e-6 {
            if near > 0.0 || far < 0.0 {
                return false;
            }
            continue;
        }
        let (first, last) = if speed > 0.0 { (near / speed, far / speed) } else { (far / speed, near / speed) };
        (enter, leave) = (enter.max(first), leave.min(last));
    }
    enter <= leave
}
