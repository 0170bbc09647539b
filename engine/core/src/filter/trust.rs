//! Which native libraries may be loaded: none, but those whose digest the user named.

use std::io::Read;
use std::path::Path;

use crate::diagnostic::{Diagnostic, Result, printable};
use crate::digest::Digest;

/// The most bytes that a library or module may have.
const LARGEST_FILE_BYTES: u64 = 256 << 20;

/// The most bytes that a list of digests may have.
const LARGEST_TRUST_BYTES: u64 = 512 << 10;

/// The digests of libraries that may be loaded.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Trust {
    allowed: Vec<Digest>,
}

impl Trust {
    /// Allows one library: `sha256:` and 64 hexadecimal digits in lower case.
    ///
    /// # Errors
    /// If it is anything else; a shortened digest could be met by another file.
    pub fn allow(&mut self, digest: &str) -> Result<()> {
        let digits = digest.strip_prefix("sha256:").unwrap_or("");
        if let Ok(digest) = Digest::try_from(digits.to_owned()) {
            self.allowed.push(digest);
            return Ok(());
        }
        let message = format!("'{}' is not the digest of a library", printable(digest));
        let help = "write sha256: and all 64 hexadecimal digits, in lower case; `engine plugins` prints them";
        Diagnostic::new("E-NATIVE-DIGEST", message).help(help).fail()
    }

    /// Allows what a trust file names: `native = ["sha256:..."]` in TOML.
    ///
    /// # Errors
    /// If the file cannot be read, is no TOML, or names something else than digests.
    pub fn allow_file(&mut self, path: &Path) -> Result<()> {
        let failed = |error| Box::new(Diagnostic::disk("read", path, &error));
        let text = String::from_utf8(ordinary(path, LARGEST_TRUST_BYTES).map_err(failed)?);
        let text = text.map_err(|_| failed(std::io::Error::other("it is not text")))?;
        let shown = printable(&path.display().to_string());
        let wrong = |why: &str| {
            let help = "write for example: native = [\"sha256:...\"], with all 64 digits";
            Box::new(Diagnostic::new("E-TRUST-FILE", format!("'{shown}': {why}")).help(help))
        };
        let table: toml::Table = toml::from_str(&text).map_err(|error| wrong(error.message()))?;
        let Some(native) = table.get("native") else { return Ok(()) };
        let digests = native.as_array().ok_or_else(|| wrong("'native' must be a list of digests"))?;
        for digest in digests {
            self.allow(digest.as_str().ok_or_else(|| wrong("'native' must be a list of texts"))?)?;
        }
        Ok(())
    }

    /// Whether a library with this digest may be loaded.
    #[cfg(feature = "native-filters")]
    #[must_use]
    pub(super) fn allows(&self, digest: &Digest) -> bool {
        self.allowed.contains(digest)
    }

    /// Whether no library at all may be loaded.
    #[cfg(feature = "native-filters")]
    #[must_use]
    pub(super) fn is_empty(&self) -> bool {
        self.allowed.is_empty()
    }
}

/// The bytes of a library or a module.
pub(super) fn read(path: &Path) -> Result<Vec<u8>> {
    let failed = |error| Box::new(Diagnostic::disk("read", path, &error));
    let length = std::fs::metadata(path).map_err(failed)?.len();
    if length > LARGEST_FILE_BYTES {
        let shown = printable(&path.display().to_string());
        let message = format!("'{shown}' has {length} bytes; a filter may have {LARGEST_FILE_BYTES}");
        return Diagnostic::new("E-FILTER-SIZE", message).fail();
    }
    ordinary(path, LARGEST_FILE_BYTES).map_err(failed)
}

/// The bytes of an ordinary file: a pipe does not make it wait, and a device is not read.
fn ordinary(path: &Path, most: u64) -> std::io::Result<Vec<u8>> {
    if !std::fs::metadata(path)?.is_file() {
        return Err(std::io::Error::other("it is not an ordinary file"));
    }
    let mut bytes = Vec::new();
    std::fs::File::open(path)?.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most { Err(std::io::Error::other("it is too long")) } else { Ok(bytes) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_whole_digests_are_taken() {
        let mut trust = Trust::default();
        assert!(trust.allow(&format!("sha256:{}", "0a".repeat(32))).is_ok());
        for wrong in ["", "sha256:", "sha256:0a0a", &"0a".repeat(32), &format!("sha256:{}", "0A".repeat(32))] {
            assert_eq!(trust.allow(wrong).err().unwrap().code, "E-NATIVE-DIGEST", "{wrong}");
        }
    }
}
