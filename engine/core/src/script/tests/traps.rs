//! Mistakes that used to load in silence, and messages that used to point elsewhere.

use super::errors::expect;
use super::judge;
use super::remembered::ahead;

const RULE: &str = "rule \"h\" when robot.contact => -1 then recover;";

#[test]
fn a_misspelt_statement_is_answered_with_the_nearest() {
    expect(&format!("succes \"y\" when test.laps > 3; {RULE}"), "E-SCRIPT-WORD", "succes", "'success'");
    expect("rul \"a\" when robot.contact => -1;", "E-SCRIPT-WORD", "rul", "'rule'");
    expect("rule \"a\" when robot.contact => -1 the recover;", "E-SCRIPT-WORD", "the", "'then'");
    expect("rule \"a\" when robot.contact => -1 recover;", "E-SCRIPT-WORD", "recover", "then recover");
    expect(&format!("success when test.laps > 9; {RULE}"), "E-SCRIPT-WORD", "when", "success \"name\" when");
}

#[test]
fn one_equals_sign_does_not_compare() {
    expect(&format!("success \"x\" when test.laps = 5; {RULE}"), "E-SCRIPT-SYNTAX", "=", "==");
    expect("rule \"x\" when laser.nearest = 0.3 => -1;", "E-SCRIPT-RULE", "=", "==");
}

#[test]
fn whole_numbers_are_not_divided_by_whole_numbers() {
    expect("rule \"a\" when time.step / 100 > 3 => -1;", "E-SCRIPT-TYPE", "/", "time.step / 100.0");
    expect("rule \"a\" when laser.beams / 2 > 90 => -1;", "E-SCRIPT-TYPE", "/", "laser.beams / 2.0");
    expect("fn reward(facts) { -facts.action.index / 14 }", "E-SCRIPT-TYPE", "/", "/ 14.0");
}

#[test]
fn a_truth_value_is_known_through_measures_and_the_step_before() {
    for condition in ["previous.robot.contact > 0", "c > 0.5"] {
        let marked = &condition[condition.find('>').unwrap()..];
        let text = format!("measure c = robot.contact; rule \"a\" when {condition} => -1;");
        expect(&text, "E-SCRIPT-TYPE", marked, "");
    }
}

#[test]
fn a_function_of_numbers_takes_no_truth_value() {
    expect("rule \"x\" when abs(robot.contact) > 0 => -1;", "E-SCRIPT-TYPE", "robot.contact", "if robot.contact");
}

#[test]
fn a_rule_changes_nothing_outside_of_itself() {
    expect("let n = 0; rule \"a\" when { n = n + 1; n > 3 } => -1;", "E-SCRIPT-MEMORY", "n", "fired(");
}

#[test]
fn bearings_grow() {
    expect("rule \"a\" when laser.between(10, -10) < 1.0 => -1;", "E-SCRIPT-FACT", "between", "between(-10, 10)");
}

#[test]
fn a_measure_that_reads_itself_is_told_once() {
    expect("measure m = m + 1; rule \"a\" when m > 1 => -1;", "E-SCRIPT-NAME", "m", "something else");
    let wrong = super::parse("measure m = m + 1; rule \"a\" when m > 1 => -1;").map(|_| ()).unwrap_err();
    assert!(wrong.others.is_empty(), "{:?}", wrong.others);
}

#[test]
fn every_wrong_figure_of_a_success_is_told() {
    let text = format!("success \"x\" when test.lops > 5 && test.contcts > 3; {RULE}");
    let wrong = super::parse(&text).map(|_| ()).unwrap_err();
    assert_eq!(wrong.all().count(), 2, "{wrong:?}");
}

#[test]
fn a_measure_may_choose() {
    let mut judge = judge(
        "measure near = if laser.front < 1.0 { 2.0 } else { laser.front };
         measure open = if laser.front < 1.0 { false } else { laser.front > 3.0 };
         rule \"a\" when true => near; rule \"b\" when open => 10;",
    );
    assert_eq!(ahead(&mut judge, &[0.5, 1.5, 4.0]), [2.0, 1.5, 14.0]);
}
