//! The columns of the list of facts: how each is read, in which unit, between which values, which beam is behind it.

use super::facts::Facts;
use super::view_facts::ViewFacts;

/// How a fact is read.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Getter {
    /// A number.
    Number(fn(&Facts) -> f64),
    /// A whole number.
    Whole(fn(&Facts) -> i64),
    /// True or false.
    Flag(fn(&Facts) -> bool),
    /// A number of one view.
    ViewNumber(fn(&ViewFacts) -> f64),
    /// A whole number of one view.
    ViewWhole(fn(&ViewFacts) -> i64),
    /// True or false of one view.
    ViewFlag(fn(&ViewFacts) -> bool),
    /// A number that the ranges of a sector give, in metres.
    Sector(fn(&[f32]) -> f64),
    /// How many beams of a sector met anything.
    Hits,
    /// With arguments: how it is written, and how many there are. What it does stands in `views` and, for rules that are
    /// compiled, in `expression`.
    Call(&'static str, usize),
}

/// The unit of a fact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// It has none: it is true or false, or more than one value.
    Without,
    /// Metres.
    Metres,
    /// Metres per second.
    MetresPerSecond,
    /// Radians per second, positive to the left.
    RadiansPerSecond,
    /// Degrees, positive to the left.
    Degrees,
    /// Seconds.
    Seconds,
    /// A share, 0 to 1.
    Share,
    /// Grey levels, 0 to 255.
    GreyLevels,
    /// Halves of the image's width, positive to the left.
    HalfImages,
    /// The number of a beam, from 0.
    Beam,
    /// A count of beams.
    Beams,
    /// The number of an action, from 0.
    Action,
    /// The number of a state, from 0.
    State,
    /// A count of steps.
    Steps,
}

/// Between which values a fact lies; some of them only the settings of a plan can say.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reach {
    /// Between the laser's least and greatest range.
    Laser,
    /// As fast as an action asks, in either direction.
    Commanded,
    /// As fast as an action asks, and what the noise of the wheels adds.
    Measured,
    /// From 0 to the number of the last action.
    Actions,
    /// From 0 to the number of the last state.
    States,
    /// From 0 to the number of beams.
    Beams,
    /// From 0 to the steps of a run.
    Steps,
    /// Between these, both included.
    Between(f64, f64),
    /// Between these; the third where nothing is seen.
    Seen(f64, f64, f64),
    /// True or false; true only after an accident of the body, so seldom.
    Accident,
    /// Anywhere; true or false.
    Any,
}

/// Which beam of the laser makes a fact what it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Beam {
    /// None, or no single one.
    Without,
    /// The first.
    Right,
    /// The middle one.
    Front,
    /// The last.
    Left,
    /// The one with the least range, of all or of its sector.
    Nearest,
    /// The one with the greatest range, of all or of its sector.
    Farthest,
    /// The one farthest beyond what is expected of it.
    Worst,
    /// The one that stands in the brackets.
    Given,
}

impl Unit {
    /// The unit in words; empty where there is none.
    #[must_use]
    pub(crate) const fn words(self) -> &'static str {
        match self {
            Self::Without => "",
            Self::Metres => "metres",
            Self::MetresPerSecond => "m/s",
            Self::RadiansPerSecond => "rad/s",
            Self::Degrees => "degrees",
            Self::Seconds => "seconds",
            Self::Share => "share",
            Self::GreyLevels => "grey levels",
            Self::HalfImages => "half images",
            Self::Beam => "beam",
            Self::Beams => "beams",
            Self::Action => "action",
            Self::State => "state",
            Self::Steps => "steps",
        }
    }
}

impl Reach {
    /// The least and the greatest value under any settings; for the laser's facts [`super::reach::Limits`] knows better.
    pub(crate) const fn bounds(self) -> (f64, f64) {
        match self {
            Self::Between(low, high) => (low, high),
            Self::Seen(low, high, unseen) => (low.min(unseen), high.max(unseen)),
            Self::Laser | Self::Actions | Self::States | Self::Beams | Self::Steps => (0.0, f64::INFINITY),
            Self::Commanded | Self::Measured | Self::Accident | Self::Any => (f64::NEG_INFINITY, f64::INFINITY),
        }
    }

    /// The values in words, as the reference page has them; empty where there is nothing to say.
    pub(crate) fn words(self) -> String {
        match self {
            Self::Laser => "`laser.min_range_m` to `laser.max_range_m`".to_owned(),
            Self::Between(low, high) => format!("{low} to {high}"),
            Self::Seen(low, high, unseen) => format!("{low} to {high}; unseen {unseen}"),
            Self::Actions | Self::States | Self::Beams | Self::Steps => "from 0".to_owned(),
            Self::Commanded | Self::Measured | Self::Accident | Self::Any => String::new(),
        }
    }
}
