//! A folder to start a pack from: one that runs at once, or one around a script that is there already.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;

use semver::{Version, VersionReq};

use super::author::{AUTHOR_FILE, Author};
use super::bundle::read_limited;
use super::entry_path::EntryPath;
use super::runnable::inside;
use super::{Capabilities, Digest, MAX_PACK_BYTES, PackName, distrusted, malformed};
use engine::diagnostic::{Diagnostic, Result, printable};
use engine::experiment::{Overrides, Plan};
use engine::filter::{Catalogue, Form, Sources};
use engine::settings::Edition;
use engine::world::{FamilyRange, Layout};
use insight::disk::write_atomic;
use insight::store::with_policies;

const SCRIPT: &str = include_str!("../../../scripts/wall.rhai");
const WORLD: &str = include_str!("../../../worlds/room.toml");
const LICENSE: &str = include_str!("../../../LICENSE-MIT");

/// The files of a folder to be, by their names.
type Files = BTreeMap<String, Vec<u8>>;

/// Writes the folder of a new pack: `pack.toml`, the script, its world, a page about it and a licence. Without `from`, the
/// behaviour is wall following; with it, that script, its world, the policies that it combines, and the filters that it
/// uses from `sources`.
///
/// # Errors
/// If the folder is there already, the script is wrong, a native filter is not allowed, or a file cannot be written.
pub fn scaffold(name: &PackName, folder: &Path, from: Option<(&Path, Sources)>) -> Result<()> {
    if insight::disk::is_there(folder)? {
        let message = format!("'{}' is there already", printable(&folder.display().to_string()));
        return Diagnostic::new("E-PACK-FOLDER", message).help("choose another with --out FOLDER").fail();
    }
    let (mut files, mut capabilities) = (Files::new(), Capabilities::default());
    let world = match from {
        None => {
            files.insert(format!("scripts/{}.rhai", name.name()), SCRIPT.into());
            files.insert("worlds/room.toml".to_owned(), WORLD.into());
            None
        }
        Some((script, sources)) => {
            let plan = Plan::load(script, &Overrides::default(), || Catalogue::new(sources).map(Arc::new))?;
            capabilities = collect_filters(&plan, &mut files)?;
            collect(&plan, &mut files)?
        }
    };
    let script = files.keys().find(|path| path.ends_with(".rhai")).cloned().unwrap_or_default();
    let said = files.get(&script).map(|text| String::from_utf8_lossy(text).into_owned()).unwrap_or_default();
    files.insert("readme.md".to_owned(), readme(name, &script).into());
    files.insert("license".to_owned(), license(name).into());
    let author = Author {
        name: name.clone(),
        version: Version::new(0, 1, 0),
        engine: VersionReq::parse(concat!(">=", env!("CARGO_PKG_VERSION"))).unwrap_or(VersionReq::STAR),
        license: "MIT".to_owned(),
        description: description(name, &said),
        edition: Some(Edition::NEWEST.number()),
        script: own(&script)?,
        world: world.as_deref().map(own).transpose()?,
        certify: None,
        seeds: vec![1, 2, 3],
        files: files.keys().map(|path| own(path)).collect::<Result<_>>()?,
        capabilities,
        depends: Vec::new(),
    };
    let text = toml::to_string_pretty(&author)
        .map_err(|error| Box::new(malformed("E-PACK-FOLDER", format!("'{AUTHOR_FILE}' cannot be written: {error}"))))?;
    files.insert(AUTHOR_FILE.to_owned(), format!("{}\n{text}", note(name)).into());
    for (path, bytes) in &files {
        let path = folder.join(path);
        if let Some(parent) = path.parent() {
            std::fs::create_dir_all(parent)
                .map_err(|error| Box::new(Diagnostic::disk("create the folder", parent, &error)))?;
        }
        write_atomic(&path, bytes)?;
    }
    Ok(())
}

fn own(path: &str) -> Result<EntryPath> {
    EntryPath::new(path).map_err(|what| Box::new(malformed("E-PACK-ENTRY", format!("'{}' {what}", printable(path)))))
}

/// The filters of a script that are not part of the engine, and that the pack asks for them.
fn collect_filters(plan: &Plan, files: &mut Files) -> Result<Capabilities> {
    let mut capabilities = Capabilities::default();
    let names: BTreeSet<&str> =
        plan.settings.views().flat_map(|view| &view.filters).map(|filter| filter.name.as_str()).collect();
    for name in names {
        let entry = plan.filters.find(name)?;
        let Some(path) = &entry.path else { continue };
        let bytes = read_limited(path, MAX_PACK_BYTES)?;
        // The file that was tried, and for a native one allowed, is the file that is taken.
        if entry.sha256.as_deref() != Some(Digest::of(&bytes).to_string().as_str()) {
            let message = format!("'{}' changed while it was read", printable(&path.display().to_string()));
            return distrusted("E-TRUST-DIGEST", message).help("run the command again").fail();
        }
        let file = path.file_name().map(|file| file.to_string_lossy().into_owned()).unwrap_or_default();
        let place = format!("filters/{file}");
        let asked = match entry.form {
            Form::Native => &mut capabilities.native,
            Form::Wasm | Form::LinkedIn => &mut capabilities.filters_wasm,
        };
        asked.push(own(&place)?);
        files.insert(place, bytes);
    }
    Ok(capabilities)
}

/// The files of a script that is there, and its world if the script alone does not lead to it.
fn collect(plan: &Plan, files: &mut Files) -> Result<Option<String>> {
    let stem = plan.behaviour.name().to_lowercase();
    files.insert(format!("scripts/{stem}.rhai"), plan.behaviour.source().text.as_bytes().to_vec());
    // What is made by rule is made again where the pack runs.
    let of_file = |layout: &&Arc<Layout>| !matches!(FamilyRange::of(&layout.name), Some(Ok(_)));
    let place = |layout: &Layout| format!("worlds/{}.toml", layout.name.to_lowercase());
    for layout in plan.worlds.layouts().iter().filter(of_file) {
        files.insert(place(layout), layout.source.text.as_bytes().to_vec());
    }
    let world = place(&plan.layout);
    if let Some(body) = plan.behaviour.body()
        && let Some(name) = body.path.file_name()
    {
        files.insert(format!("robots/{}", name.to_string_lossy()), body.text.as_bytes().to_vec());
    }
    let with = with_policies(plan.clone())?;
    let combined = with.members.iter().map(|member| (&member.source, None));
    let texts = combined.chain(with.used.iter().map(|used| (&used.texts[0], Some(&used.texts[1]))));
    for ((text, run), policy) in texts.zip(&plan.settings.policies) {
        let Some(path) = inside("scripts", policy.path.trim_end_matches("policy.toml")) else {
            let message = format!("the policy '{}' stands outside the pack", printable(&policy.path));
            return malformed("E-PACK-POLICY", message).help("name it by a path below the script's folder").fail();
        };
        files.insert(format!("{path}/policy.toml"), text.text.as_bytes().to_vec());
        if let Some(run) = run {
            files.insert(format!("{path}/run.toml"), run.text.as_bytes().to_vec());
        }
    }
    if !plan.worlds.further().is_empty() || !files.contains_key(&world) {
        return Ok(None);
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
