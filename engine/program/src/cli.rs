//! The command line: names, defaults and help, no logic.

mod certify;
mod changes;
mod check;
mod export;
mod language;
mod new;
mod pack;
mod plugins;
mod recorded;
mod runs;
mod watch;

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

pub(crate) use certify::CertifyArguments;
pub(crate) use changes::{Changes, SettingChanges};
pub(crate) use check::{CheckArguments, CheckFormat};
pub(crate) use export::ExportArguments;
pub(crate) use language::{ReferenceArguments, UpgradeArguments};
pub(crate) use new::{NewArguments, NewCommand, WorldArguments, WorldCommand};
pub(crate) use pack::*;
pub(crate) use plugins::{PluginsArguments, PluginsCommand};
pub(crate) use recorded::{ExplainArguments, ReplayArguments, RescoreArguments};
pub(crate) use runs::{CompareArguments, RunsArguments, RunsCommand};
pub(crate) use watch::WatchArguments;

/// Learns visual robot behaviours from reward scripts: learned, tested and drawn in about a second.
#[derive(Debug, Parser)]
#[command(name = "engine", version, propagate_version = true)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Learn a behaviour, test the frozen policy, draw the results
    Run(RunArguments),
    /// Look a behaviour over before it is learned: mistakes, and ways to cheat its reward
    Check(CheckArguments),
    /// Test a learned policy again, in the same or another world
    Test(TestArguments),
    /// Bound how a learned policy does in worlds that nobody has seen, which are drawn for it
    Certify(CertifyArguments),
    /// Play a recorded run again and compare every step; with --verify, learn it again too
    Replay(ReplayArguments),
    /// Why a step was rewarded as it was, or what the code of an error means
    Explain(ExplainArguments),
    /// Runs beside one another: curves, figures with intervals and exact tests, states, settings, lines
    Compare(CompareArguments),
    /// Write a learned policy as C and Python for other programs, with a kit that checks them
    Export(ExportArguments),
    /// List the runs that stand here; tag and prune them
    Runs(RunsArguments),
    /// Judge a recorded run by another script, and show which states change their action
    Rescore(RescoreArguments),
    /// Learn again on every save, and show what changed and why on a page in the browser
    Watch(WatchArguments),
    /// Measure steps per second, and where the time goes
    Bench(BenchArguments),
    /// Measure the paper's figures and claims again, and draw them beside one another
    Reproduce(ReproduceArguments),
    /// See photographs as a behaviour's filters see them, and whether training met their states
    Filter(FilterArguments),
    /// List the filters that scripts can use, or print the manual of one
    Plugins(PluginsArguments),
    /// Write a new filter that builds, to change it into your own
    New(NewArguments),
    /// Worlds that are made by rule: write the file of one
    World(WorldArguments),
    /// Share a behaviour: one signed file that carries its own evidence
    Pack(PackArguments),
    /// Print the reference page of the script language, or the language as data
    Reference(ReferenceArguments),
    /// Write a script of an older edition for the newest one, so that it means what it meant
    Upgrade(UpgradeArguments),
    /// Serve one native filter to an engine that runs with --isolate; nothing for people
    #[command(hide = true)]
    FilterWorker(FilterWorkerArguments),
}

impl Command {
    pub(crate) fn wants_json(&self) -> bool {
        match self {
            Self::Run(arguments) => arguments.json,
            Self::Check(arguments) => arguments.format() == CheckFormat::Json,
            Self::Test(arguments) => arguments.json,
            Self::Certify(arguments) => arguments.json,
            Self::Replay(arguments) => arguments.json,
            Self::Explain(arguments) => arguments.json,
            Self::Compare(arguments) => arguments.json,
            Self::Export(arguments) => arguments.json,
            Self::Runs(arguments) => arguments.json,
            Self::Rescore(arguments) => arguments.json,
            Self::Watch(arguments) => arguments.json,
            Self::Bench(arguments) => arguments.json,
            Self::Reproduce(arguments) => arguments.json,
            Self::Filter(arguments) => arguments.json,
            Self::Plugins(arguments) => arguments.json,
            Self::Pack(arguments) => arguments.json,
            Self::Upgrade(arguments) => arguments.json,
            Self::New(_) | Self::World(_) | Self::Reference(_) | Self::FilterWorker(_) => false,
        }
    }
}

