//! Arguments of `engine export`.

use std::path::PathBuf;

use clap::Args;

use super::FilterSources;

#[derive(Debug, Args)]
#[command(
    after_help = "Exit status: 0 done; 2 usage; 3 the behaviour has no port; 6 files and disk; 7 the stored run is damaged or \
                        does not fit."
)]
pub(crate) struct ExportArguments {
    /// The folder of one seed's run, such as runs/wall/1
    pub(crate) run: PathBuf,
    /// The folder for the files
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Replace what stands there, if an export wrote it
    #[arg(long)]
    pub(crate) force: bool,
    /// Print as JSON on standard output, and nothing else there
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) filters: FilterSources,
}
