//! The command line of `engine plugins`.

use clap::{Args, Subcommand};

use super::FilterSources;

const PLUGINS_STATUS: &str = "Exit status: 0 done; 2 usage; 3 there is no such filter, or it breaks the law of filters; \
                              5 refused for trust; 6 files and disk.";

#[derive(Debug, Args)]
#[command(after_help = PLUGINS_STATUS)]
pub(crate) struct PluginsArguments {
    #[command(subcommand)]
    pub(crate) command: Option<PluginsCommand>,
    /// Print as JSON on standard output, and nothing else there
    #[arg(long, global = true)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) filters: FilterSources,
}

#[derive(Debug, Subcommand)]
pub(crate) enum PluginsCommand {
    /// Print the manual of one filter
    #[command(after_help = PLUGINS_STATUS)]
    Show {
        /// The filter's name, such as sobel
        name: String,
    },
    /// Try whether a filter keeps the law of filters, over many frames and settings
    #[command(after_help = PLUGINS_STATUS)]
    Check {
        /// The filter's name, such as sobel
        name: String,
    },
}
