//! The arguments of `engine check`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::{Changes, FilterSources};

/// How findings are printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum CheckFormat {
    /// Each with its line, a caret and a way out, then what cheats earn
    Text,
    /// One line each: file:line:column: code message
    Short,
    /// One object with findings and figures
    Json,
    /// SARIF 2.1.0, as code hosts and editors read it
    Sarif,
}

impl CheckArguments {
    /// The format, whichever way it was asked for.
    pub(crate) fn format(&self) -> CheckFormat {
        if self.json { CheckFormat::Json } else { self.format }
    }
}

#[derive(Debug, Args)]
#[command(after_help = "Exit status: 0 nothing found; 1 errors or warnings; 2 usage; 3 it does not load; \
                        4 a limit stopped it; 6 files and disk. 'engine explain CODE' prints the page of a code.")]
pub(crate) struct CheckArguments {
    /// The behaviour: a script such as scripts/wall.rhai, a .pack file, a pack's folder, or an installed pack's name
    pub(crate) behaviour: PathBuf,
    #[command(flatten)]
    pub(crate) changes: Changes,
    /// How to print what is found
    #[arg(long, value_enum, default_value = "text", value_name = "FORMAT")]
    pub(crate) format: CheckFormat,
    /// Print findings and figures as JSON on standard output, and nothing else there: the same as --format json
    #[arg(long, conflicts_with = "format")]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) filters: FilterSources,
}
