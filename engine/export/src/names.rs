//! What digits, stages and guards are called in the other languages.

use crate::model::{Model, Told};
use crate::text::{identifier, plain};

/// A digit that the other program says.
pub(crate) struct DigitName {
    pub name: String,
    /// As the script has it.
    pub script: String,
    pub values: usize,
    pub how: Told,
}

/// The digits in their order, each with a name of its own.
pub(crate) fn digits(model: &Model) -> Vec<DigitName> {
    let mut taken = Vec::new();
    let one = |(name, values, how): (&str, usize, &Told)| DigitName {
        name: unlike(&mut taken, identifier(name)),
        script: plain(name),
        values,
        how: how.clone(),
    };
    model.told().map(one).collect()
}

/// The guards in their order: a name of its own each, what the script calls it, and its text.
pub(crate) fn guards(model: &Model) -> Vec<(String, String, String)> {
    let mut taken = Vec::new();
    let guards = model.guards.iter();
    guards.map(|guard| (unlike(&mut taken, identifier(&guard.name)), plain(&guard.name), plain(&guard.text))).collect()
}

/// Stages, a name of its own each.
pub(crate) fn stages(stages: &[String]) -> Vec<String> {
    let mut taken = Vec::new();
    stages.iter().map(|stage| unlike(&mut taken, identifier(stage))).collect()
}

fn unlike(taken: &mut Vec<String>, name: String) -> String {
    let numbered = (2..).map(|number| format!("{name}_{number}"));
    let free = std::iter::once(name.clone()).chain(numbered).find(|name| !taken.contains(name)).unwrap_or(name);
    taken.push(free.clone());
    free
}
