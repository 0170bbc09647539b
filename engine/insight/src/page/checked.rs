//! What a check of the script found, and whether its reward can be earned by cheating.

use serde::Serialize;

use crate::lint::{Exploits, Report, Severity};

/// Something that a check of the script found.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct FindingView {
    /// Its code.
    pub code: String,
    /// How bad it is.
    pub severity: Severity,
    /// What is wrong.
    pub message: String,
    /// The line in the script, from 1, if it has one.
    pub line: Option<usize>,
    /// What was seen there.
    pub label: Option<String>,
    /// What to do.
    pub help: Option<String>,
}

/// The outcome of trying the behaviour out; its findings are in [`Document::findings`](super::Document::findings).
#[derive(Debug, Clone, Serialize)]
pub struct CheckView {
    /// Steps that were tried.
    pub steps: u64,
    /// How many findings there was no room for.
    pub left_out: usize,
    /// What cheats would earn; null if policies are combined or a step failed.
    pub exploits: Option<Exploits>,
}

impl From<&crate::lint::Finding> for FindingView {
    fn from(found: &crate::lint::Finding) -> Self {
        let said = |words: &String| Some(words.clone()).filter(|words| !words.is_empty());
        Self {
            code: found.code.to_owned(),
            severity: found.severity,
            message: found.message.clone(),
            line: Some(found.line).filter(|line| *line > 0),
            label: said(&found.label),
            help: said(&found.help),
        }
    }
}

impl From<&Report> for CheckView {
    fn from(report: &Report) -> Self {
        Self { steps: report.steps, left_out: report.left_out, exploits: report.exploits.clone() }
    }
}
