//! One thing that is wrong or suspicious, at its place in the script.

use std::ops::Range;

use engine::diagnostic::Diagnostic;
pub use engine::diagnostic::Severity;
use engine::experiment::Plan;

/// One thing that is wrong or suspicious.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Finding {
    /// Its code, such as `W-UNIT`; `engine explain CODE` prints the page.
    pub code: &'static str,
    /// How bad it is.
    pub severity: Severity,
    /// What is wrong: one sentence.
    pub message: String,
    /// What is written beside the caret.
    pub label: String,
    /// What to change.
    pub help: String,
    /// The line of the script, from 1; 0 if it is about no line.
    pub line: usize,
    /// The column, from 1; 0 if it is about no line.
    pub column: usize,
    /// The bytes of the script.
    pub span: Range<usize>,
}

impl Finding {
    /// A warning at these bytes of the plan's script.
    #[must_use]
    pub fn warning(plan: &Plan, code: &'static str, span: Range<usize>, message: impl Into<String>) -> Self {
        let (line, column) = plan.behaviour.source().position(span.start);
        let (label, help) = (String::new(), String::new());
        Self { code, severity: Severity::Warning, message: message.into(), label, help, line, column, span }
    }

    /// Adds words beside the caret and a way out.
    #[must_use]
    pub fn say(mut self, label: impl Into<String>, help: impl Into<String>) -> Self {
        (self.label, self.help) = (label.into(), help.into());
        self
    }

    /// A failure of the script in a step.
    #[must_use]
    pub(super) fn of_error(plan: &Plan, error: &Diagnostic) -> Self {
        let span = error.place.as_ref().map_or(0..0, |place| place.span.clone());
        let label = error.place.as_ref().map_or_else(String::new, |place| place.label.clone());
        let finding = Self::warning(plan, error.code, span, error.message.clone());
        Self { severity: Severity::Error, ..finding.say(label, error.help.clone().unwrap_or_default()) }
    }

    /// For a terminal: the line with its caret.
    #[must_use]
    pub fn diagnostic(&self, plan: &Plan) -> Diagnostic {
        let diagnostic = Diagnostic::new(self.code, self.message.clone());
        diagnostic.at(plan.behaviour.source(), self.span.clone(), self.label.clone()).help(self.help.clone())
    }
}
