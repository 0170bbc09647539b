//! The truth of a run: what stands, what moves, and what the bodies of robots do among it.
//!
//! [`Layout`] is a world file, read once; [`World`] is the state of the bodies in it. Sensors look at it through
//! [`World::layout`], [`World::seen_by`] and [`World::body`]; rewards and states never do.

mod body;
mod contact;
mod drivetrain;
mod families;
mod floor_squares;
mod layout;
mod light;
pub(crate) mod marks;
mod movements;
mod mover;
mod obstacle;
mod route;
mod route_progress;
pub mod scene;
mod schedule;
mod stance;
mod terrain;
#[cfg(test)]
mod tests;
mod traffic;
mod vehicle;
mod world_set;

pub use body::{Body, Motion};
pub use families::{FAMILIES, FamilyRange};
pub(crate) use floor_squares::FloorSquares;
pub use layout::Layout;
pub use marks::{Circle, Gate, Start};
pub use movements::Movements;
pub use mover::Mover;
pub use route::Route;
pub(crate) use route_progress::RouteProgress;
pub use world_set::WorldSet;

use crate::geometry::{Point2, Pose, Twist};
use crate::random::{Random, Stream};
use crate::saved::{Passed, Passing};
use crate::settings::RobotSettings;
use drivetrain::Drivetrain;
use scene::Solid;
use stance::Stance;
use std::sync::Arc;
use traffic::Traffic;
use vehicle::Vehicle;

/// The bodies of one or more robots in a world.
///
/// A body is named by its index in the list that the world was made with. Bodies stand in the way of each other, as
/// upright boxes and cylinders of the material `plain`.
///
/// In a control period the bodies drive one after another in the order of their indices, each through the whole period;
/// then the movers go on. So a body meets those of lower index where they have arrived, and those of higher index and
/// the movers where they stood when the period began: of two that make for one place the first gets it, and a body
/// close behind one of higher index runs into it although that drives on.
#[derive(Debug, Clone)]
pub struct World {
    layout: Arc<Layout>,
    vehicles: Vec<Vehicle>,
    motions: Vec<Motion>,
    traffic: Traffic,
    /// The material of bodies.
    material: usize,
    period_s: f64,
    periods: u64,
    movements: Movements,
}

impl World {
    /// Bodies at rest: the first at the first start, each further one at the first start that is safe for it, or at the
    /// first of all if none is. `period_s` is the time between two commands, seconds.
    ///
    /// The first body draws the same random numbers whether there are others or not.
    #[must_use]
    pub fn new(layout: Arc<Layout>, bodies: &[RobotSettings], period_s: f64, seed: u64) -> Self {
        let start = layout.starts.first().map_or(Pose::default(), |start| start.pose);
        let vehicle = |(index, robot): (u32, &RobotSettings)| {
            let drive = Drivetrain::new(robot, period_s, Random::of_body(seed, Stream::Drive, index));
            Vehicle::new(robot.body, drive, &layout, start, bodies.len().saturating_sub(1))
        };
        let vehicles: Vec<_> = (0..).zip(bodies).map(vehicle).collect();
        let material = layout.scene.parts().materials.iter().position(|material| material.name == layout::PLAIN);
        let material = material.unwrap_or(layout.scene.parts().floor);
        let solids = vehicles.iter().map(|vehicle| vehicle.solid(material)).collect();
        let movements = Movements::new(Arc::clone(&layout), seed, 1.0);
        let traffic = Traffic::new(&layout.movers, &movements, solids);
        let motions = vec![Motion::default(); vehicles.len()];
        let mut world = Self { layout, vehicles, motions, traffic, material, period_s, periods: 0, movements };
        for index in 1..world.vehicles.len() {
            let safe = world.layout.starts.iter().map(|start| start.pose).find(|start| world.is_safe(index, *start));
            safe.into_iter().for_each(|start| world.place(index, start));
        }
        world
    }

    /// This world with every mover `speed` times as fast as its file says.
    #[must_use]
    pub fn with_mover_speed(self, speed: f64) -> Self {
        Self { movements: self.movements.scaled(speed), ..self }
    }

    /// From here on the drive of a body is another one: it lags, slips and is noisy as these settings say. The body stays.
    ///
    /// # Panics
    /// If there is no such body.
    pub(crate) fn change_drive(&mut self, index: usize, robot: &RobotSettings) {
        self.vehicles[index].change_drive(robot, self.period_s);
    }

    /// From here on a mover is so many times as fast as its file says; of one that knows nothing but its speed the place
    /// becomes that at which it would be, had it always been so fast.
    pub(crate) fn set_mover_speed(&mut self, index: usize, speed: f64) {
        self.movements.set_scale(index, speed);
        self.traffic.arrange(&self.layout.movers, &self.movements);
    }

    /// Where bodies and movers are, and what they will draw.
    pub(crate) fn pass(&mut self, by: &mut Passing<'_>) -> Passed {
        by.all(&mut self.vehicles, |by, vehicle| vehicle.pass(by))?;
        by.whole(&mut self.periods)?;
        self.movements.pass(by)?;
        self.traffic.arrange(&self.layout.movers, &self.movements);
        (0..self.vehicles.len()).for_each(|index| self.show(index));
        Ok(())
    }

    /// An attempt begins: movers whose file says so draw their speed, or begin anew.
    pub fn begin_attempt(&mut self) {
        if self.movements.live() {
            self.movements.begin();
            self.traffic.arrange(&self.layout.movers, &self.movements);
        }
    }

