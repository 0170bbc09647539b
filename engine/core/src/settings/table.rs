//! The one list of settings.

use super::{CombineWay, LearnerKind, Lens, RecoverTo, Settings};
use crate::diagnostic::nearest_name;

/// A setting's value as it stands in a file or a script.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// A number.
    Number(f64),
    /// True or false.
    Flag(bool),
    /// A word.
    Text(String),
}

/// What a setting may be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SettingShape {
    /// A number from the first to the second, both included.
    Number(f64, f64),
    /// A whole number from the first to the second, both included.
    Whole(u64, u64),
    /// True or false.
    Flag,
    /// One of these words.
    Choice(&'static [&'static str]),
}

/// One row of the table.
#[derive(Debug, Clone, Copy)]
pub struct Setting {
    /// The group, which is the set-up call: `camera`.
    pub group: &'static str,
    /// The key within it: `tilt_deg`.
    pub key: &'static str,
    /// The unit, in words; empty for words and flags.
    pub unit: &'static str,
    /// What it may be.
    pub shape: SettingShape,
    /// One sentence: what it changes.
    pub purpose: &'static str,
    /// Reads it.
    pub get: fn(&Settings) -> Value,
    set: fn(&mut Settings, &Value),
}

/// Why a value cannot be set.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SettingError {
    /// What is wrong: `'tilt_deg' must be -30 to 90 degrees`.
    pub message: String,
    /// What was found: `found 420`.
    pub found: String,
    /// What to write instead.
    pub help: Option<String>,
}

trait Stored {
    fn value(&self) -> Value;
    fn store(&mut self, value: &Value);
}

impl Stored for f64 {
    fn value(&self) -> Value {
        Value::Number(*self)
    }
    fn store(&mut self, value: &Value) {
        if let Value::Number(number) = value {
            *self = *number;
        }
    }
}

impl Stored for u64 {
    fn value(&self) -> Value {
        Value::Number(*self as f64)
    }
    fn store(&mut self, value: &Value) {
        if let Value::Number(number) = value {
            *self = *number as Self;
        }
    }
}

impl Stored for bool {
    fn value(&self) -> Value {
        Value::Flag(*self)
    }
    fn store(&mut self, value: &Value) {
        if let Value::Flag(flag) = value {
            *self = *flag;
        }
    }
}

/// Words are checked against the table before they are stored.
macro_rules! stored_words {
    ($($name:ident),*) => {
        $(impl Stored for $name {
            fn value(&self) -> Value {
                Value::Text(self.word().to_owned())
            }
            fn store(&mut self, value: &Value) {
                if let Value::Text(text) = value
                    && let Some(word) = Self::of(text)
                {
                    *self = word;
                }
            }
        })*
    };
}

stored_words!(CombineWay, LearnerKind, Lens, RecoverTo);

macro_rules! settings {
    ($($group:ident . $key:ident $(in $within:ident)?, $unit:literal, $shape:expr, $purpose:literal;)*) => {
        /// Every setting that is one value, group by group.
        pub const SETTINGS: &[Setting] = &[$(Setting {
            group: stringify!($group),
            key: stringify!($key),
            unit: $unit,
            shape: $shape,
            purpose: $purpose,
            get: |settings| settings.$($within.)?$group.$key.value(),
            set: |settings, value| settings.$($within.)?$group.$key.store(value),
        }),*];
    };
}

use SettingShape::{Choice, Flag, Number, Whole};

