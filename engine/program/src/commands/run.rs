//! `engine run`: learn, test the frozen policy, draw.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use engine::diagnostic::{Diagnostic, Kind, Result};
use engine::experiment::{Overrides, Phase, Plan, Progress, Spread, Summary, in_parallel, learn_into, test_into};
use insight::record::{check_recording, record};
use insight::store::RunLog;
use pack::Runnable;

use super::check;
use super::folder::{RunFolder, SeedResult};
use super::stop::{INTERRUPTED, on_ctrl_c};
use crate::cli::RunArguments;
use crate::console::{Console, ConsoleError};

pub(crate) fn run(arguments: &RunArguments, console: &mut Console) -> std::result::Result<u8, ConsoleError> {
    let (world, set) = (arguments.world.clone(), arguments.set.clone());
    let overrides = Overrides { world, steps: arguments.steps, test_steps: None, set };
    let Runnable { plan, members, .. } =
        super::behaviour::open(&arguments.behaviour, &overrides, &arguments.filters, arguments.allow_unsigned)?;
    let seeds: Vec<u64> = (0..arguments.seeds).map(|index| arguments.seed.wrapping_add(index)).collect();
    let path = out(arguments, plan.behaviour.name(), &seeds);
    if !plan.settings.policies.is_empty() {
        return super::combine::run(arguments, (&plan, &members), &seeds, &path, console);
    }
    if let Some(path) = &arguments.record {
        check_record(path, &seeds)?;
    }
    let folder = RunFolder::create(&path, &plan, &[], arguments.seed)?;

    let stop = on_ctrl_c()?;
    let threads = arguments.threads.unwrap_or(0) as usize;
    let results = learn_all(&plan, &folder, &seeds, threads, &stop, console)?;
    let checked = if arguments.check { check::beside_a_run(&plan, threads, &stop, console) } else { None };
    folder.write(&plan, &results, checked.as_ref())?;
    if let (Some(path), [SeedResult { log: Some(log), .. }]) = (&arguments.record, results.as_slice()) {
        let phases = [(Phase::Learning, &log.learning), (Phase::Test, &log.test)];
        let recording = record(&plan, arguments.seed, &phases, arguments.record_every, path)?;
        console.note(&format!(
            "recorded {} steps and {} images in {} ({} KiB)",
            recording.steps,
            recording.images,
            path.display(),
            recording.bytes / 1024
        ));
    }

    let interrupted = stop.load(Ordering::Relaxed);
    let good = if let [result] = results.as_slice() {
        console.json(&result.summary)?;
        print_one(console, &result.summary)?;
        result.summary.is_good()
    } else {
        let spread = Spread::new(results.iter().map(|result| result.summary.clone()).collect());
        console.json(&spread)?;
        print_many(console, &spread)?;
        2 * spread.seeds.iter().filter(|seed| seed.is_good()).count() > spread.seeds.len()
    };
    if let Some(report) = &checked {
        check::print_short(console, report)?;
    }
    console.line(&format!("results:   {}", folder.path().display()))?;
    if interrupted {
        console.note("stopped by Ctrl-C; what was learned until then is kept");
        return Ok(INTERRUPTED);
    }
    Ok(u8::from(!good))
}

