//! `engine bench`: microseconds of a step on one core and on all, stage by stage, beside yardsticks of the same run.

mod clock;
mod growth;
mod stages;
mod workload;

use std::sync::atomic::AtomicBool;

use dispatch::Processor;
use engine::diagnostic::Result;
use engine::experiment::{Ledger, Plan, learn_into};

use self::clock::StageTime;
use self::growth::GrowthRow;
use crate::cli::BenchArguments;
use crate::console::{Console, ConsoleError};

#[derive(serde::Serialize)]
struct BenchReport {
    behaviour: String,
    world: String,
    image: [u64; 2],
    lens: String,
    textured: bool,
    processor: &'static str,
    cores: usize,
    steps_per_second_one_core: f64,
    steps_per_second_all_cores: f64,
    step_us: f64,
    stages: Vec<StageTime>,
    copy_of_one_frame_us: f64,
    empty_step_us: f64,
    /// How many copies of one colour frame a step takes.
    step_in_copies: f64,
    growth: Option<Vec<GrowthRow>>,
}

pub(crate) fn run(arguments: &BenchArguments, console: &mut Console) -> std::result::Result<u8, ConsoleError> {
    let plan = workload::plan(arguments)?;
    if let Some(steps) = arguments.count_steps {
        // Counted from outside, instruction by instruction.
        let (plan, stop) = (workload::with_steps(&plan, steps), AtomicBool::new(false));
        learn_into(&plan, 1, &stop, &|_| (), &mut Ledger::new(&plan, steps)).map_err(|broken| broken.error)?;
        console.line(&format!("{steps} steps, {}", Processor::best().name()))?;
        return Ok(0);
    }
    let report = measure(&plan, arguments)?;
    if let (Some(folder), Some(rows)) = (&arguments.out, &report.growth) {
        growth::draw_growth(&report.behaviour, rows, folder)?;
    }
    console.json(&report)?;
    print(console, &report)?;
    Ok(0)
}

fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

fn measure(plan: &Plan, arguments: &BenchArguments) -> Result<BenchReport> {
    let cores = cores();
    let times = clock::step_us(&[(plan, 1), (plan, cores)])?;
    let (one_us, all_us) = (times[0], times[1] / cores as f64);
    let camera = &plan.settings.camera;
    let copy_us = clock::copy_us(plan, arguments.steps);
    Ok(BenchReport {
        behaviour: plan.behaviour.name().to_owned(),
        world: plan.worlds.title(),
        image: [camera.width_px, camera.height_px],
        lens: camera.lens.word().to_owned(),
        textured: arguments.texture,
        processor: Processor::best().name(),
        cores,
        steps_per_second_one_core: 1e6 / one_us,
        steps_per_second_all_cores: 1e6 / all_us,
        step_us: one_us,
        stages: clock::stages(plan, arguments.steps)?,
        copy_of_one_frame_us: copy_us,
        empty_step_us: clock::empty_step_us(plan, arguments.steps)?,
        step_in_copies: one_us / copy_us,
        growth: if arguments.growth { Some(growth::measure(plan)?) } else { None },
    })
}

fn print(console: &mut Console, report: &BenchReport) -> std::result::Result<(), ConsoleError> {
    let [width, height] = report.image;
    let textured = if report.textured { ", textured" } else { "" };
    console.line(&format!(
        "{} in {}{textured}, image {width}x{height}, {} lens, vectors: {}",
        report.behaviour, report.world, report.lens, report.processor
    ))?;
    let (one, all) = (report.steps_per_second_one_core, report.steps_per_second_all_cores);
    console.line(&format!("one core:  {one:>8.0} steps per second, {:.2} us for each", report.step_us))?;
    console.line(&format!("{} cores:   {all:>8.0} steps per second, {:.2} times as many", report.cores, all / one))?;
    console.line("microseconds for each step, stage by stage:")?;
    for StageTime { name, us } in &report.stages {
        console.line(&format!("  {name:10} {us:8.2}"))?;
    }
    let sum: f64 = report.stages.iter().map(|stage| stage.us).sum();
    console.line(&format!("  {:10} {:8.2}", "the rest", (report.step_us - sum).max(0.0)))?;
    console.line("yardsticks of this run, microseconds:")?;
    console.line(&format!(
        "  a copy of one colour frame {:8.2}; a step is {:.1} copies",
        report.copy_of_one_frame_us, report.step_in_copies
    ))?;
    console.line(&format!("  a step without sensors     {:8.2}", report.empty_step_us))?;
    report.growth.as_ref().map_or(Ok(()), |rows| print_growth(console, rows))
}

fn print_growth(console: &mut Console, rows: &[GrowthRow]) -> std::result::Result<(), ConsoleError> {
    console.line("\n| what | amount | whole step, us | times the first | camera, us | laser, us |")?;
    console.line("|---|---|---|---|---|---|")?;
    let shown = |us: Option<f64>| us.map_or("–".to_owned(), |us| format!("{us:.2}"));
    for GrowthRow { what, amount, step_us, ratio, camera_us, laser_us } in rows {
        let (camera, laser) = (shown(*camera_us), shown(*laser_us));
        console.line(&format!("| {what} | {amount} | {step_us:.2} | {ratio:.2} | {camera} | {laser} |"))?;
    }
    Ok(())
}
