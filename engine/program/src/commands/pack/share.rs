//! `engine pack push` and `pull`: a pack and its signature, to and from where others find them.

use std::path::{Path, PathBuf};

use engine::diagnostic::{Diagnostic, Result, printable};
use insight::disk::{is_there, write_atomic};
use insight::folder::create_folder;
use pack::{Pack, Signature};
use serde_json::json;

use super::fetch::fetch;
use super::places::{signature_of, signature_path};
use crate::cli::{PullArguments, PushArguments};
use crate::console::{Console, ConsoleError};

pub(super) fn push(arguments: &PushArguments, console: &mut Console) -> std::result::Result<u8, ConsoleError> {
    let pack = Pack::load(&arguments.pack)?;
    let signature = signature_of(&arguments.pack)?;
    if signature.is_none() && !arguments.allow_unsigned {
        let message = format!("{} is not signed, and nobody would install it", pack.title());
        let help = format!("sign it first: engine pack sign {}; or add --allow-unsigned", arguments.pack.display());
        return Err(Box::new(Diagnostic::new("E-TRUST-UNSIGNED", message).help(help)).into());
    }
    let place = if arguments.target.contains("://") {
        remote(&pack, signature.as_ref(), &arguments.target)?
    } else {
        store(&pack, signature.as_ref(), Path::new(&arguments.target))?.display().to_string()
    };
    console.json(&json!({ "name": pack.manifest().name, "version": pack.manifest().version, "blob": pack.blob(), "place": place }))?;
    console.line(&format!("pushed:    {} to {place}", pack.title()))?;
    Ok(0)
}

pub(super) fn pull(arguments: &PullArguments, console: &mut Console) -> std::result::Result<u8, ConsoleError> {
    let fetched = fetch(&arguments.source, arguments.name.as_deref())?;
    let blob = format!("sha256:{}", fetched.pack.blob());
    if let Some(wanted) = arguments.digest.as_ref().filter(|wanted| **wanted != blob) {
        let message = format!("{} has the digest {blob}, not {}", fetched.pack.title(), printable(wanted));
        return Err(Box::new(Diagnostic::new("E-TRUST-DIGEST", message).help("do not use this pack")).into());
    }
    let path = store(&fetched.pack, fetched.signature.as_ref(), &arguments.out)?;
    let signed = fetched.signature.as_ref().map(Signature::key_id);
    console.json(
        &json!({ "name": fetched.pack.manifest().name, "blob": fetched.pack.blob(), "file": path, "key_id": signed }),
    )?;
    console.line(&format!("pulled:    {} to {}", fetched.pack.title(), path.display()))?;
    let signed = signed.map_or("it has none".to_owned(), |id| format!("by key {id}, not verified yet"));
    console.line(&format!("signature: {signed}"))?;
    console.line(&format!("next:      engine pack install {}", path.display()))?;
    Ok(0)
}

/// Writes a pack and its signature into a folder, under the pack's own name.
fn store(pack: &Pack, signature: Option<&Signature>, folder: &Path) -> Result<PathBuf> {
    create_folder(folder)?;
    let path = folder.join(pack.manifest().file_name());
    let beside = signature_path(&path);
    write_atomic(&path, pack.bytes())?;
    match signature {
        Some(signature) => write_atomic(&beside, signature.text().as_bytes())?,
        // The signature of another build would make this one look changed.
        None if is_there(&beside)? => {
            std::fs::remove_file(&beside).map_err(|error| Box::new(Diagnostic::disk("remove", &beside, &error)))?;
        }
        None => {}
    }
    Ok(path)
}

#[cfg(feature = "share")]
fn remote(pack: &Pack, signature: Option<&Signature>, target: &str) -> Result<String> {
    super::registry::push(pack, signature, target)
}

#[cfg(not(feature = "share"))]
fn remote(_: &Pack, _: Option<&Signature>, target: &str) -> Result<String> {
    Err(super::fetch::no_network(target))
}
