//! The rules: what each adds, how often it fired, and when; those that fire in the shown step are lit. Below them the
//! stages and the measures.

use ratatui_core::buffer::Buffer;
use ratatui_core::layout::Rect;
use ratatui_core::style::{Modifier, Style};
use ratatui_core::text::{Line, Span};

use super::ink::TerminalInk;
use super::lines::{heading, write, write_all};
use super::story::part;
use super::view::View;
use super::words::{columns, fit, signed, total};
use insight::page::Document;
use insight::words::{typeset, whole};

/// The most rules in the small panel.
const MOST: usize = 8;

/// Rows that the small panel takes.
pub(super) fn height(view: &View, body: Rect) -> u16 {
    let stages = |document: &Document| document.stages.as_ref().map_or(0, |stages| stages.names.len());
    let all = |document: &Document| document.rules.len() + stages(document) + document.measures.len();
    let rules = view.document().map_or(0, all).min(MOST) as u16;
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
    let mut lines: Vec<Line<'_>> = document
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
            let over_time = Bars { now, style, fine: view.ink.fine };
            spans.extend(match known.value {
                Some(_) => over_time.counts(&parts[rule], most),
                None => over_time.sums(&view.story.sums(rule, rest), view.ink.bad()),
            });
            Line::from(spans)
        })
        .collect();
    lines.extend(stages(view, document, name_width, rest));
    lines.extend(measures(view, document, name_width, rest));
    write_all(&lines, view.scroll, inner, buffer);
}

/// The stages: in how many steps the robot was in each, and when.
fn stages<'a>(view: &View, document: &'a Document, name_width: usize, rest: usize) -> Vec<Line<'a>> {
    let (Some(stages), Some(record)) = (&document.stages, view.record()) else { return Vec::new() };
    let (present, now) = (stages.of_state(record.state), part(view.step, view.story.kept, rest));
    let line = |(stage, name): (usize, &'a String)| {
        let (parts, is_present) = (view.story.steps_in(stage, rest.max(1)), stage == present);
        let name = fit(name, name_width);
        let pad = " ".repeat(name_width - columns(&name));
        let steps = whole(parts.iter().map(|steps| u64::from(*steps)).sum());
        let name_style = if is_present { TerminalInk::strong().add_modifier(Modifier::REVERSED) } else { Style::new() };
        let mut spans = vec![
            Span::styled("◆ ", view.ink.accent()),
            Span::styled(name, name_style),
            Span::raw(format!("{pad}{:>12}{steps:>8}{:>9}  ", "in stage", "steps")),
        ];
        let all = view.story.kept.div_ceil(rest.max(1)).max(1) as u32;
        let bars = Bars { now, style: view.ink.accent(), fine: view.ink.fine };
        spans.extend(bars.counts(&parts[..rest.min(parts.len())], all));
        Line::from(spans)
    };
    stages.names.iter().enumerate().map(line).collect()
}

/// The measures: each between its least and its greatest mean, and its value in the shown step.
fn measures<'a>(view: &View, document: &'a Document, name_width: usize, rest: usize) -> Vec<Line<'a>> {
    let now = part(view.step, view.story.kept, rest);
    let word = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |value| fit(&typeset(value), 8));
    let line = |(measure, name): (usize, &'a String)| {
        let name = fit(name, name_width);
        let pad = " ".repeat(name_width - columns(&name));
        let value = view.moment().and_then(|moment| moment.measures.get(measure).copied());
        let range = view.traces().and_then(|traces| traces.range(measure));
        let [value, least, most] = [value, range.map(|range| range[0]), range.map(|range| range[1])].map(word);
        let right = |text: &str, width: usize| format!("{}{text}", " ".repeat(width.saturating_sub(columns(text))));
        let numbers = format!("{pad}{}{}{}  ", right(&value, 12), right(&least, 8), right(&most, 9));
        let mut spans = vec![Span::styled("∿ ", view.ink.accent()), Span::raw(name), Span::raw(numbers)];
        let bars = Bars { now, style: view.ink.accent(), fine: view.ink.fine };
        let heights = view.traces().map_or_else(|| vec![None; rest], |traces| traces.heights(measure, rest));
        spans.extend(bars.heights(&heights));
        Line::from(spans)
    };
    document.measures.iter().enumerate().map(line).collect()
}

/// Bars from the first step to the last; the part with the shown step stands out.
struct Bars {
    now: usize,
    style: Style,
    fine: bool,
}

impl Bars {
    /// How often something was in each part, beside the most of anything.
    fn counts(&self, parts: &[u32], most: u32) -> Vec<Span<'static>> {
        let bars = parts.iter().map(|count| (f64::from(*count) / f64::from(most.max(1)), self.style));
        self.spans(bars, '·')
    }

    /// What was added in each part, beside the most in any; what took away is in the style `bad`.
    fn sums(&self, parts: &[f64], bad: Style) -> Vec<Span<'static>> {
        let most = parts.iter().fold(0.0, |most, sum| sum.abs().max(most)).max(f64::MIN_POSITIVE);
        let bars = parts.iter().map(|sum| (sum.abs() / most, if *sum < 0.0 { bad } else { self.style }));
        self.spans(bars, '┈')
    }

    /// How high something was in each part, 0 to 1; nothing where it was not known.
    fn heights(&self, heights: &[Option<f64>]) -> Vec<Span<'static>> {
        // Squared, since bars go with the square root; the lowest is seen too.
        let bars = heights.iter().map(|height| (height.map_or(0.0, |height| (height * height).max(1e-4)), self.style));
        self.spans(bars, '·')
    }

    fn spans(&self, bars: impl Iterator<Item = (f64, Style)>, none: char) -> Vec<Span<'static>> {
        let levels = if self.fine {
            ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█']
        } else {
            ['▄', '▄', '▄', '▄', '█', '█', '█', '█']
        };
        // A single firing can be seen beside a hundred: heights go with the square root.
        let level = |share: f64| levels[(share.sqrt() * 8.0).ceil().clamp(1.0, 8.0) as usize - 1];
        let spans = bars.enumerate().map(|(index, (share, style))| {
            let (glyph, style) = match (index == self.now, share > 0.0) {
                (true, false) => ('│', TerminalInk::strong()),
                (true, true) => (level(share), style.add_modifier(Modifier::REVERSED)),
                (false, false) => (none, TerminalInk::quiet()),
                (false, true) => (level(share), style),
            };
            Span::styled(glyph.to_string(), style)
        });
        spans.collect()
    }
}
