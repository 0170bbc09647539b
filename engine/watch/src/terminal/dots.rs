//! A drawing of dots, two by four in each cell of the terminal, so that one metre is as long in x as in y.

use ratatui_core::buffer::Buffer;
use ratatui_core::layout::Rect;
use ratatui_core::style::Style;

/// Beyond so many dots nothing is drawn.
const FAR: f64 = 20_000.0;

/// How a mark stands to others in its cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Rank {
    /// Areas: they make way for everything else.
    Area,
    /// What stands.
    Ground,
    /// What matters less than a line.
    Behind,
    /// Lines.
    Line,
    /// What the eye should find.
    Front,
}

#[derive(Clone)]
struct Cell {
    bits: u8,
    rank: Rank,
    style: Style,
}

/// The drawing.
pub(super) struct Dots {
    columns: usize,
    rows: usize,
    cells: Vec<Cell>,
}

/// A place, in dots from the top left.
pub(super) type Dot = (f64, f64);

impl Dots {
    /// An empty drawing for so many cells.
    pub(super) fn new(columns: u16, rows: u16) -> Self {
        let empty = Cell { bits: 0, rank: Rank::Area, style: Style::new() };
        let (columns, rows) = (usize::from(columns), usize::from(rows));
        Self { columns, rows, cells: vec![empty; columns * rows] }
    }

    /// Width and height in dots.
    pub(super) fn size(&self) -> (f64, f64) {
        (2.0 * self.columns as f64, 4.0 * self.rows as f64)
    }

    /// One dot; outside nothing happens.
    pub(super) fn dot(&mut self, (x, y): Dot, rank: Rank, style: Style) {
        if !(x >= 0.0 && y >= 0.0 && x < 2.0 * self.columns as f64 && y < 4.0 * self.rows as f64) {
            return;
        }
        let (x, y) = (x as usize, y as usize);
        let cell = &mut self.cells[y / 4 * self.columns + x / 2];
        if cell.bits != 0 && rank < cell.rank {
            // Two lines in a cell have one colour: the upper one's.
            if rank != Rank::Area {
                cell.bits |= bit(x, y);
            }
            return;
        }
        if cell.rank == Rank::Area && rank != Rank::Area {
            cell.bits = 0;
        }
        (cell.rank, cell.style) = (rank, style);
        cell.bits |= bit(x, y);
    }

    /// A straight line; of a dashed one, `dash` dots are drawn and as many left out.
    pub(super) fn line(&mut self, from: Dot, to: Dot, dash: Option<usize>, rank: Rank, style: Style) {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let steps = dx.abs().max(dy.abs()).ceil();
        if steps.is_nan() || steps > FAR {
            return;
        }
        for step in 0..=steps as usize {
            if dash.is_some_and(|dash| step / dash % 2 == 1) {
                continue;
            }
            let share = if steps > 0.0 { step as f64 / steps } else { 0.0 };
            self.dot((from.0 + dx * share, from.1 + dy * share), rank, style);
        }
    }

    /// Lines from each place to the next.
    pub(super) fn path(&mut self, places: &[Dot], dash: Option<usize>, rank: Rank, style: Style) {
        for pair in places.windows(2) {
            self.line(pair[0], pair[1], dash, rank, style);
        }
    }

    /// The inside of a polygon: every dot, or one of so many in each direction.
    pub(super) fn fill(&mut self, corners: &[Dot], every: usize, rank: Rank, style: Style) {
        let (width, height) = self.size();
        let low = corners.iter().fold(f64::MAX, |low, corner| low.min(corner.1)).max(0.0);
        let high = corners.iter().fold(f64::MIN, |high, corner| high.max(corner.1)).min(height);
        for y in (low as usize..(high.max(0.0).ceil()) as usize).filter(|y| y.is_multiple_of(every)) {
            let middle = y as f64 + 0.5;
            let mut cuts: Vec<f64> = edges(corners)
                .filter(|(a, b)| (a.1 <= middle) != (b.1 <= middle))
                .map(|(a, b)| a.0 + (middle - a.1) / (b.1 - a.1) * (b.0 - a.0))
                .collect();
            cuts.sort_by(f64::total_cmp);
            for pair in cuts.chunks_exact(2) {
                let (from, to) = (pair[0].clamp(0.0, width) as usize, pair[1].clamp(0.0, width).ceil() as usize);
                // Every second row is shifted, so that no columns are seen in sparse areas.
                let shift = (y / every) % 2 * (every / 2);
                for x in (from..to).filter(|x| (x + shift).is_multiple_of(every)) {
                    self.dot((x as f64, y as f64), rank, style);
                }
            }
        }
    }

