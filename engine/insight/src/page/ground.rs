//! The world from above, as outlines.

use serde::Serialize;

use crate::report::WorldPlan;
use engine::experiment::Plan;
use engine::world::scene::{SceneParts, Shape, Solid};
use engine::world::{Mover, Route};

/// What stands in a world.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Ground {
    /// Name of the world.
    pub name: String,
    /// Least x and y, greatest x and y of all that is drawn, metres.
    pub bounds_m: [f64; 4],
    /// The floor's colour.
    pub floor: [u8; 3],
    /// The solids, the lowest first.
    pub solids: Vec<SolidOutline>,
    /// The lap that the world's author had in mind, metres.
    pub route_m: Option<Vec<[f64; 2]>>,
    /// Places to visit: x, y and radius, metres.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub places_m: Vec<[f64; 3]>,
    /// Gates to pass: the right post and the left one, metres.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub gates_m: Vec<[[f64; 2]; 2]>,
    /// Its movers, in the order of the world file.
    pub movers: Vec<MoverOutline>,
}

/// A mover: what drives by itself.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MoverOutline {
    /// Its name in the world file.
    pub name: String,
    /// Its solids around its own origin, x forward.
    pub solids: Vec<SolidOutline>,
    /// Its way, metres; null if that is the lap.
    pub way_m: Option<Vec<[f64; 2]>>,
}

/// One solid.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SolidOutline {
    /// `wall` stops the robot, `ground` is driven on, `glass` stops it unseen by the laser, `paint` is flat.
    pub kind: &'static str,
    /// Its colour under full light.
    pub colour: [u8; 3],
    /// Its corners, metres; empty for a circle.
    pub corners_m: Vec<[f64; 2]>,
    /// x, y and radius of a circle, metres.
    pub circle_m: Option<[f64; 3]>,
}

impl Ground {
    /// The outlines of a plan's world.
    #[must_use]
    pub fn new(plan: &Plan) -> Self {
        let (layout, world) = (&plan.layout, WorldPlan::of(plan));
        let parts = world.parts;
        let mut solids: Vec<(&Solid, bool)> = parts.solids.iter().zip(world.driven_on.iter().copied()).collect();
        solids.sort_by(|(a, _), (b, _)| {
            let key = |solid: &Solid| (solid.collides, solid.bounds().1.z);
            key(a).partial_cmp(&key(b)).unwrap_or(std::cmp::Ordering::Equal)
        });
        let mover = |mover: &'_ Mover| MoverOutline {
            name: mover.name.clone(),
            solids: mover.solids.iter().map(|solid| SolidOutline::new(solid, parts, false)).collect(),
            way_m: world.way(mover).map(points),
        };
        let starts = layout.starts.iter().map(|start| [start.pose.x_m, start.pose.y_m]);
        let ways = world.ways().chain(world.lap).flat_map(points).chain(world.marks());
        Self {
            name: layout.name.clone(),
            bounds_m: bounds(&parts.solids, &starts.chain(ways).collect::<Vec<_>>()),
            floor: colour(parts, parts.floor),
            solids: solids.iter().map(|(solid, driven_on)| SolidOutline::new(solid, parts, *driven_on)).collect(),
            route_m: world.lap.map(points),
            places_m: layout
                .places
                .iter()
                .map(|place| [place.centre.x, place.centre.y, place.radius_m].map(milli))
                .collect(),
            gates_m: layout
                .gates
                .iter()
                .map(|gate| [gate.right, gate.left].map(|post| [milli(post.x), milli(post.y)]))
                .collect(),
            movers: layout.movers.iter().map(mover).collect(),
        }
    }
}

fn points(route: &Route) -> Vec<[f64; 2]> {
    route.drawn().map(|at| [milli(at.x), milli(at.y)]).collect()
}

fn colour(parts: &SceneParts, material: usize) -> [u8; 3] {
    parts.materials.get(material).map_or([128; 3], |material| material.colour)
}

impl SolidOutline {
    fn new(solid: &Solid, parts: &SceneParts, driven_on: bool) -> Self {
        let kind = match solid {
            _ if !solid.collides => "paint",
            _ if driven_on => "ground",
            _ if parts.materials.get(solid.material).is_some_and(|material| !material.laser) => "glass",
            _ => "wall",
        };
        let colour = colour(parts, solid.material);
        let (x, y) = (solid.centre.x, solid.centre.y);
        if let Shape::Cylinder { radius_m, .. } = solid.shape {
            let circle_m = Some([milli(x), milli(y), milli(radius_m)]);
            return Self { kind, colour, corners_m: Vec::new(), circle_m };
        }
        let half = solid.shape.half_extents();
        let (sin, cos) = libm::sincos(solid.yaw_rad);
        let corner = |(along, across): (f64, f64)| {
            let (along, across) = (along * half.x, across * half.y);
            [milli(x + cos * along - sin * across), milli(y + sin * along + cos * across)]
        };
        let corners_m = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)].map(corner).to_vec();
        Self { kind, colour, corners_m, circle_m: None }
    }
}

fn bounds(solids: &[Solid], driven: &[[f64; 2]]) -> [f64; 4] {
    let corners = solids.iter().flat_map(|solid| {
        let (min, max) = solid.bounds();
        [[min.x, min.y], [max.x, max.y]]
    });
    // Around a robot alone on an endless floor there is nothing else to show.
    let around = driven.iter().flat_map(|at| [[at[0] - 1.0, at[1] - 1.0], [at[0] + 1.0, at[1] + 1.0]]);
    let mut all = [f64::MAX, f64::MAX, f64::MIN, f64::MIN];
    for [x, y] in corners.chain(around) {
        all = [all[0].min(x), all[1].min(y), all[2].max(x), all[3].max(y)];
    }
    if all[0] > all[2] { [-1.0, -1.0, 1.0, 1.0] } else { all.map(milli) }
}

/// To the millimetre, so that the text stays short.
fn milli(metres: f64) -> f64 {
    (metres * 1000.0).round() / 1000.0
}
