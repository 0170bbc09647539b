//! Where installed packs stand: one folder for each, named by its digest, read-only, there whole or not at all.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use super::bundle::read_limited;
use super::manifest::{FILE, Manifest};
use super::{Digest, Locked, MAX_MANIFEST_BYTES, MAX_PACK_BYTES, Pack, Signature, archive, distrusted};
use engine::diagnostic::{Diagnostic, Result, SourceText};
use insight::disk::{Lock, is_there, write_atomic};

/// How the names of folders begin that are not whole yet.
const STAGING: &str = ".staging-";

/// The folder of installed packs.
#[derive(Debug, Clone)]
pub struct Shelf {
    root: PathBuf,
}

impl Shelf {
    /// The shelf in a user's data folder; nothing is created yet.
    #[must_use]
    pub fn new(data: &Path) -> Self {
        Self { root: data.join("store") }
    }

    /// The folder of a pack, whether it is there or not.
    #[must_use]
    pub fn folder(&self, content: Digest) -> PathBuf {
        self.root.join(content.to_string())
    }

    /// Puts a pack on the shelf. Its files are written to a staging folder beside it, which then takes its name.
    ///
    /// # Errors
    /// If a file cannot be written; nothing is left of the pack then.
    pub fn put(&self, pack: &Pack, signature: Option<&Signature>) -> Result<()> {
        let folder = self.folder(pack.content());
        create(&self.root)?;
        let _lock = Lock::take(&self.root)?;
        self.sweep();
        if !is_there(&folder)? {
            let staging = tempfile::Builder::new().prefix(STAGING).tempdir_in(&self.root);
            let staging = staging.map_err(|error| Box::new(Diagnostic::disk("write", &folder, &error)))?.keep();
            let written = stage(&staging, pack).and_then(|()| {
                fs::rename(&staging, &folder).map_err(|error| Box::new(Diagnostic::disk("write", &folder, &error)))
            });
            if let Err(error) = written {
                // The first error is the one to tell.
                drop(discard(&staging));
                return Err(error);
            }
        }
        match signature {
            Some(signature) => write_atomic(&self.signature_path(pack.content()), signature.text().as_bytes()),
            None => Ok(()),
        }
    }

    /// Takes a pack from the shelf, checked again: every byte is the one that the lock pins.
    ///
    /// # Errors
    /// `E-PACK-MISSING` if it is not there, `E-TRUST-DIGEST` if anything in it changed.
    pub fn get(&self, locked: &Locked) -> Result<Pack> {
        let folder = self.folder(locked.content);
        let title = format!("{} {}", locked.name, locked.version);
        if !is_there(&folder.join(FILE))? {
            let message = format!("{title} is locked, but not installed on this machine");
            let help =
                format!("install it again: engine pack install {}-{}.pack", locked.name.file_stem(), locked.version);
            return super::malformed("E-PACK-MISSING", message).help(help).fail();
        }
        let changed = || {
            let message = format!("the installed {title} is not what was locked: its files changed");
            Box::new(
                distrusted("E-TRUST-DIGEST", message)
                    .help(format!("engine pack remove {}, then install it again", locked.name)),
            )
        };
        let text = read_limited(&folder.join(FILE), MAX_MANIFEST_BYTES)?;
        if Digest::of(&text) != locked.content {
            return Err(changed());
        }
        let source = SourceText::new(FILE, String::from_utf8(text.clone()).map_err(|_| changed())?);
        let manifest = Manifest::parse(&source)?;
        let mut files = vec![(FILE.to_owned(), text)];
        for line in &manifest.files {
            let path = folder.join(line.path.as_str());
            files.push((line.path.to_string(), read_limited(&path, MAX_PACK_BYTES).map_err(|_| changed())?));
        }
        let mut bytes = Vec::new();
        let files = files.iter().map(|(path, bytes)| (path.as_str(), bytes.as_slice()));
        archive::write(files, &mut bytes).map_err(|_| changed())?;
        // The form is canonical, so the file that was installed comes out again, and its digest can be asked for.
        if Digest::of(&bytes) != locked.blob {
            return Err(changed());
        }
        Pack::parse(Path::new(&manifest.file_name()), bytes)
    }

    /// The signature that a pack was installed with.
    ///
    /// # Errors
    /// If there is one that cannot be read.
    pub fn signature(&self, content: Digest) -> Result<Option<Signature>> {
        let path = self.signature_path(content);
        if !is_there(&path)? {
            return Ok(None);
        }
        let bytes = read_limited(&path, MAX_MANIFEST_BYTES)?;
        Signature::parse(&String::from_utf8_lossy(&bytes)).map(Some)
    }

    /// Removes a pack from the shelf.
    ///
    /// # Errors
    /// If it cannot be removed.
    pub fn remove(&self, content: Digest) -> Result<()> {
        create(&self.root)?;
        let _lock = Lock::take(&self.root)?;
        let signature = self.signature_path(content);
        if is_there(&signature)? {
            fs::remove_file(&signature).map_err(|error| Box::new(Diagnostic::disk("remove", &signature, &error)))?;
        }
        let folder = self.folder(content);
        if is_there(&folder)? { discard(&folder) } else { Ok(()) }
    }

    /// Removes what killed installations left: their files are read-only, their folders are not.
    fn sweep(&self) {
        for entry in fs::read_dir(&self.root).into_iter().flatten().flatten() {
            if entry.file_name().to_string_lossy().starts_with(STAGING) {
                drop(discard(&entry.path()));
            }
        }
    }

    fn signature_path(&self, content: Digest) -> PathBuf {
        self.root.join(format!("{content}.minisig"))
    }
}

fn stage(staging: &Path, pack: &Pack) -> Result<()> {
    for (path, bytes) in pack.files() {
        let path = staging.join(path);
        let disk = |error: std::io::Error| Box::new(Diagnostic::disk("write", &path, &error));
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder).map_err(disk)?;
        }
        let mut file = fs::File::create_new(&path).map_err(disk)?;
        file.write_all(bytes).and_then(|()| file.sync_all()).map_err(disk)?;
        let mut permissions = file.metadata().map_err(disk)?.permissions();
        permissions.set_readonly(true);
        file.set_permissions(permissions).map_err(disk)?;
    }
    Ok(())
}

fn create(folder: &Path) -> Result<()> {
    fs::create_dir_all(folder).map_err(|error| Box::new(Diagnostic::disk("create the folder", folder, &error)))
}

fn discard(folder: &Path) -> Result<()> {
    fs::remove_dir_all(folder).map_err(|error| Box::new(Diagnostic::disk("remove", folder, &error)))
}
