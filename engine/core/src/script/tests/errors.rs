//! What a script's author is told.

use super::{fan, parse};
use crate::diagnostic::{Diagnostic, Kind};
use crate::random::{Random, Stream};
use crate::script::Behaviour;

pub(super) fn wrong(text: &str) -> Diagnostic {
    *parse(text).map(|_| ()).expect_err(text)
}

/// Code, the marked text, and the help must be these.
pub(super) fn expect(text: &str, code: &str, marked: &str, help: &str) {
    let wrong = wrong(text);
    let place = wrong.place.as_ref().unwrap_or_else(|| panic!("{text}: {wrong:?}"));
    let found = &place.source.text[place.span.clone()];
    let given = wrong.help.clone().unwrap_or_default();
    assert!(wrong.others.is_empty(), "one cause, one error: {text}: {:?}", wrong.others);
    assert!(wrong.code == code && found == marked && given.contains(help), "{text}: {found:?} {wrong:?}");
    for jargon in ["i64", "f64", "ImmutableString", "Dynamic", "expr", "()", "closure"] {
        assert!(!wrong.message.contains(jargon), "{text}: {}", wrong.message);
    }
}

const RULE: &str = "rule \"a\" when true => 1;";

#[test]
fn a_misspelt_fact_is_answered_with_the_nearest() {
    expect("rule \"a\" when laser.rigth < 1.0 => 1;", "E-SCRIPT-FACT", "rigth", "'right'");
    expect("rule \"a\" when laser.min < 1.0 => 1;", "E-SCRIPT-FACT", "min", "'nearest'");
    expect("rule \"a\" when lasr.right < 1.0 => 1;", "E-SCRIPT-NAME", "lasr", "'laser'");
    expect("rule \"a\" when nearest < 1.0 => 1;", "E-SCRIPT-NAME", "nearest", "'laser.nearest'");
    expect("rule \"a\" when laser.sektor(1, 2).nearest < 1.0 => 1;", "E-SCRIPT-FACT", "sektor", "'sector'");
    expect("rule \"a\" when laser.sector(1, 2).nearst < 1.0 => 1;", "E-SCRIPT-FACT", "nearst", "'nearest'");
    expect("rule \"a\" when laser.sector(1) < 1.0 => 1;", "E-SCRIPT-FACT", "sector", "laser.sector(from, to)");
}

#[test]
fn a_misspelt_fact_in_a_function_is_found_at_load() {
    expect("fn reward(facts) { facts.laser.rigth }", "E-SCRIPT-FACT", "rigth", "'right'");
    expect("fn reward(f) { if false { f.lasr.right } else { 0 } }", "E-SCRIPT-FACT", "lasr", "'laser'");
    expect("fn reward(facts) { laser.right }", "E-SCRIPT-FACT", "laser", "facts.laser");
    expect("fn reward(facts) { let l = facts.laser; l.rigth }", "E-SCRIPT-FACT", "rigth", "'right'");
}

#[test]
fn a_beam_or_cell_that_does_not_exist_is_found_at_load() {
    let text = "rule \"a\" when laser[200] < 1.0 => 1;";
    assert_eq!(wrong(text).message, "beam numbers run from 0 to 180");
    expect(text, "E-SCRIPT-FACT", "200", "");
    expect("const B = 181; rule \"a\" when laser.sector(0, B) < 1.0 => 1;", "E-SCRIPT-FACT", "B", "");
    expect("fn reward(facts) { facts.laser[-1] }", "E-SCRIPT-FACT", "-", "");
    expect("rule \"a\" when camera.cell(3, 0) > 0.5 => 1;", "E-SCRIPT-FACT", "3", "");
    assert!(parse("rule \"a\" when laser[180] < 1.0 => 1;").unwrap().judge(0.5, fan(91)).is_err());
}

