//! Writes a canvas as SVG.

use std::fmt::{self, Write};

use super::canvas::{Align, PictureCanvas, PictureMark, Spot, Text, Tint, UNITS_PER_PX};
use super::{glyphs, raster};
use crate::markup::{Escaped, base64};
use engine::diagnostic::Result;

/// The canvas as a whole SVG document, with a title and what it shows in words.
///
/// # Errors
/// If an image in it cannot be encoded.
pub(super) fn svg(canvas: &PictureCanvas, title: &str, shows: &str) -> Result<String> {
    let (width, height) = (canvas.width_px, canvas.height_px);
    let mut out = String::new();
    let _ = writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" role=\"img\" \
         font-family=\"{}\" stroke-linecap=\"round\" stroke-linejoin=\"round\">\n<title>{}</title>\n<desc>{}</desc>",
        glyphs::FAMILY,
        Escaped(title),
        Escaped(shows)
    );
    for mark in &canvas.marks {
        write_mark(&mut out, mark)?;
    }
    out.push_str("</svg>\n");
    Ok(out)
}

fn write_mark(out: &mut String, mark: &PictureMark) -> Result<()> {
    // Writing into a String cannot fail.
    let _ = match mark {
        PictureMark::Rect { min, max, ink } => {
            writeln!(out, "<rect {} {}/>", SvgFrame(*min, *max), Paint("fill", *ink))
        }
        PictureMark::Area { points, ink } => {
            writeln!(out, "<polygon points=\"{}\" {}/>", Points(points), Paint("fill", *ink))
        }
        PictureMark::Line { points, width, ink } => {
            let (width, paint) = (Px(*width), Paint("stroke", *ink));
            writeln!(out, "<polyline points=\"{}\" fill=\"none\" {paint} stroke-width=\"{width}\"/>", Points(points))
        }
        PictureMark::Disc { centre, radius, ink } => {
            let (x, y, r) = (Px(centre.0), Px(centre.1), Px(*radius));
            writeln!(out, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{r}\" {}/>", Paint("fill", *ink))
        }
        PictureMark::Text(text) => write_text(out, text),
        PictureMark::Pixels { min, max, columns, rows, rgb } => {
            let image = base64(&raster::encode(rgb, *columns as u32, *rows as u32)?);
            let frame = SvgFrame(*min, *max);
            writeln!(
                out,
                "<image {frame} preserveAspectRatio=\"none\" style=\"image-rendering:pixelated\" \
                 href=\"data:image/png;base64,{image}\"/>"
            )
        }
    };
    Ok(())
}

fn write_text(out: &mut String, text: &Text) -> fmt::Result {
    let anchor = match text.along {
        Align::Start => "start",
        Align::Middle => "middle",
        Align::End => "end",
    };
    let (x, y) = (Px(text.at.0), Px(text.at.1 + text.baseline()));
    write!(out, "<text x=\"{x}\" y=\"{y}\" font-size=\"{}\" text-anchor=\"{anchor}\"", Px(text.em))?;
    if text.bold {
        out.push_str(" font-weight=\"bold\"");
    }
    if text.upwards {
        write!(out, " transform=\"rotate(-90 {x} {})\"", Px(text.at.1))?;
    }
    writeln!(out, " {}>{}</text>", Paint("fill", text.ink), Escaped(&text.words))
}

/// Canvas units written as pixels.
struct Px(i32);

impl fmt::Display for Px {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", f64::from(self.0) / f64::from(UNITS_PER_PX))
    }
}

struct Points<'a>(&'a [Spot]);

impl fmt::Display for Points<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, spot) in self.0.iter().enumerate() {
            let space = if index == 0 { "" } else { " " };
            write!(f, "{space}{},{}", Px(spot.0), Px(spot.1))?;
        }
        Ok(())
    }
}

struct SvgFrame(Spot, Spot);

impl fmt::Display for SvgFrame {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (width, height) = (Px((self.1.0 - self.0.0).max(0)), Px((self.1.1 - self.0.1).max(0)));
        write!(f, "x=\"{}\" y=\"{}\" width=\"{width}\" height=\"{height}\"", Px(self.0.0), Px(self.0.1))
    }
}

struct Paint(&'static str, Tint);

impl fmt::Display for Paint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(what, Tint { rgb: [red, green, blue], alpha }) = self;
        write!(f, "{what}=\"#{red:02x}{green:02x}{blue:02x}\"")?;
        if *alpha < 1.0 { write!(f, " {what}-opacity=\"{alpha}\"") } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_title_cannot_break_the_document() {
        let document = svg(&PictureCanvas::new(10, 10), "a </title>", "b </desc>").unwrap();
        let head = "<title>a &lt;/title&gt;</title>\n<desc>b &lt;/desc&gt;</desc>";
        assert!(document.contains(head), "{document}");
    }
}
