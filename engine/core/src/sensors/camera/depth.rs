//! The depth image: one over the distance ahead of the lens, of the face that each pixel shows. Nothing is painted for it.
//!
//! That nearness is affine over the image of a face, so that a run of a row is a first value and a step.

use super::Camera;
use crate::random::normal_table;
use crate::sensors::noise::{mixed, start};
use crate::sensors::stretches::{FLOOR_FACE, Sight};
use crate::settings::CameraSettings;
use dispatch::compiled_for_each_processor;
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

    /// Takes away the readings that are lost.
    fn pierce(&self, frame: u64, row: usize, pixels: &mut [u8]) {
        let reading = &self.row;
        let mut draws = mixed(mixed(self.seed ^ frame) ^ row as u64);
        for (column, pixel) in pixels.chunks_exact_mut(2).enumerate() {
            draws = mixed(draws);
            let left = reading[column.saturating_sub(EDGE_PX)];
            let right = reading[(column + EDGE_PX).min(reading.len() - 1)];
            let at_edge = (left - right).abs() > EDGE_SHARE * left.max(right);
            if (draws & 0xffff) < u64::from(self.holes[usize::from(at_edge)]) {
                pixel.fill(0);
            }
        }
    }
}

impl Camera {
    /// Measures two bytes for each pixel.
    pub(super) fn measure(&mut self, pixels: &mut [u8]) {
        let floor = self.nearness[FLOOR_FACE as usize];
        let sight = Sight { pinhole: self.pinhole, spans: &self.spans, floor };
        let unit = f64::from(NEARNESS_ONE);
        for (row, pixels) in pixels.chunks_exact_mut(2 * self.width_px).enumerate() {
            let nearness = &mut self.depth.row;
            let mut fill = |from: usize, to: usize, face: usize| {
                let affine = &self.nearness[face];
                let first = affine.at(from as f64 + 0.5, row as f64 + 0.5) * unit;
                ramp(self.processor, &mut nearness[from..to], first as f32, (affine.0[0] * unit) as f32);
            };
            let (floor_from, floor_to) = sight.floor_of(row);
            let mut from = 0;
            for run in self.spans.row(row).iter().map(Some).chain([None]) {
                let (start, end) = run.map_or((self.width_px, self.width_px), |run| (run.start.into(), run.end.into()));
                let (ground_from, ground_to) = (floor_from.clamp(from, start), floor_to.clamp(from, start));
                // Sky has no nearness: its face is 0 everywhere.
                for (from, to, face) in [(from, ground_from, 0), (ground_from, ground_to, 1), (ground_to, start, 0)] {
                    if from < to {
                        fill(from, to, face);
                    }
                }
                if let Some(run) = run {
                    fill(start, end, run.face as usize);
                }
                from = end;
            }
            let noise = &self.depth.noise[self.depth.noise.len().min(start(self.depth.seed, self.frame, row as u64))..];
            write_row(self.processor, &self.depth.row, noise, pixels);
            if self.depth.holes[0] > 0 {
                self.depth.pierce(self.frame, row, pixels);
            }
        }
    }
}

compiled_for_each_processor! {
    /// Values with a first one and a step.
    fn ramp<'a>(values: &'a mut [f32], first: f32, step: f32) {
        for (index, value) in (0_i32..).zip(values) {
            *value = first + step * index as f32;
        }
    }
}

compiled_for_each_processor! {
    /// Nearness with its noise, rounded; where there is some it is at least 1, and where there is none it stays 0.
    fn write_row<'a>(nearness: &'a [f32], noise: &'a [f32], pixels: &'a mut [u8]) {
        for ((nearness, noise), pixel) in nearness.iter().zip(noise).zip(pixels.as_chunks_mut::<2>().0) {
            let noisy = (nearness + noise + 0.5).clamp(1.0, 65_535.0);
            let seen = if *nearness > 0.0 { noisy } else { 0.0 };
            *pixel = (seen as i32 as u16).to_le_bytes();
        }
    }
}
