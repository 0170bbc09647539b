//! `engine run` for a script that combines learned policies: nothing is learned, the combination is tested.

use std::path::Path;
use std::sync::atomic::Ordering;
use std::time::Instant;

use engine::diagnostic::{Diagnostic, Kind, Result};
use engine::experiment::{
    CombinationFigures, CombinedRun, Cycle, Member, Plan, Spread, Step, Summary, in_parallel, test_combined,
};
use engine::robot::SimulatedRobot;
use insight::lint::Report;
use insight::page::SeedData;
use insight::report::{disagreements_csv, write_atomic};
use insight::store::{RunLog, run_to_toml};

use super::check;
use super::folder::{RunFolder, create, draw_frame, draw_trails, write_json, write_log};
use super::run::print_many;
use super::stop::{INTERRUPTED, on_ctrl_c};
use super::test::print_figures;
use crate::cli::RunArguments;
use crate::console::{Console, ConsoleError};

/// Disagreements that a person is shown.
const SHOWN: usize = 5;

struct SeedResult {
    tested: CombinedRun,
    summary: Summary,
    log: RunLog,
}

pub(super) fn run(
    arguments: &RunArguments,
    (plan, members): (&Plan, &[Member]),
    seeds: &[u64],
    path: &Path,
    console: &mut Console,
) -> std::result::Result<u8, ConsoleError> {
    if arguments.steps.is_some() {
        let message = format!("'{}' combines policies: it takes no steps of learning", plan.behaviour.name());
        let help = "leave out --steps; --set run.test_steps=N sets the length of the test";
        return Err(Box::new(Diagnostic::new("E-COMBINES", message).help(help)).into());
    }
    RunFolder::create(path, plan, members, arguments.seed)?;
    let stop = on_ctrl_c()?;
    let threads = arguments.threads.unwrap_or(0) as usize;
    let results = in_parallel(seeds, threads, |seed| {
        let started = Instant::now();
        let mut log = RunLog::new(plan);
        let mut keep = |cycle: &Cycle<SimulatedRobot>, step: &Step| log.test.add(cycle, step, false);
        let tested = test_combined(plan, members, seed, &stop, &mut keep)?;
        let mut summary = Summary::of_combination(plan, members, &tested, seed, started.elapsed().as_secs_f64());
        summary.log_sha256 = Some(log.sha256());
        Ok(SeedResult { tested, summary, log })
    })?;
    let checked = if arguments.check { check::beside_a_run(plan, threads, &stop, console) } else { None };
    let good = if let [result] = results.as_slice() {
        write_seed(path, plan, members, result, checked.as_ref())?;
        console.json(&result.summary)?;
        print_one(console, result)?;
        result.summary.is_good()
    } else {
        let spread = Spread::new(results.iter().map(|result| result.summary.clone()).collect());
        write_json(&path.join("summary.json"), &spread)?;
        for result in &results {
            let folder = path.join(result.summary.seed.to_string());
            create(&folder)?;
            write_atomic(&folder.join("run.toml"), run_to_toml(plan, members, result.summary.seed)?.as_bytes())?;
            write_seed(&folder, plan, members, result, checked.as_ref())?;
        }
        console.json(&spread)?;
        print_many(console, &spread)?;
        2 * spread.converged > spread.seeds.len()
    };
    if let Some(report) = &checked {
        check::print_short(console, report)?;
    }
    console.line(&format!("results:   {}", path.display()))?;
    if stop.load(Ordering::Relaxed) {
        console.note("stopped by Ctrl-C; what was tested until then is kept");
        return Ok(INTERRUPTED);
    }
    Ok(u8::from(!good))
}

fn write_seed(
    folder: &Path,
    plan: &Plan,
    members: &[Member],
    result: &SeedResult,
    checked: Option<&Report>,
) -> Result<()> {
    write_json(&folder.join("summary.json"), &result.summary)?;
    write_log(folder, plan, members, result.summary.seed, &result.log)?;
    let names: Vec<&str> = members.iter().map(|member| member.name.as_str()).collect();
    let table = disagreements_csv(&names, &plan.settings.actions, &result.tested.disagreements);
    write_atomic(&folder.join("disagreements.csv"), table.as_bytes())?;
    let title = format!("{} in {}, seed {}", plan.behaviour.name(), plan.layout.name, result.summary.seed);
    draw_trails(folder, plan, &title, &[("test: first 800 steps", &result.tested.run.trail)])?;
    draw_frame(folder, plan, &result.tested.run)?;
    let test = Some(&result.summary.test);
    let (learning, tested) = (&result.log.learning, &result.log.test);
    let data = SeedData { seed: result.summary.seed, tally: None, policy: None, test, learning, tested };
    super::page::write(folder, plan, &[data], checked)
}

fn print_one(console: &mut Console, result: &SeedResult) -> std::result::Result<(), ConsoleError> {
    let Summary { behaviour, world, seed, steps_per_second, test, .. } = &result.summary;
    console.line(&format!("behaviour: {behaviour} in {world}, seed {seed}, {steps_per_second} steps per second"))?;
    print_combination(console, &result.tested.figures)?;
    print_figures(console, test)
}

/// Who decided, and where the policies disagree.
pub(super) fn print_combination(
    console: &mut Console,
    figures: &CombinationFigures,
) -> std::result::Result<(), ConsoleError> {
    let member = |member: &engine::experiment::MemberFigures| match member.decided {
        Some(share) => format!("{} {:.0} %", member.name, 100.0 * share),
        None => member.name.clone(),
    };
    let members: Vec<String> = figures.policies.iter().map(member).collect();
    let way = if figures.way == "sum" { "sum of" } else { "priority, decided by" };
    console.line(&format!("combined:  {way} {}", members.join(", ")))?;
    console.line(&format!(
        "disagree:  {:.0} % of the time, in {} pairs of states",
        100.0 * figures.disagree,
        figures.disagreements
    ))?;
    for row in figures.most_frequent.iter().take(SHOWN) {
        let wish = |index: usize| {
            let [linear, angular] = row.motions[index];
            format!("{} in {} wants {linear} m/s {angular} rad/s", row.policies[index], row.states[index])
        };
        let won = match row.won {
            [0, 0] => "neither won".to_owned(),
            [first, second] if first >= second => format!("{} won", row.policies[0]),
            _ => format!("{} won", row.policies[1]),
        };
        console.line(&format!("  {} steps: {}; {}; {won}", row.steps, wish(0), wish(1)))?;
    }
    Ok(())
}