#[test]
fn a_bearing_that_the_laser_does_not_see_is_found_at_load() {
    let narrow = |rule: &str| format!("laser(#{{ field_of_view_deg: 120 }}); {rule}");
    let text = narrow("rule \"a\" when laser.left < 1.0 => 1;");
    assert_eq!(wrong(&text).message, "the laser sees 60 degrees to either side");
    expect(&text, "E-SCRIPT-FACT", "left", "write laser(#{ field_of_view_deg: 180 }), or another bearing");
    let text = narrow("fn reward(facts) { facts.previous.laser.right }");
    expect(&text, "E-SCRIPT-FACT", "right", "write laser(#{ field_of_view_deg: 180 })");
    expect("const B = -100; rule \"a\" when laser.at(B) < 1.0 => 1;", "E-SCRIPT-FACT", "B", "field_of_view_deg: 200");
    expect("fn reward(facts) { facts.laser.between(80, 200).nearest }", "E-SCRIPT-FACT", "200", "from -180 to 180");
    assert!(parse(&narrow("rule \"a\" when laser.front < laser.at(-60) => 1;")).is_ok());
    assert!(parse("laser(#{ field_of_view_deg: 360 }); rule \"a\" when laser.at(180) < laser.left => 1;").is_ok());
}

#[test]
fn an_incomplete_rule_is_shown_where_something_is_missing() {
    expect("rule \"a\" when laser.right < 1.0;", "E-SCRIPT-RULE", ";", "");
    expect("rule \"a\" when laser.right < 1.0 => ;", "E-SCRIPT-RULE", ";", "");
    expect("rule \"a\" when laser.right < 1.0 => then recover;", "E-SCRIPT-RULE", "then", "");
    expect("rule \"a\" when => 1;", "E-SCRIPT-RULE", "=", "");
    expect("rule a when true => 1;", "E-SCRIPT-RULE", "a", "");
    expect("rule \"\" when true => 1;", "E-SCRIPT-RULE", "\"", "");
    expect("rule \"a\" when true for 3 => 1;", "E-SCRIPT-RULE", "=", "");
    expect("rule \"a\" when true for 0 steps => 1;", "E-SCRIPT-RULE", "0", "leave out");
    expect("rule \"a\" when true for 1.5 steps => 1;", "E-SCRIPT-RULE", "1.5", "seconds");
    expect("rule \"a\" when true => 1 then stop;", "E-SCRIPT-RULE", "stop", "");
}

#[test]
fn a_condition_must_be_true_or_false_and_a_value_a_number() {
    expect("rule \"a\" when laser.right => 1;", "E-SCRIPT-RULE", "laser.right", "compare");
    expect("rule \"a\" when laser => 1;", "E-SCRIPT-RULE", "laser", "compare");
    expect("fn f(x) { x } rule \"a\" when f(laser.right) => 1;", "E-SCRIPT-RULE", "f(laser.right)", "compare");
    expect("rule \"a\" when true => laser.right < 1.0;", "E-SCRIPT-RULE", "laser.right < 1.0", "-1");
    expect("rule \"a\" when true => \"bad\" then recover;", "E-SCRIPT-RULE", "\"bad\"", "-1");
    expect("rule \"a\" when laser.right < \"1\" => 1;", "E-SCRIPT-NAME", "<", "");
}

#[test]
fn a_rule_that_can_never_fire_is_an_error() {
    expect("rule \"a\" when laser.nearest < 0.1 => 1;", "E-SCRIPT-RULE", "laser.nearest < 0.1", "metres");
    expect(
        "rule \"a\" when camera.coverage > 15 && true => 1;",
        "E-SCRIPT-RULE",
        "camera.coverage > 15 && true",
        "shares",
    );
    assert!(parse("rule \"a\" when laser.nearest <= 0.2 || laser.right > 100 => 1;").is_ok());
}

#[test]
fn names_are_unique() {
    expect("rule \"a\" when true => 1;\nrule \"a\" when true => 2;", "E-SCRIPT-RULE", "\"", "line 1");
    expect("world(\"a\"); world(\"b\"); rule \"a\" when true => 1;", "E-SCRIPT-SETTING", "world", "line 1");
    expect("let laser = 1; rule \"a\" when true => 1;", "E-SCRIPT-NAME", "laser", "another");
    expect("fn min(a, b) { a } rule \"a\" when true => 1;", "E-SCRIPT-NAME", "min", "another");
}

