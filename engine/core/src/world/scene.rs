//! What stands still in a world: solids, materials, light.
//!
//! Plain data first; [`Scene::new`] puts every solid under one bounding volume hierarchy, so that contact, ground and
//! sensors look only at what is near. The hierarchy is all that parry3d is used for; contact and ground are our own, and
//! tests hold contact against parry3d's.

use parry3d::bounding_volume::Aabb;
use parry3d::math::Vector;
use parry3d::partitioning::{Bvh, BvhBuildStrategy, TraversalAction};

pub use super::light::Light;
use crate::geometry::{Point2, Point3, Vector3};

/// The form of a solid in its own axes, its centre at the origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// A box by its half extents along x, y and z, metres.
    Box {
        /// Half lengths, all positive.
        half_m: Vector3,
    },
    /// An upright cylinder.
    Cylinder {
        /// Radius, metres.
        radius_m: f64,
        /// Half of its height, metres.
        half_height_m: f64,
    },
    /// A ramp: a box whose top falls from full height at +x to nothing at -x.
    Ramp {
        /// Half lengths of the box around it, all positive.
        half_m: Vector3,
    },
}

/// A shape at a place: upright, turned only about the vertical.
#[derive(Debug, Clone, PartialEq)]
pub struct Solid {
    /// Its form.
    pub shape: Shape,
    /// Its centre in the world, metres.
    pub centre: Point3,
    /// Its heading, radians.
    pub yaw_rad: f64,
    /// Index into [`SceneParts::materials`].
    pub material: usize,
    /// Whether the robot can touch it and stand on it; paint on the floor is not solid in this sense.
    pub collides: bool,
}

/// How a surface looks, and whether the laser sees it.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// The name in the world file.
    pub name: String,
    /// Red, green, blue under full light.
    pub colour: [u8; 3],
    /// What is drawn over the colour.
    pub texture: Texture,
    /// False for glass: the laser passes, the camera sees it.
    pub laser: bool,
}

/// A procedural texture: grey levels added to the colour, as a function of the place on the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Texture {
    /// One colour.
    Plain,
    /// Squares of `scale_m`, alternately `amplitude` lighter and darker.
    Checker {
        /// Grey levels, 0 to 127.
        amplitude: f64,
        /// Side of a square, metres.
        scale_m: f64,
    },
    /// Stripes `scale_m` wide along the surface's second axis, alternately lighter and darker.
    Stripes {
        /// Grey levels, 0 to 127.
        amplitude: f64,
        /// Width of a stripe, metres.
        scale_m: f64,
    },
    /// Smooth value noise with lumps of about `scale_m`.
    Noise {
        /// Grey levels, 0 to 127.
        amplitude: f64,
        /// Distance of the lattice points, metres.
        scale_m: f64,
    },
    /// Square tiles, row by row.
    Tiles(Tiling),
    /// Bricks half as high as long, every second row shifted by half a brick.
    Bricks(Tiling),
}

impl Texture {
    /// A texture of a kind of world files; plain if there is no such kind. Those without joints have amplitude and scale of `tiling`.
    #[must_use]
    pub(crate) fn of_kind(kind: &str, tiling: Tiling) -> Self {
        let Tiling { amplitude, scale_m, .. } = tiling;
        match kind {
            "checker" => Self::Checker { amplitude, scale_m },
            "stripes" => Self::Stripes { amplitude, scale_m },
            "noise" => Self::Noise { amplitude, scale_m },
            "tiles" => Self::Tiles(tiling),
            "bricks" => Self::Bricks(tiling),
            _ => Self::Plain,
        }
    }
}

impl Default for Tiling {
    /// What a world file means that does not say it.
    fn default() -> Self {
        Self { amplitude: 10.0, scale_m: 0.2, joint_m: 0.012, joint: 40.0 }
    }
}

/// Tiles or bricks, and the joints between them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tiling {
    /// Most that a tile is lighter or darker than the colour, grey levels, 0 to 127.
    pub amplitude: f64,
    /// Length of a tile from joint to joint, metres.
    pub scale_m: f64,
    /// Width of a joint, metres.
    pub joint_m: f64,
    /// How much darker than the colour a joint is, grey levels, 0 to 127.
    pub joint: f64,
}

/// All that stands still in a world.
#[derive(Debug, Clone)]
pub struct SceneParts {
    /// Walls, boxes, cylinders, platforms, paint.
    pub solids: Vec<Solid>,
    /// Every material that a solid names by index.
    pub materials: Vec<Material>,
    /// The material of the endless floor at z = 0.
    pub floor: usize,
    /// The light.
    pub light: Light,
}

impl Shape {
    /// Half extents of the box around the shape in its own axes, metres.
    #[must_use]
    pub fn half_extents(&self) -> Vector3 {
        match *self {
            Self::Box { half_m } | Self::Ramp { half_m } => half_m,
            Self::Cylinder { radius_m, half_height_m } => Vector3::new(radius_m, radius_m, half_height_m),
        }
    }
}

