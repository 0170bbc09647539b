//! All mistakes of a script at once, each of them once.

use super::parse;
use crate::diagnostic::{Diagnostic, MOST_MISTAKES};
use crate::random::{Random, Stream};

fn wrong(text: &str) -> Diagnostic {
    *parse(text).map(|_| ()).expect_err(text)
}

/// Line and marked text of each mistake.
fn told(text: &str) -> Vec<(usize, String)> {
    let wrong = wrong(text);
    let mark = |one: &Diagnostic| {
        let place = one.place.as_ref().unwrap_or_else(|| panic!("{text}: {one:?}"));
        (place.source.position(place.span.start).0, place.source.text[place.span.clone()].to_owned())
    };
    wrong.all().map(mark).collect()
}

fn expect(text: &str, marks: &[(usize, &str)]) {
    let told = told(text);
    let found: Vec<_> = told.iter().map(|(line, mark)| (*line, mark.as_str())).collect();
    assert_eq!(found, marks, "{text}");
}

/// At most twenty, in the order of the text, no two at one place, and each can be shown.
pub(super) fn in_order(wrong: &Diagnostic, text: &str) {
    assert!(wrong.others.len() < MOST_MISTAKES, "{text}");
    assert!(wrong.left_out == 0 || wrong.others.len() == MOST_MISTAKES - 1, "{text}");
    let places: Vec<_> = wrong.all().filter_map(|one| one.place.as_ref()).collect();
    assert!(places.iter().all(|place| place.source.text.get(place.span.clone()).is_some()), "{text}");
    assert!(places.windows(2).all(|pair| pair[0].span.start < pair[1].span.start), "{text}: {wrong:?}");
    assert!(wrong.others.iter().all(|other| other.others.is_empty() && other.left_out == 0));
}

const RULE: &str = "rule \"a\" when true => 1;";

#[test]
fn five_different_mistakes_are_told_in_the_order_of_their_lines() {
    let text = "camera(#{ tilt: 42 });
rule \"a\" when laser.rigth > 1.0 => 1;
rule \"b\" when laser.right > 1.0 for 0 steps => 1;
rule \"b\" when robot.contact => 1;
rule \"c\" when laser.nearest < 0.1 => 1;";
    expect(text, &[(1, "tilt"), (2, "rigth"), (3, "0"), (4, "\""), (5, "laser.nearest < 0.1")]);
    let shown = wrong(text).render(false);
    assert_eq!(shown.matches("^").count(), 4 + 5 + 1 + 1 + 19, "{shown}");
    assert!(shown.ends_with("\n\n5 mistakes in 'test.rhai'"), "{shown}");
    let json = wrong(text).to_json();
    let lines: Vec<_> = json["others"].as_array().unwrap().iter().map(|one| one["line"].as_u64().unwrap()).collect();
    assert_eq!((json["line"].as_u64(), lines), (Some(1), vec![2, 3, 4, 5]));
    assert!(json["others"][0].get("others").is_none() && json["left_out"] == 0);
}

#[test]
fn of_twenty_five_mistakes_twenty_are_shown() {
    let fact = |number: usize| format!("rule \"{number}\" when laser.rigth > 1.0 => 1;\n");
    let text: String = (0..25).map(fact).collect();
    assert_eq!(told(&text).len(), 20);
    assert!(wrong(&text).render(false).ends_with("25 mistakes in 'test.rhai': 20 are shown, and 5 more"));
    // The same when they are found one after the other, from the last.
    let calls: String = (0..5).map(|_| "camera(#{ tilt: 1 });\n").collect();
    let error = wrong(&format!("{}{calls}", (0..20).map(fact).collect::<String>()));
    assert_eq!((error.others.len(), error.left_out), (19, 5));
    let broken: String = (0..25).map(|number| format!("rule \"{number}\" when => 1;\n")).collect();
    assert_eq!((told(&broken).len(), wrong(&broken).left_out), (20, 5));
}

