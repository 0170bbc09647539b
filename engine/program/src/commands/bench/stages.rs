//! The stages of a step, each alone, on situations of a run that acts at random.

use std::hint::black_box;
use std::sync::Arc;

use engine::allowed::Allowed;
use engine::diagnostic::{Diagnostic, Result};
use engine::experiment::{Cycle, Ledger, Observer, Plan, Step};
use engine::filter::Chain;
use engine::geometry::{Isometry3, Pose};
use engine::judge::{Facts, Judge};
use engine::learner::{Learner, ShippedLearner, Transition, shipped_learner};
use engine::random::{Random, Stream};
use engine::robot::SimulatedRobot;
use engine::sensors::observation::{Image, Scan};
use engine::sensors::{Camera, Laser};
use engine::state::Grid;
use engine::world::World;

/// Situations that every stage is measured on.
pub(crate) const SAMPLES: usize = 64;
/// Steps between two samples: far enough that they differ.
const SPACING: usize = 16;

/// Steps in a log, before the next one begins.
const LOGGED: u64 = 4096;

/// One stage: its name, and what does it once on the situation with the number given, below [`SAMPLES`].
pub(crate) type Stage = (&'static str, fn(&mut Stages, usize));

/// In the order of a step.
pub(crate) const STAGES: [Stage; 8] = [
    ("physics", Stages::physics),
    ("camera", Stages::camera),
    ("laser", Stages::laser),
    ("filter", Stages::filter),
    ("state", Stages::state),
    ("script", Stages::script),
    ("learner", Stages::learner),
    ("log", Stages::log),
];

/// Everything that a step needs, with situations to use it on.
pub(crate) struct Stages {
    plan: Plan,
    samples: Vec<Situation>,
    world: World,
    camera: Camera,
    laser: Laser,
    image: Image,
    scan: Scan,
    chain: Chain,
    grid: Grid,
    judge: Judge,
    learner: ShippedLearner,
    cycle: Cycle<SimulatedRobot>,
    step: Step,
    ledger: Ledger,
    logged: u64,
    failure: Option<Box<Diagnostic>>,
}

struct Situation {
    pose: Pose,
    body: Isometry3,
    image: Image,
    mask: Vec<u8>,
    facts: Facts,
    state: usize,
}

impl Stages {
    /// Records the situations.
    ///
    /// # Errors
    /// If the behaviour cannot be run.
    pub(crate) fn new(plan: &Plan) -> Result<Self> {
        let samples = record(plan)?;
        let (settings, layout) = (&plan.settings, &plan.layout);
        let grid = plan.grid()?;
        let mut judge = plan.judge()?;
        judge.facts_mut().clone_from(&samples[0].facts);
        judge.calibrate()?;
        let mut cycle = Cycle::new(plan, SimulatedRobot::new(layout, settings, 1)?)?;
        Ok(Self {
            world: World::new(Arc::clone(layout), &[settings.robot], settings.run.period_s, 1),
            camera: Camera::new(&layout.scene, &settings.camera, 1),
            laser: Laser::new(&layout.scene, &settings.laser, 1),
            image: samples[0].image.clone(),
            scan: Scan { ranges_m: vec![0.0; settings.laser.beams as usize] },
            chain: plan.chain()?,
            learner: shipped_learner(&settings.learner, plan.task(&*plan.state_map()?, 1)?),
            grid,
            judge,
            step: cycle.step(0)?,
            cycle,
            ledger: Ledger::new(plan, LOGGED),
            logged: 0,
            failure: None,
            samples,
            plan: plan.clone(),
        })
    }

    /// Whether every stage did its work.
    ///
    /// # Errors
    /// The last failure of a filter or the script.
    pub(crate) fn finish(self) -> Result<()> {
        self.failure.map_or(Ok(()), Err)
    }

    fn physics(&mut self, index: usize) {
        if index.is_multiple_of(8) {
            self.world.place(0, self.samples[index].pose);
        }
        let actions = &self.plan.settings.actions;
        black_box(self.world.advance(&[actions[index % actions.len()]]));
    }

    fn camera(&mut self, index: usize) {
        self.camera.render(&self.samples[index].body, self.world.seen_by(0), black_box(&mut self.image));
    }

    fn laser(&mut self, index: usize) {
        self.laser.scan(&self.samples[index].body, self.world.seen_by(0), black_box(&mut self.scan));
    }

    fn filter(&mut self, index: usize) {
        if let Err(error) = black_box(self.chain.apply(black_box(&self.samples[index].image))) {
            let error = Diagnostic::new("E-FILTER", format!("a filter failed: {error}"));
            self.failure = Some(Box::new(error));
        }
    }

    fn state(&mut self, index: usize) {
        black_box(self.grid.encode(black_box(&self.samples[index].mask)));
    }

    fn script(&mut self, index: usize) {
        self.judge.facts_mut().clone_from(&self.samples[index].facts);
        if let Err(error) = black_box(self.judge.judge()) {
            self.failure = Some(error);
        }
    }

    fn log(&mut self, _: usize) {
        if self.logged == LOGGED {
            (self.ledger, self.logged) = (Ledger::new(&self.plan, LOGGED), 0);
        }
        self.logged += 1;
        let _ = black_box(&mut self.ledger).stepped(black_box(&self.cycle), &self.step);
    }

    fn learner(&mut self, index: usize) {
        let (state, next_state) = (self.samples[index].state, self.samples[(index + 1) % SAMPLES].state);
        let (action, _) = self.learner.choose(state, Allowed::ALL);
        let (potential, next_potential) = (0.0, 0.0);
        let transition = Transition {
            state,
            action,
            reward: 0.0,
            next_state,
            ending: None,
            potential,
            next_potential,
            next_allowed: Allowed::ALL,
        };
        self.learner.learn(&transition);
    }
}

fn record(plan: &Plan) -> Result<Vec<Situation>> {
    let mut cycle = Cycle::new(plan, SimulatedRobot::new(&plan.layout, &plan.settings, 1)?)?;
    let mut random = Random::new(1, Stream::Test);
    let mut samples = Vec::with_capacity(SAMPLES);
    for index in 0..SAMPLES * SPACING {
        let step = cycle.step(random.below(plan.settings.actions.len() as u32) as usize)?;
        if index % SPACING == 0 {
            let body = cycle.robot().world().body(0);
            samples.push(Situation {
                pose: body.pose,
                body: body.world_from_robot(),
                image: cycle.observation().sight().clone(),
                mask: cycle.mask().to_vec(),
                facts: cycle.facts().clone(),
                state: step.next_state,
            });
        }
        if step.then.is_some() {
            cycle.recover()?;
        }
    }
    Ok(samples)
}
