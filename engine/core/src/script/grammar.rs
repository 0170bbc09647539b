//! A TextMate grammar of behaviour scripts, from the tables by which they are read: for editors that colour by rules.

use super::reference_json::STATEMENTS;
use super::setup_table::SETUP;
use crate::judge::fact_table::GROUPS;
use crate::judge::functions::{FUNCTIONS, WINDOWS};
use serde_json::{Value as Json, json};

/// Words of rules besides the statements: what stands between a name and a value, and behind it.
const WORDS_OF_RULES: &[&str] =
    &["in", "when", "for", "once", "per", "then", "to", "steps", "step", "seconds", "second", "stage"];
/// What ends an attempt.
const ENDINGS: &[&str] = &["fail", "goal", "restart", "recover"];
/// Words of Rhai that a script may use.
const WORDS_OF_RHAI: &[&str] =
    &["let", "const", "fn", "if", "else", "while", "loop", "in", "return", "break", "continue", "switch"];

/// The grammar as JSON, as it stands in `docs/editor/behaviour.tmLanguage.json`.
#[must_use]
pub fn grammar() -> Json {
    // Later ones see only what earlier ones leave.
    let patterns = [
        json!({ "name": "comment.line.double-slash.rhai", "match": "//.*$" }),
        json!({ "name": "comment.block.rhai", "begin": "/\\*", "end": "\\*/" }),
        json!({ "name": "string.quoted.double.rhai", "begin": "\"", "end": "\"",
                "patterns": [{ "name": "constant.character.escape.rhai", "match": "\\\\." }] }),
        json!({ "name": "constant.numeric.rhai", "match": "\\b[0-9][0-9_]*(\\.[0-9]+)?([eE][-+]?[0-9]+)?\\b" }),
        json!({ "name": "constant.language.rhai", "match": "\\b(true|false)\\b" }),
        words("keyword.other.statement.behaviour", &statements(), "(?=\\s+[\"a-z_])"),
        words("keyword.control.ending.behaviour", ENDINGS, "(?=\\s*(;|$|to\\b|then\\b))"),
        words("keyword.control.rhai", WORDS_OF_RHAI, ""),
        words("keyword.other.rule.behaviour", WORDS_OF_RULES, "(?!\\s*[.(\\[=])"),
        words("support.function.setup.behaviour", &SETUP.iter().map(|row| row.name).collect::<Vec<_>>(), "(?=\\s*\\()"),
        words("support.function.setup.behaviour", &["bins"], "(?=\\s*\\()"),
        words("support.function.behaviour", &functions(), "(?=\\s*\\()"),
        words("support.variable.facts.behaviour", &groups(), "(?=\\s*[.\\[])"),
        json!({ "name": "variable.other.member.rhai", "match": "(?<=\\.)[a-z_][a-z0-9_]*" }),
        json!({ "name": "keyword.operator.rhai", "match": "=>|&&|\\|\\||[<>=!]=|[-+*/%<>!=]" }),
    ];
    json!({
        "name": "Behaviour script",
        "scopeName": "source.rhai.behaviour",
        "fileTypes": ["rhai"],
        "patterns": patterns,
    })
}

/// Whole words, with what must stand behind them.
fn words(name: &str, words: &[&str], behind: &str) -> Json {
    let mut words = words.to_vec();
    words.sort_unstable();
    words.dedup();
    json!({ "name": name, "match": format!("(?<![.\\w])({})\\b{behind}", words.join("|")) })
}

fn statements() -> Vec<&'static str> {
    STATEMENTS.iter().map(|(word, ..)| *word).filter(|word| *word != "bins").collect()
}

fn functions() -> Vec<&'static str> {
    FUNCTIONS.iter().chain(WINDOWS).map(|row| row.name).collect()
}

fn groups() -> Vec<&'static str> {
    GROUPS.iter().map(|(name, _)| *name).chain(["previous", "facts", "test", "untrained", "calibrated"]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::SETTINGS;
    use std::path::Path;

    #[test]
    fn the_grammar_for_editors_is_the_generated_one() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/editor/behaviour.tmLanguage.json");
        let text = serde_json::to_string_pretty(&grammar()).unwrap() + "\n";
        if std::env::var_os("UPDATE_PAGES").is_some() {
            std::fs::write(&path, &text).unwrap();
        }
        assert!(std::fs::read_to_string(&path).unwrap() == text, "run the tests with UPDATE_PAGES=1");
    }

    #[test]
    fn every_word_of_the_language_has_a_colour() {
        let text = grammar().to_string();
        let has = |word: &str| [format!("({word}|"), format!("|{word}|"), format!("|{word})"), format!("({word})")];
        let coloured = |word: &str| has(word).iter().any(|form| text.contains(form.as_str()));
        let setup = SETUP.iter().map(|row| row.name);
        let groups = SETTINGS.iter().map(|row| row.group).chain(GROUPS.iter().map(|(name, _)| *name));
        let all = setup.chain(groups).chain(STATEMENTS.iter().map(|(word, ..)| *word));
        for word in all.chain(WINDOWS.iter().chain(FUNCTIONS).map(|row| row.name)) {
            assert!(coloured(word), "{word}");
        }
    }
}
