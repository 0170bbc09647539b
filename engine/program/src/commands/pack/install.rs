//! `engine pack install`: verify, ask, put on the shelf, pin. Nothing of the pack runs.

use std::io::IsTerminal;
use std::path::{Path, PathBuf};

use engine::diagnostic::{Diagnostic, Result};
use pack::{Lock, Locked, Offer, Pack, Signature, Signer, resolve};
use serde_json::json;

use super::fetch::{Fetched, fetch, load, offers_in};
use super::inspect::key_shown;
use super::places::Places;
use crate::cli::InstallArguments;
use crate::console::{Console, ConsoleError};

/// A pack that may be installed.
struct Accepted {
    pack: Pack,
    signature: Option<Signature>,
    signer: Signer,
}

pub(super) fn install(arguments: &InstallArguments, console: &mut Console) -> std::result::Result<u8, ConsoleError> {
    let places = Places::find()?;
    let fetched = fetch(&arguments.source, arguments.name.as_deref())?;
    let folder = fetched.folder.clone();
    let held = places.hold()?;
    let mut accepted = vec![accept(fetched, &places, arguments, console)?];
    // Everything is accepted before anything is written.
    for dependency in dependencies(&accepted[0].pack, folder.as_deref(), &places, arguments)? {
        accepted.push(accept(dependency, &places, arguments, console)?);
    }
    let shelf = places.shelf();
    for Accepted { pack, signature, .. } in &accepted {
        shelf.put(pack, signature.as_ref())?;
    }
    let locked: Vec<Locked> = accepted.iter().map(|accepted| Locked::new(&accepted.pack, &accepted.signer)).collect();
    places.change(&held, |lock| locked.iter().for_each(|locked| lock.put(locked.clone())))?;
    console.json(&json!({ "installed": locked }))?;
    for locked in &locked {
        console.line(&format!(
            "installed: {} {}, key {}",
            locked.name,
            locked.version,
            key_shown(locked.key.as_deref())
        ))?;
    }
    console.line(&format!("next:      engine run {}", locked[0].name))?;
    Ok(0)
}

/// Everything that must hold before a pack is installed.
fn accept(fetched: Fetched, places: &Places, arguments: &InstallArguments, console: &Console) -> Result<Accepted> {
    let Fetched { pack, signature, .. } = fetched;
    let signer = places.trust()?.judge(&pack, signature.as_ref(), arguments.allow_unsigned)?;
    pack.manifest().check_engine()?;
    let (lock, index) = (places.lock()?, places.index()?);
    warn_of_lookalikes(&pack, &index, console);
    for known in [&lock, &index] {
        admit(known, &pack, &signer, arguments, console)?;
    }
    Ok(Accepted { pack, signature, signer })
}

fn admit(known: &Lock, pack: &Pack, signer: &Signer, arguments: &InstallArguments, console: &Console) -> Result<()> {
    let admitted = known.admit(pack, signer, &arguments.grant, arguments.allow_older);
    match admitted {
        Err(error) if error.code == "E-TRUST-CAPABILITY" && std::io::stdin().is_terminal() => {
            console.note(&format!("{}. Grant that? Type yes:", error.message));
            let mut answer = String::new();
            std::io::stdin()
                .read_line(&mut answer)
                .map_err(|error| Box::new(Diagnostic::disk("read", Path::new("standard input"), &error)))?;
            if answer.trim() == "yes" { Ok(()) } else { Err(error) }
        }
        other => other,
    }
}

/// Names that could be mistaken for one another are both shown; which one was meant, only the user knows.
fn warn_of_lookalikes(pack: &Pack, index: &Lock, console: &Console) {
    let name = &pack.manifest().name;
    for known in index.packs().iter().filter(|known| known.name.looks_like(name)) {
        console
            .note(&format!("warning: '{name}' looks like '{}', which is installed, but is another pack", known.name));
    }
}

/// The packs that a pack builds on and that are not installed yet, from beside it and from the folders that were named.
fn dependencies(
    pack: &Pack,
    beside: Option<&Path>,
    places: &Places,
    arguments: &InstallArguments,
) -> Result<Vec<Fetched>> {
    if pack.manifest().depends.is_empty() {
        return Ok(Vec::new());
    }
    let shelf = places.shelf();
    let mut files: Vec<(PathBuf, Offer)> = Vec::new();
    for folder in beside.into_iter().chain(arguments.from.iter().map(PathBuf::as_path)) {
        files.extend(offers_in(folder)?);
    }
    let mut offers: Vec<Offer> = files.iter().map(|(_, offer)| offer.clone()).collect();
    for locked in places.lock()?.packs().iter().chain(places.index()?.packs()) {
        // A pack that is pinned but gone from this machine is no offer.
        if let Ok(installed) = shelf.get(locked) {
            offers.push(Offer::of(&installed));
        }
    }
    let mut found = Vec::new();
    for chosen in resolve(&Offer::of(pack), &offers)? {
        if let Some((path, _)) = files.iter().find(|(_, offer)| offer.content == chosen.content) {
            found.push(load(path)?);
        } else if let Some(locked) =
            places.index()?.get(&chosen.name).cloned().or(places.lock()?.get(&chosen.name).cloned())
        {
            let (pack, signature) = (shelf.get(&locked)?, shelf.signature(locked.content)?);
            found.push(Fetched { pack, signature, folder: None });
        }
    }
    Ok(found)
}
