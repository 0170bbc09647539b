//! The learned table on one page: each state as a small grid, with the motion that the robot prefers there.

use super::canvas::{Spot, Tint, units};
use super::glyphs;
use super::picture::Picture;
use super::route::arrow_head;
use super::sheet::{
    BELOW_TITLE_PX, BLUE, FRAME, GRID, LegendEntry, MARGIN_PX, PAPER, QUIET, SMALL_PX, Sheet, TEXT, VERMILION, legend,
    spot, words,
};
use crate::words::three_figures;
use engine::diagnostic::Result;
use engine::geometry::Twist;

const WIDTH_PX: f64 = 1200.0;
/// States on a page, and in a row.
const MOST: usize = 64;
const ACROSS: usize = 8;
/// Fewer visits than these leave a state unsure.
const FEW_VISITS: u64 = 10;
const STEP_X_PX: f64 = (WIDTH_PX - 2.0 * MARGIN_PX) / ACROSS as f64;
const STEP_Y_PX: f64 = 106.0;
pub(super) const ICON_PX: f64 = 63.0;
/// The longest arrow, pixels.
const ARROW_PX: f64 = 46.0;

/// What the policy picture shows.
#[derive(Debug, Clone, Copy)]
pub struct PolicyData<'a> {
    /// The heading.
    pub title: &'a str,
    /// Rows of the grid.
    pub rows: usize,
    /// Columns of the grid.
    pub columns: usize,
    /// The states; of more than 64 the most visited are shown.
    pub states: &'a [PolicyState],
}

/// One state of the learned table.
#[derive(Debug, Clone, PartialEq)]
pub struct PolicyState {
    /// Its number.
    pub state: usize,
    /// Which cells are filled, row by row from the top left.
    pub cells: Vec<bool>,
    /// How often the robot was in it.
    pub visits: u64,
    /// The motion of its best action.
    pub best: Twist,
    /// The value of its best action.
    pub value: f64,
}

/// Draws up to 64 states in the order of their numbers; the more visits, the stronger. 1200 pixels wide.
///
/// # Errors
/// If the picture cannot be drawn or encoded.
pub fn policy(data: &PolicyData<'_>) -> Result<Picture> {
    let mut shown: Vec<&PolicyState> = data.states.iter().collect();
    shown.sort_by_key(|state| (std::cmp::Reverse(state.visits), state.state));
    shown.truncate(MOST);
    shown.sort_by_key(|state| state.state);
    let lines = shown.len().div_ceil(ACROSS).max(1);
    let top_px = BELOW_TITLE_PX + 64.0;
    let mut sheet = Sheet::new(WIDTH_PX, top_px + lines as f64 * STEP_Y_PX + MARGIN_PX / 2.0, data.title);
    let most = shown.iter().map(|state| state.visits).max().unwrap_or(0);
    let fastest = shown.iter().map(|state| state.best.linear_m_per_s.abs()).fold(1e-9, f64::max);
    for (index, state) in shown.iter().enumerate() {
        let x_px = MARGIN_PX + (index % ACROSS) as f64 * STEP_X_PX;
        let y_px = top_px + (index / ACROSS) as f64 * STEP_Y_PX;
        icon(&mut sheet, spot(x_px, y_px), (data.rows, data.columns), state, strength(state.visits, most));
        // A path backwards begins at the top, so that it does not run into the words.
        let foot_px = if state.best.linear_m_per_s < 0.0 { 8.0 } else { ICON_PX - 8.0 };
        motion(&mut sheet, spot(x_px + ICON_PX + 36.0, y_px + foot_px), state, fastest);
    }
    explain(&mut sheet);
    let unsure = shown.iter().filter(|state| state.visits < FEW_VISITS).count();
    sheet.finish(&format!("Best action of {} states, of which {unsure} were met too seldom to be sure", shown.len()))
}

/// How strongly a state is drawn, 0 to 1: by the order of magnitude of its visits.
pub(super) fn strength(visits: u64, most: u64) -> f64 {
    if visits == 0 { 0.0 } else { 0.25 + 0.75 * libm::log1p(visits as f64) / libm::log1p(most as f64) }
}

pub(super) fn icon(sheet: &mut Sheet, min: Spot, (rows, columns): (usize, usize), state: &PolicyState, strength: f64) {
    let max = (min.0 + units(ICON_PX), min.1 + units(ICON_PX));
    let x = |column: usize| min.0 + units(ICON_PX * column as f64 / columns.max(1) as f64);
    let y = |row: usize| min.1 + units(ICON_PX * row as f64 / rows.max(1) as f64);
    let ink = if state.visits == 0 { GRID } else { PAPER.towards(BLUE, strength) };
    for (cell, _) in state.cells.iter().enumerate().take(rows * columns).filter(|(_, filled)| **filled) {
        let (row, column) = (cell / columns, cell % columns);
        sheet.rect((x(column), y(row)), (x(column + 1), y(row + 1)), ink);
    }
    if rows.max(columns) <= 12 {
        let line = FRAME.towards(PAPER, 0.55);
        for column in 1..columns {
            sheet.line(vec![(x(column), min.1), (x(column), max.1)], 1.0, line);
        }
        for row in 1..rows {
            sheet.line(vec![(min.0, y(row)), (max.0, y(row))], 1.0, line);
        }
    }
    if state.visits < FEW_VISITS {
        hatch(sheet, min, max, units(9.0));
    }
    sheet.border(min, max, if state.visits == 0 { FRAME.towards(PAPER, 0.5) } else { FRAME });
    let name = if state.visits == 0 { QUIET } else { TEXT };
    let number = words(&state.state.to_string(), (min.0, max.1 + units(13.0)), SMALL_PX, name);
    let after = (glyphs::width(&number.words, number.em, false) + units(10.0)).max(units(30.0));
    let below = if state.visits == 0 { "not seen".to_owned() } else { three_figures(state.value) };
    sheet.text(words(&below, (min.0 + after, number.at.1), SMALL_PX, QUIET));
    sheet.text(number);
}

