//! `engine run`: learn or combine, test, draw.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use engine::diagnostic::{Diagnostic, Result};
use engine::experiment::{
    Overrides, Phase, Plan, Progress, RunLog, Spread, WINDOW_STEPS, in_parallel, run_only_seed, run_seed,
};
use insight::folder::{IfTaken, RunFolder, SeedResult};
use insight::record::{check_recording, record};
use insight::store::going_on_from;
use insight::words::short;
use pack::Runnable;

use super::check;
use super::print::{one_line, print_many, print_one};
use super::sources::catalogue;
use super::stop::{INTERRUPTED, on_ctrl_c};
use crate::cli::RunArguments;
use crate::console::{Console, ConsoleError};

pub(crate) fn run(arguments: &RunArguments, console: &mut Console) -> std::result::Result<u8, ConsoleError> {
    let overrides = Overrides { steps: arguments.steps, ..arguments.changes.overrides() };
    let Runnable { plan, unpacked: _unpacked } =
        super::behaviour::open(&arguments.behaviour, &overrides, &arguments.filters, arguments.allow_unsigned)?;
    let seeds = seeds(arguments)?;
    check_learning(arguments, &plan)?;
    let plan = match &arguments.from {
        Some(from) => going_on_from(plan, from, &seeds, &catalogue(&arguments.filters)?)?,
        None => plan,
    };
    if let Some(path) = &arguments.record {
        check_record(path, &seeds)?;
    }
    let if_taken = match (arguments.force, &arguments.out) {
        (true, _) => IfTaken::Replace,
        (false, Some(_)) => IfTaken::Refuse,
        (false, None) => IfTaken::Number,
    };
    let wanted = out(arguments, plan.behaviour.name(), &seeds);
    let folder = RunFolder::create(&wanted, &plan, &seeds, if_taken)?;
    if folder.path() != wanted {
        console.note(&format!("'{}' holds another run, which stays: see 'results' below", wanted.display()));
    }

    let stop = on_ctrl_c()?;
    let threads = arguments.threads.unwrap_or(0) as usize;
    let results = run_all(&plan, &folder, &seeds, threads, &stop, console)?;
    let checked = if arguments.check { check::beside_a_run(&plan, threads, &stop, console) } else { None };
    folder.write(&plan, &results, checked.as_ref())?;
    if let (Some(path), [SeedResult { log: Some(log), .. }]) = (&arguments.record, results.as_slice()) {
        record_run(arguments, &plan, log, path, console)?;
    }
    let good = if let [result] = results.as_slice() {
        console.json(&result.run.summary)?;
        print_one(console, &plan, &result.run.summary)?;
        result.run.summary.verdict.is_success()
    } else {
        let spread = Spread::new(results.iter().map(|result| result.run.summary.clone()).collect());
        console.json(&spread)?;
        print_many(console, &spread)?;
        is_enough(arguments.enough, &spread)
    };
    if let Some(report) = &checked {
        check::print_short(console, report)?;
    }
    console.line(&format!("results:   {}", folder.path().display()))?;
    if stop.load(Ordering::Relaxed) {
        let done = if plan.learns() { "learned" } else { "tested" };
        console.note(&format!("stopped by Ctrl-C; what was {done} until then is kept"));
        return Ok(INTERRUPTED);
    }
    Ok(u8::from(!good))
}

/// The seeds, from the first on.
fn seeds(arguments: &RunArguments) -> Result<Vec<u64>> {
    let Some(end) = arguments.seed.checked_add(arguments.seeds - 1) else {
        let message =
            format!("there are no {} seeds from {} on: the last one is {}", arguments.seeds, arguments.seed, u64::MAX);
        return Diagnostic::new("E-SET", message).help("choose a lesser --seed").fail();
    };
    Ok((arguments.seed..=end).collect())
}

/// Whether so many seeds succeed as are asked for: more than half, if nothing is asked.
fn is_enough(share: Option<f64>, spread: &Spread) -> bool {
    let (succeed, all) = (spread.successes as f64, spread.seeds.len() as f64);
    share.map_or(2.0 * succeed > all, |share| succeed >= share * all)
}

