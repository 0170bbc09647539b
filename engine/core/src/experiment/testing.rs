//! The test: whatever decides, frozen, judged by the truth as well as by the script.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

use super::by_world::{WorldCounts, WorldFigures};
use super::digest::StateHash;
use super::doors::check_policy;
use super::measured::figures;
use super::probes::Probes;
use super::relay::UsedDrivers;
use super::snapshot::{Glimpse, Snapshot};
use super::staged::Staged;
use super::trail::{Recorder, Trail};
use super::truth::Truth;
use super::use_figures::UseCounts;
use super::{
    ByState, Chooser, CombinationFigures, Cycle, Disagreements, Frozen, Learned, Member, Observer, Phase, Plan, Step,
    Tally, Together, UseFigures, WINDOW_STEPS, drive,
};
use crate::diagnostic::Result;
use crate::learner::{Combined, Policy};
use crate::outcome::Ending;
use crate::random::{Random, Stream};
use crate::robot::{Robot, SimulatedRobot};
use crate::settings::Settings;
use crate::verdict::TestFigures;

/// Steps of the test whose path is kept for drawing.
const TRAIL_STEPS: u64 = 2 * WINDOW_STEPS;
/// The step after which one frame is kept for drawing.
const SNAPSHOT_STEP: u64 = 60;

/// Of so many goals the durations are kept.
const MOST_GOALS: u64 = 1 << 16;

/// What a test found.
#[derive(Debug, Clone)]
pub struct TestRun {
    /// The figures.
    pub figures: TestFigures,
    /// The path of the first 800 steps.
    pub trail: Trail,
    /// One frame of it.
    pub snapshot: Snapshot,
    /// What was counted.
    pub tally: Tally,
    /// How often each action was chosen.
    pub chosen: Vec<u64>,
    /// Hash over every step, 64 hexadecimal digits.
    pub state_hash: String,
    /// Of a script that uses learned policies: how much each of them drove.
    pub uses: Vec<UseFigures>,
    /// Of several policies as one: who decided, and where they disagreed.
    pub combination: Option<CombinationTest>,
    /// Of several worlds: what was done in each.
    pub worlds: Vec<WorldFigures>,
}

/// What a test of several policies found beside the figures.
#[derive(Debug, Clone)]
pub struct CombinationTest {
    /// Who decided, and where they disagreed most.
    pub figures: CombinationFigures,
    /// All disagreements.
    pub disagreements: Disagreements,
}

/// What decides in a test.
#[derive(Debug, Clone)]
pub enum Decider {
    /// A policy that was learned.
    Learned(Policy),
    /// The policies that the plan's script combines, see [`Plan::members`].
    Combined,
}

impl Decider {
    /// What was learned; without it, what the plan combines.
    #[must_use]
    pub fn of(learned: Option<&Learned>) -> Self {
        learned.map_or(Self::Combined, |learned| Self::Learned(learned.policy.clone()))
    }

    /// Tests it for the plan's `run.test_steps`, or until `stop` is set; `also` looks on.
    ///
    /// # Errors
    /// If a sensor, a filter or the script fails, or a policy's filters or grid do not suit the plan's camera.
    pub fn test(
        &self,
        plan: &Plan,
        seed: u64,
        stop: &AtomicBool,
        also: &mut impl Observer<SimulatedRobot>,
    ) -> Result<TestRun> {
        match self {
            Self::Learned(policy) => test_and_watch(plan, policy, seed, stop, also),
            Self::Combined => test_combined(plan, seed, stop, also),
        }
    }
}

/// Tests a frozen policy for the plan's `run.test_steps`, or until `stop` is set.
///
/// # Errors
/// If a sensor, a filter or the script fails; `E-POLICY` if the policy has other actions or states than the plan.
pub fn test(plan: &Plan, policy: &Policy, seed: u64, stop: &AtomicBool) -> Result<TestRun> {
    test_and_watch(plan, policy, seed, stop, &mut ())
}

/// Tests a frozen policy while `also` looks on. Looking changes nothing.
///
/// # Errors
/// As [`test()`].
pub fn test_and_watch(
    plan: &Plan,
    policy: &Policy,
    seed: u64,
    stop: &AtomicBool,
    also: &mut impl Observer<SimulatedRobot>,
) -> Result<TestRun> {
    check_policy(plan, policy)?;
    let mut used = UsedDrivers::new(plan, Phase::Test.seed(seed));
    match used.is_empty() {
        true => test_choices(plan, seed, stop, &mut frozen(plan, policy, seed), also),
        false => test_choices(plan, seed, stop, &mut used.with(frozen(plan, policy, seed)), also),
    }
}

/// A policy as it chooses in the test of a seed.
#[must_use]
pub fn frozen<'a>(plan: &Plan, policy: &'a Policy, seed: u64) -> Frozen<'a> {
    Frozen::new(policy, policy.room(&plan.settings.learner), Random::new(seed, Stream::Test))
}

/// Tests whatever chooses, in the simulator.
///
/// # Errors
/// As [`test()`].
pub fn test_choices(
    plan: &Plan,
    seed: u64,
    stop: &AtomicBool,
    chooser: &mut impl Chooser,
    also: &mut impl Observer<SimulatedRobot>,
) -> Result<TestRun> {
    let mut cycle = Cycle::going_on_from(plan, Phase::Test.robot(plan, seed)?, chooser.kept())?;
    test_robot(plan, &mut cycle, chooser, stop, also)
}

