//! The test: the frozen policy at the lowest temperature, judged by the truth as well as by the script.

use std::sync::atomic::{AtomicBool, Ordering};

use super::digest::StateHash;
use super::summary::TestFigures;
use super::trail::{Recorder, Trail};
use super::truth::Truth;
use super::{CombinationFigures, Cycle, Disagreements, Eyes, Ledger, Member, Plan, Step, Tally, WINDOW_STEPS};
use crate::diagnostic::Result;
use crate::learner::{Combined, Policy};
use crate::random::{Random, Stream};
use crate::robot::SimulatedRobot;
use crate::sensors::observation::Image;
use crate::settings::Settings;

/// Steps of the test whose path is kept for drawing.
const TRAIL_STEPS: u64 = 2 * WINDOW_STEPS;
/// The step after which one frame is kept for drawing.
const SNAPSHOT_STEP: u64 = 60;
/// Added to the seed, so that the noise of the test is not the noise of learning again.
pub(super) const TEST_SEED_OFFSET: u64 = 0x5eed_0000_0000_0000;

/// One frame with what the filter and the grid made of it.
#[derive(Debug, Clone)]
pub struct Snapshot {
    /// The camera image.
    pub image: Image,
    /// The mask.
    pub mask: Vec<u8>,
    /// Rows and columns of the grid.
    pub grid: (usize, usize),
    /// Share of foreground pixels of each cell.
    pub shares: Vec<f32>,
    /// Whether each cell is occupied by itself.
    pub occupied: Vec<bool>,
    /// The cells that the state stands for, filled columns included.
    pub filled: Vec<bool>,
    /// The state.
    pub state: usize,
}

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
    /// Hash over every step, 64 hexadecimal digits.
    pub state_hash: String,
}

/// What a test of several policies found.
#[derive(Debug, Clone)]
pub struct CombinedRun {
    /// The test itself.
    pub run: TestRun,
    /// Who decided, and where they disagreed.
    pub figures: CombinationFigures,
    /// All disagreements.
    pub disagreements: Disagreements,
}

/// Tests a frozen policy for the plan's `run.test_steps`, or until `stop` is set.
///
/// # Errors
/// If a sensor, a filter or the script fails.
pub fn test(plan: &Plan, policy: &Policy, seed: u64, stop: &AtomicBool) -> Result<TestRun> {
    test_and_watch(plan, policy, seed, stop, &mut |_, _| ())
}

/// The same test, with a look at every step before any recovery. Looking changes nothing.
///
/// # Errors
/// As [`test()`].
pub fn test_and_watch(plan: &Plan, policy: &Policy, seed: u64, stop: &AtomicBool, watch: Watch<'_>) -> Result<TestRun> {
    let mut softmax = policy.softmax(&plan.settings.learner);
    let mut random = Random::new(seed, Stream::Test);
    drive(plan, Vec::new(), seed, stop, |states| policy.choose(states[0], &mut softmax, &mut random), watch)
}

/// The same test, with every step kept in a ledger.
///
/// # Errors
/// As [`test()`].
pub fn test_into(plan: &Plan, policy: &Policy, seed: u64, stop: &AtomicBool, ledger: &mut Ledger) -> Result<TestRun> {
    let mut keep = |cycle: &Cycle<SimulatedRobot>, step: &Step| {
        let explored = policy.best(step.state).is_none_or(|(best, _)| best != step.action);
        ledger.add(cycle, step, explored);
    };
    test_and_watch(plan, policy, seed, stop, &mut keep)
}

