//! What the commands about the script language take.

use std::path::PathBuf;

use clap::Args;

#[derive(Debug, Args)]
#[command(after_help = "Exit status: 0 printed; 2 usage; 6 standard output cannot be written.")]
pub(crate) struct ReferenceArguments {
    /// Print definitions for editors (.d.rhai) instead of the page
    #[arg(long)]
    pub(crate) definitions: bool,
    /// Print the language as data for tools (JSON) instead of the page
    #[arg(long, conflicts_with = "definitions")]
    pub(crate) json: bool,
    /// Print a TextMate grammar for the colours of an editor (JSON) instead of the page
    #[arg(long, conflicts_with_all = ["definitions", "json"])]
    pub(crate) grammar: bool,
}

#[derive(Debug, Args)]
#[command(after_help = "Exit status: 0 done; 2 usage; 3 bad script; 4 script limit; 6 files and disk.")]
pub(crate) struct UpgradeArguments {
    /// The script
    pub(crate) script: PathBuf,
    /// Change the file; without it the change is only shown
    #[arg(long)]
    pub(crate) write: bool,
    /// Print what changes as JSON
    #[arg(long)]
    pub(crate) json: bool,
}
