//! The one list of facts: scripts, checks, near names, the reference page and editors read it.

use super::compiled::Look;
use super::fact_columns::Beam::{Farthest, Front, Given, Left, Nearest, Right, Without as NoBeam, Worst};
use super::fact_columns::Getter::{Call, Flag, Hits, Number, Sector, ViewFlag, ViewNumber, ViewWhole, Whole};
use super::fact_columns::Reach::{
    Accident, Actions, Any, Beams, Between, Commanded, Laser, Measured, Seen, States, Steps,
};
use super::fact_columns::Unit::{
    Degrees, GreyLevels, HalfImages, Metres, MetresPerSecond, RadiansPerSecond, Seconds, Share, Without as NoUnit,
};
use super::fact_columns::{Beam, Getter, Reach, Unit};
use super::facts::{decimal, greatest, least, mean};
use super::ground_facts::{brightness, hue_deg, saturation};

/// One row of the list of facts.
#[derive(Debug, Clone, Copy)]
pub struct Fact {
    /// Which row it is.
    pub(crate) id: FactId,
    /// The group: `laser`; `sector` for what `laser.sector(from, to)` has.
    pub group: &'static str,
    /// The name within it: `nearest`; `[` for an index.
    pub(crate) key: &'static str,
    /// The unit.
    pub unit: Unit,
    /// Between which values it lies.
    pub reach: Reach,
    /// The beam that makes it what it is.
    pub(crate) beam: Beam,
    /// Reads it.
    pub(crate) get: Getter,
    /// One sentence: what it is.
    pub(crate) purpose: &'static str,
}

/// The groups of facts, with what each is about.
pub(crate) const GROUPS: &[(&str, &str)] = &[
    (
        "laser",
        "The ranges of the laser: beam 0 looks farthest to the right, the last beam to the left, the middle one ahead.",
    ),
    (
        "camera",
        "What the filters left of the camera's image; a named view has the same facts under its name: `red.seen`.",
    ),
    ("action", "The action that the learner has just carried out."),
    ("robot", "The bumper, the tilt switch and the wheel encoders."),
    ("state", "What the learner sees."),
    ("time", "Steps and seconds counted."),
    ("odometry", "What the wheels counted since the attempt began: it drifts, since slip and noise are in it."),
    ("ground", "The ground under three sensors with lamps of their own: paint and floor, without light or shadow."),
    ("stage", "What the robot is about, in a script with `stages`."),
    ("previous", "The facts of the step before: `previous.laser.front`, `previous.action.angular`."),
];

macro_rules! facts {
    ($($id:ident: $group:ident $key:literal, $unit:expr, $reach:expr, $beam:expr, $get:expr, $purpose:literal;)*) => {
        /// Which fact: its row in the list.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum FactId {
            $(#[doc = $purpose] $id,)*
        }

        /// Every fact, group by group.
        pub(crate) const FACTS: &[Fact] = &[$(Fact {
            id: FactId::$id,
            group: stringify!($group),
            key: $key,
            unit: $unit,
            reach: $reach,
            beam: $beam,
            get: $get,
            purpose: $purpose,
        }),*];
    };
}

