//! Where packs, locks and trusted keys stand for this user and this folder.

use std::path::{Path, PathBuf};

use engine::diagnostic::{Diagnostic, Result, printable};
use insight::disk;
use insight::folder::create_folder;
use pack::{Dependency, Lock, Locked, Pack, Shelf, Signature, TrustStore};

/// The lock of the folder where the user stands.
const LOCK: &str = "engine.lock";

/// The right to change what is installed, until it is dropped.
pub(super) struct Held {
    _locks: [disk::Lock; 2],
}

/// The user's folders.
#[derive(Debug, Clone)]
pub(in crate::commands) struct Places {
    config: PathBuf,
    data: PathBuf,
}

impl Places {
    /// From ENGINE_CONFIG_DIR and ENGINE_DATA_DIR, or the usual places.
    pub(in crate::commands) fn find() -> Result<Self> {
        let config = folder("ENGINE_CONFIG_DIR", "XDG_CONFIG_HOME", ".config")?;
        Ok(Self { config, data: folder("ENGINE_DATA_DIR", "XDG_DATA_HOME", ".local/share")? })
    }

    pub(in crate::commands) fn trust(&self) -> Result<TrustStore> {
        TrustStore::load(&self.trust_path())
    }

    pub(super) fn trust_path(&self) -> PathBuf {
        self.config.join("trust.toml")
    }

    pub(in crate::commands) fn shelf(&self) -> Shelf {
        Shelf::new(&self.data)
    }

    /// The lock of this folder.
    pub(super) fn lock(&self) -> Result<Lock> {
        Lock::load(Path::new(LOCK))
    }

    /// Every pack that the user installed, in whichever folder.
    pub(in crate::commands) fn index(&self) -> Result<Lock> {
        Lock::load(&self.data.join(LOCK))
    }

    /// Keeps other processes from changing the lock of this folder and the list of all installed packs.
    pub(super) fn hold(&self) -> Result<Held> {
        create_folder(&self.data)?;
        Ok(Held { _locks: [disk::Lock::take(&self.data.join(LOCK))?, disk::Lock::take(Path::new(LOCK))?] })
    }

    /// Keeps other processes from changing whom the user trusts.
    pub(super) fn hold_trust(&self) -> Result<disk::Lock> {
        create_folder(&self.config)?;
        disk::Lock::take(&self.trust_path())
    }

    /// An installed pack, judged as if it were installed now: its bytes by the lock, its signature by whom the user trusts.
    pub(in crate::commands) fn open(&self, locked: &Locked) -> Result<Pack> {
        let (shelf, pack) = (self.shelf(), self.shelf().get(locked)?);
        let signer = self.trust()?.judge(&pack, shelf.signature(locked.content)?.as_ref(), locked.key.is_none())?;
        if signer.key() == locked.key.as_deref() {
            return Ok(pack);
        }
        let message = format!("the installed {} is not signed by the key that it was installed with", pack.title());
        let help = format!(
            "ask '{}' over another way; to start anew: engine pack remove {}",
            locked.name.owner(),
            locked.name
        );
        Diagnostic::new("E-TRUST-KEY-CHANGED", message).help(help).fail()
    }

    /// Changes the lock of this folder and the list of all installed packs alike, which nobody else may meanwhile.
    pub(super) fn change(&self, _held: &Held, change: impl Fn(&mut Lock)) -> Result<()> {
        let (mut index, mut lock) = (self.index()?, self.lock()?);
        change(&mut index);
        change(&mut lock);
        index.save(&self.data.join(LOCK))?;
        lock.save(Path::new(LOCK))
    }

    /// The pack of a name: the one that this folder pins, or else the one that was installed last. Nothing if no pack has
    /// that name or one that is near: then something else was meant.
    pub(in crate::commands) fn locked(&self, text: &str) -> Result<Option<Locked>> {
        if let Ok(locked) = self.lock()?.find(text) {
            return Ok(Some(locked.clone()));
        }
        let index = self.index()?;
        match index.find(text) {
            Ok(locked) => Ok(Some(locked.clone())),
            Err(error)
                if error.help.as_ref().is_some_and(|help| help.starts_with("there are") || help.starts_with("get")) =>
            {
                Ok(None)
            }
            Err(error) => Err(error),
        }
    }

    /// The installed pack that a pack builds on, as it is locked.
    pub(in crate::commands) fn dependency(&self, pack: &Pack, dependency: &Dependency) -> Result<Pack> {
        let (lock, index) = (self.lock()?, self.index()?);
        let fits = |locked: &&Locked| dependency.version.matches(&locked.version);
        match lock.get(&dependency.name).or_else(|| index.get(&dependency.name)).filter(fits) {
            Some(locked) => self.open(locked),
            None => {
                let message = format!(
                    "{} builds on {} {}, which is not installed",
                    pack.title(),
                    dependency.name,
                    dependency.version
                );
                let help = "install that pack first: engine pack install FILE.pack";
                Diagnostic::new("E-PACK-DEPENDS", message).help(help).fail()
            }
        }
    }
}

fn folder(own: &str, shared: &str, usual: &str) -> Result<PathBuf> {
    let variable = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    let found = variable(own)
        .or_else(|| variable(shared).map(|folder| folder.join("engine")))
        .or_else(|| variable("HOME").map(|home| home.join(usual).join("engine")));
    found.ok_or_else(|| {
        let message = format!("there is no folder for packs: neither {own} nor HOME is set");
        Box::new(Diagnostic::new("E-PACK-HOME", message).help(format!("set {own} to a folder")))
    })
}

/// The path of the signature beside a pack's file.
pub(super) fn signature_path(pack: &Path) -> PathBuf {
    let mut name = pack.as_os_str().to_owned();
    name.push(".minisig");
    PathBuf::from(name)
}

/// The signature beside a pack's file, if there is one.
pub(in crate::commands) fn signature_of(pack: &Path) -> Result<Option<Signature>> {
    let path = signature_path(pack);
    if !disk::is_there(&path)? {
        return Ok(None);
    }
    read_text(&path).and_then(|text| Signature::parse(&text)).map(Some)
}

/// The text of a small file: a key or a signature.
pub(super) fn read_text(path: &Path) -> Result<String> {
    let bytes = pack::read_small(path)?;
    String::from_utf8(bytes).map_err(|_| {
        let message = format!("'{}' is not text", path.display());
        Box::new(Diagnostic::new("E-PACK-FILE", message))
    })
}

/// A public key as it was typed: itself, or the file that holds it.
pub(super) fn public_key(text: &str) -> Result<String> {
    let path = Path::new(text);
    if path.is_file() {
        return pack::key_line(&read_text(path)?);
    }
    // A key begins with RW; whatever looks like a name of a file is one.
    if !text.starts_with("RW") && (path.extension().is_some() || text.contains('/')) {
        let message = format!("there is no key file '{}'", printable(text));
        let help = "give the author's public key: its file, or its line that begins with RW";
        return Diagnostic::new("E-PACK-KEY", message).help(help).fail();
    }
    pack::key_line(text)
}