/// Tests several policies as one, as [`test_and_watch`] does; the plan's script judges.
///
/// # Errors
/// As [`test()`], and if a policy's filters or grid do not suit the plan's camera.
pub fn test_combined(
    plan: &Plan,
    members: &[Member],
    seed: u64,
    stop: &AtomicBool,
    watch: Watch<'_>,
) -> Result<CombinedRun> {
    let Settings { combine, learner, run, .. } = &plan.settings;
    let policies: Vec<&Policy> = members.iter().map(|member| &member.policy).collect();
    let mut combined = Combined::new(&policies, combine, learner);
    let mut random = Random::new(seed, Stream::Test);
    let mut disagreements = Disagreements::new(&combined, run.test_steps);
    let eyes = members.iter().map(|member| member.eyes(plan)).collect::<Result<Vec<_>>>()?;
    let choose = |states: &[usize]| {
        // The first state is the script's own.
        let decision = combined.choose(&states[1..], &mut random);
        disagreements.count(&states[1..], combined.votes(), &decision);
        decision.action
    };
    let run = drive(plan, eyes, seed, stop, choose, watch)?;
    let figures = CombinationFigures::new(plan, members, &disagreements);
    Ok(CombinedRun { run, figures, disagreements })
}

/// Tests whatever chooses by the present state, as [`test_and_watch`] does.
///
/// # Errors
/// As [`test()`].
pub fn test_choices(
    plan: &Plan,
    seed: u64,
    stop: &AtomicBool,
    mut choose: impl FnMut(usize) -> usize,
    watch: Watch<'_>,
) -> Result<TestRun> {
    drive(plan, Vec::new(), seed, stop, |states| choose(states[0]), watch)
}

/// What looks at every step of a test.
pub type Watch<'a> = &'a mut dyn FnMut(&Cycle<SimulatedRobot>, &Step);

fn drive(
    plan: &Plan,
    eyes: Vec<Eyes>,
    seed: u64,
    stop: &AtomicBool,
    mut choose: impl FnMut(&[usize]) -> usize,
    watch: Watch<'_>,
) -> Result<TestRun> {
    let settings = &plan.settings;
    let world_seed = seed.wrapping_add(TEST_SEED_OFFSET);
    let robot = SimulatedRobot::new(&plan.layout, settings, world_seed)?;
    let mut cycle = Cycle::with_eyes(plan, robot, eyes)?;
    let mut hash = StateHash::default();
    let mut tally = Tally::new(plan.behaviour.rules().len(), settings.run.test_steps);
    let mut truth = Truth::new(cycle.robot().world(), settings.run.period_s, settings.run.test_steps);
    let mut trail = Recorder::new(TRAIL_STEPS, cycle.robot().world());
    let mut snapshot = None;
    let mut steps = 0;
    while steps < settings.run.test_steps {
        let action = choose(cycle.states());
        let step = cycle.step(action)?;
        steps += 1;
        hash.step(&step, cycle.robot().world().body(0).pose);
        truth.follow(cycle.robot().world());
        watch(&cycle, &step);
        trail.follow(cycle.robot().world(), step.failed());
        if steps <= SNAPSHOT_STEP {
            snapshot = (steps == SNAPSHOT_STEP || steps == settings.run.test_steps).then(|| Snapshot::of(&cycle));
        }
        if step.recover {
            cycle.recover()?;
            truth.jump(cycle.robot().world());
            trail.jump(cycle.robot().world());
        }
        if tally.count(&step, cycle.fired()) && stop.load(Ordering::Relaxed) {
            break;
        }
    }
    let lap_m = plan.layout.lap.map(|lap| plan.layout.routes[lap].length_m());
    let figures = TestFigures::new(steps, settings.run.period_s, lap_m, &tally, &truth);
    let snapshot = snapshot.unwrap_or_else(|| Snapshot::of(&cycle));
    Ok(TestRun { figures, trail: trail.finish(), snapshot, tally, state_hash: hash.finish(&[]) })
}

impl Snapshot {
    /// The present frame.
    #[must_use]
    pub fn of(cycle: &Cycle<SimulatedRobot>) -> Self {
        let grid = cycle.grid();
        let counts = grid.counts().iter().enumerate();
        Self {
            image: cycle.robot().photograph(),
            mask: cycle.mask().to_vec(),
            shares: counts.map(|(cell, count)| *count as f32 / grid.area_px(cell) as f32).collect(),
            grid: grid.size(),
            occupied: grid.occupied().to_vec(),
            filled: grid.cells(cycle.state()),
            state: cycle.state(),
        }
    }
}
