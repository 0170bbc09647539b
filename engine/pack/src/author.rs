//! From an author's folder to a pack: the same folder gives the same bytes, on any machine and at any time.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use semver::{Version, VersionReq};
use serde::{Deserialize, Serialize};

use super::bundle::read_limited;
use super::certified::{CertifyLine, certificate_of};
use super::entry_path::{EntryPath, MAX_LEVELS};
use super::evidence::{Evidence, Proof, measure};
use super::manifest::{self, Capabilities, Dependency, FileLine, Manifest, PackEntry, toml_error};
use super::marks::STEPS;
use super::{Digest, MAX_MANIFEST_BYTES, MAX_PACK_BYTES, MAX_SEEDS, Pack, PackName, Runnable, archive, malformed};
use engine::diagnostic::{Diagnostic, Result, SourceText, nearest_name, printable};
use engine::experiment::{Decider, Overrides, Progress};
use engine::filter::Sources;
use insight::report::{TrajectoryData, WorldPlan, trajectories};

/// The author's file in the folder.
pub(super) const AUTHOR_FILE: &str = "pack.toml";
/// What `build` adds: the learned policy, and the picture of its paths.
const POLICY: &str = "policy.toml";
/// The picture of the paths before and after learning.
pub(super) const PICTURE: &str = "pictures/trajectories.png";

/// What an author writes into `pack.toml`; the manifest is made from it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Author {
    /// `owner/name`.
    pub name: PackName,
    /// The version of the pack.
    pub version: Version,
    /// The engines that it runs on.
    pub engine: VersionReq,
    /// The licence, as an SPDX expression.
    pub license: String,
    /// One sentence.
    pub description: String,
    /// The edition of the language that its scripts are of; without it the first, which packs of version 0.1 are.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub edition: Option<u32>,
    /// The behaviour's script.
    pub script: EntryPath,
    /// The world; without it, the one that the script names.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub world: Option<EntryPath>,
    /// The seeds that the evidence is measured with.
    #[serde(default = "three_seeds")]
    pub seeds: Vec<u64>,
    /// A bound in worlds that nobody has seen, which goes into the evidence; without it, none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub certify: Option<CertifyLine>,
    /// Every file that goes into the pack.
    pub files: Vec<EntryPath>,
    /// What the pack asks for.
    #[serde(default, skip_serializing_if = "Capabilities::is_none")]
    pub capabilities: Capabilities,
    /// The packs that it builds on.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub depends: Vec<Dependency>,
}

fn three_seeds() -> Vec<u64> {
    vec![1, 2, 3]
}

impl Author {
    /// Reads `pack.toml` of a folder.
    ///
    /// # Errors
    /// If it is missing, or wrong: at its place.
    pub fn load(folder: &Path) -> Result<Self> {
        let path = folder.join(AUTHOR_FILE);
        if !insight::disk::is_there(&path)? {
            let shown = printable(&folder.display().to_string());
            let message = format!("'{shown}' is no pack's folder: it has no '{AUTHOR_FILE}'");
            return malformed("E-PACK-FOLDER", message).help("make one with: engine pack new NAME").fail();
        }
        let text = String::from_utf8(read_limited(&path, MAX_MANIFEST_BYTES)?)
            .map_err(|_| Box::new(malformed("E-PACK-FOLDER", format!("'{AUTHOR_FILE}' is not text in UTF-8"))))?;
        let source = SourceText::new(path, text);
        let author: Self = toml::from_str(&source.text).map_err(|error| toml_error(&source, &error))?;
        if author.seeds.is_empty() || author.seeds.len() > MAX_SEEDS {
            return malformed("E-PACK-MANIFEST", format!("'seeds' in '{AUTHOR_FILE}' names 1 to {MAX_SEEDS} seeds"))
                .fail();
        }
        Ok(author)
    }