facts! {
    LaserNearest: laser "nearest", Metres, Laser, Nearest, Number(|f| decimal(least(&f.ranges_m))), "The least range of all beams.";
    LaserFarthest: laser "farthest", Metres, Laser, Farthest, Number(|f| decimal(greatest(&f.ranges_m))), "The greatest range of all beams.";
    LaserRight: laser "right", Metres, Laser, Right, Number(|f| f.beam_m(f.beam_towards(-90.0))), "The range of the beam square to the right, at -90 degrees.";
    LaserFront: laser "front", Metres, Laser, Front, Number(|f| f.beam_m(f.beam_towards(0.0))), "The range of the middle beam, ahead; of two the lesser.";
    LaserLeft: laser "left", Metres, Laser, Left, Number(|f| f.beam_m(f.beam_towards(90.0))), "The range of the beam square to the left, at 90 degrees.";
    LaserNearestBeam: laser "nearest_beam", Unit::Beam, Beams, Nearest, Whole(|f| f.nearest_beam() as i64), "The number of the beam with the least range.";
    LaserBeams: laser "beams", Unit::Beams, Beams, NoBeam, Whole(|f| f.ranges_m.len() as i64), "How many beams there are.";
    LaserBeam: laser "[", Metres, Laser, Given, Call("laser[beam]", 1), "The range of one beam.";
    LaserSector: laser "sector", NoUnit, Any, NoBeam, Call("laser.sector(from, to)", 2), "The beams `from` to `to`, both included; compared with a number it means its nearest.";
    LaserAt: laser "at", Metres, Laser, Given, Call("laser.at(degrees)", 1), "The range of the beam nearest to this bearing, the right one of two; positive to the left.";
    LaserBetween: laser "between", NoUnit, Any, NoBeam, Call("laser.between(from, to)", 2), "The beams from one bearing to another, degrees, positive to the left: as `sector`.";
    LaserHit: laser "hit", NoUnit, Any, Given, Call("laser.hit(beam)", 1), "Whether that beam met anything nearer than the greatest range.";
    LaserHitAt: laser "hit_at", NoUnit, Any, Given, Call("laser.hit_at(degrees)", 1), "Whether the beam nearest to this bearing met anything nearer than the greatest range.";
    LaserMinRange: laser "min_range_m", Metres, Any, NoBeam, Number(|f| f.laser_range_m.0), "The least range that the laser can tell.";
    LaserMaxRange: laser "max_range_m", Metres, Any, NoBeam, Number(|f| f.laser_range_m.1), "The greatest range: what a beam reads that meets nothing.";
    SectorNearest: sector "nearest", Metres, Laser, Nearest, Sector(|r| decimal(least(r))), "The least range in the sector.";
    SectorFarthest: sector "farthest", Metres, Laser, Farthest, Sector(|r| decimal(greatest(r))), "The greatest range in the sector.";
    SectorMean: sector "mean", Metres, Laser, NoBeam, Sector(mean), "The mean range in the sector.";
    SectorCountBelow: sector "count_below", Unit::Beams, Beams, Nearest, Call("laser.sector(from, to).count_below(limit)", 1), "How many beams of the sector are nearer than `limit` metres.";
    SectorHits: sector "hits", Unit::Beams, Beams, NoBeam, Hits, "How many beams of the sector met anything nearer than the greatest range.";
    SectorExcess: sector "excess", Metres, Any, Worst, Call("laser.sector(from, to).excess(expected)", 1), "The greatest of range minus expected range; `expected` is an array with one number for each beam.";
    CameraSeen: camera "seen", NoUnit, Any, NoBeam, ViewFlag(|v| v.seen), "Whether any cell of the grid is occupied.";
    CameraCoverage: camera "coverage", Share, Between(0.0, 1.0), NoBeam, ViewNumber(|v| v.coverage), "The share of the image that the filter left.";
    CameraCell: camera "cell", Share, Between(0.0, 1.0), NoBeam, Call("camera.cell(row, column)", 2), "The share of one grid cell that the filter left; row 0 is the top, column 0 the left.";
    CameraRows: camera "rows", Share, Between(0.0, 1.0), NoBeam, Call("camera.rows(from, to)", 2), "The share that the filter left of these rows of the grid, both included.";
    CameraColumns: camera "columns", Share, Between(0.0, 1.0), NoBeam, Call("camera.columns(from, to)", 2), "The share that the filter left of these columns of the grid, both included.";
    CameraIndex: camera "index", Unit::State, Any, NoBeam, ViewWhole(|v| v.index as i64), "The number of this view's grid alone, from 0.";
    CameraSize: camera "size", Share, Between(0.0, 1.0), NoBeam, ViewNumber(|v| v.patch.size), "The largest patch that the filter left: its share of the image.";
    CameraBearing: camera "bearing_deg", Degrees, Seen(-180.0, 180.0, 180.0), NoBeam, ViewNumber(|v| v.patch.bearing_deg), "Where its centre lies, from straight ahead, positive to the left.";
    CameraElevation: camera "elevation_deg", Degrees, Seen(-90.0, 90.0, 90.0), NoBeam, ViewNumber(|v| v.patch.elevation_deg), "Where the centre of that patch lies above the horizon.";
    CameraOffset: camera "offset", HalfImages, Seen(-1.0, 1.0, 2.0), NoBeam, ViewNumber(|v| v.patch.offset), "Where its centre lies across the image: 1 at the left edge, 0 in the middle.";
    CameraLeft: camera "left_deg", Degrees, Seen(-180.0, 180.0, 180.0), NoBeam, ViewNumber(|v| v.patch.left_deg), "The bearing of its left edge, at the height of its centre.";
    CameraRight: camera "right_deg", Degrees, Seen(-180.0, 180.0, 180.0), NoBeam, ViewNumber(|v| v.patch.right_deg), "The bearing of its right edge.";
    CameraFloor: camera "floor_m", Metres, Seen(0.0, 100.0, 100.0), NoBeam, ViewNumber(|v| v.patch.floor_m), "The distance from the robot's centre to its lowest place, if that lies on flat floor.";
    CameraLineSeen: camera "line_seen", NoUnit, Any, NoBeam, ViewFlag(|v| v.line.seen), "Whether the patch shows a line on the floor, 0.1 to 3 metres ahead.";
    CameraLineOffset: camera "line_offset_m", Metres, Seen(-10.0, 10.0, 100.0), NoBeam, ViewNumber(|v| v.line.offset_m), "How far left of the robot's centre that line passes.";
    CameraLineHeading: camera "line_heading_deg", Degrees, Seen(-90.0, 90.0, 180.0), NoBeam, ViewNumber(|v| v.line.heading_deg), "Where that line leads, positive to the left.";
    ActionIndex: action "index", Unit::Action, Actions, NoBeam, Whole(|f| f.action as i64), "Its number in the list of actions, from 0.";
    ActionLinear: action "linear", MetresPerSecond, Commanded, NoBeam, Number(|f| f.action_linear_m_per_s), "The forward speed that was commanded.";
    ActionAngular: action "angular", RadiansPerSecond, Commanded, NoBeam, Number(|f| f.action_angular_rad_per_s), "The turning speed that was commanded, positive to the left.";
    RobotContact: robot "contact", NoUnit, Accident, NoBeam, Flag(|f| f.contact), "Whether the body touched something in this step.";
    RobotFallen: robot "fallen", NoUnit, Accident, NoBeam, Flag(|f| f.fallen), "Whether the robot has lost its footing.";
    RobotLinear: robot "linear", MetresPerSecond, Measured, NoBeam, Number(|f| f.linear_m_per_s), "The forward speed that the wheels measured.";
    RobotAngular: robot "angular", RadiansPerSecond, Measured, NoBeam, Number(|f| f.angular_rad_per_s), "The turning speed that the wheels measured, positive to the left.";
    StateIndex: state "index", Unit::State, States, NoBeam, Whole(|f| f.state as i64), "The state that the grid was coded into, from 0.";
    TimeStep: time "step", Unit::Steps, Steps, NoBeam, Whole(|f| whole(f.step)), "Steps since learning or the test began.";
    TimeSinceRecovery: time "since_recovery", Unit::Steps, Steps, NoBeam, Whole(|f| whole(f.since_recovery)), "Steps since the last recovery or the start.";
    TimeAttempt: time "attempt_s", Seconds, Steps, NoBeam, Number(|f| f.attempt_s), "Time since the last recovery or the start.";
    OdometryDistance: odometry "distance_m", Metres, Steps, NoBeam, Number(|f| f.odometry.distance_m), "Way counted by the wheels, backward too.";
    OdometryForward: odometry "forward_m", Metres, Any, NoBeam, Number(|f| f.odometry.forward_m), "Way counted by the wheels, backward subtracted.";
    OdometryTurned: odometry "turned_deg", Degrees, Any, NoBeam, Number(|f| f.odometry.turned_rad.to_degrees()), "Turn counted by the wheels, positive to the left, not wrapped.";
    OdometryAway: odometry "away_m", Metres, Steps, NoBeam, Number(|f| f.odometry.away_m()), "Straight distance to where the attempt began, by dead reckoning.";
    OdometryBearing: odometry "bearing_deg", Degrees, Between(-180.0, 180.0), NoBeam, Number(|f| f.odometry.bearing_deg()), "The bearing of that place, positive to the left.";
    GroundBrightness: ground "brightness", GreyLevels, Between(0.0, 255.0), NoBeam, Number(|f| brightness(f.ground[0])), "How bright the ground is under the middle; 0 off the ground.";
    GroundLeft: ground "left", GreyLevels, Between(0.0, 255.0), NoBeam, Number(|f| brightness(f.ground[1])), "How bright the ground is `ground.aside_m` to the left of the middle.";
    GroundRight: ground "right", GreyLevels, Between(0.0, 255.0), NoBeam, Number(|f| brightness(f.ground[2])), "How bright the ground is as far to the right of the middle.";
    GroundHue: ground "hue_deg", Degrees, Between(0.0, 360.0), NoBeam, Number(|f| hue_deg(f.ground[0])), "Its hue under the middle: red 0, green 120; 0 of grey. Filter `colour` counts it in steps of 0.234 degrees from the nearest of red, green and blue, and drops what is less.";
    GroundSaturation: ground "saturation", Share, Between(0.0, 1.0), NoBeam, Number(|f| saturation(f.ground[0])), "Its saturation under the middle, as filter `colour` counts it.";
    StageIndex: stage "index", NoUnit, Between(0.0, 15.0), NoBeam, Whole(|f| f.stage.index as i64), "The number of the stage, from 0, in the order of `stages`.";
    StageSteps: stage "steps", Unit::Steps, Steps, NoBeam, Whole(|f| whole(f.stage.steps)), "Steps since it was entered.";
    StageSeconds: stage "seconds", Seconds, Steps, NoBeam, Number(|f| f.stage.seconds), "Time since it was entered.";
    StageDistance: stage "distance_m", Metres, Steps, NoBeam, Number(|f| f.stage.distance_m), "Way counted by the wheels since it was entered.";
    StageTurned: stage "turned_deg", Degrees, Any, NoBeam, Number(|f| f.stage.turned_deg), "Turn counted by the wheels since it was entered, positive to the left.";
    StageAt: stage "at", NoUnit, Any, NoBeam, Call("stage.at(\"name\")", 1), "Whether it is this stage.";
}

