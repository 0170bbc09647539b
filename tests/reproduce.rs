use crate::support::{Bench, root};

#[test]
fn a_quick_check_of_what_ships_fills_every_row_that_has_its_world() {
    let bench = Bench::new();
    let scripts = root().join("scripts");
    let output =
        bench.engine(&["reproduce", "--quick", "--seed", "100", "--json", "--scripts", scripts.to_str().unwrap()]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let printed: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let written: serde_json::Value = serde_json::from_str(&bench.read("runs/reproduce/reproduce.json")).unwrap();
    assert_eq!(printed, written);
    assert_eq!(printed["quick"], true);
    let rows = printed["rows"].as_array().unwrap();
    assert_eq!(rows.len(), paper::CLAIMS.len());
    for row in rows {
        let measured = row["verdict"] != "not-measured";
        assert!(!measured || row["ours"].is_object() || row["verdict"] == "not-comparable", "{row}");
        assert!(row["command"].as_str().unwrap().starts_with("cargo run --release -- "), "{row}");
        assert!(row["reason"].as_str().is_some_and(|reason| reason.ends_with('.')), "{row}");
    }
    let page = bench.read("runs/reproduce/reproduce.html");
    assert!(page.contains("Quick check") && !page.contains("http:") && !page.contains("https:"));
    assert_eq!(page.matches("<figure ").count(), page.matches("<figcaption>").count());
}

#[test]
fn a_row_that_is_not_there_is_named_with_its_neighbour() {
    let told = Bench::new().failure(&["reproduce", "--only", "wall-lerned"]);
    assert!(told.starts_with("exit status 2") && told.contains("did you mean 'wall-learned'?"), "{told}");
}

#[test]
fn a_test_with_a_folder_leaves_a_certainty_grid() {
    let bench = Bench::new();
    bench.engine(&["run", "short.rhai", "--out", "learned"]);
    bench.engine(&["test", "learned", "--out", "tested"]);
    for name in ["certainty-grid.png", "certainty-grid.svg", "test.json", "trajectories.png", "frame.png"] {
        assert!(bench.path().join("tested").join(name).exists(), "{name}");
    }
}
