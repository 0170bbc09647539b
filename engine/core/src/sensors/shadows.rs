//! Shadows of one sun on the floor and on flat faces: which points of the sun are hidden from each cell of a sheet.
//!
//! The sun is a disc of eight points, one bit each, or a single point. What stands still is cast once for a scene, what moves
//! for each frame. The shadow of a solid on a plane is that of its faces towards the sun, cut at the plane: convex polygons.

use super::drawing::Polygon;
use super::pattern::BATCH;
use super::sheet::{Area, Cells, Sheet};
use super::surface::{Face, Surfaces};
use crate::geometry::Vector3;
use crate::world::scene::{Light, Scene, Solid};
use std::sync::Arc;

/// Points of a sun that is wider than a point.
const SUN_POINTS: usize = 8;
/// The angle between one point and the next about the sun's middle, radians: the golden one spreads them evenly.
const GOLDEN_RAD: f64 = 2.399_963_229_728_653;
/// What stands less than this over a surface casts nothing on it, metres.
const LIFT_M: f64 = 1e-4;
/// No shadow on the floor is longer than this, metres.
const LONGEST_M: f64 = 50.0;
/// How far beside their routes the shadows of movers are drawn, metres.
const BESIDE_ROUTE_M: f64 = 5.0;
/// The sheet of a face that the sun does not reach.
const NO_SHEET: u32 = u32::MAX;
/// Sheets that movers may cast on in one frame before more room is made.
const MOST_TOUCHED: usize = 256;

/// Most work of casting what stands still, in rows of polygons and sixteens of their cells: some tenths of a second.
pub(super) const MOST_CAST: u64 = 8_000_000;

/// The shadows of a scene.
#[derive(Debug, Clone)]
pub(super) struct Shadows {
    /// Unit vectors towards the points of the sun, and their bits.
    suns: Vec<(Vector3, u8)>,
    /// The floor's first, then those of lit faces.
    sheets: Vec<Sheet>,
    /// By face.
    sheet_of_face: Vec<u32>,
    standing: Arc<Vec<u8>>,
    /// With what moves; empty until something does.
    now: Vec<u8>,
    casters: Surfaces,
    /// Sheets and areas of them on which something has cast that may stand elsewhere now.
    touched: Vec<(u32, Area)>,
    /// What casting took: for what stands still, and for what moved in the last frame.
    work: [u64; 2],
}

impl Shadows {
    /// The shadows of what stands in a scene with this light, whose solids have these faces; nothing if the light casts none.
    pub(super) fn new(scene: &Scene, light: &Light, surfaces: &Surfaces) -> Option<Box<Self>> {
        if !light.shadows || light.towards.z <= 0.0 {
            return None;
        }
        let suns = sun_points(light);
        let mut sheets = vec![Sheet::of_floor(floor_bounds(scene, &suns))];
        let mut sheet_of_face = vec![NO_SHEET; surfaces.faces().len()];
        for (index, face) in surfaces.faces().iter().enumerate() {
            if face.normal.dot(&light.towards) > 0.0 {
                sheet_of_face[index] = sheets.len() as u32;
                sheets.push(Sheet::of_face(face, surfaces.vertices(face)));
            }
        }
        let cells = Sheet::lay_out(&mut sheets);
        let mut shadows = Self {
            suns,
            sheets,
            sheet_of_face,
            standing: Arc::default(),
            now: Vec::new(),
            casters: Surfaces::with_room(),
            touched: Vec::with_capacity(MOST_TOUCHED),
            work: [0; 2],
        };
        let (standing, work) = shadows.cast_standing(scene, surfaces, cells);
        (shadows.standing, shadows.work[0]) = (Arc::new(standing), work);
        shadows.sheets.iter_mut().for_each(|sheet| sheet.survey(&shadows.standing));
        Some(Box::new(shadows))
    }

    /// Whether shadows may fall on a face.
    pub(super) fn falls_on(&self, face: usize) -> bool {
        self.sheet_of_face[face] != NO_SHEET
    }

