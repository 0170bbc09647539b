//! What differs from attempt to attempt: the worlds of a run, and the settings that are drawn anew.

use super::{SETTINGS, Setting, SettingShape, Value};
use crate::random::Random;

/// Settings that may be drawn anew: those that change neither the form of what is sensed nor the rhythm of a run.
const VARIABLE: [&str; 26] = [
    "robot.lag_s",
    "robot.speed_noise",
    "robot.slip",
    "camera.field_of_view_deg",
    "camera.forward_m",
    "camera.height_m",
    "camera.tilt_deg",
    "camera.noise",
    "camera.exposure_drift",
    "camera.white_balance_drift",
    "light.gain",
    "light.ambient",
    "light.turn_deg",
    "light.raise_deg",
    "light.shadows",
    "light.softness_deg",
    "laser.forward_m",
    "laser.height_m",
    "laser.tilt_deg",
    "laser.max_range_m",
    "laser.noise_m",
    "movers.speed",
    "recovery.to",
    "recovery.distance_m",
    "recovery.position_m",
    "recovery.yaw_deg",
];
/// What else may be drawn, with its unit, its range, and what stands for a name of the world in it.
const OF_THE_WORLD: [(&str, SettingShape); 5] = [
    ("start.yaw_deg", SettingShape::Number(-180.0, 180.0)),
    ("start.shift_m", SettingShape::Number(-5.0, 5.0)),
    ("colour.NAME", SettingShape::Number(-255.0, 255.0)),
    ("mover.NAME.speed", SettingShape::Number(0.0, 10.0)),
    ("texture.NAME", SettingShape::Choice(&TEXTURES)),
];
/// The kinds of a world file's textures, which have its defaults here.
pub const TEXTURES: [&str; 6] = ["plain", "checker", "stripes", "noise", "tiles", "bricks"];

/// One entry of `worlds`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WorldShare {
    /// A world's name, the path of its file, or worlds made by rule such as `corridors:1-12`.
    pub name: String,
    /// How often it is drawn, by the weights of the others: a whole number from 1.
    pub weight: u32,
}

/// One entry of `randomise`.
#[derive(Debug, Clone, PartialEq)]
pub struct Varied {
    /// What is drawn: `camera.tilt_deg`.
    pub key: String,
    /// From what.
    pub from: DrawnFrom,
}

/// What a value is drawn from.
#[derive(Debug, Clone, PartialEq)]
pub enum DrawnFrom {
    /// Uniformly from the first to the second.
    Range(f64, f64),
    /// One of these.
    OneOf(Vec<Value>),
}

