//! The page: one file that needs nothing else, for small and large screens, light and dark.

use std::fmt::Write;

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::claims::{CLAIMS, Claim};
use super::figures::Figure;
use super::job::Metric;
use super::row::{Numbers, Reproduction, Row, shown};
use super::strip::strip;
use super::verdict::Verdict;

const TITLE: &str = "The paper's figures and claims, measured again";
const STYLE: &str = include_str!("page.css");
/// The first row under each heading.
const HEADINGS: &[(&str, &str)] = &[
    ("states", "The state"),
    ("wall-learned", "Wall following"),
    ("corridor-learned", "Corridor following"),
    ("platform-learned", "Platform following"),
    ("object-learned", "Object following"),
    ("hallway", "The real corridor, other grids, aliasing"),
    ("low-obstacles", "Robustness"),
    ("longer-wall", "Beyond the paper"),
];
const VERDICTS: [Verdict; 5] =
    [Verdict::Reproduced, Verdict::Better, Verdict::Worse, Verdict::NotComparable, Verdict::NotMeasured];

/// The whole page as HTML.
#[must_use]
pub fn page(found: &Reproduction, figures: &[Figure]) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (TITLE) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                main {
                    (head(found))
                    @for (first, heading) in HEADINGS {
                        (group(heading, found.rows.iter().filter(|row| heading_of(row.id) == *heading)))
                        div .figures {
                            @for figure in figures.iter().filter(|figure| figure.beside == *first) { (drawn(figure)) }
                        }
                    }
                    footer {
                        "A task is learned at the first step from which four windows of 400 steps each have a reinforcement "
                        "of −1 or better. Tests drive the frozen policy at the lowest temperature. Net progress, distances "
                        "and paths come from the simulator's truth, which neither the learner nor the script sees."
                    }
                }
            }
        }
    };
    page.into_string()
}

fn head(found: &Reproduction) -> Markup {
    let last = found.seed.wrapping_add(found.seeds - 1);
    html! {
        h1 { (TITLE) }
        p .lead {
            "Quintía, Domenech, Gamallo and Regueiro, “Methodology for learning visual reactive behaviours in robotics "
            "through reinforcement and image-based states” (ICINCO 2007), beside what this engine measures in its own "
            "worlds with seeds " (found.seed) " to " (last) ". Every verdict follows from the numbers by the rule that "
            "stands with it."
        }
        @if found.quick {
            p .quick { "Quick check: two seeds and few steps. The verdicts mean nothing." }
        }
        ul .counts {
            @for verdict in VERDICTS {
                li class=(class(verdict)) {
                    b { (found.rows.iter().filter(|row| row.verdict == verdict).count()) }
                    (verdict.word())
                }
            }
        }
        p .key {
            "In the drawings a small dot is a seed, the large one the median, the band the quartiles, the dashed line the "
            "paper’s number or the limit; hollow dots at the right never learned."
        }
    }
}

fn group<'a>(heading: &str, rows: impl Iterator<Item = &'a Row>) -> Markup {
    let mut rows = rows.peekable();
    html! {
        @if rows.peek().is_some() {
            h2 { (heading) }
            div .rows {
                @for row in rows { (compared(row)) }
            }
        }
    }
}

fn heading_of(id: &str) -> &'static str {
    let place = |id: &str| CLAIMS.iter().position(|claim| claim.id == id);
    HEADINGS.iter().rev().find(|(first, _)| place(first) <= place(id)).map_or("", |(_, heading)| heading)
}

fn class(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Reproduced => "reproduced",
        Verdict::Better => "better",
        Verdict::Worse => "worse",
        Verdict::NotComparable => "not-comparable",
        Verdict::NotMeasured => "not-measured",
    }
}

/// A claim with its numbers, as a row.
fn compared(row: &Row) -> Markup {
    let section = if row.section == "-" { "not in the paper".to_owned() } else { format!("section {}", row.section) };
    let claim = CLAIMS.iter().find(|claim| claim.id == row.id);
    html! {
        article .row id=(row.id) {
            div .what {
                h3 { (row.claim) }
                p .section { (section) }
                p .reason { (row.reason) }
                details {
                    summary { "rule and command" }
                    p { "The verdict: " (row.rule) "." }
                    pre { (row.command) }
                }
            }
            div {
                span .label { "paper" }
                span .number { (if row.paper.is_empty() { "—" } else { row.paper }) }
            }
            div {
                span .label { "here" }
                span .number { (row.ours.as_ref().map_or("—", |ours| &ours.text)) }
                @if let (Some(ours), Some(claim)) = (&row.ours, claim) { div .small { (spread(claim, ours)) } }
            }
            div .drawn {
                @if let (Some(ours), Some(claim)) = (&row.ours, claim) { (strip(claim, ours)) }
            }
            span class={ "pill " (class(row.verdict)) } { (row.verdict.word()) }
        }
    }
}

/// Quartiles, the worst seed and the good ones.
fn spread(claim: &Claim, ours: &Numbers) -> Markup {
    let value = |value: Option<f64>| shown(value.unwrap_or(f64::INFINITY), claim.metric.manner().decimals);
    html! {
        @if claim.metric == Metric::NeverLost {
            (ours.good_means)
        } @else if ours.values.iter().all(|value| *value == ours.median) {
            "all " (ours.seeds) " seeds"
        } @else {
            "quartiles " (value(ours.quartile_low)) " to " (value(ours.quartile_high)) br;
            "worst " (value(ours.worst)) br;
            @if ours.good_means != "measured" { (ours.good) " of " }
            (ours.seeds) " "
            (if ours.good_means == "measured" { "seeds" } else { ours.good_means })
        }
    }
}

fn drawn(figure: &Figure) -> Markup {
    html! {
        figure id=(figure.id) class=(if figure.is_photograph { "photograph" } else { "drawing" }) {
            div .picture { img alt=(figure.caption) src={ "data:image/svg+xml," (Encoded(&figure.svg)) }; }
            figcaption {
                b { (figure.title) }
                (figure.caption)
            }
        }
    }
}

/// A document, percent-encoded to follow the head of a `data:` address.
struct Encoded<'a>(&'a str);

impl std::fmt::Display for Encoded<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for byte in self.0.bytes() {
            match byte {
                b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b' ' | b'-' | b'.' | b',' | b'=' | b'(' | b')' | b';' => {
                    f.write_char(char::from(byte))?;
                }
                _ => write!(f, "%{byte:02X}")?,
            }
        }
        Ok(())
    }
}
