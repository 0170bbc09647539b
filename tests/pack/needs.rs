use pack::{Dependency, Digest, Offer, PackName, resolve};
use semver::{Version, VersionReq};

use super::forge::{HEAD, pack_of, small_files};
use crate::support::Bench;

fn name(text: &str) -> PackName {
    PackName::try_from(text.to_owned()).unwrap()
}

fn offer(title: &str, depends: &[(&str, &str)]) -> Offer {
    let (own, version) = title.split_once(' ').unwrap();
    let depends = depends
        .iter()
        .map(|(other, range)| Dependency { name: name(other), version: VersionReq::parse(range).unwrap() });
    Offer {
        name: name(own),
        version: Version::parse(version).unwrap(),
        depends: depends.collect(),
        content: Digest::of(title.as_bytes()),
    }
}

fn chosen(root: &Offer, offers: &[Offer]) -> Result<Vec<String>, String> {
    let titles = |offers: Vec<Offer>| offers.iter().map(|offer| format!("{} {}", offer.name, offer.version)).collect();
    resolve(root, offers).map(titles).map_err(|error| format!("{}: {}", error.code, error.message))
}

#[test]
fn the_highest_versions_that_fit_everyone_are_chosen() {
    let root = offer("a/root 1.0.0", &[("a/left", "1"), ("a/right", "1")]);
    let offers = [
        offer("a/left 1.0.0", &[("a/base", ">=1")]),
        offer("a/left 1.1.0", &[("a/base", ">=1, <3")]),
        offer("a/left 2.0.0", &[]),
        offer("a/right 1.0.0", &[("a/base", "<2")]),
        offer("a/base 1.2.0", &[]),
        offer("a/base 1.3.0", &[]),
        offer("a/base 2.0.0", &[]),
    ];
    let expected = Ok(["a/base 1.3.0", "a/left 1.1.0", "a/right 1.0.0"].map(str::to_owned).to_vec());
    assert_eq!(chosen(&root, &offers), expected);
    let backwards: Vec<Offer> = offers.iter().rev().cloned().collect();
    assert_eq!(chosen(&root, &backwards), expected);
}

#[test]
pub(super) fn circles_and_missing_versions_are_errors() {
    let root = offer("a/root 1.0.0", &[("a/one", "1")]);
    let circle = [offer("a/one 1.0.0", &[("a/two", "1")]), offer("a/two 1.0.0", &[("a/root", "1")])];
    let expected = "E-PACK-CYCLE: packs build on one another in a circle: a/root -> a/one -> a/two -> a/root";
    assert_eq!(chosen(&root, &circle).unwrap_err(), expected);
    let inner = [offer("a/one 1.0.0", &[("a/two", "1")]), offer("a/two 1.0.0", &[("a/one", "1")])];
    assert!(chosen(&root, &inner).unwrap_err().starts_with("E-PACK-CYCLE"));
    let old = [offer("a/one 0.9.0", &[])];
    let expected = "E-PACK-DEPENDS: a/root builds on a/one ^1, and 0.9.0 is at hand";
    assert_eq!(chosen(&root, &old).unwrap_err(), expected);
}

#[test]
fn a_pack_uses_the_world_of_the_pack_that_it_builds_on() {
    let bench = Bench::new();
    let files = small_files();
    let needing =
        format!("{}\n[[depends]]\nname = \"eve/small\"\nversion = \"^1.0\"\n", HEAD.replace("eve/small", "eve/needs"));
    // The script, without the world that it names.
    bench.write("packs/needs.pack", pack_of(&needing, &[files[0], files[1]]));
    let install = ["pack", "install", "packs/needs.pack", "--allow-unsigned"];
    assert!(bench.failure(&install).contains("eve/needs builds on eve/small ^1.0, and no version of it is at hand"));
    bench.write("worlds-here/small.pack", super::forge::small());
    let out = bench.ok(&[&install[..], &["--from", "worlds-here"]].concat());
    assert!(out.contains("installed: eve/small 1.0.0"), "{out}");
    std::fs::remove_dir_all(bench.path().join("worlds-here")).unwrap();
    std::fs::remove_dir_all(bench.path().join("worlds")).unwrap();
    let output = bench.engine(&["run", "eve/needs", "--out", "out"]);
    assert!(matches!(output.status.code(), Some(0 | 1)), "{}", crate::support::told(&output));
    bench.ok(&["pack", "remove", "eve/small"]);
    assert!(bench.failure(&["run", "eve/needs"]).contains("builds on eve/small ^1.0, which is not installed"));
}
