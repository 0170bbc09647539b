//! The learning curve: the median of all seeds in its band, the shown seed, the median of the save before behind them.

use ratatui_core::buffer::Buffer;
use ratatui_core::layout::Rect;
use ratatui_core::text::{Line, Span};

use super::dots::{Dot, Dots, Rank};
use super::ink::TerminalInk;
use super::lines::{heading, nothing, write};
use super::view::View;
use super::words::{columns, ticks};
use engine::experiment::Phase;
use engine::stats::Sorted;
use insight::words::{typeset, whole};

/// The shares of the seeds below and above the band.
const BAND: [f64; 2] = [0.1, 0.9];
/// Columns of the numbers at the left.
const LEFT: u16 = 6;

struct Axes {
    low: f64,
    high: f64,
    windows: usize,
    width: f64,
    height: f64,
}

impl Axes {
    fn x(&self, window: usize) -> f64 {
        (window + 1) as f64 / self.windows as f64 * (self.width - 1.0)
    }

    fn y(&self, value: f64) -> f64 {
        (self.high - value) / (self.high - self.low) * (self.height - 1.0)
    }

    fn path(&self, values: &[f64]) -> Vec<Dot> {
        values.iter().enumerate().map(|(window, value)| (self.x(window), self.y(*value))).collect()
    }
}

pub(super) fn draw_curve(view: &View, area: Rect, buffer: &mut Buffer) {
    let (Some(shown), Some(document)) = (&view.shown.run, view.document()) else { return };
    let unit = Span::styled(format!("reward per {} steps", document.window_steps), TerminalInk::quiet());
    let inner = heading("Learning curve", vec![unit], area, buffer);
    let curves: Vec<Vec<f64>> = shown.run.seeds.iter().map(|seed| seed.curve()).collect();
    let before: &[Vec<f64>] = shown.before.as_deref().unwrap_or_default();
    let values = || curves.iter().chain(before).flatten().copied();
    if inner.height < 4 || values().next().is_none() {
        let combined = "nothing was learned: policies are combined";
        nothing(if inner.height < 4 { "no room for the curve" } else { combined }, inner, buffer);
        return;
    }
    let longest = curves.iter().chain(before).map(Vec::len).max().unwrap_or(1);
    let planned = document.planned_steps.div_ceil(document.window_steps) as usize;
    let (low, high) = (values().fold(0.0, f64::min), values().fold(0.0, f64::max));
    let room = if high > low { 0.05 * (high - low) } else { 0.5 };
    let plot =
        Rect { x: inner.x + LEFT, width: inner.width.saturating_sub(LEFT + 1), height: inner.height - 2, ..inner };
    let mut dots = Dots::new(plot.width, plot.height);
    let (width, height) = dots.size();
    let axes = Axes { low: low - room, high: high + room, windows: longest.max(planned).max(1), width, height };
    label_y(&axes, plot, buffer, &mut dots);
    lines(view, &axes, &curves, before, &mut dots);
    let steps = axes.windows as f64 * document.window_steps as f64;
    for swap in &document.swaps {
        let x = swap.step as f64 / steps * (width - 1.0);
        dots.line((x, 0.0), (x, height - 1.0), Some(3), Rank::Behind, view.ink.warning());
    }
    if view.phase == Phase::Learning && view.record().is_some() {
        let x = (view.step + 1) as f64 / steps * (width - 1.0);
        dots.line((x, 0.0), (x, height - 1.0), Some(1), Rank::Ground, TerminalInk::quiet());
    }
    dots.draw(plot, buffer, view.ink.fine);
    label_x(&axes, document.window_steps, plot, buffer);
    let legend = Rect { y: inner.y + inner.height - 1, height: 1, ..inner };
    let signs = signs(view, curves.len(), !before.is_empty(), inner.width >= 48);
    write(&Line::from(signs), legend, buffer);
}

fn lines(view: &View, axes: &Axes, curves: &[Vec<f64>], before: &[Vec<f64>], dots: &mut Dots) {
    let accent = view.ink.accent();
    if curves.len() > 1 {
        let mut edge = axes.path(&quantiles(curves, BAND[1]));
        edge.extend(axes.path(&quantiles(curves, BAND[0])).into_iter().rev());
        dots.fill(&edge, 2, Rank::Area, accent.patch(TerminalInk::quiet()));
    }
    if !before.is_empty() {
        dots.path(&axes.path(&quantiles(before, 0.5)), Some(3), Rank::Behind, TerminalInk::quiet());
    }
    if curves.len() > 1
        && let Some(own) = curves.get(view.seed)
    {
        dots.path(&axes.path(own), Some(1), Rank::Line, TerminalInk::strong());
    }
    dots.path(&axes.path(&quantiles(curves, 0.5)), None, Rank::Front, accent);
}

