//! Arguments of the commands that write something to begin with.

use std::path::PathBuf;

use clap::{Args, Subcommand};

/// Of all that write something to begin with.
const NEW_STATUS: &str = "Exit status: 0 written; 2 usage; 3 there is no such thing; 6 files and disk.";

#[derive(Debug, Args)]
#[command(after_help = NEW_STATUS)]
pub(crate) struct NewArguments {
    #[command(subcommand)]
    pub(crate) what: NewCommand,
}

#[derive(Debug, Subcommand)]
pub(crate) enum NewCommand {
    /// Write a filter as a crate of its own, with the contract beside it
    #[command(after_help = NEW_STATUS)]
    Filter {
        /// The filter's name: lower case letters, digits and _
        name: String,
        /// The folder to write into [default: the name]
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
    },
}

#[derive(Debug, Args)]
#[command(after_help = NEW_STATUS)]
pub(crate) struct WorldArguments {
    #[command(subcommand)]
    pub(crate) what: WorldCommand,
}

#[derive(Debug, Subcommand)]
pub(crate) enum WorldCommand {
    /// Write the file of a world made by rule, to look at it or to change it
    #[command(after_help = NEW_STATUS)]
    New {
        /// The world, such as corridors:7; the families are rooms, corridors and lines
        world: String,
        /// The file to write [default: corridors-7.toml]
        #[arg(long, value_name = "FILE")]
        out: Option<PathBuf>,
    },
}
