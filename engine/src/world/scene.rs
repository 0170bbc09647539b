//! What stands still: solids, materials, light, and the queries over them.
//!
//! Plain data first; `Scene::new` puts every solid under one bounding volume hierarchy.

use crate::geometry::{Point3, Vector3};

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
}

/// One sun and the light that comes from everywhere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    /// Unit vector from the scene towards the light.
    pub towards: Vector3,
    /// Share of the light that comes from everywhere, 0 to 1.
    pub ambient: f64,
    /// Brightness of the whole picture; 1 is normal.
    pub gain: f64,
}

impl Light {
    /// Brightness of a surface with the unit normal `normal`: gain * (ambient + (1 - ambient) * max(0, cos)).
    #[must_use]
    pub fn on(&self, normal: &Vector3) -> f64 {
        self.gain * (self.ambient + (1.0 - self.ambient) * self.towards.dot(normal).max(0.0))
    }
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
