//! The paper's recovery function: after a failure, back to a safe pose.

use crate::diagnostic::{Diagnostic, Result};
use crate::geometry::{Point2, Pose};
use crate::outcome::{Destination, pass_destination};
use crate::random::{Random, Stream};
use crate::saved::{Passed, Passing, Unfit};
use crate::settings::{RecoverTo, RecoverySettings, Settings};
use crate::world::{Layout, Route, World};

use super::starts_in_use::StartsInUse;

/// How often a shifted pose is drawn before the unshifted ones are tried.
const DRAWS: usize = 50;
/// Distance of the unshifted poses that are tried last, metres.
const SPACING_M: f64 = 0.5;

/// Where a robot is put.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Put {
    pub(super) pose: Pose,
    /// Index of the start that this is, if it is one.
    pub(super) start: Option<usize>,
}

/// Draws safe poses.
#[derive(Debug, Clone)]
pub(super) struct Recovery {
    settings: RecoverySettings,
    usual: Destination,
    starts: StartsInUse,
    random: Random,
    /// Added to every start or place: metres to its left, and a turn to the left.
    shift_m: f64,
    turn_rad: f64,
}

impl Recovery {
    /// Recovery in a world, under a run's seed.
    #[must_use]
    pub(super) fn new(settings: &Settings, layout: &Layout, seed: u64) -> Self {
        let Settings { recovery, starts, .. } = settings;
        let number = |name: &String| layout.starts.iter().position(|start| start.name == *name);
        let named = recovery.at.as_ref().filter(|_| recovery.to == RecoverTo::Start).and_then(number);
        let listed: Vec<usize> = starts.names.iter().filter_map(number).collect();
        // A list without any start of this world is a mistake of its own, and has been told.
        let listed = if listed.is_empty() { (0..layout.starts.len()).collect() } else { listed };
        Self {
            settings: recovery.clone(),
            usual: named.map_or(Destination::Word(recovery.to), Destination::Start),
            starts: StartsInUse::new(listed, starts.widen),
            random: Random::new(seed, Stream::Recovery),
            shift_m: 0.0,
            turn_rad: 0.0,
        }
    }

    /// Puts the robot where other settings say, so far to the left of it and turned so far to the left.
    pub(super) fn change(&mut self, settings: &Settings, shift_m: f64, yaw_deg: f64) {
        let RecoverySettings { to, distance_m, position_m, yaw_deg: most_deg, .. } = settings.recovery;
        if to != self.settings.to {
            self.usual = Destination::Word(to);
        }
        (self.settings.to, self.settings.distance_m) = (to, distance_m);
        (self.settings.position_m, self.settings.yaw_deg) = (position_m, most_deg);
        (self.shift_m, self.turn_rad) = (shift_m, yaw_deg.to_radians());
    }

    /// The robot comes from another world: as many starts are in use as there.
    pub(super) fn go_on_from(&mut self, other: &Self) {
        self.starts.go_on_from(&other.starts);
    }

    /// What settings do not say.
    pub(super) fn pass(&mut self, by: &mut Passing<'_>) -> Passed {
        by.random(&mut self.random)?;
        let mut usual = Some(self.usual);
        pass_destination(by, &mut usual)?;
        self.usual = usual.ok_or(Unfit)?;
        self.starts.pass(by)
    }

    /// Whether the usual place is the nearest one on the lap route.
    pub(super) fn is_nearest(&self) -> bool {
        self.usual == Destination::Word(RecoverTo::Nearest)
    }

    /// Counts an attempt that has ended, by the start where it began.
    pub(super) fn count(&mut self, start: Option<usize>, good: bool) {
        self.starts.count(start, good);
    }

    /// How many of the listed starts are in use.
    pub(super) fn starts_in_use(&self) -> usize {
        self.starts.in_use().len()
    }

    /// A safe pose, shifted at random: at a place that is asked for, else where recovery usually puts the robot.
    ///
    /// # Errors
    /// `E-RECOVERY-ROUTE` or `E-RECOVERY-MOVER` if the world has no lap route or no mover to recover to;
    /// `E-RECOVERY-BLOCKED` if every pose that may be used is blocked or has no ground under it.
    pub(super) fn pose(&mut self, world: &World, to: Option<Destination>) -> Result<Put> {
        let to = to.unwrap_or(self.usual);
        for _ in 0..DRAWS {
            let Put { pose, start } = self.base(world, to)?;
            let pose = self.shifted(pose);
            if world.is_safe(0, pose) {
                return Ok(Put { pose, start });
            }
        }
        let (layout, safe) = (world.layout(), |put: &Put| world.is_safe(0, put.pose));
        let found = match to {
            Destination::Word(RecoverTo::Behind) => self.farther_behind(world).map(anywhere).find(safe),
            _ => {
                let wanted = if let Destination::Start(start) = to { Some(start) } else { None };
                let listed = self.starts.in_use().iter().copied();
                let starts = wanted.into_iter().chain(listed).chain(0..layout.starts.len());
                let starts = starts.map(|start| at_start(layout, start));
                starts.chain(lap(layout).into_iter().flat_map(along).map(anywhere)).find(safe)
            }
        };
        found.ok_or_else(|| blocked(world, to))
    }