/// Exit status: 0 learned, 1 not good enough, 2 usage, 3 bad input file, 4 a limit stopped it, 6 files and disk, 130
/// stopped by Ctrl-C, 143 by SIGTERM, 129 by SIGHUP (what was learned is kept).
#[derive(Debug, Args)]
#[command(after_help = "Exit status: 0 learned; 1 not good enough; 2 usage; 3 bad input file; 4 a limit stopped it; \
                        5 refused for trust; 6 files and disk; 7 the checkpoint does not fit; 130 stopped by Ctrl-C, 143 \
                        by SIGTERM, 129 by SIGHUP, with what was learned kept for --resume.")]
pub(crate) struct RunArguments {
    /// The behaviour: a script such as scripts/wall.rhai, a .pack file, a pack's folder, or an installed pack's name
    #[arg(required_unless_present = "resume")]
    pub(crate) behaviour: Option<PathBuf>,
    /// The first seed
    #[arg(long, default_value = "1", value_parser = seed, allow_hyphen_values = true)]
    pub(crate) seed: u64,
    /// How many seeds to learn, from --seed on
    #[arg(long, default_value = "1", value_parser = count, allow_hyphen_values = true, value_name = "N")]
    pub(crate) seeds: u64,
    /// With --seeds: the share of the seeds that must succeed, 0 to 1; without it, more than half
    #[arg(long, value_parser = share, allow_hyphen_values = true, value_name = "SHARE")]
    pub(crate) enough: Option<f64>,
    /// How many threads to use; without it, one for each core
    #[arg(long, value_parser = count, allow_hyphen_values = true, value_name = "N")]
    pub(crate) threads: Option<u64>,
    /// How many steps to learn; without it, what the script says
    #[arg(long, value_parser = count, allow_hyphen_values = true, value_name = "N")]
    pub(crate) steps: Option<u64>,
    #[command(flatten)]
    pub(crate) changes: Changes,
    /// Go on from what a finished run had learned, in another world, under other rules or on another body with the same states
    /// and actions; of a run of many seeds, each seed from its own
    #[arg(long, value_name = "RUN")]
    pub(crate) from: Option<PathBuf>,
    /// Go on from a step of a finished run under this behaviour, which may have other rules, and show the first step that differs
    #[arg(long, value_name = "RUN@STEP", conflicts_with_all = ["from", "seed", "seeds"])]
    pub(crate) branch: Option<String>,
    /// Keep a checkpoint after so many steps each, from which --resume goes on [default: 200000]
    #[arg(long, value_parser = count, allow_hyphen_values = true, value_name = "N")]
    pub(crate) checkpoint: Option<u64>,
    /// Of a run of more than 1,048,576 steps: how many segments of its log are kept, from the first on, each of so many steps. The
    /// log's digest holds all steps, kept or not [default: all]
    #[arg(long, value_parser = count, allow_hyphen_values = true, value_name = "N", conflicts_with = "resume")]
    pub(crate) log_segments: Option<u64>,
    /// Go on with a run that was killed or stopped, as if nothing had happened: the folder that it was to have
    #[arg(long, value_name = "RUN", conflicts_with_all = ["behaviour", "seed", "seeds", "steps", "world", "set", "from", "branch", "out", "force"])]
    pub(crate) resume: Option<PathBuf>,
    /// The folder for the results [default: runs/BEHAVIOUR/SEED]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Replace another run in the folder: without it, such a run stays, and this one goes to the next number or is refused
    #[arg(long)]
    pub(crate) force: bool,
    /// Record learning and test for Foxglove or Rerun, as an MCAP file; of one seed
    #[arg(long, value_name = "FILE.mcap")]
    pub(crate) record: Option<PathBuf>,
    /// The steps from one recorded image to the next
    #[arg(long, default_value = "10", value_parser = count, allow_hyphen_values = true, value_name = "N")]
    pub(crate) record_every: u64,
    /// Look it over too, as engine check does: the findings and what the reward can be had for stand in report.html
    #[arg(long)]
    pub(crate) check: bool,
    /// Run a .pack file that is not signed
    #[arg(long)]
    pub(crate) allow_unsigned: bool,
    /// Print the summary as JSON on standard output, and nothing else there
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) filters: FilterSources,
}

