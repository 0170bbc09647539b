//! The learning curve: reinforcement in each window of steps, for one run or for many.

use super::axes::{Axis, BELOW_PX, Plot, axes, range};
use super::canvas::{Align, Spot, Text};
use super::picture::Picture;
use super::sheet::{
    BELOW_TITLE_PX, BLUE, LegendEntry, MARGIN_PX, PAPER, SKY, SMALL_PX, Sheet, VERMILION, legend, spot, words,
};
use crate::words::spaced;
use engine::diagnostic::Result;
use engine::stats::Sorted;

pub(super) const WIDTH_PX: f64 = 1200.0;
pub(super) const HEIGHT_PX: f64 = 700.0;
/// Right end of the plot and of the legend.
const END_PX: f64 = WIDTH_PX - 40.0;
/// Room for six digits and the title beside them.
const LEFT_PX: f64 = 84.0;

/// What the learning curve shows.
#[derive(Debug, Clone, Copy)]
pub struct CurveData<'a> {
    /// The heading.
    pub title: &'a str,
    /// Length of a window, steps.
    pub window_steps: u64,
    /// For each run, the sum of rewards in each window, oldest first.
    pub curves: &'a [Vec<f64>],
    /// The step at which learning succeeded; the median for many runs.
    pub learned_at: Option<u64>,
}

/// Draws one run as a line, many as their median and quartiles with each run faintly behind. 1200 x 700 pixels.
///
/// # Errors
/// If the picture cannot be drawn or encoded.
pub fn learning_curve(data: &CurveData<'_>) -> Result<Picture> {
    let mut sheet = Sheet::new(WIDTH_PX, HEIGHT_PX, data.title);
    let plot = frame(&mut sheet, data);
    let place = |window: usize, value: f64| plot.at((window as f64 + 1.0) * data.window_steps as f64, value);
    if let [curve] = data.curves {
        stroke(&mut sheet, curve.iter().copied(), place, 2.0, BLUE);
    } else {
        let bands = quartiles(data.curves);
        let edge = |part: usize| bands.iter().enumerate().map(move |(window, band)| (window, band[part]));
        let outline = edge(0).chain(edge(2).rev()).filter(|(_, value)| value.is_finite());
        for curve in data.curves {
            stroke(&mut sheet, curve.iter().copied(), place, 1.0, SKY.towards(PAPER, 0.6));
        }
        sheet.area(outline.map(|(window, value)| place(window, value)).collect(), BLUE.thin(0.22));
        stroke(&mut sheet, bands.iter().map(|band| band[1]), place, 3.0, BLUE);
        explain(&mut sheet, data.curves.len());
    }
    if let Some(step) = data.learned_at {
        mark_learned(&mut sheet, &plot, step, data.curves.len() > 1);
    }
    sheet.finish(&shows(data))
}

fn shows(data: &CurveData<'_>) -> String {
    let windows = data.curves.iter().map(Vec::len).max().unwrap_or(0);
    let (runs, steps) = (data.curves.len(), data.window_steps);
    let learned = data.learned_at.map_or(String::new(), |step| format!(", learned at step {step}"));
    format!("Reinforcement per {steps} steps over {windows} windows, runs: {runs}{learned}")
}

pub(super) fn frame(sheet: &mut Sheet, data: &CurveData<'_>) -> Plot {
    let windows = data.curves.iter().map(Vec::len).max().unwrap_or(0);
    let last = (windows as f64 * data.window_steps as f64).max(data.learned_at.unwrap_or(0) as f64);
    let (low, high) = range(data.curves.iter().flatten().copied());
    let room = 0.05 * (high - low);
    // Zero is the natural end of a scale of punishments or rewards when the values come near it.
    let high = if high <= 0.0 && high + (high - low) * 0.5 >= 0.0 { 0.0 } else { high + room };
    let low = if low >= 0.0 && low - (high - low) * 0.5 <= 0.0 { 0.0 } else { low - room };
    let x = Axis { title: "step".to_owned(), low: 0.0, high: last.max(1.0), room_px: BELOW_PX, ticks: 9 };
    let windows = spaced(data.window_steps as f64, 0);
    let y = Axis { title: format!("reinforcement per {windows} steps"), low, high, room_px: LEFT_PX, ticks: 8 };
    let min = spot(MARGIN_PX + LEFT_PX, BELOW_TITLE_PX + 22.0);
    axes(sheet, min, spot(END_PX, HEIGHT_PX - MARGIN_PX / 2.0 - BELOW_PX), &x, &y)
}