/// What people write first, and what it is called here.
pub(crate) const OTHER_NAMES: &[(&str, &str)] = &[
    ("min", "nearest"),
    ("minimum", "nearest"),
    ("closest", "nearest"),
    ("max", "farthest"),
    ("maximum", "farthest"),
    ("furthest", "farthest"),
    ("ahead", "front"),
    ("centre", "front"),
    ("center", "front"),
    ("len", "beams"),
    ("length", "beams"),
    ("average", "mean"),
    ("visible", "seen"),
    ("bumper", "contact"),
    ("collision", "contact"),
    ("speed", "linear"),
    ("turn", "angular"),
    ("steps", "step"),
    ("number", "index"),
];

fn whole(count: u64) -> i64 {
    i64::try_from(count).unwrap_or(i64::MAX)
}

impl Fact {
    /// `laser.nearest`.
    #[must_use]
    pub fn name(&self) -> String {
        format!("{}.{}", self.group, self.key)
    }

    /// What kind of value it is, in words: `number`, `whole number` or `true or false`.
    pub(crate) const fn kind(&self) -> &'static str {
        match self.get {
            Getter::Call(..) if matches!(self.id, FactId::LaserHit | FactId::LaserHitAt | FactId::StageAt) => {
                "true or false"
            }
            Getter::Number(_) | Getter::ViewNumber(_) | Getter::Sector(_) | Getter::Hits | Getter::Call(..) => "number",
            Getter::Whole(_) | Getter::ViewWhole(_) => "whole number",
            Getter::Flag(_) | Getter::ViewFlag(_) => "true or false",
        }
    }

    /// How it is written with its arguments, and how many these are; nothing for a value.
    pub(crate) const fn form(&self) -> Option<(&'static str, usize)> {
        match self.get {
            Getter::Call(form, arguments) => Some((form, arguments)),
            _ => None,
        }
    }
}

