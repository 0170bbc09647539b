//! Names that nothing defines: a misspelt one is told at each of its places, a missing definition once.

use super::explain;
use super::source::Code;
use crate::diagnostic::{Diagnostic, Mistakes};
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

    /// Adds the mistakes. Gives the names that look like no other, since whatever uses them is wrong too.
    pub(super) fn tell(
        mut self,
        code: &Code,
        variables: &[String],
        functions: &[String],
        mistakes: &mut Mistakes,
    ) -> BTreeSet<String> {
        // The tree is not walked in the order of the text, and a switch not even in the same order each time.
        self.0.sort_unstable();
        let mut missing: BTreeMap<(bool, String), (Diagnostic, Vec<usize>)> = BTreeMap::new();
        for (at, is_function, name) in self.0 {
            let (line, _) = code.source.position(at);
            let key = (is_function, name);
            if let Some((_, lines)) = missing.get_mut(&key) {
                lines.push(line);
            } else if mistakes.wants(&code.source, at) {
                let wrong = match is_function {
                    true => explain::unknown_function_at(&code.source, at, &key.1, functions),
                    false => explain::unknown_name_at(&code.source, at, &key.1, variables),
                };
                if wrong.help.as_ref().is_some_and(|help| help.starts_with("did you mean")) {
                    mistakes.add(wrong);
                } else if missing.len() < crate::diagnostic::MOST_MISTAKES {
                    missing.insert(key, (wrong, vec![line]));
                } else {
                    mistakes.add(wrong);
                }
            }
        }
        let names = missing.keys().map(|(_, name)| name.clone()).collect();
        missing.into_values().for_each(|(wrong, lines)| mistakes.add(with_lines(wrong, lines)));
        names
    }
}

/// The same with the other lines in which the name stands.
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