    fn base(&mut self, world: &World, to: Destination) -> Result<Put> {
        let layout = world.layout();
        let word = match to {
            Destination::Start(start) => return Ok(at_start(layout, start)),
            Destination::Word(word) => word,
        };
        match word {
            RecoverTo::Nearest => {
                let pose = world.body(0).pose;
                let route = lap(layout).ok_or_else(|| no_route(layout, word))?;
                Ok(anywhere(route.pose_at(route.nearest(Point2::new(pose.x_m, pose.y_m)).0)))
            }
            RecoverTo::Random => {
                let route = lap(layout).ok_or_else(|| no_route(layout, word))?;
                Ok(anywhere(route.pose_at(self.random.between(0.0, route.length_m()))))
            }
            RecoverTo::Behind => self.farther_behind(world).next().map(anywhere).ok_or_else(|| no_mover(layout)),
            RecoverTo::Start => {
                let starts = self.starts.in_use();
                Ok(at_start(layout, starts[self.random.below(starts.len() as u32) as usize]))
            }
        }
    }

    /// The wanted place behind the first mover, then places still farther behind, for one lap or to the route's
    /// beginning; the wanted place itself is there in any case.
    fn farther_behind<'a>(&self, world: &'a World) -> impl Iterator<Item = Pose> + use<'a> {
        let distance_m = self.settings.distance_m;
        world.prey_route().into_iter().flat_map(move |(route, along_m, back)| {
            let room_m = match back {
                _ if route.closed => route.length_m(),
                true => route.length_m() - along_m,
                false => along_m,
            };
            let count = ((room_m - distance_m).max(0.0) / SPACING_M) as usize;
            (0..=count).map(move |index| match index as f64 * SPACING_M {
                farther_m if back => turned(route.pose_at(along_m + distance_m + farther_m)),
                farther_m => route.pose_at(along_m - distance_m - farther_m),
            })
        })
    }

    /// A place with what is added to every place.
    fn displaced(&self, pose: Pose) -> Pose {
        if self.shift_m == 0.0 && self.turn_rad == 0.0 {
            return pose;
        }
        let (sin, cos) = libm::sincos(pose.yaw_rad);
        Pose::new(pose.x_m - self.shift_m * sin, pose.y_m + self.shift_m * cos, pose.yaw_rad + self.turn_rad)
    }

    fn shifted(&mut self, pose: Pose) -> Pose {
        let (shift, turn) = (self.settings.position_m, self.settings.yaw_deg.to_radians());
        let pose = self.displaced(pose);
        Pose::new(
            pose.x_m + self.random.between(-shift, shift),
            pose.y_m + self.random.between(-shift, shift),
            pose.yaw_rad + self.random.between(-turn, turn),
        )
    }
}

fn no_route(layout: &Layout, to: RecoverTo) -> Box<Diagnostic> {
    let to = to.word();
    let message = format!("recovery(\"{to}\") needs the route 'lap', and the world '{}' has none", layout.name);
    ends(layout, "E-RECOVERY-ROUTE", message)
        .help(
            "add a closed [[route]] with name = \"lap\" to the world, or write recovery(\"start\") in the script \
         (or --set recovery.to=start)",
        )
        .into()
}

fn blocked(world: &World, to: Destination) -> Box<Diagnostic> {
    let name = &world.layout().name;
    let (places, help) = if to == Destination::Word(RecoverTo::Behind) {
        ("place behind the first mover", "give the mover a longer route, or keep the route clear of solids and edges")
    } else {
        ("start and route pose", "move the starts or the route away from walls, boxes and edges")
    };
    let message = format!("the robot cannot recover: every {places} of world '{name}' is blocked");
    Box::new(Diagnostic::new("E-RECOVERY-BLOCKED", message).help(help))
}

fn anywhere(pose: Pose) -> Put {
    Put { pose, start: None }
}

fn at_start(layout: &Layout, start: usize) -> Put {
    Put { pose: layout.starts[start].pose, start: Some(start) }
}

/// A pose turned about by 180 degrees where it stands.
fn turned(pose: Pose) -> Pose {
    Pose::new(pose.x_m, pose.y_m, pose.yaw_rad + std::f64::consts::PI)
}

fn lap(layout: &Layout) -> Option<&Route> {
    layout.lap.map(|index| &layout.routes[index])
}

fn along(route: &Route) -> impl Iterator<Item = Pose> {
    let count = (route.length_m() / SPACING_M) as usize;
    (0..count).map(|index| route.pose_at(index as f64 * SPACING_M))
}

