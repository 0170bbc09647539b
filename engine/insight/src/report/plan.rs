//! The world from above: what stands, what is driven on, what is painted on the floor.

use super::axes::Plot;
use super::canvas::{Spot, Tint};
use super::sheet::{FRAME, Sheet};
use engine::geometry::Point2;
use engine::world::scene::{SceneParts, Shape, Solid};

/// The floor, dull enough to show white paint.
pub(super) const FLOOR: Tint = Tint::hex(0xf6f7f8);
/// What stops the robot.
pub(super) const WALL: Tint = Tint::hex(0x484f58);
/// What it drives on.
const PLATFORM: Tint = Tint::hex(0xffffff);
const ROUTE: Tint = Tint::hex(0x8c959f);

/// No robot stands on something thinner, metres: a path that cuts a wall does not make it a platform.
const LEAST_PLATFORM_M: f64 = 0.3;

/// Draws the solids, the lowest first; one that holds any of `visited` is driven on and drawn light.
pub(super) fn solids(sheet: &mut Sheet, plot: &Plot, parts: &SceneParts, visited: &[[f64; 2]]) {
    let mut order: Vec<&Solid> = parts.solids.iter().collect();
    order.sort_by(|a, b| (a.collides, top(a)).partial_cmp(&(b.collides, top(b))).unwrap_or(std::cmp::Ordering::Equal));
    for solid in order {
        let outline = outline(solid, plot);
        let ramp = matches!(solid.shape, Shape::Ramp { .. });
        if !solid.collides {
            let paint =
                parts.materials.get(solid.material).map_or(FRAME, |material| Tint { rgb: material.colour, alpha: 1.0 });
            sheet.area(outline, paint);
        } else if ramp || visited.iter().any(|at| holds(solid, *at)) {
            sheet.area(outline.clone(), PLATFORM);
            sheet.line(closed(outline), 1.5, WALL);
        } else {
            sheet.area(outline.clone(), WALL);
            // A wall thinner than a pixel still has to be seen.
            sheet.line(closed(outline), 1.0, WALL);
        }
    }
}

/// Draws the lap that the world's author had in mind.
pub(super) fn route(sheet: &mut Sheet, plot: &Plot, route: &[Point2]) {
    let spots: Vec<Spot> =
        route.iter().filter(|at| at.x.is_finite() && at.y.is_finite()).map(|at| plot.at(at.x, at.y)).collect();
    dashed(sheet, &spots, 1.5, ROUTE);
}

/// The sign of the route in a legend.
pub(super) fn route_sign(sheet: &mut Sheet, from: Spot, to: Spot) {
    let y = (from.1 + to.1) / 2;
    dashed(sheet, &[(from.0, y), (to.0, y)], 1.5, ROUTE);
}

/// A line of dashes that run on around the corners.
fn dashed(sheet: &mut Sheet, spots: &[Spot], width_px: f64, ink: Tint) {
    const DASH: f64 = 32.0;
    const GAP: f64 = 24.0;
    let mut done = 0.0;
    let mut dash: Vec<Spot> = Vec::new();
    for pair in spots.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let (dx, dy) = (f64::from(to.0 - from.0), f64::from(to.1 - from.1));
        let length = (dx * dx + dy * dy).sqrt();
        let mut at = 0.0;
        while at < length {
            let phase = done % (DASH + GAP);
            let step = if phase < DASH { DASH - phase } else { DASH + GAP - phase }.min(length - at).max(1e-3);
            let spot =
                |at: f64| (from.0 + (dx * at / length).round() as i32, from.1 + (dy * at / length).round() as i32);
            if phase < DASH {
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

fn top(solid: &Solid) -> f64 {
    solid.bounds().1.z
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

/// Whether a robot at a place of the floor plan can stand on the solid.
pub(crate) fn holds(solid: &Solid, at: [f64; 2]) -> bool {
    let (x, y) = (at[0] - solid.centre.x, at[1] - solid.centre.y);
    let half = solid.shape.half_extents();
    if 2.0 * half.x.min(half.y) < LEAST_PLATFORM_M {
        return false;
    }
    if let Shape::Cylinder { radius_m, .. } = solid.shape {
        return x * x + y * y < radius_m * radius_m;
    }
    let (sin, cos) = libm::sincos(solid.yaw_rad);
    (cos * x + sin * y).abs() < half.x && (cos * y - sin * x).abs() < half.y
}

#[cfg(test)]
mod tests {
    use super::*;
    use engine::geometry::{Point3, Vector3};

    #[test]
    fn a_turned_box_holds_what_lies_along_it_unless_it_is_thin() {
        let solid = |half_y| Solid {
            shape: Shape::Box { half_m: Vector3::new(2.0, half_y, 0.5) },
            centre: Point3::new(1.0, 1.0, 0.5),
            yaw_rad: std::f64::consts::FRAC_PI_2,
            material: 0,
            collides: true,
        };
        assert!(holds(&solid(0.2), [1.0, 2.5]));
        assert!(!holds(&solid(0.2), [2.5, 1.0]));
        assert!(!holds(&solid(0.1), [1.0, 2.5]));
    }
}
