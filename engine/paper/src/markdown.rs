//! The rows as a Markdown table.

use super::row::Reproduction;

/// The table, with a line above it that says how it came about.
#[must_use]
pub fn markdown(found: &Reproduction) -> String {
    let mut out = String::new();
    if found.quick {
        out.push_str("**Quick check: few steps, two seeds. The verdicts mean nothing.**\n\n");
    }
    let last = found.seed.wrapping_add(found.seeds - 1);
    out.push_str(&format!("Seeds {} to {last}; fewer where the page says so.\n\n", found.seed));
    out.push_str("| section | claim | paper | here (median; good seeds) | verdict |\n|---|---|---|---|---|\n");
    for row in &found.rows {
        let ours = match &row.ours {
            Some(ours) if ours.text.contains(" of ") && ours.median.is_some_and(|value| value <= 1.0) => {
                ours.text.clone()
            }
            Some(ours) if ours.good_means == "measured" => ours.text.clone(),
            Some(ours) => format!("{}; {} of {} {}", ours.text, ours.good, ours.seeds, ours.good_means),
            None => row.reason.clone(),
        };
        let cells = [row.section, row.claim, row.paper, &ours, row.verdict.word()].map(escaped);
        out.push_str(&format!("| {} |\n", cells.join(" | ")));
    }
    out
}

fn escaped(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}
