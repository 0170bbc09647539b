use std::sync::atomic::AtomicBool;

use super::figures::Figure;
use super::job::{Learn, Metric};
use super::row::Row;
use super::*;

fn spread(values: &[f64]) -> RowSpread {
    RowSpread::new(values, f64::is_finite, true).unwrap()
}

#[test]
fn quartiles_and_median_are_values_of_seeds_and_never_is_the_worst() {
    let found = spread(&[1200.0, f64::INFINITY, 800.0, 2000.0]);
    assert_eq!((found.quantile(0.25), found.median(), found.quantile(0.75)), (1200.0, 2000.0, f64::INFINITY));
    assert_eq!((found.worst(), found.good), (f64::INFINITY, 3));
    assert_eq!(RowSpread::new(&[0.1, 0.3], |_| true, false).unwrap().worst(), 0.1);
    assert!(RowSpread::new(&[f64::NAN], |_| true, true).is_none());
}

#[test]
fn near_has_a_band_around_the_papers_number() {
    let rule = Rule::Near(2000.0, 1.5);
    let judge = |value: f64| rule.judge(&spread(&[value]), None);
    assert_eq!(judge(1200.0), Verdict::Better);
    assert_eq!(judge(1400.0), Verdict::Reproduced);
    assert_eq!(judge(3000.0), Verdict::Reproduced);
    assert_eq!(judge(3200.0), Verdict::Worse);
    assert_eq!(judge(f64::INFINITY), Verdict::Worse);
    // Punishment is compared by its size.
    let rule = Rule::Near(-12.0, 1.5);
    assert_eq!(rule.judge(&spread(&[-7.0]), None), Verdict::Better);
    assert_eq!(rule.judge(&spread(&[-18.0]), None), Verdict::Reproduced);
    assert_eq!(rule.judge(&spread(&[-19.0]), None), Verdict::Worse);
}

#[test]
fn limits_include_themselves() {
    let judge = |rule: Rule| rule.judge(&spread(&[0.5]), None);
    assert_eq!(judge(Rule::Within(0.9, 0.4)), Verdict::Reproduced);
    assert_eq!(judge(Rule::Within(0.9, 0.3)), Verdict::Worse);
    assert_eq!(judge(Rule::AtMost(0.5)), Verdict::Reproduced);
    assert_eq!(judge(Rule::AtMost(0.4)), Verdict::Worse);
    assert_eq!(judge(Rule::AtLeast(0.5)), Verdict::Reproduced);
    assert_eq!(judge(Rule::AtLeast(0.6)), Verdict::Worse);
    assert_eq!(judge(Rule::None), Verdict::NotComparable);
}

#[test]
fn one_learner_beats_another_by_fewer_steps_or_more_seeds_and_loses_neither() {
    let reference = spread(&[800.0, 1200.0, 1600.0, f64::INFINITY]);
    let judge = |values: &[f64]| Rule::Beats.judge(&spread(values), Some(&reference));
    assert_eq!(judge(&[800.0, 1200.0, 1200.0, f64::INFINITY]), Verdict::Better);
    assert_eq!(judge(&[800.0, 1200.0, 1600.0, 4000.0]), Verdict::Better);
    assert_eq!(judge(&[800.0, 1200.0, 1600.0, f64::INFINITY]), Verdict::Worse);
    assert_eq!(judge(&[800.0, 1200.0, 2000.0, 4000.0]), Verdict::NotComparable);
    assert_eq!(Rule::Beats.judge(&reference, None), Verdict::NotComparable);
}

#[test]
fn a_share_counts_good_seeds() {
    let found = spread(&[400.0, f64::INFINITY, 800.0, 400.0]);
    assert_eq!(Rule::Loses(0.2).judge(&found, None), Verdict::Reproduced);
    assert_eq!(Rule::Loses(0.5).judge(&found, None), Verdict::Better);
    assert_eq!(Rule::Share(0.75).judge(&found, None), Verdict::Reproduced);
    assert_eq!(Rule::Share(0.8).judge(&found, None), Verdict::Worse);
}

#[test]
fn a_comparison_needs_its_reference() {
    let (ours, base) = (spread(&[2.0]), spread(&[1.0]));
    assert_eq!(Rule::NoWorse(1.0).judge(&ours, Some(&base)), Verdict::Reproduced);
    assert_eq!(Rule::NoWorse(0.5).judge(&ours, Some(&base)), Verdict::Worse);
    assert_eq!(Rule::Degrades(0.5).judge(&ours, Some(&base)), Verdict::Reproduced);
    assert_eq!(Rule::Degrades(1.0).judge(&ours, Some(&base)), Verdict::Better);
    assert_eq!(Rule::Slower(1.0).judge(&ours, Some(&base)), Verdict::Reproduced);
    assert_eq!(Rule::Slower(1.0).judge(&base, Some(&ours)), Verdict::Better);
    assert_eq!(Rule::Slower(0.5).judge(&spread(&[f64::INFINITY]), Some(&base)), Verdict::Worse);
    assert_eq!(Rule::NoWorse(1.0).judge(&ours, None), Verdict::NotComparable);
}

