//! Diagnostics as text for a terminal and as JSON for machines.

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};

use super::{Diagnostic, Severity};

impl Diagnostic {
    /// The error as it is shown on a terminal: message, place with a caret, help.
    #[must_use]
    pub fn render(&self, colour: bool) -> String {
        self.render_as(Severity::Error, colour)
    }

    /// The same as an error, a warning or a note.
    #[must_use]
    pub fn render_as(&self, severity: Severity, colour: bool) -> String {
        let renderer = if colour { Renderer::styled() } else { Renderer::plain() };
        let path;
        let level = match severity {
            Severity::Error => Level::ERROR,
            Severity::Warning => Level::WARNING,
            Severity::Note => Level::NOTE,
        };
        let mut group = level.primary_title(&self.message).id(self.code);
        let mut report = Vec::new();
        if let Some(place) = &self.place {
            path = place.source.path.display().to_string();
            let length = place.source.text.len();
            let span = place.span.start.min(length)..place.span.end.min(length);
            let snippet = Snippet::source(&*place.source.text)
                .path(&path)
                .annotation(AnnotationKind::Primary.span(span).label(&place.label));
            let mut element = group.element(snippet);
            if let Some(help) = &self.help {
                element = element.element(Level::HELP.message(help));
            }
            report.push(element);
        } else {
            group = group.id(self.code);
            let mut element = annotate_snippets::Group::with_title(group);
            if let Some(help) = &self.help {
                element = element.element(Level::HELP.message(help));
            }
            report.push(element);
        }
        renderer.render(&report)
    }

    /// The error as one JSON object: code, message, file, line, column, help.
    #[must_use]
    pub fn to_json(&self) -> serde_json::Value {
        let position = self.place.as_ref().map(|place| place.source.position(place.span.start));
        serde_json::json!({
            "code": self.code,
            "message": self.message,
            "file": self.place.as_ref().map(|place| place.source.path.display().to_string()),
            "line": position.map(|(line, _)| line),
            "column": position.map(|(_, column)| column),
            "found": self.place.as_ref().map(|place| place.label.clone()),
            "help": self.help,
        })
    }
}