    /// What casting took, counted: for what stands still, where it ends soon after [`MOST_CAST`], and for what moved in the
    /// last frame.
    pub(super) fn work(&self) -> [u64; 2] {
        self.work
    }

    /// The cells, and what they took.
    fn cast_standing(&self, scene: &Scene, surfaces: &Surfaces, count: usize) -> (Vec<u8>, u64) {
        let (mut all, mut work) = (vec![0; count], 0);
        for sheet in &self.sheets {
            for &(sun, bit) in &self.suns {
                let mut cells = sheet.cells(&mut all);
                if sheet.normal.dot(&sun) <= 1e-9 {
                    cells.fill(bit);
                    continue;
                }
                scene.visit(
                    |min, max| sheet.may_be_shaded_by(&sun, &min, &max),
                    |solid| {
                        work += 1;
                        if scene.parts().solids[solid].collides && work + cells.work <= MOST_CAST {
                            cast(sheet, &mut cells, surfaces, &surfaces.faces()[surfaces.of_solid(solid)], (&sun, bit));
                        }
                    },
                );
                work += cells.work;
                if work > MOST_CAST {
                    return (all, work);
                }
            }
        }
        (all, work)
    }

    /// Casts the shadows of what moves on the floor and on these solids of the scene. Allocates when something moves for the
    /// first time.
    pub(super) fn cast_moving(&mut self, moving: &[Solid], surfaces: &Surfaces, seen: &[usize]) {
        for (sheet, area) in &self.touched {
            self.sheets[*sheet as usize].restore(area, &mut self.now, &self.standing);
        }
        self.touched.clear();
        self.work[1] = 0;
        if moving.is_empty() {
            return;
        }
        if self.now.is_empty() {
            self.now.extend_from_slice(&self.standing);
        }
        self.casters.clear();
        for solid in moving {
            self.casters.push(solid);
        }
        let faces = seen.iter().flat_map(|&solid| surfaces.of_solid(solid)).map(|face| self.sheet_of_face[face]);
        for number in std::iter::once(0).chain(faces).filter(|sheet| *sheet != NO_SHEET) {
            let sheet = &self.sheets[number as usize];
            let mut cells = sheet.cells(&mut self.now);
            for (index, solid) in moving.iter().enumerate() {
                let (min, max) = solid.bounds();
                let single = |point: crate::geometry::Point3| [point.x as f32, point.y as f32, point.z as f32];
                for (sun, bit) in &self.suns {
                    if sheet.normal.dot(sun) > 1e-9 && sheet.may_be_shaded_by(sun, &single(min), &single(max)) {
                        let faces = &self.casters.faces()[self.casters.of_solid(index)];
                        cast(sheet, &mut cells, &self.casters, faces, (sun, *bit));
                    }
                }
            }
            let area = cells.drawn;
            self.work[1] += cells.work;
            if area.is_some() {
                self.touched.push((number, area));
            }
        }
    }

    /// Share of the sun that is seen from a point, by what stands still: that of a mover's middle is the light of all of it.
    pub(super) fn seen_from(&self, point: &Vector3, scene: &Scene, surfaces: &Surfaces) -> f64 {
        let mut hidden = 0_u8;
        let at = [point.x as f32, point.y as f32, point.z as f32];
        for (sun, bit) in &self.suns {
            scene.visit(
                |min, max| super::sheet::sweep_meets(&at, &at, sun, &min, &max),
                |solid| {
                    if hidden & bit == 0
                        && scene.parts().solids[solid].collides
                        && meets(&surfaces.faces()[surfaces.of_solid(solid)], point, sun)
                    {
                        hidden |= bit;
                    }
                },
            );
        }
        1.0 - f64::from(hidden.count_ones()) / 8.0
    }

    /// Whether all of the sun is hidden from, or seen from, all places on a line between two of a sheet; nothing if that is not
    /// known.
    #[inline(always)]
    pub(super) fn same_between(&self, sheet: u32, ends: &[[f32; 2]; 2]) -> Option<bool> {
        let changed = self.touched.iter().find(|(touched, _)| *touched == sheet).map(|(_, area)| area);
        self.sheets[sheet as usize].same_between(ends, changed)
    }

