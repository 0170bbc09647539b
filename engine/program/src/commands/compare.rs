//! `engine compare`: runs beside one another.

use engine::diagnostic::Result;
use insight::compare::{Comparison, Side, StateComparison, chance_words, compare_page};
use insight::disk::{Together, write_atomic};
use insight::folder::write_json;

use super::sources::catalogue;
use super::words::motion;
use crate::cli::CompareArguments;
use crate::console::{Console, ConsoleError};

/// States, settings and lines that a person is shown.
const SHOWN: usize = 12;
const PAGE: &str = "compare.html";

pub(crate) fn run(arguments: &CompareArguments, console: &mut Console) -> std::result::Result<u8, ConsoleError> {
    let filters = catalogue(&arguments.filters)?;
    let sides = arguments.runs.iter().map(|run| Side::load(run, &filters)).collect::<Result<Vec<_>>>()?;
    let comparison = Comparison::new(&sides)?;
    let (together, page) = (Together::into(&arguments.out)?, arguments.out.join(PAGE));
    write_atomic(&together.folder().join(PAGE), compare_page(&comparison).as_bytes())?;
    write_json(&together.folder().join("compare.json"), &comparison)?;
    together.commit()?;
    console.json(&comparison)?;
    print(console, &comparison)?;
    console.line(&format!("page:      {}", page.display()))?;
    Ok(0)
}

fn print(console: &mut Console, comparison: &Comparison) -> std::result::Result<(), ConsoleError> {
    for (index, name) in comparison.runs.iter().enumerate() {
        let side = &comparison.success[index];
        let interval = side
            .interval
            .map_or(String::new(), |[low, high]| format!(" ({:.0} to {:.0} %)", 100.0 * low, 100.0 * high));
        console.line(name)?;
        let seeds = if side.seeds == 1 { "seed" } else { "seeds" };
        console.line(&format!(
            "  {:22}{} of {} {seeds}{interval}{}",
            "success",
            side.hits,
            side.seeds,
            chance_words(side.chance)
        ))?;
        for figure in &comparison.figures {
            console.line(&format!("  {:22}{}", figure.name, figure.words(&figure.sides[index])))?;
        }
        if let Some(other) = index.checked_sub(1) {
            print_changes(console, comparison, other)?;
            print_states(console, &comparison.states[other])?;
        }
    }
    Ok(())
}

fn print_changes(
    console: &mut Console,
    comparison: &Comparison,
    other: usize,
) -> std::result::Result<(), ConsoleError> {
    let changes = &comparison.changes[other];
    if changes.is_empty() {
        return console.line("  changed               nothing: the same script and settings");
    }
    for change in changes.settings.iter().take(SHOWN) {
        console.line(&format!("  changed               {}: {} -> {}", change.name, change.before, change.after))?;
    }
    for change in changes.lines.iter().take(SHOWN) {
        let sign = if change.added { '+' } else { '-' };
        console.line(&format!("  {sign} line {:<15}{}", change.line, change.text))?;
    }
    let more = changes.settings.len().saturating_sub(SHOWN) + changes.lines.len().saturating_sub(SHOWN);
    if more > 0 { console.line(&format!("  ... and {more} more changes: see the page")) } else { Ok(()) }
}

fn print_states(console: &mut Console, states: &StateComparison) -> std::result::Result<(), ConsoleError> {
    if let Some(why) = &states.unlike {
        return console.line(&format!("  states                cannot be compared: {why}"));
    }
    let StateComparison { differ, both_met, clear, .. } = states;
    console.line(&format!(
        "  states                {differ} of {both_met} that both met want another action, {clear} of them clearly"
    ))?;
    for state in states.states.iter().filter(|state| state.is_clear()).take(SHOWN) {
        console.line(&format!(
            "    {:<6}{:24} {} -> {}",
            state.state,
            state.text,
            motion(state.before.motion),
            motion(state.after.motion)
        ))?;
    }
    Ok(())
}
