//! The camera: draws what stands before it, visible faces first and colours afterwards.

use super::canvas::{Colours, PixelCanvas, Weights};
use super::drawing::Drawing;
use super::lens::Fisheye;
use super::luma;
use super::noise::PixelNoise;
use super::observation::Image;
use super::painting::{Drawn, Painting};
use super::shadows::{MOST_CAST, Shadows};
use super::spans::Spans;
use super::stretches::{FLOOR_FACE, OUTSIDE_LENS, SKY_FACE, Sight, Stretches};
use super::surface::Surfaces;
use super::texture::{Looks, PaintMark};
use super::tint::Drift;
use super::view::{Affine, CameraView, Frustum, Pinhole};
use crate::geometry::{Isometry3, Point3, Vector3};
use crate::settings::{CameraSettings, Lens};
use crate::world::scene::{Light, Scene, Solid};
use dispatch::Processor;
use filter_api::Format;
use std::sync::Arc;

mod depth;

/// Faces of movers for which there is room from the start.
const MOVING_FACES: usize = 256;
/// What bringing one face into the view costs, in rows of a face.
const FACE_WORK: u64 = 4;
/// What is seen where there is nothing.
const SKY: [u8; 3] = [186, 198, 210];

/// A colour camera fixed to the robot, with a pinhole or an equidistant fisheye lens.
///
/// Cylinders are drawn as prisms with 32 sides. A camera inside a solid, or below the floor, sees through it.
#[derive(Debug, Clone)]
pub struct Camera {
    scene: Arc<Scene>,
    width_px: usize,
    height_px: usize,
    pinhole: Pinhole,
    fisheye: Option<Fisheye>,
    noise: Option<PixelNoise>,
    depth: depth::DepthSensor,
    drift: Option<Drift>,
    frame: u64,
    /// In the robot's axes: the lens's place, and right, down and forward.
    mount: [Vector3; 4],
    light: Light,
    shadows: Option<Box<Shadows>>,
    surfaces: Surfaces,
    moving: Surfaces,
    looks: Looks,
    standing_looks: PaintMark,
    spans: Spans,
    stretches: Stretches,
    seen: Vec<usize>,
    drawn: Vec<Drawn>,
    nearness: Vec<Affine>,
    /// Faces that were tried for the last image.
    looked_at: u64,
    processor: Processor,
    /// What grey images are made from: the weighted sums of the colours, or colours that noise may cut off.
    weights: Vec<u16>,
    colours: Vec<u8>,
}

impl Camera {
    /// A camera in a scene. `seed` decides the noise.
    #[must_use]
    pub fn new(scene: &Arc<Scene>, settings: &CameraSettings, seed: u64) -> Self {
        let (width_px, height_px) = (settings.width_px as usize, settings.height_px as usize);
        let field_of_view_rad = settings.field_of_view_deg.to_radians();
        let fisheye = (settings.lens == Lens::Fisheye).then(|| Fisheye::new(width_px, height_px, field_of_view_rad));
        let focal_px = width_px as f64 * 0.5 / libm::tan(field_of_view_rad * 0.5);
        let pinhole = fisheye.as_ref().map_or(Pinhole { width_px, height_px, focal_px }, |lens| lens.pinhole);
        let (sin, cos) = libm::sincos(settings.tilt_deg.to_radians());
        let mount = [
            Vector3::new(settings.forward_m, 0.0, settings.height_m),
            Vector3::new(0.0, -1.0, 0.0),
            Vector3::new(-sin, 0.0, -cos),
            Vector3::new(cos, 0.0, -sin),
        ];
        let parts = scene.parts();
        let light = parts.light.changed(&settings.light);
        let surfaces = Surfaces::new(&parts.solids);
        let shadows = Shadows::new(scene, &light, &surfaces);
        let mut looks = Looks::default();
        looks.push_plain(SKY);
        looks.push(&parts.materials[parts.floor], light.on(&Vector3::z()));
        if shadows.is_some() {
            looks.shade(&parts.materials[parts.floor], &light, &Vector3::z());
        }
        let black = fisheye.as_ref().is_some_and(Fisheye::has_outside);
        looks.push_plain(if black { [0; 3] } else { SKY });
        let faces = surfaces.faces().len();
        for (index, face) in surfaces.faces().iter().enumerate() {
            looks.push(&parts.materials[face.material], light.on(&face.normal));
            if shadows.as_ref().is_some_and(|shadows| shadows.falls_on(index)) {
                looks.shade(&parts.materials[face.material], &light, &face.normal);
            }
        }
        looks.reserve(MOVING_FACES);
        Self {
            scene: Arc::clone(scene),
            width_px,
            height_px,
            pinhole,
            fisheye,
            noise: PixelNoise::new(settings.noise, seed),
            depth: depth::DepthSensor::new(settings, seed),
            drift: Drift::new(settings, seed),
            frame: 0,
            mount,
            light,
            shadows,
            surfaces,
            moving: Surfaces::with_room(),
            standing_looks: looks.mark(),
            looks,
            spans: Spans::new(pinhole.width_px, pinhole.height_px),
            stretches: Stretches::with_room(height_px),
            seen: Vec::with_capacity(parts.solids.len()),
            drawn: Vec::with_capacity(faces + MOVING_FACES),
            nearness: Vec::with_capacity(faces + MOVING_FACES),
            looked_at: 0,
            processor: Processor::best(),
            weights: Vec::new(),
            colours: Vec::new(),
        }
    }

