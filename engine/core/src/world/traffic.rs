//! Whatever moves in a world, as bodies touch it and as sensors see it: movers, and other bodies.

use super::movements::Movements;
use super::mover::Mover;
use super::obstacle::Obstacle;
use super::scene::Solid;
use super::stance::Stance;
use crate::geometry::Pose;
use crate::settings::BodyShape;

/// The solids of all movers and bodies at the present time.
#[derive(Debug, Clone)]
pub(super) struct Traffic {
    /// The bodies, the movers, and the bodies once more: so all but one body, whichever it is, are one slice.
    solids: Vec<Solid>,
    movers: Vec<Obstacle>,
    /// Empty for a body that is alone: nobody touches or sees it.
    bodies: Vec<Obstacle>,
}

impl Traffic {
    /// All movers at time 0, and the bodies where they are.
    pub(super) fn new(movers: &[Mover], movements: &Movements, bodies: Vec<Solid>) -> Self {
        let bodies = if bodies.len() > 1 { bodies } else { Vec::new() };
        let moving = || movers.iter().flat_map(|mover| mover.solids.iter().cloned());
        let mut traffic = Self {
            movers: moving().map(|solid| Obstacle::new(&solid)).collect(),
            solids: bodies.iter().cloned().chain(moving()).chain(bodies.iter().cloned()).collect(),
            bodies: bodies.iter().map(Obstacle::new).collect(),
        };
        traffic.arrange(movers, movements);
        traffic
    }

    /// Puts the movers where they are; they must be those that it was made with.
    pub(super) fn arrange(&mut self, movers: &[Mover], movements: &Movements) {
        let (first, count) = (self.bodies.len(), self.movers.len());
        let mut places = &mut self.solids[first..first + count];
        for (mover, pose) in movers.iter().zip(movements.poses()) {
            places = mover.arrange(pose, places);
        }
        for (solid, obstacle) in self.solids[first..].iter().zip(&mut self.movers) {
            *obstacle = Obstacle::new(solid);
        }
    }

    /// Whether a body has others beside it, which must then be told where it is.
    pub(super) fn has_bodies(&self) -> bool {
        !self.bodies.is_empty()
    }

    /// Puts a body where it is now.
    pub(super) fn put(&mut self, body: usize, solid: Solid) {
        let again = body + self.bodies.len() + self.movers.len();
        if let Some(obstacle) = self.bodies.get_mut(body) {
            *obstacle = Obstacle::new(&solid);
            self.solids[again] = solid.clone();
            self.solids[body] = solid;
        }
    }

    /// Least distance from a solid to a mover's solids on the floor plan, metres.
    pub(super) fn gap_m(&self, from: &Solid, movers: &[Mover], mover: usize) -> Option<f64> {
        let first: usize = movers.get(..mover)?.iter().map(|before| before.solids.len()).sum();
        let own = self.movers.get(first..first + movers.get(mover)?.solids.len())?;
        let from = Obstacle::new(from);
        own.iter().map(|obstacle| from.gap_m(obstacle)).reduce(f64::min)
    }

    pub(super) fn has_movers(&self) -> bool {
        !self.movers.is_empty()
    }

    /// The solids of the movers.
    pub(super) fn movers(&self) -> &[Solid] {
        let first = self.bodies.len();
        &self.solids[first..first + self.movers.len()]
    }

    /// All solids but those of one body: the bodies after it, the movers, the bodies before it.
    pub(super) fn seen_by(&self, body: usize) -> &[Solid] {
        let first = if self.has_bodies() { body + 1 } else { 0 };
        &self.solids[first..first + self.movers.len() + self.bodies.len().saturating_sub(1)]
    }

    /// The other bodies that come within `reach_m` of a place, with their indices.
    pub(super) fn others(&self, body: usize, pose: Pose, reach_m: f64) -> impl Iterator<Item = (usize, &Obstacle)> {
        let others = self.bodies.iter().enumerate().filter(move |(index, _)| *index != body);
        others.filter(move |(_, obstacle)| obstacle.is_within(pose.x_m, pose.y_m, reach_m))
    }

    /// Another body by its index.
    pub(super) fn body(&self, index: usize) -> &Obstacle {
        &self.bodies[index]
    }

    /// Whether a mover overlaps a body in this stance.
    pub(super) fn touches(&self, shape: &BodyShape, stance: &Stance) -> bool {
        self.movers.iter().any(|obstacle| obstacle.touches(shape, stance))
    }
}
