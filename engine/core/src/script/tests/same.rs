//! Native rules and interpreted ones give the same.

use super::super::Behaviour;
use super::{fan, parse};
use crate::diagnostic::Diagnostic;
use crate::judge::rule::{Clause, CompiledRule};
use crate::judge::{Facts, ViewFacts};
use crate::random::{Random, Stream};

const BEAMS: usize = 9;

/// A random script; every rule stands there twice, once behind a function call, which keeps it interpreted.
struct Writer {
    random: Random,
}

impl Writer {
    fn one_of<'a>(&mut self, of: &[&'a str]) -> &'a str {
        of[self.random.below(of.len() as u32) as usize]
    }

    fn number(&mut self, depth: u32) -> String {
        let leaves = [
            "laser.nearest",
            "laser.left",
            "laser.front",
            "facts.laser.right",
            "laser[3]",
            "facts.laser[BEAM]",
            "HALF",
            "laser.sector(2, 6).farthest",
            "laser.sector(0, BEAM).mean",
            "camera.coverage",
            "camera.cell(1, 2)",
            "camera.rows(0, 1)",
            "facts.camera.columns(1, 2)",
            "camera.bearing_deg",
            "facts.camera.line_offset_m",
            "action.linear",
            "action.angular",
            "robot.linear",
            "0.75",
            "-1.5",
            "calibrated.front",
            "laser.sector(1, 2).excess(calibrated.pair)",
            "facts.calibrated.front",
        ];
        if depth == 0 {
            return self.one_of(&leaves).to_owned();
        }
        let (a, b) = (self.number(depth - 1), self.number(depth - 1));
        let whole = self.whole();
        match self.random.below(9) {
            0 => format!("({a} {} {b})", self.one_of(&["+", "-", "*", "/", "%"])),
            1 => format!("({a} {} {whole})", self.one_of(&["+", "-", "*", "/", "%"])),
            2 => format!("({whole} {} {b})", self.one_of(&["+", "-", "*", "/"])),
            3 => format!("{}({a}, {b})", self.one_of(&["min", "max", "pow", "hypot", "atan2"])),
            4 => format!(
                "{}({a})",
                self.one_of(&["abs", "sqrt", "sin", "exp", "ln", "floor", "round", "radians", "tanh"])
            ),
            5 => format!("{}({whole})", self.one_of(&["sqrt", "cos", "radians", "to_float"])),
            6 => format!("-({a})"),
            7 => format!("max({a}, {whole})"),
            _ => a,
        }
    }

    fn whole(&mut self) -> String {
        let leaves = [
            "laser.beams",
            "laser.nearest_beam",
            "action.index",
            "state.index",
            "time.step",
            "time.since_recovery",
            "3",
            "-2",
            "0",
            "BEAM",
            "laser.sector(0, 8).count_below(0.5)",
            "-(BEAM)",
        ];
        self.one_of(&leaves).to_owned()
    }

    fn flag(&mut self, depth: u32) -> String {
        let compare = ["<", "<=", ">", ">=", "==", "!="];
        if depth == 0 {
            let (a, b, whole, other) = (self.number(1), self.number(1), self.whole(), self.whole());
            return match self.random.below(6) {
                0 => format!("{a} {} {b}", self.one_of(&compare)),
                1 => format!("{whole} {} {other}", self.one_of(&compare)),
                2 => format!("{a} {} {whole}", self.one_of(&compare)),
                3 => format!("laser {} {b}", self.one_of(&compare[..4])),
                4 => format!("{} < laser.sector(1, 4)", whole),
                _ => self
                    .one_of(&["camera.seen", "robot.contact", "!facts.robot.fallen", "ON", "camera.seen == ON"])
                    .to_owned(),
            };
        }
        let (a, b) = (self.flag(depth - 1), self.flag(depth - 1));
        match self.random.below(4) {
            0 => format!("({a}) && ({b})"),
            1 => format!("({a}) || ({b})"),
            2 => format!("!({a})"),
            _ => format!("({a}) {} ({b})", self.one_of(&["==", "!="])),
        }
    }

    fn facts(&mut self, facts: &mut Facts) {
        let mut unit = || self.random.unit();
        facts.ranges_m.iter_mut().for_each(|range| *range = (unit() * 2.0 + 0.2) as f32);
        let cells = (0..9).map(|_| unit() as f32).collect();
        let (areas_px, grid, coverage, seen) = (vec![4, 5, 4, 4, 5, 4, 4, 5, 4], (3, 3), unit(), unit() < 0.5);
        facts.views = vec![ViewFacts { cells, areas_px, grid, coverage, seen, ..ViewFacts::default() }];
        (facts.action_linear_m_per_s, facts.action_angular_rad_per_s) = (unit(), unit() - 0.5);
        (facts.linear_m_per_s, facts.angular_rad_per_s) = (unit() * 2.0 - 1.0, unit() - 0.5);
        (facts.contact, facts.fallen) = (unit() < 0.5, unit() < 0.5);
        (facts.state, facts.action) = ((unit() * 64.0) as usize, (unit() * 14.0) as usize);
        (facts.step, facts.since_recovery) = ((unit() * 1000.0) as u64, (unit() * 5.0) as u64);
    }
}

