//! What a test measures only since a condition of success asks for it.

use std::ops::ControlFlow;
use std::sync::Arc;

use super::course::Course;
use super::{Cycle, Observer, Plan, Step};
use crate::geometry::Point2;
use crate::robot::Robot;
use crate::settings::BodyShape;
use crate::stats::Sorted;
use crate::verdict::{AskedFigure, Probe, Request};
use crate::world::{FloorSquares, Layout};

/// A contact is one with a mover that is no farther away than this, metres: a body stops a sixteenth of a tick before it.
const TOUCHING_M: f64 = 0.01;

/// Looks on while a test runs.
#[derive(Debug)]
pub(super) struct Probes {
    requests: Vec<Arc<Request>>,
    movers: Vec<MoverProbe>,
    /// By world; made of those in which the robot has been.
    floors: Vec<Option<FloorSquares>>,
    body: BodyShape,
    /// By world.
    courses: Vec<Course>,
    /// The world in which the robot is.
    at: usize,
    steps: u64,
}

/// The gaps to one mover.
#[derive(Debug)]
struct MoverProbe {
    /// By world.
    indices: Vec<usize>,
    name: String,
    /// After each step, metres.
    gaps_m: Vec<f32>,
    contacts: u64,
}

impl Probes {
    /// For what the plan's conditions ask for, with a robot where it is now.
    pub(super) fn new(plan: &Plan, robot: &impl Robot) -> Self {
        let requests = plan.success().requests();
        let asked = |name: &str| requests.iter().any(|request| request.of.as_deref() == Some(name));
        let steps = plan.settings.run.test_steps as usize;
        let layouts = plan.worlds.layouts();
        let movers = plan.layout.movers.iter().filter(|mover| asked(&mover.name));
        let movers = movers.map(|mover| {
            let name = mover.name.clone();
            let index =
                |layout: &Arc<Layout>| layout.movers.iter().position(|own| own.name == name).unwrap_or(usize::MAX);
            let indices = layouts.iter().map(index).collect();
            MoverProbe { indices, name, gaps_m: Vec::with_capacity(steps), contacts: 0 }
        });
        let movers = movers.collect();
        let body = plan.settings.robot.body;
        let covers = requests.iter().any(|request| request.probe == Probe::FloorCovered);
        let floor = |layout: &Arc<Layout>| covers.then(|| FloorSquares::new(layout, &body)).flatten();
        let floors = layouts.iter().map(floor).collect();
        let marks = [Probe::Visits, Probe::Gates, Probe::GateErrors];
        let asks = requests.iter().any(|request| marks.contains(&request.probe));
        let courses = layouts.iter().filter(|_| asks).map(Course::new).collect();
        let mut probes = Self { requests, movers, floors, body, courses, at: 0, steps: 0 };
        probes.put(robot);
        probes
    }

    /// The figures, in the order in which they are asked for.
    pub(super) fn finish(&self) -> Vec<AskedFigure> {
        self.requests
            .iter()
            .map(|request| AskedFigure { name: request.to_string(), value: self.value(request) })
            .collect()
    }

    fn value(&self, request: &Request) -> Option<f64> {
        let steps = self.steps.max(1) as f64;
        let sum = |of: fn(&Course) -> u64| (!self.courses.is_empty()).then(|| self.courses.iter().map(of).sum::<u64>());
        match request.probe {
            Probe::FloorCovered => return FloorSquares::covered_of(self.floors.iter().flatten()),
            Probe::Visits => {
                let name = request.of.as_deref()?;
                let visits = self.courses.iter().map(|course| course.visits(name));
                return visits.reduce(|a, b| Some(a? + b?)).flatten().map(|visits| visits as f64 * 1000.0 / steps);
            }
            Probe::Gates => return sum(|course| course.passed).map(|passed| passed as f64 * 1000.0 / steps),
            Probe::GateErrors => {
                let (passed, errors) = (sum(|course| course.passed)?, sum(|course| course.errors)?);
                return Some(errors as f64 / (passed + errors).max(1) as f64);
            }
            Probe::Gap | Probe::GapError | Probe::ContactsWith => {}
        }
        let mover = self.movers.iter().find(|mover| Some(&mover.name) == request.of.as_ref())?;
        let gaps = mover.gaps_m.iter().map(|gap| f64::from(*gap));
        let count = mover.gaps_m.len();
        match request.probe {
            _ if count == 0 => None,
            Probe::Gap => gaps.collect::<Sorted>().upper_median(),
            Probe::GapError => Some(gaps.map(|gap| (gap - request.metres).abs()).sum::<f64>() / count as f64),
            Probe::ContactsWith => Some(mover.contacts as f64),
            _ => None,
        }
    }

    /// The robot was put somewhere.
    fn put(&mut self, robot: &impl Robot) {
        self.at = robot.world_index();
        if let (Some(course), Some(here)) = (self.courses.get_mut(self.at), robot.whereabouts()) {
            course.put(Point2::new(here.pose.x_m, here.pose.y_m), robot.start());
        }
    }
}

impl<R: Robot> Observer<R> for Probes {
    fn stepped(&mut self, cycle: &Cycle<R>, step: &Step) -> ControlFlow<()> {
        for mover in &mut self.movers {
            if let Some(gap_m) = cycle.robot().gap_m(mover.indices[self.at]) {
                mover.contacts += u64::from(step.contact && gap_m <= TOUCHING_M);
                mover.gaps_m.push(gap_m as f32);
            }
        }
        if let (Some(Some(floor)), Some(here)) = (self.floors.get_mut(self.at), cycle.robot().whereabouts()) {
            floor.cover(&self.body, here.pose);
        }
        self.steps += 1;
        if let (Some(course), Some(here)) = (self.courses.get_mut(self.at), cycle.robot().whereabouts()) {
            course.go(Point2::new(here.pose.x_m, here.pose.y_m));
        }
        ControlFlow::Continue(())
    }
    fn recovered(&mut self, cycle: &Cycle<R>) {
        self.put(cycle.robot());
    }
}
