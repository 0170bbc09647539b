//! A page that is whole in one file and runs no script.

use engine::diagnostic::is_hidden;
use maud::{DOCTYPE, Markup, PreEscaped, html};

/// Nothing is loaded but pictures in the page itself, and no script runs.
const POLICY: &str = "default-src 'none'; img-src data:; style-src 'unsafe-inline'";

/// The page with this title, style sheet and body, as one HTML text.
#[must_use]
pub fn page_without_scripts(title: &str, style: &str, body: &Markup) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta http-equiv="Content-Security-Policy" content=(POLICY);
                title { (title) }
                style { (PreEscaped(style)) }
            }
            body { (body) }
        }
    };
    // Whatever stands on it: nothing turns a line around.
    let seen = |c: char| if is_hidden(c) && !matches!(c, '\n' | '\t') { char::REPLACEMENT_CHARACTER } else { c };
    page.into_string().chars().map(seen).collect()
}