/// Tests whoever chooses without looking: no image is drawn unless the script itself reads what the camera sees. The figures are
/// those of [`test_choices`].
pub(super) fn test_without_looking(
    plan: &Plan,
    seed: u64,
    stop: &AtomicBool,
    chooser: &mut impl Chooser,
) -> Result<TestFigures> {
    let eyes = if plan.behaviour.reads_views() { plan.eyes()? } else { plan.eyes()?.closed() };
    let mut cycle = Cycle::with_eyes(plan, Phase::Test.robot(plan, seed)?, eyes, Vec::new())?;
    Ok(test_robot(plan, &mut cycle, chooser, stop, &mut ())?.figures)
}

/// Tests the plan's combined policies as one; the plan's script judges.
fn test_combined(
    plan: &Plan,
    seed: u64,
    stop: &AtomicBool,
    also: &mut impl Observer<SimulatedRobot>,
) -> Result<TestRun> {
    if plan.behaviour.hands_over() {
        let mut used = UsedDrivers::new(plan, Phase::Test.seed(seed));
        // The last use always holds: nobody else is asked.
        return test_choices(plan, seed, stop, &mut used.with(ByState(|_| 0)), also);
    }
    let Settings { combine, learner, run, .. } = &plan.settings;
    let policies: Vec<&Policy> = plan.members.iter().map(|member| &member.policy).collect();
    let combined = Combined::new(&policies, combine, learner);
    let mut together = Together::new(combined, Random::new(seed, Stream::Test), run.test_steps);
    let eyes = plan.members.iter().map(|member: &Member| member.eyes(plan)).collect::<Result<Vec<_>>>()?;
    let mut cycle = Cycle::with_eyes(plan, Phase::Test.robot(plan, seed)?, plan.eyes()?, eyes)?;
    let run = test_robot(plan, &mut cycle, &mut together, stop, also)?;
    let disagreements = together.into_disagreements();
    let figures = CombinationFigures::new(plan, &disagreements);
    Ok(TestRun { combination: Some(CombinationTest { figures, disagreements }), ..run })
}

/// Tests whatever chooses on any robot, as it is now, for the plan's `run.test_steps` or until `stop` is set.
///
/// # Errors
/// If the robot, a filter or the script fails.
pub fn test_robot<R: Robot>(
    plan: &Plan,
    cycle: &mut Cycle<R>,
    chooser: &mut impl Chooser,
    stop: &AtomicBool,
    also: &mut impl Observer<R>,
) -> Result<TestRun> {
    let run = &plan.settings.run;
    let mut hash = StateHash::default();
    let mut truth = Truth::new(cycle.robot(), &plan.worlds, run.period_s, run.test_steps);
    let mut trail = Recorder::new(TRAIL_STEPS, cycle.robot()).in_every_world();
    let mut glimpse = Glimpse::after(SNAPSHOT_STEP.min(run.test_steps));
    let tally = Tally::new(plan.behaviour.rules().len(), run.test_steps);
    let goals_steps = Vec::with_capacity(run.test_steps.min(MOST_GOALS) as usize);
    let (mut probes, mut staged) = (Probes::new(plan, cycle.robot()), Staged::new(plan));
    let chosen = vec![0; plan.motions().len()];
    let used = UseCounts::new(plan);
    let worlds = WorldCounts::new(plan);
    let mut counts = Counts { tally, chosen, used, worlds, attempt_steps: 0, goals_steps, goal_crashes: 0, stop };
    let mut observers =
        (&mut hash, ((&mut truth, also), ((&mut trail, (&mut probes, &mut staged)), (&mut glimpse, &mut counts))));
    let steps = drive(cycle, chooser, &mut observers, run.test_steps)?;
    let figures = figures(
        plan,
        steps,
        &counts.tally,
        (&counts.goals_steps, counts.goal_crashes),
        truth.as_ref(),
        probes.finish(),
        staged.finish(),
    );
    let snapshot = glimpse.taken.unwrap_or_else(|| Snapshot::of(cycle));
    let (trail, state_hash) = (trail.finish(), hash.finish());
    let Counts { tally, chosen, used, worlds, .. } = counts;
    let (uses, worlds) = (used.figures(plan), worlds.figures(plan));
    Ok(TestRun { figures, trail, snapshot, tally, chosen, state_hash, combination: None, uses, worlds })
}

/// Counts, and looks after each step whether to stop.
struct Counts<'a> {
    tally: Tally,
    /// By action: how often it was chosen.
    chosen: Vec<u64>,
    used: UseCounts,
    worlds: WorldCounts,
    /// Steps of the present attempt, and of each that reached its goal.
    attempt_steps: u32,
    goals_steps: Vec<u32>,
    /// Goals in whose last step the robot touched something or fell.
    goal_crashes: u64,
    stop: &'a AtomicBool,
}

impl<R: Robot> Observer<R> for Counts<'_> {
    fn stepped(&mut self, cycle: &Cycle<R>, step: &Step) -> ControlFlow<()> {
        self.attempt_steps += 1;
        self.used.count(step);
        self.worlds.count(cycle.robot().world_index(), step);
        if let Some(count) = self.chosen.get_mut(step.action) {
            *count += 1;
        }
        if let Some(ending) = step.ending() {
            let steps = std::mem::take(&mut self.attempt_steps);
            let crashed = step.contact || cycle.facts().fallen;
            self.goal_crashes += u64::from(ending == Ending::Goal && crashed);
            if ending == Ending::Goal && self.goals_steps.len() < self.goals_steps.capacity() {
                self.goals_steps.push(steps);
            }
        }
        self.tally.count(step, cycle.fired());
        if self.stop.load(Ordering::Relaxed) {
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    }

    fn recovered(&mut self, _: &Cycle<R>) {
        // After a hop another attempt begins.
        self.attempt_steps = 0;
    }
}