#[test]
fn a_wrong_setting_is_shown_at_its_key_or_value() {
    expect(&format!("camera(#{{ tilt_deg: 420 }}); {RULE}"), "E-SCRIPT-SETTING", "420", "default");
    expect(&format!("camera(#{{ tilt: 42 }}); {RULE}"), "E-SCRIPT-SETTING", "tilt", "tilt_deg");
    expect(&format!("camera(#{{ distortion: [-0.3, 0.1] }}); {RULE}"), "E-SCRIPT-SETTING", "distortion", "it has");
    expect(&format!("camera(#{{ tilt_deg: [42] }}); {RULE}"), "E-SCRIPT-SETTING", "[", "write camera(");
    expect(&format!("camera(42); {RULE}"), "E-SCRIPT-SETTING", "camera", "write camera(");
    expect(&format!("world(); {RULE}"), "E-SCRIPT-SETTING", "world", "world(\"room\")");
    expect(&format!("cammera(#{{ tilt_deg: 42 }}); {RULE}"), "E-SCRIPT-NAME", "cammera", "'camera'");
    expect(&format!("learner(\"dqn\"); {RULE}"), "E-SCRIPT-SETTING", "learner", "memory");
    expect(&format!("actions([[0.4]]); {RULE}"), "E-SCRIPT-SETTING", "[0.4]", "m/s");
    expect("fn reward(facts) { world(\"x\"); 1 }", "E-SCRIPT-SETTING", "world", "top");
}

#[test]
fn functions_that_are_not_here_are_named_at_load() {
    expect("fn reward(facts) { wave(2.0) }", "E-SCRIPT-NAME", "wave", "there are");
    expect("fn reward(facts) { sqt(2.0) }", "E-SCRIPT-NAME", "sqt", "'sqrt'");
    expect("fn reward(facts) { atan2(1.0) }", "E-SCRIPT-NAME", "atan2", "atan2(y, x)");
    for call in
        ["sleep(3)", "timestamp()", "eval(\"1\")", "print(1)", "import \"/etc/passwd\" as p", "open_file(\"x\")"]
    {
        let wrong = wrong(&format!("fn reward(facts) {{ {call}; 1 }}"));
        assert!(wrong.code == "E-SCRIPT-NAME" || wrong.code == "E-SCRIPT-SYNTAX", "{call}: {wrong:?}");
        assert!(wrong.place.is_some());
    }
}

#[test]
fn reward_and_calibrate_take_one_argument() {
    expect("fn reward() { 1 }", "E-SCRIPT-REWARD", "reward", "fn reward(facts)");
    expect(
        "fn calibrate(a, b) { 1 } rule \"a\" when true => 1;",
        "E-SCRIPT-REWARD",
        "calibrate",
        "fn calibrate(facts)",
    );
}

#[test]
fn a_reward_that_is_no_number_is_an_error() {
    let both = "#{ value: 1, recover: true, then: \"goal\" }";
    for body in [
        "\"bad\"",
        "",
        "true",
        "#{ value: 1, recovery: true }",
        "#{ recover: true }",
        "#{ value: 1, then: \"stop\" }",
        both,
    ] {
        expect(&format!("fn reward(facts) {{ {body} }}"), "E-REWARD-VALUE", "reward", "then: \"fail\"");
    }
    let mut judge = super::judge("fn reward(facts) { ln(facts.laser.right - 2.0) }");
    let wrong = judge.judge().unwrap_err();
    assert_eq!((wrong.code, wrong.message.as_str()), ("E-REWARD-VALUE", "'fn reward' gave -inf as its value"));
    let mut judge = super::judge("rule \"a\" when true => sqrt(-laser.right);");
    assert_eq!(judge.judge().unwrap_err().code, "E-REWARD-VALUE");
}

#[test]
fn what_does_not_end_is_stopped_by_a_counted_limit() {
    let deep = format!("fn reward(facts) {{ {}1{} }}", "(".repeat(20_000), ")".repeat(20_000));
    let chain = format!("fn reward(facts) {{ 1{} }}", "+1".repeat(100_000));
    let scripts = [
        "loop {}",
        "fn reward(facts) { loop {} }",
        "fn reward(facts) { for i in 0..9999999 {} }",
        "fn reward(facts) { try { loop {} } catch { 1 } }",
        "fn f(x) { f(x) } fn reward(facts) { f(1) }",
        "fn reward(facts) { let a = [1]; loop { a.push(1); } }",
        "fn reward(facts) { let a = [1, 2]; loop { a = [a, a]; } }",
        "fn f(x) { loop {} } rule \"a\" when f(1) => 1;",
        &deep,
        &chain,
    ];
    for script in scripts {
        let wrong = wrong(script);
        assert_eq!(
            (wrong.code, wrong.kind()),
            ("E-SCRIPT-LIMIT", Kind::Limit),
            "{}: {wrong:?}",
            &script[..40.min(script.len())]
        );
    }
}

