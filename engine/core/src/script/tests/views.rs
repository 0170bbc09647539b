//! Views with names, and states made of several parts.

use super::{judge, parse};
use crate::judge::{Judge, Look, PatchFacts, ViewFacts};
use crate::settings::PartSettings;

const TWO: &str = "view(\"red\", filter(\"colour\"), grid(#{ rows: 2, columns: 3 }));
view(\"lines\", filter(\"sobel\", #{ threshold: 60 }));
";

fn two(rest: &str) -> String {
    format!("{TWO}{rest}")
}

/// A judge to whom the second view shows a patch ahead, a little to the left.
fn seeing(judge: &mut Judge) {
    let patch = PatchFacts { size: 0.2, bearing_deg: 8.0, ..PatchFacts::NOTHING };
    let lines = ViewFacts {
        seen: true,
        grid: (3, 3),
        cells: vec![0.5; 9],
        areas_px: vec![4; 9],
        patch,
        ..ViewFacts::default()
    };
    judge.facts_mut().views = vec![ViewFacts { grid: (2, 3), cells: vec![0.0; 6], ..ViewFacts::default() }, lines];
}

fn reward(rest: &str) -> f64 {
    let mut judge = judge(&two(rest));
    seeing(&mut judge);
    judge.judge().unwrap().reward
}

/// One mistake with this message, with a place and a way out.
fn told(text: &str, code: &str, message: &str) {
    let wrong = parse(text).err().unwrap_or_else(|| panic!("{text}"));
    assert_eq!((wrong.code, wrong.message.as_str()), (code, message), "{text}");
    let way_out = wrong.help.is_some() || message.starts_with("the grid has");
    assert!(wrong.place.is_some() && way_out && wrong.others.is_empty(), "{text}: {wrong:?}");
}

#[test]
fn every_view_has_the_facts_of_a_camera_under_its_name() {
    assert_eq!(reward("rule \"a\" when !red.seen && lines.seen => lines.bearing_deg;"), 8.0);
    assert_eq!(reward("rule \"a\" when red.bearing_deg == 180 => lines.cell(1, 1) + lines.rows(0, 1);"), 1.0);
    assert_eq!(reward("fn reward(facts) { facts.lines.size + facts.lines.columns(0, 2) }"), 0.7);
    // Left to the interpreter.
    assert_eq!(reward("fn of(x) { x } rule \"a\" when of(lines.seen) => of(lines.size);"), 0.2);
}

#[test]
fn the_step_before_is_kept_of_views_too() {
    let mut judge = judge(&two("rule \"a\" when true => lines.size - previous.lines.size;"));
    seeing(&mut judge);
    judge.judge().unwrap();
    seeing(&mut judge);
    judge.facts_mut().views[1].patch.size = 0.5;
    assert!((judge.judge().unwrap().reward - 0.3).abs() < 1e-12);
}

#[test]
fn only_what_is_read_is_looked_for() {
    let looks = |rest: &str| judge(&two(rest)).looks().to_vec();
    let (none, patch, line) = (Look::default(), Look { patch: true, line: false }, Look { patch: true, line: true });
    assert_eq!(looks("rule \"a\" when red.seen => 1;"), [none, none]);
    assert_eq!(looks("rule \"a\" when lines.size > 0.1 => red.line_offset_m;"), [line, patch]);
    assert_eq!(looks("fn reward(facts) { facts.red.size }"), [patch, none]);
    // In a variable it may be any view.
    assert_eq!(looks("fn reward(facts) { let view = facts.red; view.size }"), [patch, patch]);
}

#[test]
fn a_bare_filter_or_grid_makes_a_view_without_a_name_before_the_others() {
    let behaviour = parse(&two("filter(\"colour\"); rule \"a\" when camera.seen => 1;")).unwrap();
    let names =
        |settings: &crate::settings::Settings| settings.views().map(|view| view.name.clone()).collect::<Vec<_>>();
    assert_eq!(names(behaviour.settings()), ["camera", "red", "lines"]);
    let behaviour = parse(&two("rule \"a\" when red.seen => 1;")).unwrap();
    assert_eq!(names(behaviour.settings()), ["red", "lines"]);
    assert_eq!(behaviour.settings().view.grid.rows, 2);
    assert_eq!(behaviour.settings().further_views[0].filters[0].parameters, [("threshold".to_owned(), 60.0)]);
}

#[test]
fn values_in_a_state_are_told_apart_by_ranges() {
    let mut judge = judge(&two("measure far = laser.front > 1.0;
         state(\"lines\", bins(laser.front, [0.5, 1.0]), bins(far), bins(change(laser.front), [0.05]));
         stages([\"a\", \"b\"]); rule \"on\" when laser.front > 1.5 => 1 then stage \"b\";"));
    let mut digits = |range_m: f32| {
        judge.facts_mut().ranges_m.fill(range_m);
        judge.judge().unwrap();
        judge.digits().to_vec()
    };
    assert_eq!(digits(0.4), [0, 0, 0, 0]);
    assert_eq!(digits(0.5), [1, 0, 1, 0]);
    assert_eq!(digits(2.0), [2, 1, 1, 1]);
    assert_eq!(digits(2.0), [2, 1, 0, 1]);
}

#[test]
fn a_state_keeps_the_words_of_its_parts() {
    let behaviour =
        parse(&two("state(\"red\", bins(abs(laser.left - 1.0), [0.5])); rule \"a\" when true => 1;")).unwrap();
    let of = "abs(laser.left - 1.0)".to_owned();
    let parts = [PartSettings::View("red".to_owned()), PartSettings::Bins { of, edges: vec![0.5] }];
    assert_eq!(behaviour.settings().state, parts);
}

#[test]
fn words_of_views_and_states_stay_a_script_s_own() {
    assert!(parse("fn view(x) { x } fn state(x) { x } rule \"a\" when view(state(1)) > 0 => 1;").is_ok());
    assert!(parse("let bins = 3; rule \"a\" when laser.nearest < bins => 1;").is_ok());
}

#[test]
fn what_is_wrong_with_a_view_is_told_at_its_name() {
    let rule = "rule \"a\" when true => 1;";
    let view = |name: &str| format!("view(\"{name}\", filter(\"colour\")); {rule}");
    for (name, message) in [
        ("Red", "the name of a view is a word in small letters: its facts are read by it"),
        ("laser", "'laser' is the name of facts"),
        ("when", "'when' is a word of the language"),
        ("change", "'change' is the name of one of the engine's functions"),
    ] {
        told(&view(name), "E-SCRIPT-VIEW", message);
    }
    told(&format!("let red = 1; {}", view("red")), "E-SCRIPT-VIEW", "there is a variable called 'red'");
    told(
        &format!("{}{}", view("red"), view("red").replace("\"a\"", "\"b\"")),
        "E-SCRIPT-VIEW",
        "there are two views called 'red'",
    );
    told(&format!("view(\"red\"); {rule}"), "E-SCRIPT-SETTING", "a view has 1 to 8 filters, found 0");
    told(
        &format!("view(\"red\", grid(#{{ rows: 2 }}), filter(\"colour\")); {rule}"),
        "E-SCRIPT-SETTING",
        "a view is a name, filters, and a grid",
    );
    told(
        &format!("view(\"red\", filter(\"colour\"), grid(#{{ rows: 99 }})); {rule}"),
        "E-SCRIPT-SETTING",
        "'rows' must be a whole number from 1 to 16 (cells)",
    );
    let twice = "let f = filter(\"colour\"); view(\"red\", f); view(\"blue\", f); rule \"a\" when true => 1;";
    told(twice, "E-SCRIPT-SETTING", "this filter belongs to another view already");
}

#[test]
fn what_is_wrong_with_a_state_is_told_at_its_part() {
    let state = |parts: &str| two(&format!("state({parts}); rule \"a\" when true => 1;"));
    told(&state("\"rde\""), "E-SCRIPT-VIEW", "there is no view \"rde\"");
    told(&state("\"red\", \"red\""), "E-SCRIPT-SETTING", "the view \"red\" is twice in the state");
    told(&state("laser.left"), "E-SCRIPT-SETTING", "a value in a state is told apart by ranges");
    told(&state("3"), "E-SCRIPT-SETTING", "a part of a state is the name of a view, or bins");
    told(&state(""), "E-SCRIPT-SETTING", "a state has 1 to 8 parts, found 0");
    told(&state("bins(laser.left, [2, 1])"), "E-SCRIPT-SETTING", "the edges of bins must rise");
    told(&state("bins(laser.left, [])"), "E-SCRIPT-SETTING", "the edges of bins are an array of 1 to 15 numbers");
    told(&state("bins(laser.left)"), "E-SCRIPT-TYPE", "a number needs the edges of its ranges");
    told(&state("bins(robot.contact, [1])"), "E-SCRIPT-TYPE", "what is true or false has no ranges");
    told(&state("bins(laser.lft, [1])"), "E-SCRIPT-FACT", "'laser' has no fact 'lft'");
    told(
        &two("bins(laser.left, [1]); state(bins(laser.left, [1])); rule \"a\" when true => 1;"),
        "E-SCRIPT-RULE",
        "bins stands inside state(...)",
    );
}

#[test]
fn a_script_of_named_views_has_none_without_a_name() {
    told(&two("rule \"a\" when camera.seen => 1;"), "E-SCRIPT-VIEW", "this script has no view without a name");
    told(&two("rule \"a\" when red.sen => 1;"), "E-SCRIPT-FACT", "'red' has no fact 'sen'");
    told(
        &two("rule \"a\" when red.cell(2, 0) > 0 => 1;"),
        "E-SCRIPT-FACT",
        "the grid has rows 0 to 1 and columns 0 to 2",
    );
    told(
        &two("rule \"a\" when red.columns(0, 3) > 0 => 1;"),
        "E-SCRIPT-FACT",
        "the grid has rows 0 to 1 and columns 0 to 2",
    );
}
