//! Letters: DejaVu Sans, built in, so that text looks and measures the same on every machine.

use skrifa::instance::{LocationRef, Size};
use skrifa::outline::{DrawSettings, OutlinePen};
use skrifa::raw::TableProvider;
use skrifa::raw::tables::kern::SubtableKind;
use skrifa::{FontRef, GlyphId, MetadataProvider};

use super::canvas::{Align, FineSpot, Text, UNITS_PER_PX, fine};

/// The family as SVG names it: ours, then what a viewer without it may take.
pub(super) const FAMILY: &str = "DejaVu Sans, Verdana, sans-serif";

/// Straight pieces in place of one bend of an outline; at 22 pixels an "o" is then off by 0.03 pixels.
const PIECES: u8 = 4;

/// The font with or without heavy letters. It is part of the program; if it cannot be read, every test of text fails.
fn font(bold: bool) -> Option<FontRef<'static>> {
    FontRef::new(if bold { dejavu::sans::bold() } else { dejavu::sans::regular() }).ok()
}

/// One glyph of a line of words, and where it begins, font units from the start of the words.
type Placed = (GlyphId, f32);

/// The glyphs of a line of words, and the width of all, in font units.
fn layout(font: &FontRef<'static>, words: &str) -> (Vec<Placed>, f32) {
    let characters = font.charmap();
    let metrics = font.glyph_metrics(Size::unscaled(), LocationRef::default());
    let mut placed: Vec<Placed> = Vec::with_capacity(words.len());
    let mut end = 0.0;
    for letter in words.chars() {
        let glyph = characters.map(letter).unwrap_or(GlyphId::NOTDEF);
        if let Some((before, _)) = placed.last() {
            end += kerning(font, *before, glyph);
        }
        placed.push((glyph, end));
        end += metrics.advance_width(glyph).unwrap_or(0.0);
    }
    (placed, end)
}

/// What is added to the distance between two letters, mostly negative, font units.
fn kerning(font: &FontRef<'static>, left: GlyphId, right: GlyphId) -> f32 {
    let Ok(table) = font.kern() else { return 0.0 };
    let along = table.subtables().flatten().filter(|part| part.is_horizontal());
    let more = along.filter_map(|part| match part.kind() {
        Ok(SubtableKind::Format0(pairs)) => pairs.kerning(left, right),
        _ => None,
    });
    more.sum::<i32>() as f32
}

/// Font units in an em.
fn units_per_em(font: &FontRef<'static>) -> f32 {
    font.head().map_or(2048.0, |head| f32::from(head.units_per_em()))
}

/// Width of the words, canvas units.
pub(super) fn width(words: &str, em: i32, bold: bool) -> i32 {
    font(bold).map_or(0, |font| (layout(&font, words).1 * em as f32 / units_per_em(&font)).round() as i32)
}

/// The closed outlines of all letters, in pixels of the picture; holes run the other way round.
pub(super) fn outlines(text: &Text) -> Vec<Vec<FineSpot>> {
    let Some(font) = font(text.bold) else { return Vec::new() };
    let (placed, length) = layout(&font, &text.words);
    let scale = text.em as f32 / UNITS_PER_PX as f32 / units_per_em(&font);
    let back = match text.along {
        Align::Start => 0.0,
        Align::Middle => length / 2.0,
        Align::End => length,
    };
    let ((x, y), (_, down)) = (fine(text.at), fine((0, text.baseline())));
    let letters = font.outline_glyphs();
    let mut outlines = Vec::new();
    for (glyph, start) in placed {
        let place = |(right, up): FineSpot| {
            let (right, below) = ((start - back + right) * scale, down - up * scale);
            if text.upwards { (x + below, y - right) } else { (x + right, y + below) }
        };
        let mut pen = Pen { place, at: (0.0, 0.0), outlines: Vec::new() };
        let settings = DrawSettings::unhinted(Size::unscaled(), LocationRef::default());
        // A glyph that cannot be drawn leaves its room empty.
        if let Some(letter) = letters.get(glyph) {
            let _ = letter.draw(settings, &mut pen);
        }
        outlines.append(&mut pen.outlines);
    }
    outlines
}

