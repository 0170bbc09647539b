//! The distinct jobs of all claims, each done once: learning under every seed, then every further test of the policy.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::claims::{CLAIMS, Claim};
use super::job::{Learn, Trial};
use super::looks::{Look, Seen, Watcher};
use engine::diagnostic::Result;
use engine::experiment::{
    Overrides, Plan, RunLog, Summary, TestRun, Trail, WINDOW_STEPS, in_parallel, run_seed, test_and_watch,
};
use engine::learner::Policy;
use engine::script::Behaviour;
use engine::verdict::TestFigures;

/// Seeds, steps of learning and steps of a test in a quick check.
pub(super) const QUICK: (u64, u64, u64) = (2, 800, 200);

/// What is asked for.
#[derive(Debug, Clone)]
pub struct Options {
    /// The folder of the scripts.
    pub scripts: PathBuf,
    /// The first seed.
    pub seed: u64,
    /// How many seeds.
    pub seeds: u64,
    /// Threads; 0 is one for each core.
    pub threads: usize,
    /// Two seeds and few steps, to see that every row computes.
    pub quick: bool,
    /// Only these rows; all if empty.
    pub only: Vec<String>,
}

impl Options {
    /// How long and under how many seeds a job is really done.
    #[must_use]
    pub fn learn(&self, learn: Learn) -> (Learn, Vec<u64>) {
        let (most, steps, test_steps) = QUICK;
        let seeds = self.seeds.min(learn.most_seeds).min(if self.quick { most } else { u64::MAX });
        let seeds = (0..seeds).map(|index| self.seed.wrapping_add(index)).collect();
        let learn = if self.quick { Learn { steps: Some(steps), test_steps, ..learn } } else { learn };
        (learn, seeds)
    }

    /// How long a further test really is.
    #[must_use]
    pub const fn trial(&self, trial: Trial) -> Trial {
        if self.quick { Trial { steps: QUICK.2, ..trial } } else { trial }
    }

    /// The claims that are asked for, in the order of the table.
    pub fn claims(&self) -> impl Iterator<Item = &'static Claim> {
        CLAIMS.iter().filter(|claim| self.only.is_empty() || self.only.iter().any(|id| id == claim.id))
    }
}

/// All jobs, ready to run.
pub struct Campaign {
    options: Options,
    jobs: Vec<Job>,
}

struct Job {
    learn: Learn,
    plan: std::result::Result<Plan, String>,
    seeds: Vec<u64>,
    trials: Vec<(Trial, std::result::Result<Plan, String>)>,
}

/// One seed of one job.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// What learning and the script's own test found.
    pub summary: Summary,
    /// The path of the first 400 steps.
    pub early: Trail,
    /// The script's own test.
    pub tested: TestRun,
    /// What was learned.
    pub policy: Policy,
    /// Every further test, in the order of the job's trials; `None` where its world is missing.
    pub trials: Vec<Option<(TestFigures, Seen)>>,
}

/// One job's results.
pub struct JobResult {
    /// The job as the claims name it.
    pub learn: Learn,
    /// What was run, or why nothing was.
    pub plan: std::result::Result<Plan, String>,
    /// The trials, each with its plan or the reason why there is none.
    pub trials: Vec<(Trial, std::result::Result<Plan, String>)>,
    /// By seed.
    pub outcomes: Vec<Outcome>,
}

/// Everything that was measured.
pub struct Measured {
    /// What was asked for.
    pub options: Options,
    /// By job, in the order in which the claims first name them.
    pub jobs: Vec<JobResult>,
}

impl Measured {
    /// The results of a job.
    #[must_use]
    pub fn job(&self, learn: Learn) -> Option<&JobResult> {
        self.jobs.iter().find(|job| job.learn == learn)
    }
}

impl Campaign {
    /// Collects the jobs of all claims that are asked for. What cannot be loaded is remembered, not an error.
    #[must_use]
    pub fn new(options: Options) -> Self {
        let mut wanted: Vec<(Learn, Vec<Trial>)> = Vec::new();
        for (learn, trial) in options.claims().flat_map(Claim::jobs) {
            let at = wanted.iter().position(|(known, _)| *known == learn).unwrap_or_else(|| {
                wanted.push((learn, Vec::new()));
                wanted.len() - 1
            });
            if let Some(trial) = trial.filter(|trial| !wanted[at].1.contains(trial)) {
                wanted[at].1.push(trial);
            }
        }
        let jobs = wanted.into_iter().map(|(learn, trials)| Job::new(&options, learn, &trials)).collect();
        Self { options, jobs }
    }

