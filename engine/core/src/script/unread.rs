//! Settings that a mistake has kept from being read: what depends on them is not checked.

use crate::diagnostic::nearest_name;
use crate::settings::SETTINGS;
use std::collections::BTreeSet;

/// Settings that are written and could not be read; they have their defaults.
#[derive(Debug, Clone, Default)]
pub(crate) struct Unread(BTreeSet<(String, String)>);

impl Unread {
    /// All that one set-up call sets.
    pub(super) fn all_of(&mut self, call: &str) {
        self.0.insert((call.to_owned(), String::new()));
    }

    /// One setting; of a key that there is not, the one that is most likely meant.
    pub(super) fn one_of(&mut self, group: &str, key: &str) {
        let keys = SETTINGS.iter().filter(|row| row.group == group).map(|row| row.key);
        // A word for what is meant with another unit: `height_cm` for `height_m`.
        let stem = key.rsplit_once('_').map_or(key, |(stem, _)| stem);
        let same = keys.clone().find(|known| known.starts_with(stem));
        match keys.clone().find(|known| *known == key).or(same).or_else(|| nearest_name(key, keys)) {
            Some(meant) => drop(self.0.insert((group.to_owned(), meant.to_owned()))),
            None => self.all_of(group),
        }
    }

    /// Whether any of what this set-up call sets is not read.
    #[must_use]
    pub(crate) fn any_of(&self, call: &str) -> bool {
        self.0.iter().any(|(group, _)| group == call)
    }

    /// Whether one setting is not read, or may not be.
    #[must_use]
    pub(crate) fn has(&self, group: &str, key: &str) -> bool {
        self.0.iter().any(|(known, of)| known == group && (of.is_empty() || of == key))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wrong_key_leaves_the_setting_unread_that_was_meant() {
        let mut unread = Unread::default();
        unread.one_of("laser", "beems");
        unread.one_of("laser", "height_cm");
        assert!(unread.has("laser", "beams") && unread.has("laser", "height_m") && !unread.has("laser", "tilt_deg"));
        unread.one_of("camera", "colour_depth");
        assert!(unread.has("camera", "tilt_deg") && unread.any_of("camera") && !unread.any_of("grid"));
    }
}
