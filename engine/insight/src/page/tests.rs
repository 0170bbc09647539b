//! What a document holds, and that no text leaves its place in the page.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::*;
use crate::markup::base64;
use engine::diagnostic::SourceText;
use engine::experiment::{Ledger, Overrides, Phase, Plan, Playback, learn_into};
use engine::script::Behaviour;
use engine::settings::Settings;
use engine::world::Layout;

const WORLD: &str = r#"[floor]
material = "grey"

[[material]]
name = "grey"
colour = [120, 120, 120]

[[material]]
name = "light"
colour = [190, 190, 190]

[[wall]]
points_m = [[0, 0], [6, 0], [6, 6], [0, 6]]
closed = true
height_m = 1.0
thickness_m = 0.1
material = "light"

[[start]]
position_m = [3.0, 1.0]
yaw_deg = 0

[[route]]
name = "lap"
points_m = [[1, 1], [5, 1], [5, 5], [1, 5]]
closed = true
"#;

fn plan() -> Plan {
    plan_in(WORLD)
}

fn plan_in(world: &str) -> Plan {
    let script =
        "world(\"w\");\nrule \"near\" when laser.nearest <= 0.25 => -1 then recover;\nfn reward(facts) {\n    0.1\n}\n";
    let behaviour = Arc::new(Behaviour::parse("short", SourceText::new("short.rhai", script)).unwrap());
    let settings = Settings { ..behaviour.settings().clone() };
    let layout = Arc::new(Layout::parse(SourceText::new("w.toml", world), &settings.robot.body).unwrap());
    let plan =
        Plan::with_layout(behaviour, settings, layout, Arc::new(engine::filter::Catalogue::linked_in())).unwrap();
    plan.with_changes(&Overrides { steps: Some(40), test_steps: Some(1), ..Overrides::default() }).unwrap()
}

#[test]
fn a_document_names_rules_by_line_and_says_which_have_a_value_of_their_own() {
    let document = Document::without_seeds(&plan()).unwrap();
    let rules: Vec<_> =
        document.rules.iter().map(|rule| (rule.name.as_str(), rule.line, rule.lines, rule.value)).collect();
    assert_eq!(rules, [("near", 2, 1, Some(-1.0)), ("reward", 3, 1, None)]);
}

#[test]
fn every_fifth_of_181_beams_is_kept() {
    let document = Document::without_seeds(&plan()).unwrap();
    assert_eq!((document.scan.beams, document.scan.every, document.scan.kept), (181, 5, 37));
}

#[test]
fn the_world_is_drawn_to_its_bounds_in_millimetre_places() {
    let document = Document::without_seeds(&plan()).unwrap();
    assert_eq!(document.world.bounds_m, [-0.05, -0.05, 6.05, 6.05]);
    assert_eq!(document.unit_m, 0.001);
    assert_eq!(document.world.route_m.unwrap(), [[1.0, 1.0], [5.0, 1.0], [5.0, 5.0], [1.0, 5.0], [1.0, 1.0]]);
    assert!(document.world.solids.iter().all(|solid| solid.kind == "wall" && solid.corners_m.len() == 4));
}

#[test]
fn a_seed_beyond_those_that_bring_their_steps_has_its_curve() {
    let plan = plan();
    let (stop, off) = (AtomicBool::new(false), Ledger::off());
    let mut runs = Vec::new();
    for seed in 1..=2 {
        let mut ledger = Ledger::new(&plan, 40);
        let learned = learn_into(&plan, seed, &stop, &|_| (), &mut ledger).unwrap();
        runs.push((learned, ledger));
    }
    let data: Vec<SeedData<'_>> = runs
        .iter()
        .map(|(learned, ledger)| SeedData {
            seed: learned.seed,
            tally: Some(&learned.tally),
            policy: Some(&learned.policy),
            test: None,
            lines: None,
            learning: ledger,
            tested: &off,
        })
        .collect();
    let document = Document::new(&plan, &data, Moments { shots: 4, scans: true, seeds: Some(1) }).unwrap();
    let [first, second] = document.seeds.as_slice() else { panic!() };
    assert_eq!(first.learning.as_ref().unwrap().steps, 40);
    assert!(first.shown_first && second.learning.is_none() && !second.shown_first);
    assert_eq!((first.curve.len(), second.curve.len()), (1, 1));
    let steps: Vec<usize> = document.shots.iter().map(|shot| shot.step).collect();
    assert!(steps.len() <= 4 && steps[0] == 0 && steps.is_sorted(), "{steps:?}");
    assert_eq!(document.shots[0].state, document.shots[0].reasons.next_state.index);
}

