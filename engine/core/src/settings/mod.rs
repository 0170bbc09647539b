//! What a behaviour sets up: plain numbers and names, as written, each with one default.
//!
//! Nothing here opens a file or knows a script. [`SETTINGS`] is the one list of settings: the set-up calls of scripts,
//! `--set`, `run.toml`, range checks and the reference page all read it.

mod body;
mod body_file;
mod body_keys;
mod defaults;
mod drive;
mod edition;
mod fan;
mod shipped_bodies;
mod table;
mod variation;
mod views;
mod words;

use crate::geometry::Twist;
pub use body::{BodyShape, Footprint};
pub(crate) use body_file::{MAX_ACTIONS, read_body};
pub use drive::{Bicycle, DriveLimits};
pub use edition::Edition;
pub use fan::ScanFan;
pub(crate) use shipped_bodies::{SHIPPED_BODIES, shipped_body};
pub use table::{SETTINGS, Setting, SettingError, SettingShape, Value, apply};
pub use variation::{DrawnFrom, TEXTURES, Varied, VariedKey, WorldShare};
pub use views::{CONDITION, FilterSettings, GridSettings, PartSettings, UNNAMED_VIEW, ViewSettings};
pub use words::{CombineWay, LearnerKind, Lens, RecoverTo};

/// Everything that a run needs besides its seed.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Name of a world, or path of a world file.
    pub world: String,
    /// Several worlds with their weights, in the order in which they are drawn; empty for the one above.
    pub worlds: Vec<WorldShare>,
    /// What is drawn anew for each attempt, in this order.
    pub randomise: Vec<Varied>,
    /// How the robot looks at the image: the unnamed view, or the first one that a script names.
    pub view: ViewSettings,
    /// The views after the first, in the order of the script.
    pub further_views: Vec<ViewSettings>,
    /// What a state is made of, the lowest digit first; empty for the product of all views. Stages are added to either.
    pub state: Vec<PartSettings>,
    /// The actions that the learner chooses from.
    pub actions: Vec<Twist>,
    /// Length and rhythm of a run.
    pub run: RunSettings,
    /// The robot's body and motion.
    pub robot: RobotSettings,
    /// The camera and its mount.
    pub camera: CameraSettings,
    /// The laser and its mount.
    pub laser: LaserSettings,
    /// The sensors that look down.
    pub ground: GroundSettings,
    /// The way of learning and its parameters.
    pub learner: LearnerSettings,
    /// What `then recover` does.
    pub recovery: RecoverySettings,
    /// What drives by itself.
    pub movers: MoverSettings,
    /// Where attempts begin.
    pub starts: StartSettings,
    /// What the robot can be about, the first one first; empty for a behaviour without stages.
    pub stages: Vec<String>,
    /// Learned policies to combine, in the order of the script; empty for a behaviour that learns.
    pub policies: Vec<PolicySettings>,
    /// How they are combined.
    pub combine: CombineSettings,
}

/// A learned policy that a script names.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PolicySettings {
    /// What the script calls it.
    pub name: String,
    /// Its file or the folder of its run, as written.
    pub path: String,
}

/// Length and rhythm of a run.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs, reason = "every field is documented in the table of settings")]
pub struct RunSettings {
    pub steps: u64,
    pub test_steps: u64,
    pub period_s: f64,
    pub stay_steps: u64,
}

/// A robot's body and motion.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(missing_docs, reason = "the other fields are documented in the table of settings")]
pub struct RobotSettings {
    /// Its body.
    pub body: BodyShape,
    /// What its drive can do.
    pub drive: DriveLimits,
    pub lag_s: f64,
    pub speed_noise: f64,
    pub slip: f64,
    pub tick_s: f64,
}

/// The camera and its mount.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs, reason = "every field is documented in the table of settings")]
pub struct CameraSettings {
    pub width_px: u64,
    pub height_px: u64,
    pub field_of_view_deg: f64,
    pub lens: Lens,
    pub forward_m: f64,
    pub height_m: f64,
    pub tilt_deg: f64,
    pub noise: f64,
    pub exposure_drift: f64,
    pub white_balance_drift: f64,
    pub own_body: bool,
    pub depth: bool,
    pub depth_noise: f64,
    pub depth_holes: f64,
    pub deck_m: f64,
    /// What becomes of the light that a world file says.
    pub light: LightSettings,
}

/// What becomes of the light that a world file says.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(missing_docs, reason = "every field is documented in the table of settings")]
pub struct LightSettings {
    pub gain: f64,
    pub ambient: f64,
    pub turn_deg: f64,
    pub raise_deg: f64,
    pub shadows: bool,
    pub softness_deg: f64,
}