    /// How many eighths of the sun are hidden from places on a sheet; metres along the surface's two axes.
    #[inline(always)]
    pub(super) fn hidden(&self, sheet: u32, along: &[f32; BATCH], across: &[f32; BATCH], hidden: &mut [u8; BATCH]) {
        let sheet = &self.sheets[sheet as usize];
        let cells = if self.now.is_empty() { &self.standing[sheet.range()] } else { &self.now[sheet.range()] };
        sheet.read(cells, along, across, hidden);
    }
}

/// Casts the shadow of one solid, of these faces, on a sheet.
fn cast(sheet: &Sheet, cells: &mut Cells<'_>, surfaces: &Surfaces, faces: &[Face], (sun, bit): (&Vector3, u8)) {
    let fall = sheet.normal.dot(sun);
    for face in faces {
        if face.normal.dot(sun) <= 1e-9 {
            continue;
        }
        let mut polygon = Polygon::new(surfaces.vertices(face));
        polygon.clip(|point| sheet.normal.dot(point) - sheet.offset_m - LIFT_M);
        for point in polygon.points_mut() {
            let height = sheet.normal.dot(point) - sheet.offset_m;
            *point -= sun * (height / fall);
        }
        cells.draw(sheet, polygon.points_mut(), bit);
    }
}

/// Whether a ray meets a convex solid, of these faces.
fn meets(faces: &[Face], from: &Vector3, ray: &Vector3) -> bool {
    let (mut enter, mut leave) = (0.0_f64, f64::INFINITY);
    for face in faces {
        let (height, fall) = (face.normal.dot(from) - face.offset_m, -face.normal.dot(ray));
        if fall > 0.0 {
            enter = enter.max(height / fall);
        } else if fall < 0.0 {
            leave = leave.min(height / fall);
        } else if height > 0.0 {
            return false;
        }
    }
    enter < leave
}

/// Directions to points of the sun's disc, evenly spread over it, and the bits that stand for them.
fn sun_points(light: &Light) -> Vec<(Vector3, u8)> {
    if light.softness_deg <= 0.0 {
        return vec![(light.towards, u8::MAX)];
    }
    let middle = light.towards;
    let aside = Vector3::z().cross(&middle);
    let aside = if aside.norm() < 1e-6 { Vector3::x() } else { aside.normalize() };
    let upright = middle.cross(&aside);
    let radius = libm::tan(0.5 * light.softness_deg.to_radians());
    let point = |index: usize| {
        let (sin, cos) = libm::sincos(GOLDEN_RAD * index as f64);
        let off = radius * ((index as f64 + 0.5) / SUN_POINTS as f64).sqrt();
        ((middle + (aside * cos + upright * sin) * off).normalize(), 1 << index)
    };
    (0..SUN_POINTS).map(point).collect()
}

/// The part of the floor on which shadows may lie: least and greatest coordinates, metres; nothing if there are none.
fn floor_bounds(scene: &Scene, suns: &[(Vector3, u8)]) -> Option<[[f64; 2]; 2]> {
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    let mut hold = |axis: usize, value: f64| {
        (low[axis], high[axis]) = (low[axis].min(value), high[axis].max(value));
    };
    for solid in scene.parts().solids.iter().filter(|solid| solid.collides) {
        let (min, max) = solid.bounds();
        for (sun, _) in suns.iter().filter(|(sun, _)| sun.z > 1e-9) {
            let way = (max.z / sun.z).min(LONGEST_M / libm::hypot(sun.x, sun.y).max(1e-9));
            for axis in 0..2 {
                let cast = -sun[axis] * way.max(0.0);
                hold(axis, min[axis] + cast.min(0.0));
                hold(axis, max[axis] + cast.max(0.0));
            }
        }
    }
    for place in scene.driven().into_iter().flatten() {
        for axis in 0..2 {
            hold(axis, place[axis] - BESIDE_ROUTE_M);
            hold(axis, place[axis] + BESIDE_ROUTE_M);
        }
    }
    (low[0] <= high[0]).then_some([low, high])
}
