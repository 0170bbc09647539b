use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use engine::settings::GridSettings;
use engine::state::Grid;

use crate::support::{Bench, root};

/// The most lines of README.md.
const README_LINES: usize = 170;

fn read(path: &str) -> String {
    std::fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

fn pages_in(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            pages_in(&path, found);
        } else if path.extension().is_some_and(|ending| ending == "md") {
            found.push(path);
        }
    }
}

/// Every page for people: those at the top, and those in the folders that people look into.
fn pages() -> Vec<PathBuf> {
    let names = ["README", "ARCHITECTURE", "CHANGELOG", "CONTRIBUTING", "RELEASE-CHECKLIST", "SECURITY"];
    let mut found: Vec<PathBuf> = names.iter().map(|name| root().join(format!("{name}.md"))).collect();
    for folder in ["docs", "scripts", "worlds", "plugins", "tests/fuzz"] {
        pages_in(&root().join(folder), &mut found);
    }
    found
}

/// The text outside of fenced code.
fn prose(text: &str) -> String {
    let parts = text.split("```").enumerate().filter(|(index, _)| index % 2 == 0);
    parts.map(|(_, part)| part).collect()
}

/// What the links of a page point at.
fn links(text: &str) -> Vec<String> {
    let targets = text.split("](").skip(1).filter_map(|rest| rest.split_once(')'));
    targets.map(|(target, _)| target.split('#').next().unwrap().to_owned()).collect()
}

#[test]
fn every_link_to_a_file_finds_it() {
    let mut followed = 0;
    for page in pages() {
        for link in links(&prose(&std::fs::read_to_string(&page).unwrap())) {
            if link.is_empty() || link.contains("://") {
                continue;
            }
            followed += 1;
            assert!(page.parent().unwrap().join(&link).exists(), "{} links to {link}", page.display());
        }
    }
    assert!(followed > 50, "only {followed} links were found");
}

#[test]
fn every_source_that_a_page_names_in_full_is_there() {
    let page_names = ["README.md", "CONTRIBUTING.md", "SECURITY.md", "RELEASE-CHECKLIST.md"];
    let mut pages: Vec<PathBuf> = page_names.iter().map(|name| root().join(name)).collect();
    pages_in(&root().join("docs"), &mut pages);
    for page in pages {
        let text = std::fs::read_to_string(&page).unwrap();
        for word in prose(&text).split('`').skip(1).step_by(2) {
            let place = ["engine/", "plugins/", "tests/", ".ci/"].iter().any(|start| word.starts_with(start));
            let one_word = !word.contains([' ', '*', '<']);
            let file = word.starts_with(".ci/") || Path::new(word).extension().is_some();
            assert!(!(place && one_word && file) || root().join(word).exists(), "{} names {word}", page.display());
        }
    }
}

#[test]
fn the_readme_is_read_in_ten_minutes() {
    let lines = read("README.md").lines().count();
    assert!(lines <= README_LINES, "README.md has {lines} lines; move some of them to docs/");
}

#[test]
fn the_readme_begins_with_two_commands_and_ci_runs_them() {
    let readme = read("README.md");
    let block = readme.split("```sh\n").nth(1).unwrap().split("```").next().unwrap();
    let commands: Vec<&str> = block.lines().map(|line| line.split('#').next().unwrap().trim_end()).collect();
    assert_eq!(commands, ["cargo run --release -- run scripts/wall.rhai", "cargo test --release"]);
    let ci = read(".ci/run");
    for command in commands {
        let runs = |line: &str| line.trim() == command || line.trim().starts_with(&format!("{command} --out "));
        assert!(ci.lines().any(runs), ".ci/run does not run '{command}'");
    }
}

/// The worked example of docs/deploying.md.
struct Example {
    settings: GridSettings,
    width_px: usize,
    height_px: usize,
    mask: Vec<u8>,
    area: Vec<usize>,
    least: Vec<usize>,
    count: Vec<u32>,
    occupied: Vec<bool>,
    with_fill: usize,
    without_fill: usize,
}

/// The number at the start of a text.
fn number<T: std::str::FromStr>(text: &str) -> T {
    let digits: String = text.chars().take_while(|c| c.is_ascii_digit() || *c == '.').collect();
    digits.parse().unwrap_or_else(|_| panic!("no number: {text}"))
}

