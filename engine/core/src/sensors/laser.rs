//! The laser: cuts solids with the plane of the scan and measures along each beam.

use super::noise;
use super::observation::Scan;
use super::surface::{Face, Surfaces};
use super::view::HalfSpace;
use crate::geometry::{Isometry3, Vector3};
use crate::random::{NORMAL_RUN, normal_table};
use crate::settings::LaserSettings;
use crate::world::scene::{Scene, Shape, Solid};
use dispatch::{Processor, compiled_for_each_processor};
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

/// Address of the laser's noise within a scan; no image has such a row, so the camera's noise is another.
const NOISE_ROW: u64 = u64::MAX;

/// What cutting one solid with the plane of the scan costs, in beams.
const SOLID_WORK: u64 = 32;

/// A scanning laser fixed to the robot: beams side by side, beam 0 rightmost, anticlockwise.
///
/// It sees solids whose material returns light, movers, and the floor; not paint. It looks through solids from inside.
#[derive(Debug, Clone)]
pub struct Laser {
    scene: Arc<Scene>,
    seed: u64,
    scans: u64,
    min_range_m: f64,
    max_range_m: f64,
    noise_m: f32,
    surfaces: Surfaces,
    moving: Surfaces,
    seen: Vec<usize>,
    /// One that looks ahead; or two, to the right and to the left, of a laser that sees more than half a circle.
    sides: Vec<Side>,
}

/// Neighbouring beams that lie within half a circle.
#[derive(Debug, Clone)]
struct Side {
    /// In the robot's axes: the lens's place, and the middle of the side, a quarter turn left of it, and the normal of the
    /// scan.
    mount: [Vector3; 4],
    beams: Beams,
}

/// What each beam has met so far.
#[derive(Debug, Clone)]
struct Beams {
    /// Directions in the plane of the scan: along the middle of the side and to the left of it.
    ahead: Vec<f64>,
    left: Vec<f64>,
    ranges_m: Vec<f64>,
    /// Beams that were held against a face or a round side in this scan, and solids that were looked at.
    work: u64,
    processor: Processor,
}

/// The plane of the scan at its place in the world.
struct Plane {
    position: Vector3,
    ahead: Vector3,
    left: Vector3,
    normal: Vector3,
}

impl Laser {
    /// A laser in a scene. `seed` decides the noise.
    #[must_use]
    pub fn new(scene: &Arc<Scene>, settings: &LaserSettings, seed: u64) -> Self {
        Self {
            scene: Arc::clone(scene),
            seed,
            scans: 0,
            min_range_m: settings.min_range_m,
            max_range_m: settings.max_range_m,
            noise_m: settings.noise_m as f32,
            surfaces: Surfaces::new(&scene.parts().solids),
            moving: Surfaces::with_room(),
            seen: Vec::with_capacity(scene.parts().solids.len()),
            sides: sides(settings),
        }
    }

    /// How many scans were taken: with the seed, the address of the next scan's noise.
    #[must_use]
    pub(crate) fn scans(&self) -> u64 {
        self.scans
    }

    /// Continues as if `scans` scans had been taken.
    pub(crate) fn set_scans(&mut self, scans: u64) {
        self.scans = scans;
    }

    /// What the last scan took: beams that were held against faces, and solids that were cut.
    #[must_use]
    pub(crate) fn work(&self) -> u64 {
        self.sides.iter().map(|side| side.beams.work).sum()
    }