#[test]
fn one_cause_is_told_once() {
    // A rule with an unknown fact is not tried, nor held against its values.
    expect("rule \"a\" when laser.rigth < 0.1 && laser.rigt => 1;", &[(1, "rigth"), (1, "rigt")]);
    // What could not be defined spoils whatever uses it.
    let text = "const FAR = lasr.right;\nlet near = FAR / 2;\nfn half(x) { x * near }
rule \"a\" when laser.right > FAR => 1;\nrule \"b\" when laser.right > near => half(1);\nfn reward(facts) { half(1) }";
    expect(text, &[(1, "lasr")]);
    // A definition that is missing is missing once; a slip of the pen is to be mended in each place.
    expect("rule \"a\" when limit > 1 => 1;\nrule \"b\" when limit > 2 => wave(limit);", &[(1, "limit"), (2, "wave")]);
    let help = wrong("rule \"a\" when limit > 1 => 1;\nrule \"b\" when limit > 2 => 1;").help.unwrap();
    assert!(help.ends_with("(it stands in line 2 too)"), "{help}");
    expect("rule \"a\" when lasr.right > 1 => 1;\nrule \"b\" when lasr.left > 1 => 1;", &[(1, "lasr"), (2, "lasr")]);
    // A setting that could not be read is not relied upon.
    expect("laser(#{ beems: 361 });\nrule \"a\" when laser[300] < 1.0 => 1;", &[(1, "beems")]);
    expect("grid(#{ rows: 99 });\nrule \"a\" when camera.cell(9, 0) > 0.5 => 1;", &[(1, "99")]);
    expect("laser(#{ min_range_m: -1 });\nrule \"a\" when laser.nearest < 0.05 => 1;", &[(1, "-")]);
    // One wrong function that many rules call.
    let text = "fn f(x) { x + \"a\" < 1 }\nrule \"a\" when f(1) => 1;\nrule \"b\" when f(2) => 1;";
    assert_eq!(told(text).len(), 1);
    // A rule in a function is only in the wrong place.
    expect("fn f() { rule \"a\" when laser.right > 1 => 1; }\nfn reward(facts) { 1 }", &[(1, "rule")]);
    expect("fn calibrate(facts) { \"x\" }\nrule \"a\" when laser.right > calibrated.a => 1;", &[(1, "calibrate")]);
    expect("wrold(\"small\");", &[(1, "wrold")]);
}

#[test]
fn what_an_unknown_call_is_given_is_not_looked_at() {
    expect("rule \"a\" when camera.colour(laser.lft) == \"red\" => 1;", &[(1, "colour")]);
    expect("rule \"a\" when wave(laser.rigth, laser[999]) > 1 => 1;", &[(1, "wave")]);
    expect("fn reward(facts) { facts.laser.mode(nothing, 1 / 2) }", &[(1, "mode")]);
    // What stands beside it is.
    expect("rule \"a\" when wave(1) > laser.rigth => 1;", &[(1, "wave"), (1, "rigth")]);
}

