//! Names of packs: `owner/name`, in letters that cannot be mistaken for others, and names that look alike all the same.

use std::fmt;

use serde::{Deserialize, Serialize};

/// The longest owner and the longest name, bytes.
const MAX_PART_BYTES: usize = 40;

/// `owner/name`: lower-case letters, digits, dots, underscores and hyphens.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct PackName {
    owner: String,
    name: String,
}

impl PackName {
    /// Who publishes the pack.
    #[must_use]
    pub fn owner(&self) -> &str {
        &self.owner
    }

    /// The name without its owner.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Whether a reader could take one name for the other: `ada/platf0rm` for `ada/platform`.
    #[must_use]
    pub fn looks_like(&self, other: &Self) -> bool {
        self != other && skeleton(&self.to_string()) == skeleton(&other.to_string())
    }

    /// The name as part of a file name: `ada-platform`.
    #[must_use]
    pub fn file_stem(&self) -> String {
        format!("{}-{}", self.owner, self.name)
    }
}

impl fmt::Display for PackName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.owner, self.name)
    }
}

impl From<PackName> for String {
    fn from(name: PackName) -> Self {
        name.to_string()
    }
}

impl TryFrom<String> for PackName {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let (owner, name) = text.split_once('/').ok_or("a pack's name is written owner/name, such as ada/platform")?;
        for part in [owner, name] {
            check_part(part)?;
        }
        Ok(Self { owner: owner.to_owned(), name: name.to_owned() })
    }
}

/// Checks an owner or a name.
///
/// # Errors
/// What is wrong, for a person.
pub(super) fn check_part(part: &str) -> Result<(), String> {
    let fine = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || matches!(c, '.' | '_' | '-');
    let edge = |c: Option<char>| c.is_some_and(|c| c.is_ascii_lowercase() || c.is_ascii_digit());
    if let Some(wrong) = part.chars().find(|c| !fine(*c)) {
        let shown = wrong.escape_unicode();
        return Err(format!("a pack's name has only a to z, 0 to 9, '.', '_' and '-'; found {shown}"));
    }
    if !edge(part.chars().next()) || !edge(part.chars().last()) {
        return Err("each half of a pack's name starts and ends with a letter or a digit".to_owned());
    }
    if part.len() > MAX_PART_BYTES {
        return Err(format!("each half of a pack's name has at most {MAX_PART_BYTES} characters"));
    }
    Ok(())
}

/// The name with everything that is easily confused made equal.
fn skeleton(name: &str) -> String {
    let plain: String = name
        .chars()
        .filter(|c| !matches!(c, '.' | '_' | '-'))
        .map(|c| match c {
            '0' => 'o',
            '1' | 'i' => 'l',
            '5' => 's',
            '8' => 'b',
            other => other,
        })
        .collect();
    plain.replace("rn", "m").replace("vv", "w").replace("cl", "d")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn name(text: &str) -> PackName {
        PackName::try_from(text.to_owned()).unwrap()
    }

    #[test]
    fn a_name_has_an_owner_and_plain_letters() {
        assert_eq!((name("ada/wall-2").owner(), name("ada/wall-2").name()), ("ada", "wall-2"));
        for wrong in
            ["wall", "ada/", "/wall", "Ada/wall", "ada/w/x", "ada/..", "ada/-x", "\u{430}da/wall", "ada/a\u{1b}"]
        {
            assert!(PackName::try_from(wrong.to_owned()).is_err(), "{wrong}");
        }
    }

    #[test]
    fn names_that_look_alike_are_found() {
        assert!(name("ada/platf0rm").looks_like(&name("ada/platform")));
        assert!(name("ada/plat-form").looks_like(&name("ada/platforrn")));
        assert!(!name("ada/platform").looks_like(&name("ada/platform")));
        assert!(!name("ada/wall").looks_like(&name("ada/wall-left")));
    }
}