    fn manifest(&self) -> Manifest {
        Manifest {
            format: manifest::FORMAT,
            name: self.name.clone(),
            version: self.version.clone(),
            engine: self.engine.clone(),
            license: self.license.clone(),
            description: self.description.clone(),
            edition: self.edition,
            entry: PackEntry { script: self.script.clone(), world: self.world.clone(), policy: None },
            capabilities: self.capabilities.clone(),
            depends: self.depends.clone(),
            files: Vec::new(),
            evidence: None,
        }
    }
}

/// The author's folder as a pack in memory, without evidence and policy: what `build` starts from, and what runs when the
/// folder itself is run.
///
/// # Errors
/// If a file is missing, is not listed, or cannot be in a pack.
pub fn draft(folder: &Path) -> Result<Pack> {
    let author = Author::load(folder)?;
    check_listing(folder, &author)?;
    let mut files = BTreeMap::new();
    let mut total = 0;
    for path in &author.files {
        let bytes = read_limited(&folder.join(path.as_str()), MAX_PACK_BYTES)?;
        total += bytes.len();
        if total > MAX_PACK_BYTES {
            return malformed("E-PACK-LIMIT", format!("the files have more than {MAX_PACK_BYTES} bytes together"))
                .fail();
        }
        files.insert(path.clone(), bytes);
    }
    for made in [POLICY, PICTURE, STEPS] {
        if files.keys().any(|path| path.as_str() == made) {
            let message = format!("'{made}' is made by 'engine pack build' and cannot be among the files");
            return malformed("E-PACK-FOLDER", message).help("remove it from the folder and from 'files'").fail();
        }
    }
    assemble(folder, author.manifest(), &files)
}

/// Builds the pack of a folder: its files, the policy that is learned, and the evidence that is measured on the way.
///
/// # Errors
/// Those of [`draft`], and if the behaviour cannot be learned.
pub fn build(
    folder: &Path,
    depends: &[Pack],
    sources: Sources,
    threads: usize,
    stop: &AtomicBool,
    report: &(dyn Fn(Progress) + Sync),
) -> Result<Pack> {
    let author = Author::load(folder)?;
    let draft = draft(folder)?;
    let runnable = draft.plan(depends, &Overrides::default(), sources)?;
    let proofs = measure(&runnable, &author.seeds, threads, stop, report)?;
    let mut evidence = Evidence::new(&runnable, &proofs)?;
    let mut manifest = draft.manifest().clone();
    let mut files: BTreeMap<EntryPath, Vec<u8>> = manifest
        .files
        .iter()
        .filter_map(|line| Some((line.path.clone(), draft.file(line.path.as_str())?.to_vec())))
        .collect();
    let shown = proofs.iter().find(|proof| Some(proof.claim.seed) == evidence.policy_seed).or_else(|| proofs.first());
    if let Some(proof) = shown {
        files.insert(own_path(PICTURE)?, picture(&runnable, proof)?);
        if let Some(policy) = &proof.policy {
            let text = runnable.policy_text(policy)?;
            if let Some(line) = &author.certify {
                let decider = Decider::Learned(policy.clone());
                let certificate = certificate_of(&runnable, &decider, text.as_bytes(), line, threads, stop)?;
                evidence.certificate = Some(certificate);
                manifest.format = manifest::FORMAT_OF_CERTIFICATE;
            }
            files.insert(own_path(POLICY)?, text.into_bytes());
            manifest.entry.policy = Some(own_path(POLICY)?);
        }
    }
    let steps: String = proofs.iter().map(|proof| proof.marks.line(proof.claim.seed)).collect();
    files.insert(own_path(STEPS)?, steps.into_bytes());
    manifest.evidence = Some(evidence);
    assemble(folder, manifest, &files)
}

fn own_path(path: &str) -> Result<EntryPath> {
    EntryPath::new(path).map_err(|what| Box::new(malformed("E-PACK-ENTRY", format!("'{path}' {what}"))))
}