    /// Measures into `scan`, which gets one range for each beam. `world_from_robot` is the robot's base on the ground, x
    /// forward; `moving` are the solids that do not belong to the scene, where they stand now.
    pub fn scan(&mut self, world_from_robot: &Isometry3, moving: &[Solid], scan: &mut Scan) {
        let turn = world_from_robot.rotation.to_rotation_matrix();
        let parts = self.scene.parts();
        for side in &mut self.sides {
            let [place, ahead, left, normal] = side.mount.map(|vector| turn * vector);
            let plane = Plane { position: world_from_robot.translation.vector + place, ahead, left, normal };
            side.beams.start(&plane, self.max_range_m);
            find_near(&self.scene, &plane, self.max_range_m, &mut self.seen);
            for &index in &self.seen {
                let solid = &parts.solids[index];
                if solid.collides && parts.materials[solid.material].laser {
                    side.beams.meet(&plane, &self.surfaces, index, solid);
                }
            }
            for solid in moving.iter().filter(|solid| solid.collides && parts.materials[solid.material].laser) {
                self.moving.clear();
                // A cylinder is measured as itself, not by faces.
                if !matches!(solid.shape, Shape::Cylinder { .. }) {
                    self.moving.push(solid);
                }
                side.beams.meet(&plane, &self.moving, 0, solid);
            }
        }
        self.measure(scan);
        self.scans += 1;
    }

    /// Turns true ranges into measured ones.
    fn measure(&self, scan: &mut Scan) {
        let (min_m, max_m) = (self.min_range_m as f32, self.max_range_m as f32);
        scan.ranges_m.resize(self.sides.iter().map(|side| side.beams.ranges_m.len()).sum(), max_m);
        let start = noise::start(self.seed, self.scans, NOISE_ROW);
        let (mut rest, mut draws) = (scan.ranges_m.as_mut_slice(), &normal_table()[start..start + NORMAL_RUN]);
        for side in &self.sides {
            let truths = &side.beams.ranges_m;
            let (ranges_m, later) = rest.split_at_mut(truths.len());
            for ((range, truth), draw) in ranges_m.iter_mut().zip(truths).zip(draws) {
                let measured = (*truth as f32 + self.noise_m * draw).max(min_m).min(max_m);
                // Where nothing is seen there is nothing to be noisy about.
                *range = if *truth >= self.max_range_m { max_m } else { measured };
            }
            (rest, draws) = (later, &draws[truths.len()..]);
        }
    }
}

/// The sides of a laser: what is beside a line is only known within half a circle.
fn sides(settings: &LaserSettings) -> Vec<Side> {
    let (sin, cos) = libm::sincos(settings.tilt_deg.to_radians());
    let place = Vector3::new(settings.forward_m, 0.0, settings.height_m);
    let (ahead, left, normal) = (Vector3::new(cos, 0.0, -sin), Vector3::y(), Vector3::new(sin, 0.0, cos));
    let fan = settings.fan();
    let side = |from: usize, to: usize, middle_rad: f64, middle: Vector3, left: Vector3| {
        let along = |of: fn(f64) -> f64| (from..to).map(|beam| of(fan.bearing_rad(beam) - middle_rad)).collect();
        let (ahead, aside) = (along(libm::cos), along(libm::sin));
        let beams = Beams { ahead, left: aside, ranges_m: vec![0.0; to - from], work: 0, processor: Processor::best() };
        Side { mount: [place, middle, left, normal], beams }
    };
    if fan.view_deg <= 180.0 {
        return vec![side(0, fan.beams, 0.0, ahead, left)];
    }
    let right = (0..fan.beams).take_while(|beam| fan.bearing_rad(*beam) < 0.0).count();
    vec![side(0, right, -FRAC_PI_2, -left, ahead), side(right, fan.beams, FRAC_PI_2, left, -ahead)]
}

/// Lists the solids that the beams of a side may reach.
fn find_near(scene: &Scene, plane: &Plane, reach: f64, seen: &mut Vec<usize>) {
    let position = plane.position;
    let level = plane.normal.dot(&position);
    let mut spaces = [HalfSpace::new(&plane.ahead, plane.ahead.dot(&position)); 9];
    spaces[1] = HalfSpace::new(&plane.normal, level);
    spaces[2] = HalfSpace::new(&-plane.normal, -level);
    for (axis, pair) in [Vector3::x(), Vector3::y(), Vector3::z()].iter().zip(spaces[3..].chunks_exact_mut(2)) {
        pair[0] = HalfSpace::new(axis, axis.dot(&position) - reach);
        pair[1] = HalfSpace::new(&-axis, -axis.dot(&position) - reach);
    }
    seen.clear();
    let keep = |min, max| spaces.iter().all(|space| space.meets(&min, &max));
    scene.visit(keep, |solid| seen.push(solid));
}

