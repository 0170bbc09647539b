//! The depth image: one over the distance ahead of the lens, of the face that each pixel shows. Nothing is painted for it.
//!
//! That nearness is affine over the image of a face, so that a run of a row is a first value and a step.

use super::Camera;
use crate::random::normal_table;
use crate::sensors::noise::{mixed, start};
use crate::sensors::stretches::{FLOOR_FACE, SKY_FACE, Sight};
use crate::sensors::view::Affine;
use crate::settings::CameraSettings;
use dispatch::Work;
use filter_api::NEARNESS_ONE;

/// The noise of depth is not that of colours.
const SEED_APART: u64 = 0x9e37_79b9_7f4a_7c15;
/// Beside an edge, where the two eyes of a depth camera do not see the same, so many times as many holes.
const HOLES_AT_EDGES: f64 = 10.0;
/// Pixels that count as beside an edge, to either side of it.
const EDGE_PX: usize = 2;
/// An edge: nearness that jumps by so much of the greater one.
const EDGE_SHARE: f32 = 0.1;

/// What a depth camera does to what is there.
#[derive(Debug, Clone)]
pub(super) struct DepthSensor {
    seed: u64,
    /// Draws of noise in 1/[`NEARNESS_ONE`] 1/m; all 0 without noise, none of a camera that measures no depth.
    noise: Vec<f32>,
    /// Probabilities in 1/65536 that a pixel has no reading: anywhere, and beside an edge.
    holes: [u32; 2],
    /// Nearness of one row in 1/[`NEARNESS_ONE`] 1/m.
    row: Vec<f32>,
}

impl DepthSensor {
    pub(super) fn new(settings: &CameraSettings, seed: u64) -> Self {
        let deviation = (settings.depth_noise * f64::from(NEARNESS_ONE)) as f32;
        let noise =
            if settings.depth { normal_table().iter().map(|draw| draw * deviation).collect() } else { Vec::new() };
        let share = |share: f64| (share.min(1.0) * 65_536.0).round() as u32;
        let holes = [share(settings.depth_holes), share(settings.depth_holes * HOLES_AT_EDGES)];
        Self { seed: seed ^ SEED_APART, noise, holes, row: vec![0.0; settings.width_px as usize] }
    }

    /// Takes away the readings of a row that are lost.
    fn pierce(&self, frame: u64, row: usize, reading: &[f32], pixels: &mut [u8]) {
        let mut draws = mixed(mixed(self.seed ^ frame) ^ row as u64);
        for (column, pixel) in pixels.as_chunks_mut::<2>().0.iter_mut().enumerate() {
            draws = mixed(draws);
            let left = reading[column.saturating_sub(EDGE_PX)];
            let right = reading[(column + EDGE_PX).min(reading.len() - 1)];
            let at_edge = (left - right).abs() > EDGE_SHARE * left.max(right);
            if (draws & 0xffff) < u64::from(self.holes[usize::from(at_edge)]) {
                *pixel = [0; 2];
            }
        }
    }
}

impl Camera {
    /// Measures two bytes for each pixel.
    pub(super) fn measure(&mut self, pixels: &mut [u8]) {
        let mut row = std::mem::take(&mut self.depth.row);
        let floor = self.nearness[FLOOR_FACE as usize];
        let sight = Sight { pinhole: self.pinhole, spans: &self.spans, floor };
        let (sensor, frame) = (&self.depth, self.frame);
        let measuring = Measuring { sight, nearness: &self.nearness, sensor, frame, row: &mut row, pixels };
        self.processor.run(measuring);
        self.depth.row = row;
    }
}

/// A frame to measure. All of it is one piece of work, so that all of it is compiled for each processor.
struct Measuring<'a> {
    sight: Sight<'a>,
    /// By drawn face.
    nearness: &'a [Affine],
    sensor: &'a DepthSensor,
    frame: u64,
    row: &'a mut [f32],
    pixels: &'a mut [u8],
}

impl Work for Measuring<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { sight, nearness, sensor, frame, row: reading, pixels } = self;
        for (row, pixels) in pixels.chunks_exact_mut(2 * reading.len()).enumerate() {
            read_row(&sight, nearness, row, reading);
            let first = start(sensor.seed, frame, row as u64).min(sensor.noise.len());
            write_row(reading, &sensor.noise[first..], pixels);
            if sensor.holes[0] > 0 {
                sensor.pierce(frame, row, reading, pixels);
            }
        }
    }
}

/// The nearness that a row shows.
#[inline(always)]
fn read_row(sight: &Sight<'_>, nearness: &[Affine], row: usize, reading: &mut [f32]) {
    let width = reading.len();
    let mut ramp = |from: usize, to: usize, face: u32| {
        if from < to {
            let Affine([step, ..]) = nearness[face as usize];
            let first = nearness[face as usize].at(from as f64 + 0.5, row as f64 + 0.5);
            let [first, step] = [first, step].map(|value| (value * f64::from(NEARNESS_ONE)) as f32);
            for (index, value) in reading[from..to].iter_mut().enumerate() {
                *value = first + step * index as i32 as f32;
            }
        }
    };
    let (floor_from, floor_to) = sight.floor_of(row);
    let mut from = 0;
    for run in sight.spans.row(row).iter().map(Some).chain([None]) {
        let (start, end) = run.map_or((width, width), |run| (run.start.into(), run.end.into()));
        let (ground_from, ground_to) = (floor_from.clamp(from, start), floor_to.clamp(from, start));
        // Sky has no nearness: its face is 0 everywhere.
        ramp(from, ground_from, SKY_FACE);
        ramp(ground_from, ground_to, FLOOR_FACE);
        ramp(ground_to, start, SKY_FACE);
        if let Some(run) = run {
            ramp(start, end, run.face);
        }
        from = end;
    }
}

/// Adds noise to nearness and rounds it; where there is some it is at least 1, and where there is none it stays 0.
#[inline(always)]
fn write_row(reading: &[f32], noise: &[f32], pixels: &mut [u8]) {
    let pixels = pixels.as_chunks_mut::<2>().0;
    // Slices of one known length let the compiler drop the bounds checks and use vectors.
    let count = reading.len().min(noise.len()).min(pixels.len());
    let (reading, noise, pixels) = (&reading[..count], &noise[..count], &mut pixels[..count]);
    for index in 0..count {
        let noisy = reading[index] + noise[index];
        let least = if noisy > 1.0 { noisy } else { 1.0 };
        let most = if least < 65_535.0 { least } else { 65_535.0 };
        // With 2^23 added the nearest whole number stands in the low bits.
        let whole = (most + 8_388_608.0).to_bits() as u16;
        pixels[index] = if reading[index] > 0.0 { whole } else { 0 }.to_le_bytes();
    }
}
