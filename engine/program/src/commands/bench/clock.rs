//! Times of work: medians over many short stretches of the processor's time, which other programs disturb little.

use std::hint::black_box;
use std::sync::atomic::AtomicBool;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use engine::diagnostic::Result;
use engine::experiment::{Ledger, Plan, WINDOW_STEPS, in_parallel, learn_into};
use engine::stats::Sorted;

use super::stages::{SAMPLES, STAGES, Stages};
use super::workload::empty_cycle;

/// How often each plan is learned.
const TURNS: usize = 3;
/// Bytes of a page of memory.
const PAGE: usize = 4096;

/// Microseconds of one stage in each step.
#[derive(serde::Serialize)]
pub(super) struct StageTime {
    pub(super) name: &'static str,
    pub(super) us: f64,
}

/// The time that this thread has had on a processor.
#[cfg(unix)]
fn now() -> Duration {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Duration::try_from(time).unwrap_or_default()
}

/// The time since the first call, where threads have no clocks of their own.
#[cfg(not(unix))]
fn now() -> Duration {
    static START: std::sync::LazyLock<std::time::Instant> = std::sync::LazyLock::new(std::time::Instant::now);
    START.elapsed()
}

/// Learns once with each of the first seeds, with log, on as many threads, and lists the microseconds of a step in each window.
///
/// # Errors
/// If a sensor, a filter or the script fails.
pub(super) fn learn_on(plan: &Plan, threads: usize) -> Result<Vec<f64>> {
    let stop = AtomicBool::new(false);
    let seeds: Vec<u64> = (1..=threads as u64).collect();
    let windows = in_parallel(&seeds, threads, |seed| {
        let ends = Mutex::new(Vec::new());
        let note = |_| ends.lock().unwrap_or_else(PoisonError::into_inner).push(now());
        learn_into(plan, seed, &stop, &note, &mut Ledger::new(plan, plan.settings.run.steps))?;
        let ends = ends.into_inner().unwrap_or_else(PoisonError::into_inner);
        let us = |pair: &[Duration]| (pair[1] - pair[0]).as_secs_f64() * 1e6 / WINDOW_STEPS as f64;
        Ok(ends.windows(2).map(us).collect::<Vec<_>>())
    })?;
    Ok(windows.concat())
}

/// Microseconds of a whole step, for each of some plans on so many threads each. The plans take turns, so that a slow
/// minute slows all of them.
///
/// # Errors
/// If a sensor, a filter or the script fails.
pub(super) fn step_us(plans: &[(&Plan, usize)]) -> Result<Vec<f64>> {
    let mut windows = vec![Vec::new(); plans.len()];
    for _ in 0..TURNS {
        for ((plan, threads), windows) in plans.iter().zip(&mut windows) {
            windows.extend(learn_on(plan, *threads)?);
        }
    }
    Ok(windows.into_iter().map(median).collect())
}

/// Microseconds of each stage alone, over `calls` calls.
///
/// # Errors
/// If a filter or the script fails.
pub(super) fn stages(plan: &Plan, calls: u64) -> Result<Vec<StageTime>> {
    let mut stages = Stages::new(plan)?;
    let times = STAGES.map(|(name, call)| StageTime { name, us: median_us(calls, |index| call(&mut stages, index)) });
    stages.finish()?;
    Ok(times.into())
}

/// Microseconds of copying one colour frame of the plan's camera.
pub(super) fn copy_us(plan: &Plan, calls: u64) -> f64 {
    let camera = &plan.settings.camera;
    let length = (3 * camera.width_px * camera.height_px) as usize;
    // Copies between places that differ by little more than whole pages are several times slower on some processors.
    let gap = PAGE - length % PAGE + PAGE / 2;
    let mut memory = vec![7_u8; 2 * length + gap];
    let (frame, rest) = memory.split_at_mut(length);
    let copy = &mut rest[gap..];
    median_us(calls, |_| black_box(&mut *copy).copy_from_slice(black_box(frame)))
}

/// Microseconds of a step without sensors.
///
/// # Errors
/// If a filter or the script fails.
pub(super) fn empty_step_us(plan: &Plan, calls: u64) -> Result<f64> {
    let mut cycle = empty_cycle(plan)?;
    let mut failure = None;
    let us = median_us(calls, |index| match black_box(cycle.step(index % 2)) {
        Ok(_) => {}
        Err(error) => failure = Some(error),
    });
    failure.map_or(Ok(us), Err)
}

/// Median microseconds of one call, over rounds of [`SAMPLES`] calls, about `calls` in all.
fn median_us(calls: u64, mut call: impl FnMut(usize)) -> f64 {
    let round = |_| {
        let started = now();
        (0..SAMPLES).for_each(&mut call);
        (now() - started).as_secs_f64() * 1e6 / SAMPLES as f64
    };
    median((0..calls.div_ceil(SAMPLES as u64)).map(round))
}

fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().collect::<Sorted>().upper_median().unwrap_or(f64::NAN)
}
