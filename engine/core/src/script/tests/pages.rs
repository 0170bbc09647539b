//! The pages and the scripts that come with the engine.

use super::super::setup_table::SETUP;
use super::super::{Behaviour, definitions, reference, reference_json};
use super::fan;
use crate::judge::fact_table::FACTS;
use crate::judge::functions::FUNCTIONS;
use crate::judge::{Judgement, ViewFacts};
use crate::outcome::Then;
use std::path::{Path, PathBuf};

fn scripts() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scripts")
}

#[test]
fn the_page_about_scripts_is_the_generated_one() {
    let path = scripts().join("README.md");
    if std::env::var_os("UPDATE_PAGES").is_some() {
        std::fs::write(&path, reference()).unwrap();
    }
    assert!(std::fs::read_to_string(&path).unwrap() == reference(), "run the tests with UPDATE_PAGES=1");
}

#[test]
fn the_definitions_for_editors_are_the_generated_ones() {
    let path = scripts().join("../docs/editor/engine.d.rhai");
    if std::env::var_os("UPDATE_PAGES").is_some() {
        std::fs::write(&path, definitions()).unwrap();
    }
    assert!(std::fs::read_to_string(&path).unwrap() == definitions(), "run the tests with UPDATE_PAGES=1");
}

#[test]
fn the_language_as_data_holds_what_the_page_holds() {
    let (data, page) = (reference_json(), reference());
    let texts = |list: &str, key: &str| -> Vec<String> {
        let rows = data[list].as_array().unwrap().iter();
        rows.filter_map(|row| row[key].as_str().map(str::to_owned)).collect()
    };
    // What each row is about stands in a table of the page, and each row of its tables is about one of these.
    let lists = ["setup_calls", "settings", "facts", "functions", "windows", "test_figures"];
    let known: Vec<String> = lists.iter().flat_map(|list| texts(list, "about")).collect();
    for about in &known {
        assert!(page.contains(&format!("| {about} |")), "{about}");
    }
    let tables = page.split("\n## Limits").next().unwrap();
    let heads = ["what it sets", "what it is", "what it does", "what it changes"];
    let mut rows = 0;
    for row in tables.lines().filter(|line| line.starts_with("| `")) {
        let last = row.trim_end_matches(" |").rsplit(" | ").next().unwrap();
        assert!(known.iter().any(|about| about == last) || heads.contains(&last), "{row}");
        rows += 1;
    }
    assert!(rows >= 150, "{rows} rows");
    let row = |list: &str, key: &str, name: &str| {
        data[list].as_array().unwrap().iter().find(|row| row[key] == name).unwrap().clone()
    };
    let tilt = row("settings", "key", "tilt_deg");
    assert_eq!((&tilt["least"], &tilt["greatest"], &tilt["default"]), (&(-30.0).into(), &90.0.into(), &42.0.into()));
    let bearing = row("facts", "key", "bearing_deg");
    assert_eq!((&bearing["unseen"], &bearing["cost"]), (&180.0.into(), &"mask".into()));
    let by_edition = [0, 1].map(|edition| data["editions"][edition]["defaults"]["learner.kind"].clone());
    assert_eq!(by_edition, ["ttd", "memory"]);
    assert!(texts("statements", "word").iter().any(|word| word == "use"));
    assert!(texts("codes", "code").iter().any(|code| code == "E-SCRIPT-USE"));
}

#[test]
fn every_statement_in_the_data_can_be_written() {
    let words: Vec<&str> = super::super::reference_json::STATEMENTS.iter().map(|(word, ..)| *word).collect();
    assert_eq!(words, ["rule", "success", "measure", "forbid", "use", "bins"]);
}

#[test]
fn the_page_has_the_actions_of_a_script_that_names_none() {
    let page = reference();
    let own = crate::settings::Settings::default().actions;
    let written =
        |action: &crate::geometry::Twist| format!("`[{}, {}]`", action.linear_m_per_s, action.angular_rad_per_s);
    assert!(own.len() == 14 && own.iter().all(|action| page.contains(&written(action))));
}

#[test]
fn every_script_loads() {
    for name in ["wall", "corridor", "platform", "object", "avoid", "follow-and-avoid"] {
        let behaviour =
            Behaviour::load(&scripts().join(format!("{name}.rhai"))).unwrap_or_else(|wrong| panic!("{wrong:?}"));
        assert_eq!(behaviour.name(), name);
    }
}

#[test]
fn every_example_on_the_page_loads() {
    let page = reference();
    let examples: Vec<_> = page.split("```rhai\n").skip(1).filter_map(|part| part.split("```").next()).collect();
    assert!(examples.len() > 3);
    for example in examples {
        super::parse(example).unwrap_or_else(|wrong| panic!("{wrong:?}"));
    }
}

#[test]
fn every_form_in_the_lists_works() {
    for row in FUNCTIONS {
        let form =
            row.form.replace("array.", "[1, 2].").replace("value", "1").replace("range(from, to, step)", "len([1])");
        let words = ["radians)", "degrees)", "angle", "low", "high", "x", "y", "a", "b"];
        let (name, arguments) = form.split_once('(').unwrap();
        let with = words.iter().fold(format!("({arguments}"), |text, word| match *word {
            "radians)" | "degrees)" => text.replace(word, "0.5)"),
            word => text.replace(&format!("({word}"), "(0.5").replace(&format!(", {word}"), ", 0.5"),
        });
        let script = format!("fn reward(facts) {{ let got = {name}{with}; 1 }}");
        super::parse(&script).unwrap_or_else(|wrong| panic!("{script}: {wrong:?}"));
    }
    for row in SETUP {
        // What a form names must be there.
        let before = if row.name == "state" { "view(\"red\", filter(\"colour\")); " } else { "" };
        let script = format!("{before}{} rule \"a\" when true => 1;", row.form);
        super::parse(&script).unwrap_or_else(|wrong| panic!("{wrong:?}"));
    }
    let values = || FACTS.iter().filter(|fact| fact.form().is_none());
    for fact in values().filter(|fact| fact.group != "sector") {
        let script = format!("fn reward(facts) {{ let got = facts.{}; 1 }}", fact.name());
        super::parse(&script).unwrap_or_else(|wrong| panic!("{script}: {wrong:?}"));
    }
}

#[test]
fn the_definitions_name_every_fact() {
    let text = definitions();
    assert!(
        FACTS
            .iter()
            .filter(|fact| fact.form().is_none())
            .all(|fact| text.contains(&format!("fn get {}({}: ", fact.key, fact.group)))
    );
}

#[test]
fn the_platform_script_sees_an_edge_beside_the_front_beam() {
    let behaviour = Behaviour::load(&scripts().join("platform.rhai")).unwrap();
    let mut judge = behaviour.judge(0.33, fan(181)).unwrap();
    judge.facts_mut().views = vec![ViewFacts { grid: (3, 3), ..ViewFacts::default() }];
    for beam in 0..181_usize {
        let angle = (beam as f64 - 90.0).to_radians();
        judge.facts_mut().ranges_m[beam] = (0.537 / libm::cos(angle)).clamp(0.2, 8.192) as f32;
    }
    judge.calibrate().unwrap();
    assert_eq!(judge.judge().unwrap(), Judgement::default());
    judge.facts_mut().ranges_m[130] += 0.16;
    assert_eq!(judge.judge().unwrap(), Judgement { reward: -1.0, then: Some(Then::Recover), ..Judgement::default() });
    judge.facts_mut().ranges_m[130] -= 0.16;
    judge.facts_mut().ranges_m[131] += 0.16;
    assert_eq!(judge.judge().unwrap(), Judgement::default());
}
