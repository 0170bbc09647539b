//! Arguments of `engine certify`.

use std::path::PathBuf;

use clap::Args;

use super::{FilterSources, SettingChanges, count, seed};

#[derive(Debug, Args)]
#[command(
    after_help = "Exit status: 0 better than a robot that knows nothing, by more than chance, and the bound is reached; 1 not good \
                        enough; 2 usage; 3 bad world or setting; 4 a limit stopped it; 5 refused for trust; 6 files and disk; 7 \
                        the stored run is damaged, or --again came out otherwise; 130 stopped by Ctrl-C, which states nothing."
)]
pub(crate) struct CertifyArguments {
    /// The folder of a run, such as runs/wall/1; or a .pack file or an installed pack's name, for the policy that it carries
    pub(crate) run: PathBuf,
    /// What worlds are drawn from: a family (rooms, corridors, lines), some of it (rooms:100-120), or worlds by name or path; a comma
    /// stands between two [default: the family of the run's own worlds, and none that it learned in]
    #[arg(long, value_delimiter = ',', value_name = "WORLDS")]
    pub(crate) worlds: Vec<String>,
    /// How many worlds and seeds to draw [default: 1000, or as many as --bound needs]
    #[arg(long, value_parser = draws, allow_hyphen_values = true, value_name = "N")]
    pub(crate) draws: Option<u64>,
    /// Steps of each test; without it, what the script says
    #[arg(long, value_parser = count, allow_hyphen_values = true, value_name = "N")]
    pub(crate) steps: Option<u64>,
    /// Failures in 1,000 steps: so many draws that the upper bound comes below it, as far as a pilot of 100 other draws can tell
    #[arg(long, value_parser = failures, allow_hyphen_values = true, value_name = "FAILURES")]
    pub(crate) bound: Option<f64>,
    /// What the draws are drawn by; without it a number that is made of the policy, so that nobody can tune on these worlds
    #[arg(long, value_parser = seed, allow_hyphen_values = true)]
    pub(crate) seed: Option<u64>,
    #[command(flatten)]
    pub(crate) changes: SettingChanges,
    /// Draw the certificate in the run's folder again, and compare every figure; with --seed, draw others and show both
    #[arg(long, conflicts_with_all = ["worlds", "draws", "steps", "bound", "set", "out", "force"])]
    pub(crate) again: bool,
    /// How many threads to use; without it, one for each core
    #[arg(long, value_parser = count, allow_hyphen_values = true, value_name = "N")]
    pub(crate) threads: Option<u64>,
    /// The folder for certificate.json and the picture [default: that of the run; of a pack, nothing is written]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Replace a certificate that stands there
    #[arg(long)]
    pub(crate) force: bool,
    /// Take a .pack file that is not signed
    #[arg(long)]
    pub(crate) allow_unsigned: bool,
    /// Print the certificate as JSON on standard output, and nothing else there
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) filters: FilterSources,
}

fn draws(text: &str) -> Result<u64, String> {
    let most = engine::experiment::MOST_DRAWS;
    count(text).ok().filter(|draws| (2..=most).contains(draws)).ok_or(format!("write a whole number from 2 to {most}"))
}

fn failures(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|failures: &f64| *failures > 0.0 && *failures <= 1000.0);
    number.ok_or("write a number of failures in 1,000 steps above 0, such as 1.0".to_owned())
}
