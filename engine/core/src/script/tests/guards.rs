//! What an action must never do.

use super::errors::expect;
use super::parse;
use crate::geometry::Twist;
use crate::judge::{Judge, Leave};

const RULE: &str = "rule \"a\" when true => 1;";
const SET_UP: &str = "actions([[0.4, 0.0], [0.2, 0.8], [0.0, -0.8], [0.0, 0.4]]);";
const ACTIONS: [Twist; 4] = [Twist::new(0.4, 0.0), Twist::new(0.2, 0.8), Twist::new(0.0, -0.8), Twist::new(0.0, 0.4)];

/// A judge of a script with a rule, over 181 beams at 2 m.
fn judge(guards: &str) -> Judge {
    let behaviour = parse(&format!("{SET_UP}\n{guards}\n{RULE}")).unwrap_or_else(|wrong| panic!("{wrong:?}"));
    let mut judge = behaviour.judge(0.5, super::fan(181)).unwrap().with_actions(&ACTIONS, ACTIONS.len());
    judge.facts_mut().ranges_m.fill(2.0);
    judge.calibrate().unwrap();
    judge
}

/// What is left of the four actions where every beam has this range.
fn left(judge: &mut Judge, range_m: f32) -> (Vec<usize>, Leave) {
    judge.facts_mut().ranges_m.fill(range_m);
    judge.judge().unwrap();
    let leave = judge.leave();
    ((0..4).filter(|action| leave.allowed.contains(*action)).collect(), leave)
}

#[test]
fn while_the_left_side_holds_actions_of_the_right_side_are_not_taken() {
    let mut judge = judge("forbid \"ahead\" when laser.front < 0.4 => action.linear > 0.0;");
    assert_eq!(left(&mut judge, 2.0), (vec![0, 1, 2, 3], Leave::default()));
    let (actions, leave) = left(&mut judge, 0.3);
    assert_eq!((actions, leave.guards), (vec![2, 3], 1));
}

#[test]
fn if_guards_leave_nothing_the_slowest_action_is_taken() {
    let mut judge = judge(
        "forbid \"ahead\" when laser.front < 0.4 => action.linear > 0.0;
         forbid \"turns\" when laser.nearest < 0.35 => action.angular != 0.0;",
    );
    // Both stand still; the fourth turns less.
    assert_eq!(left(&mut judge, 0.3).0, [3]);
    assert_eq!(left(&mut judge, 0.38).0, [2, 3]);
    assert_eq!(
        (judge.guarding().instead_of(0, judge.leave().allowed), judge.guarding().instead_of(2, judge.leave().allowed)),
        (3, 2)
    );
}

#[test]
fn a_guard_may_read_measures_windows_and_parameters() {
    let mut judge = judge(
        "const limit = param(0.4, #{ low: 0.1, high: 1.0 });
         measure gap = laser.front;
         forbid \"closing\" when gap < limit && change(gap) < 0.0 => action.linear >= limit;",
    );
    assert_eq!(left(&mut judge, 2.0).0, [0, 1, 2, 3]);
    assert_eq!(left(&mut judge, 0.3).0, [1, 2, 3]);
    assert_eq!(left(&mut judge, 0.3).0, [0, 1, 2, 3]);
}

#[test]
fn the_right_side_is_said_of_the_action_alone() {
    let guard = |forbids: &str| format!("forbid \"ahead\" when laser.front < 0.4 => {forbids};\n{RULE}");
    let help = "compare action.linear or action.angular";
    expect(&guard("action.linear > laser.front"), "E-SCRIPT-GUARD", "laser", help);
    expect(&guard("fired(\"a\") > 0 && action.linear > 0"), "E-SCRIPT-GUARD", "fired", help);
    expect(&guard("action.linear"), "E-SCRIPT-GUARD", "action.linear", help);
    expect(&guard("action.speed > 0"), "E-SCRIPT-FACT", "speed", "");
    expect(&guard("action.linear > -1.0"), "E-SCRIPT-GUARD", "action.linear > -1.0", "leave one");
    expect(&guard("action.linear > 1.5"), "E-SCRIPT-GUARD", "action.linear > 1.5", "an action of this script");
}

#[test]
fn a_guard_that_is_written_otherwise_is_told_how() {
    let wrong =
        |guard: &str, code: &str, marked: &str, help: &str| expect(&format!("{guard}\n{RULE}"), code, marked, help);
    wrong("forbid \"x\" laser.front < 1 => action.linear > 0.1;", "E-SCRIPT-RULE", "laser", "");
    wrong("forbid \"x\" when => action.linear > 0.1;", "E-SCRIPT-RULE", "=", "");
    wrong("forbid \"x\" when laser.front < 1;", "E-SCRIPT-RULE", ";", "");
    wrong("forbid \"x\" when laser.front < 1 =>;", "E-SCRIPT-RULE", ";", "");
    wrong("forbid \"x\" when laser.front < 1 for 2 steps => action.linear > 0.1;", "E-SCRIPT-RULE", "for", "");
    wrong("forbid \"x\" when laser.front < 1 => action.linear > 0.1 then fail;", "E-SCRIPT-RULE", "then", "");
    wrong("forbid \"x\" when laser.front => action.linear > 0.1;", "E-SCRIPT-GUARD", "laser.front", "compare it");
    wrong("forbid \"\" when laser.front < 1 => action.linear > 0.1;", "E-SCRIPT-GUARD", "\"", "name what");
    let one = "forbid \"x\" when laser.front < 1 => action.linear > 0.1;";
    wrong(&format!("{one}\n{one}"), "E-SCRIPT-GUARD", "\"", "the first is in line 1");
    wrong(
        "fn near(d) { d < 1.0 } forbid \"x\" when near(laser.front) => action.linear > 0.1;",
        "E-SCRIPT-GUARD",
        "near",
        "write the condition out",
    );
    let inside = format!("if true {{ {one} }}");
    expect(
        &format!("{inside}\n{RULE}\n{}", one.replace("\"x\"", "\"y\"")),
        "E-SCRIPT-RULE",
        "forbid",
        "move it to the top",
    );
}

#[test]
fn a_script_without_guards_keeps_the_word() {
    assert!(parse("let forbid = 2; rule \"a\" when laser.front < forbid => 1;").is_ok());
    assert_eq!(parse(RULE).unwrap().guards().count(), 0);
}
