//! The arguments of `engine check`.

use std::path::PathBuf;

use clap::Args;

use super::FilterSources;

#[derive(Debug, Args)]
#[command(after_help = "Exit status: 0 nothing found; 1 errors or warnings; 2 usage; 3 it does not load; \
                        4 a limit stopped it; 6 files and disk. 'engine explain CODE' prints the page of a code.")]
pub(crate) struct CheckArguments {
    /// The behaviour: a script such as scripts/wall.rhai, a .pack file, a pack's folder, or an installed pack's name
    pub(crate) behaviour: PathBuf,
    /// Another world: its name, or the path of a world file
    #[arg(long)]
    pub(crate) world: Option<String>,
    /// Change a setting of the script, such as camera.tilt_deg=40; may be given again
    #[arg(long, value_name = "KEY=VALUE")]
    pub(crate) set: Vec<String>,
    /// Print findings and figures as JSON on standard output, and nothing else there
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) filters: FilterSources,
}
