//! The world from above, with equal scale in x and y: what stands, where rules fired, the robot's way, its laser, itself.

use std::f64::consts::PI;

use ratatui_core::buffer::Buffer;
use ratatui_core::layout::Rect;
use ratatui_core::style::{Modifier, Style};
use ratatui_core::text::Span;

use super::dots::{Dot, Dots, Rank};
use super::ink::TerminalInk;
use super::lines::{heading, nothing};
use super::view::View;
use engine::experiment::{Record, RecordedMovers};
use insight::page::{Document, Ground, SolidOutline};
use insight::words::typeset;

/// Steps of the way that are drawn.
const TRAIL_STEPS: usize = 400;
/// How far ahead of its centre the robot's heading is drawn, metres.
const NOSE_M: f64 = 0.6;

/// From metres to dots.
struct Map {
    scale: f64,
    origin: Dot,
}

impl Map {
    fn new([x0, y0, x1, y1]: [f64; 4], (width, height): Dot) -> Self {
        let (wide, high) = ((x1 - x0).max(0.1), (y1 - y0).max(0.1));
        let scale = ((width - 1.0) / wide).min((height - 1.0) / high);
        let origin =
            ((width - 1.0 - wide * scale) / 2.0 - x0 * scale, (height - 1.0 - high * scale) / 2.0 + y1 * scale);
        Self { scale, origin }
    }

    fn at(&self, (x, y): (f64, f64)) -> Dot {
        (self.origin.0 + x * self.scale, self.origin.1 - y * self.scale)
    }

    /// An outline's corners in dots, with its own origin at a pose.
    fn corners(&self, outline: &SolidOutline, (x, y, yaw): (f64, f64, f64)) -> Vec<Dot> {
        let (sin, cos) = libm::sincos(yaw);
        let place =
            |(along, across): (f64, f64)| self.at((x + cos * along - sin * across, y + sin * along + cos * across));
        match outline.circle_m {
            Some([centre_x, centre_y, radius]) => (0..24)
                .map(|part| libm::sincos(2.0 * PI * f64::from(part) / 24.0))
                .map(|(sin, cos)| place((centre_x + radius * cos, centre_y + radius * sin)))
                .collect(),
            None => outline.corners_m.iter().map(|corner| place((corner[0], corner[1]))).collect(),
        }
    }
}

pub(super) fn draw_world(view: &View, area: Rect, buffer: &mut Buffer) {
    let Some(document) = view.document() else { return };
    let ground = ground(view, document);
    let mut dots = Dots::new(area.width, area.height.saturating_sub(1));
    let map = Map::new(ground.bounds_m, dots.size());
    let inner = heading("World", vec![Span::styled(scale_bar(&map), TerminalInk::quiet())], area, buffer);
    if inner.height < 3 {
        nothing("no room for the world", inner, buffer);
        return;
    }
    if let Some(route) = &ground.route_m {
        let places: Vec<Dot> = route.iter().map(|place| map.at((place[0], place[1]))).collect();
        dots.path(&places, Some(1), Rank::Ground, TerminalInk::quiet());
    }
    for solid in &ground.solids {
        stand(&map, solid, &mut dots);
    }
    let record = view.record();
    if let Some(record) = &record {
        laser(view, document, &map, record, &mut dots);
        trail(view, &map, &mut dots);
        movers(view, ground, &map, &mut dots);
    }
    dots.draw(inner, buffer, view.ink.fine);
    marks(view, document, &map, inner, buffer);
    if let Some(record) = &record {
        robot(view, document, &map, record, inner, buffer);
    }
}

/// The number of the world in which a step was done.
fn world_of(view: &View, step: usize) -> usize {
    view.ledger().map_or(0, |ledger| ledger.world(step))
}

/// The world in which the robot is.
fn ground<'a>(view: &View, document: &'a Document) -> &'a Ground {
    let further = world_of(view, view.step).checked_sub(1);
    further.and_then(|index| document.further_worlds.get(index)).unwrap_or(&document.world)
}

/// A length that is easy to read, as wide as it is drawn.
fn scale_bar(map: &Map) -> String {
    let cells = |metres: f64| (metres * map.scale / 2.0).round() as usize;
    let lengths = [50.0, 20.0, 10.0, 5.0, 2.0, 1.0, 0.5, 0.2, 0.1];
    let metres = lengths.into_iter().find(|metres| cells(*metres) <= 8).unwrap_or(0.1);
    format!("├{}┤ {} m", "─".repeat(cells(metres).saturating_sub(2)), typeset(metres))
}

