//! The seeds of a row as dots on a line, with a mark where the paper's number or the limit lies.

use maud::{Markup, html};

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
pub(super) fn strip(claim: &Claim, ours: &Numbers) -> Markup {
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
    let band = ours.quartile_low.map(|low| (place(low), ours.quartile_high.map_or(TO_PX, place)));
    // RowSpread a little up and down, so that equal seeds show.
    let height = |seed: usize| MIDDLE_PX + [0.0, -4.0, 4.0, -2.0, 2.0][seed % 5];
    let drawing = html! {
        path .axis d={ "M" (FROM_PX) " " (MIDDLE_PX) "H" (TO_PX) } {}
        @if let Some((from, to)) = band {
            rect .band x=(tenth(from - 2.0)) y="9" width=(tenth(to - from + 4.0)) height="12" rx="3" {}
        }
        @for (seed, value) in ours.values.iter().enumerate() {
            @match value {
                Some(value) => circle .dot cx=(tenth(place(*value))) cy=(height(seed)) r="2.5" {},
                None => circle .never cx=(NEVER_PX) cy=(height(seed)) r="2.5" {},
            }
        }
        @if let Some(mark) = mark { path .mark d={ "M" (tenth(place(mark))) " 3V27" } {} }
        @if let Some(median) = ours.median { circle .median cx=(tenth(place(median))) cy=(MIDDLE_PX) r="4.5" {} }
    };
    titled("Each dot is a seed; the upright line is the paper's number or the limit.", &drawing)
}

fn share(ours: &Numbers) -> Markup {
    let full = NEVER_PX - FROM_PX;
    let part = full * ours.good as f64 / ours.seeds.max(1) as f64;
    let drawing = html! {
        rect .rest x=(FROM_PX) y="11" width=(full) height="8" rx="4" {}
        rect .part x=(FROM_PX) y="11" width=(tenth(part)) height="8" rx="4" {}
    };
    titled("The filled part is the share of good seeds.", &drawing)
}

fn titled(title: &str, drawing: &Markup) -> Markup {
    html! {
        svg .strip viewBox={ "0 0 " (WIDTH_PX) " " (HEIGHT_PX) } width=(WIDTH_PX) height=(HEIGHT_PX) role="img" {
            title { (title) }
            (drawing)
        }
    }
}

fn tenth(px: f64) -> String {
    format!("{px:.1}")
}
