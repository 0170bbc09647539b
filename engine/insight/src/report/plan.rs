//! The world from above: what stands, what is driven on, what is painted on the floor, what drives by itself.

use super::axes::Plot;
use super::canvas::{Spot, Tint};
use super::sheet::{FRAME, PAPER, Sheet, TEXT};
use engine::experiment::Plan;
use engine::geometry::{Point2, Pose};
use engine::world::scene::{SceneParts, Shape, Solid};
use engine::world::{Circle, Gate, Mover, Route};

/// The outline of what stands.
pub(super) const EDGE: Tint = Tint::hex(0x484f58);
const LAP: Tint = Tint::hex(0x8c959f);
const WAY: Tint = Tint::hex(0x57606a);
/// How far the colour of what is driven on goes towards white, so that a path can be read on it.
const LIGHTER: f64 = 0.75;

/// A world as pictures show it.
#[derive(Debug, Clone)]
pub struct WorldPlan<'a> {
    /// What stands still.
    pub parts: &'a SceneParts,
    /// For each solid, whether the robot drives on it.
    pub driven_on: Vec<bool>,
    /// The lap that the world's author had in mind.
    pub lap: Option<&'a Route>,
    /// All routes of the world.
    pub routes: &'a [Route],
    /// What drives by itself.
    pub movers: &'a [Mover],
    /// The outline of the robot, in its own axes, metres; empty if there is none to draw.
    pub robot_m: Vec<[f64; 2]>,
    /// Places to visit.
    pub places: &'a [Circle],
    /// Gates to pass.
    pub gates: &'a [Gate],
}

impl<'a> WorldPlan<'a> {
    /// The world of a plan, for its robot.
    #[must_use]
    pub fn of(plan: &'a Plan) -> Self {
        let layout = &plan.layout;
        Self {
            driven_on: layout.driven_on(&plan.settings.robot.body),
            lap: layout.lap.map(|lap| &layout.routes[lap]),
            routes: &layout.routes,
            movers: &layout.movers,
            robot_m: plan.settings.robot.body.footprint.outline_m(),
            places: &layout.places,
            gates: &layout.gates,
            ..Self::standing(layout.scene.parts())
        }
    }

    /// Solids alone, none of them driven on.
    #[must_use]
    pub fn standing(parts: &'a SceneParts) -> Self {
        Self {
            parts,
            driven_on: vec![false; parts.solids.len()],
            lap: None,
            routes: &[],
            movers: &[],
            robot_m: Vec::new(),
            places: &[],
            gates: &[],
        }
    }

