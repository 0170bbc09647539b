//! Scripts that want to remember are told at load that they cannot, in whatever branch.

use super::parse;

/// The mistakes of a script: code, line, what is marked, and the help.
fn told(text: &str) -> Vec<(&'static str, usize, String, String)> {
    let wrong = parse(text).map(|_| ()).expect_err(text);
    let one = |one: &crate::diagnostic::Diagnostic| {
        let place = one.place.as_ref().unwrap();
        let line = place.source.position(place.span.start).0;
        (one.code, line, place.source.text[place.span.clone()].to_owned(), one.help.clone().unwrap_or_default())
    };
    wrong.all().map(one).collect()
}

fn expect(text: &str, line: usize, marked: &str) {
    let told = told(text);
    let [(code, found, mark, help)] = told.as_slice() else { panic!("one cause, one error: {text}: {told:?}") };
    assert_eq!((*code, *found, mark.as_str()), ("E-SCRIPT-MEMORY", line, marked), "{text}");
    assert!(help.contains("remember nothing between steps") && help.contains("fired("), "{help}");
}

#[test]
fn a_function_that_changes_what_stands_outside_is_told_in_every_branch() {
    let in_branch = |outer: &str, change: &str| {
        format!(
            "{outer}\nfn reward(facts) {{\n if facts.laser.right > 99.0 {{\n {change}\n }}\n -facts.laser.right\n}}"
        )
    };
    expect(&in_branch("let target = 1.0;", "target = 2.0;"), 4, "target");
    expect(&in_branch("const TARGET = 1.0;", "TARGET = 2.0;"), 4, "TARGET");
    expect(&in_branch("let count = 0;", "count += 1;"), 4, "count");
    expect(&in_branch("let memory = #{ x: 1 };", "memory.x = 2;"), 4, "memory");
    expect(&in_branch("let seen = [1, 2];", "seen[0] = facts.laser.right;"), 4, "seen");
    expect(&in_branch("let seen = [];", "seen.push(facts.laser.right);"), 4, "seen");
    expect(&in_branch("", "this.previous = 2;"), 4, "this");
    // In a function that another calls, and told once however often it is changed.
    expect("let n = 0;\nfn more(x) { n += x; n = 3; }\nfn reward(facts) { more(1); n }", 2, "n");
}

#[test]
fn a_function_may_change_its_own_variables_and_arguments() {
    parse("const N = 3; fn more(x) { x += 1; x } fn reward(facts) { let y = N; y += 1; let a = [1]; a.push(y); a[0] = 2; more(y) }")
        .unwrap();
    parse("let near = 1.0; near = 2.0; rule \"a\" when laser.right < near => -1;").unwrap();
}
