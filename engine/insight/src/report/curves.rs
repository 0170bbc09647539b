//! Learning curves of several runs over one another.

use super::canvas::{Spot, Tint, units};
use super::curve::{CurveData, HEIGHT_PX, WIDTH_PX, frame, quartiles};
use super::picture::Picture;
use super::sheet::{BLUE, Sheet, VERMILION};
use engine::diagnostic::Result;

/// The colours of Okabe and Ito that stand out on white, in the order in which runs take them.
const INKS: [Tint; 6] =
    [BLUE, VERMILION, Tint::hex(0x009e73), Tint::hex(0xcc79a7), Tint::hex(0xb08800), Tint::hex(0x333333)];
/// Dashes and gaps in turn, pixels; none of a whole line. With the colours these are 36 lines that differ.
const DASHES: [&[f64]; 6] =
    [&[], &[14.0, 9.0], &[2.0, 8.0], &[18.0, 8.0, 2.0, 8.0], &[30.0, 10.0], &[8.0, 8.0, 2.0, 8.0, 2.0, 8.0]];
/// Beyond so many runs their bands would hide one another.
const MOST_BANDS: usize = 4;
const LINE_PX: f64 = 3.0;

/// The curves of one run.
#[derive(Debug, Clone)]
pub struct CurveGroup<'a> {
    /// What the description says.
    pub name: &'a str,
    /// For each seed, the sum of rewards in each window, oldest first.
    pub curves: Vec<&'a [f64]>,
}

/// How the line of a run is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveStyle {
    /// Red, green, blue.
    pub rgb: [u8; 3],
    /// Dashes and gaps in turn, pixels; empty for a whole line.
    pub dashes: &'static [f64],
}

impl CurveStyle {
    /// That of the run with this number, from 0: neighbours differ in colour and in dashes.
    #[must_use]
    pub fn of(run: usize) -> Self {
        let (colours, kinds) = (INKS.len(), DASHES.len());
        Self { rgb: INKS[run % colours].rgb, dashes: DASHES[(run + run / colours) % kinds] }
    }
}

/// Whether so many runs have bands beside their medians.
#[must_use]
pub fn has_bands(runs: usize) -> bool {
    runs <= MOST_BANDS
}

/// Draws each run as the median of its seeds, a few runs with the band of their quartiles; a run of one seed as its line.
/// 1200 x 700 pixels, without a legend: [`CurveStyle::of`] says how each line looks.
///
/// # Errors
/// If the picture cannot be drawn or encoded.
pub fn compared_curves(title: &str, window_steps: u64, groups: &[CurveGroup<'_>]) -> Result<Picture> {
    let mut sheet = Sheet::new(WIDTH_PX, HEIGHT_PX, title);
    let bands: Vec<Vec<[f64; 3]>> = groups
        .iter()
        .map(|group| quartiles(&group.curves.iter().map(|curve| curve.to_vec()).collect::<Vec<_>>()))
        .collect();
    // The axes hold what is drawn.
    let parts = if has_bands(groups.len()) { 0..3 } else { 1..2 };
    let shown: Vec<Vec<f64>> = bands
        .iter()
        .flat_map(|band| parts.clone().map(|part| band.iter().map(|window| window[part]).collect()).collect::<Vec<_>>())
        .collect();
    let plot = frame(&mut sheet, &CurveData { title, window_steps, curves: &shown, learned_at: None });
    let place = |window: usize, value: f64| plot.at((window as f64 + 1.0) * window_steps as f64, value);
    for (index, band) in bands.iter().enumerate().filter(|_| has_bands(groups.len())) {
        let edge = |part: usize| band.iter().map(move |window| window[part]).enumerate();
        let outline =
            edge(0).chain(edge(2).collect::<Vec<_>>().into_iter().rev()).filter(|(_, value)| value.is_finite());
        let ink = INKS[index % INKS.len()].thin(0.16);
        sheet.area(outline.map(|(window, value)| place(window, value)).collect(), ink);
    }
    for (index, band) in bands.iter().enumerate() {
        let medians: Vec<f64> = band.iter().map(|window| window[1]).collect();
        draw(&mut sheet, &medians, place, CurveStyle::of(index));
    }
    let names: Vec<&str> = groups.iter().map(|group| group.name).collect();
    let what = if has_bands(groups.len()) { "median and quartiles" } else { "median" };
    let shows =
        format!("The sum of the rewards of every {window_steps} steps, {what} of the seeds of {}.", names.join(", "));
    sheet.finish(&shows)
}

/// Draws values as a line that is broken where one is not finite; a lone value is a dot.
fn draw(sheet: &mut Sheet, values: &[f64], place: impl Fn(usize, f64) -> Spot, style: CurveStyle) {
    let ink = Tint { rgb: style.rgb, alpha: 1.0 };
    let places: Vec<(f64, Spot)> =
        values.iter().enumerate().map(|(window, value)| (*value, place(window, *value))).collect();
    for whole in places.split(|(value, _)| !value.is_finite()) {
        let line: Vec<Spot> = whole.iter().map(|(_, spot)| *spot).collect();
        match line[..] {
            [alone] => sheet.disc(alone, LINE_PX + 1.0, ink),
            _ => dashed(&line, style.dashes).into_iter().for_each(|dash| sheet.line(dash, LINE_PX, ink)),
        }
    }
}

/// A line cut into its dashes.
fn dashed(line: &[Spot], dashes: &[f64]) -> Vec<Vec<Spot>> {
    let Some(first) = dashes.first() else { return vec![line.to_vec()] };
    let (mut part, mut left) = (0, f64::from(units(*first)));
    let (mut cut, mut dash) = (Vec::new(), line.first().copied().into_iter().collect::<Vec<_>>());
    for ends in line.windows(2) {
        let [from, to] = [ends[0], ends[1]].map(|(x, y)| (f64::from(x), f64::from(y)));
        let length = libm::hypot(to.0 - from.0, to.1 - from.1);
        let at = |way: f64| {
            let share = way / length;
            ((from.0 + share * (to.0 - from.0)).round() as i32, (from.1 + share * (to.1 - from.1)).round() as i32)
        };
        let mut way = 0.0;
        while length - way > left {
            way += left;
            if part % 2 == 0 {
                dash.push(at(way));
                cut.push(std::mem::take(&mut dash));
            } else {
                dash = vec![at(way)];
            }
            part = (part + 1) % dashes.len();
            left = f64::from(units(dashes[part]));
        }
        left -= length - way;
        if part % 2 == 0 {
            dash.push(ends[1]);
        }
    }
    if dash.len() > 1 {
        cut.push(dash);
    }
    cut
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thirty_six_runs_have_lines_that_differ_and_neighbours_differ_in_colour_and_dashes() {
        let styles: Vec<CurveStyle> = (0..36).map(CurveStyle::of).collect();
        for (index, style) in styles.iter().enumerate() {
            assert!(!styles[..index].contains(style), "{index}");
        }
        assert!(styles.windows(2).all(|two| two[0].rgb != two[1].rgb && two[0].dashes != two[1].dashes));
    }

    #[test]
    fn dashes_go_on_round_a_corner() {
        // Four units are a pixel: dashes of 10 and gaps of 5 pixels along 20 pixels right and 20 down.
        let dashes = dashed(&[(0, 0), (80, 0), (80, 80)], &[10.0, 5.0]);
        assert_eq!(dashes, [vec![(0, 0), (40, 0)], vec![(60, 0), (80, 0), (80, 20)], vec![(80, 40), (80, 80)]]);
        assert_eq!(dashed(&[(0, 0), (80, 0)], &[]), [vec![(0, 0), (80, 0)]]);
    }
}
