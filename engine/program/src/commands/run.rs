//! `engine run`: learn or combine, test, draw.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use engine::diagnostic::{Diagnostic, Result};
use engine::experiment::{
    BrokenOff, Checkpoints, Kept, Overrides, PassedOn, Phase, Plan, Progress, RunLog, SeedRun, Spread, WINDOW_STEPS,
    in_parallel, run_only_seed, run_seed_kept,
};
use insight::folder::{ALL_SEGMENTS, IfTaken, RunFolder, SeedResult, Unfinished};
use insight::record::{check_recording, record};
use insight::store::{CheckpointWriter, StoredCheckpoint, going_on_from, plan_of_run};
use insight::words::short;
use pack::Runnable;

use super::branch::Branch;
use super::check;
use super::print::{one_line, print_many, print_one};
use super::sources::catalogue;
use super::stop::Stop;
use crate::cli::RunArguments;
use crate::console::{Console, ConsoleError};

/// Steps from one checkpoint to the next, unless it is said.
const CHECKPOINT_STEPS: u64 = 200_000;

/// All that a run needs.
struct Begun {
    runnable: Runnable,
    seeds: Vec<u64>,
    folder: RunFolder,
    /// Steps from one checkpoint to the next.
    every: u64,
    /// How many segments of the log are kept.
    segments: u64,
    resumed: bool,
    branch: Option<Branch>,
}

pub(crate) fn run(arguments: &RunArguments, console: &mut Console) -> std::result::Result<u8, ConsoleError> {
    let begun = match &arguments.resume {
        Some(place) => resume(place, arguments)?,
        None => begin(arguments, console)?,
    };
    let stop = Stop::on_signals()?;
    let threads = arguments.threads.unwrap_or(0) as usize;
    let results = match run_all(&begun, threads, &stop.flag, console) {
        Ok(results) => results,
        Err(error) => {
            if begun.folder.can_be_resumed() {
                console.note(&format!("what was learned until then is kept: {}", go_on(begun.folder.path())));
            }
            begun.folder.commit_broken()?;
            return Err(error.into());
        }
    };
    let Begun { runnable: Runnable { plan, unpacked: _unpacked }, seeds, folder, branch, .. } = begun;
    let checked = if arguments.check { check::beside_a_run(&plan, threads, &stop.flag, console) } else { None };
    folder.write(&plan, &results, checked.as_ref())?;
    let (stopped, written) = (stop.status(), folder.path().to_owned());
    let resumable = stopped.is_some() && folder.can_be_resumed();
    if let Some(aside) = folder.set_aside()? {
        console.note(&format!("the run that stands there has a tag: it is kept, in {}", aside.display()));
    }
    match stopped {
        Some(_) => folder.commit()?,
        None => folder.commit_done(&seeds)?,
    }
    if let (Some(path), [SeedResult { log: Some(log), .. }]) = (&arguments.record, results.as_slice()) {
        record_run(arguments.record_every, seeds[0], &plan, log, path, console)?;
    }
    let good = tell(arguments, &plan, &results, console)?;
    if let (Some(branch), [SeedResult { log: Some(log), .. }]) = (&branch, results.as_slice()) {
        branch.tell(&plan, &log.learning, console)?;
    }
    if let Some(report) = &checked {
        check::print_short(console, report)?;
    }
    console.line(&format!("results:   {}", written.display()))?;
    let Some((status, by)) = stopped else { return Ok(u8::from(!good)) };
    let done = if plan.learns() { "learned" } else { "tested" };
    console.note(&format!("stopped by {by}; what was {done} until then is kept"));
    if resumable {
        console.note(&go_on(&written));
    }
    Ok(status)
}

fn go_on(folder: &Path) -> String {
    format!("go on with it: engine run --resume {}", folder.display())
}

/// Prints the figures; whether they are good enough.
fn tell(
    arguments: &RunArguments,
    plan: &Plan,
    results: &[SeedResult],
    console: &mut Console,
) -> std::result::Result<bool, ConsoleError> {
    if let [result] = results {
        console.json(&result.run.summary)?;
        print_one(console, plan, &result.run.summary)?;
        return Ok(result.run.summary.verdict.is_success());
    }
    let spread = Spread::new(results.iter().map(|result| result.run.summary.clone()).collect());
    console.json(&spread)?;
    print_many(console, &spread)?;
    Ok(is_enough(arguments.enough, &spread))
}

