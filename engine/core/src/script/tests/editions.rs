//! Editions, and scripts that are upgraded.

use super::super::{Behaviour, Upgrade, upgrade};
use super::parse;
use crate::settings::{Edition, LearnerKind};

const RULE: &str = "rule \"a\" when robot.contact => -1 then recover;";

fn edition_of(text: &str) -> u32 {
    parse(text).unwrap().edition().number()
}

#[test]
fn a_script_has_the_edition_that_it_says_and_else_the_newest() {
    assert_eq!(edition_of(RULE), Edition::NEWEST.number());
    assert_eq!(edition_of(&format!("edition(1); {RULE}")), 1);
    let text = crate::diagnostic::SourceText::new("a.rhai", RULE);
    let first = Behaviour::parse_in(Edition::FIRST, "a", text, &|_| Ok(None), &Default::default()).unwrap();
    assert_eq!((first.edition(), first.settings().learner.kind), (Edition::FIRST, LearnerKind::Ttd));
}

#[test]
fn an_unknown_edition_is_answered_with_the_known_ones() {
    for edition in ["edition(3);", "edition(0);", "edition(\"2\");"] {
        let wrong = parse(&format!("{edition} {RULE}")).unwrap_err();
        assert_eq!(wrong.message, "there is no such edition: there are 1 and 2", "{edition}");
        assert_eq!(wrong.help.as_deref(), Some("write edition(2);"));
    }
    let twice = parse(&format!("edition(1); edition(2); {RULE}")).unwrap_err();
    assert_eq!(twice.message, "'edition' is set twice");
}

fn upgraded(text: &str) -> Upgrade {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.rhai");
    std::fs::write(&path, text).unwrap();
    upgrade(&path).unwrap()
}

#[test]
fn an_upgrade_writes_out_what_the_edition_decided_and_touches_nothing_else() {
    let before = "// Mine: it drives.\n// And more.\n\nworld(\"room\");   // a room\nrule \"a\" when robot.contact => -1.5 /* hit */ then recover;\n\
                  rule \"b\" when laser.front < 0.5 =>  1 then recover;\nrule \"c\" when laser.left < 0.5 => 0 then recover;\n\
                  const V = -1; rule \"d\" when laser.right < 0.5 => V then recover;\n";
    let after = before
        .replace("world(\"room\")", "edition(2);\nlearner(#{ kind: \"ttd\" });\nworld(\"room\")")
        .replace("/* hit */ then recover", "/* hit */ then fail")
        .replace("=>  1 then recover", "=>  1 then goal")
        .replace("=> 0 then recover", "=> 0 then restart");
    let upgraded = upgraded(before);
    assert_eq!(upgraded.after, after);
    assert_eq!(upgraded.changes.len(), 5);
}

#[test]
fn an_upgrade_keeps_a_learner_that_is_named_and_the_place_of_an_edition() {
    let text = format!("learner(\"q\");\nedition(1); {RULE}");
    assert_eq!(upgraded(&text).after, text.replace("edition(1);", "edition(2);").replace("recover", "fail"));
}

#[test]
fn a_script_that_was_upgraded_is_not_changed_again() {
    let once = upgraded(RULE).after;
    let again = upgraded(&once);
    assert_eq!((again.after, again.changes), (once, Vec::new()));
}

#[test]
fn what_is_no_script_is_not_upgraded() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("room.toml");
    std::fs::write(&path, "description = \"a room\"").unwrap();
    assert!(upgrade(&path).is_err());
}

#[test]
fn an_outcome_that_the_rules_above_may_turn_is_left_as_it_is() {
    // With the first rule, the second one's step is worth 2 - 1 = 1: a goal.
    let turned = "rule \"way\" when robot.linear > 0.1 => 2;\nrule \"a\" when robot.contact => -1 then recover;\n";
    assert!(upgraded(turned).after.ends_with(turned));
    let read = turned.replace("=> 2", "=> robot.linear");
    assert!(upgraded(&read).after.ends_with(&read));
    let sure = turned.replace("=> 2", "=> -2");
    assert!(upgraded(&sure).after.ends_with(&sure.replace("recover", "fail")));
}

#[test]
fn every_shipped_script_can_be_upgraded() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scripts");
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|ending| ending == "rhai") {
            let after = upgrade(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display())).after;
            assert!(after.contains("edition(2);"), "{}", path.display());
        }
    }
}

#[test]
fn line_ends_and_a_byte_order_mark_stay_as_they_are() {
    let text = format!("\u{feff}world(\"room\");\r\n{RULE}\r\n");
    let after = upgraded(&text).after;
    let begin = "\u{feff}edition(2);\r\nlearner(#{ kind: \"ttd\" });\r\nworld(\"room\");\r\n";
    assert_eq!(after, format!("{begin}{}\r\n", RULE.replace("recover", "fail")));
}
