//! What a command line changes in a behaviour.

use clap::Args;
use engine::experiment::Overrides;

/// Another world, and other settings than the script's.
#[derive(Debug, Clone, Args)]
pub(crate) struct Changes {
    /// Another world: its name, or the path of a world file
    #[arg(long)]
    pub(crate) world: Option<String>,
    #[command(flatten)]
    settings: SettingChanges,
}

/// Other settings than the script's.
#[derive(Debug, Clone, Args)]
pub(crate) struct SettingChanges {
    /// Change a setting of the script, such as camera.noise=8; may be given again
    #[arg(long, value_name = "KEY=VALUE")]
    pub(crate) set: Vec<String>,
}

impl Changes {
    /// The settings, as they were typed.
    pub(crate) fn set(&self) -> &[String] {
        &self.settings.set
    }

    /// These changes and no others.
    pub(crate) fn overrides(&self) -> Overrides {
        Overrides { world: self.world.clone(), ..self.settings.overrides() }
    }
}

impl SettingChanges {
    /// These changes and no others.
    pub(crate) fn overrides(&self) -> Overrides {
        Overrides { set: self.set.clone(), ..Overrides::default() }
    }
}