    /// How many frames were rendered: with the seed, the address of the next frame's noise.
    #[must_use]
    pub(crate) fn frames(&self) -> u64 {
        self.frame
    }

    /// Continues as if `frames` frames had been rendered.
    pub(crate) fn set_frames(&mut self, frames: u64) {
        self.frame = frames;
    }

    /// What finding the visible faces of the last image took: faces in sight, the rows that they cover, and the runs of pixels
    /// that they were compared with; and the shadows of what moves.
    #[must_use]
    pub(crate) fn work(&self) -> u64 {
        let cast = self.shadows.as_ref().map_or(0, |shadows| shadows.work()[1]);
        self.spans.work() + FACE_WORK * self.looked_at + cast
    }

    /// Whether the shadows of what stands still took more work than they may, so that they are not complete.
    #[must_use]
    pub(crate) fn lacks_shadows(&self) -> bool {
        self.shadows.as_ref().is_some_and(|shadows| shadows.work()[0] > MOST_CAST)
    }

    /// Renders into `image`, which gets the camera's size and keeps its format: colour, grey or depth. Grey is the luma of the
    /// same image in colour. `world_from_robot` is the robot's base on the ground, x forward; `moving` are the solids
    /// that do not belong to the scene, where they stand now.
    pub fn render(&mut self, world_from_robot: &Isometry3, moving: &[Solid], image: &mut Image) {
        match image.format {
            Format::Depth => self.render_both(world_from_robot, moving, None, Some(image)),
            _ => self.render_both(world_from_robot, moving, Some(image), None),
        }
    }

    /// As [`Camera::render`], but what is not asked for costs nothing: colours or brightness, and depth of the same moment.
    pub fn render_both(
        &mut self,
        world_from_robot: &Isometry3,
        moving: &[Solid],
        image: Option<&mut Image>,
        depth: Option<&mut Image>,
    ) {
        if image.is_none() && depth.is_none() {
            self.frame += 1;
            return;
        }
        let view = self.view(world_from_robot);
        let frustum = view.frustum();
        self.place_movers(moving, &frustum);
        self.find_visible(&view, &frustum);
        if let Some(image) = image {
            self.fit(image);
            if let Some(shadows) = &mut self.shadows {
                shadows.cast_moving(moving, &self.surfaces, &self.seen);
            }
            self.list();
            if image.format == Format::Rgb { self.paint(&mut image.pixels) } else { self.paint_grey(&mut image.pixels) }
        }
        if let Some(depth) = depth {
            self.fit(depth);
            self.measure(&mut depth.pixels);
        }
        self.frame += 1;
    }

    /// Gives an image the camera's size.
    fn fit(&self, image: &mut Image) {
        let (width, height) = (self.width_px, self.height_px);
        if (image.width_px, image.height_px) != (width, height)
            || image.pixels.len() != width * height * image.format.channels()
        {
            *image = Image::of(image.format, width, height);
        }
    }

    /// Lists what the pixels show.
    fn list(&mut self) {
        let floor = self.nearness[FLOOR_FACE as usize];
        let sight = Sight { pinhole: self.pinhole, spans: &self.spans, floor };
        let drawn = &self.drawn;
        let is_plain = |face: u32| drawn[face as usize].plain;
        match &self.fisheye {
            None => self.stretches.see(&sight, is_plain),
            Some(lens) => self.stretches.see_through(lens, self.width_px, &sight, is_plain),
        }
    }

    fn paint_on<C: PixelCanvas>(&self, canvas: C) {
        self.processor.run(Painting {
            canvas,
            stretches: &self.stretches,
            looks: &self.looks,
            drawn: &self.drawn,
            nearness: &self.nearness,
            size_px: [self.width_px, self.height_px],
            lens: self.fisheye.as_ref(),
            shadows: self.shadows.as_deref(),
        });
    }

