//! `engine.lock`: which packs a folder uses, byte for byte, by whose key, and what they were granted.

use std::path::Path;

use semver::Version;
use serde::{Deserialize, Serialize};

use super::manifest::toml_error;
use super::{Digest, MAX_MANIFEST_BYTES, Pack, PackName, Signer, bundle, distrusted, malformed};
use engine::diagnostic::{Diagnostic, Result, SourceText, nearest_name, printable};
use insight::disk::{is_there, write_atomic};

/// The format of the file.
const FORMAT: u32 = 1;

/// The packs of a folder, or of a user.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lock {
    format: u32,
    #[serde(rename = "pack", default)]
    packs: Vec<Locked>,
}

/// One pack, pinned.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Locked {
    /// Its name.
    pub name: PackName,
    /// Its version.
    pub version: Version,
    /// The digest of its file.
    pub blob: Digest,
    /// The digest of its manifest.
    pub content: Digest,
    /// The public key that signed it; absent if it is unsigned.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub key: Option<String>,
    /// What it was granted.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub granted: Vec<String>,
}

impl Locked {
    /// The line of a pack that was accepted.
    #[must_use]
    pub fn new(pack: &Pack, signer: &Signer) -> Self {
        let manifest = pack.manifest();
        Self {
            name: manifest.name.clone(),
            version: manifest.version.clone(),
            blob: pack.blob(),
            content: pack.content(),
            key: signer.key().map(str::to_owned),
            granted: manifest.capabilities.lines(),
        }
    }
}

impl Default for Lock {
    fn default() -> Self {
        Self { format: FORMAT, packs: Vec::new() }
    }
}

impl Lock {
    /// Reads a lock; without a file, an empty one.
    ///
    /// # Errors
    /// If the file is there but cannot be read, or is wrong.
    pub fn load(path: &Path) -> Result<Self> {
        if !is_there(path)? {
            return Ok(Self::default());
        }
        let wrong = |what: &str| {
            Box::new(malformed("E-PACK-LOCK", format!("'{}' {what}", printable(&path.display().to_string()))))
        };
        let text = bundle::read_limited(path, MAX_MANIFEST_BYTES)?;
        let text = String::from_utf8(text).map_err(|_| wrong("is not text in UTF-8"))?;
        let source = SourceText::new(path, text);
        let lock: Self = toml::from_str(&source.text).map_err(|error| toml_error(&source, &error))?;
        if lock.format != FORMAT {
            return Err(wrong(&format!("has format {}, this engine reads format {FORMAT}", lock.format)));
        }
        Ok(lock)
    }

    /// Writes the lock.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn save(&self, path: &Path) -> Result<()> {
        let text = toml::to_string(self)
            .map_err(|error| Box::new(Diagnostic::new("E-IO", format!("the lock cannot be written: {error}"))))?;
        let note = "# Written by 'engine pack install'. Keep it with your work: it pins every pack, byte for byte.\n";
        write_atomic(path, format!("{note}{text}").as_bytes())
    }

    /// Every pack, in the order of the names.
    #[must_use]
    pub fn packs(&self) -> &[Locked] {
        &self.packs
    }

    /// The pack of a full name.
    #[must_use]
    pub fn get(&self, name: &PackName) -> Option<&Locked> {
        self.packs.iter().find(|locked| locked.name == *name)
    }

    /// The pack that a user means by `ada/wall`, or by `wall` if only one owner has a pack of that name.
    ///
    /// # Errors
    /// `E-PACK-NAME` if none or more than one is meant.
    pub fn find(&self, text: &str) -> Result<&Locked> {
        let full: Vec<String> = self.packs.iter().map(|locked| locked.name.to_string()).collect();
        let is_meant = |locked: &&Locked| locked.name.to_string() == text || locked.name.name() == text;
        let meant: Vec<&Locked> = self.packs.iter().filter(is_meant).collect();
        let wrong = |message: String, help: String| Err(Box::new(malformed("E-PACK-NAME", message).help(help)));
        match meant[..] {
            [locked] => Ok(locked),
            [] => {
                let message = format!("no pack '{}' is installed", printable(text));
                match nearest_name(text, full.iter().map(String::as_str)) {
                    Some(near) => wrong(message, format!("did you mean '{near}'?")),
                    None if full.is_empty() => wrong(message, "get one with: engine pack install FILE.pack".to_owned()),
                    None => wrong(message, format!("there are: {}", full.join(", "))),
                }
            }
            _ => {
                let names: Vec<String> = meant.iter().map(|locked| locked.name.to_string()).collect();
                wrong(
                    format!("'{}' is more than one pack", printable(text)),
                    format!("write one of: {}", names.join(", ")),
                )
            }
        }
    }

    /// Checks that a pack may take the place of what is locked: the same key, no lower version, nothing new asked for that
    /// is not in `granted`.
    ///
    /// # Errors
    /// `E-TRUST-KEY-CHANGED`, `E-TRUST-VERSION`, `E-TRUST-DIGEST` or `E-TRUST-CAPABILITY`: each says what to type.
    pub fn admit(&self, pack: &Pack, signer: &Signer, granted: &[String], allow_older: bool) -> Result<()> {
        let manifest = pack.manifest();
        let before = self.get(&manifest.name);
        if let Some(before) = before {
            self.check_change(before, pack, signer, allow_older)?;
        }
        let old = before.map_or(&[][..], |before| &before.granted);
        let asked = manifest.capabilities.lines();
        let new: Vec<&String> = asked.iter().filter(|line| !old.contains(line) && !granted.contains(line)).collect();
        if new.is_empty() {
            return Ok(());
        }
        let message = format!("{} asks for what it was not granted: {}", pack.title(), join(&new));
        let flags: Vec<String> = new.iter().map(|line| format!("--grant {line}")).collect();
        let help = format!("if you want that: engine pack install, with {}", flags.join(" "));
        distrusted("E-TRUST-CAPABILITY", message).help(help).fail()
    }

    fn check_change(&self, before: &Locked, pack: &Pack, signer: &Signer, allow_older: bool) -> Result<()> {
        let name = &before.name;
        let same_signer = before.key.as_deref() == signer.key();
        if !same_signer && !before.key.as_deref().is_some_and(|key| signer.took_over(key)) {
            let message = format!("{} is not signed by the key that signed {name} {}", pack.title(), before.version);
            let help = format!("ask '{}' over another way; to start anew: engine pack remove {name}", name.owner());
            return distrusted("E-TRUST-KEY-CHANGED", message).help(help).fail();
        }
        let version = &pack.manifest().version;
        if *version < before.version && !allow_older {
            let message = format!("{} is older than version {}, which is installed", pack.title(), before.version);
            return distrusted("E-TRUST-VERSION", message).help("if you want that, add: --allow-older").fail();
        }
        if *version == before.version && pack.blob() != before.blob {
            let message = format!("{} is not the same as the {name} {version} that is installed", pack.title());
            let help = format!("a version never changes; to start anew: engine pack remove {name}");
            return distrusted("E-TRUST-DIGEST", message).help(help).fail();
        }
        Ok(())
    }

    /// Puts a pack in, in the place of another of its name.
    pub fn put(&mut self, locked: Locked) {
        self.packs.retain(|other| other.name != locked.name);
        self.packs.push(locked);
        self.packs.sort_by(|a, b| a.name.cmp(&b.name));
    }

    /// Takes a pack out.
    pub fn take(&mut self, name: &PackName) {
        self.packs.retain(|locked| locked.name != *name);
    }
}

fn join(lines: &[&String]) -> String {
    lines.iter().map(|line| line.as_str()).collect::<Vec<_>>().join(", ")
}
