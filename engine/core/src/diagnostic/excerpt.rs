//! Lines of a source with words under them, for findings and explanations.

use std::ops::Range;

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};

use super::SourceText;

/// A title over lines of a source, each place underlined with its words beside it.
#[must_use]
pub fn excerpt(title: &str, source: &SourceText, places: &[(Range<usize>, String)], colour: bool) -> String {
    let renderer = if colour { Renderer::styled() } else { Renderer::plain() };
    let path = source.path.display().to_string();
    let length = source.text.len();
    let notes = places.iter().map(|(span, words)| {
        AnnotationKind::Primary.span(span.start.min(length)..span.end.min(length)).label(words.as_str())
    });
    let snippet = Snippet::source(&*source.text).path(&path).annotations(notes);
    renderer.render(&[Level::NOTE.primary_title(title).element(snippet)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_stand_under_the_place_they_are_about() {
        let source = SourceText::new("a.rhai", "world(\"room\");\nrule \"near\" when laser.nearest < 0.3 => -1;\n");
        let start = source.offset(2, 18);
        let text = excerpt("it fired", &source, &[(start..start + 19, "0.2 m".to_owned())], false);
        assert!(text.contains("note: it fired") && text.contains("a.rhai:2:18"), "{text}");
        assert!(text.contains("^^^^^^^^^^^^^^^^^^^ 0.2 m"), "{text}");
    }
}