    /// The ways of the movers that are not the lap.
    pub(crate) fn ways(&self) -> impl Iterator<Item = &'a Route> {
        self.movers.iter().filter_map(|mover| self.way(mover))
    }

    /// The way of a mover, unless that is the lap.
    pub(crate) fn way(&self, mover: &'a Mover) -> Option<&'a Route> {
        mover.way(self.routes).filter(|way| self.lap.is_none_or(|lap| !std::ptr::eq(lap, *way)))
    }

    /// Points round all that is marked on the floor plan.
    pub(crate) fn marks(&self) -> impl Iterator<Item = [f64; 2]> {
        let circles = self.places.iter().flat_map(|place| {
            let (x, y, radius_m) = (place.centre.x, place.centre.y, place.radius_m);
            [[x - radius_m, y - radius_m], [x + radius_m, y + radius_m]]
        });
        circles.chain(self.gates.iter().flat_map(|gate| [gate.right, gate.left]).map(|post| [post.x, post.y]))
    }

    /// Whether a mover drives along the lap.
    pub(super) fn lap_is_driven(&self) -> bool {
        self.movers.len() > self.ways().count()
    }

    /// The floor's colour.
    pub(super) fn floor(&self) -> Tint {
        lighter(self.colour(self.parts.floor))
    }

    fn colour(&self, material: usize) -> Tint {
        self.parts.materials.get(material).map_or(FRAME, |material| Tint { rgb: material.colour, alpha: 1.0 })
    }

    /// Draws what stands, the lowest first, then the lap and the ways.
    pub(super) fn draw(&self, sheet: &mut Sheet, plot: &Plot) {
        let parts = self.parts;
        let mut order: Vec<(&Solid, bool)> = parts.solids.iter().zip(self.driven_on.iter().copied()).collect();
        let key = |solid: &Solid| (solid.collides, solid.bounds().1.z);
        order.sort_by(|(a, _), (b, _)| key(a).partial_cmp(&key(b)).unwrap_or(std::cmp::Ordering::Equal));
        for (solid, driven_on) in order {
            let (outline, colour) = (outline(solid, plot), self.colour(solid.material));
            let glass = parts.materials.get(solid.material).is_some_and(|material| !material.laser);
            let ink = match solid {
                _ if driven_on => lighter(colour),
                // The laser passes, and so does the eye.
                _ if solid.collides && glass => colour.thin(0.35),
                _ => colour,
            };
            sheet.area(outline.clone(), ink);
            if solid.collides {
                // A wall thinner than a pixel still has to be seen.
                sheet.line(closed(outline), 1.0, if driven_on { FRAME } else { EDGE });
            }
        }
        self.draw_marks(sheet, plot);
        for way in self.ways() {
            dashed(sheet, &spots(plot, way), 1.0, WAY, FINE);
        }
        if let Some(lap) = self.lap {
            dashed(sheet, &spots(plot, lap), 1.5, LAP, DASHES);
        }
    }

    /// Draws the robot's outline where it stands, with a line from the point that it turns about to its front.
    pub(super) fn draw_robot(&self, sheet: &mut Sheet, plot: &Plot, at: Pose) {
        if self.robot_m.is_empty() || ![at.x_m, at.y_m, at.yaw_rad].iter().all(|number| number.is_finite()) {
            return;
        }
        let (sin, cos) = libm::sincos(at.yaw_rad);
        let spot = |x: f64, y: f64| plot.at(at.x_m + cos * x - sin * y, at.y_m + sin * x + cos * y);
        let corners: Vec<Spot> = self.robot_m.iter().map(|[x, y]| spot(*x, *y)).collect();
        let front = self.robot_m.iter().fold(0.0, |front: f64, [x, _]| front.max(*x));
        sheet.area(corners.clone(), PAPER.thin(0.6));
        sheet.line(closed(corners), 1.0, TEXT);
        sheet.line(vec![spot(0.0, 0.0), spot(front, 0.0)], 1.0, TEXT);
    }

    /// Draws the places as circles and the gates as lines from post to post, all of them fine.
    fn draw_marks(&self, sheet: &mut Sheet, plot: &Plot) {
        for place in self.places {
            let round = |part: u8| {
                let (sin, cos) = libm::sincos(f64::from(part) * std::f64::consts::TAU / 48.0);
                plot.at(place.centre.x + place.radius_m * cos, place.centre.y + place.radius_m * sin)
            };
            dashed(sheet, &(0..=48).map(round).collect::<Vec<_>>(), 1.0, LAP, FINE);
        }
        for gate in self.gates {
            let posts = [gate.right, gate.left].map(|post| plot.at(post.x, post.y));
            dashed(sheet, &posts, 1.0, LAP, FINE);
        }
    }

    /// Draws the movers where they are.
    pub(super) fn draw_movers(&self, sheet: &mut Sheet, plot: &Plot, poses: &[Pose]) {
        for (mover, at) in self.movers.iter().zip(poses) {
            for solid in &mover.solids {
                let outline = outline(&placed(solid, *at), plot);
                sheet.area(outline.clone(), self.colour(solid.material));
                sheet.line(closed(outline), 1.0, TEXT);
            }
        }
    }
}

fn lighter(colour: Tint) -> Tint {
    colour.towards(PAPER, LIGHTER)
}

/// A mover's solid in the world.
fn placed(solid: &Solid, at: Pose) -> Solid {
    let (sin, cos) = libm::sincos(at.yaw_rad);
    let mut placed = solid.clone();
    placed.centre.x = at.x_m + cos * solid.centre.x - sin * solid.centre.y;
    placed.centre.y = at.y_m + sin * solid.centre.x + cos * solid.centre.y;
    placed.yaw_rad += at.yaw_rad;
    placed
}

