//! What the lint found, and the mistake of a bad save with the writer's own line.

use ratatui_core::buffer::Buffer;
use ratatui_core::layout::Rect;
use ratatui_core::style::Style;
use ratatui_core::text::{Line, Span};

use super::ink::TerminalInk;
use super::lines::{heading, nothing, write_all};
use super::view::View;
use super::words::{fit, lines};
use engine::diagnostic::printable;

/// Rows that the panel needs: of the mistake if there is one, else of the findings; none if there is nothing to say.
pub(super) fn height(view: &View, width: u16) -> u16 {
    let text = if view.shown.error.is_some() { error_lines(view, width) } else { found(view, width) };
    if text.is_empty() { 0 } else { (1 + text.len()) as u16 }
}

pub(super) fn draw_findings(view: &View, area: Rect, buffer: &mut Buffer) {
    let lines = found(view, area.width);
    let count = view.document().map_or(0, |document| document.findings.len());
    let notes = if count > 0 { vec![Span::styled(count.to_string(), view.ink.warning())] } else { Vec::new() };
    let inner = heading("Findings", notes, area, buffer);
    if lines.is_empty() {
        nothing("none: the lint has nothing to say about this behaviour", inner, buffer);
    }
    write_all(&lines, view.scroll, inner, buffer);
}

pub(super) fn error(view: &View, area: Rect, buffer: &mut Buffer) {
    let stays = if view.shown.run.is_some() { "the last good run stays on screen" } else { "nothing is learned yet" };
    let notes = vec![Span::styled(stays, view.ink.bad())];
    let inner = heading("This save cannot be learned", notes, area, buffer);
    write_all(&error_lines(view, area.width), view.scroll, inner, buffer);
}

fn found(view: &View, width: u16) -> Vec<Line<'static>> {
    let Some(document) = view.document() else { return Vec::new() };
    let mut out = Vec::new();
    for finding in &document.findings {
        let place = finding.line.map_or_else(String::new, |line| format!("line {line}: "));
        let words = printable(&format!("{} {place}{}", finding.code, finding.message));
        for (row, text) in lines(&words, usize::from(width).saturating_sub(2)).into_iter().enumerate() {
            let code = text.strip_prefix(&finding.code).filter(|_| row == 0);
            out.push(match code {
                Some(rest) => {
                    let code = Span::styled(finding.code.clone(), TerminalInk::strong().patch(view.ink.warning()));
                    Line::from(vec![code, Span::raw(rest.to_owned())])
                }
                None => Line::raw(format!("  {text}")),
            });
        }
        let help = printable(finding.help.as_deref().unwrap_or_default());
        out.extend(
            lines(&help, usize::from(width).saturating_sub(4))
                .into_iter()
                .map(|text| Line::styled(format!("  {text}"), TerminalInk::quiet())),
        );
    }
    // What a cheat would earn, once the save was tried out.
    let exploits = document.checked.as_ref().and_then(|checked| checked.exploits.as_ref());
    let sentence = printable(exploits.map_or("", |exploits| &exploits.sentence));
    out.extend(lines(&sentence, usize::from(width)).into_iter().map(|text| Line::styled(text, TerminalInk::quiet())));
    out
}

fn error_lines(view: &View, width: u16) -> Vec<Line<'static>> {
    let Some(error) = &view.shown.error else { return Vec::new() };
    let text = error.render(false);
    let lines = text.trim_end().lines().map(|line| {
        let line = fit(line, usize::from(width));
        // The caret and what is written beside it.
        match line.find('^').filter(|at| line[..*at].trim_end().ends_with('|')) {
            Some(at) => {
                Line::from(vec![Span::raw(line[..at].to_owned()), Span::styled(line[at..].to_owned(), view.ink.bad())])
            }
            None if line.starts_with("error") => Line::styled(line, TerminalInk::strong().patch(view.ink.bad())),
            None => Line::styled(line, Style::new()),
        }
    });
    lines.collect()
}
