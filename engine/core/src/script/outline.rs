//! What a script says, told apart for whoever looks for mistakes in it: comparisons, conditions, loops, names.

use crate::judge::{Comparison, FactId};
use crate::outcome::Then;
use std::ops::Range;

/// A fact as a script names it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NamedFact {
    /// Which fact it is.
    pub id: FactId,
    /// Its path, without spaces and without `facts.`: `laser.sector(50,130).nearest`.
    pub path: String,
}

/// A fact against a fixed number.
#[derive(Debug, Clone, PartialEq)]
pub struct Compared {
    /// The fact.
    pub fact: NamedFact,
    /// Whether its absolute value is compared.
    pub absolute: bool,
    /// How; the fact stands on the left.
    pub comparison: Comparison,
    /// With what.
    pub limit: f64,
    /// Its bytes in the script, from the left side's first to the end of its line's expression at most.
    pub span: Range<usize>,
}

/// A condition as far as it is understood.
#[derive(Debug, Clone, PartialEq)]
pub enum Condition {
    /// A fact against a number.
    Compare(Compared),
    /// A fact that is true or false, and whether it is denied.
    Flag(NamedFact, bool),
    /// All of these.
    All(Vec<Condition>),
    /// Any of these.
    Any(Vec<Condition>),
    /// Something else.
    Other,
}

impl Condition {
    /// Whether it asks for a fact to be true, by itself or beside others.
    #[must_use]
    pub fn asks_for(&self, fact: FactId) -> bool {
        match self {
            Self::Flag(named, denied) => named.id == fact && !denied,
            Self::All(parts) | Self::Any(parts) => parts.iter().any(|part| part.asks_for(fact)),
            Self::Compare(_) | Self::Other => false,
        }
    }
}

/// One rule.
#[derive(Debug, Clone, PartialEq)]
pub struct RuleOutline {
    /// Its condition.
    pub condition: Condition,
    /// The bytes of the condition.
    pub condition_span: Range<usize>,
    /// The bytes of the value.
    pub value_span: Range<usize>,
    /// The bytes of the time after `for`.
    pub time_span: Option<Range<usize>>,
    /// What it says if it ends the attempt.
    pub then: Option<Then>,
    /// The stages in which it is judged, a bit for each; nothing for all.
    pub stages: Option<u32>,
    /// The stage that it leads to.
    pub leads_to: Option<usize>,
}

/// What a loop over the beams of the laser gathers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Gathers {
    /// How many there are of something.
    Count,
    /// A sum.
    Sum,
    /// Something else, most often the least.
    Other,
}

/// A loop in a function that reads the laser beam by beam.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BeamLoop {
    /// The bytes of its first line, from its first word.
    pub span: Range<usize>,
    /// The beams that it goes over, where these are plain numbers.
    pub beams: Option<(i64, i64)>,
    /// What it gathers.
    pub gathers: Gathers,
}

/// Something that stands in the script and that nothing uses.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnusedName {
    /// What it is: `constant`, `variable` or `function`.
    pub what: &'static str,
    /// Its name.
    pub name: String,
    /// The bytes of the name where it is defined.
    pub span: Range<usize>,
}

/// What a script says.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ScriptOutline {
    /// The rules in their order.
    pub rules: Vec<RuleOutline>,
    /// Comparisons in functions.
    pub(super) comparisons: Vec<Compared>,
    /// Loops over beams in `fn reward` and what it calls.
    pub loops: Vec<BeamLoop>,
    /// The groups of facts that rules and `fn reward` read, in the order of the alphabet.
    pub groups: Vec<String>,
    /// Where the name of `fn reward` stands.
    pub reward: Option<Range<usize>>,
    /// Whether `fn reward` can ask for recovery.
    pub(super) reward_recovers: bool,
    /// Rules that `fired` or `since` name.
    pub remembered: Vec<String>,
    /// The measures, each with the bytes of its expression.
    pub measures: Vec<(String, Range<usize>)>,
    /// Names that nothing uses.
    pub unused: Vec<UnusedName>,
}

impl ScriptOutline {
    /// Whether anything can ask for recovery.
    #[must_use]
    pub fn recovers(&self) -> bool {
        self.reward_recovers || self.rules.iter().any(|rule| rule.then.is_some())
    }

    /// A part of the script's text, followed by the expressions of the measures that it names, and of those that these name.
    #[must_use]
    pub fn with_measures(&self, text: &str, part: &str) -> String {
        let mut whole = part.to_owned();
        // A measure reads only those above it.
        for (name, span) in self.measures.iter().rev() {
            let part = |c: char| c.is_alphanumeric() || c == '_';
            if whole.split(|c| !part(c)).any(|word| word == name) {
                whole.push(' ');
                whole.push_str(&text[span.clone()]);
            }
        }
        whole
    }

    /// Every comparison: of rules, then of functions.
    pub fn all_comparisons(&self) -> impl Iterator<Item = &Compared> {
        self.rules.iter().flat_map(|rule| rule.condition.comparisons()).chain(&self.comparisons)
    }
}

impl Condition {
    /// The comparisons in it.
    #[must_use]
    pub(super) fn comparisons(&self) -> Vec<&Compared> {
        match self {
            Self::Compare(compared) => vec![compared],
            Self::All(parts) | Self::Any(parts) => parts.iter().flat_map(Self::comparisons).collect(),
            _ => Vec::new(),
        }
    }
}
