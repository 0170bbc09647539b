//! The command line of `engine watch`.

use std::path::PathBuf;

use clap::Args;

use super::{Changes, FilterSources, count, seed};

#[derive(Debug, Args)]
#[command(
    after_help = "The page is served on this computer only, at an address with a secret; nobody else can open it. \
                        A script that is saved with a mistake ends nothing: the page shows the error until the next save.\n\
                        With --keep, a swap of the reward stands in the log of the run, so that engine replay DIR --verify \
                        does it again.\n\
                        With --tui the terminal shows it too: the error in place, the last good run above it.\n\
                        Exit status: 0 ended with Ctrl-C or q; 2 usage; 3 bad script to begin with; 4 no free port; \
                        5 refused for trust; 6 files and disk."
)]
// Without the feature nothing reads them.
#[cfg_attr(not(feature = "serve"), allow(dead_code))]
pub(crate) struct WatchArguments {
    /// The behaviour's script, such as scripts/wall.rhai
    pub(crate) behaviour: PathBuf,
    /// The first seed
    #[arg(long, default_value = "1", value_parser = seed, allow_hyphen_values = true)]
    pub(crate) seed: u64,
    /// How many seeds to learn on each save, from --seed on
    #[arg(long, default_value = "30", value_parser = seeds, allow_hyphen_values = true, value_name = "N")]
    pub(crate) seeds: u64,
    /// How many threads to use; without it, one for each core
    #[arg(long, value_parser = count, allow_hyphen_values = true, value_name = "N")]
    pub(crate) threads: Option<u64>,
    /// How many steps to learn; without it, what the script says
    #[arg(long, value_parser = count, allow_hyphen_values = true, value_name = "N")]
    pub(crate) steps: Option<u64>,
    /// On a save that changes only the reward, learn on from where the robots are instead of from nothing; of what they
    /// learned, keep all, let it decay by half, or reset it
    #[arg(long, value_name = "HOW", num_args = 0..=1, require_equals = true, default_missing_value = "keep",
          value_parser = ["keep", "decay", "reset"])]
    pub(crate) keep: Option<String>,
    /// Write each finished run to this folder, as engine run does; with --keep it is runs/BEHAVIOUR/watch without this
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Replace whatever run stands in that folder; without this, only an older one of the same script and the same seeds
    #[arg(long)]
    pub(crate) force: bool,
    #[command(flatten)]
    pub(crate) changes: Changes,
    /// The port of the page; the next free one if it is taken, any for 0
    #[arg(long, default_value = "8400", value_name = "N")]
    pub(crate) port: u16,
    /// Show the same in this terminal too, and open no browser; ? lists the keys, q ends
    #[arg(long, conflicts_with = "json")]
    pub(crate) tui: bool,
    /// Do not open the browser
    #[arg(long)]
    pub(crate) no_open: bool,
    /// Print the address as JSON on standard output, and nothing else there
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) filters: FilterSources,
}

/// All seeds stay in memory with every step.
fn seeds(text: &str) -> Result<u64, String> {
    count(text).ok().filter(|seeds| *seeds <= 300).ok_or_else(|| "write a whole number from 1 to 300".to_owned())
}
