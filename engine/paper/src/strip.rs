//! The seeds of a row as dots on a line, with a mark where the paper's number or the limit lies.

use std::fmt::Write;

use super::claims::Claim;
use super::job::Metric;
use super::row::Numbers;
use super::verdict::Rule;

const WIDTH_PX: f64 = 180.0;
const HEIGHT_PX: f64 = 30.0;
const MIDDLE_PX: f64 = 15.0;
/// Where the line begins and ends; "never" has a place of its own beyond its end.
const FROM_PX: f64 = 8.0;
const TO_PX: f64 = 152.0;
const NEVER_PX: f64 = 170.0;

/// A small drawing without text; colours come from the page's classes.
pub(super) fn strip(claim: &Claim, ours: &Numbers) -> String {
    if claim.metric == Metric::NeverLost {
        return share(ours);
    }
    let mark = match claim.rule {
        Rule::Near(at, _) | Rule::Within(at, _) | Rule::AtMost(at) | Rule::AtLeast(at) => Some(at),
        Rule::Share(_) if claim.metric == Metric::NetSpeed => Some(0.1),
        _ => None,
    };
    let finite: Vec<f64> = ours.values.iter().flatten().copied().chain(mark).collect();
    let low = finite.iter().copied().fold(0.0, f64::min);
    let high = finite.iter().copied().fold(0.0, f64::max);
    let span = if high > low { high - low } else { 1.0 };
    let place = |value: f64| FROM_PX + (TO_PX - FROM_PX) * (value - low) / span;
    let mut out = open("Each dot is a seed; the upright line is the paper's number or the limit.");
    let _ = write!(out, "<path class=\"axis\" d=\"M{FROM_PX} {MIDDLE_PX}H{TO_PX}\"/>");
    if let Some(first) = ours.quartile_low {
        let (from, to) = (place(first), ours.quartile_high.map_or(TO_PX, place));
        let _ = write!(
            out,
            "<rect class=\"band\" x=\"{:.1}\" y=\"9\" width=\"{:.1}\" height=\"12\" rx=\"3\"/>",
            from - 2.0,
            to - from + 4.0
        );
    }
    for (index, value) in ours.values.iter().enumerate() {
        // Spread a little up and down, so that equal seeds show.
        let y = MIDDLE_PX + [0.0, -4.0, 4.0, -2.0, 2.0][index % 5];
        let _ = match value {
            Some(value) => write!(out, "<circle class=\"dot\" cx=\"{:.1}\" cy=\"{y}\" r=\"2.5\"/>", place(*value)),
            None => write!(out, "<circle class=\"never\" cx=\"{NEVER_PX}\" cy=\"{y}\" r=\"2.5\"/>"),
        };
    }
    if let Some(mark) = mark {
        let _ = write!(out, "<path class=\"mark\" d=\"M{:.1} 3V27\"/>", place(mark));
    }
    if let Some(median) = ours.median {
        let _ = write!(out, "<circle class=\"median\" cx=\"{:.1}\" cy=\"{MIDDLE_PX}\" r=\"4.5\"/>", place(median));
    }
    out.push_str("</svg>");
    out
}

fn share(ours: &Numbers) -> String {
    let full = NEVER_PX - FROM_PX;
    let part = full * ours.good as f64 / ours.seeds.max(1) as f64;
    let mut out = open("The filled part is the share of good seeds.");
    let _ = write!(
        out,
        "<rect class=\"rest\" x=\"{FROM_PX}\" y=\"11\" width=\"{full}\" height=\"8\" rx=\"4\"/>\
         <rect class=\"part\" x=\"{FROM_PX}\" y=\"11\" width=\"{part:.1}\" height=\"8\" rx=\"4\"/></svg>"
    );
    out
}

fn open(title: &str) -> String {
    format!(
        "<svg class=\"strip\" viewBox=\"0 0 {WIDTH_PX} {HEIGHT_PX}\" width=\"{WIDTH_PX}\" height=\"{HEIGHT_PX}\" \
         role=\"img\"><title>{title}</title>"
    )
}
