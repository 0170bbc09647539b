//! Three downward sensors with lamps of their own: the colour of the ground under them, without shadow or noise.

use super::pattern::BATCH;
use super::surface::{CYLINDER_SIDES, Surfaces};
use super::texture::Looks;
use crate::geometry::{Isometry3, Point3, Vector3};
use crate::settings::GroundSettings;
use crate::world::scene::{Scene, Shape, Solid};

/// Ground so much higher than the robot's own is no longer under it, metres.
const ABOVE_M: f64 = 0.05;
/// Ground so much lower is out of reach: an edge, metres.
const BELOW_M: f64 = 0.10;
/// How far paint stands off what it is painted on is nothing to a lamp: a tie is the later solid's.
const TIE_M: f64 = 1e-9;

/// The colours under the three sensors: the middle one, the left one, the right one. Red, green, blue; black off the ground.
pub type GroundColours = [[u8; 3]; 3];

/// The sensors over one scene.
#[derive(Debug, Clone)]
pub struct GroundSensors {
    scene: Scene,
    surfaces: Surfaces,
    /// One look for each material, unlit.
    looks: Looks,
    /// In the robot's axes.
    places: [Point3; 3],
}

impl GroundSensors {
    /// Sensors under a robot in this scene.
    #[must_use]
    pub fn new(scene: &Scene, settings: &GroundSettings) -> Self {
        let mut looks = Looks::default();
        for material in &scene.parts().materials {
            looks.push(material, 1.0);
        }
        let place = |aside_m: f64| Point3::new(settings.ahead_m, aside_m, 0.0);
        let places = [place(0.0), place(settings.aside_m), place(-settings.aside_m)];
        Self { surfaces: Surfaces::new(&scene.parts().solids), scene: scene.clone(), looks, places }
    }

    /// What they read under a robot that stands so. Allocates nothing.
    #[must_use]
    pub fn read(&self, world_from_robot: &Isometry3) -> GroundColours {
        self.places.map(|place| self.colour(world_from_robot * place))
    }

    fn colour(&self, at: Point3) -> [u8; 3] {
        let (floor, mut found) = (self.scene.parts().floor, None::<(f64, usize)>);
        let over = |min: [f32; 3], max: [f32; 3]| {
            let within = |axis: usize, value: f64| f64::from(min[axis]) <= value && value <= f64::from(max[axis]);
            within(0, at.x) && within(1, at.y)
        };
        self.scene.visit(over, |solid| {
            let Some(top_m) = self.top_m(solid, at).filter(|top_m| *top_m <= at.z + ABOVE_M) else { return };
            let higher = found.is_none_or(|(height, known)| {
                top_m > height + TIE_M || (top_m - height).abs() <= TIE_M && solid > known
            });
            if higher {
                found = Some((top_m, solid));
            }
        });
        let on_floor = found.is_none_or(|(top_m, _)| top_m < 0.0);
        let height_m = if on_floor { 0.0 } else { found.map_or(0.0, |(top_m, _)| top_m) };
        if height_m < at.z - BELOW_M || height_m > at.z + ABOVE_M {
            return [0; 3];
        }
        match found.filter(|_| !on_floor) {
            None => self.look(floor, at.x, at.y),
            Some((top_m, solid)) => {
                let face = &self.surfaces.faces()[self.top_face(solid)];
                let from = Vector3::new(at.x, at.y, top_m) - face.origin;
                self.look(face.material, from.dot(&face.along), from.dot(&face.across()))
            }
        }
    }

    fn look(&self, material: usize, along_m: f64, across_m: f64) -> [u8; 3] {
        let look = self.looks.get(material);
        if look.is_plain() {
            return [look.pattern[0], look.pattern[1], look.pattern[2]];
        }
        let mut indices = [0; BATCH];
        look.places.choose(&[along_m as f32; BATCH], &[across_m as f32; BATCH], &mut indices);
        let [red, green, blue, _] = self.looks.palette(look)[usize::from(indices[0])];
        [red, green, blue]
    }

    fn top_face(&self, solid: usize) -> usize {
        let first = self.surfaces.of_solid(solid).start;
        match self.scene.parts().solids[solid].shape {
            Shape::Cylinder { .. } => first + CYLINDER_SIDES,
            Shape::Box { .. } | Shape::Ramp { .. } => first,
        }
    }

    /// How high a solid is at a place; nothing beside it.
    fn top_m(&self, solid: usize, at: Point3) -> Option<f64> {
        if !covers(&self.scene.parts().solids[solid], at) {
            return None;
        }
        let face = &self.surfaces.faces()[self.top_face(solid)];
        Some((face.offset_m - face.normal.x * at.x - face.normal.y * at.y) / face.normal.z)
    }
}

/// Whether a place lies over a solid, seen from above.
fn covers(solid: &Solid, at: Point3) -> bool {
    let (x, y) = (at.x - solid.centre.x, at.y - solid.centre.y);
    match solid.shape {
        Shape::Cylinder { radius_m, .. } => x * x + y * y <= radius_m * radius_m,
        Shape::Box { half_m } | Shape::Ramp { half_m } => {
            let (sin, cos) = libm::sincos(solid.yaw_rad);
            (cos * x + sin * y).abs() <= half_m.x && (cos * y - sin * x).abs() <= half_m.y
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::scene::{Light, Material, SceneParts, Texture};
    use std::f64::consts::FRAC_PI_2;

    fn scene() -> Scene {
        let material =
            |name: &str, colour: [u8; 3], texture| Material { name: name.to_owned(), colour, texture, laser: true };
        let materials = vec![
            material("floor", [90, 90, 90], Texture::Checker { amplitude: 20.0, scale_m: 1.0 }),
            material("yellow", [200, 180, 20], Texture::Plain),
            material("slab", [60, 60, 200], Texture::Plain),
        ];
        let boxed = |centre: Point3, half_m: Vector3, material, collides| Solid {
            shape: Shape::Box { half_m },
            centre,
            yaw_rad: FRAC_PI_2,
            material,
            collides,
        };
        // A painted stripe 0.1 m wide along x at y = 0.2, and a slab 0.3 m high from x = 4 to 6. Both are turned by 90 degrees.
        let paint = boxed(Point3::new(0.0, 0.2, 0.0), Vector3::new(0.05, 2.0, 0.001), 1, false);
        let slab = boxed(Point3::new(5.0, 0.0, 0.15), Vector3::new(1.0, 1.0, 0.15), 2, true);
        let light = Light::from_direction(Vector3::z(), 0.1, 0.3);
        Scene::new(SceneParts { solids: vec![paint, slab], materials, floor: 0, light })
    }

    fn read(x_m: f64, z_m: f64) -> GroundColours {
        let sensors = GroundSensors::new(&scene(), &GroundSettings { ahead_m: 0.1, aside_m: 0.2 });
        sensors.read(&Isometry3::translation(x_m, 0.0, z_m))
    }

    #[test]
    fn paint_and_floor_are_read_in_their_own_colours_whatever_the_light() {
        // The middle one stands on a light square, the left one on paint, the right one on a dark square.
        assert_eq!(read(0.3, 0.0), [[110, 110, 110], [200, 180, 20], [70, 70, 70]]);
    }

    #[test]
    fn a_slab_is_the_ground_for_whoever_stands_on_it_and_a_wall_for_others() {
        assert_eq!(read(4.5, 0.3), [[60, 60, 200]; 3]);
        // Over its edge the floor is too far below; before it, its top is not under the robot.
        assert_eq!(read(5.95, 0.3), [[0; 3]; 3]);
        assert_eq!(read(4.5, 0.0)[0], [110, 110, 110]);
    }
}
