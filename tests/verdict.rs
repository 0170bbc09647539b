use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use engine::allowed::Allowed;
use engine::diagnostic::{Result, SourceText};
use engine::experiment::{
    Choice, Chooser, Decider, Overrides, Plan, base_lines, in_parallel, test_choices, test_untrained,
};
use engine::geometry::Twist;
use engine::learner::Policy;
use engine::script::Behaviour;
use engine::verdict::{BaseLines, Because, SuccessVerdict};

use crate::support::root;

/// Every shipped behaviour that learns.
const SHIPPED: &[&str] = &[
    "avoid",
    "corridor",
    "corridor-erroneous",
    "corridor-speed",
    "dock",
    "line",
    "object",
    "platform",
    "wall",
    "wall-instant",
    "wall-left",
];
const STEPS: u64 = 2000;

/// A policy that sees nothing: what it does depends on the step alone. Each with the motions that it needs.
struct Cheat {
    name: &'static str,
    motions: &'static [(f64, f64)],
    choice: fn(u64) -> usize,
}

const CHEATS: &[Cheat] = &[
    Cheat { name: "stands", motions: &[(0.0, 0.0)], choice: |_| 0 },
    Cheat { name: "creeps", motions: &[(0.02, 0.0)], choice: |_| 0 },
    Cheat { name: "spins left", motions: &[(0.0, 0.8)], choice: |_| 0 },
    Cheat { name: "spins right", motions: &[(0.0, -0.8)], choice: |_| 0 },
    Cheat { name: "spins while it drives", motions: &[(0.05, 0.8)], choice: |_| 0 },
    Cheat { name: "drives straight on", motions: &[(0.4, 0.0)], choice: |_| 0 },
    Cheat { name: "drives straight on slowly", motions: &[(0.2, 0.0)], choice: |_| 0 },
    Cheat { name: "drives backwards", motions: &[(-0.2, 0.0)], choice: |_| 0 },
    Cheat { name: "backs in a circle", motions: &[(-0.2, 0.2)], choice: |_| 0 },
    Cheat { name: "a circle of 0.3 m", motions: &[(0.2, 0.6)], choice: |_| 0 },
    Cheat { name: "a circle of 1 m", motions: &[(0.2, -0.2)], choice: |_| 0 },
    Cheat { name: "a circle of 2 m", motions: &[(0.4, 0.2)], choice: |_| 0 },
    Cheat { name: "a circle of 2 m, the other way", motions: &[(0.4, -0.2)], choice: |_| 0 },
    Cheat { name: "a circle of 3 m", motions: &[(0.3, 0.1)], choice: |_| 0 },
    Cheat { name: "a circle of 3 m, the other way", motions: &[(0.3, -0.1)], choice: |_| 0 },
    Cheat { name: "a circle of 5 m", motions: &[(0.4, 0.08)], choice: |_| 0 },
    Cheat { name: "to and fro", motions: &[(0.2, 0.0), (-0.2, 0.0)], choice: |step| usize::from(step / 20 % 2 == 1) },
    Cheat { name: "U-turns", motions: &[(0.3, 0.0), (0.05, 0.8)], choice: |step| usize::from(step % 20 >= 12) },
    Cheat { name: "an eight", motions: &[(0.3, 0.3), (0.3, -0.3)], choice: |step| usize::from(step / 50 % 2 == 1) },
    Cheat { name: "weaves", motions: &[(0.3, 0.6), (0.3, -0.6)], choice: |step| usize::from(step / 3 % 2 == 1) },
    Cheat { name: "wriggles", motions: &[(0.05, 0.8), (0.05, -0.8)], choice: |step| usize::from(step % 2 == 1) },
    Cheat {
        name: "wriggles on the spot",
        motions: &[(0.0, 0.8), (0.0, -0.8)],
        choice: |step| usize::from(step % 2 == 1),
    },
    Cheat { name: "rocks", motions: &[(0.1, 0.0), (-0.1, 0.0)], choice: |step| usize::from(step % 2 == 1) },
    Cheat { name: "rocks and drifts", motions: &[(0.2, 0.0), (-0.12, 0.0)], choice: |step| usize::from(step % 2 == 1) },
];

struct Blind(fn(u64) -> usize, u64);

impl Chooser for Blind {
    fn choose(&mut self, _: &[usize], _: Allowed) -> Result<Choice> {
        self.1 += 1;
        Ok(Choice { action: (self.0)(self.1 - 1), explored: false })
    }
}

fn plan(path: &Path) -> Plan {
    let overrides = Overrides { test_steps: Some(STEPS), ..Overrides::default() };
    Plan::new(Arc::new(Behaviour::load(path).unwrap()), &overrides).unwrap()
}

fn shipped(name: &str) -> Plan {
    plan(&root().join("scripts").join(format!("{name}.rhai")))
}

