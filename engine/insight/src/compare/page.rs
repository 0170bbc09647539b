//! The comparison as one page, whole in one file, without a script.

use maud::{Markup, PreEscaped, html};

use crate::report::{CurveStyle, has_bands};
use crate::shell::page_without_scripts;
use engine::experiment::WINDOW_STEPS;

use super::{Changes, ComparedFigure, ComparedState, Comparison, FigureSide, StateChoice, StateComparison};

const STYLE: &str = include_str!("compare.css");
/// Of more runs than these, what was changed and which states differ has to be opened.
const MOST_OPEN: usize = 4;

/// The page, as one HTML text.
#[must_use]
pub fn compare_page(comparison: &Comparison) -> String {
    let title = match comparison.runs.as_slice() {
        [first, others @ ..] if others.len() > 3 => format!("Compared: {first} and {} others", others.len()),
        runs => format!("Compared: {}", runs.join(" and ")),
    };
    let body = html! {
        main {
            h1 { (title) }
            (figures(comparison))
            @if let Some(curves) = &comparison.curves_svg { (learning(comparison, curves)) }
            @for (index, changes) in comparison.changes.iter().enumerate() {
                (folded(comparison, &format!("What was changed in {}", comparison.runs[index + 1]),
                    &changed(comparison, index + 1, changes)))
            }
            @for (index, states) in comparison.states.iter().enumerate() {
                (folded(comparison, &format!("States that want another action in {}", comparison.runs[index + 1]),
                    &states_of(comparison, index + 1, states)))
            }
        }
    };
    page_without_scripts(&title, STYLE, &body)
}

/// A section under its heading; of many runs it has to be opened.
fn folded(comparison: &Comparison, heading: &str, content: &Markup) -> Markup {
    html! {
        section {
            @if comparison.runs.len() > MOST_OPEN {
                details { summary { h2 { (heading) } } (content) }
            } @else {
                h2 { (heading) }
                (content)
            }
        }
    }
}

/// The curves, with what each line is, and what lines and bands are, in words.
fn learning(comparison: &Comparison, curves: &str) -> Markup {
    let bands = has_bands(comparison.runs.len());
    html! {
        section {
            h2 { "Learning" }
            ul.legend.inked {
                @for (index, run) in comparison.runs.iter().enumerate() { li { (line_of(index)) " " (run) } }
            }
            figure.inked { (PreEscaped(curves)) }
            p.quiet {
                "The sum of the rewards of every " (WINDOW_STEPS) " steps of learning. "
                @if comparison.several {
                    "A line is the median of a run's seeds in each window, so that it may go from one seed to another"
                    @if bands { "; the band around it goes from the lower to the upper quartile: half of the seeds lie in it" }
                    @else { "; of so many runs the bands of the quartiles are left out" }
                    ". A run of one seed is its own line."
                }
            }
        }
    }
}

/// A piece of a run's line.
fn line_of(run: usize) -> Markup {
    let CurveStyle { rgb: [red, green, blue], dashes } = CurveStyle::of(run);
    let dashes: Vec<String> = dashes.iter().map(f64::to_string).collect();
    html! {
        svg viewBox="0 0 64 8" width="64" height="8" aria-hidden="true" {
            line x1="2" y1="4" x2="62" y2="4" stroke=(format!("#{red:02x}{green:02x}{blue:02x}")) stroke-width="3"
                stroke-linecap="round" stroke-dasharray=(dashes.join(" ")) {}
        }
    }
}

/// Seeds in words: `1 to 30`, `3`, `1, 4, 9`.
fn seeds_in_words(seeds: &[u64]) -> String {
    let follow = seeds.windows(2).all(|two| two[0].checked_add(1) == Some(two[1]));
    match seeds {
        [first, .., last] if follow => format!("{first} to {last}"),
        seeds => seeds.iter().map(u64::to_string).collect::<Vec<_>>().join(", "),
    }
}

fn figures(comparison: &Comparison) -> Markup {
    let others = comparison.seeds.iter().any(|seeds| *seeds != comparison.seeds[0]);
    html! {
        section {
            h2 { "Figures" }
            table.runs {
                thead { tr { th scope="col" { "" } @for run in &comparison.runs { th scope="col" { (run) } } } }
                tbody {
                    tr {
                        th scope="row" { "seeds" }
                        @for seeds in &comparison.seeds { td { (seeds_in_words(seeds)) } }
                    }
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
                "Medians of the seeds, each figure's on its own: two figures of a run may be those of different seeds. "
                @if others { "The runs have different seeds, so that chance differs between them too. " }
                "The interval below a figure holds the true median in 95 of 100 samples, whatever the "
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

fn states_of(comparison: &Comparison, index: usize, states: &StateComparison) -> Markup {
    html! {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seeds_that_follow_one_another_are_told_by_their_ends() {
        assert_eq!(seeds_in_words(&[1, 2, 3]), "1 to 3");
        assert_eq!((seeds_in_words(&[7]), seeds_in_words(&[1, 4, 9])), ("7".to_owned(), "1, 4, 9".to_owned()));
    }
}