    /// The outline of a polygon.
    pub(super) fn outline(&mut self, corners: &[Dot], dash: Option<usize>, rank: Rank, style: Style) {
        for (from, to) in edges(corners) {
            self.line(from, to, dash, rank, style);
        }
    }

    /// Writes the drawing into a screen; as half blocks where the font has no fine dots.
    pub(super) fn draw(&self, area: Rect, buffer: &mut Buffer, fine: bool) {
        for (index, cell) in self.cells.iter().enumerate().filter(|(_, cell)| cell.bits != 0) {
            let (x, y) = (area.x + (index % self.columns) as u16, area.y + (index / self.columns) as u16);
            if let Some(on_screen) = buffer.cell_mut((x, y)) {
                on_screen.set_char(glyph(cell.bits, fine)).set_style(cell.style);
            }
        }
    }
}

fn edges(corners: &[Dot]) -> impl Iterator<Item = (Dot, Dot)> + '_ {
    (0..corners.len()).map(|index| (corners[index], corners[(index + 1) % corners.len()]))
}

/// The bit of a dot in its cell, as Unicode numbers them.
fn bit(x: usize, y: usize) -> u8 {
    const BITS: [[u8; 4]; 2] = [[0x01, 0x02, 0x04, 0x40], [0x08, 0x10, 0x20, 0x80]];
    BITS[x % 2][y % 4]
}

fn glyph(bits: u8, fine: bool) -> char {
    let (upper, lower) = (bits & 0x1b != 0, bits & 0xe4 != 0);
    match (upper, lower) {
        _ if fine => char::from_u32(0x2800 + u32::from(bits)).unwrap_or(' '),
        (true, true) => '█',
        (true, false) => '▀',
        (false, true) => '▄',
        (false, false) => ' ',
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(dots: &Dots, fine: bool) -> Vec<String> {
        let area = Rect::new(0, 0, dots.columns as u16, dots.rows as u16);
        let mut buffer = Buffer::empty(area);
        dots.draw(area, &mut buffer, fine);
        (0..area.height).map(|y| (0..area.width).map(|x| buffer[(x, y)].symbol()).collect()).collect()
    }

    #[test]
    fn a_line_is_dots_and_half_blocks_where_there_are_none() {
        let mut dots = Dots::new(2, 1);
        dots.line((0.0, 0.0), (3.0, 0.0), None, Rank::Line, Style::new());
        assert_eq!((drawn(&dots, true), drawn(&dots, false)), (vec!["⠉⠉".to_owned()], vec!["▀▀".to_owned()]));
    }

    #[test]
    fn an_area_makes_way_for_a_line() {
        let mut dots = Dots::new(1, 1);
        dots.fill(&[(0.0, 0.0), (2.0, 0.0), (2.0, 4.0), (0.0, 4.0)], 1, Rank::Area, Style::new());
        assert_eq!(drawn(&dots, true), ["⣿"]);
        dots.dot((0.0, 0.0), Rank::Line, Style::new());
        dots.dot((1.0, 3.0), Rank::Area, Style::new());
        assert_eq!(drawn(&dots, true), ["⠁"]);
    }

    #[test]
    fn nothing_is_drawn_outside_or_where_there_is_no_place() {
        let mut dots = Dots::new(1, 1);
        dots.dot((-0.1, 0.0), Rank::Line, Style::new());
        dots.dot((f64::NAN, 0.0), Rank::Line, Style::new());
        dots.line((0.0, 0.0), (f64::INFINITY, 0.0), None, Rank::Line, Style::new());
        dots.line((-1e12, 0.0), (1e12, 0.0), None, Rank::Line, Style::new());
        assert_eq!(drawn(&dots, true), [" "]);
    }
}
