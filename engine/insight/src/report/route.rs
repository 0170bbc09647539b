//! A driven path: its colour shows the time, arrow heads the direction, crosses the failures.

use super::axes::Plot;
use super::canvas::{Spot, Tint, UNITS_PER_PX};
use super::sheet::{GREEN, PAPER, Sheet, VERMILION};
use engine::experiment::Trail;

const FIRST: Tint = Tint::hex(0x6cbcf0);
const LAST: Tint = Tint::hex(0x00324f);
/// Colours from the first to the last moment.
const SHADES: usize = 24;

/// The colour of a moment, 0 to 1.
pub(super) fn shade(share: f64) -> Tint {
    FIRST.towards(LAST, share.clamp(0.0, 1.0))
}

/// Every point of a path whose coordinates are finite.
pub(super) fn points(path: &Trail) -> impl Iterator<Item = [f64; 2]> {
    let all = path.legs.iter().flatten().chain(&path.failures).chain(&path.goals);
    all.filter(|at| at[0].is_finite() && at[1].is_finite()).map(|at| [f64::from(at[0]), f64::from(at[1])])
}

/// Draws the legs, where each starts, and the failures.
pub(super) fn draw_path(sheet: &mut Sheet, plot: &Plot, path: &Trail) {
    let total = path.legs.iter().map(Vec::len).sum::<usize>().max(1);
    let mut before = 0;
    for leg in &path.legs {
        leg_line(sheet, plot, leg, before, total);
        before += leg.len();
    }
    before = 0;
    for leg in &path.legs {
        leg_arrows(sheet, plot, leg, before, total);
        before += leg.len();
    }
    for (index, leg) in path.legs.iter().enumerate() {
        if let Some(start) = leg.first() {
            let at = place(plot, *start);
            // The first start is where the run began; the others follow a recovery.
            let radius_px = if index == 0 { 6.0 } else { 3.5 };
            sheet.disc(at, radius_px + 1.5, PAPER);
            sheet.disc(at, radius_px, LAST);
        }
    }
    for goal in &path.goals {
        draw_goal(sheet, place(plot, *goal));
    }
    for failure in &path.failures {
        sheet.cross(place(plot, *failure), 5.0, VERMILION);
    }
}

/// A ring: told from a start, which is full, and from a failure without its colour.
pub(super) fn draw_goal(sheet: &mut Sheet, at: Spot) {
    for (radius_px, tint) in [(7.5, PAPER), (6.5, GREEN), (3.5, PAPER)] {
        sheet.disc(at, radius_px, tint);
    }
}

/// Draws the legs in one colour, and small crosses where it failed.
pub(super) fn draw_thin(sheet: &mut Sheet, plot: &Plot, path: &Trail, ink: Tint) {
    for leg in &path.legs {
        sheet.line(leg.iter().map(|at| place(plot, *at)).collect(), 1.0, ink);
    }
    for failure in &path.failures {
        sheet.cross(place(plot, *failure), 3.0, VERMILION.thin(0.7));
    }
}

fn place(plot: &Plot, at: [f32; 2]) -> Spot {
    plot.at(f64::from(at[0]), f64::from(at[1]))
}

fn moment(index: usize, total: usize) -> usize {
    (index * SHADES / total).min(SHADES - 1)
}

/// One line for each colour; points closer than half a pixel to the one before are left out.
fn leg_line(sheet: &mut Sheet, plot: &Plot, leg: &[[f32; 2]], before: usize, total: usize) {
    let mut line: Vec<Spot> = Vec::new();
    let mut colour = moment(before, total);
    for (index, at) in leg.iter().enumerate() {
        let spot = place(plot, *at);
        let last = line.last().copied().unwrap_or((i32::MIN / 2, 0));
        let near = (spot.0 - last.0).abs().max((spot.1 - last.1).abs()) < UNITS_PER_PX / 2;
        if !near || index + 1 == leg.len() {
            line.push(spot);
        }
        let now = moment(before + index, total);
        if now != colour {
            stroke(sheet, std::mem::replace(&mut line, vec![spot]), colour);
            colour = now;
        }
    }
    stroke(sheet, line, colour);
}

fn stroke(sheet: &mut Sheet, line: Vec<Spot>, colour: usize) {
    sheet.line(line, 1.75, shade((colour as f64 + 0.5) / SHADES as f64));
}

/// An arrow head every 160 pixels of the path, at most ten in a leg.
fn leg_arrows(sheet: &mut Sheet, plot: &Plot, leg: &[[f32; 2]], before: usize, total: usize) {
    let apart = f64::from(160 * UNITS_PER_PX);
    let mut way = apart / 2.0;
    let mut drawn = 0;
    for (index, pair) in leg.windows(2).enumerate() {
        let (from, to) = (place(plot, pair[0]), place(plot, pair[1]));
        way += length(from, to);
        if way >= apart && from != to && drawn < 10 {
            let tail = place(plot, leg[index.saturating_sub(6)]);
            let colour = shade((moment(before + index, total) as f64 + 0.5) / SHADES as f64);
            arrow_head(sheet, if tail == to { from } else { tail }, to, 7.0, colour);
            way = 0.0;
            drawn += 1;
        }
    }
}

fn length(from: Spot, to: Spot) -> f64 {
    let (x, y) = (f64::from(to.0 - from.0), f64::from(to.1 - from.1));
    (x * x + y * y).sqrt()
}

/// A filled arrow head with its tip at `to`.
pub(super) fn arrow_head(sheet: &mut Sheet, from: Spot, to: Spot, long_px: f64, ink: Tint) {
    let way = length(from, to).max(1.0);
    let long = long_px * f64::from(UNITS_PER_PX);
    let (x, y) = (f64::from(to.0 - from.0) / way * long, f64::from(to.1 - from.1) / way * long);
    let corner = |back: f64, side: f64| {
        (to.0 - (x * back + y * side).round() as i32, to.1 - (y * back - x * side).round() as i32)
    };
    sheet.area(vec![corner(-0.35, 0.0), corner(0.8, 0.55), corner(0.5, 0.0), corner(0.8, -0.55)], ink);
}