/// A script of one's own in a shipped world.
fn written(text: &str) -> Plan {
    let place = root().join("scripts/own.rhai");
    let behaviour = Behaviour::parse("own", SourceText::new(place, text.to_owned())).unwrap();
    Plan::new(Arc::new(behaviour), &Overrides { test_steps: Some(STEPS), ..Overrides::default() }).unwrap()
}

/// The verdict on whoever does not look.
fn of_cheat(plan: &Plan, cheat: &Cheat) -> SuccessVerdict {
    let never = AtomicBool::new(false);
    let lines = BaseLines::of_untrained(test_untrained(plan, 7, &never).unwrap());
    let mut plan = plan.clone();
    plan.settings.actions = cheat.motions.iter().map(|(linear, angular)| Twist::new(*linear, *angular)).collect();
    let tested = test_choices(&plan, 7, &never, &mut Blind(cheat.choice, 0), &mut ()).unwrap();
    plan.success().verdict(&tested.figures, &lines)
}

/// The verdict on a policy that was never trained.
fn of_untrained(plan: &Plan, seed: u64) -> SuccessVerdict {
    let never = AtomicBool::new(false);
    let decider = Decider::Learned(Policy::new(plan.settings.actions.len(), Vec::new()));
    let tested = decider.test(plan, seed, &never, &mut ()).unwrap();
    plan.success().verdict(&tested.figures, &base_lines(plan, seed, &tested, &never).unwrap())
}

#[test]
fn no_untrained_policy_of_ten_is_called_done_in_any_shipped_behaviour() {
    for name in SHIPPED {
        let plan = shipped(name);
        let seeds: Vec<u64> = (0..10).collect();
        let verdicts = in_parallel(&seeds, 0, |seed| Ok(of_untrained(&plan, seed))).unwrap();
        let done = verdicts.iter().filter(|verdict| verdict.is_success()).count();
        assert_eq!(done, 0, "{name}");
    }
}

#[test]
fn none_of_24_policies_that_see_nothing_is_called_done_in_any_shipped_behaviour() {
    assert_eq!(CHEATS.len(), 24);
    for name in SHIPPED {
        let plan = shipped(name);
        let numbers: Vec<u64> = (0..CHEATS.len() as u64).collect();
        let verdicts = in_parallel(&numbers, 0, |number| Ok(of_cheat(&plan, &CHEATS[number as usize]))).unwrap();
        let done: Vec<_> = CHEATS.iter().zip(&verdicts).filter(|(_, verdict)| verdict.is_success()).collect();
        let names: Vec<_> = done.iter().map(|(cheat, _)| cheat.name).collect();
        assert!(names.is_empty(), "{name}: {names:?}");
    }
}

#[test]
fn a_circle_inside_the_track_makes_no_laps() {
    let plan = written(
        "world(\"line\"); filter(\"colour\", #{ hue_deg: 50, width_deg: 20 });
         rule \"contact\" when robot.contact => -1 then recover;",
    );
    let circle = CHEATS.iter().find(|cheat| cheat.name == "a circle of 3 m").unwrap();
    let verdict = of_cheat(&plan, circle);
    assert_eq!(verdict.success, Some(false), "{verdict:?}");
}

#[test]
fn whoever_wriggles_on_the_spot_gets_nowhere_where_there_is_no_route() {
    let plan = written("world(\"clutter\"); recovery(\"start\"); rule \"contact\" when robot.contact => -1 then fail;");
    let never = AtomicBool::new(false);
    for name in ["wriggles", "wriggles on the spot", "rocks", "rocks and drifts"] {
        let cheat = CHEATS.iter().find(|cheat| cheat.name == name).unwrap();
        let mut own = plan.clone();
        own.settings.actions = cheat.motions.iter().map(|(linear, angular)| Twist::new(*linear, *angular)).collect();
        let tested = test_choices(&own, 7, &never, &mut Blind(cheat.choice, 0), &mut ()).unwrap();
        assert!(tested.figures.idle() > 0.9, "{name}: {}", tested.figures.idle());
        assert_eq!(of_cheat(&plan, cheat).success, Some(false), "{name}");
    }
}

#[test]
fn a_script_that_names_no_outcome_claims_nothing() {
    let plan = written("world(\"room\"); fn reward(facts) { 0.001 }");
    let verdict = of_untrained(&plan, 1);
    assert_eq!((verdict.success, verdict.why), (None, Because::NothingToTellBy));
    assert!(!plan.success().tells_learning());
}

#[test]
fn a_success_that_chance_meets_too_claims_nothing() {
    let plan = written(
        "world(\"room\"); rule \"hit\" when robot.contact => -1 then fail;
         success \"moves\" when test.distance_m > 1.0;",
    );
    let verdict = of_untrained(&plan, 1);
    assert_eq!((verdict.success, verdict.why), (None, Because::UntrainedToo));
}