/// What each line is.
fn signs(view: &View, seeds: usize, before: bool, wide: bool) -> Vec<Span<'static>> {
    let accent = view.ink.accent();
    let mut signs = if seeds > 1 {
        vec![
            Span::styled("━ ", accent),
            Span::styled(
                if wide { format!("median of {seeds}  ") } else { "median  ".to_owned() },
                TerminalInk::quiet(),
            ),
            Span::styled("░ ", accent.patch(TerminalInk::quiet())),
            Span::styled("10–90 %  ", TerminalInk::quiet()),
        ]
    } else {
        Vec::new()
    };
    let (sign, style) = if seeds > 1 { ("┈ ", TerminalInk::strong()) } else { ("━ ", accent) };
    let seed = view.seed_run().map_or(0, |seed| seed.seed);
    signs.extend([Span::styled(sign, style), Span::styled(format!("seed {seed}"), TerminalInk::quiet())]);
    if view.document().is_some_and(|document| !document.swaps.is_empty()) {
        signs.extend([Span::styled("  ┊ ", view.ink.warning()), Span::styled("reward swapped", TerminalInk::quiet())]);
    }
    if view.document().is_some_and(|document| document.from.is_some()) {
        signs.push(Span::styled("  goes on from another run", TerminalInk::quiet()));
    }
    if before {
        signs.extend([Span::styled("  ╌ ", TerminalInk::quiet()), Span::styled("before", TerminalInk::quiet())]);
    }
    signs
}

fn label_y(axes: &Axes, plot: Rect, buffer: &mut Buffer, dots: &mut Dots) {
    for at in ticks(axes.low, axes.high, usize::from(plot.height / 3).max(2)) {
        let y = axes.y(at);
        let text = typeset(at);
        let width = (columns(&text) as u16).min(LEFT - 1);
        let row = plot.y + (y / 4.0) as u16;
        let place = Rect { x: plot.x - 1 - width, y: row.min(plot.y + plot.height - 1), width, height: 1 };
        write(&Line::styled(text, TerminalInk::quiet()), place, buffer);
        let dash = if at == 0.0 { 1 } else { 0 };
        for x in (0..axes.width as usize).step_by(if dash == 1 { 2 } else { 8 }) {
            dots.dot((x as f64, y), Rank::Ground, TerminalInk::quiet());
        }
    }
}

fn label_x(axes: &Axes, window_steps: u64, plot: Rect, buffer: &mut Buffer) {
    let row = Rect { y: plot.y + plot.height, height: 1, ..plot };
    let steps = axes.windows as f64 * window_steps as f64;
    let column = |step: f64| row.x + (step / steps * (axes.width - 1.0) / 2.0) as u16;
    let end = row.x + row.width + 1;
    let mut free = plot.x.saturating_sub(LEFT);
    for at in ticks(0.0, steps, usize::from(row.width / 14).max(1)) {
        let text = if at == 0.0 { "0 steps".to_owned() } else { whole(at.round() as u64) };
        let width = columns(&text) as u16;
        let x = if at == 0.0 { row.x } else { column(at).saturating_sub(width / 2).min(end.saturating_sub(width)) };
        if x >= free {
            write(
                &Line::styled(text, TerminalInk::quiet()),
                Rect { x, width: width.min(end.saturating_sub(x)), ..row },
                buffer,
            );
            free = x + width + 1;
        }
    }
}

/// By window, the value below which this share of the seeds is.
fn quantiles(curves: &[Vec<f64>], share: f64) -> Vec<f64> {
    let longest = curves.iter().map(Vec::len).max().unwrap_or(0);
    (0..longest)
        .filter_map(|window| {
            curves.iter().filter_map(|curve| curve.get(window).copied()).collect::<Sorted>().quantile(share)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_and_the_band_are_interpolated_between_seeds() {
        let curves = [vec![-4.0, 0.0], vec![-2.0, -1.0], vec![0.0]];
        assert_eq!(quantiles(&curves, 0.5), [-2.0, -0.5]);
        assert_eq!(quantiles(&curves, 0.25), [-3.0, -0.75]);
        assert_eq!(quantiles(&[], 0.5), Vec::<f64>::new());
    }
}