/// Slanting lines over a rectangle: what is there is not sure.
fn hatch(sheet: &mut Sheet, min: Spot, max: Spot, apart: i32) {
    let (wide, high) = (max.0 - min.0, max.1 - min.1);
    for from in (apart..wide + high).step_by(apart.max(1) as usize) {
        let (low, end) = ((from - high).max(0), from.min(wide));
        let line = vec![(min.0 + low, min.1 + from - low), (min.0 + end, min.1 + from - end)];
        sheet.line(line, 1.0, PAPER);
        sheet.line(
            vec![(min.0 + low, min.1 + from - low + 4), (min.0 + end, min.1 + from - end + 4)],
            1.0,
            FRAME.thin(0.6),
        );
    }
}

/// The path that the robot would take in some time, upwards from `foot`: the length shows the speed, the bend the turn.
pub(super) fn motion(sheet: &mut Sheet, foot: Spot, state: &PolicyState, fastest: f64) {
    let ink = match state {
        PolicyState { visits: 0, .. } => return,
        PolicyState { visits, .. } if *visits < FEW_VISITS => FRAME,
        PolicyState { best, .. } if best.linear_m_per_s < 0.0 => VERMILION,
        _ => TEXT,
    };
    let Twist { linear_m_per_s: speed, angular_rad_per_s: turn } = state.best;
    // Two seconds show the usual turns of wheeled robots as clear bends without closing a circle.
    let bend = (turn * 2.0).clamp(-2.8, 2.8);
    if speed.abs() < 1e-6 * fastest {
        return spin(sheet, foot, bend, ink);
    }
    let long = speed / fastest * ARROW_PX;
    let mut way = vec![foot];
    let (mut x, mut y) = (0.0, 0.0);
    for part in 0..24 {
        let heading = bend * (f64::from(part) + 0.5) / 24.0;
        x -= libm::sin(heading) * long / 24.0;
        y -= libm::cos(heading) * long / 24.0;
        way.push((foot.0 + units(x), foot.1 + units(y)));
    }
    finish_arrow(sheet, foot, way, ink);
}

/// A turn on the spot: an arc around it.
fn spin(sheet: &mut Sheet, foot: Spot, bend: f64, ink: Tint) {
    let centre = (foot.0, foot.1 - units(20.0));
    if bend == 0.0 {
        return sheet.disc(centre, 4.0, ink);
    }
    let way = (0..=24).map(|part| {
        let angle = bend.signum() * 4.2 * f64::from(part) / 24.0;
        (centre.0 - units(13.0 * libm::sin(angle)), centre.1 - units(13.0 * libm::cos(angle)))
    });
    finish_arrow(sheet, centre, way.collect(), ink);
}

fn finish_arrow(sheet: &mut Sheet, foot: Spot, way: Vec<Spot>, ink: Tint) {
    if let [.., before, _, tip] = way[..] {
        sheet.line(way, 2.0, ink);
        sheet.disc(foot, 3.0, ink);
        arrow_head(sheet, before, tip, 9.0, ink);
    }
}

fn explain(sheet: &mut Sheet) {
    let end = spot(WIDTH_PX - MARGIN_PX, BELOW_TITLE_PX + 6.0);
    let shades = |sheet: &mut Sheet, from: Spot, to: Spot| {
        for part in 0..4 {
            let x = |part: i32| from.0 + (to.0 - from.0) * part / 4;
            sheet.rect((x(part), from.1), (x(part + 1), to.1), PAPER.towards(BLUE, 0.25 + 0.25 * f64::from(part)));
        }
    };
    let arrow = |sheet: &mut Sheet, from: Spot, to: Spot| {
        let y = (from.1 + to.1) / 2;
        let way = (0..=4).map(|part| (from.0 + (to.0 - from.0 - units(4.0)) * part / 4, y)).collect();
        finish_arrow(sheet, (from.0, y), way, TEXT);
    };
    let entries = [
        LegendEntry { sign: &arrow, words: "best action: length is speed, bend is turn, orange is backwards" },
        LegendEntry { sign: &shades, words: "filled cells, stronger with more visits" },
    ];
    legend(sheet, end, &entries);
    explain_unsure(sheet, (end.0, end.1 + units(24.0)));
    sheet.text(words("below each: state and value", spot(MARGIN_PX, BELOW_TITLE_PX + 6.0), SMALL_PX, QUIET));
}

/// The line of a legend that ends at `end` and says what hatching means.
pub(super) fn explain_unsure(sheet: &mut Sheet, end: Spot) {
    let unsure = |sheet: &mut Sheet, from: Spot, to: Spot| {
        sheet.rect(from, to, PAPER.towards(BLUE, 0.4));
        hatch(sheet, from, to, units(6.0));
    };
    let said = format!("hatched, pale arrow: met fewer than {FEW_VISITS} times, unsure");
    legend(sheet, end, &[LegendEntry { sign: &unsure, words: &said }]);
}
