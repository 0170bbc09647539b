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
use crate::world::FloorSquares;

/// A contact is one with a mover that is no farther away than this, metres: a body stops a sixteenth of a tick before it.
const TOUCHING_M: f64 = 0.01;

/// Looks on while a test runs.
#[derive(Debug)]
pub(super) struct Probes {
    requests: Vec<Arc<Request>>,
    movers: Vec<MoverProbe>,
    floor: Option<(FloorSquares, BodyShape)>,
    course: Option<Course>,
    steps: u64,
}

/// The gaps to one mover.
#[derive(Debug)]
struct MoverProbe {
    index: usize,
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
        let movers = plan.layout.movers.iter().enumerate().filter(|(_, mover)| asked(&mover.name));
        let movers = movers.map(|(index, mover)| {
            let name = mover.name.clone();
            MoverProbe { index, name, gaps_m: Vec::with_capacity(steps), contacts: 0 }
        });
        let movers = movers.collect();
        let body = plan.settings.robot.body;
        let covers = requests.iter().any(|request| request.probe == Probe::FloorCovered);
        let floor = covers.then(|| FloorSquares::new(&plan.layout, &body)).flatten().map(|floor| (floor, body));
        let marks = [Probe::Visits, Probe::Gates, Probe::GateErrors];
        let asks = requests.iter().any(|request| marks.contains(&request.probe));
        let mut probes = Self { requests, movers, floor, course: asks.then(|| Course::new(&plan.layout)), steps: 0 };
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
        let course = self.course.as_ref();
        match request.probe {
            Probe::FloorCovered => return self.floor.as_ref().map(|(floor, _)| floor.covered()),
            Probe::Visits => return Some(course?.visits(request.of.as_deref()?)? as f64 * 1000.0 / steps),
            Probe::Gates => return Some(course?.passed as f64 * 1000.0 / steps),
            Probe::GateErrors => {
                let Course { passed, errors, .. } = course?;
                return Some(*errors as f64 / (passed + errors).max(1) as f64);
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
        if let (Some(course), Some(here)) = (&mut self.course, robot.whereabouts()) {
            course.put(Point2::new(here.pose.x_m, here.pose.y_m), robot.start());
        }
    }
}

impl<R: Robot> Observer<R> for Probes {
    fn stepped(&mut self, cycle: &Cycle<R>, step: &Step) -> ControlFlow<()> {
        for mover in &mut self.movers {
            if let Some(gap_m) = cycle.robot().gap_m(mover.index) {
                mover.contacts += u64::from(step.contact && gap_m <= TOUCHING_M);
                mover.gaps_m.push(gap_m as f32);
            }
        }
        if let (Some((floor, body)), Some(here)) = (&mut self.floor, cycle.robot().whereabouts()) {
            floor.cover(body, here.pose);
        }
        self.steps += 1;
        if let (Some(course), Some(here)) = (&mut self.course, cycle.robot().whereabouts()) {
            course.go(Point2::new(here.pose.x_m, here.pose.y_m));
        }
        ControlFlow::Continue(())
    }
    fn recovered(&mut self, cycle: &Cycle<R>) {
        self.put(cycle.robot());
    }
}