impl FactId {
    /// What must be found in a view's mask for it; nothing for most facts.
    pub(crate) const fn look(self) -> Option<Look> {
        match self {
            Self::CameraSize
            | Self::CameraBearing
            | Self::CameraElevation
            | Self::CameraOffset
            | Self::CameraLeft
            | Self::CameraRight
            | Self::CameraFloor => Some(Look { patch: true, line: false }),
            Self::CameraLineSeen | Self::CameraLineOffset | Self::CameraLineHeading => {
                Some(Look { patch: true, line: true })
            }
            _ => None,
        }
    }

    /// Its row in the list.
    #[must_use]
    pub const fn fact(self) -> &'static Fact {
        &FACTS[self as usize]
    }
}

/// The row of a fact that is read without arguments.
pub(crate) fn value(group: &str, key: &str) -> Option<&'static Fact> {
    FACTS.iter().find(|fact| fact.group == group && fact.key == key && fact.form().is_none())
}

/// The row of a fact that is read with arguments.
pub(crate) fn call(group: &str, key: &str) -> Option<&'static Fact> {
    FACTS.iter().find(|fact| fact.group == group && fact.key == key && fact.form().is_some())
}

/// Whether any group has a fact of this name that is read with arguments.
pub(crate) fn takes_arguments(key: &str) -> bool {
    FACTS.iter().any(|fact| fact.key == key && fact.form().is_some())
}

