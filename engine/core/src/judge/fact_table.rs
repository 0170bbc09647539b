//! The one list of facts: scripts, checks, near names, the reference page and editors read it.

use super::facts::{Facts, decimal, greatest, least, mean};

/// How a fact is read.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Getter {
    /// A number.
    Number(fn(&Facts) -> f64),
    /// A whole number.
    Whole(fn(&Facts) -> i64),
    /// True or false.
    Flag(fn(&Facts) -> bool),
}

/// Between which values a fact lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Reach {
    /// Between the laser's least and greatest range.
    Laser,
    /// Between these, both included.
    Between(f64, f64),
    /// From this on.
    From(f64),
    /// Anywhere.
    Any,
}

/// One row of the table.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Fact {
    /// The group: `laser`.
    pub group: &'static str,
    /// The name within it: `nearest`.
    pub key: &'static str,
    /// The unit, in words; empty for flags.
    pub unit: &'static str,
    /// Between which values it lies.
    pub reach: Reach,
    /// One sentence: what it is.
    pub purpose: &'static str,
    /// Reads it.
    pub get: Getter,
}

/// A fact of a sector of the laser.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SectorFact {
    /// Its name: `nearest`.
    pub key: &'static str,
    /// One sentence: what it is.
    pub purpose: &'static str,
    /// Reads it, metres.
    pub get: fn(&[f32]) -> f64,
}

/// A fact that needs arguments.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FactCall {
    /// What it belongs to: `laser`, `sector` or `camera`.
    pub group: &'static str,
    /// Its name: `sector`; `[` for an index.
    pub key: &'static str,
    /// How it is written: `laser.sector(from, to)`.
    pub form: &'static str,
    /// How many arguments it takes.
    pub arguments: usize,
    /// The unit, in words; empty for a sector.
    pub unit: &'static str,
    /// One sentence: what it is.
    pub purpose: &'static str,
}

/// The groups of facts, with what each is about.
pub(crate) const GROUPS: &[(&str, &str)] = &[
    ("laser", "The ranges of the laser: beam 0 looks right, the last beam left, the middle one ahead."),
    ("camera", "What the filter left of the camera's image."),
    ("action", "The action that the learner has just carried out."),
    ("robot", "The bumper, the tilt switch and the wheel encoders."),
    ("state", "What the learner sees."),
    ("time", "Steps counted."),
];

macro_rules! facts {
    ($($group:ident . $key:ident, $kind:ident, $unit:literal, $reach:expr, $get:expr, $purpose:literal;)*) => {
        /// Every fact that is one value, group by group.
        pub(crate) const FACTS: &[Fact] = &[$(Fact {
            group: stringify!($group),
            key: stringify!($key),
            unit: $unit,
            reach: $reach,
            purpose: $purpose,
            get: Getter::$kind($get),
        }),*];
    };
}

use Reach::{Any, Between, From, Laser};

facts! {
    laser.nearest, Number, "metres", Laser, |f| decimal(least(&f.ranges_m)), "The least range of all beams.";
    laser.farthest, Number, "metres", Laser, |f| decimal(greatest(&f.ranges_m)), "The greatest range of all beams.";
    laser.right, Number, "metres", Laser, |f| f.beam_m(0), "The range of beam 0, square to the right.";
    laser.front, Number, "metres", Laser, |f| f.beam_m(f.ranges_m.len() / 2), "The range of the middle beam, ahead.";
    laser.left, Number, "metres", Laser, |f| f.beam_m(f.ranges_m.len().saturating_sub(1)), "The range of the last beam, square to the left.";
    laser.nearest_beam, Whole, "beam", From(0.0), |f| f.nearest_beam() as i64, "The number of the beam with the least range.";
    laser.beams, Whole, "beams", From(0.0), |f| f.ranges_m.len() as i64, "How many beams there are.";
    camera.seen, Flag, "", Any, |f| f.seen, "Whether any cell of the grid is occupied.";
    camera.coverage, Number, "share", Between(0.0, 1.0), |f| f.coverage, "The share of the image that the filter left.";
    action.index, Whole, "action", From(0.0), |f| f.action as i64, "Its number in the list of actions, from 0.";
    action.linear, Number, "m/s", Any, |f| f.action_linear, "The forward speed that was commanded.";
    action.angular, Number, "rad/s", Any, |f| f.action_angular, "The turning speed that was commanded, positive to the left.";
    robot.contact, Flag, "", Any, |f| f.contact, "Whether the body touched something in this step.";
    robot.fallen, Flag, "", Any, |f| f.fallen, "Whether the robot has lost its footing.";
    robot.linear, Number, "m/s", Any, |f| f.linear, "The forward speed that the wheels measured.";
    robot.angular, Number, "rad/s", Any, |f| f.angular, "The turning speed that the wheels measured, positive to the left.";
    state.index, Whole, "state", From(0.0), |f| f.state as i64, "The state that the grid was coded into, from 0.";
    time.step, Whole, "steps", From(0.0), |f| whole(f.step), "Steps since learning or the test began.";
    time.since_recovery, Whole, "steps", From(0.0), |f| whole(f.since_recovery), "Steps since the last recovery or the start.";
}