/// The laser and its mount.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs, reason = "every field is documented in the table of settings")]
pub struct LaserSettings {
    pub beams: u64,
    pub field_of_view_deg: f64,
    pub forward_m: f64,
    pub height_m: f64,
    pub tilt_deg: f64,
    pub min_range_m: f64,
    pub max_range_m: f64,
    pub noise_m: f64,
}

impl LaserSettings {
    /// Where its beams look.
    #[must_use]
    pub fn fan(&self) -> ScanFan {
        ScanFan { beams: self.beams as usize, view_deg: self.field_of_view_deg }
    }
}

/// Three sensors that look down at the ground.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs, reason = "every field is documented in the table of settings")]
pub struct GroundSettings {
    pub ahead_m: f64,
    pub aside_m: f64,
}

/// The way of learning and its parameters (Table 1 of the paper).
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs, reason = "every field is documented in the table of settings")]
pub struct LearnerSettings {
    pub kind: LearnerKind,
    pub step_size: f64,
    pub discount: f64,
    pub trace_decay: f64,
    pub window: u64,
    pub temperature: f64,
    pub temperature_end: f64,
    pub cooling_visits: u64,
    pub initial_low: f64,
    pub initial_high: f64,
    pub failure_is_terminal: bool,
    pub mirror: bool,
    pub replay: u64,
    pub memory_steps: u64,
    pub memory_discount: f64,
    pub memory_lambda: f64,
}

impl LearnerSettings {
    /// How much the next value counts for the learner that is set (gamma).
    #[must_use]
    pub const fn gamma(&self) -> f64 {
        match self.kind {
            LearnerKind::Memory => self.memory_discount,
            _ => self.discount,
        }
    }

    /// Why the learner that is set does not read a setting of learning, and what to write instead; nothing if it does.
    #[must_use]
    pub fn unread(&self, key: &str) -> Option<(String, &'static str)> {
        let of_memory = key.starts_with("memory_");
        match self.kind {
            _ if ["kind", "failure_is_terminal", "mirror"].contains(&key) => None,
            LearnerKind::Memory if of_memory => None,
            LearnerKind::Memory => {
                let instead = match key {
                    "discount" => "write memory_discount",
                    "trace_decay" => "write memory_lambda",
                    _ => "take it out, or write learner(\"ttd\", ...)",
                };
                Some((format!("learner \"memory\" has no {key}"), instead))
            }
            kind if of_memory => {
                let why = format!("learner \"{}\" remembers no steps", kind.word());
                Some((why, "take it out, or write learner(#{ kind: \"memory\" })"))
            }
            _ => None,
        }
    }
}

/// What `then recover` does.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs, reason = "every field is documented in the table of settings")]
pub struct RecoverySettings {
    pub to: RecoverTo,
    /// The name of a start: that one only, where `to` is a start.
    pub at: Option<String>,
    pub distance_m: f64,
    pub position_m: f64,
    pub yaw_deg: f64,
}

/// Where attempts begin, of a script that lists its starts.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StartSettings {
    /// The names of the world's starts, in the order in which they join; empty for all.
    pub names: Vec<String>,
    /// Of twenty attempts, the share that must go well before the next start joins; nothing if all are used at once.
    pub widen: Option<f64>,
}

/// What drives by itself.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs, reason = "every field is documented in the table of settings")]
pub struct MoverSettings {
    pub speed: f64,
}

/// How several policies become one.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs, reason = "every field is documented in the table of settings")]
pub struct CombineSettings {
    pub way: CombineWay,
    pub margin: f64,
    pub scaled: bool,
}

impl Settings {
    /// These settings, but where a script's own changed `from` one `to` another they change too.
    #[must_use]
    pub(crate) fn following(mut self, from: &Self, to: &Self) -> Self {
        for row in SETTINGS.iter().filter(|row| (row.get)(from) != (row.get)(to)) {
            // What the other has is within its range.
            let _ = apply(&mut self, row.group, row.key, &(row.get)(to));
        }
        if from.world != to.world {
            self.world.clone_from(&to.world);
        }
        if from.worlds != to.worlds {
            self.worlds.clone_from(&to.worlds);
        }
        if from.randomise != to.randomise {
            self.randomise.clone_from(&to.randomise);
        }
        if from.view.filters != to.view.filters {
            self.view.filters.clone_from(&to.view.filters);
        }
        if from.further_views != to.further_views {
            self.further_views.clone_from(&to.further_views);
        }
        if from.actions != to.actions {
            self.actions.clone_from(&to.actions);
        }
        self
    }
}