    /// Paints three bytes for each pixel.
    fn paint(&self, pixels: &mut [u8]) {
        self.paint_on(Colours(pixels));
        if let Some(drift) = &self.drift {
            drift.tint(self.processor, self.frame, pixels);
        }
        if let Some(noise) = &self.noise {
            noise.add(self.processor, self.frame, pixels, self.width_px * 3);
        }
    }

    /// Paints one byte for each pixel.
    fn paint_grey(&mut self, pixels: &mut [u8]) {
        let most = self.noise.as_ref().map_or(0, PixelNoise::most);
        if self.drift.is_some() || !self.looks.keep_within(most.max(1)) {
            // Noise is cut off at black and white channel by channel, and so is a drift.
            let mut colours = std::mem::take(&mut self.colours);
            colours.resize(pixels.len() * 3, 0);
            self.paint(&mut colours);
            luma::of_colours(self.processor, &colours, pixels);
            self.colours = colours;
            return;
        }
        let mut weights = std::mem::take(&mut self.weights);
        weights.resize(pixels.len(), 0);
        self.paint_on(Weights(&mut weights));
        match &self.noise {
            None => luma::of_weights(self.processor, &weights, pixels),
            Some(noise) => {
                let rows = weights.chunks_exact(self.width_px).zip(pixels.chunks_exact_mut(self.width_px));
                for (row, (weights, pixels)) in rows.enumerate() {
                    luma::of_noisy_weights(self.processor, weights, noise.of_row(self.frame, row), pixels);
                }
            }
        }
        self.weights = weights;
    }

    fn view(&self, world_from_robot: &Isometry3) -> CameraView {
        let turn = world_from_robot.rotation.to_rotation_matrix();
        let [place, right, down, forward] = self.mount.map(|vector| turn * vector);
        let position = world_from_robot.translation.vector + place;
        CameraView { pinhole: self.pinhole, position, right, down, forward }
    }

    /// Makes faces of the movers that may be in sight.
    fn place_movers(&mut self, moving: &[Solid], frustum: &Frustum) {
        let parts = self.scene.parts();
        self.moving.clear();
        self.looks.truncate(self.standing_looks);
        for solid in moving {
            let (min, max) = solid.bounds();
            let single = |point: Point3| [point.x as f32, point.y as f32, point.z as f32];
            if frustum.meets(&single(min), &single(max)) {
                self.moving.push(solid);
                let (shadows, middle) = (self.shadows.as_deref(), solid.centre.coords);
                let share = shadows.map_or(1.0, |shadows| shadows.seen_from(&middle, &self.scene, &self.surfaces));
                for face in self.moving.of_last() {
                    self.looks.push(&parts.materials[face.material], self.light.partly_on(&face.normal, share));
                }
            }
        }
    }

    /// Fills the spans with everything in sight.
    fn find_visible(&mut self, view: &CameraView, frustum: &Frustum) {
        self.spans.clear();
        self.drawn.clear();
        self.nearness.clear();
        for look in [SKY_FACE, FLOOR_FACE, OUTSIDE_LENS] {
            let look = look as usize;
            self.drawn.push(Drawn {
                look,
                plain: self.looks.get(look).is_plain(),
                coordinates: [Affine::default(); 2],
            });
            self.nearness.push(Affine::default());
        }
        if let Some(nearness) = view.nearness(&Vector3::z(), 0.0) {
            let origin = Vector3::zeros();
            self.nearness[FLOOR_FACE as usize] = nearness;
            self.drawn[FLOOR_FACE as usize].coordinates =
                [Vector3::x(), Vector3::y()].map(|axis| view.coordinate(&axis, &origin, nearness));
        }
        self.seen.clear();
        let seen = &mut self.seen;
        self.scene.visit(|min, max| frustum.meets(&min, &max), |solid| seen.push(solid));
        // The later of two solids in one plane is seen: paint lies over paint in the order of the world file.
        seen.sort_unstable();
        let first_look = OUTSIDE_LENS as usize + 1;
        let mut drawing = Drawing {
            view,
            looks: &self.looks,
            spans: &mut self.spans,
            drawn: &mut self.drawn,
            nearness: &mut self.nearness,
        };
        self.looked_at = self.moving.faces().len() as u64;
        for &solid in &self.seen {
            self.looked_at += self.surfaces.of_solid(solid).len() as u64;
            for face in self.surfaces.of_solid(solid) {
                drawing.face(&self.surfaces, &self.surfaces.faces()[face], first_look + face);
            }
        }
        for (index, face) in self.moving.faces().iter().enumerate() {
            drawing.face(&self.moving, face, self.standing_looks.looks + index);
        }
    }
}
