//! `engine bench`: steps per second on one core and on all, and the microseconds of each stage.

use std::hint::black_box;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use engine::diagnostic::{Diagnostic, Kind, Result};
use engine::experiment::{Cycle, Ledger, Overrides, Plan, in_parallel, learn};
use engine::filter::Chain;
use engine::geometry::{Isometry3, Pose};
use engine::learner::{Learner, Transition};
use engine::random::{Random, Stream};
use engine::reward::{Behaviour, Facts};
use engine::robot::SimulatedRobot;
use engine::sensors::observation::{Image, Scan};
use engine::sensors::{Camera, Laser};
use engine::world::World;

use crate::cli::BenchArguments;
use crate::console::{Console, ConsoleError};

/// Situations that every stage is measured on.
const SAMPLES: usize = 64;
/// Steps between two samples: far enough that they differ.
const SPACING: usize = 16;
/// Each figure is the median of so many rounds.
const ROUNDS: usize = 7;

#[derive(serde::Serialize)]
struct Report {
    behaviour: String,
    world: String,
    image: [u64; 2],
    cores: usize,
    steps_per_second_one_core: f64,
    steps_per_second_all_cores: f64,
    step_us: f64,
    stages: Vec<Stage>,
    copy_of_one_frame_us: f64,
}

/// Microseconds of one stage in each step.
#[derive(serde::Serialize)]
struct Stage {
    name: &'static str,
    us: f64,
}

pub(crate) fn run(arguments: &BenchArguments, console: &mut Console) -> std::result::Result<u8, ConsoleError> {
    let behaviour = Arc::new(Behaviour::load(&arguments.behaviour)?);
    let (world, set) = (arguments.world.clone(), arguments.set.clone());
    let overrides = Overrides { world, steps: Some(arguments.steps), test_steps: None, set };
    let plan = Plan::with_filters(behaviour, &overrides, super::sources::catalogue(&arguments.filters)?)?;
    if !plan.settings.policies.is_empty() {
        let message = format!("'{}' combines policies and learns nothing", plan.behaviour.name());
        let error = Diagnostic::new(Kind::Usage, "E-POLICY", message).help("measure a behaviour that learns");
        return Err(ConsoleError::Failed(Box::new(error)));
    }
    let report = measure(&plan, arguments.steps)?;
    console.json(&report)?;
    print(console, &report)?;
    Ok(0)
}

fn print(console: &mut Console, report: &Report) -> std::result::Result<(), ConsoleError> {
    let [width, height] = report.image;
    console.line(&format!("{} in {}, image {width}x{height}", report.behaviour, report.world))?;
    console.line(&format!(
        "one core:  {:>8.0} steps per second ({:.1} us for each)",
        report.steps_per_second_one_core, report.step_us
    ))?;
    console.line(&format!("{} cores:   {:>8.0} steps per second", report.cores, report.steps_per_second_all_cores))?;
    console.line("microseconds for each step, stage by stage:")?;
    for Stage { name, us } in &report.stages {
        console.line(&format!("  {name:10} {us:8.2}"))?;
    }
    console.line(&format!("for scale, a copy of one RGB frame: {:.2} us", report.copy_of_one_frame_us))
}

fn measure(plan: &Plan, steps: u64) -> Result<Report> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let stop = AtomicBool::new(false);
    let silent = |_| ();
    // The scene's and the noise's tables are built on first use.
    learn(&with_steps(plan, 400), 1, &stop, &silent)?;
    let one = timed(|| learn(plan, 1, &stop, &silent)?.whole().map(|_| ()))?;
    let seeds: Vec<u64> = (1..=cores as u64).collect();
    let all = timed(|| {
        in_parallel(&seeds, cores, |seed| learn(plan, seed, &stop, &silent)?.whole().map(|_| ())).map(|_| ())
    })?;
    let samples = Samples::record(plan)?;
    let frame = &samples.images[0].pixels;
    let mut copy = vec![0; frame.len()];
    Ok(Report {
        behaviour: plan.behaviour.name().to_owned(),
        world: plan.layout.name.clone(),
        image: [plan.settings.camera.width_px, plan.settings.camera.height_px],
        cores,
        steps_per_second_one_core: steps as f64 / one,
        steps_per_second_all_cores: (steps * cores as u64) as f64 / all,
        step_us: one / steps as f64 * 1e6,
        stages: stages(plan, &samples, steps)?,
        copy_of_one_frame_us: median_us(steps as usize, |_| black_box(&mut copy).copy_from_slice(black_box(frame))),
    })
}

fn with_steps(plan: &Plan, steps: u64) -> Plan {
    let mut plan = plan.clone();
    plan.settings.run.steps = steps;
    plan
}

fn timed(work: impl FnOnce() -> Result<()>) -> Result<f64> {
    let started = Instant::now();
    work()?;
    Ok(started.elapsed().as_secs_f64())
}