settings! {
    run.steps, "steps", Whole(1, 1_000_000_000), "How long to learn.";
    run.test_steps, "steps", Whole(1, 1_000_000_000), "How long to test the frozen policy afterwards.";
    run.period_s, "seconds", Number(0.05, 5.0), "Time between two actions.";
    run.stay_steps, "steps", Whole(0, 1_000_000_000), "With several worlds or with `randomise`: how long an attempt lasts at most; 0 is for ever, and the default of a script that can reach a goal or restarts.";
    robot.lag_s, "seconds", Number(0.0, 2.0), "Time constant with which the wheels follow a command.";
    robot.speed_noise, "share", Number(0.0, 0.5), "Deviation of the real speeds from the commanded ones.";
    robot.slip, "share", Number(0.0, 0.5), "Share of a turn that the skidding wheels lose.";
    robot.tick_s, "seconds", Number(0.001, 0.1), "Longest step of the physics.";
    camera.width_px, "pixels", Whole(16, 1280), "Width of the image.";
    camera.height_px, "pixels", Whole(12, 960), "Height of the image.";
    camera.field_of_view_deg, "degrees", Number(10.0, 120.0), "Horizontal field of view.";
    camera.lens, "", Choice(Lens::WORDS), "The projection; `fisheye` is equidistant.";
    camera.forward_m, "metres", Number(-1.0, 1.0), "Place of the camera ahead of the robot's centre.";
    camera.height_m, "metres", Number(0.05, 3.0), "Height of the camera above the floor.";
    camera.tilt_deg, "degrees", Number(-30.0, 90.0), "How far the camera looks down.";
    camera.noise, "grey levels", Number(0.0, 64.0), "Deviation of the pixel noise.";
    camera.exposure_drift, "share", Number(0.0, 0.5), "Deviation of the brightness of whole images, which wanders within some tens of images.";
    camera.white_balance_drift, "share", Number(0.0, 0.5), "Deviation of red, and of blue against it, which wanders likewise.";
    camera.own_body, "", Flag, "Whether the camera sees the robot's own body where that is in its view.";
    camera.depth, "", Flag, "Whether it is a depth camera too: filters such as `relief` need one.";
    camera.depth_noise, "1/m", Number(0.0, 1.0), "Deviation of the noise of nearness, one over the distance.";
    camera.depth_holes, "share", Number(0.0, 1.0), "Share of the pixels at which depth is not measured; beside edges ten times as many.";
    camera.deck_m, "metres", Number(0.01, 5.0), "Height of the body as its own camera sees it, without what stands on it; at most the body's height, which it is for a body file that does not say it.";
    light.gain in camera, "times", Number(0.05, 5.0), "Brightness of the image, by that in the world file.";
    light.ambient in camera, "share", Number(-1.0, 1.0), "Added to the share of the light that comes from everywhere; the sum is kept within 0 to 1.";
    light.turn_deg in camera, "degrees", Number(-180.0, 180.0), "The sun is turned so far to the left, seen from above.";
    light.raise_deg in camera, "degrees", Number(-90.0, 90.0), "The sun stands so much higher; from the horizon to straight above.";
    light.shadows in camera, "", Flag, "Whether the sun casts shadows in a world whose file does not say so.";
    light.softness_deg in camera, "degrees", Number(0.0, 20.0), "Added to the width of the sun: the edges of shadows are as soft as that. The sum is at most 20.";
    laser.beams, "beams", Whole(3, 1441), "Beams over the field of view, both ends included.";
    laser.field_of_view_deg, "degrees", Number(10.0, 360.0), "From the first beam to the last; 360 looks all round.";
    laser.forward_m, "metres", Number(-1.0, 1.0), "Place of the laser ahead of the robot's centre.";
    laser.height_m, "metres", Number(0.02, 3.0), "Height of the laser above the floor.";
    laser.tilt_deg, "degrees", Number(-90.0, 90.0), "How far the laser looks down.";
    laser.min_range_m, "metres", Number(0.0, 10.0), "Nothing nearer is measured; nearer things read as this.";
    laser.max_range_m, "metres", Number(0.1, 100.0), "Nothing seen reads as this.";
    laser.noise_m, "metres", Number(0.0, 1.0), "Deviation of the range noise.";
    ground.ahead_m, "metres", Number(-1.0, 1.0), "Place of the sensors that look down, ahead of the robot's centre.";
    ground.aside_m, "metres", Number(0.0, 1.0), "How far to the left and right of the middle one the two others are.";
    grid.rows in view, "cells", Whole(1, 16), "Rows of the grid over the filtered image.";
    grid.columns in view, "cells", Whole(1, 16), "Columns of the grid.";
    grid.occupied in view, "share", Number(0.0001, 1.0), "Share of foreground pixels from which a cell is occupied.";
    grid.fill in view, "", Flag, "Whether an occupied cell fills those above it.";
    grid.remember_s in view, "seconds", Number(0.0, 60.0), "How long an empty column is told apart that was not empty; needs `fill`.";
    learner.kind, "", Choice(LearnerKind::WORDS), "The way of learning.";
    learner.step_size, "share", Number(0.0, 1.0), "Share of the error that is learned (alpha).";
    learner.discount, "share", Number(0.0, 1.0), "How much the next value counts (gamma).";
    learner.trace_decay, "share", Number(0.0, 1.0), "How fast the memory of earlier states fades (lambda).";
    learner.window, "states", Whole(1, 1000), "How many of the last states are updated (n).";
    learner.temperature, "value", Number(0.000_001, 1000.0), "Softmax temperature of a state never met (T0).";
    learner.temperature_end, "value", Number(0.000_001, 1000.0), "Lowest temperature, and that of the test (k).";
    learner.cooling_visits, "visits", Whole(1, 1_000_000_000), "Visits of a state until it is coolest (tk).";
    learner.initial_low, "value", Number(-1000.0, 1000.0), "Least first value of an action.";
    learner.initial_high, "value", Number(-1000.0, 1000.0), "Greatest first value of an action.";
    learner.failure_is_terminal, "", Flag, "Whether nothing is expected after a failure.";
    learner.mirror, "", Flag, "Whether each step is also learned left for right; for symmetric tasks.";
    learner.replay, "passes", Whole(0, 100), "How often the steps before a recovery, 60 at most, are learned again backwards.";
    learner.memory_steps, "steps", Whole(100, 1_000_000), "Of `memory`: how many of the last steps are remembered.";
    learner.memory_discount, "share", Number(0.0, 1.0), "Of `memory`: how much the next value counts (gamma).";
    learner.memory_lambda, "share", Number(0.0, 1.0), "Of `memory`: how much of a return is what followed, the rest what was expected (lambda).";
    recovery.to, "", Choice(RecoverTo::WORDS), "Where recovery puts the robot: on the lap route, at a start, or behind the first mover.";
    recovery.distance_m, "metres", Number(0.0, 100.0), "How far behind the mover, along its route; for `behind` only.";
    recovery.position_m, "metres", Number(0.0, 2.0), "Greatest random shift of that place.";
    recovery.yaw_deg, "degrees", Number(0.0, 180.0), "Greatest random turn of that heading.";
    movers.speed, "times", Number(0.0, 10.0), "How fast everything that drives by itself is, by the speed in the world file.";
    combine.way, "", Choice(CombineWay::WORDS), "How several policies become one.";
    combine.margin, "value", Number(0.0, 1000.0), "By priority: best less median value from which a policy decides.";
    combine.scaled, "", Flag, "By sum: whether each policy's values are divided by their deviation first.";
}

