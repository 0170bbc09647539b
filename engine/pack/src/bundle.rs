//! A pack that has been read: the bytes, the manifest, and that they agree.

use std::collections::BTreeMap;
use std::io::Read;
use std::ops::Range;
use std::path::{Path, PathBuf};

use super::manifest::FILE;
use super::{Digest, MAX_PACK_BYTES, Manifest, archive, distrusted, malformed};
use engine::diagnostic::{Diagnostic, Result, SourceText, printable};

/// A pack whose form is right: harmless names, and exactly the files of its manifest. Who made it is another question.
#[derive(Debug, Clone)]
pub struct Pack {
    manifest: Manifest,
    bytes: Vec<u8>,
    files: BTreeMap<String, Range<usize>>,
    blob: Digest,
    content: Digest,
    origin: PathBuf,
}

impl Pack {
    /// Reads a pack's file.
    ///
    /// # Errors
    /// If it cannot be read, is larger than 64 MiB, or is no pack.
    pub fn load(path: &Path) -> Result<Self> {
        Self::parse(path, read_limited(path, MAX_PACK_BYTES)?)
    }

    /// Reads a pack from its bytes; errors in its files name them under `origin`.
    ///
    /// # Errors
    /// `E-PACK-...` for a wrong form, `E-TRUST-DIGEST` for a file that the manifest does not mean.
    pub fn parse(origin: &Path, bytes: Vec<u8>) -> Result<Self> {
        let entries = archive::read(&bytes)?;
        let files: BTreeMap<String, Range<usize>> =
            entries.into_iter().map(|entry| (entry.path.to_string(), entry.range)).collect();
        let text = &bytes[files.get(FILE).cloned().unwrap_or(0..0)];
        let content = Digest::of(text);
        let text = std::str::from_utf8(text)
            .map_err(|_| Box::new(malformed("E-PACK-MANIFEST", "the manifest is not text in UTF-8")))?;
        let manifest = Manifest::parse(&SourceText::new(origin.join(FILE), text))?;
        let blob = Digest::of(&bytes);
        let pack = Self { manifest, bytes, files, blob, content, origin: origin.to_owned() };
        pack.check_files()?;
        Ok(pack)
    }

    /// The list of the manifest and the files are the same, byte for byte.
    fn check_files(&self) -> Result<()> {
        let listed = |path: &str| self.manifest.files.iter().any(|line| line.path.as_str() == path);
        if self.files.len() != self.manifest.files.len() + 1
            && let Some(extra) = self.files.keys().find(|path| *path != FILE && !listed(path))
        {
            return malformed("E-PACK-LIST", format!("the pack holds '{extra}', which its manifest does not list"))
                .fail();
        }
        for line in &self.manifest.files {
            let Some(bytes) = self.file(line.path.as_str()) else {
                let message = format!("the manifest lists '{}', which the pack does not hold", line.path);
                return malformed("E-PACK-LIST", message).fail();
            };
            if bytes.len() as u64 != line.size {
                let message = format!("'{}' has {} bytes, its manifest says {}", line.path, bytes.len(), line.size);
                return malformed("E-PACK-LIST", message).fail();
            }
            if Digest::of(bytes) != line.sha256 {
                let message = format!("'{}' is not the file that the manifest means: its digest differs", line.path);
                return distrusted("E-TRUST-DIGEST", message).help("get the pack again").fail();
            }
            check_magic(line.path.as_str(), bytes)?;
        }
        Ok(())
    }

    /// What the pack says of itself.
    #[must_use]
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// The whole file.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// The digest of the whole file.
    #[must_use]
    pub fn blob(&self) -> Digest {
        self.blob
    }

    /// The digest of the manifest, which pins every file: the pack's identity.
    #[must_use]
    pub fn content(&self) -> Digest {
        self.content
    }

    /// Every file's name and bytes, the manifest included, in the order of their names.
    pub fn files(&self) -> impl Iterator<Item = (&str, &[u8])> {
        self.files.iter().map(|(path, range)| (path.as_str(), &self.bytes[range.clone()]))
    }

    /// One file's bytes.
    #[must_use]
    pub fn file(&self, path: &str) -> Option<&[u8]> {
        self.files.get(path).map(|range| &self.bytes[range.clone()])
    }

    /// One file as text, under the path that errors show: inside the pack.
    ///
    /// # Errors
    /// If there is no such file, or it is not text.
    pub fn text(&self, path: &str) -> Result<SourceText> {
        let Some(bytes) = self.file(path) else {
            return malformed("E-PACK-LIST", format!("the pack holds no file '{}'", printable(path))).fail();
        };
        let text = std::str::from_utf8(bytes)
            .map_err(|_| Box::new(malformed("E-PACK-ENTRY", format!("'{path}' in the pack is not text in UTF-8"))))?;
        Ok(SourceText::new(self.origin.join(path), text))
    }

    /// `ada/wall 1.2.0`.
    #[must_use]
    pub fn title(&self) -> String {
        format!("{} {}", self.manifest.name, self.manifest.version)
    }
}

/// Code stands under the ending of code, so that what is asked for is what can run.
fn check_magic(path: &str, bytes: &[u8]) -> Result<()> {
    let magic: [(&[u8], &[&str], &str); 4] = [
        (b"\0asm", &["wasm"], "a WebAssembly module"),
        (b"\x7fELF", &["so"], "a program"),
        (b"MZ", &["dll"], "a program"),
        (b"\xcf\xfa\xed\xfe", &["dylib"], "a program"),
    ];
    let kind = super::entry_path::kind(path).unwrap_or_default();
    match magic.iter().find(|(start, endings, _)| bytes.starts_with(start) && !endings.contains(&kind)) {
        Some((_, _, what)) => {
            malformed("E-PACK-CAPABILITY", format!("'{path}' in the pack is {what} under another name")).fail()
        }
        None => Ok(()),
    }
}

/// Reads an ordinary file of at most `limit` bytes.
pub(super) fn read_limited(path: &Path, limit: usize) -> Result<Vec<u8>> {
    let shown = printable(&path.display().to_string());
    let unreadable = |error: &std::io::Error| {
        let mut diagnostic = Diagnostic::disk("read", path, error);
        if error.kind() == std::io::ErrorKind::NotFound {
            diagnostic.code = "E-PACK-FILE";
        }
        Box::new(diagnostic)
    };
    // Opening a pipe would wait for its writer, perhaps for ever.
    if !std::fs::metadata(path).map_err(|error| unreadable(&error))?.is_file() {
        return malformed("E-PACK-FILE", format!("'{shown}' is not an ordinary file")).fail();
    }
    let file = std::fs::File::open(path).map_err(|error| unreadable(&error))?;
    let mut bytes = Vec::new();
    file.take(limit as u64 + 1).read_to_end(&mut bytes).map_err(|error| unreadable(&error))?;
    if bytes.len() > limit {
        return malformed("E-PACK-LIMIT", format!("'{shown}' has more than {limit} bytes")).fail();
    }
    Ok(bytes)
}