const HEAD: &str = "laser(#{ beams: 9, min_range_m: 0, max_range_m: 100 });
    const HALF = 0.5; let BEAM = 4; const ON = true;
    fn same(x) { x }
    fn calibrate(facts) { #{ front: facts.laser.front, pair: [1, 1.5] } }\n";

#[test]
fn native_rules_and_interpreted_rules_agree() {
    let mut writer = Writer { random: Random::new(5, Stream::Test) };
    let mut compared = 0;
    let mut spare = parse(&format!("{HEAD} rule \"a\" when true => 1;")).unwrap().judge(0.5, fan(BEAMS)).unwrap();
    for _ in 0..1500 {
        let (flag, number) = (writer.flag(2), writer.number(2));
        let native = parse(&format!("{HEAD} rule \"a\" when {flag} => {number};"));
        let interpreted = parse(&format!("{HEAD} rule \"a\" when same({flag}) => same({number});"));
        // What is no number whatever is measured is refused; its facts are drawn all the same.
        let no_number = |wrong: &Diagnostic| wrong.message == "this gives no number";
        if let Err(wrong) = &native
            && no_number(wrong)
            && wrong.others.iter().all(no_number)
        {
            (0..4).for_each(|_| writer.facts(spare.facts_mut()));
        }
        let (Ok(native), Ok(interpreted)) = (native, interpreted) else { continue };
        let mut judges = [native.judge(0.5, fan(BEAMS)).unwrap(), interpreted.judge(0.5, fan(BEAMS)).unwrap()];
        for _ in 0..4 {
            writer.facts(judges[0].facts_mut());
            let facts = judges[0].facts_mut().clone();
            *judges[1].facts_mut() = facts;
            let verdicts = judges.each_mut().map(|judge| {
                judge.calibrate().unwrap();
                judge.judge().map(|verdict| verdict.reward.to_bits()).map_err(|wrong| wrong.code)
            });
            assert_eq!(verdicts[0], verdicts[1], "when {flag} => {number}");
            compared += 1;
        }
    }
    assert!(compared > 4000, "{compared}");
}

/// Numbers by which comparisons could be told apart: none, infinite, next to one another, next to zero, huge.
const SPECIAL: [f64; 14] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    0.0,
    -0.0,
    5e-324,
    1e-17,
    0.3,
    0.1 + 0.2,
    1.0,
    1.0 + f64::EPSILON,
    -1.0,
    f64::MAX,
    f64::MIN,
];

#[test]
fn a_comparison_of_any_two_numbers_is_the_same_in_the_interpreter_and_where_it_is_compiled() {
    for operator in ["<", "<=", ">", ">=", "==", "!="] {
        for (a, b) in [
            ("robot.linear", "robot.angular"),
            ("robot.linear", "0.3"),
            ("robot.linear", "1"),
            ("-1", "robot.angular"),
            ("mean", "robot.linear"),
            ("moved", "robot.angular"),
            ("moved", "0"),
            ("robot.linear - robot.angular", "mean * 2.0"),
        ] {
            let head = format!(
                "{HEAD} measure mean = average(robot.linear, 1.0); measure moved = change(robot.linear);
                 rule \"mark\" when robot.linear {operator} robot.angular => 0;"
            );
            let native = format!("{head} rule \"a\" when {a} {operator} {b} && since(\"mark\") >= 0 => 1;");
            let other = format!("{head} measure ago = since(\"mark\"); rule \"a\" when same({a} {operator} {b}) => 1;");
            let mut judges = [native, other].map(|text| parse(&text).unwrap().judge(0.5, fan(BEAMS)).unwrap());
            for pair in SPECIAL.iter().flat_map(|a| SPECIAL.iter().map(move |b| (*a, *b))) {
                let verdicts = judges.each_mut().map(|judge| {
                    let facts = judge.facts_mut();
                    facts.ranges_m = vec![1.0; BEAMS];
                    (facts.linear_m_per_s, facts.angular_rad_per_s) = pair;
                    judge.calibrate().unwrap();
                    judge.judge().map(|verdict| verdict.reward).map_err(|wrong| wrong.code)
                });
                assert_eq!(verdicts[0], verdicts[1], "{a} {operator} {b} of {pair:?}");
            }
        }
    }
}

