//! The mistakes of a file, gathered: one for each place, in the order of the lines, so many and no more.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::PathBuf;

use super::{Diagnostic, Result, SourceText};

/// The most mistakes that one error shows; more are only counted.
pub(crate) const MOST_MISTAKES: usize = 20;

/// Which file, and which of its bytes.
type At = (usize, usize);

/// Mistakes as they are found, in any order.
///
/// Of several at one place the first to be found is kept: whatever is found there later may follow from it.
#[derive(Debug)]
pub(crate) struct Mistakes {
    /// In the order in which their mistakes are told.
    files: Vec<PathBuf>,
    seen: BTreeSet<At>,
    kept: BTreeMap<At, Diagnostic>,
    /// Those that stand in no file.
    elsewhere: Vec<Diagnostic>,
    left_out: usize,
}

impl Mistakes {
    /// None yet; those of `source` will be told before those of other files.
    #[must_use]
    pub(crate) fn new(source: &SourceText) -> Self {
        let (seen, kept) = (BTreeSet::new(), BTreeMap::new());
        Self { files: vec![source.path.clone()], seen, kept, elsewhere: Vec::new(), left_out: 0 }
    }

    /// Adds a mistake with its further ones, unless its place has one.
    pub(crate) fn add(&mut self, mut mistake: Diagnostic) {
        self.left_out += std::mem::take(&mut mistake.left_out);
        let others = std::mem::take(&mut mistake.others);
        self.add_one(mistake);
        others.into_iter().for_each(|other| self.add_one(other));
    }

    fn add_one(&mut self, mistake: Diagnostic) {
        let Some(place) = &mistake.place else {
            if !self.elsewhere.iter().any(|known| known.message == mistake.message) {
                self.elsewhere.push(mistake);
            }
            return;
        };
        let at = (self.file(&place.source), place.span.start);
        if self.seen.insert(at) {
            self.kept.insert(at, mistake);
            if self.kept.len() > MOST_MISTAKES {
                self.kept.pop_last();
            }
        }
    }

    /// The value of a success; a failure is added.
    pub(crate) fn take<T>(&mut self, result: Result<T>) -> Option<T> {
        result.map_err(|mistake| self.add(*mistake)).ok()
    }

    /// Whether a mistake at this byte would be shown. If not it is counted, so that nobody has to put it into words.
    pub(crate) fn wants(&mut self, source: &SourceText, start: usize) -> bool {
        let at = (self.file(source), start);
        let late = self.kept.len() == MOST_MISTAKES && self.kept.last_key_value().is_some_and(|(last, _)| *last < at);
        if late {
            self.seen.insert(at);
        }
        !late && !self.seen.contains(&at)
    }

    /// Whether a mistake begins within these bytes.
    #[must_use]
    pub(crate) fn within(&self, source: &SourceText, bytes: &Range<usize>) -> bool {
        let file = self.files.iter().position(|path| *path == source.path);
        file.is_some_and(|file| {
            bytes.start < bytes.end && { self.seen.range((file, bytes.start)..(file, bytes.end)).next().is_some() }
        })
    }

    /// Whether there is none.
    #[must_use]
    pub(crate) fn is_empty(&self) -> bool {
        self.count() == 0
    }

    /// How many there are.
    #[must_use]
    pub(crate) fn count(&self) -> usize {
        self.seen.len() + self.elsewhere.len() + self.left_out
    }

    /// All as one error.
    ///
    /// # Errors
    /// If there is a mistake: the first, with the further ones.
    pub(crate) fn end(self) -> Result<()> {
        self.gathered().map_or(Ok(()), Diagnostic::fail)
    }

    /// All as one error, after one more that ended the search.
    #[must_use]
    pub(crate) fn ended_by(mut self, last: Diagnostic) -> Box<Diagnostic> {
        self.add(last.clone());
        Box::new(self.gathered().unwrap_or(last))
    }

    fn gathered(self) -> Option<Diagnostic> {
        let count = self.count();
        let mut all = self.kept.into_values().chain(self.elsewhere);
        let mut first = all.next()?;
        first.others = all.take(MOST_MISTAKES - 1).collect();
        first.left_out = count - 1 - first.others.len();
        Some(first)
    }

    fn file(&mut self, source: &SourceText) -> usize {
        self.files.iter().position(|path| *path == source.path).unwrap_or_else(|| {
            self.files.push(source.path.clone());
            self.files.len() - 1
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostic::Kind;

    fn at(source: &SourceText, start: usize, message: &str) -> Diagnostic {
        Diagnostic::new("E-SCRIPT-RULE", message).at(source, start..start + 1, "here")
    }

    #[test]
    fn mistakes_are_told_in_the_order_of_the_lines_one_for_each_place() {
        let (script, world) = (SourceText::new("a.rhai", "one\ntwo\nthree"), SourceText::new("w.toml", "x"));
        let mut mistakes = Mistakes::new(&script);
        mistakes.add(at(&world, 0, "world"));
        mistakes.add(Diagnostic::new("E-IO", "nowhere"));
        mistakes.add(at(&script, 8, "third"));
        mistakes.add(at(&script, 0, "first"));
        mistakes.add(at(&script, 8, "what follows from the third"));
        assert!(mistakes.within(&script, &(4..9)) && !mistakes.within(&script, &(4..8)));
        let error = mistakes.end().unwrap_err();
        let told: Vec<_> = error.all().map(|one| one.message.as_str()).collect();
        assert_eq!(told, ["first", "third", "world", "nowhere"]);
        assert_eq!(error.summary().unwrap(), "4 mistakes in 'a.rhai' and 'w.toml'");
        assert_eq!(error.kind(), Kind::Input);
    }

    #[test]
    fn after_twenty_they_are_only_counted() {
        let source = SourceText::new("a.rhai", "x".repeat(100));
        let mut mistakes = Mistakes::new(&source);
        for start in (0..25).rev() {
            mistakes.add(at(&source, start, "wrong"));
        }
        assert!(!mistakes.wants(&source, 60) && !mistakes.wants(&source, 3));
        let error = mistakes.end().unwrap_err();
        assert_eq!((error.others.len(), error.left_out), (19, 6));
        assert!(error.all().all(|one| one.place.as_ref().unwrap().span.start < 20));
        assert_eq!(error.summary().unwrap(), "26 mistakes in 'a.rhai': 20 are shown, and 6 more");
        // Gathered twice, the counts stay.
        let mut again = Mistakes::new(&source);
        again.add(*error);
        assert_eq!(again.count(), 26);
    }

    #[test]
    fn one_alone_needs_no_count() {
        let source = SourceText::new("a.rhai", "x");
        let error = Mistakes::new(&source).ended_by(at(&source, 0, "wrong"));
        assert_eq!((error.summary(), error.to_json()["others"].as_array().map(Vec::len)), (None, Some(0)));
    }
}
