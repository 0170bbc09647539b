//! Names of starts, places and gates.

use super::{START, expect, parse};

const GATE: &str = "[[gate]]\nname = \"first\"\nright_m = [3, -1]\nleft_m = [3, 1]\n";

#[test]
fn a_start_without_a_name_is_called_by_its_number() {
    let text = format!("{START}[[start]]\nname = \"dock\"\nposition_m = [2, 0]\n{START}");
    let names: Vec<_> = parse(&text).unwrap().starts.into_iter().map(|start| start.name).collect();
    assert_eq!(names, ["start 1", "dock", "start 3"]);
}

#[test]
fn names_are_used_once_and_are_no_words_of_recovery() {
    let named = |name: &str| format!("{START}[[start]]\nname = \"{name}\"\nposition_m = [2, 0]\n");
    expect(&named("start 1"), "E-WORLD-NAME", "\"start 1\"", "two starts with the name 'start 1'");
    expect(&named("nearest"), "E-WORLD-NAME", "\"nearest\"", "recovery(\"nearest\") means something else");
    let place = "[[place]]\nname = \"a\"\nposition_m = [0, 0]\nradius_m = 1\n";
    expect(&format!("{START}{place}{place}"), "E-WORLD-NAME", "\"a\"", "two places with the name 'a'");
    expect(&format!("{START}{GATE}{GATE}"), "E-WORLD-NAME", "\"first\"", "two gates with the name 'first'");
}

#[test]
fn a_start_names_its_gate_and_a_gate_is_wide() {
    let at = |gate: &str| format!("{START}gate = \"{gate}\"\n{GATE}{}", GATE.replace("first", "second"));
    assert_eq!(parse(&at("second")).unwrap().starts[0].gate, 1);
    expect(&at("secnod"), "E-WORLD-NAME", "\"secnod\"", "no gate named 'secnod'; did you mean \"second\"?");
    let narrow = GATE.replace("[3, 1]", "[3, -0.95]");
    expect(&format!("{START}{narrow}"), "E-WORLD-VALUE", "[3, -0.95]", "0.1 m apart at least");
}