/// Whether this is a group of facts by itself; `sector` is a part of one.
pub(crate) fn is_group(name: &str) -> bool {
    GROUPS.iter().any(|(group, _)| *group == name)
}

/// All names in a group, for near names, values first; `sector` is a group too.
pub(crate) fn names_in(group: &str) -> Vec<&'static str> {
    let in_group = || FACTS.iter().filter(|fact| fact.group == group && fact.key != "[");
    let values = in_group().filter(|fact| fact.form().is_none());
    values.chain(in_group().filter(|fact| fact.form().is_some())).map(|fact| fact.key).collect()
}

#[cfg(test)]
mod tests {
    use super::super::facts::Facts;
    use super::*;

    #[test]
    fn names_are_unique_and_every_group_is_known() {
        let mut names: Vec<_> = FACTS.iter().map(Fact::name).collect();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), FACTS.len());
        assert!(FACTS.iter().all(|fact| is_group(fact.group) || fact.group == "sector"));
    }

    #[test]
    fn every_identity_leads_to_its_row() {
        assert!(FACTS.iter().all(|fact| fact.id.fact().name() == fact.name()));
    }

    #[test]
    fn the_front_of_181_beams_is_beam_90() {
        let facts = Facts { ranges_m: (0..181).map(|beam| beam as f32).collect(), ..Facts::default() };
        let read = |key| match value("laser", key).unwrap().get {
            Getter::Number(get) => get(&facts),
            Getter::Whole(get) => get(&facts) as f64,
            _ => panic!(),
        };
        assert_eq!((read("right"), read("front"), read("left"), read("beams")), (0.0, 90.0, 180.0, 181.0));
    }

    #[test]
    fn the_front_of_an_even_number_of_beams_is_the_lesser_of_the_middle_two() {
        let front = |ranges_m: &[f32]| {
            let facts = Facts { ranges_m: ranges_m.to_vec(), ..Facts::default() };
            let Getter::Number(get) = FactId::LaserFront.fact().get else { panic!() };
            (get(&facts), facts.beam_towards(0.0))
        };
        assert_eq!(front(&[1.0, 3.0, 2.0, 1.0]), (2.0, 2));
        assert_eq!(front(&[1.0, 2.0, 3.0, 1.0]), (2.0, 1));
        assert_eq!(front(&[1.0, 2.0, 2.0, 1.0]), (2.0, 1));
        assert_eq!(front(&[]), (0.0, 0));
    }
}