#[test]
fn every_mover_is_where_it_was_when_the_steps_are_played_again() {
    let mover = |name: &str, speed: f64, offset: f64| {
        format!(
            "\n[[mover]]\nname = \"{name}\"\nroute = \"lap\"\nspeed_m_per_s = {speed}\noffset_m = {offset}\n\
             boxes = [{{ centre_m = [0, 0, 0.2], size_m = [0.3, 0.2, 0.4], material = \"light\" }}]\n"
        )
    };
    let plan = plan_in(&format!("{WORLD}{}{}", mover("first", 0.2, 8.0), mover("second", 0.4, 10.0)));
    let names: Vec<_> = Ground::new(&plan).movers.into_iter().map(|mover| (mover.name, mover.solids.len())).collect();
    assert_eq!(names, [("first".to_owned(), 1), ("second".to_owned(), 1)]);
    let mut ledger = Ledger::new(&plan, 40);
    let learned = learn_into(&plan, 1, &AtomicBool::new(false), &|_| (), &mut ledger).unwrap();
    let off = Ledger::off();
    let data = SeedData {
        seed: 1,
        tally: Some(&learned.tally),
        policy: Some(&learned.policy),
        test: None,
        lines: None,
        learning: &ledger,
        tested: &off,
    };
    let document = Document::new(&plan, &[data], Moments { shots: 0, scans: false, seeds: None }).unwrap();
    let track = document.seeds[0].learning.as_ref().unwrap();
    let mut playback = Playback::new(&plan, 1, Phase::Learning, &ledger).unwrap();
    let mut places = vec![[Vec::new(), Vec::new()]; 2];
    while playback.advance().unwrap().is_some() {
        for (solid, place) in playback.cycle().robot().world().moving().iter().zip(&mut places) {
            for (column, metres) in place.iter_mut().zip([solid.centre.x, solid.centre.y]) {
                column.extend(((metres / document.unit_m).round() as i16).to_le_bytes());
            }
        }
    }
    for (mover, [x, y]) in track.movers.iter().zip(&places) {
        assert_eq!((&mover.x, &mover.y), (&base64(x), &base64(y)));
    }
    assert_ne!(track.movers[0].x, track.movers[1].x);
}

#[test]
fn a_full_check_replaces_what_reading_found() {
    let plan = plan();
    let document = Document::without_seeds(&plan).unwrap();
    assert!(document.checked.is_none());
    let span = 0..0;
    let mut finding = crate::lint::Finding::warning(&plan, "W-UNIT", span, "nothing reads it").say("", "");
    finding.line = 0;
    let report = crate::lint::Report {
        behaviour: "short".to_owned(),
        world: "w".to_owned(),
        steps: 6800,
        findings: vec![finding],
        left_out: 2,
        exploits: None,
    };
    let document = document.with_check(&report);
    let [found] = document.findings.as_slice() else { panic!() };
    assert_eq!((found.line, &found.label, &found.help), (None, &None, &None));
    let checked = document.checked.unwrap();
    assert_eq!((checked.steps, checked.left_out), (6800, 2));
}

#[test]
fn the_end_of_a_script_element_in_a_text_ends_nothing() {
    let mut document = Document::without_seeds(&plan()).unwrap();
    document.script = "</script><b>".to_owned();
    document.behaviour = "<b>".to_owned();
    let html = page(Some(&document)).unwrap().html;
    assert!(html.contains("\\u003c/script>\\u003cb>") && !html.contains("<b>"));
}
