//! A folder to start a pack from: one that runs at once, or one around a script that is there already.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use semver::{Version, VersionReq};

use super::author::{AUTHOR_FILE, Author};
use super::entry_path::EntryPath;
use super::runnable::inside;
use super::{Capabilities, PackName, malformed};
use crate::diagnostic::{Diagnostic, Kind, Result, printable};
use crate::experiment::{Overrides, Plan};
use crate::report::write_atomic;
use crate::reward::Behaviour;
use crate::store::load_members;

const SCRIPT: &str = include_str!("../../../scripts/wall.rhai");
const WORLD: &str = include_str!("../../../worlds/room.toml");
const LICENSE: &str = include_str!("../../../LICENSE-MIT");

/// Writes the folder of a new pack: `pack.toml`, the script, its world, a page about it and a licence. Without `from`, the
/// behaviour is wall following; with it, that script, its world and the policies that it combines.
///
/// # Errors
/// If the folder is there already, the script is wrong, or a file cannot be written.
pub fn scaffold(name: &PackName, folder: &Path, from: Option<&Path>) -> Result<()> {
    if folder.exists() {
        let message = format!("'{}' is there already", printable(&folder.display().to_string()));
        return Diagnostic::new(Kind::Usage, "E-PACK-FOLDER", message).help("choose another with --out FOLDER").into();
    }
    let mut files = BTreeMap::new();
    let world = match from {
        None => {
            files.insert(format!("scripts/{}.rhai", name.name()), SCRIPT.to_owned());
            files.insert("worlds/room.toml".to_owned(), WORLD.to_owned());
            None
        }
        Some(script) => collect(script, &mut files)?,
    };
    let script = files.keys().find(|path| path.ends_with(".rhai")).cloned().unwrap_or_default();
    files.insert("readme.md".to_owned(), readme(name, &script));
    files.insert("license".to_owned(), license(name));
    let own = |path: &str| {
        EntryPath::new(path)
            .map_err(|what| Box::new(malformed("E-PACK-ENTRY", format!("'{}' {what}", printable(path)))))
    };
    let author = Author {
        name: name.clone(),
        version: Version::new(0, 1, 0),
        engine: VersionReq::parse(concat!(">=", env!("CARGO_PKG_VERSION"))).unwrap_or(VersionReq::STAR),
        license: "MIT".to_owned(),
        description: description(name, files.get(&script).map_or("", String::as_str)),
        script: own(&script)?,
        world: world.as_deref().map(own).transpose()?,
        seeds: vec![1, 2, 3],
        files: files.keys().map(|path| own(path)).collect::<Result<_>>()?,
        capabilities: Capabilities::default(),
        depends: Vec::new(),
    };
    let text = toml::to_string_pretty(&author)
        .map_err(|error| Box::new(malformed("E-PACK-FOLDER", format!("'{AUTHOR_FILE}' cannot be written: {error}"))))?;
    files.insert(AUTHOR_FILE.to_owned(), format!("{}\n{text}", note(name)));
    for (path, text) in &files {
        let path = folder.join(path);
        if let Some(parent) = path.parent() {
            std::fs::create_dir_all(parent)
                .map_err(|error| Box::new(Diagnostic::disk("create the folder", parent, &error)))?;
        }
        write_atomic(&path, text.as_bytes())?;
    }
    Ok(())
}

/// The files of a script that is there, and its world if the script alone does not lead to it.
fn collect(script: &Path, files: &mut BTreeMap<String, String>) -> Result<Option<String>> {
    let plan = Plan::new(Arc::new(Behaviour::load(script)?), &Overrides::default())?;
    let stem = plan.behaviour.name().to_lowercase();
    files.insert(format!("scripts/{stem}.rhai"), plan.behaviour.source().text.to_string());
    let world = format!("worlds/{}.toml", plan.layout.name.to_lowercase());
    files.insert(world.clone(), plan.layout.source.text.to_string());
    if !plan.settings.policies.is_empty() {
        for (member, policy) in load_members(&plan)?.iter().zip(&plan.settings.policies) {
            let Some(path) = inside("scripts", policy.path.trim_end_matches("policy.toml")) else {
                let message = format!("the policy '{}' stands outside the pack", printable(&policy.path));
                return malformed("E-PACK-POLICY", message).help("name it by a path below the script's folder").into();
            };
            files.insert(format!("{path}/policy.toml"), member.source.text.to_string());
        }
    }
    let named = &plan.settings.world;
    Ok((named.contains('/') || named.ends_with(".toml") || *named != plan.layout.name.to_lowercase()).then_some(world))
}

/// The first sentence of the script's first comment, if it has a good length.
fn description(name: &PackName, script: &str) -> String {
    let comment: Vec<&str> = script.lines().map_while(|line| line.strip_prefix("//")).map(str::trim).collect();
    let comment = comment.join(" ");
    let said = comment.split_once(".rhai: ").map_or(comment.as_str(), |(_, said)| said);
    let said = said.split(". ").next().unwrap_or_default().trim().trim_end_matches('.');
    let fine = (10..=150).contains(&said.len()) && !said.chars().any(char::is_control);
    if fine { said.to_owned() } else { format!("The behaviour '{}'", name.name()) }
}

fn note(name: &PackName) -> String {
    format!(
        "# The pack {name}. Every file that goes into it stands under 'files'; the manifest is made from this page.\n\
         #   engine run .          learn it\n\
         #   engine pack check .   is it ready?\n\
         #   engine pack build .   make the pack\n"
    )
}

fn readme(name: &PackName, script: &str) -> String {
    format!(
        "# {name}\n\nWhat the robot learns, in which world, and what is punished: say it here. The behaviour is `{script}`.\n"
    )
}

/// The licence's text with the pack's owner in the line of the copyright.
fn license(name: &PackName) -> String {
    let line = |line: &str| {
        if line.starts_with("Copyright") { format!("Copyright (c) {}", name.owner()) } else { line.to_owned() }
    };
    LICENSE.lines().map(line).collect::<Vec<_>>().join("\n") + "\n"
}