#[test]
fn a_script_without_a_rule_is_empty() {
    for text in ["", "// nothing\n", "world(\"room\");"] {
        assert_eq!(wrong(text).code, "E-SCRIPT-EMPTY");
    }
}

#[test]
fn unfinished_comments_and_texts_are_shown_where_they_begin() {
    expect("rule \"a\" when true => 1; /* never", "E-SCRIPT-SYNTAX", "/*", "*/");
    expect("world(\"room);\nrule \"a\" when true => 1;", "E-SCRIPT-SYNTAX", "\"", "\"");
    assert!(parse("/* a /* b */ \" ' */ rule \"/*\" when true => 1; // \"").is_ok());
}

#[test]
fn hidden_characters_are_refused() {
    expect("rule \"a\u{202e}\" when true => 1;", "E-SCRIPT-SOURCE", "\u{202e}", "delete");
    expect("rule \"a\" when true => 1;\0", "E-SCRIPT-SOURCE", "\0", "delete");
}

#[test]
fn other_slips_are_told_in_plain_words() {
    expect("world(\"room\")\nrule \"a\" when true => 1;", "E-SCRIPT-SYNTAX", "rule", "';'");
    expect("fn reward(facts) { let f = |x| x; 1 }", "E-SCRIPT-SYNTAX", "|", "");
    expect("fn reward(facts) { if facts.laser.right < \"1\" { 1 } else { 0 } }", "E-SCRIPT-NAME", "<", "quotes");
    expect("fn reward(facts) { 2.0 ** 3.0 }", "E-SCRIPT-SYNTAX", "*", "pow");
    expect("rule \"a\" when laser.right > 1 / 2 => 1;", "E-SCRIPT-RULE", "/", "1.0 / 2.0");
    expect("if true { rule \"a\" when true => 1; }", "E-SCRIPT-RULE", "rule", "top level");
    expect("let near = laser.right; rule \"a\" when true => 1;", "E-SCRIPT-FACT", "laser", "rule");
    expect("rule \"a\" when laser.right > calibrated => 1;", "E-SCRIPT-FACT", "calibrated", "fn calibrate");
}

#[test]
fn files_that_are_no_scripts_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    };
    write("wall.rhai", RULE.as_bytes());
    let load = |path: &std::path::Path| *Behaviour::load(path).map(|_| ()).unwrap_err();
    assert!(load(&folder.path().join("wal.rhai")).help.unwrap().contains("wall.rhai"));
    assert_eq!(load(folder.path()).code, "E-SCRIPT-FILE");
    assert!(load(&write("a.rhai", b"\n\n\xff")).message.contains("line 3"));
    assert!(load(&write("b.rhai", b"\x89PNG\r\n")).message.contains("PNG"));
    assert!(load(&write("c.rhai", &vec![b' '; (1 << 20) + 1])).message.contains("too long"));
    assert!([load(folder.path())].iter().all(|wrong| wrong.kind() == Kind::Input));
}

#[test]
fn a_damaged_script_is_never_a_panic() {
    let mut random = Random::new(11, Stream::Test);
    let pieces = [
        "(", ")", "[", "]", "{", "}", "\"", "'", "`", "/*", "\\", "é", "for", "=>", "then", "-", "9", ".", ";",
        "facts", "#{",
    ];
    for name in ["wall", "platform", "object"] {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../scripts/{name}.rhai"));
        let text: Vec<char> = std::fs::read_to_string(path).unwrap().chars().collect();
        for _ in 0..700 {
            let at = random.below(text.len() as u32) as usize;
            let skipped = random.below(4) as usize;
            let piece = pieces[random.below(pieces.len() as u32) as usize];
            let (before, after) = (&text[..at], text.get(at + skipped..).unwrap_or_default());
            let damaged: String = before.iter().copied().chain(piece.chars()).chain(after.iter().copied()).collect();
            if let Err(wrong) = parse(&damaged) {
                super::mistakes::in_order(&wrong, &damaged);
            }
        }
    }
}
