//! Names of files in a pack: harmless on every system, or refused.

use std::fmt;

use serde::{Deserialize, Serialize};

use engine::diagnostic::printable;

/// The longest name, bytes.
const MAX_PATH_BYTES: usize = 100;
/// The deepest name, folders and file.
pub(super) const MAX_LEVELS: usize = 8;
/// The kinds of files that a pack can hold, by their endings.
const ENDINGS: &[&str] =
    &["rhai", "toml", "md", "txt", "csv", "json", "png", "jpg", "jpeg", "wasm", "so", "dylib", "dll"];
/// Names that Windows keeps for devices.
const DEVICES: &[&str] = &["con", "prn", "aux", "nul", "conin$", "conout$"];

/// The name of a file in a pack, with `/` between its parts.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct EntryPath(String);

impl EntryPath {
    /// Checks a name.
    ///
    /// # Errors
    /// What is wrong with it, for a person, in words that stand after the name.
    pub fn new(path: &str) -> Result<Self, String> {
        if path.is_empty() {
            return Err("is empty".to_owned());
        }
        if path.len() > MAX_PATH_BYTES {
            return Err(format!("is longer than {MAX_PATH_BYTES} bytes"));
        }
        if path.starts_with('/') {
            return Err("is absolute; a name starts inside the pack".to_owned());
        }
        if path.contains('\\') {
            return Err("has a backslash; folders are written with '/'".to_owned());
        }
        if path.split('/').count() > MAX_LEVELS {
            return Err(format!("is deeper than {MAX_LEVELS} levels"));
        }
        path.split('/').try_for_each(check_part)?;
        if kind(path).is_none() {
            return Err(format!("is of no kind that a pack can hold (.{})", ENDINGS.join(", .")));
        }
        Ok(Self(path.to_owned()))
    }

    /// The text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

/// What a name's ending says: `rhai`, `toml`, ...; `text` for a licence without an ending; nothing for other names.
pub(super) fn kind(path: &str) -> Option<&'static str> {
    let file = path.rsplit('/').next().unwrap_or(path);
    if matches!(file, "license" | "licence" | "copying" | "license-mit" | "license-apache") {
        return Some("text");
    }
    let (_, ending) = file.rsplit_once('.')?;
    ENDINGS.iter().find(|known| **known == ending).copied()
}

fn check_part(part: &str) -> Result<(), String> {
    let wrong = |text: &str| Err(text.to_owned());
    match part {
        "" => return wrong("has an empty part"),
        "." | ".." => return wrong("leaves its folder with '.' or '..'"),
        _ => {}
    }
    if part.chars().any(char::is_control) {
        return wrong("has a control character");
    }
    if part.chars().any(|c| c.is_ascii_uppercase()) {
        return wrong("has capital letters, which some systems do not tell from small ones; use small letters");
    }
    if part.contains(':') {
        return wrong("has a ':', which names a drive or a hidden stream on Windows");
    }
    let allowed = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || matches!(c, '.' | '_' | '-');
    if !part.chars().all(allowed) {
        return wrong("has other characters than a to z, 0 to 9, '.', '_' and '-'");
    }
    if part.starts_with(['.', '-']) || part.ends_with('.') {
        return wrong("has a part that starts with '.' or '-' or ends with '.'");
    }
    let stem = part.split('.').next().unwrap_or(part);
    let numbered =
        |prefix: &str| stem.strip_prefix(prefix).is_some_and(|rest| matches!(rest.as_bytes(), [b'0'..=b'9']));
    if DEVICES.contains(&stem) || numbered("com") || numbered("lpt") {
        return wrong("is the name of a device on Windows");
    }
    Ok(())
}

impl fmt::Display for EntryPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl From<EntryPath> for String {
    fn from(path: EntryPath) -> Self {
        path.0
    }
}

impl TryFrom<String> for EntryPath {
    type Error = String;

    fn try_from(path: String) -> Result<Self, String> {
        Self::new(&path).map_err(|wrong| format!("the file name '{}' {wrong}", printable(&path)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_names_are_allowed() {
        for name in ["manifest.toml", "scripts/wall.rhai", "license", "a/b/c/d/e/f/g/h.png", "license-mit"] {
            assert!(EntryPath::new(name).is_ok(), "{name}");
        }
    }

    #[test]
    fn names_that_mean_something_to_a_system_are_refused() {
        let wrong = [
            "",
            "../a.txt",
            "a/../b.txt",
            "/etc/a.txt",
            "a//b.txt",
            "./a.txt",
            "con.txt",
            "a/nul.toml",
            "com1.txt",
            "lpt9.md",
            "a.txt.",
            "x:y.txt",
            "..\\a.txt",
            "a\u{1b}.txt",
            "a\n.txt",
            "A.txt",
            ".hidden.txt",
            "-rf.txt",
            "a b.txt",
            "run.sh",
            "a",
            "\u{430}.txt",
            "a/b/c/d/e/f/g/h/i.txt",
            "setup.exe",
            "inner.pack",
            "model.safetensors",
            "picture.svg",
        ];
        for name in wrong {
            assert!(EntryPath::new(name).is_err(), "{name}");
        }
        assert!(EntryPath::new(&format!("{}.txt", "a".repeat(97))).is_err());
    }
}
