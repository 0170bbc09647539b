//! The parts of a state that are looked at by themselves: over these, states are pooled.
//!
//! A state is a tuple of digits. Its *views* are the parts of several digits, columns of a grid; what has one digit (bins, the
//! stage) stands alone and goes with every view. From the lowest level, which knows most states, up:
//!
//! * pairs of columns of a view; a view of one or two columns as a whole
//! * the same with all single digits, if there are any
//! * each view with all single digits, if there are several views
//!
//! One grid alone has the lowest level only. A state without views has none.

use crate::state::Digit;

/// Some digits of a state.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct SubTuple {
    /// Which digits.
    pub(super) digits: Vec<usize>,
    /// Of each: the product of the values of all digits below it, and its own number of values.
    places: Vec<(u64, u64)>,
}

impl SubTuple {
    /// The number of a state's digits that it looks at, in mixed radix.
    #[must_use]
    pub(super) fn key(&self, state: usize) -> u64 {
        self.places.iter().rev().fold(0, |key, (below, values)| key * values + state as u64 / below % values)
    }
}

/// All sub-tuples of a state, level by level, the lowest level first.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Levels {
    pub(super) tuples: Vec<SubTuple>,
    /// Where each level ends in `tuples`.
    pub(super) ends: Vec<usize>,
}

impl Levels {
    /// The levels of states with these digits, lowest first.
    #[must_use]
    pub(super) fn new(digits: &[Digit]) -> Self {
        let views = views(digits);
        let single: Vec<usize> = (0..digits.len()).filter(|digit| is_single(digits, *digit)).collect();
        let pairs: Vec<Vec<usize>> = views.iter().flat_map(|view| pairs(view)).collect();
        let with_single = |own: &[usize]| [own, &single].concat();
        let mut levels = vec![pairs.clone()];
        if !single.is_empty() {
            levels.push(pairs.iter().map(|pair| with_single(pair)).collect());
        }
        if views.len() > 1 {
            levels.push(views.iter().map(|view| with_single(&view.concat())).collect());
        }
        levels.retain(|level| !level.is_empty());
        let ends = levels.iter().scan(0, |end, level| {
            *end += level.len();
            Some(*end)
        });
        let ends = ends.collect();
        let places = places(digits);
        let tuple = |digits: Vec<usize>| SubTuple { places: digits.iter().map(|at| places[*at]).collect(), digits };
        Self { tuples: levels.into_iter().flatten().map(tuple).collect(), ends }
    }

    /// The sub-tuples of each level, lowest first.
    pub(super) fn ranges(&self) -> impl DoubleEndedIterator<Item = std::ops::Range<usize>> + '_ {
        (0..self.ends.len()).map(|level| if level == 0 { 0 } else { self.ends[level - 1] }..self.ends[level])
    }
}

fn is_single(digits: &[Digit], digit: usize) -> bool {
    digits.iter().filter(|other| other.part == digits[digit].part).count() == 1
}

/// By view and column: the digits.
fn views(digits: &[Digit]) -> Vec<Vec<Vec<usize>>> {
    let mut parts: Vec<usize> =
        (0..digits.len()).filter(|at| !is_single(digits, *at)).map(|at| digits[at].part).collect();
    parts.dedup();
    let of = |part: usize| {
        let mut columns: Vec<Vec<usize>> = Vec::new();
        for (at, digit) in digits.iter().enumerate().filter(|(_, digit)| digit.part == part) {
            if columns.len() <= digit.column {
                columns.resize(digit.column + 1, Vec::new());
            }
            columns[digit.column].push(at);
        }
        columns
    };
    parts.into_iter().map(of).collect()
}

/// The digits of every two columns of a view; all of it if it has no more than two.
fn pairs(view: &[Vec<usize>]) -> Vec<Vec<usize>> {
    if view.len() <= 2 {
        return vec![view.concat()];
    }
    let with = |one: usize| (one + 1..view.len()).map(move |other| [view[one].as_slice(), &view[other]].concat());
    (0..view.len()).flat_map(with).collect()
}

fn places(digits: &[Digit]) -> Vec<(u64, u64)> {
    let place = |below: &mut u64, digit: &Digit| {
        let (at, values) = (*below, digit.values.max(1) as u64);
        *below = at.saturating_mul(values);
        Some((at, values))
    };
    digits.iter().scan(1, place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Columns of so many heights each.
    fn view(part: usize, columns: usize, values: usize) -> Vec<Digit> {
        (0..columns).map(|column| Digit { part, column, values }).collect()
    }

    fn single(part: usize, values: usize) -> Vec<Digit> {
        vec![Digit { part, column: 0, values }]
    }

    #[test]
    fn a_grid_alone_is_pooled_over_its_three_pairs_of_columns() {
        let levels = Levels::new(&view(0, 3, 4));
        assert_eq!(levels.ends, [3]);
        // Heights 2, 1, 3: columns (0, 1) are 2 + 4 * 1, (0, 2) are 2 + 4 * 3, (1, 2) are 1 + 4 * 3.
        let state = 2 + 4 + 16 * 3;
        assert_eq!(levels.tuples.iter().map(|tuple| tuple.key(state)).collect::<Vec<_>>(), [6, 14, 13]);
    }

    #[test]
    fn single_digits_go_with_every_view_and_are_dropped_last_but_one() {
        // Two views of two columns and a digit: the views whole, then with the digit, then with it as views.
        let digits = [view(0, 2, 3), view(1, 2, 2), single(2, 5)].concat();
        let levels = Levels::new(&digits);
        assert_eq!(levels.ends, [2, 4, 6]);
        // Digits 2, 1 | 1, 0 | 4: the first view is 2 + 3 * 1 = 5, the second 1; with the digit 5 + 9 * 4 and 1 + 4 * 4.
        let state = 2 + 3 + 9 + 36 * 4;
        assert_eq!(levels.tuples.iter().map(|tuple| tuple.key(state)).collect::<Vec<_>>(), [5, 1, 41, 17, 41, 17]);
    }

    #[test]
    fn a_state_without_views_has_no_level() {
        assert_eq!(Levels::new(&[single(0, 3), single(1, 4)].concat()).ends, [0; 0]);
    }

    #[test]
    fn without_column_fill_a_column_is_all_of_its_cells() {
        // Two rows of three cells, row by row: column c holds digits c and c + 3.
        let digits: Vec<Digit> = (0..6).map(|cell| Digit { part: 0, column: cell % 3, values: 2 }).collect();
        let levels = Levels::new(&digits);
        assert_eq!(levels.tuples.len(), 3);
        // Cells 1 0 1 / 1 1 0: columns (0, 1) hold 1, 1, 0, 1 = 1 + 2 + 8.
        assert_eq!(levels.tuples[0].key(0b01_1101), 11);
    }
}
