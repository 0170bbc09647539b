//! Scripts that ask for too much: each is refused with one clear error, or runs within its limits.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use engine::experiment::{Overrides, Plan};
use engine::script::Behaviour;

use crate::support::Bench;

const HIT: &str = "rule \"hit\" when robot.contact => -1 then fail;\n";

/// A text for each number, joined.
fn each(count: usize, text: impl Fn(usize) -> String) -> String {
    (0..count).map(text).collect()
}

/// A list of texts, as a script writes it.
fn list(count: usize, text: impl Fn(usize) -> String) -> String {
    (0..count).map(text).collect::<Vec<_>>().join(", ")
}

/// Scripts that are refused, each with the code.
fn refused() -> Vec<(&'static str, String)> {
    let averages = |count| each(count, |i| format!("rule \"r{i}\" when average(laser.at({i}), 1) < 0.3 => -1;\n"));
    let views = |count| each(count, |i| format!("view(\"v{i}\", filter(\"sobel\"));\n"));
    let bins = |parts, edges| {
        let edges = list(edges, |i| format!("{}", 0.1 * (i + 1) as f64));
        format!("state(\"camera\", {});\n{HIT}", list(parts, |i| format!("bins(laser.at({}), [{edges}])", 10 * i)))
    };
    let sum = |count: usize| vec!["laser.front"; count].join(" + ");
    vec![
        ("E-SCRIPT-LIMIT", averages(65)),
        ("E-SCRIPT-LIMIT", each(33, |i| format!("measure m{i} = laser.at({i});\n")) + HIT),
        ("E-SCRIPT-LIMIT", each(257, |i| format!("rule \"r{i}\" when laser.front < 0.{} => -1;\n", 300 + i))),
        ("E-SCRIPT-LIMIT", format!("{HIT}{}", each(17, |i| format!("success \"s{i}\" when test.laps > {i};\n")))),
        ("E-SCRIPT-LIMIT", views(9) + HIT),
        ("E-SCRIPT-LIMIT", format!("rule \"x\" when {} < 0.5 => -1 then fail;\n", sum(5000))),
        ("E-SCRIPT-LIMIT", format!("rule \"x\" when {}1.0{} < 0.5 => -1;\n", "(".repeat(200), ")".repeat(200))),
        ("E-SCRIPT-LIMIT", format!("filter(\"where\", \"{}\");\n{HIT}", vec!["r > 60"; 3000].join(" && "))),
        ("E-SCRIPT-LIMIT", "fn reward(facts) { loop { } }\n".to_owned()),
        ("E-SCRIPT-LIMIT", "fn reward(facts) { let a = []; loop { a.push(1); } }\n".to_owned()),
        ("E-SCRIPT-LIMIT", "fn reward(facts) { let a = \"x\"; loop { a += a; } }\n".to_owned()),
        ("E-SCRIPT-LIMIT", "fn f(x) { f(x + 1) }\nfn reward(facts) { f(1) }\n".to_owned()),
        ("E-SCRIPT-LIMIT", format!("fn calibrate(facts) {{ loop {{ }} }}\n{HIT}")),
        ("E-SCRIPT-LIMIT", format!("let a = [1]; loop {{ a += a; }}\n{HIT}")),
        ("E-SCRIPT-LIMIT", format!("loop {{ }}\n{HIT}")),
        ("E-SCRIPT-LIMIT", each(300, |i| format!("const p{i} = param(0.5, #{{ low: 0.0, high: 1.0 }});\n")) + HIT),
        ("E-SCRIPT-WINDOW", "rule \"x\" when average(laser.front, 601) < 0.5 => -1 then fail;\n".to_owned()),
        ("E-SCRIPT-SETTING", format!("stages([{}]);\n{HIT}", list(17, |i| format!("\"s{i}\"")))),
        ("E-SCRIPT-SETTING", format!("view(\"v\", {});\n{HIT}", list(9, |_| "filter(\"sobel\")".to_owned()))),
        ("E-SCRIPT-SETTING", bins(8, 1)),
        ("E-SCRIPT-SETTING", bins(1, 16)),
        ("E-GRID", format!("learner(\"ttd\");\n{}", bins(5, 15))),
        ("E-GRID", bins(7, 15)),
        ("E-GRID", format!("grid(#{{ rows: 16, columns: 16 }});\n{HIT}")),
        ("E-SCRIPT-SETTING", format!("grid(#{{ rows: 120, columns: 160 }});\n{HIT}")),
        ("E-SCRIPT-SETTING", format!("laser(#{{ beams: 100000 }});\n{HIT}")),
        ("E-SCRIPT-SETTING", format!("run(#{{ steps: 1000000000000 }});\n{HIT}")),
        ("E-SCRIPT-SETTING", format!("starts([{}]);\n{HIT}", list(65, |i| format!("\"s{i}\"")))),
        ("E-FILTER-SETTING", format!("filter(\"where\", \"{}r > 60{}\");\n{HIT}", "(".repeat(60), ")".repeat(60))),
        ("E-ROBOT-FILE", format!("robot(\"../../x\");\n{HIT}")),
        ("E-SCRIPT-SYNTAX", format!("import \"x\" as y;\n{HIT}")),
        ("E-SCRIPT-SYNTAX", format!("eval(\"loop {{ }}\");\n{HIT}")),
        ("E-SCRIPT-SOURCE", format!("rule \"a\u{1b}[31mb\" when robot.contact => -1 then fail;\n{HIT}")),
        ("E-SCRIPT-SOURCE", format!("{HIT}// {}\n", "x".repeat(2 << 20))),
    ]
}

