//! The learner against its definition, written down plainly and computed slowly.

mod plain;
mod rejudged;

use proptest::prelude::*;

use self::plain::Plain;
use super::MemoryLearner;
use crate::allowed::Allowed;
use crate::geometry::Twist;
use crate::learner::{Carry, Learner, Mirror, Task, Transition};
use crate::outcome::Ending;
use crate::random::{Random, Stream};
use crate::saved::{Loading, Saving};
use crate::settings::{LearnerKind, LearnerSettings, Settings};
use crate::state::Digit;

fn settings() -> LearnerSettings {
    LearnerSettings { kind: LearnerKind::Memory, ..Settings::default().learner }
}

/// Two views of three and two columns of three heights, and a digit of two values: 486 states.
fn composed() -> Vec<Digit> {
    let column = |part: usize| move |column: usize| Digit { part, column, values: 3 };
    let single = Digit { part: 2, column: 0, values: 2 };
    (0..3).map(column(0)).chain((0..2).map(column(1))).chain([single]).collect()
}

fn grid() -> Vec<Digit> {
    (0..3).map(|column| Digit { part: 0, column, values: 4 }).collect()
}

fn twists() -> Vec<Twist> {
    vec![Twist::new(0.2, 0.4), Twist::new(0.2, 0.0), Twist::new(0.2, -0.4)]
}

fn task(digits: Vec<Digit>) -> Task {
    let states = digits.iter().map(|digit| digit.values).product();
    let random = Random::new(3, Stream::Learner);
    Task { digits, states, actions: twists(), mirror: None, random }
}

fn learner(digits: Vec<Digit>) -> MemoryLearner {
    MemoryLearner::new(&settings(), task(digits))
}

fn step(state: usize, action: usize, reward: f64, next_state: usize) -> Transition {
    let (ending, next_allowed) = (None, Allowed::ALL);
    Transition { state, action, reward, next_state, ending, potential: 0.0, next_potential: 0.0, next_allowed }
}

/// Steps of a robot that wanders over a few states; every seventh or so ends an attempt, some move the robot.
fn steps(states: usize, count: usize) -> impl Strategy<Value = Vec<(Transition, bool)>> {
    let one = (0..7_usize, 0..3_usize, -1.0..0.5_f64, 0..14_u8, 0.0..1.0_f64, 1..8_u64);
    proptest::collection::vec(one, 1..count).prop_map(move |drawn| {
        let (mut state, mut potential) = (0, 0.0);
        let step = |(to, action, reward, what, built, bits): (usize, usize, f64, u8, f64, u64)| {
            let next_state = to * 31 % states;
            let ending = match what {
                0 => Some(Ending::Failure),
                1 => Some(Ending::Goal),
                2 => Some(Ending::Restart),
                _ => None,
            };
            let next_allowed = if what == 4 { Allowed::of_bits(bits) } else { Allowed::ALL };
            let next_potential = if what > 8 { -built } else { 0.0 };
            let own = Transition {
                potential,
                next_potential,
                next_allowed,
                ending,
                ..step(state, action, reward, next_state)
            };
            let moved = ending.is_some() || what == 3;
            (state, potential) = if moved { ((to * 5 + 1) % states, 0.0) } else { (next_state, next_potential) };
            (own, moved)
        };
        drawn.into_iter().map(step).collect()
    })
}

fn lead(learner: &mut impl Learner, steps: &[(Transition, bool)]) {
    for (transition, moved) in steps {
        learner.visit(transition.state);
        learner.learn(transition);
        if *moved {
            learner.forget();
        }
    }
}

