//! A certainty grid: what the laser found on the way, as a map of free, occupied and unknown cells.

use std::ops::ControlFlow;

use super::{Cycle, Observer, Step};
use crate::geometry::Pose;
use crate::robot::Robot;
use crate::settings::{LaserSettings, ScanFan};
use crate::world::Layout;

/// Edge of a cell, metres.
const CELL_M: f64 = 0.1;
/// Room around everything that stands in the world, metres.
const BORDER_M: f64 = 0.5;
/// The largest map, cells; a larger world is cut off.
const MOST_CELLS: usize = 1 << 20;
/// What a beam that ends in a cell, and one that passes through it, add to the cell's evidence.
const HIT: i16 = 3;
const PASS: i16 = -1;
/// Evidence is kept between this and its negative, so that a map can change its mind.
const MOST: i16 = 12;

/// Evidence for each cell, from scans at true poses.
#[derive(Debug, Clone, PartialEq)]
pub struct CertaintyGrid {
    evidence: Vec<i16>,
    columns: usize,
    rows: usize,
    origin_m: [f64; 2],
    laser: LaserSettings,
}

impl CertaintyGrid {
    /// An unknown world; `None` if the laser looks up or down, since its beams then end on the floor.
    #[must_use]
    pub fn new(layout: &Layout, laser: &LaserSettings) -> Option<Self> {
        if laser.tilt_deg != 0.0 {
            return None;
        }
        let corners = layout.scene.parts().solids.iter().flat_map(|solid| {
            let (min, max) = solid.bounds();
            [[min.x, min.y], [max.x, max.y]]
        });
        let (mut low, mut high) = ([f64::MAX; 2], [f64::MIN; 2]);
        for point in corners.chain(layout.starts.iter().map(|start| [start.pose.x_m, start.pose.y_m])) {
            for axis in 0..2 {
                low[axis] = low[axis].min(point[axis] - BORDER_M);
                high[axis] = high[axis].max(point[axis] + BORDER_M);
            }
        }
        Some(Self::sized(low, [high[0] - low[0], high[1] - low[1]], laser))
    }

    fn sized(origin_m: [f64; 2], size_m: [f64; 2], laser: &LaserSettings) -> Self {
        let columns = ((size_m[0] / CELL_M).ceil() as usize).clamp(1, 4096);
        let rows = ((size_m[1] / CELL_M).ceil() as usize).clamp(1, MOST_CELLS / columns);
        Self { evidence: vec![0; columns * rows], columns, rows, origin_m, laser: laser.clone() }
    }

    fn add(&mut self, robot: Pose, ranges_m: &[f32]) {
        let (sin, cos) = libm::sincos(robot.yaw_rad);
        let at = [robot.x_m + self.laser.forward_m * cos, robot.y_m + self.laser.forward_m * sin];
        let fan = ScanFan { beams: ranges_m.len(), ..self.laser.fan() };
        let first_rad = robot.yaw_rad - 0.5 * fan.view_deg.to_radians();
        for (beam, range_m) in ranges_m.iter().enumerate() {
            let yaw_rad = first_rad + beam as f64 * fan.apart_rad();
            self.add_beam(at, yaw_rad, f64::from(*range_m));
        }
    }

    fn add_beam(&mut self, at: [f64; 2], yaw_rad: f64, range_m: f64) {
        let (sin, cos) = libm::sincos(yaw_rad);
        let end = self.cell(at[0] + range_m * cos, at[1] + range_m * sin);
        let mut last = None;
        let pieces = (range_m / (0.5 * CELL_M)) as usize;
        for piece in 0..pieces {
            let along_m = piece as f64 * 0.5 * CELL_M;
            let cell = self.cell(at[0] + along_m * cos, at[1] + along_m * sin);
            if cell != last && cell != end {
                self.note(cell, PASS);
            }
            last = cell;
        }
        // The greatest range means that nothing was seen, the least that something is somewhere nearer.
        if range_m < self.laser.max_range_m - 0.05 && range_m > self.laser.min_range_m {
            self.note(end, HIT);
        }
    }

    fn note(&mut self, cell: Option<usize>, amount: i16) {
        if let Some(evidence) = cell.and_then(|cell| self.evidence.get_mut(cell)) {
            *evidence = (*evidence + amount).clamp(-MOST, MOST);
        }
    }

    fn cell(&self, x_m: f64, y_m: f64) -> Option<usize> {
        let column = ((x_m - self.origin_m[0]) / CELL_M).floor();
        let row = ((y_m - self.origin_m[1]) / CELL_M).floor();
        let inside = column >= 0.0 && row >= 0.0 && column < self.columns as f64 && row < self.rows as f64;
        inside.then(|| row as usize * self.columns + column as usize)
    }

    /// Grey levels, row 0 at the least y: white is free, black occupied, the middle unknown.
    #[must_use]
    pub fn greys(&self) -> Vec<u8> {
        self.evidence.iter().map(|evidence| (128 - 10 * *evidence).clamp(0, 255) as u8).collect()
    }

    /// Cells in a row.
    #[must_use]
    pub const fn columns(&self) -> usize {
        self.columns
    }

    /// Edge of a cell, metres.
    #[must_use]
    pub const fn cell_m(&self) -> f64 {
        CELL_M
    }

    /// The least x and y, metres.
    #[must_use]
    pub const fn origin_m(&self) -> [f64; 2] {
        self.origin_m
    }
}

/// Adds each scan in the home world at the robot's true pose.
impl<R: Robot> Observer<R> for CertaintyGrid {
    fn stepped(&mut self, cycle: &Cycle<R>, _: &Step) -> ControlFlow<()> {
        if let Some(here) = cycle.robot().whereabouts().filter(|_| cycle.robot().world_index() == 0) {
            self.add(here.pose, &cycle.observation().scan.ranges_m);
        }
        ControlFlow::Continue(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_beam_frees_its_way_and_marks_its_end() {
        let laser = LaserSettings { forward_m: 0.0, ..crate::settings::Settings::default().laser };
        let mut grid = CertaintyGrid::sized([0.0, 0.0], [2.0, 0.3], &laser);
        // Three beams: right and left see nothing, the middle one ends 1 m ahead.
        for _ in 0..12 {
            grid.add(Pose::new(0.05, 0.15, 0.0), &[8.192, 1.0, 8.192]);
        }
        let greys = grid.greys();
        let row = &greys[20..40];
        assert_eq!((row[0], row[5], row[9]), (248, 248, 248));
        assert_eq!(row[10], 8);
        assert_eq!((row[11], row[19]), (128, 128));
    }
}