/// What a key of `randomise` is about.
#[derive(Debug, Clone, Copy)]
pub enum VariedKey<'a> {
    /// A setting.
    Setting(&'static Setting),
    /// A turn of the place where an attempt begins, degrees to the left.
    StartYaw,
    /// A shift of it, metres to its left.
    StartShift,
    /// Grey levels that are added to a material's colour.
    Colour(&'a str),
    /// How many times as fast as its file says one mover is.
    Mover(&'a str),
    /// The kind of a material's texture.
    Texture(&'a str),
}

impl<'a> VariedKey<'a> {
    /// What a key is about, and what its values may be; nothing if it cannot vary.
    #[must_use]
    pub fn of(key: &'a str) -> Option<(Self, SettingShape)> {
        let [yaw, shift, colour, speed, texture] = OF_THE_WORLD.map(|(_, shape)| shape);
        if VARIABLE.contains(&key) {
            let row = SETTINGS.iter().find(|row| row.name() == key)?;
            return Some((Self::Setting(row), row.shape));
        }
        let mover = || key.strip_prefix("mover.")?.strip_suffix(".speed").map(Self::Mover);
        match key {
            "start.yaw_deg" => Some((Self::StartYaw, yaw)),
            "start.shift_m" => Some((Self::StartShift, shift)),
            _ => key
                .strip_prefix("colour.")
                .map(|name| (Self::Colour(name), colour))
                .or_else(|| Some((Self::Texture(key.strip_prefix("texture.")?), texture)))
                .or_else(|| Some((mover()?, speed)))
                .filter(|(key, _)| !matches!(key, Self::Colour("") | Self::Mover("") | Self::Texture(""))),
        }
    }

    /// Every key that can vary; `NAME` stands for a name of the world.
    pub fn all() -> impl Iterator<Item = &'static str> {
        VARIABLE.into_iter().chain(OF_THE_WORLD.into_iter().map(|(key, _)| key))
    }
}

impl DrawnFrom {
    /// The range or the choice in words: `40 to 44`, `0 or 1 or 2`.
    #[must_use]
    pub fn words(&self) -> String {
        match self {
            Self::Range(low, high) => format!("{low} to {high}"),
            Self::OneOf(values) => values.iter().map(Value::to_string).collect::<Vec<_>>().join(" or "),
        }
    }
}

impl Varied {
    /// Draws once: the number; of words and flags, which of them it is, from 0.
    pub fn draw(&self, random: &mut Random) -> f64 {
        match &self.from {
            DrawnFrom::Range(low, high) => random.between(*low, *high),
            DrawnFrom::OneOf(values) => {
                let index = random.below(values.len() as u32) as usize;
                if let Value::Number(number) = values[index] { number } else { index as f64 }
            }
        }
    }

    /// The value that a drawn number stands for.
    #[must_use]
    pub fn value(&self, drawn: f64) -> Value {
        match &self.from {
            DrawnFrom::OneOf(values) if !matches!(values.first(), Some(Value::Number(_))) => {
                values.get(drawn as usize).cloned().unwrap_or(Value::Number(drawn))
            }
            _ => Value::Number(drawn),
        }
    }

    /// The value in words: to four places, or the word.
    #[must_use]
    pub fn shown(&self, drawn: f64) -> String {
        match self.value(drawn) {
            Value::Number(number) => format!("{}", (number * 1e4).round() / 1e4),
            value => value.to_string(),
        }
    }

    /// Both ends of its range, or each of its values, as drawn numbers.
    pub fn extremes(&self) -> impl Iterator<Item = f64> + '_ {
        let count = if let DrawnFrom::OneOf(values) = &self.from { values.len() } else { 2 };
        (0..count).map(|index| match &self.from {
            DrawnFrom::Range(low, high) => [*low, *high][index],
            DrawnFrom::OneOf(values) => {
                if let Value::Number(number) = values[index] {
                    number
                } else {
                    index as f64
                }
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    #[test]
    fn every_key_that_varies_is_known_and_those_that_shape_a_run_are_not() {
        for key in VariedKey::all() {
            assert!(VariedKey::of(key).is_some(), "{key}");
        }
        for key in ["robot.tick_s", "camera.width_px", "laser.beams", "run.period_s", "grid.rows", "camera.own_body"] {
            assert!(VariedKey::of(key).is_none(), "{key}");
        }
        assert!(VariedKey::of("colour.").is_none() && VariedKey::of("mover..speed").is_none());
    }

    #[test]
    fn a_range_is_drawn_evenly_and_words_by_their_number() {
        let mut random = Random::new(3, Stream::Variation);
        let range = Varied { key: "movers.speed".to_owned(), from: DrawnFrom::Range(1.0, 3.0) };
        let draws: Vec<f64> = (0..4000).map(|_| range.draw(&mut random)).collect();
        // The mean is 2 within four times 2 / sqrt(12 * 4000) = 0.009.
        let mean = draws.iter().sum::<f64>() / 4000.0;
        assert!(draws.iter().all(|drawn| (1.0..3.0).contains(drawn)) && (mean - 2.0).abs() < 0.037, "{mean}");
        let words = ["start", "random"].map(|word| Value::Text(word.to_owned()));
        let words = Varied { key: "recovery.to".to_owned(), from: DrawnFrom::OneOf(words.to_vec()) };
        let drawn = words.draw(&mut random);
        assert!(words.value(drawn) == words.value(0.0) || words.value(drawn) == words.value(1.0));
        assert_eq!(words.value(1.0), Value::Text("random".to_owned()));
    }
}