impl Example {
    fn read() -> Self {
        let page = read("docs/deploying.md");
        let (_, text) = page.split_once("### By hand").unwrap();
        let after = |words: &str| text.split_once(words).unwrap_or_else(|| panic!("'{words}' is missing")).1;
        let pair = |words: &str| {
            let (first, second) = after(words).split_once('x').unwrap();
            (number::<usize>(first), number::<usize>(second))
        };
        let ((width_px, height_px), (rows, columns)) = (pair("A mask of "), pair("under a grid of "));
        let occupied = number(after("`occupied = "));
        let settings =
            GridSettings { rows: rows as u64, columns: columns as u64, occupied, fill: true, remember_s: 0.0 };
        let row = |label: &str| -> Vec<usize> {
            let line = text.lines().find(|line| line.starts_with(label)).unwrap();
            line.split_whitespace().skip(1).map(number).collect()
        };
        let drawn = text.split("```").nth(1).unwrap().lines().skip(1).take_while(|line| !line.starts_with("area"));
        let pixels = drawn.flat_map(str::chars).filter(|c| matches!(c, '.' | '#'));
        let state = |label: &str| {
            let line = text.lines().find(|line| line.starts_with(label)).unwrap();
            number(line.rsplit("= ").next().unwrap())
        };
        Self {
            width_px,
            height_px,
            mask: pixels.map(|c| if c == '#' { 255 } else { 0 }).collect(),
            area: row("area "),
            least: row("least "),
            count: row("count ").into_iter().map(|count| count as u32).collect(),
            occupied: row("occupied ").into_iter().map(|bit| bit == 1).collect(),
            with_fill: state("with fill "),
            without_fill: state("without fill "),
            settings,
        }
    }

    fn grid(&self, fill: bool) -> Grid {
        Grid::new(&GridSettings { fill, ..self.settings.clone() }, self.width_px, self.height_px).unwrap()
    }
}

#[test]
fn the_example_that_is_worked_by_hand_is_what_the_engine_computes() {
    let example = Example::read();
    let mut grid = example.grid(true);
    assert_eq!(example.mask.len(), example.width_px * example.height_px);
    assert_eq!(grid.encode(&example.mask), example.with_fill);
    assert_eq!(grid.counts(), example.count);
    assert_eq!(grid.occupied(), example.occupied);
    assert_eq!((0..example.area.len()).map(|cell| grid.area_px(cell)).collect::<Vec<_>>(), example.area);
    assert_eq!(example.grid(false).encode(&example.mask), example.without_fill);
}

#[test]
fn the_thresholds_of_the_example_are_where_cells_become_occupied() {
    let example = Example::read();
    let mut grid = example.grid(true);
    let mut mask = vec![0; example.mask.len()];
    let mut pixels = vec![Vec::new(); example.least.len()];
    for pixel in 0..mask.len() {
        mask[pixel] = 255;
        grid.encode(&mask);
        pixels[grid.counts().iter().position(|count| *count == 1).unwrap()].push(pixel);
        mask[pixel] = 0;
    }
    for (cell, pixels) in pixels.iter().enumerate() {
        for set in 0..=pixels.len() {
            pixels[..set].iter().for_each(|pixel| mask[*pixel] = 255);
            grid.encode(&mask);
            assert_eq!(grid.occupied()[cell], set >= example.least[cell], "cell {cell} with {set} pixels");
            mask.fill(0);
        }
    }
}

/// All keys of a JSON value, however deep.
fn keys(value: &serde_json::Value, found: &mut BTreeSet<String>) {
    match value {
        serde_json::Value::Object(map) => map.iter().for_each(|(key, value)| {
            found.insert(key.clone());
            keys(value, found);
        }),
        serde_json::Value::Array(values) => values.iter().for_each(|value| keys(value, found)),
        _ => {}
    }
}

#[test]
fn every_field_and_file_of_a_run_stands_on_the_page_about_it() {
    let (bench, page) = (Bench::new(), read("docs/run-folder.md"));
    bench.engine(&["run", "short.rhai"]);
    bench.engine(&["run", "short.rhai", "--seeds", "2"]);
    let mut found = BTreeSet::new();
    for folder in ["1", "1-2"] {
        keys(&serde_json::from_str(&bench.read(&format!("runs/short/{folder}/summary.json"))).unwrap(), &mut found);
    }
    bench.engine(&["certify", "runs/short/1", "--worlds", "rooms", "--bound", "900", "--steps", "20"]);
    keys(&serde_json::from_str(&bench.read("runs/short/1/certificate.json")).unwrap(), &mut found);
    let files = std::fs::read_dir(bench.path().join("runs/short/1")).unwrap();
    found.extend(files.map(|entry| entry.unwrap().file_name().into_string().unwrap().replace(".svg", ".png")));
    for word in found {
        assert!(page.contains(&format!("`{word}`")), "docs/run-folder.md does not explain '{word}'");
    }
}

#[test]
fn every_field_of_a_policy_stands_on_the_page_about_it() {
    let (bench, page) = (Bench::new(), read("docs/deploying.md"));
    bench.write("filtered.rhai", format!("filter(\"sobel\", #{{ threshold: 60 }});\n{}", crate::support::SCRIPT));
    bench.engine(&["run", "filtered.rhai"]);
    let policy: toml::Table = toml::from_str(&bench.read("runs/filtered/1/policy.toml")).unwrap();
    let mut found = BTreeSet::new();
    keys(&serde_json::to_value(policy).unwrap(), &mut found);
    for table in ["filter", "state", "parameters", "threshold"] {
        assert!(found.remove(table), "{table}");
    }
    for word in found {
        assert!(page.contains(&format!("`{word}`")), "docs/deploying.md does not explain '{word}'");
    }
}
