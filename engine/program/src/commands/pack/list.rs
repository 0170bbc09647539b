//! `engine pack list` and `remove`: what is installed.

use std::path::Path;

use engine::diagnostic::Result;
use insight::disk::write_atomic;
use insight::folder::create_folder;
use pack::{Card, Locked, Pack, Signature, gallery, signature_line};
use serde_json::json;

use super::fetch::{load, offers_in};
use super::inspect::key_shown;
use super::places::Places;
use crate::cli::{ListArguments, RemoveArguments};
use crate::console::{Console, ConsoleError};

/// A pack of the list.
struct ListedPack {
    pack: Pack,
    signature: Option<Signature>,
}

pub(super) fn list(arguments: &ListArguments, console: &mut Console) -> std::result::Result<u8, ConsoleError> {
    let places = Places::find()?;
    let listed = match &arguments.from {
        Some(folder) => in_folder(folder)?,
        None => installed(&places)?,
    };
    let trust = places.trust()?;
    let mut rows = Vec::new();
    let mut cards = Vec::new();
    for ListedPack { pack, signature } in &listed {
        let signed = signature_line(&trust, pack, signature.as_ref());
        let manifest = pack.manifest();
        rows.push(json!({
            "name": manifest.name, "version": manifest.version, "description": manifest.description,
            "content": pack.content(), "signature": signed.text, "trusted": signed.trusted,
        }));
        console.line(&format!("{:32} {}", pack.title(), signed.text))?;
        cards.push(Card { pack, signed });
    }
    if listed.is_empty() {
        console.line("there are no packs; get one with: engine pack install FILE.pack")?;
    }
    console.json(&rows)?;
    if let Some(folder) = &arguments.gallery {
        create_folder(folder)?;
        let path = folder.join("index.html");
        write_atomic(&path, gallery(&cards).as_bytes())?;
        console.line(&format!("gallery:   {}", path.display()))?;
    }
    Ok(0)
}

fn in_folder(folder: &Path) -> Result<Vec<ListedPack>> {
    let offers = offers_in(folder)?;
    let listed =
        |path: &Path| load(path).map(|fetched| ListedPack { pack: fetched.pack, signature: fetched.signature });
    offers.iter().map(|(path, _)| listed(path)).collect()
}

fn installed(places: &Places) -> Result<Vec<ListedPack>> {
    let shelf = places.shelf();
    let listed =
        |locked: &Locked| Ok(ListedPack { pack: shelf.get(locked)?, signature: shelf.signature(locked.content)? });
    places.index()?.packs().iter().map(listed).collect()
}

pub(super) fn remove(arguments: &RemoveArguments, console: &mut Console) -> std::result::Result<u8, ConsoleError> {
    let places = Places::find()?;
    let held = places.hold()?;
    let (lock, index) = (places.lock()?, places.index()?);
    let named = index.find(&arguments.name).or_else(|error| lock.find(&arguments.name).map_err(|_| error))?;
    let (name, shelf) = (named.name.clone(), places.shelf());
    for locked in [lock.get(&name), index.get(&name)].into_iter().flatten() {
        shelf.remove(locked.content)?;
    }
    places.change(&held, |lock| lock.take(&name))?;
    console.json(&json!({ "removed": name }))?;
    console.line(&format!("removed:   {name} {}, key {}", named.version, key_shown(named.key.as_deref())))?;
    Ok(0)
}
