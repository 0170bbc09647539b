//! The paper's recovery function: after a failure, back to a safe pose.

use crate::diagnostic::{Diagnostic, Kind, Result};
use crate::geometry::{Point2, Pose};
use crate::random::{Random, Stream};
use crate::settings::RecoverySettings;
use crate::world::World;

/// How often a shifted pose is drawn before the unshifted ones are tried.
const DRAWS: usize = 50;
/// Distance of the unshifted poses that are tried last, metres.
const SPACING_M: f64 = 0.5;

/// Draws safe poses.
#[derive(Debug, Clone)]
pub struct Recovery {
    settings: RecoverySettings,
    random: Random,
}

impl Recovery {
    /// Recovery under a run's seed.
    #[must_use]
    pub fn new(settings: &RecoverySettings, seed: u64) -> Self {
        Self { settings: settings.clone(), random: Random::new(seed, Stream::Recovery) }
    }

    /// A safe pose: on the route nearest to the robot, anywhere on the route, or at a start, shifted at random.
    ///
    /// # Errors
    /// If no pose on the route or at a start is free and has ground under it.
    pub fn pose(&mut self, world: &World) -> Result<Pose> {
        for _ in 0..DRAWS {
            let base = self.base(world);
            let pose = self.shifted(base);
            if world.is_safe(pose) {
                return Ok(pose);
            }
        }
        let mut fallback = world.layout().starts.clone();
        if let Some(route) = world.layout().lap.map(|index| &world.layout().routes[index]) {
            let count = (route.length_m() / SPACING_M) as usize;
            fallback.extend((0..count).map(|index| route.pose_at(index as f64 * SPACING_M)));
        }
        fallback.into_iter().find(|pose| world.is_safe(*pose)).ok_or_else(|| {
            let message = format!(
                "the robot cannot recover: every start and route pose of world '{}' is blocked",
                world.layout().name
            );
            Box::new(
                Diagnostic::new(Kind::Input, "E-RECOVERY-BLOCKED", message)
                    .help("move the starts or the route away from walls, boxes and edges"),
            )
        })
    }

    fn base(&mut self, world: &World) -> Pose {
        let layout = world.layout();
        match (layout.lap.map(|index| &layout.routes[index]), self.settings.to.as_str()) {
            (Some(route), "nearest") => {
                let pose = world.body().pose;
                route.pose_at(route.nearest(Point2::new(pose.x_m, pose.y_m)).0)
            }
            (Some(route), "random") => route.pose_at(self.random.between(0.0, route.length_m())),
            // Without a route there are only the starts.
            _ => layout.starts[self.random.below(layout.starts.len() as u32) as usize],
        }
    }

    fn shifted(&mut self, pose: Pose) -> Pose {
        let (shift, turn) = (self.settings.position_m, self.settings.yaw_deg.to_radians());
        Pose::new(
            pose.x_m + self.random.between(-shift, shift),
            pose.y_m + self.random.between(-shift, shift),
            pose.yaw_rad + self.random.between(-turn, turn),
        )
    }
}
