use std::path::Path;
use std::sync::atomic::AtomicBool;

use engine::diagnostic::Kind;
use engine::experiment::{Overrides, learn};
use engine::filter::Sources;
use pack::Pack;

use super::forge::{HEAD, pack_of, small_files};

/// Statements that use up time or memory, in some frame each.
const GREEDY: &[&str] = &[
    "loop {}",
    "while true {}",
    "let x = 0; loop { x += 1; }",
    "for i in 0..1000000000 { let y = i; }",
    "let a = []; loop { a.push(1); }",
    "let a = [0]; loop { a += a; }",
    "let s = \"x\"; loop { s += s; }",
    "let m = #{}; let i = 0; loop { m[`k${i}`] = i; i += 1; }",
    "let a = []; loop { a = [a, a]; }",
    "let a = []; a.pad(100000000, 0);",
    "let a = []; a.pad(1000, 0); loop { if a == a {} }",
    "let s = \"\"; s.pad(100000000, 'x');",
    "let a = []; for i in 0..1000 { a.push(i); } loop { a.sort(); }",
    "let x = 1; loop { x = x * 3; }",
    "let x = 1.0; loop { x = x * 1.1; }",
    "let b = blob(2000000000);",
    "let s = \"abc\"; loop { s = s.to_upper() + s; }",
    "let a = [1,2,3]; loop { a.insert(0, a.len()); }",
    "let f = Fn(\"g\"); loop { f = f.curry(f); }",
    "let a = [[1]]; loop { a.push(a); }",
];

/// Reaches for what no script has.
const CURIOUS: &[&str] = &[
    "sleep(3)",
    "sleep(3.0)",
    "eval(\"1\")",
    "open_file(\"/etc/passwd\")",
    "env(\"HOME\")",
    "timestamp()",
    "print(\"x\")",
    "debug(\"x\")",
    "exit(0)",
    "system(\"ls\")",
    "rand()",
    "now()",
    "read(\"/etc/passwd\")",
    "http_get(\"http://x\")",
    "type_of(1)",
    "is_def_fn(\"reward\", 1)",
    "Fn(\"reward\")",
    "call(\"reward\")",
    "spawn(\"x\")",
    "unwrap(1)",
];

/// Whole scripts that are wrong in themselves.
fn broken() -> Vec<String> {
    let rule = "rule \"x\" when robot.contact => -1;\n";
    vec![
        String::new(),
        "/* never closed\n".to_owned() + rule,
        "import \"/etc/passwd\" as p;\n".to_owned() + rule,
        "import \"../x\" as p;\n".to_owned() + rule,
        "import \"short\" as p;\n".to_owned() + rule,
        "export let x = 1;\n".to_owned() + rule,
        "(".repeat(20_000),
        format!("1{}", "+1".repeat(200_000)),
        "||{".repeat(1000),
        format!("let x = 0; if x == 1 {{}} {}", "else if x == 2 {} ".repeat(50_000)),
        "\u{202e}".to_owned() + rule,
        "let s = \"\0\";\n".to_owned() + rule,
        format!("let s = \"{}\";\n{rule}", "x".repeat(1 << 21)),
        "let x = 99999999999999999999999999;\n".to_owned() + "rule \"x\" when y > x => -1;",
        "rule \"x\" when sped > 1 => -1;".to_owned(),
        "rule \"x\" when laser[200] < 1 => -1;".to_owned(),
        "rule \"x\" when robot.contact => 1e400;".to_owned(),
        "fn reward() { 1.0 }".to_owned(),
        "fn reward(facts, more) { 1.0 }".to_owned(),
        "fn f(x) { f(x) } fn reward(facts) { f(1) }".to_owned(),
        "world(\"../../etc/passwd\");\n".to_owned() + rule,
        "world(\"/etc/passwd\");\n".to_owned() + rule,
        "world(\"/etc/hosts.toml\");\n".to_owned() + rule,
        "world(\"nowhere\");\n".to_owned() + rule,
        "policy(\"a\", \"/etc/passwd\"); policy(\"b\", \"../../../etc/passwd\");\nworld(\"small\");\n".to_owned()
            + rule,
        "filter(\"/tmp/evil.so\");\nworld(\"small\");\n".to_owned() + rule,
        "rule".to_owned(),
        "let rule = 1;".to_owned(),
        "const X = loop {};".to_owned(),
        "switch 1 { 1 => loop {} }".to_owned(),
    ]
}

fn hostile() -> Vec<String> {
    let setup = "world(\"small\");\nrun(#{ steps: 400, test_steps: 100 });\n";
    let rule = "rule \"x\" when robot.contact => -1;\n";
    let mut scripts = broken();
    for greedy in GREEDY {
        scripts.push(format!("{setup}{rule}{greedy}"));
        scripts.push(format!("{setup}fn reward(facts) {{ {greedy} 0.0 }}"));
        scripts.push(format!("{setup}{rule}fn calibrate(facts) {{ {greedy} #{{}} }}"));
    }
    for curious in CURIOUS {
        scripts.push(format!("{setup}{rule}let x = {curious};"));
        scripts.push(format!("{setup}fn reward(facts) {{ {curious}; 0.0 }}"));
    }
    for value in ["0.0/0.0", "1.0/0.0", "()", "\"text\"", "[1]", "1e308*10.0", "#{}", "'x'"] {
        scripts.push(format!("{setup}fn reward(facts) {{ {value} }}"));
    }
    scripts
}

/// What became of a stranger's script: nothing but its error, or that it did harmless work.
fn outcome(script: &str) -> Option<engine::diagnostic::Diagnostic> {
    let files = small_files();
    let pack = Pack::parse(Path::new("x.pack"), pack_of(HEAD, &[files[0], (files[1].0, script.as_bytes()), files[2]]))
        .unwrap();
    let run = pack.plan(&[], &Overrides::default(), Sources::default()).and_then(|runnable| {
        learn(&runnable.plan, 1, &AtomicBool::new(false), &|_| ()).map(drop).map_err(|broken| broken.error)
    });
    run.err().map(|error| *error)
}

#[test]
fn every_hostile_script_ends_in_a_clear_error() {
    let scripts = hostile();
    assert!(scripts.len() >= 130, "{}", scripts.len());
    for script in scripts {
        let start: String = script.chars().take(300).collect();
        let Some(error) = outcome(&script) else { panic!("it ran: {start}") };
        assert!(matches!(error.kind(), Kind::Input | Kind::Limit), "{start}: {}", error.render(false));
        let shown = error.render(false);
        assert!(!shown.contains("root:") && !shown.contains("localhost"), "{start}: {shown}");
        assert!(!shown.chars().any(|c| c.is_control() && c != '\n'), "{start}: {}", shown.escape_debug());
    }
}

#[test]
fn a_harmless_script_in_the_same_pack_runs() {
    let script = "world(\"small\");\nrun(#{ steps: 400, test_steps: 100 });\nrule \"x\" when robot.contact => -1 then recover;\n";
    assert!(outcome(script).is_none());
}
