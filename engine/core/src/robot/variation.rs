//! What is drawn anew for each attempt, and which parts of a robot and its world that touches.

use crate::random::{Random, Stream};
use crate::saved::{Passed, Passing};
use crate::settings::{RecoverTo, Settings, TEXTURES, Value, Varied, VariedKey, apply};
use crate::world::Mover;

/// Draws the values of `randomise`, in the order of its keys.
#[derive(Debug, Clone)]
pub(super) struct Variation {
    random: Random,
    keys: Vec<Varied>,
    /// As drawn last: numbers; of words and flags, which of them it is.
    drawn: Vec<f64>,
    /// The settings with what was drawn.
    pub(super) settings: Settings,
    pub(super) touched: Touched,
}

/// What drawn values change, and those of them that are no settings.
#[derive(Debug, Clone, Default)]
pub(super) struct Touched {
    pub(super) drive: bool,
    pub(super) camera: bool,
    pub(super) laser: bool,
    pub(super) movers: bool,
    pub(super) recovery: bool,
    pub(super) colours: bool,
    pub(super) start_shift_m: f64,
    pub(super) start_yaw_deg: f64,
    /// By material: grey levels to add.
    levels: Vec<(String, f64)>,
    /// By material: the kind of its texture.
    textures: Vec<(String, &'static str)>,
    /// By mover: how many times as fast it is.
    speeds: Vec<(String, f64)>,
}

impl Variation {
    /// Of a run's settings, under its seed; nothing is drawn yet.
    pub(super) fn new(settings: &Settings, seed: u64) -> Self {
        let keys = settings.randomise.clone();
        let mut touched = Touched::default();
        keys.iter().filter_map(|varied| Some(VariedKey::of(&varied.key)?.0)).for_each(|key| touched.add(key));
        let random = Random::new(seed, Stream::Variation);
        Self { random, drawn: vec![0.0; keys.len()], keys, settings: settings.clone(), touched }
    }

    /// Draws all values.
    pub(super) fn draw(&mut self) {
        let Self { random, keys, drawn, .. } = self;
        for (varied, drawn) in keys.iter().zip(drawn) {
            *drawn = varied.draw(random);
        }
        self.set();
    }

    /// What is drawn.
    pub(super) fn pass(&mut self, by: &mut Passing<'_>) -> Passed {
        by.random(&mut self.random)?;
        by.all(&mut self.drawn, Passing::number)?;
        self.set();
        Ok(())
    }

    fn set(&mut self) {
        let Self { keys, drawn, settings, touched, .. } = self;
        for (varied, drawn) in keys.iter().zip(drawn) {
            match VariedKey::of(&varied.key) {
                // The script was refused if its values were out of range.
                Some((VariedKey::Setting(row), _)) => {
                    let _ = apply(settings, row.group, row.key, &varied.value(*drawn));
                }
                Some((VariedKey::StartYaw, _)) => touched.start_yaw_deg = *drawn,
                Some((VariedKey::StartShift, _)) => touched.start_shift_m = *drawn,
                Some((VariedKey::Colour(name), _)) => set(&mut touched.levels, name, *drawn),
                Some((VariedKey::Mover(name), _)) => set(&mut touched.speeds, name, *drawn),
                Some((VariedKey::Texture(name), _)) => {
                    let own = touched.textures.iter_mut().filter(|(own, _)| own == name);
                    own.for_each(|(_, kind)| *kind = texture(varied, *drawn));
                }
                None => {}
            }
        }
    }

    pub(super) fn drawn(&self) -> &[f64] {
        &self.drawn
    }

    /// The greatest range of the laser, if that is drawn.
    pub(super) fn max_range_m(&self) -> Option<f64> {
        self.touched.laser.then_some(self.settings.laser.max_range_m)
    }
}

impl Touched {
    fn add(&mut self, key: VariedKey<'_>) {
        match key {
            VariedKey::Setting(row) => match row.group {
                "robot" => self.drive = true,
                "camera" | "light" => self.camera = true,
                "laser" => self.laser = true,
                "movers" => self.movers = true,
                _ => self.recovery = true,
            },
            VariedKey::StartYaw | VariedKey::StartShift => self.recovery = true,
            VariedKey::Colour(name) => {
                self.colours = true;
                self.levels.push((name.to_owned(), 0.0));
            }
            VariedKey::Texture(name) => {
                self.colours = true;
                self.textures.push((name.to_owned(), TEXTURES[0]));
            }
            VariedKey::Mover(name) => {
                self.movers = true;
                self.speeds.push((name.to_owned(), 1.0));
            }
        }
    }

    pub(super) fn speed_of(&self, mover: &str) -> f64 {
        of(&self.speeds, mover).unwrap_or(1.0)
    }

    /// The kind of a material's texture, if that is drawn.
    pub(super) fn texture_of(&self, material: &str) -> Option<&'static str> {
        self.textures.iter().find(|(own, _)| own == material).map(|(_, kind)| *kind)
    }

    pub(super) fn levels_of(&self, material: &str) -> Option<f64> {
        of(&self.levels, material)
    }
}

/// The kind that was drawn; the script was refused if it is none.
fn texture(varied: &Varied, drawn: f64) -> &'static str {
    let Value::Text(word) = varied.value(drawn) else { return TEXTURES[0] };
    TEXTURES.into_iter().find(|kind| *kind == word).unwrap_or(TEXTURES[0])
}

fn of(pairs: &[(String, f64)], name: &str) -> Option<f64> {
    pairs.iter().find(|(own, _)| own == name).map(|(_, value)| *value)
}

fn set(pairs: &mut [(String, f64)], name: &str, value: f64) {
    pairs.iter_mut().filter(|(own, _)| own == name).for_each(|(_, own)| *own = value);
}

/// How many times as fast as its file says each of a world's movers is, after these draws of a run with these settings.
pub(crate) fn speeds_of_movers<'a>(
    settings: &Settings,
    drawn: &[f64],
    movers: &'a [Mover],
) -> impl Iterator<Item = f64> + use<'a> {
    let mut variation = Variation::new(settings, 0);
    variation.drawn.copy_from_slice(drawn);
    variation.set();
    let Variation { settings, touched, .. } = variation;
    movers.iter().map(move |mover| settings.movers.speed * touched.speed_of(&mover.name))
}

/// Each of the settings that a run's attempts may have at the ends of what is drawn: one key at its end, the others as they are.
pub(super) fn extremes(settings: &Settings) -> impl Iterator<Item = Settings> + '_ {
    settings.randomise.iter().flat_map(move |varied| {
        varied.extremes().map(move |drawn| {
            let mut extreme = Settings { randomise: Vec::new(), ..settings.clone() };
            if let Some((VariedKey::Setting(row), _)) = VariedKey::of(&varied.key) {
                let value = varied.value(drawn);
                let _ = apply(&mut extreme, row.group, row.key, &value);
                if let Value::Text(word) = &value
                    && RecoverTo::of(word) != Some(RecoverTo::Start)
                {
                    extreme.recovery.at = None;
                }
            }
            extreme
        })
    })
}
