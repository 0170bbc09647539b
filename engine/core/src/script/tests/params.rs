//! Parameters: constants that are set from outside.

use super::errors::expect;
use super::parse;
use crate::diagnostic::{Diagnostic, SourceText};
use crate::script::{Behaviour, ParamValues};

const NEAR: &str = "const near = param(0.25, #{ low: 0.15, high: 0.5, unit: \"m\" });\n";
const COUNT: &str = "const count = param(3, #{ low: 1, high: 9 });\n";

fn parse_with(text: &str, values: &[(&str, f64)]) -> Result<Behaviour, Box<Diagnostic>> {
    let values: ParamValues = values.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
    Behaviour::parse_with("test", SourceText::new("test.rhai", text), &|_| Ok(None), &values)
}

/// The reward where the nearest beam is at 0.3 m.
fn reward(behaviour: &Behaviour) -> f64 {
    let mut judge = behaviour.judge(0.5, super::fan(181)).unwrap();
    judge.facts_mut().ranges_m.fill(0.3);
    judge.calibrate().unwrap();
    judge.judge().unwrap().reward
}

#[test]
fn a_parameter_is_a_constant_in_rules_functions_and_set_up() {
    let text = format!(
        "{NEAR}laser(#{{ min_range_m: near / 2 }});
         rule \"close\" when laser.nearest <= near => -1;
         fn reward(facts) {{ if facts.laser.front < near {{ -10 }} else {{ 0 }} }}"
    );
    let own = parse(&text).unwrap();
    assert_eq!((reward(&own), own.settings().laser.min_range_m), (0.0, 0.125));
    let set = parse_with(&text, &[("near", 0.4)]).unwrap();
    assert_eq!((reward(&set), set.settings().laser.min_range_m), (-11.0, 0.2));
    assert_eq!(own.with_values(&set.param_values()).unwrap().param_values(), set.param_values());
}

#[test]
fn a_parameter_says_what_it_is_and_may_be() {
    let behaviour =
        parse_with(&format!("{COUNT}{NEAR}rule \"a\" when laser.nearest < near => count;"), &[("near", 0.3)]);
    let params = behaviour.unwrap().params().to_vec();
    assert_eq!((params[0].name.as_str(), params[0].shown().as_str()), ("count", "3 (1 to 9)"));
    assert_eq!(params[1].shown(), "0.3 m (0.15 to 0.5; the script says 0.25)");
    assert_eq!((params[0].whole, params[1].whole, params[1].span.clone()), (true, false, 52..56));
}

#[test]
fn a_whole_parameter_may_be_a_place_in_an_array() {
    let text = format!("{COUNT}const all = [5, 6, 7, 8, 9];\nrule \"a\" when true => all[count];");
    assert_eq!(reward(&parse(&text).unwrap()), 8.0);
    assert_eq!(reward(&parse_with(&text, &[("count", 1.0)]).unwrap()), 6.0);
    let half = parse_with(&text, &[("count", 1.5)]).unwrap_err();
    assert_eq!(half.message, "'count' must be a whole number from 1 to 9, not 1.5");
}

#[test]
fn a_value_out_of_range_and_an_unknown_name_are_refused() {
    let text = format!("{NEAR}rule \"a\" when laser.nearest < near => 1;");
    let wrong = |name: &str, value: f64| parse_with(&text, &[(name, value)]).unwrap_err();
    assert_eq!(wrong("near", 0.6).message, "'near' must be 0.15 to 0.5 m, not 0.6");
    assert_eq!(wrong("near", f64::NAN).code, "E-SET");
    assert_eq!(wrong("nera", 0.3).help.as_deref(), Some("did you mean 'near'?"));
    assert_eq!(wrong("speed", 0.3).help.as_deref(), Some("there are: near"));
}

#[test]
fn a_parameter_that_is_written_otherwise_is_told_with_its_form() {
    let rule = "rule \"a\" when true => 1;";
    for (written, marked) in [
        ("const near = param(0.25);", "param"),
        ("const near = param(0.25, #{ low: 0.3, high: 0.5 });", "param"),
        ("const near = param(0.25, #{ low: 0.5, high: 0.1 });", "param"),
        ("const near = param(0.25, #{ low: 0.1 });", "param"),
        ("const near = param(0.25, #{ low: 0.1, high: 0.5, units: \"m\" });", "param"),
        ("const near = param(\"a\", #{ low: 0.1, high: 0.5 });", "param"),
        ("let near = param(0.25, #{ low: 0.1, high: 0.5 });", "param"),
        ("param(\"near\", 0.25, #{ low: 0.15, high: 0.5 });", "param"),
        ("const twice = 2 * param(0.25, #{ low: 0.1, high: 0.5 });", "param"),
    ] {
        expect(&format!("{written}\n{rule}"), "E-SCRIPT-SETTING", marked, "write const near = param(0.25, #{ low");
    }
    expect(
        "rule \"a\" when param(1, #{ low: 0, high: 2 }) > 0 => 1;",
        "E-SCRIPT-SETTING",
        "param",
        "top of the script",
    );
}

#[test]
fn a_parameter_collides_with_no_setting_fact_or_function() {
    let rule = "rule \"a\" when true => 1;";
    for name in ["grid", "clamp", "learner"] {
        let text = format!("const {name} = param(1, #{{ low: 0, high: 2 }});\n{rule}");
        expect(&text, "E-SCRIPT-NAME", name, "choose another name");
    }
    let twice = format!("{NEAR}{NEAR}{rule}");
    assert!(parse(&twice).is_err());
}

#[test]
fn a_parameter_that_nothing_reads_is_found_and_one_in_a_text_is_read() {
    let unused = |text: &str| parse(text).unwrap().outline().unused.clone();
    let found = unused(&format!("{NEAR}rule \"a\" when true => 1;"));
    assert_eq!((found[0].what, found[0].name.as_str()), ("parameter", "near"));
    let text = format!("{NEAR}filter(\"where\", `r > ${{near}}`); rule \"a\" when true => 1;");
    assert_eq!(unused(&text), []);
}

#[test]
fn a_script_that_has_a_function_called_param_keeps_it() {
    let behaviour = parse("fn param(x) { x + 1 } const near = param(1);\nrule \"a\" when true => near;").unwrap();
    assert_eq!((reward(&behaviour), behaviour.params().len()), (2.0, 0));
}