fn stand(map: &Map, solid: &SolidOutline, dots: &mut Dots) {
    let corners = map.corners(solid, (0.0, 0.0, 0.0));
    match solid.kind {
        "wall" => {
            dots.fill(&corners, 1, Rank::Ground, Style::new());
            dots.outline(&corners, None, Rank::Ground, Style::new());
        }
        "glass" => dots.outline(&corners, Some(1), Rank::Ground, Style::new()),
        "paint" => dots.fill(&corners, 1, Rank::Ground, Style::new()),
        _ => dots.outline(&corners, None, Rank::Ground, TerminalInk::quiet()),
    }
}

fn trail(view: &View, map: &Map, dots: &mut Dots) {
    let Some(ledger) = view.ledger() else { return };
    let from = view.step.saturating_sub(TRAIL_STEPS);
    let mut last: Option<Record> = None;
    for step in from..=view.step {
        let Some(record) = ledger.record(step) else { break };
        // Where it was lately counts more.
        let old = view.step - step > TRAIL_STEPS / 2;
        let style = if old { view.ink.accent().patch(TerminalInk::quiet()) } else { view.ink.accent() };
        let attempt = ledger.attempt(step);
        let here = attempt.as_ref().map_or(0, |attempt| attempt.world) == world_of(view, view.step);
        if let Some(last) = last.filter(|last| last.then.is_none() && here) {
            let (from, to) = (map.at((last.pose.x_m, last.pose.y_m)), map.at((record.pose.x_m, record.pose.y_m)));
            dots.line(from, to, None, Rank::Line, style);
        }
        last = Some(record).filter(|_| here && attempt.is_none_or(|attempt| !attempt.hop));
    }
}

fn laser(view: &View, document: &Document, map: &Map, record: &Record, dots: &mut Dots) {
    let scan = document.scan;
    let (sin, cos) = libm::sincos(record.pose.yaw_rad);
    let from = (record.pose.x_m + scan.forward_m * cos, record.pose.y_m + scan.forward_m * sin);
    let end = |beam: usize, range_m: f64| {
        let angle = record.pose.yaw_rad + scan.first_rad + beam as f64 * scan.apart_rad;
        let (sin, cos) = libm::sincos(angle);
        let reach_m = range_m * libm::cos(scan.tilt_rad);
        map.at((from.0 + reach_m * cos, from.1 + reach_m * sin))
    };
    let start = map.at(from);
    let ranges_m = view.moment().map(|moment| &moment.ranges_m);
    if let Some(ranges_m) = ranges_m {
        // A whole circle has no corner where the laser stands.
        let mut fan = if scan.whole { Vec::new() } else { vec![start] };
        fan.extend(ranges_m.iter().enumerate().map(|(beam, range_m)| end(beam, f64::from(*range_m))));
        dots.fill(&fan, 2, Rank::Area, view.ink.accent().patch(TerminalInk::quiet()));
    }
    let nearest_m = f64::from(record.nearest_m);
    // Where nothing is in reach, no beam is the nearest.
    if nearest_m < 0.99 * scan.max_range_m {
        dots.line(start, end(usize::from(record.nearest_beam), nearest_m), None, Rank::Behind, view.ink.accent());
    }
    if let Some(beam) = record.beam {
        let range_m = ranges_m.and_then(|ranges_m| ranges_m.get(usize::from(beam))).map(|range_m| f64::from(*range_m));
        let rule = view
            .ledger()
            .and_then(|ledger| view.story.fired_at(ledger, view.step).map(|(rule, _)| rule).last())
            .unwrap_or(0);
        let to = end(usize::from(beam), range_m.unwrap_or(nearest_m));
        dots.line(start, to, None, Rank::Front, view.ink.rule(&document.rules, rule).patch(TerminalInk::strong()));
    }
}

