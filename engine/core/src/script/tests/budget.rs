//! What a step may cost: counted by the length of what is touched, one budget for all rules.

use super::{judge, parse};
use crate::diagnostic::Diagnostic;

const RULE: &str = "rule \"a\" when robot.contact => -1;\n";
const TABLE: &str = "let a = [];\nfor i in range(0, 1000, 1) { a.push(i * 1.0); }\nlet b = a;\n";
const NESTED: &str = "let m = #{};\nm.x = [];\nm.y = [];\nm.z = [];\nfor i in range(0, 300, 1) { m.x.push(i); m.y.push(i); m.z.push(i); }\nlet n = m;\n";

/// A function of which the body runs for ever, after these statements of the top level.
fn endless(top: &str, body: &str) -> String {
    format!("{top}fn reward(facts) {{\nlet k = 0;\nwhile true {{\n{body}\n}}\n0.0\n}}\n{RULE}")
}

fn refused(text: &str) -> Diagnostic {
    *parse(text).map(|_| ()).expect_err(text)
}

/// Loops of which each turn was a handful of operations, whatever it copied or compared.
fn dear() -> Vec<String> {
    let same = |what: &str| format!("if {} {{ k += 1; }}", [what; 12].join(" && "));
    vec![
        endless(TABLE, "let c = a; c.push(1.0); k += 1;"),
        endless(TABLE, &same("a == b")),
        endless(TABLE, &same("!(a != b)")),
        endless(TABLE, &same("!(-1.0 in a)")),
        endless(TABLE, &same("!a.contains(-1)")),
        endless(TABLE, "let c = a + b;"),
        endless(TABLE, "let c = []; c += a; c += [1];"),
        endless(TABLE, "for x in a { break; }"),
        endless(TABLE, &same("a[500] == 500.0")),
        endless(TABLE, "let c = [a, 1]; let d = [c];"),
        endless(TABLE, "facts.laser.sector(0, 180).excess(a.len() > 0 && a == b);"),
        endless("let a = [];\nfor i in range(0, 1400, 1) { a.push([]); }\n", "let c = a; c.push(1.0);"),
        endless(NESTED, &same("m == n")),
        endless(NESTED, "let c = m; c.x[0] = 7;"),
        endless(NESTED, "k += m.x.len();"),
        endless("let text = \"\";\nfor i in 0..12 { text += text + \"aaa\"; }\n", "let c = text + k; k += 1;"),
        endless("", "let s = facts.laser.sector(0, 180); if s.nearest < s.mean { k += 1; }"),
        format!("{TABLE}fn calibrate(facts) {{ a }}\n{}", endless("", "let c = facts.calibrated; k += c.len();")),
    ]
}

#[test]
fn a_loop_that_copies_or_compares_is_stopped_by_what_it_touches() {
    for text in dear() {
        let wrong = refused(&text);
        assert!(matches!(wrong.code, "E-SCRIPT-LIMIT" | "E-SCRIPT-NAME"), "{text}: {wrong:?}");
    }
}

#[test]
fn all_rules_of_a_step_share_one_budget() {
    let spin = "fn spin(turns) {\nlet n = 0;\nfor i in 0..turns { n += 1; }\nn > 0\n}\n";
    // Each alone is far below the limit; no step has room for all of them.
    let rules: String = (0..50).map(|rule| format!("rule \"r{rule}\" when spin(2000) => -0.01;\n")).collect();
    let text = format!("{spin}{rules}");
    let wrong = *judge(&text).judge().expect_err("too dear");
    assert_eq!(wrong.code, "E-SCRIPT-LIMIT");
    assert!(wrong.message.contains("100000 operations"), "{}", wrong.message);
    // The next step has as much as the first.
    let few = format!("{spin}rule \"a\" when spin(5000) => -0.01;\n");
    let mut judge = judge(&few);
    assert!((0..20).all(|_| judge.judge().is_ok()));
}

#[test]
fn a_table_as_long_as_an_array_may_be_can_be_made_and_read() {
    let text = "let a = [];\nfor i in range(0, 2048, 1) { a.push(i); }\nfn reward(facts) { let s = 0; for i in range(0, 500, 1) { s += a[i]; } s * 0.000001 }\n";
    // The numbers from 0 to 499, in millionths.
    let reward = judge(text).judge().unwrap().reward;
    assert!((reward - 0.12475).abs() < 1e-12, "{reward}");
}

#[test]
fn equality_is_what_the_language_says_it_is() {
    let holds = |expression: &str| {
        let text = format!("fn one(x) {{ x }}\nrule \"a\" when one({expression}) => 1;\n");
        judge(&text).judge().unwrap().reward == 1.0
    };
    assert!(holds("[1, 2] == [1, 2]") && holds("[1, 2.0] == [1.0, 2]") && holds("[] == []"));
    assert!(holds("[1, 2] != [1, 3]") && holds("[1] != [1, 1]") && holds("[1, \"a\"] != [1, 2]"));
    assert!(
        holds("#{ a: [1] } == #{ a: [1] }") && holds("#{ a: 1 } != #{ b: 1 }") && holds("#{ a: 1 } != #{ a: \"1\" }")
    );
    assert!(holds("2 in [1, 2]") && holds("[1, [2]].contains([2])") && holds("!([1, 2].contains(\"2\"))"));
    assert!(holds("[true, \"x\"] == [true, \"x\"]"));
    // Numbers that differ by rounding only are equal, in arrays too.
    assert!(holds("0.1 + 0.2 == 0.3") && holds("[0.1 + 0.2] == [0.3]") && holds("0.3 in [0.1 + 0.2]"));
}