/// Every state's values by both, as learned now and as frozen.
fn compare(settings: &LearnerSettings, digits: &[Digit], steps: &[(Transition, bool)]) -> Result<(), TestCaseError> {
    let mut quick = MemoryLearner::new(settings, task(digits.to_vec()));
    let mut plain = Plain::new(settings, digits.to_vec(), twists());
    lead(&mut quick, steps);
    for (transition, moved) in steps {
        plain.learn(transition, *moved);
    }
    let near = |one: f64, other: f64| (one - other).abs() < 1e-9;
    prop_assert!(near(quick.scale.unit, plain.unit) && near(quick.scale.mean, plain.mean));
    for (row, state) in quick.met.states().iter().enumerate() {
        for (action, value) in quick.table.row(row).iter().enumerate() {
            let wanted = plain.value(*state, action);
            prop_assert!(near(*value, wanted), "state {state}, action {action}: {value}, by definition {wanted}");
        }
    }
    let policy = quick.policy();
    assert_eq!(policy.rows().count(), policy.states());
    for (state, row) in policy.rows() {
        for (action, value) in row.values.iter().enumerate() {
            let wanted = plain.frozen(state, action);
            prop_assert!(near(*value, wanted), "frozen, state {state}: {value}, by definition {wanted}");
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn a_grid_is_valued_as_the_definition_says(steps in steps(64, 160)) {
        compare(&settings(), &grid(), &steps)?;
    }

    #[test]
    fn views_and_single_digits_are_valued_as_the_definition_says(steps in steps(486, 160)) {
        compare(&settings(), &composed(), &steps)?;
    }

    #[test]
    fn a_short_memory_and_terminal_failures_are_valued_as_the_definition_says(steps in steps(64, 400)) {
        let short = LearnerSettings { memory_steps: 100, failure_is_terminal: true, ..settings() };
        compare(&short, &grid(), &steps)?;
    }

    #[test]
    fn a_learner_that_was_saved_goes_on_bit_for_bit(steps in steps(486, 300), cut in 0.0..1.0_f64) {
        let (first, rest) = steps.split_at((steps.len() as f64 * cut) as usize);
        let mut learner = learner(composed());
        lead(&mut learner, first);
        let mut saving = Saving::default();
        learner.save(&mut saving);
        let bytes = saving.into_bytes();
        let mut again = super::tests::learner(composed());
        lead(&mut again, rest);
        let mut loading = Loading::new(&bytes);
        prop_assert!(again.load(&mut loading).is_ok() && loading.end().is_ok());
        lead(&mut learner, rest);
        lead(&mut again, rest);
        prop_assert_eq!(numbers(&learner), numbers(&again));
        prop_assert_eq!(learner.policy(), again.policy());
        prop_assert_eq!(learner.choose(5, Allowed::ALL), again.choose(5, Allowed::ALL));
        prop_assert!(again.load(&mut Loading::new(&bytes[..bytes.len() - 8])).is_err());
    }
}

fn numbers(learner: &MemoryLearner) -> Vec<u64> {
    let mut all = Vec::new();
    learner.numbers(&mut |number| all.push(number.to_bits()));
    all
}

#[test]
fn a_failure_is_valued_by_hand_computed_numbers() {
    let mut learner = learner(vec![Digit { part: 0, column: 0, values: 3 }]);
    learner.learn(&step(0, 1, 0.0, 1));
    learner.learn(&Transition { ending: Some(Ending::Failure), ..step(1, 1, -1.0, 2) });
    // Every V is 0 in the first fit. G(1) = -1, G(0) = 0.98 * 0.85 * -1 = -0.833. The steps weigh 2^(1/500) and 2^(2/500), by
    // the second one r = 2^(-1/500) and 1. Nothing is expected (0): own tries of state 1, with similar actions behind them,
    // are ((0 + 1 * -1) + 4 * (-1 / (1 + 5))) / (1 + 4) = -1/3.
    let row = learner.met.row(1).unwrap();
    assert!((learner.table.row(row)[1] + 1.0 / 3.0).abs() < 1e-12);
    let ratio = libm::exp2(-1.0 / 500.0);
    let similar = -0.833 * ratio / (ratio + 5.0);
    let row = learner.met.row(0).unwrap();
    assert!((learner.table.row(row)[1] - (-0.833 * ratio + 4.0 * similar) / (ratio + 4.0)).abs() < 1e-12);
    // 0.4 rad/s away the likeness is exp(-(4/3)^2 / 2) = 0.4111: of a try that was never made.
    let like = libm::exp(-8.0 / 9.0);
    let row = learner.met.row(1).unwrap();
    assert!((learner.table.row(row)[0] - -like / (like + 5.0)).abs() < 1e-12);
    // The spread of -1 and -0.833 with nearly equal weights is half their distance, to five digits.
    assert!((learner.scale.unit - 0.0835).abs() < 1e-6);
}

#[test]
fn what_is_paid_while_a_rule_holds_is_given_back_when_it_ends() {
    // The rule is worth -1 and has held for half of its time; then it ends, or it fires.
    let gains = |last: Transition| {
        let mut learner = learner(grid());
        learner.learn(&Transition { next_potential: -0.5, ..step(0, 0, 0.0, 1) });
        learner.learn(&Transition { potential: -0.5, ..last });
        [learner.past.back(1).reward, learner.past.back(0).reward]
    };
    assert_eq!(gains(step(1, 0, 0.0, 2)), [-0.49, 0.5]);
    let failed = Transition { ending: Some(Ending::Failure), next_potential: -1.0, ..step(1, 0, -1.0, 2) };
    assert_eq!(gains(failed), [-0.49, -0.5]);
    // A restart, or being moved to another world, breaks off what could have gone on: it keeps what it has built up.
    let restarted = Transition { ending: Some(Ending::Restart), next_potential: -0.75, ..step(1, 0, 0.0, 2) };
    assert_eq!(gains(restarted), [-0.49, -0.735 + 0.5]);
}

#[test]
fn nothing_flows_back_over_a_move() {
    let mut moved = learner(grid());
    moved.learn(&step(0, 0, 0.0, 1));
    moved.forget();
    moved.learn(&Transition { ending: Some(Ending::Failure), ..step(2, 0, -1.0, 3) });
    assert_eq!((moved.past.back(1).gain, moved.past.back(0).gain), (0.0, -1.0));
}

#[test]
fn a_reward_of_another_size_teaches_the_same() {
    let chosen = |size: f64| {
        let mut learner = learner(grid());
        let mut state = 0;
        let choose = |index: usize| {
            let (action, _) = learner.choose(state, Allowed::ALL);
            let next = (state * 5 + action * 3 + 1) % 64;
            let failed = next % 7 == 3;
            let ending = failed.then_some(Ending::Failure);
            let reward = if failed { -size } else { 0.0 };
            learner.learn(&Transition { ending, ..step(state, action, reward, next) });
            state = if failed { index % 64 } else { next };
            action
        };
        (0..600).map(choose).collect::<Vec<_>>()
    };
    // Powers of two, so that not even rounding differs.
    assert_eq!(chosen(1.0), chosen(128.0));
    assert_eq!(chosen(1.0), chosen(0.015_625));
}

#[test]
fn only_what_is_allowed_is_chosen_and_hoped_for() {
    let mut learner = learner(grid());
    for index in 0..60 {
        learner.learn(&step(1, index % 3, if index % 3 == 0 { 1.0 } else { 0.0 }, 2));
    }
    let only = Allowed::NONE.with(1).with(2);
    assert!((0..100).all(|_| learner.choose(1, only).0 != 0));
    // State 1 is worth what its best allowed action is: less than what the forbidden one brought.
    let worth = |allowed: Allowed| {
        let mut learner = super::tests::learner(grid());
        for index in 0..60 {
            learner.learn(&step(1, index % 3, if index % 3 == 0 { 1.0 } else { 0.0 }, 2));
        }
        for _ in 0..20 {
            learner.learn(&Transition { next_allowed: allowed, ..step(9, 0, 0.0, 1) });
            learner.forget();
        }
        learner.past.back(0).gain
    };
    assert!(worth(Allowed::ALL) > worth(only) + 0.1);
}

#[test]
fn what_is_learned_on_the_left_is_known_on_the_right() {
    let digits = vec![Digit { part: 0, column: 0, values: 3 }];
    let mirror = Mirror::new(vec![1, 0, 2], &twists()).unwrap();
    let mut learner = MemoryLearner::new(&settings(), Task { mirror: Some(mirror), ..task(digits) });
    learner.visit(0);
    for _ in 0..10 {
        learner.learn(&Transition { ending: Some(Ending::Failure), ..step(0, 0, -1.0, 2) });
    }
    let policy = learner.policy();
    let of = |state: usize| policy.row(state).cloned().unwrap();
    let mirrored: Vec<f64> = of(0).values.into_iter().rev().collect();
    assert!(of(1).values.iter().zip(&mirrored).all(|(one, other)| (one - other).abs() < 1e-12));
    assert_eq!((of(1).visits, of(2).visits), (1, 0));
}

#[test]
fn another_reward_keeps_all_forgets_the_age_or_forgets_everything() {
    let learned = || {
        let mut learner = learner(grid());
        for index in 0..500 {
            learner.visit(index % 5);
            learner.learn(&step(index % 5, index % 3, if index % 3 == 0 { -1.0 } else { 0.0 }, (index + 1) % 5));
        }
        learner
    };
    let after = |carry| {
        let mut learner = learned();
        learner.swap(&settings(), None, carry);
        learner
    };
    assert_eq!(numbers(&after(Carry::Keep)), numbers(&learned()));
    let decayed = after(Carry::Decay);
    assert_eq!((decayed.past.len(), decayed.age, decayed.visits[0], decayed.averaged.tables), (500, 0, 0, 1));
    // 250 steps before the latest, of half a half-life: 2^-0.5.
    assert!((decayed.past.back(250).weight - 0.5_f64.sqrt()).abs() < 1e-12);
    let reset = after(Carry::Reset);
    assert_eq!((reset.past.len(), reset.scale.unit), (0, 0.0));
    assert!(reset.table.values.iter().all(|value| *value == 0.0));
}

#[test]
fn a_state_that_was_never_met_is_answered_for_by_its_columns() {
    let mut learner = learner(grid());
    for _ in 0..20 {
        learner.learn(&Transition { ending: Some(Ending::Failure), ..step(0, 1, -1.0, 21) });
    }
    // State 16 shares its two left columns with state 0, state 42 shares nothing with it.
    let policy = learner.policy();
    let value = |state: usize| policy.row(state).cloned().unwrap().values[1];
    assert!(value(16) < value(42));
    assert_eq!((policy.states_met(), value(42)), (0, learner.pools.first_value()));
}

#[test]
fn over_many_states_the_sums_of_their_parts_answer_as_the_learner_would() {
    // 3 x 8 heights of two views: 4^3 * 5^4 = 40,000 states.
    let columns =
        |part: usize, count: usize, values: usize| (0..count).map(move |column| Digit { part, column, values });
    let digits: Vec<Digit> = columns(0, 3, 4).chain(columns(1, 4, 5)).collect();
    let mut learner = learner(digits);
    for index in 0..300 {
        let failed = index % 4 == 0;
        let ending = failed.then_some(Ending::Failure);
        let reward = if failed { -1.0 } else { 0.0 };
        learner.learn(&Transition { ending, ..step(index * 37 % 211, index % 3, reward, (index + 1) * 37 % 211) });
    }
    let policy = learner.policy();
    let pools = policy.pools().unwrap();
    let mut room = super::PooledRow::default();
    pools.answer(39_999, &mut room);
    let wanted: Vec<f64> = (0..3).map(|action| learner.chain(39_999, action).value).collect();
    assert!(
        room.values.iter().zip(&wanted).all(|(one, other)| (one - other).abs() < 1e-12),
        "{:?} {wanted:?}",
        room.values
    );
    assert!(policy.row(39_999).is_none() && wanted[0] != wanted[1]);
}

#[test]
fn the_chain_ends_in_the_value_and_names_the_steps_behind_it() {
    let mut learner = learner(composed());
    for index in 0..100 {
        learner.learn(&step(index % 4, index % 3, if index % 5 == 0 { -1.0 } else { 0.0 }, (index + 1) % 4));
    }
    let row = learner.met.row(2).unwrap();
    let chain = learner.chain(2, 1);
    assert!((chain.value - learner.table.row(row)[1]).abs() < 1e-12);
    // Pairs and a view of two columns, the same with the digit, both views with it, similar actions, own tries.
    assert_eq!(chain.links.len(), 1 + 4 + 4 + 2 + 2);
    // State 2 is met at 2, 6, 10, ..., with action 1 at 10, 22, ..., 94.
    assert_eq!(chain.tries.iter().map(|past| past.step).collect::<Vec<_>>(), [94, 82, 70, 58, 46, 34, 22, 10]);
}

#[test]
fn what_is_paid_in_advance_leaves_the_return_of_an_attempt_as_it_was() {
    // From begin to end of an attempt, the discounted rewards as learned add up to those of the script: what is best stays best.
    let mut learner = learner(grid());
    let (built, script) = ([0.0, -0.25, -0.5, -0.9], [0.0, 0.1, 0.0, -1.0]);
    for (index, reward) in script.into_iter().enumerate() {
        let next_potential = built.get(index + 1).copied().unwrap_or(-1.0);
        let ending = (index == 3).then_some(Ending::Failure);
        learner.learn(&Transition {
            potential: built[index],
            next_potential,
            ending,
            ..step(index, 0, reward, index + 1)
        });
    }
    let discounted = |rewards: &[f64]| rewards.iter().rev().fold(0.0, |sum, reward| reward + 0.98 * sum);
    let learned: Vec<f64> = (0..4).rev().map(|back| learner.past.back(back).reward).collect();
    assert!((discounted(&learned) - discounted(&script)).abs() < 1e-12, "{learned:?}");
}

#[test]
fn sums_that_are_kept_are_those_of_the_steps_that_are_remembered() {
    // Long enough that old steps are renewed block by block, and the oldest are forgotten.
    let mut learner = MemoryLearner::new(&LearnerSettings { memory_steps: 2_000, ..settings() }, task(grid()));
    let mut state = 0;
    for index in 0..7_000_usize {
        let (action, _) = learner.choose(state, Allowed::ALL);
        let next = (state * 5 + action * 7 + index % 3) % 64;
        let ending = (next % 9 == 4).then_some(Ending::Failure);
        let reward = if ending.is_some() { -1.0 } else { 0.0 };
        learner.learn(&Transition { ending, ..step(state, action, reward, next) });
        state = next;
    }
    let mut again = super::returns::ReturnSums::new(3);
    (0..learner.visits.len()).for_each(|_| again.meet());
    learner.past.iter().for_each(|step| again.count(step, None, 1.0));
    let near = |kept: &[f64], anew: &[f64]| {
        kept.iter().zip(anew).all(|(one, other)| (one - other).abs() < 1e-9 * again.totals.weight)
    };
    assert!(near(&learner.sums.sums, &again.sums) && near(&learner.sums.tries, &again.tries));
    assert!((learner.sums.totals.weight / again.totals.weight - 1.0).abs() < 1e-9);
}
