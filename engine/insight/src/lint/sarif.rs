//! Findings as SARIF, the form in which code hosts and editors take what a tool has found.

use engine::diagnostic::{Severity, Told, code_page};
use serde_json::{Value, json};

/// The findings as one log of SARIF 2.1.0 (OASIS, 2020), with the pages of their codes as its rules.
#[must_use]
pub fn sarif(told: &[Told]) -> Value {
    let mut codes: Vec<&str> = told.iter().map(|one| one.code).collect();
    codes.sort_unstable();
    codes.dedup();
    let rule = |code: &&str| {
        let page = code_page(code).unwrap_or_default();
        let first = page.lines().next().unwrap_or_default();
        json!({ "id": code, "shortDescription": { "text": first }, "fullDescription": { "text": page } })
    };
    json!({
        "$schema": "https://json.schemastore.org/sarif-2.1.0.json",
        "version": "2.1.0",
        "runs": [{
            "tool": { "driver": {
                "name": "engine",
                "version": env!("CARGO_PKG_VERSION"),
                "rules": codes.iter().map(rule).collect::<Vec<_>>(),
            }},
            "columnKind": "unicodeCodePoints",
            "results": told.iter().map(result).collect::<Vec<_>>(),
        }],
    })
}

fn result(told: &Told) -> Value {
    let level = match told.severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
    };
    let further = [&told.found, &told.help].into_iter().flatten().map(String::as_str);
    let text: Vec<&str> = std::iter::once(told.message.as_str()).chain(further).collect();
    let location = told.file.as_ref().map(|file| {
        // Beside a script stand slashes, whatever the system.
        let address = file.replace('\\', "/");
        json!({ "physicalLocation": {
            "artifactLocation": { "uri": address },
            "region": {
                "startLine": told.line, "startColumn": told.column, "endLine": told.end_line, "endColumn": told.end_column,
            },
        }})
    });
    json!({
        "ruleId": told.code,
        "level": level,
        "message": { "text": text.join("\n") },
        "locations": location.into_iter().collect::<Vec<_>>(),
    })
}
