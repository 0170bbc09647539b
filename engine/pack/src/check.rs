//! Whether a pack is ready to be shared: what its author should know before strangers find out.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use serde::Serialize;

use super::author::Author;
use super::evidence::{check_length, measure};
use super::{Pack, draft};
use engine::diagnostic::Result;
use engine::experiment::{Overrides, Progress};
use engine::filter::Sources;

/// How many seeds are learned.
const SEEDS: usize = 3;

/// Something to mend.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct PackFinding {
    /// What it is about: `license`, `capability`, `evidence`, `description`.
    pub about: &'static str,
    /// What is wrong and what to do.
    pub text: String,
}

/// Checks an author's folder: it loads, every file is listed, it is licensed, it asks for nothing that it does not use,
/// and its first three seeds learn.
///
/// # Errors
/// If it cannot be a pack at all, or does not load.
pub fn check_pack(
    folder: &Path,
    depends: &[Pack],
    sources: Sources,
    stop: &AtomicBool,
    report: &(dyn Fn(Progress) + Sync),
) -> Result<Vec<PackFinding>> {
    let author = Author::load(folder)?;
    let pack = draft(folder)?;
    let mut findings = Vec::new();
    let mut find = |about, text| findings.push(PackFinding { about, text });
    let licensed = |path: &str| ["license", "licence", "copying"].iter().any(|start| path.starts_with(start));
    if !author.files.iter().any(|path| licensed(path.as_str())) {
        find("license", format!("the text of '{}' is missing: add a file 'license' to 'files'", author.license));
    }
    if author.license.split_whitespace().any(|word| !is_spdx(word)) {
        find("license", format!("'{}' is no SPDX expression, such as MIT or MIT OR Apache-2.0", author.license));
    }
    let script = pack.text(author.script.as_str())?;
    for asked in author.capabilities.filters_wasm.iter().chain(&author.capabilities.native) {
        let file = asked.as_str().rsplit('/').next().unwrap_or_default();
        let name = file.split('.').next().unwrap_or_default();
        let name = name.strip_prefix("lib").filter(|_| author.capabilities.native.contains(asked)).unwrap_or(name);
        if !script.text.contains(&format!("\"{name}\"")) {
            find("capability", format!("'{asked}' is asked for, but the script uses no filter '{name}'"));
        }
    }
    if author.capabilities.bridge && !script.text.contains("bridge") {
        find("capability", "'bridge' is asked for, but the script does not use it".to_owned());
    }
    let runnable = pack.plan(depends, &Overrides::default(), sources)?;
    check_length(&runnable, author.seeds.len())?;
    let seeds: Vec<u64> = author.seeds.iter().copied().take(SEEDS).collect();
    let proofs = measure(&runnable, &seeds, 0, stop, report)?;
    let good = proofs.iter().filter(|proof| proof.claim.success == Some(true)).count();
    if 2 * good <= proofs.len() {
        find("evidence", format!("only {good} of {} seeds are a success: engine run shows why", proofs.len()));
    }
    Ok(findings)
}

fn is_spdx(word: &str) -> bool {
    let word = word.trim_matches(['(', ')']);
    !word.is_empty() && word.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '.' | '-' | '+'))
}