impl Plane {
    /// A point as seen from the laser: ahead, to the left, and above the plane.
    fn local(&self, point: &Vector3) -> [f64; 3] {
        let from = point - self.position;
        [self.ahead.dot(&from), self.left.dot(&from), self.normal.dot(&from)]
    }
}

impl Beams {
    /// Forgets all but the floor.
    fn start(&mut self, plane: &Plane, max_range_m: f64) {
        self.work = 0;
        let height = plane.position.z;
        let (fall_ahead, fall_left) = (-plane.ahead.z, -plane.left.z);
        if height <= 0.0 || (fall_ahead.abs() < 1e-9 && fall_left.abs() < 1e-9) {
            self.ranges_m.fill(max_range_m);
            return;
        }
        for ((range, ahead), left) in self.ranges_m.iter_mut().zip(&self.ahead).zip(&self.left) {
            let fall = ahead * fall_ahead + left * fall_left;
            let floor = height / fall;
            *range = if fall > 1e-12 && floor < max_range_m { floor } else { max_range_m };
        }
    }

    /// Shortens the beams that meet a solid.
    fn meet(&mut self, plane: &Plane, surfaces: &Surfaces, index: usize, solid: &Solid) {
        self.work += SOLID_WORK;
        if let Shape::Cylinder { radius_m, half_height_m } = solid.shape {
            self.meet_cylinder(plane, solid, radius_m, half_height_m);
            return;
        }
        for face in &surfaces.faces()[surfaces.of_solid(index)] {
            if face.normal.dot(&plane.position) > face.offset_m {
                self.meet_face(plane, surfaces, face);
            }
        }
    }

    /// A convex face meets the plane of the scan in one stretch of a line.
    fn meet_face(&mut self, plane: &Plane, surfaces: &Surfaces, face: &Face) {
        let vertices = surfaces.vertices(face);
        let mut ends = [[0.0; 2]; 2];
        let mut found = 0;
        let mut from = plane.local(&vertices[vertices.len() - 1]);
        for vertex in vertices {
            let to = plane.local(vertex);
            if (from[2] < 0.0) != (to[2] < 0.0) && found < 2 {
                // From the lower end, whichever way round: neighbours that share the edge get the same point.
                let (low, high) = if from[2] < 0.0 { (from, to) } else { (to, from) };
                let share = low[2] / (low[2] - high[2]);
                ends[found] = [low[0] + (high[0] - low[0]) * share, low[1] + (high[1] - low[1]) * share];
                found += 1;
            }
            from = to;
        }
        if found == 2 {
            self.meet_line(ends[0], ends[1]);
        }
    }

    /// A stretch of a line in the plane of the scan, its ends ahead and to the left, metres.
    fn meet_line(&mut self, from: [f64; 2], to: [f64; 2]) {
        let (mut right, mut left) = if cross(from, to) > 0.0 { (from, to) } else { (to, from) };
        let turn = cross(right, left);
        // The end that lies behind the laser moves to where the line passes beside it.
        let beside = |front: [f64; 2], back: [f64; 2]| {
            [0.0, front[1] + (back[1] - front[1]) * (front[0] / (front[0] - back[0]))]
        };
        let along = [left[0] - right[0], left[1] - right[1]];
        match (right[0] < 0.0, left[0] < 0.0) {
            (true, true) => return,
            (true, false) => right = beside(left, right),
            (false, true) => left = beside(right, left),
            (false, false) => {}
        }
        let (first, last) = (self.first_beam(right, |side| side > 0.0), self.first_beam(left, |side| side >= 0.0));
        if first >= last || turn < 1e-12 {
            return;
        }
        let directions = [&self.ahead[first..last], &self.left[first..last]];
        // A vector of beams at a time.
        self.work += (last - first) as u64 / 8;
        shorten(self.processor, &mut self.ranges_m[first..last], directions, turn, along);
    }

