//! What is told of mistakes in a condition of success.

use super::errors::expect;

/// The mistake is marked, and the help shows the way out.
fn told(condition: &str, marked: &str, help: &str) {
    let text = format!("rule \"hit\" when robot.contact => -1 then fail; success \"s\" when {condition};");
    expect(&text, "E-SCRIPT-SUCCESS", marked, help);
}

#[test]
fn a_figure_that_is_not_there_is_answered_with_the_nearest() {
    told("test.lap > 1.0", "lap", "'laps'");
    told("test.gap_n(\"prey\") < 1.0", "gap_n", "'gap_m'");
    told("laser.front > 1.0", "laser", "figure of the test");
}

#[test]
fn what_stands_in_the_parentheses_of_a_figure_is_asked_for() {
    told("test.per_1000 < 1.0", "per_1000", "test.per_1000(\"rule\")");
    told("test.per_1000(\"hid\") < 1.0", "\"", "\"hit\"");
    told("test.gap_m < 1.0", "gap_m", "test.gap_m(\"mover\")");
    told("test.gap_error_m(\"prey\") < 1.0", "gap_error_m", "test.gap_error_m(\"mover\", 0.8)");
    told("test.gap_error_m(\"prey\", test.laps) < 1.0", "gap_error_m", "test.gap_error_m(\"mover\", 0.8)");
    told("untrained.laps(3) < 1.0", "laps", "untrained.laps");
}

#[test]
fn a_condition_is_true_or_false_and_reads_the_test() {
    told("test.laps", "test", "test.laps >= 5");
    told("1.0 < 2.0", "1", "figure of the test");
    told("test.laps > true", "true", "compare numbers");
}

#[test]
fn a_condition_that_no_test_can_meet_is_a_mistake() {
    told("test.failures_per_1000 < 0", "test.failures_per_1000 < 0", "turn the comparison");
    told("test.goal_rate > 1", "test.goal_rate > 1", "at once");
    told("test.laps > 5 && test.laps < 3", "test.laps > 5 && test.laps < 3", "||");
    told("-test.distance_m > 0", "-test.distance_m > 0", "turn");
    told("test.per_1000(\"hit\") > 1000", "test.per_1000(\"hit\") > 1000", "turn");
    let can = |condition: &str| {
        let text = format!("rule \"hit\" when robot.contact => -1 then fail; success \"s\" when {condition};");
        super::parse(&text).unwrap();
    };
    can("test.failures_per_1000 <= 0");
    can("test.laps > 5 || test.laps < -5");
    can("test.laps > 5 && untrained.laps < 3");
    can("test.failures_per_1000 < 0 || test.laps > 3");
    can("test.per_1000(\"hit\") > 3 && test.contacts_per_1000 < 2");
}

#[test]
fn two_conditions_that_exclude_one_another_are_a_mistake() {
    let text = "rule \"hit\" when robot.contact => -1 then fail;
                success \"far\" when test.distance_m > 100 && test.laps >= 1; success \"near\" when 50 >= test.distance_m;";
    expect(text, "E-SCRIPT-SUCCESS", "50 >= test.distance_m", "join the two");
    assert!(super::errors::wrong(text).message.contains("\"near\" and success \"far\" can never hold together"));
}
