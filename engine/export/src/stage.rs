//! The filters that have a port, and their parameters as that port takes them.

use engine::diagnostic::Result;
use engine::experiment::Plan;
use engine::settings::{FilterSettings, ViewSettings};

use crate::model::cannot;

/// The filters that have a port in both languages.
const PORTED: &[&str] = &["blur", "chroma", "colour", "horizon", "scharr", "sobel", "threshold"];

/// What a stage reads, or writes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Reads {
    Colour,
    Grey,
    Mask,
}

/// One filter of a chain; whole numbers, as the filters compute with them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Stage {
    /// Brightness of a colour image, where a filter wants no more.
    Luma,
    /// Weights beside and in the middle, and the square of the norm from which a pixel is an edge.
    Edges {
        side: i32,
        middle: i32,
        least: i32,
    },
    Threshold {
        least: u8,
        bright: u8,
        dark: u8,
    },
    Colour {
        hue: i32,
        width: i32,
        saturation: i32,
        dark: i32,
    },
    Chroma {
        rows: usize,
        columns: usize,
        left: usize,
        tolerance: i32,
    },
    /// Of each row: pixels cleared on either side.
    Horizon {
        cleared: Vec<usize>,
    },
    Blur {
        weights: Vec<u32>,
    },
}

impl Stage {
    /// The chain of a view over images of one size. Where the plan looks in colour, filters that want brightness get it.
    pub(crate) fn chain(plan: &Plan, view: &ViewSettings, size_px: (usize, usize)) -> Result<Vec<Self>> {
        let default = [FilterSettings::new("sobel")];
        let filters = if view.filters.is_empty() { &default[..] } else { &view.filters };
        let stages = filters.iter().map(|filter| Self::new(plan, filter, size_px)).collect::<Result<Vec<_>>>()?;
        let colour = |stage: &Self| stage.reads() == Reads::Colour;
        let mut others = plan.settings.views().flat_map(|view| view.filters.first());
        let in_colour = others.any(|filter| matches!(filter.name.as_str(), "colour" | "chroma"));
        let first = if in_colour && !stages.first().is_some_and(colour) { Some(Self::Luma) } else { None };
        Ok(first.into_iter().chain(stages).collect())
    }

    fn new(plan: &Plan, filter: &FilterSettings, (width, height): (usize, usize)) -> Result<Self> {
        let name = filter.name.as_str();
        if !PORTED.contains(&name) || !plan.filters.is_own(name) {
            let help =
                format!("filters with a port: {}; or compile its source for the other program", PORTED.join(", "));
            return cannot(format!("filter '{name}' has no port"), &help);
        }
        let descriptor = plan.filters.find(name)?.descriptor;
        let value = |wanted: &str| {
            let set = filter.parameters.iter().find(|(key, _)| key == wanted).map(|(_, value)| *value);
            let parameter = || descriptor.parameters.iter().find(|parameter| parameter.name == wanted);
            set.or_else(|| parameter().map(|parameter| parameter.default)).unwrap_or(0.0)
        };
        let square = || (value("threshold") * value("threshold")).ceil() as i32;
        Ok(match name {
            "scharr" => Self::Edges { side: 3, middle: 10, least: square() },
            "threshold" => {
                let (bright, dark) = if value("invert") == 0.0 { (255, 0) } else { (0, 255) };
                Self::Threshold { least: value("threshold").ceil() as u8, bright, dark }
            }
            "colour" => {
                let steps = |degrees: f64| (degrees * 1536.0 / 360.0).round() as i32;
                Self::Colour {
                    hue: steps(value("hue_deg")) % 1536,
                    width: steps(value("width_deg")),
                    saturation: (value("saturation") * 256.0).round() as i32,
                    dark: value("dark").round() as i32,
                }
            }
            "chroma" => {
                let part = |share: f64, length: usize| ((share * length as f64).round() as usize).clamp(1, length);
                let (rows, columns) = (part(value("height"), height), part(value("width"), width));
                let tolerance = (value("tolerance") * 4096.0).round() as i32;
                Self::Chroma { rows, columns, left: (width - columns) / 2, tolerance }
            }
            "horizon" => {
                let (top, narrowing) = (value("top"), value("narrowing"));
                Self::Horizon {
                    cleared: (0..height).map(|row| cleared_px(row, (width, height), top, narrowing)).collect(),
                }
            }
            "blur" => Self::Blur { weights: pascal_row(2 * value("radius_px") as usize) },
            _ => Self::Edges { side: 1, middle: 2, least: square() },
        })
    }

    pub(crate) const fn reads(&self) -> Reads {
        match self {
            Self::Luma | Self::Colour { .. } | Self::Chroma { .. } => Reads::Colour,
            Self::Edges { .. } | Self::Threshold { .. } | Self::Blur { .. } => Reads::Grey,
            Self::Horizon { .. } => Reads::Mask,
        }
    }

    /// The name of its function in both languages.
    pub(crate) const fn function(&self) -> &'static str {
        match self {
            Self::Luma => "luma",
            Self::Edges { .. } => "edges",
            Self::Threshold { .. } => "threshold",
            Self::Colour { .. } => "colour",
            Self::Chroma { .. } => "chroma",
            Self::Horizon { .. } => "horizon",
            Self::Blur { .. } => "blur",
        }
    }
}

/// How many pixels `horizon` clears on either side of a row.
fn cleared_px(row: usize, (width, height): (usize, usize), top: f64, narrowing: f64) -> usize {
    let (line, middle) = (top * height as f64, row as f64 + 0.5);
    let most = width - width / 2;
    if middle < line {
        return most;
    }
    let above_bottom = (height as f64 - middle) / (height as f64 - line);
    let side = narrowing * above_bottom * width as f64 * 0.5;
    ((side - 0.5).ceil().max(0.0) as usize).min(most)
}

/// Row `n` of Pascal's triangle.
fn pascal_row(n: usize) -> Vec<u32> {
    let mut row = vec![0_u32; n + 1];
    row[0] = 1;
    for _ in 0..n {
        for index in (1..=n).rev() {
            row[index] += row[index - 1];
        }
    }
    row
}