fn no_mover(layout: &Layout) -> Box<Diagnostic> {
    let message = format!("recovery(\"behind\") needs a mover, and the world '{}' has none", layout.name);
    ends(layout, "E-RECOVERY-MOVER", message)
        .help("add a [[mover]] and its [[route]] to the world, or write recovery(\"start\") in the script")
        .into()
}

/// An error about something that a world file does not have.
fn ends(layout: &Layout, code: &'static str, message: String) -> Diagnostic {
    let end = layout.source.text.len();
    Diagnostic::new(code, message).at(&layout.source, end..end, "the file ends here")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostic::SourceText;
    use crate::settings::Settings;
    use std::f64::consts::FRAC_PI_2;
    use std::sync::Arc;

    const CORNER: &str = "[[route]]\nname = \"way\"\npoints_m = [[0, 0], [4, 0], [4, 4]]\n\
                          [[start]]\nposition_m = [0, 3]\n";
    const MOVER: &str = "[[mover]]\nname = \"prey\"\nroute = \"way\"\nspeed_m_per_s = 1\noffset_m = 2\n\
                         boxes = [{ centre_m = [0, 0, 0.3], size_m = [0.4, 0.4, 0.4] }]\n";

    fn world(text: &str) -> World {
        let robot = Settings::default().robot;
        let layout = Layout::parse(SourceText::new("test.toml", text), &robot.body);
        World::new(Arc::new(layout.unwrap_or_else(|error| panic!("{error:?}"))), &[robot], 0.5, 1)
    }

    /// Where recovery puts the robot, to the millimetre.
    fn exact(to: RecoverTo, world: &World) -> Result<Pose> {
        let recovery = RecoverySettings { to, at: None, distance_m: 1.1, position_m: 0.0, yaw_deg: 0.0 };
        let settings = Settings { recovery, ..Settings::default() };
        Recovery::new(&settings, world.layout(), 1).pose(world, None).map(|put| put.pose)
    }

    fn is_near(pose: Pose, x_m: f64, y_m: f64, yaw_rad: f64) -> bool {
        pose.distance_m(Pose::new(x_m, y_m, 0.0)) < 1e-9 && (pose.yaw_rad - yaw_rad).abs() < 1e-9
    }

    #[test]
    fn behind_a_mover_is_a_place_on_its_route_that_looks_along_it() {
        let mut world = world(&format!("{CORNER}{MOVER}"));
        assert!(is_near(exact(RecoverTo::Behind, &world).unwrap(), 0.9, 0.0, 0.0));
        for _ in 0..7 {
            world.advance(&[]);
        }
        // 2 + 3.5 m along: 1.5 m past the corner; 1.1 m less is on the second side too.
        assert!(is_near(exact(RecoverTo::Behind, &world).unwrap(), 4.0, 0.4, FRAC_PI_2));
    }

    #[test]
    fn a_mover_that_stands_at_the_end_of_its_route_is_followed_there() {
        let mut world = world(&format!("{CORNER}{MOVER}"));
        for _ in 0..100 {
            world.advance(&[]);
        }
        assert!(is_near(exact(RecoverTo::Behind, &world).unwrap(), 4.0, 2.9, FRAC_PI_2));
    }

    #[test]
    fn a_place_behind_that_is_blocked_gives_way_to_one_farther_behind() {
        let wall = "[[wall]]\npoints_m = [[1, -1], [1, 1]]\n";
        let world = world(&format!("{CORNER}{}{wall}", MOVER.replace("= 2", "= 3")));
        // 1.9 m along is free; 0.25 m of half length ahead of the wall it would be at 1.3 m at least.
        assert!(is_near(exact(RecoverTo::Behind, &world).unwrap(), 1.9, 0.0, 0.0));
        let world = self::world(&format!("{CORNER}{MOVER}{}", wall.replace("[1, ", "[0.9, ")));
        assert!(is_near(exact(RecoverTo::Behind, &world).unwrap(), 0.4, 0.0, 0.0));
    }

    #[test]
    fn a_world_without_what_recovery_needs_is_an_error_that_names_it() {
        let bare = world(CORNER);
        assert_eq!(exact(RecoverTo::Behind, &bare).unwrap_err().code, "E-RECOVERY-MOVER");
        for to in [RecoverTo::Nearest, RecoverTo::Random] {
            let error = exact(to, &bare).unwrap_err();
            assert_eq!(error.code, "E-RECOVERY-ROUTE");
            let help = error.help.unwrap();
            assert!(help.contains("name = \"lap\"") && help.contains("recovery(\"start\")"), "{help}");
        }
        assert!(is_near(exact(RecoverTo::Start, &bare).unwrap(), 0.0, 3.0, 0.0));
    }
}