    /// Steps of learning and testing in all jobs.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.jobs.iter().map(|job| job.steps_per_seed() * job.seeds.len() as u64).sum()
    }

    /// Does all jobs. `done` is told steps as they are done.
    ///
    /// # Errors
    /// If no threads can be started. A job that fails is told in its rows.
    pub fn run(self, stop: &AtomicBool, done: &(dyn Fn(u64) + Sync)) -> Result<Measured> {
        let mut units: Vec<(usize, u64)> = Vec::new();
        for (index, job) in self.jobs.iter().enumerate() {
            units.extend(job.seeds.iter().map(|seed| (index, *seed)));
        }
        // Long jobs go first, so that no core waits for one at the end; results are put back into order.
        units.sort_by_key(|(index, seed)| (std::cmp::Reverse(self.jobs[*index].steps_per_seed()), *index, *seed));
        let numbers: Vec<u64> = (0..units.len() as u64).collect();
        let outcomes = in_parallel(&numbers, self.options.threads, |number| {
            let (index, seed) = units[number as usize];
            Ok(self.jobs[index].learn_and_test(seed, stop, done).map_err(|error| error.message))
        })?;
        let mut found: Vec<_> = units.into_iter().zip(outcomes).collect();
        found.sort_by_key(|(unit, _)| *unit);
        let mut jobs: Vec<JobResult> = (self.jobs.into_iter())
            .map(|Job { learn, plan, trials, .. }| JobResult { learn, plan, trials, outcomes: Vec::new() })
            .collect();
        for ((index, seed), outcome) in found {
            match outcome {
                Ok(Some(outcome)) => jobs[index].outcomes.push(outcome),
                Ok(None) => {}
                Err(message) => jobs[index].plan = Err(format!("seed {seed}: {message}")),
            }
        }
        Ok(Measured { options: self.options, jobs })
    }
}

impl Job {
    fn new(options: &Options, learn: Learn, trials: &[Trial]) -> Self {
        let (real, seeds) = options.learn(learn);
        let path = options.scripts.join(format!("{}.rhai", real.script));
        let plan = Behaviour::load(&path).and_then(|behaviour| {
            let set = real.changes().map(str::to_owned).collect();
            let overrides =
                Overrides { steps: real.steps, test_steps: Some(real.test_steps), set, ..Overrides::default() };
            Plan::new(Arc::new(behaviour), &overrides)
        });
        let plan = plan.map_err(|error| error.message);
        let trials = trials.iter().map(|trial| {
            let trial_plan = plan.clone().and_then(|plan| {
                let real = options.trial(*trial);
                let set = real.set.iter().map(|pair| (*pair).to_owned()).collect();
                let world = real.world.map(str::to_owned);
                plan.with_changes(&Overrides { world, test_steps: Some(real.steps), set, ..Overrides::default() })
                    .map_err(|error| error.message)
            });
            (*trial, trial_plan)
        });
        Self { learn, seeds, trials: trials.collect(), plan }
    }

    fn steps_per_seed(&self) -> u64 {
        let Ok(plan) = &self.plan else { return 0 };
        let trials = self.trials.iter().filter_map(|(_, plan)| plan.as_ref().ok());
        plan.settings.run.steps
            + plan.settings.run.test_steps
            + trials.map(|plan| plan.settings.run.test_steps).sum::<u64>()
    }

    fn learn_and_test(&self, seed: u64, stop: &AtomicBool, done: &(dyn Fn(u64) + Sync)) -> Result<Option<Outcome>> {
        let Ok(plan) = &self.plan else { return Ok(None) };
        let run = run_seed(plan, seed, stop, &|_| done(WINDOW_STEPS), &mut RunLog::off())?;
        // A behaviour that combines policies learns nothing that a claim could be about.
        let Some(learned) = run.learned else { return Ok(None) };
        done(plan.settings.run.test_steps);
        let trials = (self.trials.iter())
            .map(|(trial, plan)| {
                let Ok(plan) = plan else { return Ok(None) };
                let seen = look(plan, &learned.policy, seed, stop, trial.look)?;
                done(plan.settings.run.test_steps);
                Ok(Some(seen))
            })
            .collect::<Result<Vec<_>>>()?;
        let (summary, tested) = (run.summary, run.tested);
        Ok(Some(Outcome { summary, early: learned.early, tested, policy: learned.policy, trials }))
    }
}

fn look(plan: &Plan, policy: &Policy, seed: u64, stop: &AtomicBool, look: Look) -> Result<(TestFigures, Seen)> {
    let mut watcher = Watcher::new(look);
    let tested = test_and_watch(plan, policy, seed, stop, &mut watcher)?;
    Ok((tested.figures, watcher.finish()))
}
