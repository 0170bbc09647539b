//! The whole screen: what stands where, at which size.

use ratatui_core::buffer::Buffer;
use ratatui_core::layout::Rect;
use ratatui_core::text::Line;

use super::lines::write;
use super::view::{Panel, View};
use super::words::{fit, lines};
use super::{curve, findings, foot, rules, step, world};

/// Below this there is no room for anything but words.
const LEAST: (u16, u16) = (40, 12);
/// Rows that the world and the curve need to be of use.
const LEAST_TOP: u16 = 7;

/// Draws the screen as it is now.
pub fn draw_screen(view: &View, area: Rect, buffer: &mut Buffer) {
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
        rules::draw_rules(view, middle, buffer);
    }
    if wrong {
        findings::error(view, below, buffer);
    } else if notes_height > 0 {
        findings::draw_findings(view, below, buffer);
    }
}

fn top_panels(view: &View, area: Rect, buffer: &mut Buffer) {
    if area.width < 64 {
        let half = if area.height >= 2 * LEAST_TOP { area.height / 2 } else { 0 };
        let [upper, lower] = rows(area, [0, half]);
        world::draw_world(view, upper, buffer);
        if half > 0 {
            curve::draw_curve(view, lower, buffer);
        }
        return;
    }
    let left_width = if area.width >= 100 { area.width * 11 / 20 } else { area.width / 2 };
    let left = Rect { width: left_width, ..area };
    let right = Rect { x: area.x + left_width + 1, width: area.width - left_width - 1, ..area };
    world::draw_world(view, left, buffer);
    let step_height = if area.height >= 22 { (area.height / 2).min(step::height(view) + 1) } else { 0 };
    let [upper, lower] = rows(right, [0, step_height]);
    curve::draw_curve(view, upper, buffer);
    if step_height > 0 {
        step::draw_step(view, lower, buffer);
    }
}

fn panel_at(view: &View, panel: Panel, area: Rect, buffer: &mut Buffer) {
    match panel {
        Panel::World => world::draw_world(view, area, buffer),
        Panel::Curve => curve::draw_curve(view, area, buffer),
        Panel::Rules => rules::draw_rules(view, area, buffer),
        Panel::Step => step::draw_step(view, area, buffer),
        Panel::Findings => findings::draw_findings(view, area, buffer),
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