fn check_record(path: &Path, seeds: &[u64]) -> Result<()> {
    if seeds.len() > 1 {
        let error = Diagnostic::new(Kind::Usage, "E-RECORD", "a recording is of one seed");
        return error.help("leave --seeds out, and choose the seed with --seed").into();
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

fn learn_all(
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
        bar.inc(engine::experiment::WINDOW_STEPS);
        bar.set_message(format!("reinforcement per 400: {}", progress.reinforcement));
        if plain {
            console.note(&format!(
                "step {}: reinforcement of the last 400 steps {}",
                progress.steps, progress.reinforcement
            ));
        }
    };
    let results = in_parallel(seeds, threads, |seed| {
        let (started, mut log) = (Instant::now(), RunLog::new(plan));
        let mut learned = learn_into(plan, seed, stop, &report, &mut log.learning)?;
        if let Some(fault) = learned.fault.take() {
            let kept = folder.keep(plan, &learned, &log, seeds.len() > 1)?;
            console.note(&format!("what was learned in {} steps is kept in {}", learned.steps, kept.display()));
            return Err(fault);
        }
        let tested = test_into(plan, &learned.policy, seed, stop, &mut log.test)?;
        let mut summary = Summary::new(plan, &learned, tested.figures.clone(), started.elapsed().as_secs_f64());
        summary.log_sha256 = Some(log.sha256());
        if bar.is_hidden() && !plain {
            console.note(&format!("seed {seed}: {}", one_line(&summary)));
        }
        folder.keep_log(plan, seed, &log, seeds.len() > 1)?;
        let log = (seeds.len() == 1).then_some(log);
        Ok(SeedResult { learned, tested, summary, log })
    });
    bar.finish_and_clear();
    results
}

fn one_line(summary: &Summary) -> String {
    let learned = summary.learned_at.map_or("not learned".to_owned(), |step| format!("learned at step {step}"));
    let laps = summary.test.laps.map_or(String::new(), |laps| format!(", {laps:.1} laps"));
    format!("{learned}; test: {:.1} failures in 1000 steps{laps}", summary.test.failures_per_1000)
}

fn print_one(console: &mut Console, summary: &Summary) -> std::result::Result<(), ConsoleError> {
    let Summary { behaviour, world, seed, steps, test, .. } = summary;
    console.line(&format!(
        "behaviour: {behaviour} in {world}, seed {seed}, {} steps per second",
        summary.steps_per_second
    ))?;
    let learned = match summary.learned_at {
        Some(step) => format!("at step {step} of {steps} (four windows of 400 steps with -1 or better)"),
        None => format!("not within {steps} steps (no four windows of 400 steps with -1 or better)"),
    };
    console.line(&format!("learned:   {learned}"))?;
    super::test::print_figures(console, test)
}

pub(super) fn print_many(console: &mut Console, spread: &Spread) -> std::result::Result<(), ConsoleError> {
    let count = spread.seeds.len();
    console.line(&format!("behaviour: {} in {}, {count} seeds", spread.behaviour, spread.world))?;
    let combined = spread.seeds.iter().any(|seed| seed.combination.is_some());
    console.line(&format!(
        "{}   {} of {count} seeds ({:.0} %)",
        if combined { "good:   " } else { "learned:" },
        spread.converged,
        100.0 * spread.converged as f64 / count as f64
    ))?;
    console.line("                        median     worst")?;
    let step = |step: Option<u64>| step.map_or("never".to_owned(), |step| step.to_string());
    let (median, worst) = (&spread.median, &spread.worst);
    let mut row =
        |name: &str, median: String, worst: String| console.line(&format!("  {name:20}{median:>8}  {worst:>8}"));
    if !combined {
        row("learned at step", step(median.learned_at), step(worst.learned_at))?;
    }
    row("failures per 1000", format!("{:.1}", median.failures_per_1000), format!("{:.1}", worst.failures_per_1000))?;
    if let (Some(median), Some(worst)) = (median.laps, worst.laps) {
        row("laps", format!("{median:.1}"), format!("{worst:.1}"))?;
    }
    if let (Some(median), Some(worst)) = (median.prey_distance_m, worst.prey_distance_m) {
        row("distance to prey, m", format!("{median:.2}"), format!("{worst:.2}"))?;
    }
    row("contacts", format!("{:.0}", median.contacts), format!("{:.0}", worst.contacts))?;
    row("spinning, %", format!("{:.0}", 100.0 * median.spinning), format!("{:.0}", 100.0 * worst.spinning))?;
    let lost = spread.seeds.iter().filter(|seed| seed.test.does_task == Some(false)).count();
    if lost > 0 {
        console
            .line(&format!("{lost} of {count} seeds avoid punishment but make less than 0.1 m/s along the route"))?;
    }
    Ok(())
}
