//! What parts of somebody's own hand in through the doors of the library, held to what these doors say: an error in the place
//! of a panic, or of figures that mean nothing.

use filter_api::Format;

use super::Plan;
use crate::diagnostic::{Diagnostic, Result};
use crate::learner::Policy;
use crate::sensors::observation::{Image, Observation};
use crate::state::StateMap;

const CODE: &str = "E-DOOR";

/// What a robot is asked for: it fills what it is given, and changes nothing of its shape but that it may see in colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Asked {
    beams: usize,
    image: Shape,
    depth: Option<Shape>,
}

/// Of an image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Shape {
    format: Format,
    size_px: (usize, usize),
    whole: bool,
}

impl Shape {
    fn of(image: &Image) -> Self {
        let (format, size_px) = (image.format, (image.width_px, image.height_px));
        Self { format, size_px, whole: image.pixels.len() == size_px.0 * size_px.1 * format.channels() }
    }
}

impl Asked {
    pub(super) fn of(observation: &Observation) -> Self {
        let Observation { image, depth, scan, .. } = observation;
        Self { beams: scan.ranges_m.len(), image: Shape::of(image), depth: depth.as_ref().map(Shape::of) }
    }

    fn is_kept_by(self, observation: &Observation) -> bool {
        let found = Self::of(observation);
        let coloured = Self { image: Shape { format: Format::Rgb, ..self.image }, ..self };
        found == self || found == coloured
    }

    /// Holds an observation to it. Ranges and speeds are numbers: a range that is none would never be nearer than anything.
    #[inline]
    pub(super) fn check(self, observation: &Observation) -> Result<()> {
        // All of them, without an end on the way: so the compiler looks at several at once.
        let ranges_m = &observation.scan.ranges_m;
        let broken = ranges_m.iter().fold(false, |broken, range_m| broken | !range_m.is_finite());
        if !broken && observation.odometry.is_finite() && self.is_kept_by(observation) {
            return Ok(());
        }
        self.broken(observation).fail()
    }

    #[cold]
    fn broken(self, observation: &Observation) -> Diagnostic {
        let ranges_m = &observation.scan.ranges_m;
        if !self.is_kept_by(observation) {
            return Diagnostic::new(CODE, "the robot changed the shape of the observation that it was to fill")
                .help("Robot::observe writes into the pixels and ranges that are there: as many as it finds");
        }
        match ranges_m.iter().position(|range_m| !range_m.is_finite()) {
            Some(beam) => {
                Diagnostic::new(CODE, format!("beam {beam} of the robot's laser measured {}", ranges_m[beam]))
                    .help("a beam that meets nothing measures the greatest range")
            }
            None => Diagnostic::new(CODE, "the robot's wheels measured a speed that is no number"),
        }
    }
}

/// An action that was chosen, of so many.
#[cold]
pub(super) fn no_action(action: usize, actions: usize) -> Diagnostic {
    let message = format!("action {action} was chosen, and the robot has {actions} of them, counted from 0");
    Diagnostic::new(CODE, message).help("whoever chooses may choose only these: see Plan::motions")
}

/// A state that a map gave, of so many.
#[cold]
pub(super) fn no_state(state: usize, states: usize) -> Diagnostic {
    let message = format!("the state map gave state {state}, and says that there are {states}, counted from 0");
    Diagnostic::new(CODE, message).help("StateMap::encode must stay below StateMap::states")
}

/// A map has states, a record has room for their numbers, and its digits tell them apart.
pub(super) fn check_states(map: &dyn StateMap) -> Result<()> {
    let states = map.states();
    if states == 0 || u32::try_from(states - 1).is_err() {
        let message = format!("the state map has {states} states");
        return Diagnostic::new(CODE, message).help("a map has 1 to 4294967296 of them").fail();
    }
    let told = map.digits().iter().try_fold(1_usize, |product, digit| product.checked_mul(digit.values));
    if told == Some(states) {
        return Ok(());
    }
    let message = format!("the state map has {states} states, and its digits tell another number apart");
    Diagnostic::new(CODE, message).help("the values of StateMap::digits, multiplied, are StateMap::states").fail()
}

