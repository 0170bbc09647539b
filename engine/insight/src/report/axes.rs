//! Axes with a grid and ticks at round numbers, and the map from values to places.

use super::canvas::{Align, Spot, Text, Tint, units};
use super::sheet::{FRAME, LABEL_PX, QUIET, SMALL_PX, Sheet, TEXT, centred, words};
use crate::words::spaced;

/// Pixels under a plot for its labels.
pub(super) const BELOW_PX: f64 = 54.0;
/// Seen on paper and on the floor of any world.
const GRID_LINE: Tint = FRAME.thin(0.21);
/// Length of a tick, and from the axis to the number beside it, pixels.
const TICK_PX: f64 = 5.0;
const NUMBER_PX: f64 = 10.0;

/// One axis.
#[derive(Debug, Clone)]
pub(super) struct Axis {
    /// Quantity and unit.
    pub(super) title: String,
    /// The least value shown.
    pub(super) low: f64,
    /// The greatest value shown.
    pub(super) high: f64,
    /// Pixels beside the plot for its labels.
    pub(super) room_px: f64,
    /// About how many ticks there is room for.
    pub(super) ticks: usize,
}

/// A plot: values on it and where they are on the sheet.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plot {
    /// Top left of the plot.
    pub(super) min: Spot,
    /// Bottom right of the plot.
    pub(super) max: Spot,
    x: (f64, f64),
    y: (f64, f64),
}

impl Plot {
    /// A plot without axes: where the ranges of both are on the sheet.
    pub(super) fn of(min: Spot, max: Spot, x: (f64, f64), y: (f64, f64)) -> Self {
        Self { min, max, x, y }
    }

    /// The place of a value; values far outside stay near enough to the plot to be counted.
    pub(super) fn at(&self, x: f64, y: f64) -> Spot {
        (place(x, self.x, (self.min.0, self.max.0)), place(y, self.y, (self.max.1, self.min.1)))
    }
}

fn place(value: f64, (low, high): (f64, f64), (from, to): (i32, i32)) -> i32 {
    let share = ((value - low) / (high - low)).clamp(-4.0, 5.0);
    (f64::from(from) + share * f64::from(to - from)).round() as i32
}

/// A range that holds all finite values and is never empty; without values it is 0 to 1.
pub(super) fn range(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let finite = values.into_iter().filter(|value| value.is_finite());
    let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    // Wider than any world or reward; keeps differences finite.
    let (low, high) = (low.max(-1e300), high.min(1e300));
    if low > high {
        (0.0, 1.0)
    } else if high - low <= high.abs().max(1e-6) * 1e-9 {
        let around = (high.abs() * 0.1).max(0.5);
        (low - around, high + around)
    } else {
        (low, high)
    }
}

/// The round step, 1, 2 or 5 times a power of ten, that cuts `span` into at most `parts`, and its decimals.
fn round_step(span: f64, parts: usize) -> (f64, usize) {
    let least = span / parts.max(1) as f64;
    let (mut power, mut decimals) = (1.0_f64, 0_usize);
    while power < least && power < 1e300 {
        power *= 10.0;
    }
    let mut down = 1.0;
    while power / down / 10.0 >= least && decimals < 12 {
        if power > 1.0 {
            power /= 10.0;
        } else {
            down *= 10.0;
            decimals += 1;
        }
    }
    // `power / down` is now the least power of ten that is enough.
    for (part, deeper) in [(5.0, 1), (2.0, 1)] {
        if power / down / part >= least {
            return (power / down / part, if power > 1.0 { 0 } else { decimals + deeper });
        }
    }
    (power / down, decimals)
}

/// Round values from `low` to `high`, and the decimals to write them with.
pub(super) fn ticks(low: f64, high: f64, count: usize) -> (Vec<f64>, usize) {
    let (step, decimals) = round_step(high - low, count);
    let first = (low / step - 1e-9).ceil();
    let ticks =
        (0..=count + 1).map(|index| (first + index as f64) * step).take_while(|tick| *tick <= high + step * 1e-9);
    (ticks.collect(), decimals)
}