/// Scripts at the very limits, which run.
fn accepted() -> Vec<String> {
    let mark = |from: &str, to: &str| format!("rule \"{from}\" in \"{from}\" when true => 0 then stage \"{to}\";\n");
    vec![
        each(32, |i| format!("measure m{i} = average(laser.at({i}), 600);\n"))
            + &*each(32, |i| format!("rule \"r{i}\" when average(laser.at(-{i}), 600) < 0.1 => -1 then fail;\n")),
        format!("stages([\"a\", \"b\", \"c\"]);\n{}{}{}{HIT}", mark("a", "b"), mark("b", "c"), mark("c", "a")),
        format!("stages([\"a\", \"b\"]);\n{}{HIT}", mark("a", "a")),
        each(8, |i| format!("view(\"v{i}\", filter(\"sobel\"), grid(#{{ rows: 1, columns: 1 }}));\n")) + HIT,
        format!("{HIT}{}", each(255, |i| format!("rule \"r{i}\" when laser.at({}) < 0.3 => -0.001;\n", i % 90))),
    ]
}

fn run(bench: &Bench, text: &str) -> engine::diagnostic::Result<()> {
    bench.write("mine.rhai", format!("world(\"small\");\n{text}"));
    let steps = Overrides { steps: Some(400), ..Overrides::default() };
    let plan = Plan::new(Arc::new(Behaviour::load(&bench.path().join("mine.rhai"))?), &steps)?;
    let learned = engine::experiment::learn(&plan, 1, &AtomicBool::new(false), &|_| {});
    learned.map(drop).map_err(|broken| broken.error)
}

#[test]
fn scripts_that_ask_for_too_much_are_refused_with_one_error() {
    let bench = Bench::new();
    for (code, text) in refused() {
        let error = run(&bench, &text).expect_err(&text[..text.len().min(200)]);
        assert_eq!(error.code, code, "{}: {}", error.message, &text[..text.len().min(200)]);
    }
}

#[test]
fn scripts_at_the_limits_learn() {
    let bench = Bench::new();
    for text in accepted() {
        if let Err(error) = run(&bench, &text) {
            panic!("{}: {}", error.message, &text[..text.len().min(200)]);
        }
    }
}
