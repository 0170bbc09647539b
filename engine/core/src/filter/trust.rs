//! Which native libraries may be loaded: none, but those whose digest the user named.

use std::fmt::Write;
use std::path::Path;

use sha2::{Digest, Sha256};

use crate::diagnostic::{Diagnostic, Result, printable};

/// The most bytes that a library or module may have.
const LARGEST_FILE_BYTES: u64 = 256 << 20;

/// The digests of libraries that may be loaded.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Trust {
    allowed: Vec<String>,
}

impl Trust {
    /// Allows one library: `sha256:` and 64 hexadecimal digits in lower case.
    ///
    /// # Errors
    /// If it is anything else; a shortened digest could be met by another file.
    pub fn allow(&mut self, digest: &str) -> Result<()> {
        let digits = digest.strip_prefix("sha256:").unwrap_or("");
        if digits.len() == 64 && digits.bytes().all(|digit| matches!(digit, b'0'..=b'9' | b'a'..=b'f')) {
            self.allowed.push(digits.to_owned());
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
        let text = std::fs::read_to_string(path).map_err(|error| Diagnostic::disk("read", path, &error))?;
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

    /// Reads a library whose digest is allowed.
    ///
    /// # Errors
    /// If it is not allowed: what that would mean, and the exact words that allow it.
    pub(super) fn read(&self, path: &Path) -> Result<(Vec<u8>, String)> {
        let bytes = read(path)?;
        let digest = sha256(&bytes);
        if self.allowed.contains(&digest) {
            return Ok((bytes, digest));
        }
        let shown = printable(&path.display().to_string());
        let (code, message) = if self.allowed.is_empty() {
            ("E-NATIVE-DENIED", format!("'{shown}' is a native library and was not loaded"))
        } else {
            ("E-NATIVE-DENIED", format!("'{shown}' is not one of the native libraries that are allowed"))
        };
        let help = format!(
            "a native filter can do all that you can do: read, change and send your files. If you trust it: \
             --allow-native=sha256:{digest}"
        );
        Diagnostic::new(code, message).help(help).fail()
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
    std::fs::read(path).map_err(failed)
}

/// SHA-256 in 64 hexadecimal digits.
pub(super) fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().fold(String::with_capacity(64), |mut digits, byte| {
        // Writing to a String cannot fail.
        let _ = write!(digits, "{byte:02x}");
        digits
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostic::Kind;

    #[test]
    fn only_whole_digests_are_taken() {
        let mut trust = Trust::default();
        assert!(trust.allow(&format!("sha256:{}", "0a".repeat(32))).is_ok());
        for wrong in ["", "sha256:", "sha256:0a0a", &"0a".repeat(32), &format!("sha256:{}", "0A".repeat(32))] {
            assert_eq!(trust.allow(wrong).err().unwrap().code, "E-NATIVE-DIGEST", "{wrong}");
        }
    }

    #[test]
    fn a_library_is_read_only_if_its_digest_is_allowed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("ink.so");
        std::fs::write(&path, "abc").unwrap();
        // SHA-256 of "abc", FIPS 180-2 appendix B.1.
        let digest = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        let mut trust = Trust::default();
        let error = trust.read(&path).err().unwrap();
        assert_eq!((error.code, error.kind()), ("E-NATIVE-DENIED", Kind::Trust));
        assert!(error.help.unwrap().ends_with(&format!("--allow-native=sha256:{digest}")));
        let file = folder.path().join("trust.toml");
        std::fs::write(&file, format!("native = [\"sha256:{digest}\"]\n")).unwrap();
        trust.allow_file(&file).unwrap();
        assert_eq!(trust.read(&path).unwrap(), (b"abc".to_vec(), digest.to_owned()));
        std::fs::write(&path, "abd").unwrap();
        assert_eq!(trust.read(&path).err().unwrap().code, "E-NATIVE-DENIED");
    }
}