impl Solid {
    /// The corners of the box with the world's axes around the solid: least and greatest coordinates, metres.
    #[must_use]
    pub fn bounds(&self) -> (Point3, Point3) {
        let half = self.shape.half_extents();
        let reach = if let Shape::Cylinder { .. } = self.shape {
            half
        } else {
            let (sin, cos) = libm::sincos(self.yaw_rad);
            let (sin, cos) = (sin.abs(), cos.abs());
            Vector3::new(cos * half.x + sin * half.y, sin * half.x + cos * half.y, half.z)
        };
        (self.centre - reach, self.centre + reach)
    }
}

/// The solids of a world that stand still, under one bounding volume hierarchy.
#[derive(Debug, Clone)]
pub struct Scene {
    parts: SceneParts,
    hierarchy: Bvh,
    /// Where on the floor plan movers drive: least and greatest coordinates, metres.
    driven: Option<[Point2; 2]>,
}

impl Scene {
    /// Builds the hierarchy. The order of the solids decides their indices and is kept.
    #[must_use]
    pub fn new(parts: SceneParts) -> Self {
        let leaves: Vec<Aabb> = parts.solids.iter().map(|solid| loose_box(solid.bounds())).collect();
        Self { hierarchy: Bvh::from_leaves(BvhBuildStrategy::Binned, &leaves), parts, driven: None }
    }

    /// This scene with things that drive over these places of the floor plan, for their shadows.
    #[must_use]
    pub(crate) fn driven_over<'a>(mut self, places: impl Iterator<Item = &'a Point2>) -> Self {
        for place in places {
            let [low, high] = self.driven.unwrap_or([*place; 2]);
            self.driven = Some([low.inf(place), high.sup(place)]);
        }
        self
    }

    /// Where movers drive: least and greatest coordinates on the floor plan, metres.
    pub(crate) fn driven(&self) -> Option<[Point2; 2]> {
        self.driven
    }

    /// This scene with each of its materials so many grey levels lighter, negative ones darker, and of another kind of texture.
    #[must_use]
    pub(crate) fn repainted(&self, changes: impl Iterator<Item = (Option<f64>, Option<&'static str>)>) -> Self {
        let mut scene = self.clone();
        for (material, (levels, texture)) in scene.parts.materials.iter_mut().zip(changes) {
            if let Some(levels) = levels {
                material.colour =
                    material.colour.map(|level| (f64::from(level) + levels).round().clamp(0.0, 255.0) as u8);
            }
            if let Some(kind) = texture {
                material.texture = Texture::of_kind(kind, Tiling::default());
            }
        }
        scene
    }

    /// The solids, materials, floor and light.
    #[must_use]
    pub fn parts(&self) -> &SceneParts {
        &self.parts
    }

    /// Calls `each` with the index of every solid whose surrounding box, and all boxes around that one, `keep` accepts.
    ///
    /// `keep` gets the least and greatest corner of a box with the world's axes, metres. The order is that of the
    /// hierarchy: the same in every run, but not sorted.
    pub(crate) fn visit(&self, mut keep: impl FnMut([f32; 3], [f32; 3]) -> bool, mut each: impl FnMut(usize)) {
        self.hierarchy.traverse(|node| {
            if !keep(node.mins().to_array(), node.maxs().to_array()) {
                return TraversalAction::Prune;
            }
            if let Some(solid) = node.leaf_data() {
                each(solid as usize);
            }
            TraversalAction::Continue
        });
    }
}

/// The box in single precision, widened so that rounding never makes it smaller than the solid.
fn loose_box((min, max): (Point3, Point3)) -> Aabb {
    let loose = |value: f64, by: f64| (value + by * (1e-4 + value.abs() * 1e-6)) as f32;
    Aabb::new(
        Vector::new(loose(min.x, -1.0), loose(min.y, -1.0), loose(min.z, -1.0)),
        Vector::new(loose(max.x, 1.0), loose(max.y, 1.0), loose(max.z, 1.0)),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn boxes(count: usize) -> Scene {
        let solids = (0..count)
            .map(|index| Solid {
                shape: Shape::Box { half_m: Vector3::new(0.4, 0.4, 0.5) },
                centre: Point3::new(index as f64, 0.0, 0.5),
                yaw_rad: 0.0,
                material: 0,
                collides: true,
            })
            .collect();
        let light = Light::from_direction(Vector3::z(), 0.5, 1.0);
        Scene::new(SceneParts { solids, materials: Vec::new(), floor: 0, light })
    }

    fn between(scene: &Scene, low: f32, high: f32) -> Vec<usize> {
        let mut found = Vec::new();
        scene.visit(|min, max| min[0] <= high && max[0] >= low, |solid| found.push(solid));
        found.sort_unstable();
        found
    }

    #[test]
    fn a_visit_finds_just_the_solids_whose_boxes_are_kept() {
        assert_eq!(between(&boxes(50), 9.7, 12.3), [10, 11, 12]);
        assert_eq!(between(&boxes(1), -1.0, 1.0), [0]);
        assert_eq!(between(&boxes(0), -1.0, 1.0), [] as [usize; 0]);
    }

    #[test]
    fn a_turned_box_has_wider_bounds() {
        let mut solid = boxes(1).parts.solids.remove(0);
        solid.yaw_rad = std::f64::consts::FRAC_PI_4;
        let (_, max) = solid.bounds();
        assert!((max.x - 0.8 * std::f64::consts::FRAC_1_SQRT_2).abs() < 1e-12);
    }
}
