//! `engine test`: a stored policy again, in the same or another world.

use std::sync::atomic::Ordering;

use engine::diagnostic::{Diagnostic, printable};
use engine::experiment::{CertaintyGrid, Decider, Overrides, base_lines};
use engine::filter::Sources;
use engine::settings::{LearnerKind, Settings};
use engine::verdict::{BaseLines, SuccessVerdict, TestFigures};
use insight::folder::TestFolder;
use insight::store::StoredRun;
use pack::{Evidence, Pack, Runnable};
use serde::Serialize;

use super::print::{print_combination, print_figures, print_uses, print_verdict};
use super::sources::{catalogue, sources};
use super::stop::{INTERRUPTED, on_ctrl_c};
use crate::cli::TestArguments;
use crate::console::{Console, ConsoleError};

/// What the softmax of a frozen policy reads.
const FROZEN: [&str; 3] = ["learner.temperature", "learner.temperature_end", "learner.cooling_visits"];

/// What is printed as JSON: the figures as they stand in `figures.json`, and the verdict on them.
#[derive(Serialize)]
struct TestReport<'a> {
    #[serde(flatten)]
    figures: &'a TestFigures,
    #[serde(flatten)]
    lines: &'a BaseLines,
    verdict: &'a SuccessVerdict,
}

pub(crate) fn run(arguments: &TestArguments, console: &mut Console) -> Result<u8, ConsoleError> {
    let overrides = Overrides {
        worlds: arguments.worlds.clone(),
        plain: arguments.plain,
        test_steps: arguments.steps,
        ..arguments.changes.overrides()
    };
    let StoredRun { plan, seed, decider } = match super::behaviour::open_pack(&arguments.run, arguments.allow_unsigned)?
    {
        Some((pack, depends)) => of_pack(&pack, &depends, &overrides, sources(&arguments.filters)?)?,
        None => {
            let stored = StoredRun::load_with(&arguments.run, catalogue(&arguments.filters)?)?;
            let plan = stored.plan.clone().with_changes(&overrides)?;
            check_states(&stored.plan.settings, &plan.settings)?;
            StoredRun { plan, ..stored }
        }
    };
    check_effect(arguments.changes.set(), plan.settings.learner.kind)?;
    let folder = arguments.out.as_ref().map(|out| TestFolder::create(out, arguments.force)).transpose()?;
    let stop = on_ctrl_c()?;
    let test_seed = arguments.seed.unwrap_or(seed);
    let mut map = arguments.out.as_ref().and_then(|_| CertaintyGrid::new(&plan.layout, &plan.settings.laser));
    let tested = decider.test(&plan, test_seed, &stop, &mut map)?;
    if let Some(folder) = folder {
        folder.write(&plan, &tested, map.as_ref())?;
    }
    let lines = base_lines(&plan, test_seed, &tested, &stop)?;
    let verdict = plan.success().verdict(&tested.figures, &lines);
    console.json(&TestReport { figures: &tested.figures, lines: &lines, verdict: &verdict })?;
    let how = match plan.behaviour.hands_over() {
        _ if plan.learns() => "learned",
        true => "driven by learned policies",
        false => "combined",
    };
    console.line(&format!(
        "behaviour: {} in {}, {how} with seed {seed}",
        plan.behaviour.name(),
        plan.worlds.title()
    ))?;
    if let Some(combination) = &tested.combination {
        print_combination(console, &combination.figures)?;
    }
    print_uses(console, &tested.uses)?;
    print_verdict(console, &verdict)?;
    print_figures(console, &plan, &tested.figures, &lines)?;
    if stop.load(Ordering::Relaxed) {
        return Ok(INTERRUPTED);
    }
    Ok(u8::from(!verdict.is_success()))
}

/// Refuses changes under which the states of what was learned mean something else.
pub(super) fn check_states(learned: &Settings, now: &Settings) -> engine::diagnostic::Result<()> {
    let differs = if !learned.views().eq(now.views()) {
        "other filters or another grid"
    } else if (&learned.state, &learned.stages) != (&now.state, &now.stages) {
        "another state"
    } else {
        return Ok(());
    };
    let message = format!("the policy was learned with {differs}: its states would mean something else");
    let help = "leave that --set out here, and learn with it: engine run SCRIPT --set ...";
    Diagnostic::new("E-POLICY-FILE", message).help(help).fail()
}

/// Refuses settings that a test has no use for.
pub(super) fn check_effect(set: &[String], kind: LearnerKind) -> engine::diagnostic::Result<()> {
    // What remembers its steps has a temperature of its own.
    let chooses = |key: &str| kind != LearnerKind::Memory && FROZEN.contains(&key);
    let learns = |key: &str| key == "run.steps" || key.starts_with("learner.") && !chooses(key);
    let key = set.iter().filter_map(|pair| pair.split('=').next()).map(str::trim).find(|key| learns(key));
    let Some(key) = key else { return Ok(()) };
    let message = format!("'{}' says how to learn, and nothing is learned in a test", printable(key));
    Diagnostic::new("E-SET", message).help("leave it out, or learn with it: engine run SCRIPT --set ...").fail()
}

/// What a pack carries: its policy, under the seed that learned it, or the policies that it combines.
pub(super) fn of_pack(
    pack: &Pack,
    depends: &[Pack],
    overrides: &Overrides,
    sources: Sources,
) -> engine::diagnostic::Result<StoredRun> {
    let Runnable { plan, .. } = pack.plan(depends, overrides, sources)?;
    let evidence = pack.manifest().evidence.as_ref();
    let seed = evidence.and_then(Evidence::shown).map_or(1, |claim| claim.seed);
    if !plan.learns() {
        return Ok(StoredRun { plan, seed, decider: Decider::Combined });
    }
    let Some(policy) = pack.policy(&plan)? else {
        let message = format!("{} carries no learned policy", pack.title());
        let help = "learn it with 'engine run', or build it first: engine pack build FOLDER";
        return Diagnostic::new("E-PACK-POLICY", message).help(help).fail();
    };
    let decider = Decider::Learned(policy);
    Ok(StoredRun { plan, seed, decider })
}