#[test]
fn every_row_has_a_name_of_its_own() {
    for (index, claim) in CLAIMS.iter().enumerate() {
        assert!(CLAIMS[..index].iter().all(|before| before.id != claim.id), "{}", claim.id);
        assert!(claim.id.chars().all(|c| c.is_ascii_alphanumeric() || "-.".contains(c)), "{}", claim.id);
    }
}

/// A room, and a script for each job: all learn the same.
fn scratch() -> (tempfile::TempDir, Options) {
    let folder = tempfile::tempdir().unwrap();
    let scripts = folder.path().join("scripts");
    std::fs::create_dir_all(folder.path().join("worlds")).unwrap();
    std::fs::create_dir_all(&scripts).unwrap();
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../worlds/room.toml");
    std::fs::copy(root, folder.path().join("worlds/room.toml")).unwrap();
    let script = "world(\"room\");\nrule \"near\" when laser.nearest <= 0.25 => -1 then recover;\n";
    std::fs::write(scripts.join("wall.rhai"), script).unwrap();
    let only = Vec::new();
    let options = Options { scripts, seed: 100, seeds: 2, threads: 1, quick: true, only };
    (folder, options)
}

fn measure(options: Options) -> (Reproduction, Vec<Figure>) {
    let measured = Campaign::new(options).run(&AtomicBool::new(false), &|_| {}).unwrap();
    (rows(&measured), figures(&measured).unwrap())
}

#[test]
fn every_claim_has_a_row_and_what_is_missing_says_why() {
    let (_folder, options) = scratch();
    let (found, drawn) = measure(options);
    assert_eq!(
        found.rows.iter().map(|row| row.id).collect::<Vec<_>>(),
        CLAIMS.iter().map(|c| c.id).collect::<Vec<_>>()
    );
    let row = |id: &str| found.rows.iter().find(|row| row.id == id).unwrap();
    assert_eq!(row("states").verdict, Verdict::Reproduced);
    let missing = |id: &str, word: &str| {
        assert_eq!(row(id).verdict, Verdict::NotMeasured, "{id}");
        assert!(row(id).reason.contains(word), "{}", row(id).reason);
    };
    missing("corridor-learned", "corridor.rhai");
    missing("gaps-40", "no world");
    let page = page(&found, &drawn);
    assert!(!page.contains("http:") && !page.contains("https:") && !page.contains("src=\"/"), "an outside reference");
    assert!(page.contains("Quick check"));
    assert_eq!(page.matches("<article").count(), CLAIMS.len());
    assert_eq!(markdown(&found).lines().filter(|line| line.starts_with("| ")).count(), CLAIMS.len() + 1);
}

#[test]
fn one_thread_or_two_give_the_same_bytes() {
    let (_folder, options) = scratch();
    let only = vec!["wall-learned".to_owned(), "noise".to_owned(), "aliasing".to_owned()];
    let one = Options { only, ..options };
    let two = Options { threads: 2, ..one.clone() };
    let bytes = |options: Options| {
        let (found, drawn) = measure(options);
        (serde_json::to_string(&found).unwrap(), page(&found, &drawn))
    };
    assert_eq!(bytes(one), bytes(two));
}

#[test]
fn text_is_never_markup() {
    let row = Row {
        id: "states",
        section: "4",
        claim: "<b>",
        paper: "&",
        ours: None,
        reference: None,
        verdict: Verdict::NotMeasured,
        rule: String::new(),
        reason: "<script>alert('x')</script>".to_owned(),
        command: "run \"a\"".to_owned(),
    };
    let page = page(&Reproduction { seed: 1, seeds: 1, quick: false, rows: vec![row] }, &[]);
    assert!(!page.contains("<script") && !page.contains("<b></h3>"));
    assert!(page.contains("&lt;script&gt;alert('x')&lt;/script&gt;"));
    assert!(page.contains("run &quot;a&quot;"));
}

#[test]
fn a_metric_says_which_seeds_are_good() {
    assert!(Metric::LearnedAt.good(800.0).0 && !Metric::LearnedAt.good(f64::INFINITY).0);
    assert!(Metric::NetSpeed.good(0.1).0 && !Metric::NetSpeed.good(0.09).0);
    assert_eq!(super::row::shown(10_500.0, 0), "10,500");
    assert_eq!(super::row::shown(-1800.25, 1), "−1,800.2");
    assert_eq!(super::row::shown(-0.01, 1), "0.0");
    assert_eq!(super::row::shown(f64::INFINITY, 0), "never");
}

#[test]
fn every_claim_is_learned_by_ttd_unless_it_names_another_learner() {
    let changes = |set: &'static [&'static str]| Learn::script("wall").set(set).changes().collect::<Vec<_>>();
    assert_eq!(changes(&[]), ["learner.kind=ttd"]);
    assert_eq!(changes(&["grid.rows=4"]), ["learner.kind=ttd", "grid.rows=4"]);
    assert_eq!(changes(&["learner.kind=q"]), ["learner.kind=q"]);
}
