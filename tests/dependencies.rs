use std::collections::BTreeMap;
use std::process::Command;

use serde::Deserialize;

use crate::support::root;

/// The parts of deny.toml that are held here.
#[derive(Deserialize)]
struct Deny {
    licenses: Licenses,
    sources: Sources,
}

#[derive(Deserialize)]
struct Licenses {
    allow: Vec<String>,
    exceptions: Vec<Exception>,
}

#[derive(Deserialize)]
struct Exception {
    #[serde(rename = "crate")]
    package: String,
    allow: Vec<String>,
}

#[derive(Deserialize)]
#[serde(rename_all = "kebab-case")]
struct Sources {
    allow_registry: Vec<String>,
    allow_git: Vec<String>,
}

#[derive(Deserialize)]
struct Lock {
    package: Vec<Locked>,
}

#[derive(Deserialize)]
struct Locked {
    name: String,
    source: Option<String>,
}

#[derive(Deserialize)]
struct Metadata {
    packages: Vec<Package>,
}

#[derive(Deserialize)]
struct Package {
    name: String,
    license: Option<String>,
}

fn deny() -> Deny {
    toml::from_str(&std::fs::read_to_string(root().join("deny.toml")).unwrap()).unwrap()
}

fn output(command: &mut Command) -> String {
    let output = command.current_dir(root()).output().unwrap();
    assert!(output.status.success(), "{command:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Every crate that is built on this system with the features that this test is built with; all are here already.
fn packages() -> Vec<Package> {
    let version = output(Command::new("rustc").arg("-vV"));
    let host = version.lines().find_map(|line| line.strip_prefix("host: ")).unwrap();
    let mut command = Command::new(env!("CARGO"));
    command.args(["metadata", "--format-version", "1", "--locked", "--offline", "--filter-platform", host]);
    if cfg!(all(feature = "wasm", feature = "mcap", feature = "share")) {
        command.arg("--all-features");
    }
    serde_json::from_str::<Metadata>(&output(&mut command)).unwrap().packages
}

/// A licence expression of SPDX, read from the left; old ones write `/` for `OR`.
struct Expression<'a> {
    words: Vec<String>,
    at: usize,
    allowed: &'a dyn Fn(&str) -> bool,
}

impl Expression<'_> {
    fn is_met(text: &str, allowed: &dyn Fn(&str) -> bool) -> bool {
        let spaced = text.replace('/', " OR ").replace('(', " ( ").replace(')', " ) ");
        let words = spaced.split_whitespace().map(str::to_owned).collect();
        let mut expression = Expression { words, at: 0, allowed };
        let met = expression.any();
        assert_eq!(expression.at, expression.words.len(), "'{text}' is not a licence expression");
        met
    }

    fn takes(&mut self, word: &str) -> bool {
        let found = self.words.get(self.at).is_some_and(|next| next == word);
        self.at += usize::from(found);
        found
    }

    fn any(&mut self) -> bool {
        let mut met = self.all();
        while self.takes("OR") {
            met |= self.all();
        }
        met
    }

    fn all(&mut self) -> bool {
        let mut met = self.one();
        while self.takes("AND") {
            met &= self.one();
        }
        met
    }

    fn one(&mut self) -> bool {
        if self.takes("(") {
            let met = self.any();
            assert!(self.takes(")"), "a bracket is not closed");
            return met;
        }
        let mut licence = self.words[self.at].trim_end_matches('+').to_owned();
        self.at += 1;
        if self.takes("WITH") {
            licence = format!("{licence} WITH {}", self.words[self.at]);
            self.at += 1;
        }
        (self.allowed)(&licence)
    }
}

#[test]
fn licence_expressions_are_read_as_spdx_means_them() {
    let allowed = |licence: &str| ["MIT", "ISC", "Apache-2.0 WITH LLVM-exception"].contains(&licence);
    for met in ["MIT", "GPL-3.0 OR MIT", "MIT/GPL-3.0", "MIT AND ISC", "GPL-3.0 AND X OR ISC", "(X OR MIT) AND ISC"] {
        assert!(Expression::is_met(met, &allowed), "{met}");
    }
    assert!(Expression::is_met("Apache-2.0 WITH LLVM-exception OR X", &allowed));
    for unmet in ["GPL-3.0", "MIT AND X", "X AND (MIT OR ISC)", "Apache-2.0", "X OR Y AND MIT"] {
        assert!(!Expression::is_met(unmet, &allowed), "{unmet}");
    }
}

#[test]
fn every_crate_can_be_had_under_a_licence_that_deny_toml_allows() {
    let Licenses { allow, exceptions } = deny().licenses;
    let exceptions: BTreeMap<&str, &[String]> =
        exceptions.iter().map(|exception| (exception.package.as_str(), exception.allow.as_slice())).collect();
    let packages = packages();
    assert!(packages.len() > 100, "only {} packages were found", packages.len());
    for package in packages {
        let own = exceptions.get(package.name.as_str()).copied().unwrap_or_default();
        let allowed = |licence: &str| allow.iter().chain(own).any(|other| other == licence);
        let licence = package.license.unwrap_or_else(|| panic!("{} names no licence", package.name));
        assert!(Expression::is_met(&licence, &allowed), "{} is under {licence}: see deny.toml", package.name);
    }
}

#[test]
fn every_crate_comes_from_a_place_that_deny_toml_allows() {
    let Sources { allow_registry, allow_git } = deny().sources;
    assert!(allow_git.is_empty());
    let lock: Lock = toml::from_str(&std::fs::read_to_string(root().join("Cargo.lock")).unwrap()).unwrap();
    for Locked { name, source } in lock.package {
        // What has no source stands in this repository.
        let Some(source) = source else { continue };
        let registry = source.strip_prefix("registry+");
        let known = registry.is_some_and(|registry| allow_registry.iter().any(|allowed| allowed == registry));
        assert!(known, "{name} comes from {source}: see deny.toml");
    }
}

/// How many crates a package needs to be built for use.
#[cfg(all(target_os = "linux", target_arch = "x86_64"))]
fn crates_of(package: &str, features: &[&str]) -> usize {
    let mut command = Command::new(env!("CARGO"));
    command
        .args(["tree", "--edges", "normal", "--prefix", "none", "--locked", "--offline", "--package", package])
        .args(features);
    let tree = output(&mut command);
    let name = |line: &str| line.split_whitespace().take(2).collect::<Vec<_>>().join(" ");
    tree.lines().filter(|line| !line.is_empty()).map(name).collect::<std::collections::BTreeSet<_>>().len()
}

#[test]
#[cfg(all(target_os = "linux", target_arch = "x86_64"))]
fn the_library_and_the_program_stay_small() {
    for (package, features, most) in
        [("engine", &["--no-default-features"][..], 100), ("engine", &[], 120), ("program", &[], 200)]
    {
        let count = crates_of(package, features);
        assert!(count <= most, "{package} {features:?} needs {count} crates, more than {most}");
    }
}
