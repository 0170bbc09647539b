//! Diagnostics as text for a terminal and as JSON for machines.

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};

use super::{Diagnostic, Severity, printable};

impl Diagnostic {
    /// The error as it is shown on a terminal: message, place with a caret, help; then the further mistakes in the same
    /// way, and how many there are.
    #[must_use]
    pub fn render(&self, colour: bool) -> String {
        let mut blocks: Vec<_> = self.all().map(|one| one.render_as(Severity::Error, colour)).collect();
        blocks.extend(self.summary());
        blocks.join("\n\n")
    }

    /// This mistake and the further ones.
    pub fn all(&self) -> impl Iterator<Item = &Self> {
        std::iter::once(self).chain(&self.others)
    }

    /// How many mistakes there are and in which files: `3 mistakes in 'a.rhai'`; nothing for one alone.
    #[must_use]
    pub fn summary(&self) -> Option<String> {
        if self.others.is_empty() {
            return None;
        }
        let mut files: Vec<String> = Vec::new();
        for place in self.all().filter_map(|one| one.place.as_ref()) {
            let file = format!("'{}'", printable(&place.source.path.display().to_string()));
            if !files.contains(&file) {
                files.push(file);
            }
        }
        let shown = 1 + self.others.len();
        let files = if files.is_empty() { String::new() } else { format!(" in {}", files.join(" and ")) };
        let mistakes = format!("{} mistakes{files}", shown + self.left_out);
        Some(match self.left_out {
            0 => mistakes,
            more => format!("{mistakes}: {shown} are shown, and {more} more"),
        })
    }

    /// This one alone as an error, a warning or a note.
    #[must_use]
    pub fn render_as(&self, severity: Severity, colour: bool) -> String {
        let renderer = if colour { Renderer::styled() } else { Renderer::plain() };
        let path;
        let level = match severity {
            Severity::Error => Level::ERROR,
            Severity::Warning => Level::WARNING,
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
}