/// Follows the outline of one glyph and notes it as corners on the picture.
struct Pen<F> {
    /// From font units to the picture.
    place: F,
    /// Where the pen is, font units.
    at: FineSpot,
    outlines: Vec<Vec<FineSpot>>,
}

impl<F: Fn(FineSpot) -> FineSpot> Pen<F> {
    fn corner(&mut self, at: FineSpot) {
        self.at = at;
        if let Some(outline) = self.outlines.last_mut() {
            outline.push((self.place)(at));
        }
    }
}

impl<F: Fn(FineSpot) -> FineSpot> OutlinePen for Pen<F> {
    fn move_to(&mut self, x: f32, y: f32) {
        self.outlines.push(Vec::new());
        self.corner((x, y));
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.corner((x, y));
    }

    fn quad_to(&mut self, cx: f32, cy: f32, x: f32, y: f32) {
        // The cubic curve of the same shape.
        let pull = |end: f32, to: f32| end + (to - end) * (2.0 / 3.0);
        self.curve_to(pull(self.at.0, cx), pull(self.at.1, cy), pull(x, cx), pull(y, cy), x, y);
    }

    fn curve_to(&mut self, ax: f32, ay: f32, bx: f32, by: f32, x: f32, y: f32) {
        let from = self.at;
        for piece in 1..PIECES {
            let (done, left) = (f32::from(piece) / f32::from(PIECES), f32::from(PIECES - piece) / f32::from(PIECES));
            let along = |from: f32, a: f32, b: f32, to: f32| {
                left * left * left * from + 3.0 * done * left * (left * a + done * b) + done * done * done * to
            };
            self.corner((along(from.0, ax, bx, x), along(from.1, ay, by, y)));
        }
        self.corner((x, y));
    }

    fn close(&mut self) {}
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::canvas::{Tint, UNITS_PER_PX};

    fn text(words: &str, along: Align, upwards: bool) -> Text {
        let (em, ink) = (20 * UNITS_PER_PX, Tint::hex(0));
        Text { words: words.to_owned(), at: (400, 400), em, bold: false, along, across: Align::Middle, upwards, ink }
    }

    /// Least x and y, greatest x and y of all outlines.
    fn bounds(text: &Text) -> [f32; 4] {
        let all: Vec<FineSpot> = outlines(text).concat();
        let from = [f32::MAX, f32::MAX, f32::MIN, f32::MIN];
        all.iter().fold(from, |now, at| [now[0].min(at.0), now[1].min(at.1), now[2].max(at.0), now[3].max(at.1)])
    }

    #[test]
    fn words_are_as_wide_as_the_font_says_and_pairs_stand_closer() {
        // Advance widths of DejaVu Sans: "A" 1401, "V" 1401, "n" 1298 of 2048; "AV" is kerned by 131.
        assert_eq!(width("n", 2048, false), 1298);
        assert_eq!(width("AV", 2048, false), 2 * 1401 - 131);
        assert_eq!(width("nn", 100, false), 127);
        assert!(width("n", 2048, true) > width("n", 2048, false));
        assert_eq!(width("", 100, false), 0);
    }

    #[test]
    fn a_letter_has_an_outline_for_each_border_and_one_without_a_shape_has_a_box() {
        let outlines = |words: &str| outlines(&text(words, Align::Start, false)).len();
        assert_eq!((outlines("l"), outlines("o"), outlines("i"), outlines(" ")), (1, 2, 2, 0));
        assert!(outlines("\u{10ffff}") > 0);
    }

    #[test]
    fn words_stand_around_their_place_and_upwards_ones_beside_it() {
        let [left, top, right, bottom] = bounds(&text("nn", Align::Middle, false));
        assert!((left + right - 200.0).abs() < 1.0 && left > 85.0 && right < 115.0, "{left} {right}");
        assert!(top < 100.0 && bottom > 100.0 && bottom < 110.0, "{top} {bottom}");
        let [left, top, right, bottom] = bounds(&text("nn", Align::Start, true));
        assert!(top > 70.0 && bottom < 100.0, "{top} {bottom}");
        assert!(left < 100.0 && right > 100.0, "{left} {right}");
    }
}
