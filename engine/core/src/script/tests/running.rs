//! What is said when a script fails or is stopped while it runs: plain words, and the line that ran.

use super::{judge, parse};
use crate::diagnostic::Diagnostic;

/// What a script that loads is told in its first step.
fn fails(text: &str) -> Diagnostic {
    *judge(text).judge().expect_err(text)
}

fn line_of(wrong: &Diagnostic) -> usize {
    let place = wrong.place.as_ref().unwrap();
    place.source.position(place.span.start).0
}

/// What is said, and what is advised, in words that say nothing of the interpreter.
fn expect(text: &str, code: &str, message: &str, help: &str) {
    let wrong = fails(text);
    let given = wrong.help.clone().unwrap_or_default();
    assert_eq!((wrong.code, wrong.message.as_str()), (code, message), "{text}");
    assert!(given.contains(help) && !wrong.render(false).contains("help: \n"), "{text}: {given}");
}

#[test]
fn a_calculation_without_a_result_is_told_with_what_to_write() {
    let rule = |condition: &str| format!("fn same(x) {{ x }} rule \"a\" when {condition} => -0.1;");
    expect(
        &rule("same(time.step) % 0 == 0"),
        "E-SCRIPT-RUN",
        "there is no remainder of a division by 0: 0 % 0",
        "divide by max(1, x)",
    );
    expect(&rule("7 / same(time.step) == 0"), "E-SCRIPT-RUN", "a division by 0: 7 / 0", "divide by max(1, x)");
    let text = "fn reward(facts) { let x = 9223372036854775807; x += facts.laser.beams; -0.0001 * x }";
    let message = "a whole number has grown too large: 9223372036854775807 + 181";
    expect(text, "E-SCRIPT-RUN", message, "write one of the numbers as 1.0");
}

#[test]
fn a_value_that_is_not_there_is_told_with_how_to_ask_for_it() {
    let far = |body: &str| format!("fn reward(facts) {{ {body} }}");
    let text = far("let a = [1, 2]; a[facts.laser.nearest_beam + 2]");
    expect(&text, "E-SCRIPT-RUN", "the array has 2 values: there is no number 2", "counted from 0: 0 to 1");
    let text = far("let a = []; a[facts.laser.nearest_beam]");
    expect(&text, "E-SCRIPT-RUN", "the array has 0 values: there is no number 0", "array.len() > 0");
    let text = far("let m = #{ a: 1 }; m.b");
    expect(&text, "E-SCRIPT-RUN", "the map has no key 'b'", "map.contains(\"b\")");
}

#[test]
fn no_help_is_better_than_an_empty_one() {
    let wrong = Diagnostic::new("E-SCRIPT-RUN", "this failed").help("");
    assert_eq!(wrong.help, None);
}

#[test]
fn a_limit_points_at_the_loop_that_ran() {
    let stopped = |text: &str, lines: &[usize]| {
        let wrong = *parse(text).map(|_| ()).expect_err(text);
        assert_eq!(wrong.code, "E-SCRIPT-LIMIT", "{text}");
        assert!(lines.contains(&line_of(&wrong)), "{text}: line {}", line_of(&wrong));
    };
    let rule = "rule \"a\" when robot.contact => -1;";
    let body = "fn reward(facts) {\nlet x = 0.0;\nwhile true {\nx += 1.0;\n}\nx\n}\n";
    stopped(&format!("{body}{rule}"), &[3, 4]);
    stopped("fn reward(facts) {\nloop {\n}\n}", &[2]);
    stopped("fn reward(facts) {\nlet s = \"a\";\nfor i in 0..60 {\ns += s;\n}\n1\n}", &[3, 4]);
    stopped("fn reward(facts) {\nlet a = [1];\nloop {\na.push(1);\n}\n}", &[3, 4]);
    // In a function that is called, wherever it is called from.
    let spin = "fn spin(x) {\nlet y = x;\nwhile true {\ny += 1;\n}\n}\n";
    stopped(&format!("{spin}fn reward(facts) {{\nspin(1)\n}}"), &[3, 4]);
    stopped(&format!("{spin}rule \"a\" when spin(1) => -1;"), &[3, 4]);
    // A loop of another function has no part in it.
    let other = "fn other(x) {\nfor i in 0..2 {}\n}\n";
    stopped(&format!("{spin}{other}fn reward(facts) {{\nother(1);\nspin(1)\n}}"), &[3, 4]);
    stopped(&format!("{spin}let a = spin(1);\n{rule}"), &[3, 4]);
    stopped("fn deep(x) {\ndeep(x)\n}\nfn reward(facts) {\ndeep(1)\n}", &[5]);
}
