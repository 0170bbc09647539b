//! The whole screen: what stands where, at which size.

use ratatui_core::buffer::Buffer;
use ratatui_core::layout::Rect;
use ratatui_core::text::{Line, Span};
use ratatui_core::widgets::Widget;

use super::ink::Ink;
use super::view::{Panel, View};
use super::words::{columns, fit, lines};
use super::{curve, findings, foot, rules, step, world};

/// Below this there is no room for anything but words.
const LEAST: (u16, u16) = (40, 12);
/// Rows that the world and the curve need to be of use.
const LEAST_TOP: u16 = 7;

/// Draws the screen as it is now.
pub fn draw(view: &View, area: Rect, buffer: &mut Buffer) {
    if area.width < LEAST.0 || area.height < LEAST.1 {
        let words = format!(
            "{} x {} is too small: make the window {} x {} or larger; q quits",
            area.width, area.height, LEAST.0, LEAST.1
        );
        for (row, line) in area.rows().zip(lines(&words, usize::from(area.width))) {
            write(&Line::raw(line), row, buffer);
        }
        return;
    }
    let [head, body, below] = rows(area, [2, 0, 2]);
    foot::head(view, head, buffer);
    foot::foot(view, below, buffer);
    if view.help {
        foot::help(view, body, buffer);
    } else if view.document().is_none() {
        if view.shown.error.is_some() {
            findings::error(view, body, buffer);
        } else {
            let words = if view.shown.text.is_empty() { "reading the behaviour" } else { &view.shown.text };
            let middle = Rect { y: body.y + body.height / 2, height: 1, ..body };
            write(&Line::raw(fit(words, usize::from(body.width))).centered(), middle, buffer);
        }
    } else {
        panels(view, body, buffer);
    }
}

fn panels(view: &View, body: Rect, buffer: &mut Buffer) {
    let wrong = view.shown.error.is_some();
    if let Some(panel) = view.large {
        // A mistake is shown whatever else is looked at.
        let notes = if wrong { findings::height(view, body.width).min(body.height / 2) } else { 0 };
        let [main, below] = rows(body, [0, notes]);
        panel_at(view, panel, main, buffer);
        if notes > 0 {
            findings::error(view, below, buffer);
        }
        return;
    }
    let most_notes = if wrong { body.height - LEAST_TOP.min(body.height) } else { (body.height / 5).max(3) };
    let notes_height = findings::height(view, body.width).min(most_notes);
    let mut rules_height = rules::height(view, body);
    if body.height < notes_height + rules_height + LEAST_TOP {
        rules_height = 0;
    }
    let [top, middle, below] = rows(body, [0, rules_height, notes_height]);
    top_panels(view, top, buffer);
    if rules_height > 0 {
        rules::draw(view, middle, buffer);
    }
    if wrong {
        findings::error(view, below, buffer);
    } else if notes_height > 0 {
        findings::draw(view, below, buffer);
    }
}

fn top_panels(view: &View, area: Rect, buffer: &mut Buffer) {
    if area.width < 64 {
        let half = if area.height >= 2 * LEAST_TOP { area.height / 2 } else { 0 };
        let [upper, lower] = rows(area, [0, half]);
        world::draw(view, upper, buffer);
        if half > 0 {
            curve::draw(view, lower, buffer);
        }
        return;
    }
    let left_width = if area.width >= 100 { area.width * 11 / 20 } else { area.width / 2 };
    let left = Rect { width: left_width, ..area };
    let right = Rect { x: area.x + left_width + 1, width: area.width - left_width - 1, ..area };
    world::draw(view, left, buffer);
    let step_height = if area.height >= 22 { (area.height / 2).min(step::height(view) + 1) } else { 0 };
    let [upper, lower] = rows(right, [0, step_height]);
    curve::draw(view, upper, buffer);
    if step_height > 0 {
        step::draw(view, lower, buffer);
    }
}

fn panel_at(view: &View, panel: Panel, area: Rect, buffer: &mut Buffer) {
    match panel {
        Panel::World => world::draw(view, area, buffer),
        Panel::Curve => curve::draw(view, area, buffer),
        Panel::Rules => rules::draw(view, area, buffer),
        Panel::Step => step::draw(view, area, buffer),
        Panel::Findings => findings::draw(view, area, buffer),
    }
}

/// Cuts an area into rows of these heights; the one of height 0 that comes first gets the rest.
fn rows<const N: usize>(area: Rect, heights: [u16; N]) -> [Rect; N] {
    let rest = area.height.saturating_sub(heights.iter().sum());
    let grows = heights.iter().position(|height| *height == 0);
    let (mut y, end) = (area.y, area.y + area.height);
    std::array::from_fn(|index| {
        let height = if Some(index) == grows { rest } else { heights[index] }.min(end - y);
        let row = Rect { y, height, ..area };
        y += height;
        row
    })
}

/// A panel's heading with a thin line to its right; the room below comes back.
pub(super) fn heading(title: &str, notes: Vec<Span<'_>>, area: Rect, buffer: &mut Buffer) -> Rect {
    let mut spans = vec![Span::styled(title.to_owned(), Ink::strong())];
    for note in notes {
        spans.push(Span::raw("  "));
        spans.push(note);
    }
    let used: usize = spans.iter().map(Span::width).sum();
    let rest = usize::from(area.width).saturating_sub(used + 1);
    spans.push(Span::styled(format!(" {}", "─".repeat(rest)), Ink::quiet()));
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
            write(&Line::styled(format!("… {hidden} more lines (Tab, PgDn)"), Ink::quiet()), at, buffer);
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
        write(&Line::styled(text, Ink::quiet()), at, buffer);
    }
}
