//! The remembered steps under other rules.

use super::*;
use crate::learner::Rejudged;

/// Returns that take in no values: what was earned, discounted, all the way to the end.
fn far_sighted() -> LearnerSettings {
    LearnerSettings { memory_lambda: 1.0, failure_is_terminal: true, ..settings() }
}

/// Two steps that earned nothing, then an end that cost 1; the robot is put elsewhere and does two more.
fn led_through(settings: &LearnerSettings) -> MemoryLearner {
    let mut learner = MemoryLearner::new(settings, task(grid()));
    let end = Transition { ending: Some(Ending::Failure), ..step(2, 0, -1.0, 3) };
    let moved = [(step(0, 0, 0.0, 1), false), (step(1, 0, 0.0, 2), false), (end, true)];
    lead(&mut learner, &moved);
    lead(&mut learner, &[(step(10, 1, 0.0, 11), false), (step(11, 1, 0.0, 12), false)]);
    learner
}

fn gains(learner: &MemoryLearner) -> Vec<f64> {
    (0..learner.past.len()).rev().map(|back| learner.past.back(back).gain).collect()
}

fn rescored(learner: &mut MemoryLearner, settings: &LearnerSettings, said: &[(Transition, bool)]) {
    let said: Vec<Rejudged> =
        said.iter().map(|(transition, moved)| Rejudged { transition: *transition, moved: *moved }).collect();
    learner.swap(settings, None, Carry::Rescore);
    learner.rescore(&said);
}

#[test]
fn returns_are_those_of_the_new_rules_by_hand_computed_numbers() {
    let settings = far_sighted();
    let mut learner = led_through(&settings);
    // The new rules find nothing wrong with the first attempt, and punish the last step with 2, which ends it.
    let last = Transition { ending: Some(Ending::Failure), ..step(11, 1, -2.0, 12) };
    let said = [
        (step(0, 0, 0.5, 1), false),
        (step(1, 0, 0.0, 2), false),
        (step(2, 0, 0.0, 3), true),
        (step(10, 1, 0.0, 11), false),
        (last, false),
    ];
    rescored(&mut learner, &settings, &said);
    let gains = gains(&learner);
    // -2 ends the second attempt; the step before it sees that once discounted.
    assert!((gains[4] + 2.0).abs() < 1e-12 && (gains[3] + 1.96).abs() < 1e-12, "{gains:?}");
    // The old rules moved the robot after the third step: nothing of the second attempt flows back, but the value of its state.
    let value = (0..3).map(|action| learner.chain(3, action).value).fold(f64::MIN, f64::max);
    assert!((gains[2] - 0.98 * value).abs() < 0.01, "{gains:?}, value {value}");
    assert!((gains[1] - 0.98 * gains[2]).abs() < 1e-12 && (gains[0] - (0.5 + 0.98 * gains[1])).abs() < 1e-12);
}

#[test]
fn an_end_by_the_new_rules_cuts_though_the_robot_went_on() {
    let settings = far_sighted();
    let mut learner = led_through(&settings);
    let second = Transition { ending: Some(Ending::Failure), ..step(1, 0, -4.0, 2) };
    let said = [
        (step(0, 0, 0.0, 1), false),
        (second, false),
        (step(2, 0, -8.0, 3), true),
        (step(10, 1, 0.0, 11), false),
        (step(11, 1, 0.0, 12), false),
    ];
    rescored(&mut learner, &settings, &said);
    let gains = gains(&learner);
    assert!((gains[1] + 4.0).abs() < 1e-12 && (gains[0] + 3.92).abs() < 1e-12, "{gains:?}");
}

#[test]
fn visits_age_and_unit_are_forgotten_and_rewards_of_another_size_teach_the_same() {
    let settings = settings();
    let said = |size: f64| {
        let end = Transition { ending: Some(Ending::Failure), ..step(2, 0, -size, 3) };
        let first = [(step(0, 0, 0.0, 1), false), (step(1, 0, 0.0, 2), false), (end, true)];
        [&first[..], &[(step(10, 1, 0.0, 11), false), (step(11, 1, 0.0, 12), false)]].concat()
    };
    let [one, hundred] = [1.0, 100.0].map(|size| {
        let mut learner = led_through(&settings);
        rescored(&mut learner, &settings, &said(size));
        learner
    });
    assert_eq!((one.age, one.visits.iter().sum::<u64>(), one.averaged.tables), (0, 0, 1));
    assert!((hundred.scale.unit / one.scale.unit - 100.0).abs() < 1e-6);
    let values = one.table.values.iter().zip(&hundred.table.values);
    assert!(values.clone().all(|(one, hundred)| (100.0 * one - hundred).abs() < 1e-6));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(30))]

    #[test]
    fn what_the_old_rules_say_again_leaves_every_step_as_it_is_remembered(steps in steps(64, 200)) {
        let settings = settings();
        let mut learner = MemoryLearner::new(&settings, task(grid()));
        lead(&mut learner, &steps);
        learner.forget();
        let steps_of = |learner: &MemoryLearner| {
            learner.past.iter().map(|step| (step.row, step.action, step.reward, step.follows, step.next_allowed)).collect::<Vec<_>>()
        };
        let before = steps_of(&learner);
        rescored(&mut learner, &settings, &steps);
        prop_assert_eq!(steps_of(&learner), before);
        prop_assert!(learner.table.values.iter().all(|value| value.is_finite()));
    }
}