/// The pack with these files, read back through the same gates as a stranger's.
fn assemble(origin: &Path, mut manifest: Manifest, files: &BTreeMap<EntryPath, Vec<u8>>) -> Result<Pack> {
    let line = |(path, bytes): (&EntryPath, &Vec<u8>)| FileLine {
        path: path.clone(),
        size: bytes.len() as u64,
        sha256: Digest::of(bytes),
    };
    manifest.files = files.iter().map(line).collect();
    let text = manifest.to_toml()?;
    let mut bytes = Vec::new();
    let all = files.iter().map(|(path, bytes)| (path.as_str(), bytes.as_slice()));
    archive::write(std::iter::once((manifest::FILE, text.as_bytes())).chain(all), &mut bytes)
        .map_err(|error| Box::new(Diagnostic::new("E-IO", format!("the pack cannot be written: {error}"))))?;
    Pack::parse(origin, bytes)
}

fn picture(runnable: &Runnable, proof: &Proof) -> Result<Vec<u8>> {
    let plan = &runnable.plan;
    let title = format!("{} in {}, seed {}", plan.behaviour.name(), plan.worlds.title(), proof.claim.seed);
    let tested = ("test: first 800 steps", &proof.tested.trail);
    let panels: Vec<_> = proof.early.iter().map(|early| ("learning: first 400 steps", early)).chain([tested]).collect();
    Ok(trajectories(&TrajectoryData { title: &title, world: &WorldPlan::of(plan), panels: &panels })?.png)
}

/// The folder holds exactly what `files` lists, apart from what the engine and the author's tools leave beside it.
fn check_listing(folder: &Path, author: &Author) -> Result<()> {
    let mut found = Vec::new();
    walk(folder, "", 1, &mut found)?;
    if let Some(missing) = author.files.iter().find(|path| !found.iter().any(|name| name == path.as_str())) {
        let message = format!("'{AUTHOR_FILE}' lists '{missing}', which is not in the folder");
        let error = malformed("E-PACK-LIST", message);
        return match nearest_name(missing.as_str(), found.iter().map(String::as_str)) {
            Some(near) => error.help(format!("did you mean '{}'?", printable(near))).fail(),
            None => error.fail(),
        };
    }
    let listed = |name: &&String| !author.files.iter().any(|path| path.as_str() == name.as_str());
    if let Some(extra) = found.iter().find(listed) {
        let shown = printable(extra);
        if let Err(what) = EntryPath::new(extra) {
            return malformed("E-PACK-ENTRY", format!("'{shown}' in the folder {what}"))
                .help("rename or remove it")
                .fail();
        }
        let help = format!("add \"{shown}\" to 'files', or remove the file");
        return malformed("E-PACK-LIST", format!("'{shown}' is in the folder, but not in 'files'")).help(help).fail();
    }
    Ok(())
}

/// What stands beside a pack's files without being meant: builds, keys, runs, hidden files.
fn is_beside(name: &str, level: usize) -> bool {
    let top = level == 1 && matches!(name, AUTHOR_FILE | "runs" | "engine.lock");
    let ending = name.rsplit('.').next().unwrap_or_default();
    top || name.starts_with('.') || matches!(ending, "pack" | "minisig" | "key" | "pub")
}

fn walk(folder: &Path, prefix: &str, level: usize, found: &mut Vec<String>) -> Result<()> {
    let disk = |error: std::io::Error| Box::new(Diagnostic::disk("read the folder", folder, &error));
    let mut entries: Vec<_> = std::fs::read_dir(folder).map_err(disk)?.collect::<std::io::Result<_>>().map_err(disk)?;
    entries.sort_by_key(std::fs::DirEntry::file_name);
    for entry in entries {
        let file_name = entry.file_name();
        let name = file_name.to_string_lossy();
        if is_beside(&name, level) {
            continue;
        }
        let path = format!("{prefix}{name}");
        let kind = entry.file_type().map_err(disk)?;
        if kind.is_dir() && level < MAX_LEVELS {
            walk(&entry.path(), &format!("{path}/"), level + 1, found)?;
        } else if kind.is_file() {
            found.push(path);
        } else {
            let what = if kind.is_dir() { "is too deep" } else { "is no ordinary file" };
            return malformed("E-PACK-ENTRY", format!("'{}' in the folder {what}", printable(&path))).fail();
        }
    }
    Ok(())
}