#[derive(Debug, Args)]
#[command(
    after_help = "Exit status: 0 a success; 1 not good enough; 2 usage; 3 bad world or setting; 4 a limit stopped it; 5 refused \
                        for trust; 6 files and disk; 7 the stored run is damaged or does not fit; 130 stopped by Ctrl-C."
)]
pub(crate) struct TestArguments {
    /// The folder of a run, such as runs/wall/1; or a .pack file or an installed pack's name, for the policy that it carries
    pub(crate) run: PathBuf,
    #[command(flatten)]
    pub(crate) changes: Changes,
    /// Other worlds, equally likely, by name, path or rule, such as corridors:100-120; a comma stands between two
    #[arg(long, value_delimiter = ',', conflicts_with_all = ["world", "plain"], value_name = "WORLDS")]
    pub(crate) worlds: Vec<String>,
    /// Draw nothing: the home world, and no values of randomise
    #[arg(long)]
    pub(crate) plain: bool,
    /// The seed of the test; without it, that of the run
    #[arg(long, value_parser = seed, allow_hyphen_values = true)]
    pub(crate) seed: Option<u64>,
    /// How many steps to test; without it, what the script says
    #[arg(long, value_parser = count, allow_hyphen_values = true, value_name = "N")]
    pub(crate) steps: Option<u64>,
    /// A folder for the figures and pictures of the test; without it, nothing is written
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Replace a test that stands in that folder
    #[arg(long, requires = "out")]
    pub(crate) force: bool,
    /// Run a .pack file that is not signed
    #[arg(long)]
    pub(crate) allow_unsigned: bool,
    /// Print the figures as JSON on standard output, and nothing else there
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) filters: FilterSources,
}

#[derive(Debug, Args)]
#[command(after_help = "Exit status: 0 measured; 2 usage; 3 bad input file; 5 refused for trust; 6 files and disk.")]
pub(crate) struct BenchArguments {
    /// The behaviour whose step is measured
    #[arg(long, default_value = "scripts/wall.rhai")]
    pub(crate) behaviour: PathBuf,
    #[command(flatten)]
    pub(crate) changes: Changes,
    /// Another size of the image, such as 320x240
    #[arg(long, value_parser = size, value_name = "WIDTHxHEIGHT")]
    pub(crate) size: Option<(u64, u64)>,
    /// Another lens: pinhole or fisheye
    #[arg(long)]
    pub(crate) lens: Option<String>,
    /// Draw speckles (value noise, 15 cm, 6 grey levels) on the floor and on every plain surface, and add pixel noise of at
    /// least 2 grey levels
    #[arg(long)]
    pub(crate) texture: bool,
    /// Also measure how a step grows with boxes out of sight, states, pixels and threads (takes a minute)
    #[arg(long)]
    pub(crate) growth: bool,
    /// With --growth: the folder for growth.svg and growth.png
    #[arg(long, requires = "growth", value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Only learn so many steps, for programs that count instructions
    #[arg(long, hide = true, value_parser = count, value_name = "N")]
    pub(crate) count_steps: Option<u64>,
    /// How many steps each figure is measured over, 1200 or more; times are those of the processor, so that other programs
    /// disturb little
    #[arg(long, default_value = "20000", value_parser = count, allow_hyphen_values = true, value_name = "N")]
    pub(crate) steps: u64,
    /// Print the figures as JSON on standard output, and nothing else there
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) filters: FilterSources,
}

