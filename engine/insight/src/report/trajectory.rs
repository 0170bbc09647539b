//! Where the robot drove: panels of the world from above, such as early and late.

use super::axes::{Axis, BELOW_PX, Plot, axes, range};
use super::canvas::{Spot, Tint, units};
use super::picture::Picture;
use super::plan::WorldPlan;
use super::sheet::{
    BELOW_TITLE_PX, LABEL_PX, LegendEntry, MARGIN_PX, Sheet, TEXT, VERMILION, centred, fitted, legend, spot, words,
};
use super::{plan, route};
use engine::diagnostic::Result;
use engine::experiment::Trail;
use engine::world::Route;

pub(super) const WIDTH_PX: f64 = 1400.0;
/// Room for four digits and the title beside them.
pub(super) const LEFT_PX: f64 = 66.0;

/// What the trajectory picture shows.
#[derive(Debug, Clone, Copy)]
pub struct TrajectoryData<'a> {
    /// The heading.
    pub title: &'a str,
    /// The world.
    pub world: &'a WorldPlan<'a>,
    /// Name and path of each panel, left to right; one or two.
    pub panels: &'a [(&'a str, &'a Trail)],
}

/// Draws both panels in one scale. 1400 pixels wide, as high as the world needs.
///
/// # Errors
/// If the picture cannot be drawn or encoded.
pub fn trajectories(data: &TrajectoryData<'_>) -> Result<Picture> {
    let floor = FloorPlan::around(data.world, data.panels.iter().flat_map(|(_, path)| route::points(path)));
    let room_px = (WIDTH_PX - 2.0 * MARGIN_PX - 24.0) / 2.0 - LEFT_PX;
    let (width_px, height_px) = floor.fit(room_px, 760.0);
    let top_px = BELOW_TITLE_PX + 30.0;
    let mut sheet = Sheet::new(WIDTH_PX, top_px + height_px + BELOW_PX + 44.0, data.title);
    for (index, (name, path)) in data.panels.iter().enumerate() {
        let left_px = MARGIN_PX + LEFT_PX + index as f64 * (room_px + LEFT_PX + 24.0) + (room_px - width_px) / 2.0;
        let min = spot(left_px, top_px);
        let max = (min.0 + units(width_px), min.1 + units(height_px));
        let heading = centred(words(name, ((min.0 + max.0) / 2, min.1 - units(18.0)), LABEL_PX, TEXT));
        sheet.text(fitted(heading, units(room_px)));
        let plot = floor.plot(&mut sheet, min, max, data.world.floor());
        data.world.draw(&mut sheet, &plot);
        data.world.draw_movers(&mut sheet, &plot, &path.movers);
        route::draw_path(&mut sheet, &plot, path);
        if let Some(last) = path.last {
            data.world.draw_robot(&mut sheet, &plot, last);
        }
    }
    let goals = data.panels.iter().any(|(_, path)| !path.goals.is_empty());
    explain(&mut sheet, data.world, goals);
    sheet.finish(&shows(data.world, data.panels))
}

/// Each panel in words, and what drives by itself.
fn shows(world: &WorldPlan<'_>, panels: &[(&str, &Trail)]) -> String {
    let panel = |(name, path): &(&str, &Trail)| {
        let (steps, failures) = (path.steps(), path.failures.len());
        let goals = if path.goals.is_empty() { String::new() } else { format!(", goals: {}", path.goals.len()) };
        format!("{name}: path of the robot over {steps} steps, failures: {failures}{goals}")
    };
    let movers = world.movers.iter().map(|mover| format!("mover: {}", mover.name));
    panels.iter().map(panel).chain(movers).collect::<Vec<_>>().join("; ")
}

/// The part of the floor plan that is shown, metres.
#[derive(Debug, Clone, Copy)]
pub(super) struct FloorPlan {
    x: (f64, f64),
    y: (f64, f64),
}

impl FloorPlan {
    /// All solids, routes and places, with a small border.
    pub(super) fn around(world: &WorldPlan<'_>, places: impl Iterator<Item = [f64; 2]>) -> Self {
        let corners = world.parts.solids.iter().flat_map(|solid| {
            let (min, max) = solid.bounds();
            [[min.x, min.y], [max.x, max.y]]
        });
        let routes = world.ways().chain(world.lap).flat_map(Route::drawn).map(|at| [at.x, at.y]);
        let all: Vec<[f64; 2]> = corners.chain(routes).chain(world.marks()).chain(places).collect();
        let (x, y) = (range(all.iter().map(|at| at[0])), range(all.iter().map(|at| at[1])));
        let border = 0.03 * (x.1 - x.0).max(y.1 - y.0);
        Self::showing((x.0 - border, x.1 + border), (y.0 - border, y.1 + border))
    }