/// The facts of `laser.sector(from, to)`.
pub(crate) const SECTOR: &[SectorFact] = &[
    SectorFact { key: "nearest", purpose: "The least range in the sector.", get: |r| decimal(least(r)) },
    SectorFact { key: "farthest", purpose: "The greatest range in the sector.", get: |r| decimal(greatest(r)) },
    SectorFact { key: "mean", purpose: "The mean range in the sector.", get: mean },
];

/// The facts that need arguments.
pub(crate) const CALLS: &[FactCall] = &[
    FactCall {
        group: "laser",
        key: "[",
        form: "laser[beam]",
        arguments: 1,
        unit: "metres",
        purpose: "The range of one beam.",
    },
    FactCall {
        group: "laser",
        key: "sector",
        form: "laser.sector(from, to)",
        arguments: 2,
        unit: "",
        purpose: "The beams `from` to `to`, both included; compared with a number it means its nearest.",
    },
    FactCall {
        group: "sector",
        key: "count_below",
        form: "laser.sector(from, to).count_below(limit)",
        arguments: 1,
        unit: "beams",
        purpose: "How many beams of the sector are nearer than `limit` metres.",
    },
    FactCall {
        group: "sector",
        key: "excess",
        form: "laser.sector(from, to).excess(expected)",
        arguments: 1,
        unit: "metres",
        purpose: "The greatest of range minus expected range; `expected` is an array with one number for each beam.",
    },
    FactCall {
        group: "camera",
        key: "cell",
        form: "camera.cell(row, column)",
        arguments: 2,
        unit: "share",
        purpose: "The share of one grid cell that the filter left; row 0 is the top, column 0 the left.",
    },
];

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
    pub(crate) fn name(&self) -> String {
        format!("{}.{}", self.group, self.key)
    }

    /// What kind of value it is, in words: `number`, `whole number` or `true or false`.
    #[must_use]
    pub(crate) const fn kind(&self) -> &'static str {
        match self.get {
            Getter::Number(_) => "number",
            Getter::Whole(_) => "whole number",
            Getter::Flag(_) => "true or false",
        }
    }
}

impl Reach {
    /// The least and the greatest value; for the laser's facts [`super::reach::Limits`] knows better.
    pub(crate) fn bounds(self) -> (f64, f64) {
        match self {
            Self::Laser => (0.0, f64::INFINITY),
            Self::Between(low, high) => (low, high),
            Self::From(low) => (low, f64::INFINITY),
            Self::Any => (f64::NEG_INFINITY, f64::INFINITY),
        }
    }
}

/// The row of one fact.
pub(crate) fn find(group: &str, key: &str) -> Option<&'static Fact> {
    FACTS.iter().find(|fact| fact.group == group && fact.key == key)
}

/// All names in a group, for near names; `sector` is a group too.
pub(crate) fn names_in(group: &str) -> Vec<&'static str> {
    let values = FACTS.iter().filter(|fact| fact.group == group).map(|fact| fact.key);
    let sector = SECTOR.iter().filter(|_| group == "sector").map(|fact| fact.key);
    let calls = CALLS.iter().filter(|call| call.group == group && call.key != "[").map(|call| call.key);
    values.chain(sector).chain(calls).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_every_group_is_known() {
        let mut names: Vec<_> = FACTS.iter().map(Fact::name).collect();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), FACTS.len());
        assert!(FACTS.iter().all(|fact| GROUPS.iter().any(|(group, _)| *group == fact.group)));
    }

    #[test]
    fn the_front_of_181_beams_is_beam_90() {
        let facts = Facts { ranges_m: (0..181).map(|beam| beam as f32).collect(), ..Facts::default() };
        let read = |key| match find("laser", key).unwrap().get {
            Getter::Number(get) => get(&facts),
            Getter::Whole(get) => get(&facts) as f64,
            Getter::Flag(_) => panic!(),
        };
        assert_eq!((read("right"), read("front"), read("left"), read("beams")), (0.0, 90.0, 180.0, 181.0));
    }
}