impl Setting {
    /// `camera.tilt_deg`.
    #[must_use]
    pub fn name(&self) -> String {
        format!("{}.{}", self.group, self.key)
    }

    /// What it may be, in words: `-30 to 90 degrees`.
    #[must_use]
    pub fn allowed(&self) -> String {
        self.shape.allowed(self.unit)
    }
}

impl SettingShape {
    /// Whether it may be this value.
    #[must_use]
    pub fn accepts(self, value: &Value) -> bool {
        match (self, value) {
            (Self::Number(min, max), Value::Number(number)) => (min..=max).contains(number),
            (Self::Whole(min, max), Value::Number(number)) => {
                number.fract() == 0.0 && (min as f64..=max as f64).contains(number)
            }
            (Self::Flag, Value::Flag(_)) => true,
            (Self::Choice(words), Value::Text(text)) => words.contains(&text.as_str()),
            _ => false,
        }
    }

    /// What it may be, in words; `unit` in words too, or empty.
    #[must_use]
    pub fn allowed(self, unit: &str) -> String {
        let unit = if unit.is_empty() { String::new() } else { format!(" ({unit})") };
        match self {
            Self::Number(min, max) => format!("{min} to {max}{unit}"),
            Self::Whole(min, max) => format!("a whole number from {min} to {max}{unit}"),
            Self::Flag => "true or false".to_owned(),
            Self::Choice(words) => words.iter().map(|word| format!("\"{word}\"")).collect::<Vec<_>>().join(" or "),
        }
    }
}

