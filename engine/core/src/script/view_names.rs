//! The names of a script's views: each is a group of facts, like `camera`, so they must be known before anything is parsed.

use super::source::Code;
use super::syntax::begins_a_statement;
use crate::diagnostic::{Diagnostic, Mistakes};
use crate::judge::fact_table::{GROUPS, is_group};
use crate::judge::functions::{FUNCTIONS, WINDOWS};
use crate::settings::UNNAMED_VIEW;
use std::ops::Range;

/// A word that Rhai or the rules keep for themselves.
const RESERVED: &[&str] = &[
    "if",
    "else",
    "let",
    "const",
    "fn",
    "for",
    "in",
    "while",
    "loop",
    "do",
    "until",
    "return",
    "throw",
    "try",
    "catch",
    "import",
    "export",
    "as",
    "private",
    "this",
    "true",
    "false",
    "switch",
    "break",
    "continue",
    "new",
    "static",
    "var",
    "rule",
    "when",
    "then",
    "once",
    "per",
    "success",
    "measure",
    "bins",
    "facts",
    "calibrated",
    "test",
    "untrained",
    "sector",
];

/// The views that a script names, as its text has them.
#[derive(Debug, Default)]
pub(super) struct ViewNames {
    names: Vec<(String, Range<usize>)>,
    /// Where a view is named by something else than a text.
    nameless: Vec<usize>,
    /// Whether there is a view without a name.
    unnamed: bool,
}

impl ViewNames {
    /// Found in the text: `plain` is without what stands in quotes, `text` with it.
    pub(super) fn of(code: &Code) -> Self {
        if !begins_a_statement(code, "view", |tail| tail.starts_with('(')) || code.function("view").is_some() {
            return Self { unnamed: true, ..Self::default() };
        }
        let (mut names, mut nameless) = (Vec::new(), Vec::new());
        for (_, open) in calls(&code.plain, "view") {
            let quote = open + code.plain[open..].len() - code.plain[open..].trim_start().len();
            let quoted = code.parsed[quote..].strip_prefix('"').and_then(|text| text.split_once('"'));
            match quoted {
                Some((name, _)) => names.push((name.to_owned(), quote + 1..quote + 1 + name.len())),
                None => nameless.push(quote),
            }
        }
        let bare = ["filter", "grid"].into_iter().flat_map(|word| calls(&code.plain, word));
        let unnamed = bare.into_iter().any(|(at, _)| depth(&code.plain[..at]) == 0);
        Self { names, nameless, unnamed }
    }

    /// The group in the list of facts that a name stands for: its own, or that of the views.
    pub(super) fn group_of(&self, name: &str) -> Option<&'static str> {
        if self.names.iter().any(|(known, _)| known == name) {
            return Some(UNNAMED_VIEW);
        }
        let group = GROUPS.iter().map(|(group, _)| *group).find(|group| *group == name)?;
        (group != UNNAMED_VIEW || self.unnamed).then_some(group)
    }

    /// The names of all views in the order of their numbers: that without a name is the first.
    pub(super) fn all(&self) -> Vec<String> {
        let unnamed = self.unnamed.then(|| UNNAMED_VIEW.to_owned());
        unnamed.into_iter().chain(self.names.iter().map(|(name, _)| name.clone())).collect()
    }

    /// The number of a view.
    pub(super) fn index(&self, name: &str) -> Option<usize> {
        if name == UNNAMED_VIEW {
            return self.unnamed.then_some(0);
        }
        let at = self.names.iter().position(|(known, _)| known == name)?;
        Some(at + usize::from(self.unnamed))
    }

    /// Adds every name that cannot be one.
    pub(super) fn check(&self, code: &Code, variables: &[String], mistakes: &mut Mistakes) {
        for (index, (name, span)) in self.names.iter().enumerate() {
            let named_before = self.names[..index].iter().any(|(before, _)| before == name);
            let word = name.starts_with(|c: char| c.is_ascii_lowercase())
                && name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_');
            let message = match () {
                () if !word => "the name of a view is a word in small letters: its facts are read by it".to_owned(),
                () if named_before => format!("there are two views called '{name}'"),
                () if is_group(name) => format!("'{name}' is the name of facts"),
                () if variables.contains(name) => format!("there is a variable called '{name}'"),
                () if RESERVED.contains(&name.as_str()) => format!("'{name}' is a word of the language"),
                () if FUNCTIONS.iter().chain(WINDOWS).any(|row| row.name == name) => {
                    format!("'{name}' is the name of one of the engine's functions")
                }
                () => continue,
            };
            let wrong = Diagnostic::new("E-SCRIPT-VIEW", message).at(&code.source, span.clone(), "named here");
            mistakes.add(wrong.help("choose another name: view(\"red\", filter(\"colour\"))"));
        }
        for at in &self.nameless {
            let message = "the name of a view stands in quotes in the call itself: its facts are read by it";
            let wrong = Diagnostic::new("E-SCRIPT-VIEW", message).at(&code.source, *at..*at + 1, "no name in quotes");
            mistakes.add(wrong.help("write view(\"red\", filter(\"colour\"))"));
        }
    }
}

/// Where each call of a function begins, and where its bracket ends.
fn calls<'a>(plain: &'a str, name: &'a str) -> impl Iterator<Item = (usize, usize)> + 'a {
    let part = |c: char| c.is_alphanumeric() || matches!(c, '_' | '.');
    plain.match_indices(name).filter_map(move |(at, _)| {
        let tail = &plain[at + name.len()..];
        let open = plain.len() - tail.trim_start().len();
        (!plain[..at].ends_with(part) && tail.trim_start().starts_with('(')).then_some((at, open + 1))
    })
}

/// How many brackets are open at the end of a text.
fn depth(plain: &str) -> i32 {
    plain.chars().fold(0, |depth, c| match c {
        '(' | '[' | '{' => depth + 1,
        ')' | ']' | '}' => depth - 1,
        _ => depth,
    })
}
