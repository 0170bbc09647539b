//! A mark for every step of a run, so that a replay can name the first step that differs.
//!
//! Each mark is two bytes of a chain of digests over the records of the ledger. A mark that agrees by chance is one in
//! 65,536, and the marks after it disagree all the same.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use super::Digest;
use engine::experiment::Ledger;

/// The marks' file in a pack: a line for each seed, with the marks of its learning and of its test.
pub(super) const STEPS: &str = "evidence/steps.txt";
/// Stands for no steps.
const NONE: &str = "-";

/// The marks of one seed: learning, then test.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Marks([Vec<u8>; 2]);

impl Marks {
    pub(super) fn new(learning: &Ledger, test: &Ledger) -> Self {
        Self([learning, test].map(chain))
    }

    /// The line of the file.
    pub(super) fn line(&self, seed: u64) -> String {
        let text = |marks: &Vec<u8>| if marks.is_empty() { NONE.to_owned() } else { STANDARD.encode(marks) };
        let [learning, test] = &self.0;
        format!("{seed} {} {}\n", text(learning), text(test))
    }

    /// The marks of a seed from the file's text; nothing if they are not there.
    pub(super) fn of_seed(text: &str, seed: u64) -> Option<Self> {
        let line = text.lines().find(|line| line.split(' ').next() == Some(&seed.to_string()))?;
        let [_, learning, test] = line.split(' ').collect::<Vec<_>>()[..] else { return None };
        let bytes = |text: &str| if text == NONE { Some(Vec::new()) } else { STANDARD.decode(text).ok() };
        Some(Self([bytes(learning)?, bytes(test)?]))
    }

    /// The first step, counted from 1, of learning or else of the test, that differs.
    pub(super) fn first_difference(&self, other: &Self) -> Option<(&'static str, u64)> {
        let differs = |part: usize| {
            let pairs = self.0[part].chunks(2).zip(other.0[part].chunks(2));
            pairs.enumerate().find(|(_, (own, other))| own != other).map(|(index, _)| index as u64 + 1)
        };
        let learning = differs(0).map(|step| ("learning", step));
        learning.or_else(|| differs(1).map(|step| ("the test", step)))
    }
}

fn chain(ledger: &Ledger) -> Vec<u8> {
    let mut last = Digest::of(b"");
    let mut marks = Vec::with_capacity(2 * ledger.len());
    let mut linked = Vec::new();
    for record in (0..ledger.len()).filter_map(|step| ledger.record_bytes(step)) {
        linked.clear();
        linked.extend_from_slice(last.bytes());
        linked.extend_from_slice(&record);
        last = Digest::of(&linked);
        marks.extend_from_slice(&last.bytes()[..2]);
    }
    marks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_written_read_and_compared() {
        let own = Marks([vec![1, 2, 3, 4], vec![5, 6]]);
        let text = format!("{}{}", Marks([vec![], vec![9, 9]]).line(7), own.line(8));
        assert_eq!(Marks::of_seed(&text, 8).as_ref(), Some(&own));
        assert_eq!(Marks::of_seed(&text, 9), None);
        assert_eq!(own.first_difference(&own), None);
        assert_eq!(own.first_difference(&Marks([vec![1, 2, 0, 4], vec![5, 6]])), Some(("learning", 2)));
        assert_eq!(own.first_difference(&Marks([vec![1, 2, 3, 4], vec![5, 0]])), Some(("the test", 1)));
    }
}