    /// Puts a body at rest at `pose`, on the highest platform or ramp there or else on the floor.
    ///
    /// # Panics
    /// If there is no such body.
    pub fn place(&mut self, index: usize, pose: Pose) {
        self.vehicles[index].place(&self.layout, pose);
        self.show(index);
    }

    /// Drives for one control period, with a command for each body; a body without one is to stand. Returns what
    /// happened to each body.
    ///
    /// A body that touches something stops there and tries again in the next tick; one that has fallen lies still until
    /// it is placed. A thing that a body overlaps already does not hold it.
    pub fn advance(&mut self, commands: &[Twist]) -> &[Motion] {
        self.motions.fill(Motion::default());
        for index in 0..self.vehicles.len() {
            let command = commands.get(index).copied().unwrap_or_default();
            let vehicle = &mut self.vehicles[index];
            let motion = vehicle.advance(&self.layout, &self.traffic, index, command);
            self.motions[index] = Motion { contact: motion.contact | self.motions[index].contact, ..motion };
            for &struck in vehicle.struck() {
                self.motions[struck].contact = true;
            }
            self.show(index);
        }
        self.periods += 1;
        if self.traffic.has_movers() {
            let middle = |vehicle: &Vehicle| Point2::new(vehicle.stance().pose.x_m, vehicle.stance().pose.y_m);
            self.movements.advance(self.periods as f64 * self.period_s, self.vehicles.iter().map(middle));
            self.traffic.arrange(&self.layout.movers, &self.movements);
            for (motion, vehicle) in self.motions.iter_mut().zip(&self.vehicles) {
                motion.contact |= self.traffic.touches(vehicle.shape(), vehicle.stance());
            }
        }
        &self.motions
    }

    /// Lets the others know where a body is.
    fn show(&mut self, index: usize) {
        if self.traffic.has_bodies() {
            self.traffic.put(index, self.vehicles[index].solid(self.material));
        }
    }

    /// Where a body is.
    ///
    /// # Panics
    /// If there is no such body.
    #[must_use]
    pub fn body(&self, index: usize) -> Body {
        let Stance { pose, z_m, slope_x, slope_y, .. } = *self.vehicles[index].stance();
        if slope_x == 0.0 && slope_y == 0.0 {
            return Body { pose, z_m, pitch_rad: 0.0, roll_rad: 0.0 };
        }
        let pitch_rad = -libm::atan(slope_x);
        Body { pose, z_m, pitch_rad, roll_rad: libm::atan(slope_y * libm::cos(pitch_rad)) }
    }

    /// The movers' solids where they are now, in world coordinates, in the order of the file.
    #[must_use]
    pub fn moving(&self) -> &[Solid] {
        self.traffic.movers()
    }

    /// All that moves besides one body, for its sensors: the bodies of higher index, the movers, the bodies of lower
    /// index, where they are now. For a body that is alone that is [`World::moving`].
    ///
    /// # Panics
    /// If there are several bodies and not this one.
    #[must_use]
    pub fn seen_by(&self, index: usize) -> &[Solid] {
        self.traffic.seen_by(index)
    }

    /// The body with this index up to a height: upright, whatever slope it stands on.
    ///
    /// # Panics
    /// If there is no such body.
    #[must_use]
    pub(crate) fn solid_of(&self, index: usize, height_m: f64) -> Solid {
        self.vehicles[index].solid_up_to(height_m, self.material)
    }

    /// Where a mover is now.
    #[must_use]
    pub fn mover(&self, index: usize) -> Option<Pose> {
        (index < self.layout.movers.len()).then(|| self.movements.pose(index))
    }

    /// Where the first mover is now.
    #[must_use]
    pub fn prey(&self) -> Option<Pose> {
        self.mover(0)
    }

    /// Least distance between a body and the mover with this index, seen from above, metres: 0 where they touch. `None` if
    /// there is no such mover.
    ///
    /// # Panics
    /// If there is no such body.
    #[must_use]
    pub fn gap_m(&self, index: usize, mover: usize) -> Option<f64> {
        self.traffic.gap_m(&self.vehicles[index].solid(self.material), &self.layout.movers, mover)
    }

    /// The route of the first mover, how far along it the mover is now, metres, and whether it comes back along it.
    #[must_use]
    pub(crate) fn prey_route(&self) -> Option<(&Route, f64, bool)> {
        self.movements.first_on_route()
    }

    /// Time since the world began, seconds. Placing a body does not turn it back.
    #[must_use]
    pub fn time_s(&self) -> f64 {
        self.periods as f64 * self.period_s
    }

    /// Whether a body could be placed at `pose`: nothing touches it there, no mover and no other body either, and all of
    /// its footprint has ground below.
    ///
    /// # Panics
    /// If there is no such body.
    #[must_use]
    pub fn is_safe(&self, index: usize, pose: Pose) -> bool {
        let shape = self.vehicles[index].shape();
        let stance = self.layout.terrain().put(&self.layout.scene, shape, pose).stance;
        let mut others = self.traffic.others(index, pose, shape.radius_m());
        self.layout.obstruction(shape, pose).is_none()
            && !self.traffic.touches(shape, &stance)
            && !others.any(|(_, other)| other.touches(shape, &stance))
    }

    /// What the world was made from.
    #[must_use]
    pub fn layout(&self) -> &Layout {
        &self.layout
    }
}