/// Median microseconds of one call, over rounds that share `calls` between them.
fn median_us(calls: usize, mut call: impl FnMut(usize)) -> f64 {
    let calls = (calls / ROUNDS).max(SAMPLES);
    let mut rounds: Vec<f64> = (0..ROUNDS)
        .map(|_| {
            let started = Instant::now();
            (0..calls).for_each(|index| call(index % SAMPLES));
            started.elapsed().as_secs_f64() * 1e6 / calls as f64
        })
        .collect();
    rounds.sort_by(f64::total_cmp);
    rounds[ROUNDS / 2]
}

/// Situations from a run that acts at random.
struct Samples {
    poses: Vec<Pose>,
    bodies: Vec<Isometry3>,
    images: Vec<Image>,
    masks: Vec<Vec<u8>>,
    facts: Vec<Facts>,
    states: Vec<usize>,
}

impl Samples {
    fn record(plan: &Plan) -> Result<Self> {
        let mut cycle = Cycle::new(plan, SimulatedRobot::new(&plan.layout, &plan.settings, 1)?)?;
        let mut random = Random::new(1, Stream::Test);
        let mut samples =
            Self { poses: vec![], bodies: vec![], images: vec![], masks: vec![], facts: vec![], states: vec![] };
        for index in 0..SAMPLES * SPACING {
            let step = cycle.step(random.below(plan.settings.actions.len() as u32) as usize)?;
            if index % SPACING == 0 {
                let body = cycle.robot().world().body();
                samples.poses.push(body.pose);
                samples.bodies.push(body.world_from_robot());
                samples.images.push(cycle.observation().image.clone());
                samples.masks.push(cycle.mask().to_vec());
                samples.facts.push(cycle.facts().clone());
                samples.states.push(step.next_state);
            }
            if step.recover {
                cycle.recover()?;
            }
        }
        Ok(samples)
    }
}

fn stages(plan: &Plan, samples: &Samples, steps: u64) -> Result<Vec<Stage>> {
    let (settings, layout, calls) = (&plan.settings, &plan.layout, steps as usize);
    let mut world = World::new(Arc::clone(layout), &settings.robot, settings.run.period_s, 1);
    let mut camera = Camera::new(&layout.scene, &settings.camera, 1);
    let mut laser = Laser::new(&layout.scene, &settings.laser, 1);
    let mut chain: Chain = plan.chain()?;
    let mut grid = plan.grid()?;
    let mut judge = plan.judge()?;
    judge.facts_mut().clone_from(&samples.facts[0]);
    judge.calibrate()?;
    let random = Random::new(1, Stream::Learner);
    let mut learner = Learner::new(&settings.learner, grid.states(), settings.actions.len(), random);
    let mut image = samples.images[0].clone();
    let mut scan = Scan { ranges_m: vec![0.0; settings.laser.beams as usize] };
    let moving = world.moving().to_vec();

    let physics = median_us(calls, |index| {
        if index % 8 == 0 {
            world.place(samples.poses[index]);
        }
        black_box(world.advance(settings.actions[index % settings.actions.len()]));
    });
    let camera = median_us(calls, |index| camera.render(&samples.bodies[index], &moving, black_box(&mut image)));
    let laser = median_us(calls, |index| laser.scan(&samples.bodies[index], &moving, black_box(&mut scan)));
    let filter = median_us(calls, |index| {
        // The chain has just processed these very images; it cannot fail now.
        let _ = black_box(chain.apply(black_box(&samples.images[index])));
    });
    let state = median_us(calls, |index| {
        black_box(grid.encode(black_box(&samples.masks[index])));
    });
    let mut script_failure = None;
    let script = median_us(calls, |index| {
        judge.facts_mut().clone_from(&samples.facts[index]);
        if let Err(error) = black_box(judge.judge()) {
            script_failure = Some(error);
        }
    });
    let learner = median_us(calls, |index| {
        let (state, next_state) = (samples.states[index], samples.states[(index + 1) % SAMPLES]);
        let action = learner.choose(state);
        learner.learn(&Transition { state, action, reward: 0.0, next_state, terminal: false });
    });
    let mut cycle = Cycle::new(plan, SimulatedRobot::new(layout, settings, 1)?)?;
    let step = cycle.step(0)?;
    let mut ledger = Ledger::new(plan, steps.max((ROUNDS * SAMPLES) as u64));
    let log = median_us(calls, |_| black_box(&mut ledger).add(black_box(&cycle), &step, false));
    if let Some(error) = script_failure {
        return Err(error);
    }
    Ok(vec![
        Stage { name: "physics", us: physics },
        Stage { name: "camera", us: camera },
        Stage { name: "laser", us: laser },
        Stage { name: "filter", us: filter },
        Stage { name: "state", us: state },
        Stage { name: "script", us: script },
        Stage { name: "learner", us: learner },
        Stage { name: "log", us: log },
    ])
}