impl std::fmt::Display for Value {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Number(number) => write!(f, "{number}"),
            Self::Flag(flag) => write!(f, "{flag}"),
            Self::Text(text) => write!(f, "\"{}\"", crate::diagnostic::printable(text)),
        }
    }
}

/// Sets `group.key`, checked against the table.
///
/// # Errors
/// If there is no such key (with the nearest one, or the one with the right unit), or the value is out of its range.
pub fn apply(settings: &mut Settings, group: &str, key: &str, value: &Value) -> Result<(), SettingError> {
    let Some(row) = SETTINGS.iter().find(|row| row.group == group && row.key == key) else {
        return Err(unknown(group, key));
    };
    if !row.shape.accepts(value) {
        return Err(SettingError {
            message: format!("'{}' must be {}", row.key, row.allowed()),
            found: format!("found {value}"),
            help: Some(format!("the default is {}. {}", (row.get)(&Settings::default()), row.purpose)),
        });
    }
    (row.set)(settings, value);
    Ok(())
}

fn unknown(group: &str, key: &str) -> SettingError {
    let rows: Vec<_> = SETTINGS.iter().filter(|row| row.group == group).collect();
    let shown = crate::diagnostic::printable(key);
    if rows.is_empty() {
        let groups = SETTINGS.iter().map(|row| row.group);
        let near = nearest_name(group, groups.clone()).map(|near| format!("did you mean '{near}.{key}'?"));
        let help = near.unwrap_or_else(|| {
            let mut groups: Vec<_> = groups.collect();
            groups.dedup();
            format!("the groups are: {}", groups.join(", "))
        });
        let message = format!("there is no group of settings '{}'", crate::diagnostic::printable(group));
        return SettingError { message, found: "not known".to_owned(), help: Some(help) };
    }
    // `height_cm` and `height` both mean `height_m`: the stem is right, the unit is not.
    let stem = |name: &str| name.rsplit_once('_').map_or(name.to_owned(), |(stem, _)| stem.to_owned());
    let same_stem = rows
        .iter()
        .filter(|row| stem(row.key) == stem(key) || stem(row.key) == key)
        .min_by_key(|row| strsim::damerau_levenshtein(row.key, key));
    let help = match (same_stem, nearest_name(key, rows.iter().map(|row| row.key))) {
        (Some(row), _) if !row.unit.is_empty() => Some(format!("write '{}', in {}", row.key, row.unit)),
        (_, Some(near)) => Some(format!("did you mean '{near}'?")),
        _ => Some(format!("it has: {}", rows.iter().map(|row| row.key).collect::<Vec<_>>().join(", "))),
    };
    SettingError { message: format!("'{group}' has no setting '{shown}'"), found: "not known".to_owned(), help }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_default_is_within_its_own_range() {
        let settings = Settings::default();
        for row in SETTINGS {
            assert!(row.shape.accepts(&(row.get)(&settings)), "{}", row.name());
        }
    }

    #[test]
    fn names_are_unique() {
        let mut names: Vec<_> = SETTINGS.iter().map(Setting::name).collect();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), SETTINGS.len());
    }

    #[test]
    fn a_set_value_is_read_back() {
        let mut settings = Settings::default();
        apply(&mut settings, "camera", "tilt_deg", &Value::Number(30.0)).unwrap();
        assert_eq!(settings.camera.tilt_deg, 30.0);
    }

    #[test]
    fn a_wrong_unit_is_answered_with_the_right_one() {
        let error = apply(&mut Settings::default(), "camera", "height_cm", &Value::Number(81.0)).unwrap_err();
        assert_eq!(error.help.as_deref(), Some("write 'height_m', in metres"));
    }

    #[test]
    fn a_fraction_is_no_whole_number() {
        assert!(apply(&mut Settings::default(), "grid", "rows", &Value::Number(2.5)).is_err());
    }

    #[test]
    fn not_a_number_is_refused() {
        assert!(apply(&mut Settings::default(), "camera", "noise", &Value::Number(f64::NAN)).is_err());
    }
}
