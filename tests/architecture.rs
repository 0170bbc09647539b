use std::path::{Path, PathBuf};

use crate::support::root;

/// Which rooms of its crate a room may use, besides itself and what all share; between crates the compiler holds the law.
const IMPORTS: &[(&str, &[&str])] = &[
    ("geometry", &[]),
    ("random", &[]),
    ("saved", &[]),
    ("outcome", &[]),
    ("settings", &["geometry"]),
    ("diagnostic", &[]),
    ("world", &[]),
    ("sensors", &["world"]),
    ("filter", &["sensors"]),
    ("state", &["sensors"]),
    ("learner", &["state"]),
    ("judge", &[]),
    ("verdict", &["judge"]),
    ("script", &["judge", "verdict"]),
    ("robot", &["world", "sensors"]),
    ("experiment", &["world", "sensors", "filter", "state", "learner", "judge", "verdict", "script", "robot"]),
    ("disk", &[]),
    ("store", &["disk"]),
    ("lint", &[]),
    ("report", &["disk"]),
    ("page", &["lint", "report"]),
    ("record", &[]),
    ("folder", &["disk", "store", "lint", "report", "page"]),
    ("compare", &["store", "report"]),
    ("shelf", &["disk", "store"]),
];
const SHARED: &[&str] =
    &["allowed", "geometry", "random", "saved", "settings", "diagnostic", "digest", "outcome", "stats"];
/// Libraries that only some rooms may know. Clocks, hash maps, sines of the platform and fused steps are in clippy.toml.
const ONLY_IN: &[(&str, &[&str])] = &[
    ("rhai::", &["judge", "script"]),
    // The judge runs what the script room has made; it walks no tree of the parser.
    ("Expr::", &["script"]),
    ("Stmt::", &["script"]),
    ("parry3d", &["world"]),
    ("skrifa", &["report"]),
];

fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() && !path.ends_with("target") && !path.ends_with("examples") {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// Every source of the crates with its room: a folder of the core or of the insight crate, else the crate itself.
fn engine_sources() -> Vec<(String, PathBuf, String)> {
    let folder = root().join("engine");
    let room = |path: &Path| {
        let parts: Vec<&str> =
            path.strip_prefix(&folder).unwrap().components().map(|part| part.as_os_str().to_str().unwrap()).collect();
        match parts[..] {
            ["core" | "insight", "src", room, ..] => room.trim_end_matches(".rs").to_owned(),
            [name, ..] => name.to_owned(),
            [] => unreachable!("a source is not the folder itself"),
        }
    };
    let read = |path: PathBuf| (room(&path), path.clone(), std::fs::read_to_string(path).unwrap());
    sources(&folder).into_iter().map(read).collect()
}

fn is_test(path: &Path) -> bool {
    path.components().any(|part| part.as_os_str() == "tests" || part.as_os_str() == "tests.rs")
}

#[test]
fn rooms_import_only_what_the_map_allows() {
    for (room, path, text) in engine_sources() {
        let Some((_, allowed)) = IMPORTS.iter().find(|(name, _)| *name == room) else { continue };
        for used in text.split("crate::").skip(1) {
            let used: String = used.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            let known = IMPORTS.iter().any(|(name, _)| *name == used);
            let fine = !known || used == room || SHARED.contains(&used.as_str()) || allowed.contains(&used.as_str());
            assert!(fine || is_test(&path), "{} uses {used}", path.display());
        }
    }
}

#[test]
fn scripts_shapes_and_letters_stay_in_their_rooms() {
    for (room, path, text) in engine_sources() {
        let product = text.split("#[cfg(test)]").next().unwrap();
        for (word, rooms) in ONLY_IN {
            let fine = !product.contains(word) || rooms.contains(&room.as_str()) || is_test(&path);
            assert!(fine, "{} says {word}", path.display());
        }
    }
}

#[test]
fn unsafe_stands_where_libraries_are_loaded_and_kernels_are_picked() {
    let allowed = [
        "engine/core/src/filter/native/loaded.rs",
        "engine/core/src/filter/native/rounding.rs",
        "engine/dispatch/src/",
        "plugins/filter-api/src/",
    ];
    for path in ["engine", "plugins"].iter().flat_map(|folder| sources(&root().join(folder))) {
        let text = std::fs::read_to_string(&path).unwrap();
        let place = path.strip_prefix(root()).unwrap().to_str().unwrap();
        let used = text.contains("unsafe {") || text.contains("unsafe fn") || text.contains("unsafe impl");
        assert!(!used || allowed.iter().any(|start| place.starts_with(start)), "{place} is unsafe");
    }
}

#[test]
fn every_code_of_a_message_has_a_page_and_every_page_a_message() {
    let pages: Vec<_> = engine::diagnostic::all_codes().collect();
    let sources =
        engine_sources().into_iter().filter(|(_, path, _)| !path.to_str().unwrap().contains("diagnostic/codes"));
    let text: String = sources.map(|(_, _, text)| text).collect();
    let is_code = |word: &&str| {
        let begins = word.starts_with("E-") || word.starts_with("W-");
        begins && word.len() > 3 && word.chars().all(|c| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '-')
    };
    let codes: std::collections::BTreeSet<&str> = text.split('"').filter(is_code).collect();
    for code in &codes {
        assert!(pages.contains(code), "{code} needs a page in diagnostic/codes");
    }
    for page in pages {
        assert!(codes.contains(page), "no message has the code {page}");
    }
}

#[test]
fn every_file_is_one_idea() {
    let folders = ["engine", "plugins", "tests"];
    for path in folders.iter().flat_map(|folder| sources(&root().join(folder))) {
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.lines().count() <= 400, "{} is too long", path.display());
        let documented = text.starts_with("//!") || path.starts_with(root().join("tests")) || is_test(&path);
        assert!(documented, "{} does not say what it is", path.display());
    }
}
