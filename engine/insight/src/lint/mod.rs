//! What is wrong or suspicious in a behaviour that loads, before anyone waits for it to learn.
//!
//! First what can be read from the script, then what a few thousand steps show, then the best that this reward can be had
//! for. Everything is deterministic: the same script and world give the same findings.

mod choice;
mod cost;
mod exploit;
mod filters;
mod finding;
mod fired;
mod guards;
mod loops;
mod model;
mod mounts;
mod outcome;
mod sarif;
mod scale;
mod setup;
mod shadow;
mod stages;
mod starts;
mod trial;
mod units;
mod verdict;
mod views;

pub use exploit::{Exploit, Exploits};
pub use finding::{Finding, Severity};
pub use model::{Coverage, Model};
pub use sarif::sarif;
pub use trial::{LintTrial, TrialStep};
pub use verdict::ExploitVerdict;

use std::sync::atomic::{AtomicBool, Ordering};

use engine::diagnostic::{Kind, Result};
use engine::experiment::Plan;
use engine::judge::FactId;
use engine::script::Condition;

/// The most findings of one behaviour that are kept.
pub const MOST_FINDINGS: usize = 20;

/// What was found.
#[derive(Debug, Clone, serde::Serialize)]
pub struct Report {
    /// Name of the behaviour.
    pub behaviour: String,
    /// Name of the world.
    pub world: String,
    /// Steps that were tried.
    pub steps: u64,
    /// What is wrong or suspicious, in the order of the lines; 20 at most.
    pub findings: Vec<Finding>,
    /// How many more there are.
    pub left_out: usize,
    /// What the reward can be had for; absent where policies are combined or a step failed.
    pub exploits: Option<Exploits>,
}

impl Report {
    /// Whether there is an error or a warning.
    #[must_use]
    pub fn is_clean(&self) -> bool {
        self.findings.is_empty()
    }
}

/// Looks a behaviour over: its text, some thousand steps, and what its reward can be had for.
///
/// # Errors
/// If a sensor or a filter fails, or a limit stops the script; any other failure of it in a step is a finding.
pub fn check_behaviour(plan: &Plan) -> Result<Report> {
    look(plan, 0, &AtomicBool::new(false))
}

/// Checks on so many threads (0: one for each core), until `stop` is set: then nothing.
///
/// # Errors
/// As [`check_behaviour`].
pub fn check_behaviour_until(plan: &Plan, threads: usize, stop: &AtomicBool) -> Result<Option<Report>> {
    let report = look(plan, threads, stop)?;
    Ok((!stop.load(Ordering::Relaxed)).then_some(report))
}

/// What is found once `stop` is set means nothing.
fn look(plan: &Plan, threads: usize, stop: &AtomicBool) -> Result<Report> {
    // Only the last of several rewards is on trial.
    let plan = &plan.clone().after(Vec::new());
    let mut findings = read(plan);
    let (mut steps, mut exploits) = (0, None);
    if plan.learns() {
        let tried = LintTrial::run(plan, threads, stop)
            .and_then(|mut trial| Ok((Exploits::find(plan, &mut trial, threads, stop)?, trial)));
        match tried {
            Ok((found, trial)) => {
                steps = trial.steps();
                fired::check_firing(plan, &trial, &found, &mut findings);
                scale::observed(plan, &trial, &mut findings);
                choice::observed(plan, &trial, &found, &mut findings);
                verdict::check_exploits(plan, &found, &mut findings);
                outcome::check_goals_met(plan, &trial, &mut findings);
                outcome::check_values(plan, &trial, &mut findings);
                outcome::check_success(plan, threads, stop, &mut findings)?;
                guards::check_guards(plan, &trial, stop, &mut findings)?;
                starts::check_starts(plan, threads, stop, &mut findings)?;
                exploits = Some(found);
            }
            // The script's own mistake is a finding like others; what a limit stopped is not.
            Err(fault) if fault.kind() == Kind::Input => {
                // A reward that fails depends on nothing, and that is not what is wrong with it.
                findings.retain(|finding| finding.code != "W-NO-CHOICE");
                findings.push(Finding::of_error(plan, &fault));
            }
            Err(fault) => return Err(fault),
        }
    }
    // If some must be left out, let it be warnings.
    findings.sort_by_key(|finding| (finding.severity, finding.line));
    let left_out = findings.len().saturating_sub(MOST_FINDINGS);
    findings.truncate(MOST_FINDINGS);
    findings.sort_by_key(|finding| (finding.line, finding.code));
    let (behaviour, world) = (plan.behaviour.name().to_owned(), plan.layout.name.clone());
    Ok(Report { behaviour, world, steps, findings, left_out, exploits })
}

/// What can be read from the script and its settings, without a step.
#[must_use]
pub fn read(plan: &Plan) -> Vec<Finding> {
    let mut findings = Vec::new();
    units::check_units(plan, &mut findings);
    shadow::check_shadows(plan, &mut findings);
    loops::check_loops(plan, &mut findings);
    cost::check_cost(plan, &mut findings);
    scale::written(plan, &mut findings);
    setup::check_setup(plan, &mut findings);
    choice::written(plan, &mut findings);
    outcome::check_goals(plan, &mut findings);
    stages::check_stages(plan, &mut findings);
    views::check_views(plan, &mut findings);
    mounts::check_mounts(plan, &mut findings);
    filters::check_filters(plan, &mut findings);
    findings
}

/// The facts that a condition wants to be true.
fn read_flags(condition: &Condition) -> impl Iterator<Item = FactId> {
    let found = match condition {
        Condition::Flag(fact, false) => vec![fact.id],
        Condition::All(parts) | Condition::Any(parts) => parts.iter().flat_map(read_flags).collect(),
        _ => Vec::new(),
    };
    found.into_iter()
}
