//! The rules: what each adds, how often it fired, and when; those that fire in the shown step are lit.

use ratatui_core::buffer::Buffer;
use ratatui_core::layout::Rect;
use ratatui_core::style::{Modifier, Style};
use ratatui_core::text::{Line, Span};

use super::ink::TerminalInk;
use super::lines::{heading, write, write_all};
use super::story::part;
use super::view::View;
use super::words::{columns, fit, signed, total};
use insight::words::whole;

/// The most rules in the small panel.
const MOST: usize = 8;

/// Rows that the small panel takes.
pub(super) fn height(view: &View, body: Rect) -> u16 {
    let rules = view.document().map_or(0, |document| document.rules.len()).min(MOST) as u16;
    (1 + rules.max(1)).min(body.height / 3)
}

pub(super) fn draw_rules(view: &View, area: Rect, buffer: &mut Buffer) {
    let Some(document) = view.document() else { return };
    let longest = document.rules.iter().map(|rule| columns(&fit(&rule.name, 40))).max().unwrap_or(0);
    let name_width = longest.clamp(6, usize::from(area.width / 5).max(12));
    let table_width = name_width + 2 + 5 + 7 + 8 + 9;
    let rest = usize::from(area.width).saturating_sub(table_width + 2);
    let head = format!("{:<name_width$}{:>5}{:>7}{:>8}{:>9}", "", "line", "adds", "fired", "sum");
    let inner = heading("Rules", Vec::new(), area, buffer);
    let over =
        Rect { x: area.x + 6, width: (table_width as u16).saturating_sub(4).min(area.width - 6), height: 1, ..area };
    write(&Line::styled(format!("{}  ", &head[4..]), TerminalInk::quiet()), over, buffer);
    if document.rules.is_empty() {
        write(&Line::styled("this behaviour has no rules", TerminalInk::quiet()), inner, buffer);
        return;
    }
    let parts: Vec<Vec<u32>> = (0..document.rules.len()).map(|rule| view.story.parts(rule, rest)).collect();
    let most = parts.iter().flatten().copied().max().unwrap_or(0).max(1);
    let now = part(view.step, view.story.kept, rest);
    let lines: Vec<Line<'_>> = document
        .rules
        .iter()
        .enumerate()
        .map(|(rule, known)| {
            let (fired, style) = (view.fired(rule), view.ink.rule(&document.rules, rule));
            let name = fit(&known.name, name_width);
            let pad = " ".repeat(name_width - columns(&name));
            let name_style = if fired { TerminalInk::strong().add_modifier(Modifier::REVERSED) } else { Style::new() };
            let adds = known.value.map_or_else(|| "varies".to_owned(), signed);
            let count = whole(view.story.fired.get(rule).copied().unwrap_or(0));
            let sum = total(view.story.totals.get(rule).copied().unwrap_or(0.0));
            let numbers = format!("{pad}{:>5}{adds:>7}{count:>8}{sum:>9}  ", known.line);
            let mut spans = vec![
                Span::styled(format!("{} ", view.ink.chip(rule)), style),
                Span::styled(name, name_style),
                Span::styled(numbers, if fired { TerminalInk::strong() } else { Style::new() }),
            ];
            spans.extend(over_time(&parts[rule], most, now, style, known.value.is_none(), view.ink.fine));
            Line::from(spans)
        })
        .collect();
    write_all(&lines, view.scroll, inner, buffer);
}

/// How often a rule fired, from the first step to the last; the shown step stands out.
fn over_time(parts: &[u32], most: u32, now: usize, style: Style, varies: bool, fine: bool) -> Vec<Span<'static>> {
    let levels = if fine {
        ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█']
    } else {
        ['▄', '▄', '▄', '▄', '█', '█', '█', '█']
    };
    let glyph = |count: u32| match count {
        0 if varies => '┈',
        0 => '·',
        // A single firing can be seen beside a hundred: heights go with the square root.
        _ => levels[((f64::from(count) / f64::from(most)).sqrt() * 8.0).ceil().clamp(1.0, 8.0) as usize - 1],
    };
    let spans = parts.iter().enumerate().map(|(index, count)| {
        let (glyph, style) = match (index == now, *count) {
            (true, 0) => ('│', TerminalInk::strong()),
            (true, _) => (glyph(*count), style.add_modifier(Modifier::REVERSED)),
            (false, 0) => (glyph(0), TerminalInk::quiet()),
            (false, _) => (glyph(*count), style),
        };
        Span::styled(glyph.to_string(), style)
    });
    spans.collect()
}
