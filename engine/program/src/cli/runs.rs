//! The arguments of `engine compare` and `engine runs`.

use std::path::PathBuf;

use clap::{Args, Subcommand};

use super::FilterSources;

#[derive(Debug, Args)]
#[command(
    after_help = "Exit status: 0 compared; 2 usage; 3 not two runs; 6 files and disk; 7 a folder that is no finished run."
)]
pub(crate) struct CompareArguments {
    /// The folders of two runs or more, of one seed or of many, such as runs/wall/1-30; each is held against the first
    #[arg(required = true, num_args = 1.., value_name = "RUN")]
    pub(crate) runs: Vec<PathBuf>,
    /// The folder for compare.html and compare.json
    #[arg(long, default_value = "runs/compare", value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Print the figures as JSON on standard output, and nothing else there
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) filters: FilterSources,
}

const RUNS_STATUS: &str = "Exit status: 0 done; 2 usage; 6 files and disk; 7 a folder that is no run.";

#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true)]
#[command(after_help = RUNS_STATUS)]
pub(crate) struct RunsArguments {
    #[command(subcommand)]
    pub(crate) command: Option<RunsCommand>,
    /// Where the runs stand
    #[arg(default_value = "runs", value_name = "DIR")]
    pub(crate) folder: PathBuf,
    /// Print the list as JSON on standard output, and nothing else there
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Subcommand)]
pub(crate) enum RunsCommand {
    /// Put a word on a run, so that it is found again and kept
    #[command(after_help = RUNS_STATUS)]
    Tag {
        /// The folder of a run, such as runs/wall/1
        run: PathBuf,
        /// The word, such as best; without one, the run has no tag any more
        tag: Option<String>,
    },
    /// Remove runs without a tag; without --yes, only say which
    #[command(after_help = RUNS_STATUS)]
    Prune {
        /// Where the runs stand
        #[arg(default_value = "runs", value_name = "DIR")]
        folder: PathBuf,
        /// Only those that were written more than so many days ago
        #[arg(long, value_name = "DAYS")]
        older: Option<u64>,
        /// Only those that are no success
        #[arg(long)]
        failed: bool,
        /// Remove them
        #[arg(long)]
        yes: bool,
    },
}
