//! A mistake as programs read it: one shape for errors and for findings, one line for editors.

use std::fmt;

use super::{Diagnostic, Severity};

/// One mistake, with its place counted as editors count: lines and columns from 1, columns in characters, the end exclusive.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Told {
    /// Its code; `engine explain CODE` prints the page.
    pub code: &'static str,
    /// How bad it is.
    pub severity: Severity,
    /// What is wrong: one sentence.
    pub message: String,
    /// The file, as the user named it; null where it is in no file.
    pub file: Option<String>,
    /// Where it begins.
    pub line: Option<usize>,
    /// Where it begins.
    pub column: Option<usize>,
    /// Where it ends.
    pub end_line: Option<usize>,
    /// Where it ends, the first column after it.
    pub end_column: Option<usize>,
    /// What stands beside the caret: what was found.
    pub found: Option<String>,
    /// What to type or change next.
    pub help: Option<String>,
}

impl Diagnostic {
    /// This one alone, without the others.
    #[must_use]
    pub fn told(&self, severity: Severity) -> Told {
        let place = self.place.as_ref();
        let start = place.map(|place| place.source.position(place.span.start));
        let end = place.map(|place| place.source.position(place.span.end.max(place.span.start)));
        Told {
            code: self.code,
            severity,
            message: self.message.clone(),
            file: place.map(|place| place.source.path.display().to_string()),
            line: start.map(|start| start.0),
            column: start.map(|start| start.1),
            end_line: end.map(|end| end.0),
            end_column: end.map(|end| end.1),
            found: place.map(|place| place.label.clone()).filter(|label| !label.is_empty()),
            help: self.help.clone(),
        }
    }

    /// This one and the others as errors, in their order.
    #[must_use]
    pub fn told_with_others(&self) -> Vec<Told> {
        std::iter::once(self).chain(&self.others).map(|one| one.told(Severity::Error)).collect()
    }

    /// The error as one JSON object: its fields as in [`Told`]; and the further mistakes, each such an object, as `others`,
    /// with the number of those `left_out`.
    #[must_use]
    pub fn to_json(&self) -> serde_json::Value {
        let mut object = serde_json::json!(self.told(Severity::Error));
        object["others"] = self.others.iter().map(|one| serde_json::json!(one.told(Severity::Error))).collect();
        object["left_out"] = self.left_out.into();
        object
    }
}

/// One line for editors and for text search: `file:line:column: code message`, without the place where there is none.
impl fmt::Display for Told {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let (Some(file), Some(line), Some(column)) = (&self.file, self.line, self.column) {
            write!(f, "{file}:{line}:{column}: ")?;
        }
        write!(f, "{} {}", self.code, self.message)
    }
}
