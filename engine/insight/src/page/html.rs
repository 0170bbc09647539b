//! The page itself: the files of `web/`, one document of data, and a policy that lets nothing else run or load.

use super::document::Document;
use crate::markup::{Escaped, base64};
use engine::diagnostic::{Diagnostic, Result};
use engine::digest::Digest;

const HTML: &str = include_str!("web/index.html");
const STYLE: &str = include_str!("web/style.css");
/// Each after those that it uses.
const SCRIPTS: &[&str] = &[
    include_str!("web/data.js"),
    include_str!("web/drawing.js"),
    include_str!("web/map.js"),
    include_str!("web/curve.js"),
    include_str!("web/timeline.js"),
    include_str!("web/frames.js"),
    include_str!("web/states.js"),
    include_str!("web/seeds.js"),
    include_str!("web/reasons.js"),
    include_str!("web/findings.js"),
    include_str!("web/spoken.js"),
    include_str!("web/live.js"),
    include_str!("web/app.js"),
];

/// A whole page.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Page {
    /// The file.
    pub html: String,
    /// What the browser may run and load: the value of the header `Content-Security-Policy`.
    pub policy: String,
}

/// The page with a document in it; without one, the page asks the server that it came from.
///
/// # Errors
/// Never in practice: only if the document cannot be written as JSON.
pub fn page(document: Option<&Document>) -> Result<Page> {
    let data = serde_json::to_string(&document)
        .map_err(|error| Box::new(Diagnostic::new("E-IO", format!("cannot write the data of the page: {error}"))))?;
    // Within a script element only "<" can end it or begin something else.
    let data = data.replace('<', "\\u003c");
    let script = SCRIPTS.concat();
    let connect = if document.is_none() { "'self'" } else { "'none'" };
    let policy = format!(
        "default-src 'none'; script-src 'sha256-{}'; style-src 'sha256-{}'; img-src data:; connect-src {connect}; \
         base-uri 'none'; form-action 'none'",
        digest(&script),
        digest(STYLE)
    );
    let title = document
        .map_or("engine watch".to_owned(), |document| format!("{} in {}", document.behaviour, document.world.name));
    let mut html = String::with_capacity(HTML.len() + STYLE.len() + script.len() + data.len());
    let mut rest = HTML;
    for (mark, text) in [
        ("{{policy}}", policy.as_str()),
        ("{{title}}", &Escaped(&title).to_string()),
        ("{{style}}", STYLE),
        ("{{data}}", &data),
        ("{{script}}", &script),
    ] {
        let (before, after) = rest.split_once(mark).unwrap_or((rest, ""));
        html.push_str(before);
        html.push_str(text);
        rest = after;
    }
    html.push_str(rest);
    Ok(Page { html, policy })
}

fn digest(text: &str) -> String {
    base64(Digest::of(text.as_bytes()).bytes())
}
