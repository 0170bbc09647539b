//! The shown step: state, action, the nearest thing, and what each rule said of it.

use ratatui_core::buffer::Buffer;
use ratatui_core::layout::Rect;
use ratatui_core::style::Style;
use ratatui_core::text::{Line, Span};

use super::chain::chain;
use super::ink::TerminalInk;
use super::lines::{heading, nothing, write, write_all};
use super::view::View;
use super::words::{fit, motion, side, signed};
use engine::experiment::{FactReasons, Record, RuleReasons};
use insight::page::ScanShape;
use insight::words::{typeset, whole};

/// The largest grid that is drawn cell by cell.
const MOST_CELLS: [usize; 2] = [6, 12];

/// Rows that it needs below its heading.
pub(super) fn height(view: &View) -> u16 {
    lines(view, 60).len().max(8) as u16
}

pub(super) fn draw_step(view: &View, area: Rect, buffer: &mut Buffer) {
    let inner = heading("This step", vec![Span::styled(whole(view.step as u64), TerminalInk::quiet())], area, buffer);
    if view.record().is_none() {
        nothing("no step is recorded", inner, buffer);
        return;
    }
    let grid = cells(view);
    let grid_width = grid.iter().map(Line::width).max().unwrap_or(0) as u16;
    let text = Rect { width: inner.width.saturating_sub(grid_width + 2), ..inner };
    write_all(&lines(view, usize::from(text.width)), view.scroll, text, buffer);
    for (row, line) in (0..inner.height).zip(&grid) {
        let place = Rect {
            x: inner.x + inner.width.saturating_sub(grid_width),
            y: inner.y + row,
            width: grid_width,
            height: 1,
        };
        write(line, place, buffer);
    }
}

fn lines(view: &View, width: usize) -> Vec<Line<'static>> {
    let (Some(record), Some(document)) = (view.record(), view.document()) else { return Vec::new() };
    let scan = document.scan;
    let entry = |name: &str, words: String| {
        let words = fit(&words, width.saturating_sub(9));
        Line::from(vec![Span::styled(format!("{name:<9}"), TerminalInk::quiet()), Span::raw(words)])
    };
    let action = document.actions.get(usize::from(record.action)).map_or_else(String::new, |action| motion(*action));
    let mut lines = vec![
        entry("state", format!("{} → {}", record.state, record.next_state)),
        entry("action", action),
        entry("nearest", format!("{:.2} m, {}", record.nearest_m, beam(usize::from(record.nearest_beam), scan))),
        entry("events", events(&record)),
        entry("reward", signed(record.reward)),
    ];
    if let Some(stages) = &document.stages {
        let name = |state: u32| stages.names.get(stages.of_state(state)).map_or("", String::as_str);
        let (from, to) = (name(record.state), name(record.next_state));
        lines.push(entry("stage", if from == to { from.to_owned() } else { format!("{from} → {to}") }));
    }
    let measures = view.moment().map_or(&[][..], |moment| &moment.measures);
    for (name, value) in document.measures.iter().zip(measures) {
        lines.push(entry("measure", format!("{name} {}", typeset(*value))));
    }
    for (rule, known) in document.rules.iter().enumerate() {
        let fired = view.fired(rule);
        // Of a reward that was swapped later, the step's own rule of this name.
        let reasons = view.moment().and_then(|moment| moment.reasons.rules.iter().find(|why| why.name == known.name));
        let style = if fired { TerminalInk::strong() } else { TerminalInk::quiet() };
        let words = reasons
            .map_or_else(|| if fired { "fired".to_owned() } else { "silent".to_owned() }, |why| said(why, fired));
        lines.push(Line::from(vec![
            Span::styled(format!("{} ", view.ink.chip(rule)), view.ink.rule(&document.rules, rule)),
            Span::styled(fit(&known.name, width.saturating_sub(12).min(30)), style),
            Span::styled(format!("  {words}"), if fired { Style::new() } else { TerminalInk::quiet() }),
        ]));
        let mut facts: Vec<String> =
            reasons.iter().flat_map(|why| &why.parts).flat_map(|part| &part.facts).map(|one| fact(one, scan)).collect();
        facts.dedup();
        lines.extend(
            facts
                .into_iter()
                .map(|words| Line::styled(format!("  {}", fit(&words, width.saturating_sub(2))), TerminalInk::quiet())),
        );
    }
    if let Some(value) = view.moment().and_then(|moment| moment.reasons.value.as_ref()) {
        lines.extend(chain(value, width));
    }
    lines
}

fn events(record: &Record) -> String {
    let all = [
        (record.contact, "contact"),
        (record.fallen, "fallen"),
        (record.then.is_some(), "recovery follows"),
        (record.explored, "explored"),
    ];
    let words: Vec<&str> = all.into_iter().filter(|(is, _)| *is).map(|(_, word)| word).collect();
    if words.is_empty() { "none".to_owned() } else { words.join(", ") }
}

fn said(why: &RuleReasons, fired: bool) -> String {
    let held = if why.needed > 1 { format!(", held {} of {} steps", why.held, why.needed) } else { String::new() };
    match why.added {
        Some(added) if fired => signed(added),
        _ if why.spent => "silent by 'once': it has fired".to_owned(),
        _ if !why.asked => "not asked: an earlier rule ended the step".to_owned(),
        _ => format!("silent{held}"),
    }
}

fn fact(fact: &FactReasons, scan: ScanShape) -> String {
    let value = match fact.unit {
        "metres" => format!("{} m", typeset(fact.value)),
        "share" => format!("{} %", typeset(100.0 * fact.value)),
        "" => (fact.value != 0.0).to_string(),
        unit => format!("{} {unit}", typeset(fact.value)),
    };
    let by = fact.beam.map_or_else(String::new, |number| format!(" ({})", beam(number, scan)));
    format!("{} = {value}{by}", fact.name)
}

fn beam(number: usize, scan: ScanShape) -> String {
    format!("beam {number}, {}", side((scan.first_rad + number as f64 * scan.apart_rad).to_degrees()))
}

/// The cells of the state that the step came to.
fn cells(view: &View) -> Vec<Line<'static>> {
    let (Some(moment), Some(document)) = (view.moment(), view.document()) else { return Vec::new() };
    let [rows, columns] = document.grid;
    if rows > MOST_CELLS[0] || columns > MOST_CELLS[1] {
        return Vec::new();
    }
    let row = |cells: &[bool]| {
        let cell = |filled: &bool| {
            if *filled { Span::styled("██", view.ink.accent()) } else { Span::styled("··", TerminalInk::quiet()) }
        };
        Line::from(cells.iter().map(cell).collect::<Vec<_>>())
    };
    let mut lines: Vec<Line<'static>> = moment.reasons.next_state.cells.chunks(columns.max(1)).map(row).collect();
    lines.push(Line::styled("grid", TerminalInk::quiet()));
    lines
}