    /// The first beam for which `before` does not hold; it gets how far the point lies to the left of the beam.
    fn first_beam(&self, point: [f64; 2], before: impl Fn(f64) -> bool) -> usize {
        let (mut low, mut high) = (0, self.ahead.len());
        while low < high {
            let middle = usize::midpoint(low, high);
            if before(cross([self.ahead[middle], self.left[middle]], point)) {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        low
    }

    /// The round side by its quadratic equation and the two caps as planes.
    fn meet_cylinder(&mut self, plane: &Plane, solid: &Solid, radius: f64, half_height: f64) {
        let centre = plane.local(&solid.centre.coords);
        let reach = (radius * radius + half_height * half_height).sqrt();
        let (first, last) = self.beams_towards([centre[0], centre[1]], reach);
        let from = plane.position - solid.centre.coords;
        let outside = from.x * from.x + from.y * from.y - radius * radius;
        self.work += (last - first) as u64;
        for beam in first..last {
            let direction = plane.ahead * self.ahead[beam] + plane.left * self.left[beam];
            let mut met = f64::INFINITY;
            let square = direction.x * direction.x + direction.y * direction.y;
            let half = direction.x * from.x + direction.y * from.y;
            let root = half * half - square * outside;
            if outside > 0.0 && root >= 0.0 && half < 0.0 {
                // Half and root have the same sign here, so nothing cancels.
                let side = outside / (-half + root.sqrt());
                if (from.z + side * direction.z).abs() <= half_height {
                    met = side;
                }
            }
            if from.z.abs() > half_height && from.z * direction.z < 0.0 {
                let cap = (from.z.abs() - half_height) / direction.z.abs();
                let (x, y) = (from.x + cap * direction.x, from.y + cap * direction.y);
                if x * x + y * y <= radius * radius {
                    met = met.min(cap);
                }
            }
            self.ranges_m[beam] = self.ranges_m[beam].min(met);
        }
    }

    /// The beams that may pass within `reach` of a point in the plane; too many rather than too few.
    fn beams_towards(&self, [ahead, left]: [f64; 2], reach: f64) -> (usize, usize) {
        let square = ahead * ahead + left * left - reach * reach;
        if ahead < -reach {
            return (0, 0);
        }
        if square <= 0.0 {
            return (0, self.ahead.len());
        }
        // The points where the tangents touch, times the distance's square over the tangent's length.
        let tangent = square.sqrt();
        let right_end = [ahead * tangent + left * reach, left * tangent - ahead * reach];
        let left_end = [ahead * tangent - left * reach, left * tangent + ahead * reach];
        // An end behind the laser lies on the centre's side of it, even where it is past straight behind.
        let count = self.ahead.len();
        let behind = |end: [f64; 2]| (end[0] < 0.0).then_some(if left < 0.0 { 0 } else { count });
        let (first, last) = (behind(right_end), behind(left_end));
        let first = first.unwrap_or_else(|| self.first_beam(right_end, |side| side > 0.0).saturating_sub(1));
        let last = last.unwrap_or_else(|| (self.first_beam(left_end, |side| side >= 0.0) + 1).min(count));
        (first, last)
    }
}

compiled_for_each_processor! {
    /// Shortens beams that meet a line, by their directions ahead and to the left: `turn` is how far the line's ends turn
    /// about the laser (a cross product), `along` leads from one to the other.
    fn shorten<'a>(ranges_m: &'a mut [f64], directions: [&'a [f64]; 2], turn: f64, along: [f64; 2]) {
        let [aheads, lefts] = directions;
        for (range, (ahead, left)) in ranges_m.iter_mut().zip(aheads.iter().zip(lefts)) {
            let met = turn / (ahead * along[1] - left * along[0]);
            *range = if met < *range && met > 0.0 { met } else { *range };
        }
    }
}

/// Positive if `b` lies to the left of `a`.
fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}
