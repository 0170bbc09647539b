//! Editions of the language: each is a column of defaults, so that a better default never changes what an older script means.

use super::{Settings, Value, apply};

/// An edition.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Edition(usize);

/// A default that depends on the edition.
struct EditionRow {
    group: &'static str,
    key: &'static str,
    /// By edition, the first one first.
    words: [&'static str; EDITIONS],
}

const EDITIONS: usize = 2;

/// Every default that depends on the edition; the others are those of all of them. The second one remembers its steps.
const ROWS: &[EditionRow] = &[EditionRow { group: "learner", key: "kind", words: ["ttd", "memory"] }];

impl Edition {
    /// That of version 0.1, of which nothing says its edition.
    pub const FIRST: Self = Self(0);
    /// That of a script that says none.
    pub const NEWEST: Self = Self(EDITIONS - 1);

    /// The edition of this number, from 1.
    #[must_use]
    pub fn of(number: u32) -> Option<Self> {
        let index = usize::try_from(number).ok()?.checked_sub(1)?;
        (index < EDITIONS).then_some(Self(index))
    }

    /// Its number, from 1.
    #[must_use]
    pub const fn number(self) -> u32 {
        self.0 as u32 + 1
    }

    /// All of them, the first one first.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..EDITIONS).map(Self)
    }

    /// The settings whose default depends on the edition, with what it is in this one: group, key, word.
    pub fn defaults(self) -> impl Iterator<Item = (&'static str, &'static str, &'static str)> {
        ROWS.iter().map(move |row| (row.group, row.key, row.words[self.0]))
    }
}

impl Settings {
    /// The defaults of an edition.
    #[must_use]
    pub fn of_edition(edition: Edition) -> Self {
        let mut settings = Self::of_every_edition();
        for (group, key, word) in edition.defaults() {
            // A test holds that the table has each of them.
            let _ = apply(&mut settings, group, key, &Value::Text(word.to_owned()));
        }
        settings
    }
}

/// Those of the newest edition.
impl Default for Settings {
    fn default() -> Self {
        Self::of_edition(Edition::NEWEST)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::{LearnerKind, SETTINGS, SettingShape};

    #[test]
    fn every_default_of_an_edition_is_a_word_that_the_setting_may_be() {
        for (group, key, word) in Edition::all().flat_map(Edition::defaults) {
            let row = SETTINGS.iter().find(|row| row.group == group && row.key == key).unwrap();
            assert!(matches!(row.shape, SettingShape::Choice(words) if words.contains(&word)), "{group}.{key} {word}");
        }
    }

    #[test]
    fn the_first_edition_learns_as_version_1_did_and_the_second_remembers() {
        let kinds = Edition::all().map(|edition| Settings::of_edition(edition).learner.kind);
        assert_eq!(kinds.collect::<Vec<_>>(), [LearnerKind::Ttd, LearnerKind::Memory]);
        assert_eq!(Settings::default().learner.kind, LearnerKind::Memory);
    }

    #[test]
    fn editions_are_counted_from_1_and_end_with_the_newest() {
        assert_eq!(Edition::all().map(Edition::number).collect::<Vec<_>>(), [1, 2]);
        assert_eq!(
            (Edition::of(0), Edition::of(1), Edition::of(2), Edition::of(3)),
            (None, Some(Edition::FIRST), Some(Edition::NEWEST), None)
        );
    }
}
