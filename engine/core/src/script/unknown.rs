//! Names that nothing defines: a misspelt one is told at each of its places, a missing definition once.

use super::refused::unknown_function_at;
use super::source::Code;
use crate::diagnostic::{Diagnostic, Mistakes};
use crate::judge::explain;
use std::collections::{BTreeMap, BTreeSet};

/// Lines that are named beside the first.
const MOST_LINES: usize = 5;

/// Where unknown names stand, and whether as functions.
#[derive(Debug, Default)]
pub(super) struct Unknown(Vec<(usize, bool, String)>);

impl Unknown {
    pub(super) fn variable(&mut self, name: &str, at: usize) {
        self.0.push((at, false, name.to_owned()));
    }

    pub(super) fn function(&mut self, name: &str, at: usize) {
        self.0.push((at, true, name.to_owned()));
    }

    /// Adds the mistakes. Gives the names that are told once, since whatever else uses them is wrong too.
    pub(super) fn tell(
        mut self,
        code: &Code,
        variables: &[String],
        functions: &[String],
        mistakes: &mut Mistakes,
    ) -> BTreeSet<String> {
        // The tree is not walked in the order of the text, and a switch not even in the same order each time.
        self.0.sort_unstable();
        let mut places: BTreeMap<(bool, String), Vec<usize>> = BTreeMap::new();
        for (at, is_function, name) in self.0 {
            places.entry((is_function, name)).or_default().push(at);
        }
        let mut places: Vec<_> = places.into_iter().map(|(name, places)| (places, name)).collect();
        places.sort_unstable();
        let source = &code.source;
        let known: Vec<String> = variables.iter().cloned().chain(code.views.all()).collect();
        let mut once = BTreeSet::new();
        for (places, (is_function, name)) in places {
            let told = |at: usize| match is_function {
                true => unknown_function_at(source, at, &name, functions),
                false => explain::unknown_name_at(source, at, &name, &known),
            };
            let first = if mistakes.wants(source, places[0]) { Some(told(places[0])) } else { None };
            match first {
                Some(wrong) if wrong.help.as_ref().is_some_and(|help| help.starts_with("did you mean")) => {
                    mistakes.add(wrong);
                    for at in places.into_iter().skip(1) {
                        if mistakes.wants(source, at) {
                            mistakes.add(told(at));
                        }
                    }
                    continue;
                }
                Some(wrong) => {
                    let lines = places.iter().map(|at| source.position(*at).0).collect();
                    mistakes.add(with_lines(wrong, lines));
                }
                None => {}
            }
            once.insert(name);
        }
        once
    }
}

/// Adds the other lines in which the name stands.
fn with_lines(wrong: Diagnostic, mut lines: Vec<usize>) -> Diagnostic {
    lines.dedup();
    let Some((_, others @ [first, ..])) = lines.split_first() else { return wrong };
    let words = match others.len() {
        1 => format!("it stands in line {first} too"),
        count => {
            let shown: Vec<String> = others.iter().take(MOST_LINES).map(usize::to_string).collect();
            let more = if count > MOST_LINES { " and others" } else { "" };
            format!("it stands in lines {}{more} too", shown.join(", "))
        }
    };
    let help = wrong.help.clone().map_or(words.clone(), |help| format!("{help} ({words})"));
    wrong.help(help)
}
