//! Truth values and numbers are not the same thing.

use super::parse;

/// Message, marked text and help of the one mistake.
fn wrong(text: &str) -> (String, String, String) {
    let wrong = *parse(text).map(|_| ()).expect_err(text);
    assert!(wrong.others.is_empty() && wrong.code == "E-SCRIPT-TYPE", "{text}: {wrong:?}");
    let place = wrong.place.unwrap();
    (wrong.message, place.source.text[place.span].to_owned(), wrong.help.unwrap())
}

fn expect(condition: &str, marked: &str, help: &str) {
    for text in [
        format!("rule \"a\" when {condition} => -1 then recover;"),
        format!("fn reward(facts) {{ if {} {{ 1.0 }} else {{ 0.0 }} }}", in_function(condition)),
        format!(
            "fn own(all) {{ 1.0 }} fn reward(x) {{ if {} {{ own(x) }} else {{ 0.0 }} }}",
            in_function(condition).replace("facts.", "x.")
        ),
    ] {
        let (_, found, given) = wrong(&text);
        let plain = |text: &str| text.replace("facts.", "").replace("x.", "");
        assert_eq!((plain(&found).as_str(), plain(&given).as_str()), (marked, help), "{text}");
    }
}

fn in_function(condition: &str) -> String {
    let mut text = condition.to_owned();
    for group in ["laser.", "robot.", "camera.", "action."] {
        text = text.replace(group, &format!("facts.{group}"));
    }
    text
}

#[test]
fn a_truth_value_compared_with_a_number_is_told_with_what_to_write() {
    expect("robot.contact == 1", "== 1", "write robot.contact");
    expect("robot.contact == 1.0", "== 1.0", "write robot.contact");
    expect("robot.contact >= 1", ">= 1", "write robot.contact");
    expect("robot.contact > 0", "> 0", "write robot.contact");
    expect("robot.contact != 0", "!= 0", "write robot.contact, or !robot.contact");
    expect("camera.seen == 0", "== 0", "write !camera.seen");
    expect("1 == robot.fallen", "1 == robot.fallen", "write robot.fallen");
    expect("laser.front < 1.0 && robot.contact == 1", "== 1", "write robot.contact");
    expect("(laser.front < 1.0) == 1", "== 1", "write laser.front < 1.0");
}

#[test]
fn a_chain_of_comparisons_is_told_as_two() {
    expect("0.3 < laser.front < 0.6", "< 0.6", "write 0.3 < laser.front && laser.front < 0.6");
    expect(
        "1.0 >= laser.sector(10, 20).nearest >= 0.2",
        ">= 0.2",
        "write 1.0 >= laser.sector(10, 20).nearest && laser.sector(10, 20).nearest >= 0.2",
    );
    let (message, ..) = wrong("rule \"a\" when 0.3 < laser.front < 0.6 => 1;");
    assert_eq!(message, "this compares the truth value of `0.3 < laser.front` with 0.6");
}

#[test]
fn numbers_are_no_truth_values_and_truth_values_no_numbers() {
    expect("!laser.front", "laser.front", "compare it: laser.front < 0.5");
    expect("laser.front && robot.contact", "laser.front", "compare it: laser.front < 0.5");
    expect("laser.front + camera.seen > 1.0", "camera.seen", "write if camera.seen { 1.0 } else { 0.0 } in a function");
    let (message, ..) = wrong("rule \"a\" when laser.front < 1.0 => -robot.contact;");
    assert_eq!(message, "a truth value is no number");
}

#[test]
fn what_is_right_or_cannot_be_known_is_let_through() {
    for condition in [
        "robot.contact == true",
        "robot.contact == camera.seen",
        "(laser.front < 1.0) == (laser.left < 1.0)",
        "!robot.contact && laser.front < 1.0",
        "abs(laser.left - laser.right) < 0.2",
        "laser < 0.5",
    ] {
        parse(&format!("rule \"a\" when {condition} => 1;")).unwrap();
    }
    parse("fn near(x) { x < 1.0 } rule \"a\" when near(laser.front) == true => 1;").unwrap();
    parse("fn reward(facts) { let hit = facts.robot.contact; let n = if hit { 1 } else { 0 }; if n == 1 { -1 } else { 0 } }").unwrap();
}

#[test]
fn a_constant_that_is_true_or_false_is_no_number_in_a_rule_and_at_the_top_level() {
    let rule = "when laser.front < 1.0 => -1 then fail;";
    for text in [
        "const HIT = true; rule \"a\" when HIT > 0 && laser.front < 1.0 => -1 then fail;".to_owned(),
        format!("const HIT = true; const BAD = HIT > 0; rule \"a\" {rule}"),
        format!("const HIT = true; camera(#{{ own_body: HIT > 0 }}); rule \"a\" {rule}"),
    ] {
        assert_eq!(wrong(&text).1, "> 0", "{text}");
    }
}

#[test]
fn constants_that_come_to_no_number_are_told_where_they_are_written() {
    for (text, marked) in [
        ("const V = 0.0 / 0.0; rule \"a\" when laser.front < 1.0 => V then fail;", "0.0 / 0.0"),
        ("const V = -1.0; rule \"a\" when laser.front < sqrt(V) => -1 then fail;", "sqrt(V)"),
        ("rule \"a\" when laser.front < 1.0 => 1.0 + ln(-2.0) then fail;", "1.0 + ln(-2.0)"),
        ("rule \"a\" when laser.front < 1.0 => sqrt(-1.0) + laser.left then fail;", "sqrt(-1.0)"),
        ("const V = 2.0; fn reward(facts) { facts.laser.front * asin(V) }", "asin(V)"),
    ] {
        let (message, found, _) = wrong(text);
        assert_eq!((message.as_str(), found.as_str()), ("this gives no number", marked), "{text}");
    }
}

#[test]
fn whole_constants_whose_division_drops_a_fraction_are_told() {
    let rule = "rule \"a\" when laser.front < 1.0 => -1 then fail;";
    for (text, help) in [
        ("let a = 1; let b = 2; rule \"a\" when laser.front < a/b => -1 then fail;".to_owned(), "write 1.0 * a / b"),
        ("const A = 7; fn reward(facts) { A / 2 * facts.laser.front }".to_owned(), "write A / 2.0"),
        (format!("let a = 1; let b = 2; let c = a / b; {rule}"), "write 1.0 * a / b"),
        (format!("const A = 7; camera(#{{ tilt_deg: A / 2 }}); {rule}"), "write A / 2.0"),
        (format!("const A = 7; success \"s\" when test.laps > A / 2; {rule}"), "write A / 2.0"),
    ] {
        let (message, found, given) = wrong(&text);
        assert_eq!(message, "a division of whole numbers drops the fraction", "{text}");
        assert_eq!((found.as_str(), given.as_str()), ("/", help), "{text}");
    }
    // No fraction, a variable that changes, a function's own variable.
    for text in [
        "const A = 8; rule \"a\" when laser.front < A / 2 - 3.5 => -1 then fail;",
        "let a = 8; let c = a / 2; a = 7; rule \"a\" when laser.front < 1.0 => -1.0 * c then fail;",
        "const A = 7; fn reward(facts) { let A = 8; A / 2 * facts.laser.front }",
    ] {
        parse(text).unwrap();
    }
}
