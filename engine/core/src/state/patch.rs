//! The largest patch of a mask: found by runs of its rows, joined where they touch.

/// A region smaller than this is noise, pixels.
const LEAST_PX: u32 = 4;

/// The largest 8-connected region of a mask; of equals the one whose first pixel, row by row, comes first.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Patch {
    /// Its pixels.
    pub pixels: u32,
    /// Sums of the columns and rows of its pixels.
    sum_x: u64,
    sum_y: u64,
    /// Its leftmost and rightmost column.
    pub columns: (u32, u32),
    /// Its first and last row.
    pub rows: (u32, u32),
}

impl Patch {
    /// Whether there is anything large enough.
    #[must_use]
    pub fn is_seen(&self) -> bool {
        self.pixels >= LEAST_PX
    }

    /// The mean of its pixels' middles, pixels from the image's top left corner.
    #[must_use]
    pub fn centre(&self) -> (f64, f64) {
        let mean = |sum: u64| sum as f64 / f64::from(self.pixels.max(1)) + 0.5;
        (mean(self.sum_x), mean(self.sum_y))
    }

    fn add(&mut self, run: &Run) {
        let (from, to, row) = (u64::from(run.from), u64::from(run.to), u64::from(run.row));
        let count = to - from;
        let empty = self.pixels == 0;
        self.pixels += count as u32;
        self.sum_x += (from + to - 1) * count / 2;
        self.sum_y += row * count;
        let join = |old: (u32, u32), new: (u32, u32)| if empty { new } else { (old.0.min(new.0), old.1.max(new.1)) };
        self.columns = join(self.columns, (run.from, run.to - 1));
        self.rows = join(self.rows, (run.row, run.row));
    }
}

/// Foreground pixels side by side in one row.
#[derive(Debug, Clone, Copy)]
struct Run {
    row: u32,
    from: u32,
    /// The first column after it.
    to: u32,
    /// A run that it touches, towards the first one of its region.
    parent: u32,
}

/// Finds patches in masks of one size; nothing is allocated after the first.
#[derive(Debug, Clone, Default)]
pub struct PatchFinder {
    runs: Vec<Run>,
    patches: Vec<Patch>,
}

impl PatchFinder {
    /// Room for any mask of this size.
    #[must_use]
    pub fn new(width_px: usize, height_px: usize) -> Self {
        let most = width_px.div_ceil(2) * height_px;
        Self { runs: Vec::with_capacity(most), patches: Vec::with_capacity(most) }
    }

    /// The largest patch of a mask, a byte for each pixel, row-major, foreground where it is not 0.
    pub fn find(&mut self, mask: &[u8], width_px: usize) -> Patch {
        self.runs.clear();
        let mut above = 0..0;
        for (row, pixels) in mask.chunks_exact(width_px.max(1)).enumerate() {
            let first = self.runs.len();
            self.scan(row as u32, pixels);
            self.join(above, first);
            above = first..self.runs.len();
        }
        self.largest()
    }

    fn scan(&mut self, row: u32, pixels: &[u8]) {
        let mut column = 0;
        while let Some(from) = next(pixels, column, true) {
            let to = next(pixels, from, false).unwrap_or(pixels.len());
            let parent = self.runs.len() as u32;
            self.runs.push(Run { row, from: from as u32, to: to as u32, parent });
            column = to;
        }
    }

    /// Joins the runs from `first` on with those of the row above that they touch, corners included.
    fn join(&mut self, above: std::ops::Range<usize>, first: usize) {
        let mut upper = above.start;
        for lower in first..self.runs.len() {
            let (from, to) = (self.runs[lower].from, self.runs[lower].to);
            while upper < above.end && self.runs[upper].to < from {
                upper += 1;
            }
            let mut touching = upper;
            while touching < above.end && self.runs[touching].from <= to {
                let (a, b) = (self.root(touching), self.root(lower));
                // The first run leads, so that the order of the patches is that of their first pixels.
                let (first, last) = (a.min(b), a.max(b));
                self.runs[last].parent = first as u32;
                touching += 1;
            }
        }
    }

    fn root(&mut self, mut run: usize) -> usize {
        while self.runs[run].parent as usize != run {
            let parent = self.runs[run].parent as usize;
            self.runs[run].parent = self.runs[parent].parent;
            run = parent;
        }
        run
    }

