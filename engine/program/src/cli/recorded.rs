//! Arguments of the commands that read a recorded run.

use std::path::PathBuf;

use clap::Args;

use super::{FilterSources, count};

#[derive(Debug, Args)]
#[command(
    after_help = "Exit status: 0 every step is the recorded one; 2 usage; 6 files and disk; 7 something differs, or \
                        the stored run is damaged."
)]
pub(crate) struct ReplayArguments {
    /// The folder of one seed's run, such as runs/wall/1
    pub(crate) run: PathBuf,
    /// Learn, test and draw again from the seed alone, and compare every step, figure and file
    #[arg(long)]
    pub(crate) verify: bool,
    /// The steps of the test instead of those of learning
    #[arg(long, conflicts_with = "verify")]
    pub(crate) test: bool,
    /// List the steps from this one on, counted from 0
    #[arg(long, value_parser = step, allow_hyphen_values = true, value_name = "N", conflicts_with = "verify")]
    pub(crate) from: Option<usize>,
    /// List the steps up to this one; without it, 20 steps
    #[arg(long, value_parser = step, allow_hyphen_values = true, value_name = "N", requires = "from")]
    pub(crate) to: Option<usize>,
    /// Print as JSON on standard output, and nothing else there
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) filters: FilterSources,
}

#[derive(Debug, Args)]
#[command(after_help = "Exit status: 0 done; 2 usage; 6 files and disk; 7 the stored run is damaged or does not fit.")]
pub(crate) struct ExplainArguments {
    /// The folder of one seed's run, such as runs/wall/1; or a code, such as E-SCRIPT-FACT
    pub(crate) topic: String,
    /// The step of the run, counted from 0
    #[arg(long, value_parser = step, allow_hyphen_values = true, value_name = "N")]
    pub(crate) step: Option<usize>,
    /// A step of the test instead of one of learning
    #[arg(long)]
    pub(crate) test: bool,
    /// The folder for the pictures [default: that of the run]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Print as JSON on standard output, and nothing else there
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) filters: FilterSources,
}

#[derive(Debug, Args)]
#[command(
    after_help = "Exit status: 0 done; 2 usage; 3 bad script; 6 files and disk; 7 the stored run is damaged, or \
                        the script needs other steps than it has."
)]
pub(crate) struct RescoreArguments {
    /// The folder of one seed's run, such as runs/wall/1
    pub(crate) run: PathBuf,
    /// The script with the other rules
    pub(crate) script: PathBuf,
    /// How often to go over the recorded steps: 1 is what the run's own learner would have learned from them; more
    /// is one-step Q-learning until the values settle, with 50 or so
    #[arg(long, default_value = "1", value_parser = passes, allow_hyphen_values = true, value_name = "N")]
    pub(crate) passes: u64,
    /// The folder for rescore.json and the pictures [default: RUN/rescore-SCRIPT]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Print as JSON on standard output, and nothing else there
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) filters: FilterSources,
}

fn step(text: &str) -> Result<usize, String> {
    text.parse().map_err(|_| "a step is a whole number, counted from 0".to_owned())
}

fn passes(text: &str) -> Result<u64, String> {
    count(text).ok().filter(|passes| *passes <= 1000).ok_or_else(|| "write a whole number from 1 to 1000".to_owned())
}