/// A policy fits the plan that it is tested in: its actions, its states, and a number for each value.
pub(super) fn check_policy(plan: &Plan, policy: &Policy) -> Result<()> {
    let (actions, states) = (plan.settings.actions.len(), plan.state_map()?.states());
    let wrong = |message: String| {
        let help = "test it with the behaviour that it was learned with, or learn it again";
        Diagnostic::new("E-POLICY", message).help(help).fail()
    };
    if policy.actions() != actions {
        return wrong(format!("the policy chooses among {} actions, and the robot has {actions}", policy.actions()));
    }
    for (state, row) in policy.rows() {
        if state >= states {
            return wrong(format!("the policy knows state {state}, and the behaviour has {states} of them"));
        }
        if row.values.len() != actions || row.values.iter().any(|value| !value.is_finite()) {
            return wrong(format!("the policy has no {actions} numbers for the actions of state {state}"));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;

    use super::super::{Cycle, Overrides, Phase, test};
    use super::*;
    use crate::diagnostic::SourceText;
    use crate::geometry::Twist;
    use crate::learner::PolicyRow;
    use crate::robot::Robot;
    use crate::script::Behaviour;
    use crate::state::{Described, Digit, Percept};

    fn plan() -> Plan {
        let script =
            "world(\"room\"); run(#{ test_steps: 100 }); rule \"near\" when laser.nearest < 0.3 => -1 then recover;";
        let place = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scripts/doors.rhai");
        let behaviour = Behaviour::parse("doors", SourceText::new(place, script)).unwrap();
        Plan::new(behaviour.into(), &Overrides::default()).unwrap()
    }

    /// Breaks what it observes from the second time on, so that a cycle can be made.
    struct Broken(fn(&mut Observation), u32);

    impl Robot for Broken {
        fn observe(&mut self, observation: &mut Observation) -> Result<()> {
            observation.scan.ranges_m.fill(2.0);
            self.1 += 1;
            if self.1 > 1 {
                (self.0)(observation);
            }
            Ok(())
        }

        fn act(&mut self, _: Twist) -> Result<()> {
            Ok(())
        }

        fn recover(&mut self) -> Result<()> {
            Ok(())
        }
    }

    fn told(broken: fn(&mut Observation)) -> String {
        let error = Cycle::new(&plan(), Broken(broken, 0)).unwrap().step(0).unwrap_err();
        assert_eq!(error.code, CODE);
        error.message
    }

    #[test]
    fn what_a_robot_measures_is_a_number() {
        assert_eq!(told(|seen| seen.scan.ranges_m[7] = f32::NAN), "beam 7 of the robot's laser measured NaN");
        assert_eq!(told(|seen| seen.scan.ranges_m[0] = f32::INFINITY), "beam 0 of the robot's laser measured inf");
        let wheels = told(|seen| seen.odometry.linear_m_per_s = f64::NAN);
        assert_eq!(wheels, "the robot's wheels measured a speed that is no number");
    }

    #[test]
    fn a_robot_fills_an_observation_and_keeps_its_shape() {
        let shape = "the robot changed the shape of the observation that it was to fill";
        assert_eq!(told(|seen| seen.scan.ranges_m.truncate(3)), shape);
        assert_eq!(told(|seen| seen.image.pixels.truncate(3)), shape);
        assert_eq!(told(|seen| seen.image.width_px = 7), shape);
        assert_eq!(told(|seen| seen.depth = Some(seen.image.clone())), shape);
        assert_eq!(told(|seen| seen.image.format = Format::Rgb), shape);
        let in_colour = |seen: &mut Observation| {
            seen.image = Image::of(Format::Rgb, seen.image.width_px, seen.image.height_px);
        };
        assert!(Cycle::new(&plan(), Broken(in_colour, 0)).unwrap().step(0).is_ok());
    }

    #[test]
    fn an_action_that_the_robot_does_not_have_is_told() {
        let error = Cycle::new(&plan(), Broken(|_| (), 0)).unwrap().step(99).unwrap_err();
        assert_eq!(error.message, "action 99 was chosen, and the robot has 14 of them, counted from 0");
    }

    /// A map that gives one state, and says that there are so many.
    struct Says {
        gives: usize,
        states: usize,
        values: usize,
    }

    impl StateMap for Says {
        fn encode(&mut self, _: Percept<'_>) -> usize {
            self.gives
        }

        fn states(&self) -> usize {
            self.states
        }

        fn digits(&self) -> Vec<Digit> {
            vec![Digit { part: 0, column: 0, values: self.values }]
        }

        fn describe(&self, _: usize) -> Described {
            Described { text: String::new(), cells: None }
        }

        fn mirrored(&self, _: usize) -> Option<usize> {
            None
        }

        fn to_table(&self) -> toml::Table {
            toml::Table::new()
        }
    }

    #[test]
    fn a_map_gives_states_that_it_has() {
        let (plan, map) = (plan(), Says { gives: 4, states: 4, values: 4 });
        let robot = Phase::Learning.robot(&plan, 1).unwrap();
        let error = Cycle::with_map(&plan, robot, Box::new(map)).err().unwrap();
        assert_eq!(error.message, "the state map gave state 4, and says that there are 4, counted from 0");
    }

    #[test]
    fn a_map_without_states_with_too_many_or_with_others_than_its_digits_is_refused() {
        let wrong =
            |states, values| plan().task(&Says { gives: 0, states, values }, 1).err().map(|error| error.message);
        assert_eq!(wrong(0, 0).as_deref(), Some("the state map has 0 states"));
        assert_eq!(wrong(1 << 33, 1 << 33).as_deref(), Some("the state map has 8589934592 states"));
        let apart = "the state map has 6 states, and its digits tell another number apart";
        assert_eq!(wrong(6, 5).as_deref(), Some(apart));
        assert_eq!(wrong(6, 6), None);
    }

    #[test]
    fn a_policy_of_other_actions_or_states_is_not_tested() {
        let (plan, never) = (plan(), AtomicBool::new(false));
        let wrong = |policy: Policy| test(&plan, &policy, 1, &never).err().map(|error| error.message);
        let row = |values: Vec<f64>| Some(PolicyRow { visits: 1, values });
        let states = plan.state_map().unwrap().states();
        assert_eq!(
            wrong(Policy::new(3, Vec::new())).as_deref(),
            Some("the policy chooses among 3 actions, and the robot has 14")
        );
        let mut rows = vec![None; states];
        rows.push(row(vec![0.0; 14]));
        let told = format!("the policy knows state {states}, and the behaviour has {states} of them");
        assert_eq!(wrong(Policy::new(14, rows)), Some(told));
        for values in [vec![0.0; 13], vec![f64::NAN; 14]] {
            let told = wrong(Policy::new(14, vec![row(values)]));
            assert_eq!(told.as_deref(), Some("the policy has no 14 numbers for the actions of state 0"));
        }
        assert_eq!(wrong(Policy::new(14, Vec::new())), None);
    }
}
