//! The page: one file that needs nothing else, for a phone as for a desk, by day and by night.

use std::fmt::Write;

use super::claims::CLAIMS;
use super::figures::Figure;
use super::row::{Numbers, Reproduction, Row, shown};
use super::strip::strip;
use super::verdict::Verdict;

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
    let mut out = String::from(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>The paper's figures and claims, measured again</title>\n<style>\n",
    );
    out.push_str(STYLE);
    out.push_str("</style>\n</head>\n<body>\n<main>\n");
    head(&mut out, found);
    for (first, heading) in HEADINGS {
        let rows: Vec<&Row> = found.rows.iter().filter(|row| heading_of(row.id) == *heading).collect();
        if !rows.is_empty() {
            let _ = write!(out, "<h2>{}</h2>\n<div class=\"rows\">\n", Escaped(heading));
            rows.iter().for_each(|row| write_row(&mut out, row));
            out.push_str("</div>\n");
        }
        write_figures(&mut out, figures.iter().filter(|figure| figure.beside == *first));
    }
    out.push_str(
        "<footer>A task is learned at the first step from which four windows of 400 steps each have a reinforcement of \
         −1 or better. Tests drive the frozen policy at the lowest temperature. Net progress, distances and paths come \
         from the simulator's truth, which neither the learner nor the script sees.</footer>\n</main>\n</body>\n</html>\n",
    );
    out
}

fn head(out: &mut String, found: &Reproduction) {
    let last = found.seed.wrapping_add(found.seeds - 1);
    let _ = write!(
        out,
        "<h1>The paper's figures and claims, measured again</h1>\n<p class=\"lead\">Quintía, Domenech, Gamallo and \
         Regueiro, “Methodology for learning visual reactive behaviours in robotics through reinforcement and \
         image-based states” (ICINCO 2007), beside what this engine measures in its own worlds with seeds {} to {last}. \
         Every verdict follows from the numbers by the rule that stands with it.</p>\n",
        found.seed
    );
    if found.quick {
        out.push_str("<p class=\"quick\">Quick check: two seeds and few steps. The verdicts mean nothing.</p>\n");
    }
    out.push_str("<ul class=\"counts\">\n");
    for verdict in VERDICTS {
        let count = found.rows.iter().filter(|row| row.verdict == verdict).count();
        let _ = writeln!(out, "<li class=\"{}\"><b>{count}</b>{}</li>", class(verdict), verdict.word());
    }
    out.push_str(
        "</ul>\n<p class=\"key\">In the drawings a small dot is a seed, the large one the median, the band the \
         quartiles, the dashed line the paper’s number or the limit; hollow dots at the right never learned.</p>\n",
    );
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

fn write_row(out: &mut String, row: &Row) {
    let section = if row.section == "-" { "not in the paper".to_owned() } else { format!("section {}", row.section) };
    let _ = write!(
        out,
        "<article class=\"row\" id=\"{}\">\n<div class=\"what\"><h3>{}</h3><p class=\"section\">{}</p>\
         <p class=\"reason\">{}</p><details><summary>rule and command</summary><p>The verdict: {}.</p><pre>{}</pre>\
         </details></div>\n",
        Escaped(row.id),
        Escaped(row.claim),
        Escaped(&section),
        Escaped(&row.reason),
        Escaped(&row.rule),
        Escaped(&row.command)
    );
    let paper = if row.paper.is_empty() { "—" } else { row.paper };
    let _ =
        writeln!(out, "<div><span class=\"label\">paper</span><span class=\"number\">{}</span></div>", Escaped(paper));
    out.push_str("<div><span class=\"label\">here</span>");
    match &row.ours {
        Some(ours) => {
            let _ = write!(out, "<span class=\"number\">{}</span>{}", Escaped(&ours.text), spread(row, ours));
        }
        None => out.push_str("<span class=\"number\">—</span>"),
    }
    out.push_str("</div>\n<div class=\"drawn\">");
    if let (Some(ours), Some(claim)) = (&row.ours, CLAIMS.iter().find(|claim| claim.id == row.id)) {
        out.push_str(&strip(claim, ours));
    }
    let _ =
        write!(out, "</div>\n<span class=\"pill {}\">{}</span>\n</article>\n", class(row.verdict), row.verdict.word());
}

/// Quartiles, the worst seed and the good ones, in small letters.
fn spread(row: &Row, ours: &Numbers) -> String {
    let Some(claim) = CLAIMS.iter().find(|claim| claim.id == row.id) else { return String::new() };
    let decimals = claim.metric.manner().decimals;
    let good = if ours.good_means == "measured" {
        format!("{} seeds", ours.seeds)
    } else {
        format!("{} of {} {}", ours.good, ours.seeds, ours.good_means)
    };
    if claim.metric == super::job::Metric::NeverLost {
        return format!("<div class=\"small\">{}</div>", Escaped(ours.good_means));
    }
    if ours.values.iter().all(|value| *value == ours.median) {
        return format!("<div class=\"small\">all {} seeds</div>", ours.seeds);
    }
    let value = |value: Option<f64>| shown(value.unwrap_or(f64::INFINITY), decimals);
    format!(
        "<div class=\"small\">quartiles {} to {}<br>worst {}<br>{}</div>",
        Escaped(&value(ours.quartile_low)),
        Escaped(&value(ours.quartile_high)),
        Escaped(&value(ours.worst)),
        Escaped(&good)
    )
}

fn write_figures<'a>(out: &mut String, figures: impl Iterator<Item = &'a Figure>) {
    out.push_str("<div class=\"figures\">\n");
    for figure in figures {
        let kind = if figure.is_photograph { "photograph" } else { "drawing" };
        let _ = writeln!(
            out,
            "<figure id=\"{}\" class=\"{kind}\"><div class=\"picture\"><img alt=\"{}\" src=\"data:image/svg+xml,{}\">\
             </div><figcaption><b>{}</b>{}</figcaption></figure>",
            Escaped(&figure.id),
            Escaped(&figure.caption),
            Encoded(&figure.svg),
            Escaped(&figure.title),
            Escaped(&figure.caption)
        );
    }
    out.push_str("</div>\n");
}

/// Text that may hold anything, made safe for HTML.
struct Escaped<'a>(&'a str);

impl std::fmt::Display for Escaped<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for letter in self.0.chars() {
            match letter {
                '&' => f.write_str("&amp;")?,
                '<' => f.write_str("&lt;")?,
                '>' => f.write_str("&gt;")?,
                '"' => f.write_str("&quot;")?,
                '\'' => f.write_str("&#39;")?,
                _ => f.write_char(letter)?,
            }
        }
        Ok(())
    }
}

/// A document as the rest of a data address.
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