#[derive(Debug, Args)]
#[command(after_help = "Exit status: 0 done; 2 usage; 6 files and disk; 130 stopped by Ctrl-C.")]
pub(crate) struct ReproduceArguments {
    /// How many seeds, from --seed on; long jobs take fewer and say so
    #[arg(long, default_value = "30", value_parser = count, allow_hyphen_values = true, value_name = "N")]
    pub(crate) seeds: u64,
    /// The first seed
    #[arg(long, default_value = "2000", value_parser = seed, allow_hyphen_values = true)]
    pub(crate) seed: u64,
    /// How many threads to use; without it, one for each core
    #[arg(long, value_parser = count, allow_hyphen_values = true, value_name = "N")]
    pub(crate) threads: Option<u64>,
    /// Two seeds and few steps, to see that every row computes; the verdicts mean nothing
    #[arg(long)]
    pub(crate) quick: bool,
    /// Only this row, such as wall-learned; may be given again
    #[arg(long, value_name = "ROW")]
    pub(crate) only: Vec<String>,
    /// The folder for reproduce.html and reproduce.json
    #[arg(long, default_value = "runs/reproduce", value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// The folder of the scripts
    #[arg(long, default_value = "scripts", value_name = "DIR")]
    pub(crate) scripts: PathBuf,
    /// Print the rows as a Markdown table
    #[arg(long)]
    pub(crate) markdown: bool,
    /// Print the rows as JSON on standard output, and nothing else there
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
#[command(
    after_help = "Exit status: 0 done; 1 too many new states, or one state for nearly all of five images or more; 2 usage; 3 bad script or image; 6 files and disk; \
                        7 a stored run that does not fit."
)]
pub(crate) struct FilterArguments {
    /// The behaviour: a script such as scripts/wall.rhai, a .pack file, a pack's folder, or an installed pack's name
    pub(crate) behaviour: PathBuf,
    /// PNG or JPEG files, or folders of them; at most 64 MiB and 50 megapixels each. For a filter that reads depth: PNG files of
    /// 16 bits in millimetres, 0 where nothing was measured
    #[arg(required = true)]
    pub(crate) image: Vec<PathBuf>,
    /// The view to see through, of a script that has several; the first one otherwise
    #[arg(long, value_name = "NAME")]
    pub(crate) view: Option<String>,
    /// The folder of a run: says which states its training met
    #[arg(long, value_name = "RUN")]
    pub(crate) run: Option<PathBuf>,
    /// The share of images with new states above which the exit status is 1
    #[arg(long, default_value = "0.2", value_parser = share, allow_hyphen_values = true, value_name = "SHARE")]
    pub(crate) new_share: f64,
    #[command(flatten)]
    pub(crate) changes: SettingChanges,
    /// The folder for the pictures [default: runs/BEHAVIOUR/filter]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Print one object for each image as JSON on standard output, and nothing else there
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) filters: FilterSources,
}

/// Where filters come from, besides those linked in.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Filters from elsewhere")]
pub(crate) struct FilterSources {
    /// A folder of native or WebAssembly filters; may be given again
    #[arg(global = true, long, value_name = "DIR")]
    pub(crate) filter_dir: Vec<PathBuf>,
    /// Let one native library be loaded, with all rights that you have; may be given again
    #[arg(global = true, long, value_name = "sha256:DIGEST")]
    pub(crate) allow_native: Vec<String>,
    /// A file that allows native libraries: native = ["sha256:..."] [default: trust.toml in ~/.config/engine, if there]
    #[arg(global = true, long, value_name = "FILE")]
    pub(crate) trust: Option<PathBuf>,
    /// Run each native filter in a process of its own, so that its crash or endless loop ends only itself
    #[arg(global = true, long)]
    pub(crate) isolate: bool,
}

#[derive(Debug, Args)]
pub(crate) struct FilterWorkerArguments {
    /// The library
    pub(crate) library: PathBuf,
    /// Its digest
    #[arg(long, value_name = "sha256:DIGEST")]
    pub(crate) allow_native: String,
}

fn seed(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_| format!("a seed is a whole number from 0 to {}", u64::MAX))
}

fn count(text: &str) -> Result<u64, String> {
    match text.parse() {
        Ok(count) if (1..=1_000_000_000).contains(&count) => Ok(count),
        _ => Err("write a whole number from 1 to 1000000000".to_owned()),
    }
}

fn size(text: &str) -> Result<(u64, u64), String> {
    let parts = text.split_once('x').map(|(width, height)| (width.parse(), height.parse()));
    match parts {
        Some((Ok(width), Ok(height))) => Ok((width, height)),
        _ => Err("write the width and the height in pixels, such as 320x240".to_owned()),
    }
}

fn share(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(share) if (0.0..=1.0).contains(&share) => Ok(share),
        _ => Err("write a number from 0 to 1, such as 0.2".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn every_command_says_its_exit_statuses() {
        fn silent(command: &clap::Command) -> Vec<String> {
            let all = command.get_subcommands().filter(|one| !one.is_hide_set() && one.get_name() != "help");
            all.flat_map(|one| {
                let told = one.get_after_help().is_some_and(|help| help.to_string().contains("Exit status: 0 "));
                (!told).then(|| one.get_name().to_owned()).into_iter().chain(silent(one))
            })
            .collect()
        }
        assert_eq!(silent(&Cli::command()), Vec::<String>::new());
    }

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }
}