    fn largest(&mut self) -> Patch {
        self.patches.clear();
        self.patches.resize(self.runs.len(), Patch::default());
        for run in 0..self.runs.len() {
            let root = self.root(run);
            let found = self.runs[run];
            self.patches[root].add(&found);
        }
        let largest = |best: Patch, patch: &Patch| if patch.pixels > best.pixels { *patch } else { best };
        self.patches.iter().fold(Patch::default(), largest)
    }
}

/// The first pixel from `at` on that is foreground, or that is not. Eight at a time: most of a mask is alike.
fn next(pixels: &[u8], at: usize, foreground: bool) -> Option<usize> {
    const HIGH: u64 = 0x8080_8080_8080_8080;
    let (eights, rest) = pixels.get(at..)?.as_chunks::<8>();
    for (index, eight) in eights.iter().enumerate() {
        let word = u64::from_le_bytes(*eight);
        // The highest bit of each byte that is not 0: a carry out of the lower seven, or the bit itself.
        let lit = (((word & !HIGH) + !HIGH) | word) & HIGH;
        let found = if foreground { lit } else { !lit & HIGH };
        if found != 0 {
            return Some(at + 8 * index + found.trailing_zeros() as usize / 8);
        }
    }
    let found = rest.iter().position(|pixel| (*pixel != 0) == foreground)?;
    Some(at + 8 * eights.len() + found)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn find(rows: &[&str]) -> Patch {
        let mask: Vec<u8> = rows.concat().bytes().map(|c| if c == b'#' { 255 } else { 0 }).collect();
        PatchFinder::new(rows[0].len(), rows.len()).find(&mask, rows[0].len())
    }

    #[test]
    fn the_largest_region_is_found_with_its_centre_and_its_edges() {
        let patch = find(&["##....", "......", "..###.", "..###."]);
        assert_eq!((patch.pixels, patch.columns, patch.rows), (6, (2, 4), (2, 3)));
        // Columns 2 to 4 have their middles at 2.5 to 4.5, rows 2 and 3 at 2.5 and 3.5.
        assert_eq!(patch.centre(), (3.5, 3.0));
        assert!(patch.is_seen());
    }

    #[test]
    fn regions_that_touch_at_a_corner_or_further_down_are_one() {
        assert_eq!(find(&["#..", ".#.", "..#"]).pixels, 3);
        assert_eq!(find(&["#.#", "#.#", "###"]).pixels, 7);
        assert_eq!(find(&["#.#.#", "#.#.#", "..#..", "#####"]).pixels, 8);
    }

    #[test]
    fn of_equals_the_first_is_taken_and_less_than_four_pixels_are_nothing() {
        let patch = find(&["##..##", "##..##"]);
        assert_eq!((patch.pixels, patch.columns), (4, (0, 1)));
        assert!(!find(&["###"]).is_seen() && !find(&["..."]).is_seen());
    }

    #[test]
    fn regions_are_those_of_a_slow_flood() {
        let mut random = crate::random::Random::new(7, crate::random::Stream::Test);
        for _ in 0..200 {
            let (width, height) = (17, 11);
            // Any byte but 0 is foreground.
            let pixel =
                |random: &mut crate::random::Random| if random.below(100) < 45 { 1 + random.below(255) } else { 0 };
            let mask: Vec<u8> = (0..width * height).map(|_| pixel(&mut random) as u8).collect();
            let (mut seen, mut largest) = (vec![false; mask.len()], 0);
            for start in 0..mask.len() {
                let (mut next, mut count) = (vec![start], 0);
                while let Some(at) = next.pop() {
                    if mask[at] == 0 || std::mem::replace(&mut seen[at], true) {
                        continue;
                    }
                    count += 1;
                    let (x, y) = ((at % width) as i32, (at / width) as i32);
                    for (dx, dy) in [(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)] {
                        let (x, y) = (x + dx, y + dy);
                        if (0..width as i32).contains(&x) && (0..height as i32).contains(&y) {
                            next.push(y as usize * width + x as usize);
                        }
                    }
                }
                largest = largest.max(count);
            }
            assert_eq!(PatchFinder::new(width, height).find(&mask, width).pixels, largest);
        }
    }
}
