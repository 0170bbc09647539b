//! Lines of text on the screen: headings, lists that are cut, words where there is nothing to see.

use ratatui_core::buffer::Buffer;
use ratatui_core::layout::Rect;
use ratatui_core::text::{Line, Span};
use ratatui_core::widgets::Widget;

use super::ink::TerminalInk;
use super::words::{columns, fit};

/// A panel's heading with a thin line to its right; the room below comes back.
pub(super) fn heading(title: &str, notes: Vec<Span<'_>>, area: Rect, buffer: &mut Buffer) -> Rect {
    let mut spans = vec![Span::styled(title.to_owned(), TerminalInk::strong())];
    for note in notes {
        spans.push(Span::raw("  "));
        spans.push(note);
    }
    let used: usize = spans.iter().map(Span::width).sum();
    let rest = usize::from(area.width).saturating_sub(used + 1);
    spans.push(Span::styled(format!(" {}", "─".repeat(rest)), TerminalInk::quiet()));
    write(&Line::from(spans), Rect { height: 1.min(area.height), ..area }, buffer);
    Rect { y: area.y + 1.min(area.height), height: area.height.saturating_sub(1), ..area }
}

/// One line of text, cut at the area's right.
pub(super) fn write(line: &Line<'_>, area: Rect, buffer: &mut Buffer) {
    if area.height > 0 {
        line.render(area, buffer);
    }
}

/// Lines of text, cut below; one that says so stands where more follow.
pub(super) fn write_all(lines: &[Line<'_>], scroll: usize, area: Rect, buffer: &mut Buffer) {
    let room = usize::from(area.height);
    let scroll = scroll.min(lines.len().saturating_sub(room));
    for (row, line) in lines.iter().skip(scroll).take(room).enumerate() {
        let at = Rect { y: area.y + row as u16, height: 1, ..area };
        let hidden = lines.len() - scroll - row;
        if row + 1 == room && hidden > 1 {
            write(&Line::styled(format!("… {hidden} more lines (Tab, PgDn)"), TerminalInk::quiet()), at, buffer);
        } else {
            write(line, at, buffer);
        }
    }
}

/// A line with one text at its left and one at its right; the left one is cut.
pub(super) fn ends(left: Vec<Span<'_>>, right: Line<'_>, area: Rect, buffer: &mut Buffer) {
    let width = right.width().min(usize::from(area.width)) as u16;
    let room = area.width - width;
    write(&Line::from(left), Rect { width: room.saturating_sub(1), ..area }, buffer);
    write(&right, Rect { x: area.x + room, width, ..area }, buffer);
}

/// A text centred in an area that has nothing else to show.
pub(super) fn nothing(words: &str, area: Rect, buffer: &mut Buffer) {
    let text = fit(words, usize::from(area.width));
    let x = area.x + (area.width.saturating_sub(columns(&text) as u16)) / 2;
    let at = Rect { x, y: area.y + area.height / 2, width: area.width.saturating_sub(x - area.x), height: 1 };
    if area.height > 0 {
        write(&Line::styled(text, TerminalInk::quiet()), at, buffer);
    }
}