fn spots(plot: &Plot, route: &Route) -> Vec<Spot> {
    let finite = |at: &Point2| at.x.is_finite() && at.y.is_finite();
    route.drawn().filter(finite).map(|at| plot.at(at.x, at.y)).collect()
}

/// The sign of the lap in a legend.
pub(super) fn lap_sign(sheet: &mut Sheet, from: Spot, to: Spot) {
    let y = (from.1 + to.1) / 2;
    dashed(sheet, &[(from.0, y), (to.0, y)], 1.5, LAP, DASHES);
}

/// The sign of the robot in a legend.
pub(super) fn robot_sign(sheet: &mut Sheet, from: Spot, to: Spot) {
    let (middle, half) = ((from.0 + to.0) / 2, (to.1 - from.1) / 3);
    let y = (from.1 + to.1) / 2;
    sheet.border((middle - half, y - half), (middle + half, y + half), TEXT);
    sheet.line(vec![(middle, y), (middle + half, y)], 1.0, TEXT);
}

/// The sign of a mover's way in a legend.
pub(super) fn way_sign(sheet: &mut Sheet, from: Spot, to: Spot) {
    let y = (from.1 + to.1) / 2;
    dashed(sheet, &[(from.0, y), (to.0, y)], 1.0, WAY, FINE);
}

/// The sign of a mover in a legend.
pub(super) fn mover_sign(sheet: &mut Sheet, from: Spot, to: Spot) {
    let (middle, half) = ((from.0 + to.0) / 2, (to.1 - from.1) / 2);
    let (min, max) = ((middle - half, from.1), (middle + half, to.1));
    sheet.rect(min, max, LAP);
    sheet.border(min, max, TEXT);
}

/// Dash and gap of the lap, and of a way, units.
const DASHES: [f64; 2] = [32.0, 24.0];
const FINE: [f64; 2] = [12.0, 12.0];

/// A line of dashes that run on around the corners.
fn dashed(sheet: &mut Sheet, spots: &[Spot], width_px: f64, ink: Tint, [dash_long, gap]: [f64; 2]) {
    let mut done = 0.0;
    let mut dash: Vec<Spot> = Vec::new();
    for pair in spots.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let (dx, dy) = (f64::from(to.0 - from.0), f64::from(to.1 - from.1));
        let length = (dx * dx + dy * dy).sqrt();
        let mut at = 0.0;
        while at < length {
            let phase = done % (dash_long + gap);
            let step =
                if phase < dash_long { dash_long - phase } else { dash_long + gap - phase }.min(length - at).max(1e-3);
            let spot =
                |at: f64| (from.0 + (dx * at / length).round() as i32, from.1 + (dy * at / length).round() as i32);
            if phase < dash_long {
                if dash.is_empty() {
                    dash.push(spot(at));
                }
                dash.push(spot(at + step));
            } else if !dash.is_empty() {
                sheet.line(std::mem::take(&mut dash), width_px, ink);
            }
            at += step;
            done += step;
        }
    }
    sheet.line(dash, width_px, ink);
}

/// The corners of a solid seen from above, on the sheet.
fn outline(solid: &Solid, plot: &Plot) -> Vec<Spot> {
    let at = |x: f64, y: f64| plot.at(solid.centre.x + x, solid.centre.y + y);
    if let Shape::Cylinder { radius_m, .. } = solid.shape {
        return (0..48)
            .map(|part| {
                let (sin, cos) = libm::sincos(f64::from(part) * std::f64::consts::TAU / 48.0);
                at(radius_m * cos, radius_m * sin)
            })
            .collect();
    }
    let half = solid.shape.half_extents();
    let (sin, cos) = libm::sincos(solid.yaw_rad);
    [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)]
        .map(|(x, y)| (x * half.x, y * half.y))
        .map(|(x, y)| at(cos * x - sin * y, sin * x + cos * y))
        .to_vec()
}

fn closed(mut outline: Vec<Spot>) -> Vec<Spot> {
    outline.extend(outline.first().copied());
    outline
}
