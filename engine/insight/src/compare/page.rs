//! The comparison as one page, whole in one file, without a script.

use maud::{Markup, PreEscaped, html};

use crate::shell::page_without_scripts;

use super::{Changes, ComparedFigure, ComparedState, Comparison, FigureSide, StateChoice, StateComparison};

const STYLE: &str = include_str!("compare.css");

/// The page, as one HTML text.
#[must_use]
pub fn compare_page(comparison: &Comparison) -> String {
    let title = format!("Compared: {}", comparison.runs.join(" and "));
    let body = html! {
        main {
            h1 { (title) }
            (figures(comparison))
            @if let Some(curves) = &comparison.curves_svg {
                section { h2 { "Learning" } figure { (PreEscaped(curves)) } }
            }
            @for (index, changes) in comparison.changes.iter().enumerate() {
                (changed(comparison, index + 1, changes))
            }
            @for (index, states) in comparison.states.iter().enumerate() {
                (states_of(comparison, index + 1, states))
            }
        }
    };
    page_without_scripts(&title, STYLE, &body)
}

fn figures(comparison: &Comparison) -> Markup {
    html! {
        section {
            h2 { "Figures" }
            table {
                thead { tr { th scope="col" { "" } @for run in &comparison.runs { th scope="col" { (run) } } } }
                tbody {
                    tr {
                        th scope="row" { "success, seeds" }
                        @for side in &comparison.success {
                            td {
                                (side.hits) " of " (side.seeds)
                                @if let Some([low, high]) = side.interval {
                                    small { (percent(low)) " to " (percent(high)) " %" }
                                }
                                (chance(side.chance))
                            }
                        }
                    }
                    @for figure in &comparison.figures { (row(figure)) }
                }
            }
            p.quiet {
                "Medians of the seeds. The interval below a figure holds the true median in 95 of 100 samples, whatever the "
                "distribution (order statistics; six seeds at least); that of success is Wilson's. "
                "p says how often two runs that do not differ would lie so far apart by chance: Fisher's exact test for success, "
                "the exact rank test for the others, each against the first run. With many figures some p below 0.05 is chance."
            }
        }
    }
}

fn row(figure: &ComparedFigure) -> Markup {
    html! {
        tr {
            th scope="row" { (figure.name) }
            @for side in &figure.sides {
                td {
                    (value(side.median, figure.places, figure.name))
                    @if let Some([low, high]) = side.interval {
                        small { (value(low, figure.places, figure.name)) " to " (value(high, figure.places, figure.name)) }
                    }
                    (chance(side.chance))
                }
            }
        }
    }
}

fn changed(comparison: &Comparison, index: usize, changes: &Changes) -> Markup {
    html! {
        section {
            h2 { "What was changed in " (comparison.runs[index]) }
            @if changes.is_empty() { p.quiet { "Nothing: the same script and the same settings." } }
            @if !changes.settings.is_empty() {
                table {
                    thead { tr { th scope="col" { "setting" } th scope="col" { (comparison.runs[0]) } th scope="col" { (comparison.runs[index]) } } }
                    tbody {
                        @for change in &changes.settings {
                            tr { th scope="row" { (change.name) } td { (change.before) } td { (change.after) } }
                        }
                    }
                }
            }
            @if !changes.lines.is_empty() {
                pre {
                    @for change in &changes.lines {
                        @if change.added { ins { "+ " (format!("{:>4}", change.line)) "  " (change.text) "\n" } }
                        @else { del { "- " (format!("{:>4}", change.line)) "  " (change.text) "\n" } }
                    }
                }
            }
        }
    }
}

fn states_of(comparison: &Comparison, index: usize, states: &StateComparison) -> Markup {
    html! {
        section {
            h2 { "States that want another action in " (comparison.runs[index]) }
            @match &states.unlike {
                Some(why) => p.quiet { "They cannot be compared: " (why) "." },
                None => {
                    p.quiet {
                        (states.differ) " of " (states.both_met) " states that both have met, in " (states.clear) " of them clearly: "
                        "by more than half of the seeds that met them, three at least, on both sides"
                        @if states.states.len() < states.differ { "; the " (states.states.len()) " most visited are shown" }
                        ". Of many seeds the action counts that most of them hold for the best."
                    }
                    @if !states.states.is_empty() {
                        table.states {
                            thead { tr {
                                th scope="col" { "state" } th scope="col" { "" }
                                th scope="col" { (comparison.runs[0]) } th scope="col" { (comparison.runs[index]) }
                            } }
                            tbody { @for state in &states.states { (state_row(state)) } }
                        }
                    }
                }
            }
        }
    }
}

fn state_row(state: &ComparedState) -> Markup {
    html! {
        tr {
            th scope="row" { (state.state) small { (state.text) } }
            td { @if let Some((rows, columns, filled)) = &state.cells { (cells(*rows, *columns, filled)) } }
            td.clear[state.is_clear()] { (choice(&state.before)) }
            td.clear[state.is_clear()] { (choice(&state.after)) }
        }
    }
}

fn choice(choice: &StateChoice) -> Markup {
    let [linear, angular] = choice.motion;
    let turn = if angular == 0.0 {
        "straight".to_owned()
    } else {
        format!("{} rad/s {}", angular.abs(), if angular > 0.0 { "left" } else { "right" })
    };
    html! { (linear) " m/s, " (turn) small { (choice.seeds) " of " (choice.met) " seeds, " (choice.visits) " visits" } }
}

fn cells(rows: usize, columns: usize, filled: &[bool]) -> Markup {
    let words = format!("{} of {} cells filled", filled.iter().filter(|cell| **cell).count(), rows * columns);
    html! {
        svg viewBox=(format!("0 0 {columns} {rows}")) width=(12 * columns) height=(12 * rows) role="img" aria-label=(words) {
            @for (index, cell) in filled.iter().enumerate() {
                rect.filled[*cell] x=(index % columns) y=(index / columns) width="0.9" height="0.9" {}
            }
        }
    }
}

fn chance(chance: Option<f64>) -> Markup {
    html! {
        @if let Some(chance) = chance { small.clear[chance < 0.05] { "p " (probability(chance)) } }
    }
}

/// A probability: `0.03`, `< 0.0001`.
pub(super) fn probability(chance: f64) -> String {
    match chance {
        chance if chance < 0.0001 => "< 0.0001".to_owned(),
        chance if chance < 0.1 => format!("= {chance:.4}"),
        chance => format!("= {chance:.2}"),
    }
}

fn percent(share: f64) -> String {
    format!("{:.0}", 100.0 * share)
}

/// A figure as text; of steps, nothing stands for never.
fn value(value: Option<f64>, places: usize, name: &str) -> String {
    match value {
        // No minus before a zero.
        Some(value) => format!("{:.places$}", if value == 0.0 { 0.0 } else { value }),
        None if name.starts_with("learned") => "never".to_owned(),
        None => "–".to_owned(),
    }
}

impl ComparedFigure {
    /// A side's median with its interval, for a terminal.
    #[must_use]
    pub fn words(&self, side: &FigureSide) -> String {
        let of = |number| value(number, self.places, self.name);
        let interval = side.interval.map_or(String::new(), |[low, high]| format!(" ({} to {})", of(low), of(high)));
        format!("{}{interval}{}", of(side.median), chance_words(side.chance))
    }
}

/// How likely it is by chance, for a terminal; nothing where it was not tested.
#[must_use]
pub fn chance_words(chance: Option<f64>) -> String {
    chance.map_or(String::new(), |chance| format!(", p {}", probability(chance)))
}