    /// This rectangle, widened about its middle until no side is more than five times the other.
    pub(super) fn showing(x: (f64, f64), y: (f64, f64)) -> Self {
        let least = (x.1 - x.0).max(y.1 - y.0) / 5.0;
        let widened = |(low, high): (f64, f64)| {
            let more = ((least - (high - low)) / 2.0).max(0.0);
            (low - more, high + more)
        };
        Self { x: widened(x), y: widened(y) }
    }

    /// Width and height in pixels, equal scale, within a room.
    pub(super) fn fit(&self, width_px: f64, height_px: f64) -> (f64, f64) {
        let shape = (self.y.1 - self.y.0) / (self.x.1 - self.x.0);
        let height_px = (width_px * shape).min(height_px);
        (height_px / shape, height_px)
    }

    /// The plot without axes.
    pub(super) fn bare(&self, min: Spot, max: Spot) -> Plot {
        Plot::of(min, max, self.x, self.y)
    }

    /// Draws the axes and the empty floor.
    pub(super) fn plot(&self, sheet: &mut Sheet, min: Spot, max: Spot, floor: Tint) -> Plot {
        sheet.rect(min, max, floor);
        let per_tick = units(80.0);
        let x = Axis {
            title: "x (m)".to_owned(),
            low: self.x.0,
            high: self.x.1,
            room_px: BELOW_PX,
            ticks: ((max.0 - min.0) / per_tick).max(2) as usize,
        };
        let y = Axis {
            title: "y (m)".to_owned(),
            low: self.y.0,
            high: self.y.1,
            room_px: LEFT_PX,
            ticks: ((max.1 - min.1) / per_tick).max(2) as usize,
        };
        axes(sheet, min, max, &x, &y)
    }
}

/// The signs of a picture of paths, below it.
pub(super) fn explain(sheet: &mut Sheet, world: &WorldPlan<'_>, goals: bool) {
    let middle = |from: Spot, to: Spot| ((from.0 + to.0) / 2, (from.1 + to.1) / 2);
    let end = spot(WIDTH_PX - MARGIN_PX, sheet.height_px - 28.0);
    let time = |sheet: &mut Sheet, from: Spot, to: Spot| {
        let y = (from.1 + to.1) / 2;
        for part in 0..14 {
            let x = |part: i32| from.0 / 4 * 4 + (to.0 - from.0) * part / 14;
            sheet.line(vec![(x(part), y), (x(part + 1), y)], 3.0, route::shade(f64::from(part) / 13.0));
        }
    };
    let start = |sheet: &mut Sheet, from: Spot, to: Spot| sheet.disc(middle(from, to), 6.0, route::shade(1.0));
    let failure = |sheet: &mut Sheet, from: Spot, to: Spot| sheet.cross(middle(from, to), 5.0, VERMILION);
    let goal = |sheet: &mut Sheet, from: Spot, to: Spot| route::draw_goal(sheet, middle(from, to));
    let mut all = vec![
        LegendEntry { sign: &start, words: "start" },
        LegendEntry { sign: &time, words: "way, light early to dark late" },
        LegendEntry { sign: &failure, words: "failure" },
    ];
    if goals {
        all.push(LegendEntry { sign: &goal, words: "goal" });
    }
    if !world.robot_m.is_empty() {
        all.push(LegendEntry { sign: &plan::robot_sign, words: "robot at the end" });
    }
    if world.lap.is_some() {
        let words = if world.lap_is_driven() { "intended lap, driven by the mover too" } else { "intended lap" };
        all.push(LegendEntry { sign: &plan::lap_sign, words });
    }
    if !world.movers.is_empty() {
        all.push(LegendEntry { sign: &plan::mover_sign, words: "mover at the end" });
    }
    if world.ways().next().is_some() {
        all.push(LegendEntry { sign: &plan::way_sign, words: "way of a mover" });
    }
    legend(sheet, end, &all);
}