#[test]
fn comparisons_are_those_of_arithmetic_but_for_rounding() {
    let holds = |condition: &str, linear: f64| {
        [condition.to_owned(), format!("same({condition})")].map(|condition| {
            let mut judge =
                parse(&format!("{HEAD} rule \"a\" when {condition} => 1;")).unwrap().judge(0.5, fan(BEAMS)).unwrap();
            judge.facts_mut().ranges_m = vec![1.0; BEAMS];
            judge.facts_mut().linear_m_per_s = linear;
            judge.calibrate().unwrap();
            judge.judge().unwrap().reward == 1.0
        })
    };
    for (condition, linear, wanted) in [
        ("robot.linear > 1.0", f64::INFINITY, true),
        ("robot.linear >= robot.linear", f64::INFINITY, true),
        ("robot.linear == robot.linear", f64::INFINITY, true),
        ("robot.linear == -robot.linear", f64::INFINITY, false),
        ("robot.linear != robot.linear", f64::NAN, true),
        ("robot.linear == robot.linear", f64::NAN, false),
        ("robot.linear < 1.0", f64::NAN, false),
        ("robot.linear == 0.3", 0.1 + 0.2, true),
        ("robot.linear > 0.3", 0.1 + 0.2, true),
    ] {
        assert_eq!(holds(condition, linear), [wanted; 2], "{condition} of {linear}");
    }
}

#[test]
fn the_rules_of_the_scripts_are_native() {
    for name in ["wall", "corridor", "platform", "object"] {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../scripts/{name}.rhai"));
        let judge = Behaviour::load(&path).unwrap().judge(0.5, fan(181)).unwrap();
        let native =
            |rule: &CompiledRule| matches!((&rule.condition, &rule.value), (Clause::Native(_), Clause::Native(_)));
        assert!(judge.present().compiled.rules.iter().all(native), "{name}");
    }
}

/// Whatever the manual says of a rule is judged without the interpreter.
#[test]
fn every_form_of_a_rule_is_native() {
    let head = r#"view("red", filter("colour")); stages(["a", "b"]);
        measure gap = laser.between(-20, 20).nearest; measure near = if red.seen { gap } else { 5.0 };
        rule "mark" when laser.front < 1.0 => 0 then stage "b";"#;
    for flag in [
        "laser.at(5) < 0.6",
        "laser.between(-20, 20) < 0.6",
        "laser.hit_at(5) && laser.hit(90)",
        "laser.sector(60, 120).hits > 3",
        "red.seen && abs(red.bearing_deg) < 10",
        "red.line_seen && red.line_offset_m > 0.2",
        "red.cell(1, 1) + red.rows(0, 1) - red.columns(1, 2) > 0.3",
        "ground.left > 120 || ground.hue_deg < 20",
        "previous.laser.front - laser.front > 0.1",
        "abs(change(odometry.turned_deg, 6)) > 150",
        "average(laser.front < 1.0, 2) > 0.5",
        "fired(\"mark\") > 2 && since(\"mark\") < 4.0",
        "stage.at(\"b\") && stage.seconds > 20",
        "near < gap",
        "clamp(gap, 0.0, 1) < 0.5 && sign(action.angular) == 1",
        "time.attempt_s > 60",
    ] {
        let behaviour = parse(&format!("{head} rule \"x\" when {flag} for 2 seconds once => 0.1 * gap per second;"));
        let judge = behaviour.unwrap().judge(0.5, fan(181)).unwrap();
        let rule = judge.present().compiled.rules.last().unwrap();
        assert!(matches!((&rule.condition, &rule.value), (Clause::Native(_), Clause::Native(_))), "{flag}");
    }
}