/// Draws axes and grid around the rectangle from `min` to `max`.
pub(super) fn axes(sheet: &mut Sheet, min: Spot, max: Spot, x: &Axis, y: &Axis) -> Plot {
    let plot = Plot { min, max, x: (x.low, x.high), y: (y.low, y.high) };
    let (x_ticks, x_decimals) = ticks(x.low, x.high, x.ticks);
    let (y_ticks, y_decimals) = ticks(y.low, y.high, y.ticks);
    let columns: Vec<(i32, String)> =
        x_ticks.iter().map(|tick| (plot.at(*tick, y.low).0, spaced(*tick, x_decimals))).collect();
    let rows: Vec<(i32, String)> =
        y_ticks.iter().map(|tick| (plot.at(x.low, *tick).1, spaced(*tick, y_decimals))).collect();
    for (column, _) in &columns {
        sheet.line(vec![(*column, min.1), (*column, max.1)], 1.0, GRID_LINE);
    }
    for (row, _) in &rows {
        sheet.line(vec![(min.0, *row), (max.0, *row)], 1.0, GRID_LINE);
    }
    for (column, number) in columns {
        sheet.line(vec![(column, max.1), (column, max.1 + units(TICK_PX))], 1.0, FRAME);
        let label = centred(words(&number, (column, max.1 + units(NUMBER_PX)), SMALL_PX, QUIET));
        sheet.text(Text { across: Align::Start, ..label });
    }
    for (row, number) in rows {
        sheet.line(vec![(min.0 - units(TICK_PX), row), (min.0, row)], 1.0, FRAME);
        let label = words(&number, (min.0 - units(NUMBER_PX), row), SMALL_PX, QUIET);
        sheet.text(Text { along: Align::End, ..label });
    }
    sheet.line(vec![min, (min.0, max.1)], 1.0, FRAME);
    sheet.line(vec![(min.0, max.1), max], 1.0, FRAME);
    let (middle, left) = ((min.0 + max.0) / 2, min.0 - units(y.room_px));
    let title = centred(words(&x.title, (middle, max.1 + units(x.room_px)), LABEL_PX, TEXT));
    sheet.text(Text { across: Align::End, ..title });
    let title = centred(words(&y.title, (left, (min.1 + max.1) / 2), LABEL_PX, TEXT));
    sheet.text(Text { across: Align::Start, upwards: true, ..title });
    plot
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_within_the_range() {
        assert_eq!(ticks(-20.3, 0.0, 5), (vec![-20.0, -15.0, -10.0, -5.0, 0.0], 0));
        assert_eq!(ticks(0.0, 40_000.0, 8).0, [0.0, 5e3, 1e4, 1.5e4, 2e4, 2.5e4, 3e4, 3.5e4, 4e4]);
        let (small, decimals) = ticks(0.1, 0.42, 4);
        assert_eq!(decimals, 1);
        assert!(small.iter().zip([0.1, 0.2, 0.3, 0.4]).all(|(a, b)| (a - b).abs() < 1e-12), "{small:?}");
        assert_eq!(ticks(0.0, 0.0101, 2), (vec![0.0, 0.01], 2));
        assert_eq!(ticks(0.0, 0.0101, 3).1, 3);
    }

    #[test]
    fn each_number_has_its_tick_and_its_line_of_the_grid() {
        let mut sheet = Sheet::new(300.0, 300.0, "");
        let axis = |title: &str| Axis { title: title.to_owned(), low: 0.0, high: 10.0, room_px: 40.0, ticks: 2 };
        axes(&mut sheet, (400, 400), (1000, 1000), &axis("x"), &axis("y"));
        let picture = sheet.finish("").unwrap();
        let image = image::load_from_memory(&picture.png).unwrap().to_rgb8();
        for at in [100, 175] {
            assert_eq!(image.get_pixel(at, 252).0, FRAME.rgb, "tick below at {at}");
            assert_eq!(image.get_pixel(98, at).0, FRAME.rgb, "tick beside at {at}");
        }
        let grid = [231, 233, 235];
        assert_eq!((image.get_pixel(175, 120).0, image.get_pixel(120, 175).0), (grid, grid));
        assert_eq!((image.get_pixel(100, 120).0, image.get_pixel(120, 250).0), (FRAME.rgb, FRAME.rgb));
        assert_eq!(picture.svg.matches(">5<").count(), 2);
    }

    #[test]
    fn a_range_is_never_empty() {
        assert_eq!(range([]), (0.0, 1.0));
        assert_eq!(range([f64::NAN]), (0.0, 1.0));
        assert_eq!(range([-3.0, -3.0]), (-3.5, -2.5));
        let (low, high) = range([1e308, -1e308]);
        assert!((high - low).is_finite());
    }
}