/// Everything that drives by itself, where it is at the end of the step.
fn movers(view: &View, ground: &Ground, map: &Map, dots: &mut Dots) {
    let Some(shown) = &view.shown.run else { return };
    let (Some(seed), Some(ledger)) = (view.seed_run(), view.ledger()) else { return };
    let mut track = RecordedMovers::new(&shown.run.plan, seed.seed, view.phase);
    track.seek(ledger, view.step);
    for (pose, drawn) in track.poses().zip(&ground.movers) {
        for solid in &drawn.solids {
            let corners = map.corners(solid, (pose.x_m, pose.y_m, pose.yaw_rad));
            dots.fill(&corners, 1, Rank::Line, TerminalInk::strong());
            dots.outline(&corners, None, Rank::Line, TerminalInk::strong());
        }
    }
}

fn marks(view: &View, document: &Document, map: &Map, area: Rect, buffer: &mut Buffer) {
    let here = world_of(view, view.step);
    for mark in view.story.marks.iter().filter(|mark| world_of(view, mark.step) == here) {
        put(map.at(mark.place_m), view.ink.mark(mark.rule), view.ink.rule(&document.rules, mark.rule), area, buffer);
    }
}

fn robot(view: &View, document: &Document, map: &Map, record: &Record, area: Rect, buffer: &mut Buffer) {
    let style = if record.contact || record.fallen { view.ink.bad() } else { Style::new() };
    let (sin, cos) = libm::sincos(record.pose.yaw_rad);
    let centre = (record.pose.x_m, record.pose.y_m);
    let [half, _] = document.robot_half_m;
    let mut body = Dots::new(area.width, area.height);
    if half * map.scale >= 2.0 {
        let corner = |(along, across): (f64, f64)| {
            map.at((centre.0 + cos * along - sin * across, centre.1 + sin * along + cos * across))
        };
        let corners: Vec<Dot> = document.robot_outline_m.iter().map(|[x, y]| corner((*x, *y))).collect();
        body.fill(&corners, 1, Rank::Front, style);
    }
    body.line(map.at(centre), map.at((centre.0 + NOSE_M * cos, centre.1 + NOSE_M * sin)), None, Rank::Front, style);
    body.draw(area, buffer, view.ink.fine);
    put(
        map.at(centre),
        arrow(record.pose.yaw_rad, view.ink.fine),
        style.add_modifier(Modifier::REVERSED | Modifier::BOLD),
        area,
        buffer,
    );
}

/// The way it looks, to the nearest eighth of a turn; a quarter where the font has no more.
fn arrow(yaw_rad: f64, fine: bool) -> char {
    let eighth = (yaw_rad / (PI / 4.0)).round().rem_euclid(8.0) as usize % 8;
    let quarter = (yaw_rad / (PI / 2.0)).round().rem_euclid(4.0) as usize % 4;
    if fine {
        ['→', '↗', '↑', '↖', '←', '↙', '↓', '↘'][eighth]
    } else {
        ['→', '↑', '←', '↓'][quarter]
    }
}

/// One character over the cell of a dot.
fn put((x, y): Dot, glyph: char, style: Style, area: Rect, buffer: &mut Buffer) {
    if x >= 0.0 && y >= 0.0 && x < 2.0 * f64::from(area.width) && y < 4.0 * f64::from(area.height) {
        let place = (area.x + x as u16 / 2, area.y + y as u16 / 4);
        if let Some(cell) = buffer.cell_mut(place) {
            cell.set_char(glyph).set_style(Style::reset().patch(style));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_metre_is_as_long_in_x_as_in_y() {
        let map = Map::new([-1.0, -2.0, 9.0, 3.0], (81.0, 161.0));
        let (left, right) = (map.at((0.0, 0.0)), map.at((1.0, 1.0)));
        assert_eq!((right.0 - left.0, left.1 - right.1), (8.0, 8.0));
        // As wide as there is room, and in the middle of the height.
        assert_eq!((map.at((-1.0, 0.5)), map.at((9.0, 0.5))), ((0.0, 80.0), (80.0, 80.0)));
        assert_eq!(scale_bar(&map), "├──────┤ 2 m");
    }

    #[test]
    fn the_robot_is_an_arrow() {
        let yaws = [0.0, 0.5, PI / 2.0, -PI / 4.0, 7.0, -0.1];
        assert_eq!(yaws.map(|yaw| arrow(yaw, true)), ['→', '↗', '↑', '↘', '↗', '→']);
        assert_eq!(arrow(-PI / 2.0, false), '↓');
    }
}
