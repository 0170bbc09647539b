//! `is` as the key of a map, as filters by a condition have it: Rhai keeps the word to itself.

use super::source::Code;
use rhai::{Engine, Position, Token};

/// Lets `is:` be a key where a script writes it so; elsewhere the word stays what it is.
pub(super) fn allow(engine: &mut Engine, code: &Code) {
    let part = |c: char| c.is_alphanumeric() || c == '_';
    let keys = code
        .plain
        .match_indices("is")
        .filter(|(at, _)| !code.plain[..*at].ends_with(part) && code.plain[at + 2..].trim_start().starts_with(':'));
    let places: Vec<(usize, usize)> = keys.map(|(at, _)| code.source.position(at)).collect();
    if places.is_empty() {
        return;
    }
    let is_key = move |at: Position| at.line().zip(at.position()).is_some_and(|place| places.contains(&place));
    #[expect(deprecated, reason = "Rhai calls it unstable; its version is pinned")]
    engine.on_parse_token(move |token, position, _| match token {
        Token::Reserved(word) if *word == "is" && is_key(position) => Token::Identifier(word),
        token => token,
    });
}