/// Draws values as a line that is broken where one is not finite; a lone value is a dot.
fn stroke(
    sheet: &mut Sheet,
    values: impl Iterator<Item = f64>,
    place: impl Fn(usize, f64) -> Spot,
    width_px: f64,
    ink: super::canvas::Tint,
) {
    let mut line = Vec::new();
    let mut end = |line: &mut Vec<Spot>| match std::mem::take(line)[..] {
        [alone] => sheet.disc(alone, width_px + 1.0, ink),
        ref many => sheet.line(many.to_vec(), width_px, ink),
    };
    for (window, value) in values.enumerate() {
        if value.is_finite() {
            line.push(place(window, value));
        } else {
            end(&mut line);
        }
    }
    end(&mut line);
}

/// Lower quartile, median and upper quartile of each window, over the runs that reached it; NaN where none did.
pub(super) fn quartiles(curves: &[Vec<f64>]) -> Vec<[f64; 3]> {
    let windows = curves.iter().map(Vec::len).max().unwrap_or(0);
    let bands = (0..windows).map(|window| {
        let values = curves.iter().filter_map(|curve| curve.get(window).copied());
        let values: Sorted = values.filter(|value| value.is_finite()).collect();
        [0.25, 0.5, 0.75].map(|share| values.quantile(share).unwrap_or(f64::NAN))
    });
    bands.collect()
}

fn explain(sheet: &mut Sheet, runs: usize) {
    let level = |from: Spot, to: Spot| vec![(from.0, (from.1 + to.1) / 2), (to.0, (from.1 + to.1) / 2)];
    let median = format!("median of {runs} runs");
    legend(
        sheet,
        spot(END_PX, BELOW_TITLE_PX + 4.0),
        &[
            LegendEntry { sign: &|sheet: &mut Sheet, from, to| sheet.line(level(from, to), 3.0, BLUE), words: &median },
            LegendEntry {
                sign: &|sheet: &mut Sheet, from, to| sheet.rect(from, to, BLUE.thin(0.22)),
                words: "quartiles",
            },
            LegendEntry {
                sign: &|sheet: &mut Sheet, from, to| sheet.line(level(from, to), 1.0, SKY.towards(PAPER, 0.6)),
                words: "each run",
            },
        ],
    );
}

fn mark_learned(sheet: &mut Sheet, plot: &Plot, step: u64, many: bool) {
    let (x, _) = plot.at(step as f64, 0.0);
    sheet.line(vec![(x, plot.min.1), (x, plot.max.1)], 1.5, VERMILION);
    let kind = if many { "learned (median)" } else { "learned" };
    // A rising curve leaves the lower right empty.
    let right = x < plot.min.0 + (plot.max.0 - plot.min.0) * 3 / 4;
    let away = if right { 40 } else { -40 };
    let text =
        words(&format!("{kind}: step {}", spaced(step as f64, 0)), (x + away, plot.max.1 - 80), SMALL_PX, VERMILION);
    sheet.text(Text { along: if right { Align::Start } else { Align::End }, ..text });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quartiles_are_taken_over_the_runs_that_reached_a_window() {
        let curves = [vec![1.0, 7.0], vec![2.0], vec![3.0], vec![4.0], vec![5.0]];
        assert_eq!(quartiles(&curves), [[2.0, 3.0, 4.0], [7.0, 7.0, 7.0]]);
    }
}
