//! Where packs come from: a file, a folder, https, or an OCI registry. What arrives is a pack by its form; whether it is
//! trusted is asked afterwards.

use std::path::{Path, PathBuf};

use engine::diagnostic::{Diagnostic, Result, printable};
use pack::{Offer, PACK_ENDING, Pack, Signature};

use super::places::signature_of;

/// A pack that was fetched, with its signature if there is one.
pub(super) struct Fetched {
    pub(super) pack: Pack,
    pub(super) signature: Option<Signature>,
    /// The folder that it stood in, where what it builds on may stand too.
    pub(super) folder: Option<PathBuf>,
}

/// Fetches a pack; `name` chooses among those of a folder.
pub(super) fn fetch(source: &str, name: Option<&str>) -> Result<Fetched> {
    if source.contains("://") {
        if name.is_some() {
            let error = Diagnostic::new("E-PACK-ADDRESS", "--name chooses a pack of a folder");
            return error.help("write the whole address instead").fail();
        }
        return remote(source);
    }
    let path = Path::new(source);
    if path.is_dir() {
        let offers = offers_in(path)?;
        return load(&choose(path, &offers, name)?);
    }
    load(path)
}

/// Loads a pack's file and the signature beside it.
pub(super) fn load(path: &Path) -> Result<Fetched> {
    let folder = path.parent().map(|parent| if parent.as_os_str().is_empty() { Path::new(".") } else { parent });
    Ok(Fetched { pack: Pack::load(path)?, signature: signature_of(path)?, folder: folder.map(Path::to_owned) })
}

/// Every pack of a folder, in the order of the file names.
pub(super) fn offers_in(folder: &Path) -> Result<Vec<(PathBuf, Offer)>> {
    let disk = |error: std::io::Error| Box::new(Diagnostic::disk("read the folder", folder, &error));
    let entries = std::fs::read_dir(folder).map_err(disk)?.collect::<std::io::Result<Vec<_>>>().map_err(disk)?;
    let mut paths: Vec<PathBuf> = entries.iter().map(std::fs::DirEntry::path).collect();
    paths.retain(|path| path.extension().is_some_and(|ending| ending == PACK_ENDING) && path.is_file());
    paths.sort();
    let offer = |path: PathBuf| {
        let pack = Pack::load(&path).map_err(|mut error| {
            error.message = format!("'{}': {}", printable(&path.display().to_string()), error.message);
            error
        })?;
        Ok((path, Offer::of(&pack)))
    };
    paths.into_iter().map(offer).collect()
}

/// The highest version of what `name` means; without a name, of the only pack that there is.
fn choose(folder: &Path, offers: &[(PathBuf, Offer)], name: Option<&str>) -> Result<PathBuf> {
    let (wanted, version) = match name.map(|name| name.split_once('@').unwrap_or((name, ""))) {
        Some((name, version)) => (Some(name), version),
        None => (None, ""),
    };
    let fits = |offer: &Offer| {
        wanted.is_none_or(|name| offer.name.to_string() == name)
            && (version.is_empty() || offer.version.to_string() == version)
    };
    let mut fitting: Vec<&(PathBuf, Offer)> = offers.iter().filter(|(_, offer)| fits(offer)).collect();
    fitting.sort_by(|a, b| a.1.version.cmp(&b.1.version));
    let one_name = fitting.windows(2).all(|pair| pair[0].1.name == pair[1].1.name);
    match fitting.last() {
        Some((path, _)) if one_name => Ok(path.clone()),
        found => {
            let what = if found.is_some() { "more than one pack" } else { "no such pack" };
            let mut names: Vec<String> =
                offers.iter().map(|(_, offer)| format!("{}@{}", offer.name, offer.version)).collect();
            names.sort();
            let message = format!("the folder '{}' holds {what}", printable(&folder.display().to_string()));
            let error = Diagnostic::new("E-PACK-CHOICE", message);
            if names.is_empty() {
                error.fail()
            } else {
                error.help(format!("write --name with one of: {}", names.join(", "))).fail()
            }
        }
    }
}

#[cfg(feature = "share")]
fn remote(source: &str) -> Result<Fetched> {
    let (bytes, signature) = super::registry::fetch(source)?;
    let pack = Pack::parse(Path::new("pulled.pack"), bytes)?;
    let signature = signature.map(|text| Signature::parse(&text)).transpose()?;
    Ok(Fetched { pack, signature, folder: None })
}

#[cfg(not(feature = "share"))]
fn remote(source: &str) -> Result<Fetched> {
    Err(no_network(source))
}

/// This program was built without a network.
#[cfg(not(feature = "share"))]
pub(super) fn no_network(address: &str) -> Box<Diagnostic> {
    let message = format!("'{}' needs the network, which this program was built without", printable(address));
    let help = "build it with: cargo build --release --features share; files and folders always work";
    Box::new(Diagnostic::new("E-PACK-ADDRESS", message).help(help))
}
