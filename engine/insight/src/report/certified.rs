//! A certificate as a picture: how often it fails in each world, from the best to the worst, and the worst worlds with the path there.

use super::axes::{Axis, BELOW_PX, Plot, axes};
use super::canvas::{Spot, units};
use super::picture::Picture;
use super::plan::WorldPlan;
use super::route;
use super::sheet::{
    BELOW_TITLE_PX, BLUE, FRAME, LABEL_PX, LegendEntry, MARGIN_PX, QUIET, SKY, SMALL_PX, Sheet, TEXT, VERMILION,
    centred, fitted, legend, spot, words,
};
use super::trajectory::{FloorPlan, LEFT_PX};
use engine::diagnostic::Result;
use engine::experiment::{Certificate, CertifiedRate, Trail};

const WIDTH_PX: f64 = 1400.0;
const PLOT_PX: f64 = 300.0;
/// Room for the lines of the statement.
const LINE_PX: f64 = 24.0;
/// The most worlds that are drawn.
pub(crate) const MOST_PANELS: usize = 4;
const GAP_PX: f64 = 24.0;
const PANEL_PX: f64 = 300.0;

/// What the picture of a certificate shows.
pub struct CertifiedData<'a> {
    /// The heading.
    pub title: &'a str,
    /// The statement in a few lines.
    pub lines: &'a [String],
    /// The figures.
    pub certificate: &'a Certificate,
    /// Of the worst draws, the worst first: a name, the world, and the path of the first steps; the first four are drawn.
    pub worst: &'a [(String, WorldPlan<'a>, &'a Trail)],
}

/// Draws the curve over the draws, and below it the worst ones. 1400 pixels wide.
///
/// # Errors
/// If the picture cannot be drawn or encoded.
pub fn certified(data: &CertifiedData<'_>) -> Result<Picture> {
    let plot_top_px = BELOW_TITLE_PX + data.lines.len() as f64 * LINE_PX + 12.0;
    let legend_px = plot_top_px + PLOT_PX + BELOW_PX + 26.0;
    let heading_px = legend_px + 44.0;
    let panels_px = heading_px + 32.0;
    let height_px = if data.worst.is_empty() { legend_px + 24.0 } else { panels_px + PANEL_PX + 24.0 };
    let mut sheet = Sheet::new(WIDTH_PX, height_px, data.title);
    for (line, text) in data.lines.iter().enumerate() {
        let at = spot(MARGIN_PX, BELOW_TITLE_PX + line as f64 * LINE_PX);
        sheet.text(fitted(words(text, at, LABEL_PX, TEXT), units(WIDTH_PX - 2.0 * MARGIN_PX)));
    }
    curve(&mut sheet, data.certificate, plot_top_px);
    explain(&mut sheet, legend_px);
    if !data.worst.is_empty() {
        let heading = "The worst, with the path of the first 800 steps";
        sheet.text(words(heading, spot(MARGIN_PX, heading_px), LABEL_PX, TEXT));
    }
    for (index, (name, world, path)) in data.worst.iter().take(MOST_PANELS).enumerate() {
        panel(&mut sheet, index, panels_px, name, world, path);
    }
    sheet.finish(&data.lines.join(" "))
}

/// Failures in 1,000 steps over the draws in their order, as steps of a stair, in the band of the interval.
fn curve(sheet: &mut Sheet, certificate: &Certificate, top_px: f64) {
    let Certificate { spread, untrained_spread, failures, steps, draws, .. } = certificate;
    let per_1000 = |failures: u64| 1000.0 * failures as f64 / (*steps).max(1) as f64;
    let worst = spread.last().map_or(0.0, |[failures, _]| per_1000(*failures));
    let high = 1.05 * worst.max(failures.high).max(certificate.aim.map_or(0.0, |aim| aim.per_1000)).max(0.1);
    let (min, max) = (spot(MARGIN_PX + LEFT_PX, top_px), spot(WIDTH_PX - MARGIN_PX, top_px + PLOT_PX));
    let share = if certificate.each_its_own_world { "worlds" } else { "draws" };
    let x = Axis {
        title: format!("{share}, from the best to the worst (%)"),
        low: 0.0,
        high: 100.0,
        room_px: BELOW_PX,
        ticks: 10,
    };
    let y = Axis { title: "failures in 1,000 steps".to_owned(), low: 0.0, high, room_px: LEFT_PX, ticks: 6 };
    let plot = axes(sheet, min, max, &x, &y);
    let CertifiedRate { low, high: above, .. } = *failures;
    sheet.rect(plot.at(0.0, above), plot.at(100.0, low), SKY.thin(0.35));
    let level = |sheet: &mut Sheet, at: f64, ink| sheet.line(vec![plot.at(0.0, at), plot.at(100.0, at)], 1.5, ink);
    level(sheet, failures.per_1000, SKY);
    if let Some(aim) = certificate.aim {
        level(sheet, aim.per_1000, TEXT);
    }
    let stair = |spread: &[[u64; 2]]| {
        let mut done = 0;
        let spots = spread.iter().flat_map(|[failures, count]| {
            let from = 100.0 * done as f64 / (*draws).max(1) as f64;
            done += count;
            [(from, per_1000(*failures)), (100.0 * done as f64 / (*draws).max(1) as f64, per_1000(*failures))]
        });
        // What is above the plot is not drawn.
        spots.filter(|(_, at)| *at <= high).map(|(share, at)| plot.at(share, at)).collect::<Vec<Spot>>()
    };
    sheet.line(stair(untrained_spread), 2.0, VERMILION);
    sheet.line(stair(spread), 3.0, BLUE);
}

fn explain(sheet: &mut Sheet, at_px: f64) {
    let line = |ink, width_px| {
        move |sheet: &mut Sheet, from: Spot, to: Spot| {
            let y = (from.1 + to.1) / 2;
            sheet.line(vec![(from.0, y), (to.0, y)], width_px, ink);
        }
    };
    let band = |sheet: &mut Sheet, from: Spot, to: Spot| sheet.rect(from, to, SKY.thin(0.35));
    let (policy, untrained) = (line(BLUE, 3.0), line(VERMILION, 2.0));
    let entries = [
        LegendEntry { sign: &policy, words: "the policy" },
        LegendEntry { sign: &untrained, words: "a robot that knows nothing, as far as it is within the picture" },
        LegendEntry { sign: &band, words: "the mean over all such worlds, 95 %" },
    ];
    legend(sheet, spot(WIDTH_PX - MARGIN_PX, at_px), &entries);
}

/// One of the worst draws: its world from above, and the path.
fn panel(sheet: &mut Sheet, index: usize, top_px: f64, name: &str, world: &WorldPlan<'_>, path: &Trail) {
    let room_px = (WIDTH_PX - 2.0 * MARGIN_PX - (MOST_PANELS - 1) as f64 * GAP_PX) / MOST_PANELS as f64;
    let left_px = MARGIN_PX + index as f64 * (room_px + GAP_PX);
    let middle = spot(left_px + 0.5 * room_px, top_px);
    sheet.text(fitted(centred(words(name, middle, SMALL_PX, QUIET)), units(room_px)));
    let floor = FloorPlan::around(world, route::points(path));
    let (width_px, height_px) = floor.fit(room_px, PANEL_PX - 30.0);
    let min = spot(left_px + 0.5 * (room_px - width_px), top_px + 18.0);
    let max = (min.0 + units(width_px), min.1 + units(height_px));
    sheet.rect(min, max, world.floor());
    let plot: Plot = floor.bare(min, max);
    world.draw(sheet, &plot);
    route::draw_path(sheet, &plot, path);
    sheet.border(min, max, FRAME);
}
