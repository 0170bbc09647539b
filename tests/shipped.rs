use std::path::PathBuf;
use std::sync::Arc;

use engine::experiment::{Overrides, Plan};
use engine::script::Behaviour;
use engine::settings::BodyShape;
use engine::world::Layout;

use crate::support::root;

fn files(folder: &str, ending: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(root().join(folder)).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<_> = entries.filter(|path| path.extension().is_some_and(|found| found == ending)).collect();
    files.sort();
    assert!(!files.is_empty());
    files
}

#[test]
fn every_world_that_ships_loads() {
    for path in files("worlds", "toml") {
        if let Err(error) = Layout::load(&path, &BodyShape::pioneer2at()) {
            panic!("{}", error.render(false));
        }
    }
}

#[test]
fn every_script_that_ships_is_ready_to_be_learned() {
    for path in files("scripts", "rhai") {
        let plan = Behaviour::load(&path).and_then(|behaviour| Plan::new(Arc::new(behaviour), &Overrides::default()));
        if let Err(error) = plan {
            panic!("{}", error.render(false));
        }
    }
}

#[test]
fn the_reference_page_is_what_the_engine_prints() {
    let page = std::fs::read_to_string(root().join("scripts/README.md")).unwrap();
    assert!(page == engine::script::reference(), "run: engine reference > scripts/README.md");
}
