//! How long a step takes under growing workloads: one group of bars for each kind of growth.

use super::canvas::units;
use super::picture::Picture;
use super::sheet::{
    BELOW_TITLE_PX, BLUE, FRAME, LABEL_PX, MARGIN_PX, QUIET, SMALL_PX, Sheet, TEXT, centred, fitted, spot, words,
};
use engine::diagnostic::Result;

const WIDTH_PX: f64 = 1200.0;
const HEIGHT_PX: f64 = 420.0;
/// Empty space between two groups.
const GAP_PX: f64 = 40.0;
/// Share of a bar's place that it fills.
const FILLED: f64 = 0.62;

/// One kind of growth.
#[derive(Debug, Clone, Copy)]
pub struct GrowthGroup<'a> {
    /// What grows.
    pub what: &'a str,
    /// For each amount its name and the microseconds of a step.
    pub bars: &'a [(&'a str, f64)],
}

/// Draws the groups side by side, each with its own scale from 0. 1200 x 420 pixels.
///
/// # Errors
/// If the picture cannot be drawn or encoded.
pub fn growth(title: &str, groups: &[GrowthGroup<'_>]) -> Result<Picture> {
    let mut sheet = Sheet::new(WIDTH_PX, HEIGHT_PX, title);
    let bars: usize = groups.iter().map(|group| group.bars.len()).sum();
    let place_px = (WIDTH_PX - 2.0 * MARGIN_PX - GAP_PX * (groups.len().max(1) - 1) as f64) / bars.max(1) as f64;
    let mut left_px = MARGIN_PX;
    for group in groups {
        group_of_bars(&mut sheet, group, left_px, place_px);
        left_px += group.bars.len() as f64 * place_px + GAP_PX;
    }
    let names: Vec<&str> = groups.iter().map(|group| group.what).collect();
    sheet.finish(&format!("Microseconds of a step, as bars: {}", names.join(", ")))
}

fn group_of_bars(sheet: &mut Sheet, group: &GrowthGroup<'_>, left_px: f64, place_px: f64) {
    let (top_px, bottom_px) = (BELOW_TITLE_PX + 48.0, HEIGHT_PX - MARGIN_PX - 30.0);
    sheet.text(words(group.what, spot(left_px, BELOW_TITLE_PX + 8.0), LABEL_PX, TEXT));
    let most = group.bars.iter().map(|bar| bar.1).filter(|us| us.is_finite()).fold(f64::MIN_POSITIVE, f64::max);
    for (index, (name, us)) in group.bars.iter().enumerate() {
        let middle_px = left_px + (index as f64 + 0.5) * place_px;
        let half_px = place_px * FILLED * 0.5;
        let height_px = (bottom_px - top_px) * (us / most).clamp(0.0, 1.0);
        sheet.rect(spot(middle_px - half_px, bottom_px - height_px), spot(middle_px + half_px, bottom_px), BLUE);
        let label = |text: &str, y_px: f64, ink| {
            fitted(centred(words(text, spot(middle_px, y_px), SMALL_PX, ink)), units(place_px))
        };
        sheet.text(label(&format!("{us:.1} µs"), bottom_px - height_px - 14.0, TEXT));
        sheet.text(label(name, bottom_px + 18.0, QUIET));
    }
    let end_px = left_px + group.bars.len() as f64 * place_px;
    sheet.line(vec![spot(left_px, bottom_px), spot(end_px, bottom_px)], 1.0, FRAME);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_step_has_the_highest_bar_and_every_bar_its_number() {
        let bars = [("50", 8.0), ("5000", 16.0)];
        let picture = growth("a step", &[GrowthGroup { what: "boxes", bars: &bars }]).unwrap();
        assert!(picture.svg.contains("8.0") && picture.svg.contains("16.0") && picture.svg.contains("boxes"));
        assert!(growth("nothing", &[]).is_ok());
        assert!(growth("no number", &[GrowthGroup { what: "x", bars: &[("1", f64::NAN)] }]).is_ok());
    }
}
