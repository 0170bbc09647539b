//! Learning curves of several runs over one another.

use super::canvas::{Spot, Tint};
use super::curve::{CurveData, END_PX, HEIGHT_PX, WIDTH_PX, frame, quartiles, stroke};
use super::picture::Picture;
use super::sheet::{BELOW_TITLE_PX, BLUE, LegendEntry, Sheet, VERMILION, legend, spot};
use engine::diagnostic::Result;

/// The colours of Okabe and Ito that stand out on white, in the order in which runs take them.
const INKS: [Tint; 6] =
    [BLUE, VERMILION, Tint::hex(0x009e73), Tint::hex(0xcc79a7), Tint::hex(0xb08800), Tint::hex(0x333333)];

/// The curves of one run.
#[derive(Debug, Clone)]
pub struct CurveGroup<'a> {
    /// What the legend says.
    pub name: &'a str,
    /// For each seed, the sum of rewards in each window, oldest first.
    pub curves: Vec<&'a [f64]>,
}

/// Draws each run as the median of its seeds with their quartiles; a run of one seed as its line. 1200 x 700 pixels.
///
/// # Errors
/// If the picture cannot be drawn or encoded.
pub fn compared_curves(title: &str, window_steps: u64, groups: &[CurveGroup<'_>]) -> Result<Picture> {
    let mut sheet = Sheet::new(WIDTH_PX, HEIGHT_PX, title);
    let bands: Vec<Vec<[f64; 3]>> = groups
        .iter()
        .map(|group| quartiles(&group.curves.iter().map(|curve| curve.to_vec()).collect::<Vec<_>>()))
        .collect();
    // The axes hold what is drawn: medians and quartiles.
    let shown: Vec<Vec<f64>> = bands
        .iter()
        .flat_map(|band| (0..3).map(|part| band.iter().map(|window| window[part]).collect()).collect::<Vec<_>>())
        .collect();
    let plot = frame(&mut sheet, &CurveData { title, window_steps, curves: &shown, learned_at: None });
    let place = |window: usize, value: f64| plot.at((window as f64 + 1.0) * window_steps as f64, value);
    let inked = || bands.iter().zip(INKS.iter().cycle());
    for (band, ink) in inked() {
        let edge = |part: usize| band.iter().map(move |window| window[part]).enumerate();
        let outline =
            edge(0).chain(edge(2).collect::<Vec<_>>().into_iter().rev()).filter(|(_, value)| value.is_finite());
        sheet.area(outline.map(|(window, value)| place(window, value)).collect(), ink.thin(0.16));
    }
    for (band, ink) in inked() {
        stroke(&mut sheet, band.iter().map(|window| window[1]), place, 3.0, *ink);
    }
    let level = |from: Spot, to: Spot| vec![(from.0, (from.1 + to.1) / 2), (to.0, (from.1 + to.1) / 2)];
    let sign = |ink: Tint| move |sheet: &mut Sheet, from: Spot, to: Spot| sheet.line(level(from, to), 3.0, ink);
    let signs: Vec<_> = INKS.iter().cycle().take(groups.len()).map(|ink| sign(*ink)).collect();
    let entries: Vec<LegendEntry<'_>> =
        groups.iter().zip(&signs).map(|(group, sign)| LegendEntry { sign, words: group.name }).collect();
    legend(&mut sheet, spot(END_PX, BELOW_TITLE_PX + 4.0), &entries);
    let names: Vec<&str> = groups.iter().map(|group| group.name).collect();
    let shows = format!(
        "The sum of the rewards of every {window_steps} steps, median and quartiles of the seeds of {}.",
        names.join(", ")
    );
    sheet.finish(&shows)
}