/// Tells of seeds in their order, whichever thread is done first.
struct InOrder {
    /// The seeds that are not told yet, each with its line once it is there.
    waiting: Mutex<VecDeque<(u64, Option<String>)>>,
}

impl InOrder {
    fn new(seeds: &[u64]) -> Self {
        Self { waiting: Mutex::new(seeds.iter().map(|seed| (*seed, None)).collect()) }
    }

    fn tell(&self, seed: u64, line: String, print: impl Fn(u64, &str)) {
        let mut waiting = self.waiting.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(place) = waiting.iter_mut().find(|(waiting, _)| *waiting == seed) {
            place.1 = Some(line);
        }
        while let Some((seed, Some(line))) = waiting.front() {
            print(*seed, line);
            waiting.pop_front();
        }
    }
}

/// Refuses what only a behaviour that learns can do.
fn check_learning(arguments: &RunArguments, plan: &Plan) -> Result<()> {
    if plan.learns() || arguments.steps.is_none() {
        return Ok(());
    }
    let message = format!("'{}' combines policies: it takes no steps of learning", plan.behaviour.name());
    let help = "leave out --steps; --set run.test_steps=N sets the length of the test";
    Diagnostic::new("E-COMBINES", message).help(help).fail()
}

fn record_run(arguments: &RunArguments, plan: &Plan, log: &RunLog, path: &Path, console: &Console) -> Result<()> {
    let phases = [(Phase::Learning, &log.learning), (Phase::Test, &log.test)];
    let recording = record(plan, arguments.seed, &phases, arguments.record_every, path)?;
    console.note(&format!(
        "recorded {} steps and {} images in {} ({} KiB)",
        recording.steps,
        recording.images,
        path.display(),
        recording.bytes / 1024
    ));
    Ok(())
}

fn check_record(path: &Path, seeds: &[u64]) -> Result<()> {
    if seeds.len() > 1 {
        let error = Diagnostic::new("E-RECORD-SEEDS", "a recording is of one seed");
        return error.help("leave --seeds out, and choose the seed with --seed").fail();
    }
    check_recording(path)
}

fn out(arguments: &RunArguments, name: &str, seeds: &[u64]) -> PathBuf {
    if let Some(out) = &arguments.out {
        return out.clone();
    }
    let folder = match seeds {
        [first, .., last] => format!("{first}-{last}"),
        _ => arguments.seed.to_string(),
    };
    Path::new("runs").join(name).join(folder)
}

fn run_all(
    plan: &Plan,
    folder: &RunFolder,
    seeds: &[u64],
    threads: usize,
    stop: &AtomicBool,
    console: &Console,
) -> Result<Vec<SeedResult>> {
    let bar = console.bar(plan.settings.run.steps * seeds.len() as u64);
    let plain = bar.is_hidden() && seeds.len() == 1;
    let report = |progress: Progress| {
        bar.inc(WINDOW_STEPS);
        bar.set_message(format!("reinforcement per 400: {}", short(progress.reinforcement)));
        if plain {
            console.note(&format!(
                "step {}: reinforcement of the last 400 steps {}",
                progress.steps,
                short(progress.reinforcement)
            ));
        }
    };
    let told = InOrder::new(seeds);
    let run_seed = if seeds.len() == 1 { run_only_seed } else { run_seed };
    let results = in_parallel(seeds, threads, |seed| {
        let (started, mut log) = (Instant::now(), RunLog::new(plan));
        let mut run = match run_seed(plan, seed, stop, &report, &mut log) {
            Ok(run) => run,
            Err(broken) => {
                if let Some(learned) = &broken.learned {
                    let kept = folder.keep_broken(plan, learned, &log)?;
                    console.note(&format!("what was learned in {} steps is kept in {}", learned.steps, kept.display()));
                }
                return Err(broken.error);
            }
        };
        run.summary = run.summary.timed(started.elapsed().as_secs_f64());
        if plan.learns() && bar.is_hidden() && !plain {
            told.tell(seed, one_line(&run.summary), |seed, line| console.note(&format!("seed {seed}: {line}")));
        }
        folder.keep_log(plan, seed, &log)?;
        Ok(SeedResult { run, log: (seeds.len() == 1).then_some(log) })
    });
    bar.finish_and_clear();
    results
}
