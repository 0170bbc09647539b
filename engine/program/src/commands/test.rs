//! `engine test`: a stored policy again, in the same or another world.

use std::sync::atomic::Ordering;

use engine::diagnostic::{Diagnostic, Kind};
use engine::experiment::{CertaintyGrid, Cycle, Overrides, Step, TestFigures, test_and_watch, test_combined};
use engine::filter::Sources;
use engine::robot::SimulatedRobot;
use insight::store::{Decider, StoredRun};
use pack::{Evidence, Pack, Runnable};

use super::combine::print_combination;
use super::folder::TestFolder;
use super::sources::{catalogue, sources};
use super::stop::{INTERRUPTED, on_ctrl_c};
use crate::cli::TestArguments;
use crate::console::{Console, ConsoleError};

pub(crate) fn run(arguments: &TestArguments, console: &mut Console) -> Result<u8, ConsoleError> {
    let (world, set) = (arguments.world.clone(), arguments.set.clone());
    let overrides = Overrides { world, steps: None, test_steps: arguments.steps, set };
    let StoredRun { plan, seed, decider } = match super::behaviour::open_pack(&arguments.run, arguments.allow_unsigned)?
    {
        Some((pack, depends)) => of_pack(&pack, &depends, &overrides, sources(&arguments.filters)?)?,
        None => {
            let stored = StoredRun::load_with(&arguments.run, catalogue(&arguments.filters)?)?;
            StoredRun { plan: stored.plan.with_changes(&overrides)?, ..stored }
        }
    };
    let stop = on_ctrl_c()?;
    let test_seed = arguments.seed.unwrap_or(seed);
    let mut map = arguments.out.as_ref().and_then(|_| CertaintyGrid::new(&plan.layout, &plan.settings.laser));
    let mut watch = |cycle: &Cycle<SimulatedRobot>, _: &Step| {
        if let Some(map) = &mut map {
            map.follow(cycle);
        }
    };
    let (tested, combined) = match &decider {
        Decider::Learned(policy) => (test_and_watch(&plan, policy, test_seed, &stop, &mut watch)?, None),
        Decider::Combined(members) => {
            let combined = test_combined(&plan, members, test_seed, &stop, &mut watch)?;
            (combined.run, Some(combined.figures))
        }
    };
    if let Some(out) = &arguments.out {
        TestFolder::create(out)?.write(&plan, &tested, map.as_ref())?;
    }
    console.json(&tested.figures)?;
    let how = if combined.is_some() { "combined" } else { "learned" };
    console.line(&format!("behaviour: {} in {}, {how} with seed {seed}", plan.behaviour.name(), plan.layout.name))?;
    if let Some(combined) = &combined {
        print_combination(console, combined)?;
    }
    print_figures(console, &tested.figures)?;
    if stop.load(Ordering::Relaxed) {
        return Ok(INTERRUPTED);
    }
    Ok(u8::from(tested.figures.does_task == Some(false)))
}

/// What a pack carries: its policy, under the seed that learned it, or the policies that it combines.
fn of_pack(
    pack: &Pack,
    depends: &[Pack],
    overrides: &Overrides,
    sources: Sources,
) -> engine::diagnostic::Result<StoredRun> {
    let Runnable { plan, members, .. } = pack.plan(depends, overrides, sources)?;
    let evidence = pack.manifest().evidence.as_ref();
    let seed = evidence.and_then(Evidence::shown).map_or(1, |claim| claim.seed);
    let decider = match pack.policy(&plan)? {
        _ if !members.is_empty() => Decider::Combined(members),
        Some(policy) => Decider::Learned(policy),
        None => {
            let message = format!("{} carries no learned policy", pack.title());
            let help = "learn it with 'engine run', or build it first: engine pack build FOLDER";
            return Diagnostic::new("E-PACK-POLICY", message).help(help).fail();
        }
    };
    Ok(StoredRun { plan, seed, decider })
}

/// The figures of a test for a person, and in words what a reward cannot see.
pub(crate) fn print_figures(console: &mut Console, test: &TestFigures) -> Result<(), ConsoleError> {
    console.line(&format!(
        "test:      {} steps, {} ({:.1} per 1000), {}, {:.2} m/s",
        test.steps,
        counted(test.failures, "failure"),
        test.failures_per_1000,
        counted(test.contacts, "contact"),
        test.mean_speed
    ))?;
    if test.goals > 0 {
        let all = test.goals + test.failures;
        let share = 100.0 * test.goals as f64 / all as f64;
        console.line(&format!("goals:     {} of {all} attempts ({share:.0} %)", test.goals))?;
    }
    if let (Some(laps), Some(net_m)) = (test.laps, test.net_route_m) {
        console
            .line(&format!("route:     {laps:.1} laps, {net_m:.0} m net along it; {:.0} m driven", test.distance_m))?;
    }
    if let Some(distance_m) = test.prey_distance_m {
        console.line(&format!("prey:      median distance {distance_m:.2} m"))?;
    }
    let habits = [("spinning", test.spinning), ("standing", test.standing), ("circling", test.circling)];
    let habits: Vec<_> = habits.iter().filter(|(_, share)| *share > 0.02).collect();
    for (habit, share) in habits {
        console.line(&format!("warning:   {habit} {:.0} % of the time", 100.0 * share))?;
    }
    if test.does_task == Some(false) {
        console.line("warning:   it avoids punishment, but makes less than 0.1 m/s along the route")?;
    }
    Ok(())
}

/// `1 failure`, `2 failures`.
fn counted(count: u64, thing: &str) -> String {
    format!("{count} {thing}{}", if count == 1 { "" } else { "s" })
}