#[test]
fn a_statement_that_cannot_be_parsed_does_not_hide_the_others() {
    let text = "camera(#{ tilt_deg: 42 ;\n";
    assert_eq!(told(&format!("{text}{RULE}")).len(), 1);
    let text = "const FAR = 1 +;
rule \"a\" when laser.rigth > 1 => 1;
rule \"b\" when laser.right > FAR => 1;
rule \"c\" when => 1;
fn reward(facts) { facts.laser.right ** 2 }
fn half(x) { x. }
rule \"d\" when half(laser.right) > 1 => half(1) for 3;
run(#{ steps: -1 });";
    expect(text, &[(1, ";"), (2, "rigth"), (4, "="), (5, "*"), (6, "}"), (7, "for"), (8, "-")]);
    // Accents before it in its line move no caret.
    expect("let é = 1 +; rule \"ä\" when laser.rigth > 1 => 1;", &[(1, "é"), (1, "rigth")]);
}

#[test]
fn statements_after_one_that_fails_still_run() {
    let text = "let a = [1][3];\nlet b = a + 1;\nrun(#{ steps: -1 });\nlet c = #{}.x;\nworld(7);\nlet d = 1;
rule \"a\" when laser.right > d for 0 steps => b;";
    expect(text, &[(1, "3"), (3, "-"), (4, "x"), (5, "world"), (7, "0")]);
}

#[test]
fn a_limit_ends_the_search_and_is_told_with_what_was_found() {
    let error = wrong("camera(#{ tilt: 1 });\nlet x = 0;\nloop { x += 1; }\nrule \"a\" when laser.rigth > 1 => 1;");
    let codes: Vec<_> = error.all().map(|one| one.code).collect();
    assert_eq!(codes, ["E-SCRIPT-LIMIT", "E-SCRIPT-FACT"]);
}

#[test]
fn characters_that_do_not_belong_are_told_once_a_line() {
    assert_eq!(told("let a = 1;\0\0\0\n// \u{202e}\n\u{7}").len(), 3);
}

#[test]
fn a_hostile_number_of_mistakes_is_counted_within_bounds() {
    let cases = [
        ("f();", 1),
        ("x;", 1),
        ("camera.a;", 5_000),
        ("world(=);\n", 10),
        ("let a = 1;", 1),
        ("camera(#{ tilt: 1 });\n", 1),
        ("\0\n", 50_000),
    ];
    for (line, least) in cases {
        let error = wrong(&line.repeat(400_000 / line.len()));
        in_order(&error, line);
        assert!(error.left_out + error.others.len() + 1 >= least, "{line}: {}", error.left_out);
    }
    let rules: String =
        (0..3_000).map(|number| format!("rule \"{number}\" when laser.rigth < 1 => wave(1);")).collect();
    assert_eq!(told(&rules).len(), 20);
}

#[test]
fn shipped_scripts_with_several_damages_are_told_in_order() {
    let mut random = Random::new(12, Stream::Test);
    let pieces =
        ["laser.rigth", "0", "camera(#{ tilt: 1 });", "=>", "lasr", "\"", "then", "for 0 steps", "wave(1)", "}"];
    for name in ["wall", "corridor", "dock", "line"] {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../scripts/{name}.rhai"));
        let text = std::fs::read_to_string(path).unwrap();
        let words: Vec<&str> = text.split_inclusive(' ').collect();
        for _ in 0..150 {
            let mut damaged: Vec<&str> = words.clone();
            for _ in 0..1 + random.below(6) {
                let at = random.below(damaged.len() as u32) as usize;
                damaged[at] = pieces[random.below(pieces.len() as u32) as usize];
            }
            let damaged = damaged.concat();
            if let Err(wrong) = parse(&damaged) {
                in_order(&wrong, &damaged);
                let again = parse(&damaged).map(|_| ()).unwrap_err();
                assert_eq!(again.render(false), wrong.render(false), "the same each time: {damaged}");
            }
        }
    }
}

#[test]
fn every_mistake_in_a_list_of_actions_and_of_the_parts_of_a_state_is_told() {
    let actions = "actions([[0.4], [9.4, 0.0], [0.2, 0.0], [\"x\", 0.0]]);\nrule \"a\" when robot.contact => -1;";
    expect(actions, &[(1, "[0.4]"), (1, "[9.4, 0.0]"), (1, "[\"x\", 0.0]")]);
    let state = "state(\"camrea\",\nbins(laser.front, [1.0, 0.5]),\nbins(laser.left, [1.0, 1.0]), 5);\nrule \"a\" when robot.contact => -1;";
    expect(state, &[(1, "state"), (2, "laser"), (3, "laser")]);
}

#[test]
fn who_indexes_the_laser_as_elsewhere_is_told_how_beams_are_written() {
    for read in ["laser[beam]", "laser[\"front\"]", "laser(5)", "laser[1.5]"] {
        let text = format!("rule \"a\" when {read} < 1.0 => -1;");
        let told = super::errors::wrong(&text);
        assert!(told.help.as_deref().is_some_and(|help| help.contains("laser[90]")), "{read}: {told:?}");
    }
}