/// A new run.
fn begin(arguments: &RunArguments, console: &Console) -> Result<Begun> {
    let overrides = Overrides { steps: arguments.steps, ..arguments.changes.overrides() };
    let Some(behaviour) = &arguments.behaviour else {
        return Diagnostic::new("E-SET", "no behaviour is given").help("write: engine run SCRIPT").fail();
    };
    let Runnable { plan, unpacked } =
        super::behaviour::open(behaviour, &overrides, &arguments.filters, arguments.allow_unsigned)?;
    check_learning(arguments, &plan)?;
    let (plan, seeds, branch) = match (&arguments.branch, &arguments.from) {
        (Some(from), _) => {
            let (plan, branch) = Branch::begin(plan, from, arguments.steps, &catalogue(&arguments.filters)?)?;
            (plan, vec![branch.seed()], Some(branch))
        }
        (None, Some(from)) => {
            let seeds = seeds(arguments)?;
            (going_on_from(plan, from, &seeds, &catalogue(&arguments.filters)?)?, seeds, None)
        }
        (None, None) => (plan, seeds(arguments)?, None),
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
    let (runnable, segments) = (Runnable { plan, unpacked }, arguments.log_segments.unwrap_or(ALL_SEGMENTS));
    Ok(Begun {
        runnable,
        seeds,
        folder,
        every: arguments.checkpoint.unwrap_or(CHECKPOINT_STEPS),
        segments,
        resumed: false,
        branch,
    })
}

/// A run that was killed or stopped.
fn resume(place: &Path, arguments: &RunArguments) -> Result<Begun> {
    let (folder, unfinished) = RunFolder::resume(place)?;
    let (plan, _) = plan_of_run(folder.work(), catalogue(&arguments.filters)?)?;
    let seeds = unfinished.all_seeds();
    if let Some(path) = &arguments.record {
        check_record(path, &seeds)?;
    }
    let (runnable, segments) = (Runnable { plan, unpacked: None }, unfinished.segments);
    Ok(Begun {
        runnable,
        seeds,
        folder,
        every: arguments.checkpoint.unwrap_or(unfinished.every),
        segments,
        resumed: true,
        branch: None,
    })
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
    let combines = |what, help| {
        let message = format!("'{}' combines policies: it {what}", plan.behaviour.name());
        Diagnostic::new("E-COMBINES", message).help(help).fail()
    };
    match arguments {
        _ if plan.learns() => Ok(()),
        RunArguments { steps: Some(_), .. } => combines(
            "takes no steps of learning",
            "leave out --steps; --set run.test_steps=N sets the length of the test",
        ),
        RunArguments { checkpoint: Some(_), .. } => combines(
            "learns nothing that a checkpoint could keep",
            "leave out --checkpoint; a test that was killed is begun anew",
        ),
        _ => Ok(()),
    }
}

fn record_run(every: u64, seed: u64, plan: &Plan, log: &RunLog, path: &Path, console: &Console) -> Result<()> {
    let phases = [(Phase::Learning, &log.learning), (Phase::Test, &log.test)];
    let recording = record(plan, seed, &phases, every, path)?;
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
        [seed] => seed.to_string(),
        [] => arguments.seed.to_string(),
    };
    Path::new("runs").join(name).join(folder)
}

fn run_all(begun: &Begun, threads: usize, stop: &AtomicBool, console: &Console) -> Result<Vec<SeedResult>> {
    let Begun { runnable: Runnable { plan, .. }, seeds, folder, .. } = begun;
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
    let results = in_parallel(seeds, threads, |seed| {
        let (started, mut log) = (Instant::now(), RunLog::new(plan));
        let mut run = match learn_seed(begun, seed, stop, &report, &mut log)? {
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

/// One seed, with its checkpoints.
fn learn_seed(
    begun: &Begun,
    seed: u64,
    stop: &AtomicBool,
    report: &(dyn Fn(Progress) + Sync),
    log: &mut RunLog,
) -> Result<std::result::Result<SeedRun, Box<BrokenOff>>> {
    let Begun { runnable: Runnable { plan, .. }, seeds, folder, every, segments, resumed, .. } = begun;
    let run_seed = if seeds.len() == 1 { run_only_seed } else { run_seed_kept };
    if !plan.learns() {
        return Ok(run_seed(plan, seed, stop, report, log, Checkpoints::NONE));
    }
    let after = if *resumed { folder.checkpoint(plan, seed)? } else { None };
    let unfinished = Unfinished { seed: seeds[0], seeds: seeds.len() as u64, every: *every, segments: *segments };
    let long = Mutex::new(folder.segments(plan, seed, *segments)?);
    let segments = || long.lock().unwrap_or_else(PoisonError::into_inner);
    // Made with the first checkpoint: a short run has none.
    let writer: Mutex<Option<CheckpointWriter>> = Mutex::new(None);
    let keep = |kept: Kept<'_>| {
        let mut writer = writer.lock().unwrap_or_else(PoisonError::into_inner);
        if writer.is_none() {
            *writer = Some(folder.keeper(plan, seed, after.as_ref())?);
        }
        segments().sync()?;
        writer.as_mut().map_or(Ok(()), |writer| folder.keep_checkpoint(writer, kept, unfinished))
    };
    let from = after.as_ref().map(StoredCheckpoint::kept);
    let take = |chunk: PassedOn<'_>| segments().take(chunk);
    Ok(run_seed(plan, seed, stop, report, log, Checkpoints { every: *every, from, keep: &keep, take: &take }))
}