#[test]
fn a_success_by_the_reward_alone_claims_nothing() {
    let plan = written(
        "world(\"room\"); rule \"hit\" when robot.contact => -1 then fail;
         success \"pays\" when test.reward_per_1000 > -1000.0;",
    );
    assert_eq!(of_untrained(&plan, 1).why, Because::RewardOnly);
}

#[test]
fn a_time_limit_is_neither_failure_nor_goal() {
    for words in ["then recover", "then restart"] {
        let plan = written(&format!("world(\"room\"); rule \"timeout\" when time.since_recovery >= 100 => 0 {words};"));
        let figures = test_untrained(&plan, 1, &AtomicBool::new(false)).unwrap();
        assert_eq!((figures.failures, figures.goals, figures.restarts), (0, 0, STEPS / 100), "{words}");
    }
}

#[test]
fn a_goal_is_a_goal_whatever_it_pays_and_a_failure_a_failure() {
    let plan = written(
        "world(\"room\");
         rule \"far\"  when time.since_recovery >= 50 => -3 then goal;
         rule \"near\" when robot.contact => 2 then fail;",
    );
    let figures = test_untrained(&plan, 1, &AtomicBool::new(false)).unwrap();
    let fired = |rule: usize| figures.rules[rule].fired;
    assert_eq!((figures.goals, figures.failures), (fired(0), fired(1)));
    assert!(figures.goals > 0 && figures.failures > 0 && figures.restarts == 0, "{figures:?}");
    assert_eq!(figures.goal_rate, fired(0) as f64 / (fired(0) + fired(1)) as f64);
    assert_eq!(figures.goal_s, Some(50.0 * plan.settings.run.period_s));
}

#[test]
fn the_gap_to_a_mover_is_measured_where_a_success_asks_for_it() {
    let script = |success: &str| {
        format!(
            "world(\"object\"); filter(\"colour\"); actions([[0, 0], [0.2, 0]]); recovery(\"behind\", #{{ distance_m: 1.1 }});
             run(#{{ period_s: 0.33 }}); rule \"hit\" when robot.contact => -1 then fail; success \"near\" when {success};"
        )
    };
    let plan = written(&script(
        "test.gap_m(\"prey\") < 1.0 && test.gap_error_m(\"prey\", 0.5) < 1.0 && test.floor_covered > 0.1",
    ));
    let stands = test_choices(&plan, 7, &AtomicBool::new(false), &mut Blind(|_| 0, 0), &mut ()).unwrap().figures;
    let [gap, error, covered] = stands.asked.as_slice() else { panic!("{:?}", stands.asked) };
    assert_eq!((gap.name.as_str(), error.name.as_str()), ("gap_m(\"prey\")", "gap_error_m(\"prey\", 0.5)"));
    // The prey drives round and round a robot that stands: from centre to centre it is as far as the gap and two half bodies.
    let (gap_m, centres_m) = (gap.value.unwrap(), stands.prey_distance_m.unwrap());
    assert!(gap_m < centres_m - 0.45 && gap_m > centres_m - 0.7, "{gap_m} {centres_m}");
    assert!(error.value.unwrap() > 0.5 && covered.value.unwrap() < 0.01, "{:?}", stands.asked);
    // Without the question, nothing is measured.
    let plan = written(&script("test.contacts_per_1000 < 1.0"));
    assert!(test_untrained(&plan, 7, &AtomicBool::new(false)).unwrap().asked.is_empty());
}

#[test]
fn a_success_over_what_the_world_does_not_have_is_a_mistake() {
    let refused = |success: &str| {
        let text = format!(
            "world(\"object\"); rule \"hit\" when robot.contact => -1 then fail; success \"near\" when {success};"
        );
        let behaviour = Behaviour::parse("own", SourceText::new(root().join("scripts/own.rhai"), text)).unwrap();
        *Plan::new(Arc::new(behaviour), &Overrides::default()).map(|_| ()).unwrap_err()
    };
    let wrong = refused("test.contacts_with(\"pray\") < 2.0");
    assert_eq!((wrong.code, wrong.message.as_str()), ("E-SCRIPT-SUCCESS", "this world has no mover \"pray\""));
    assert_eq!(wrong.help.as_deref(), Some("did you mean \"prey\"?"));
}

#[test]
fn who_does_not_look_comes_to_the_same_figures_whether_images_are_drawn_or_not() {
    let never = AtomicBool::new(false);
    let wall = std::fs::read_to_string(root().join("scripts/wall.rhai")).unwrap();
    let closed = test_untrained(&written(&wall), 7, &never).unwrap();
    // A rule that reads what the camera sees, and changes nothing.
    let looks = format!("{wall}\nrule \"sees\" when camera.coverage > 2.0 || camera.coverage >= 0.0 => 0.0;");
    let mut open = test_untrained(&written(&looks), 7, &never).unwrap();
    assert!(open.rules.pop().unwrap().fired > STEPS / 2);
    assert_eq!(open, closed);
}
