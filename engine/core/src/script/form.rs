//! The form of a reward: what its rules, guards and functions say, numbers aside.

use super::Behaviour;
use std::ops::Range;

impl Behaviour {
    /// What its rules, guards and functions say without their numbers: alike for two scripts that differ in values, limits and
    /// times only. Names of rules say nothing, those of constants are numbers.
    #[must_use]
    pub fn reward_form(&self) -> String {
        let (compiled, outline, text) = (self.compiled(), self.outline(), &self.source().text);
        let named = |name: &str| compiled.constants.contains(name);
        let part = |span: &Range<usize>| form_of(&outline.with_measures(text, &text[span.clone()]), &named);
        let mut form: Vec<String> = Vec::new();
        for (rule, outlined) in compiled.rules.iter().zip(&outline.rules) {
            let (condition, value) = (part(&rule.condition_span), part(&rule.value_span));
            let waits = outlined.time_span.is_some();
            let ends = (rule.then, rule.to_place.as_ref().map(|(to, _)| to), rule.stages, rule.to_stage);
            form.push(format!("rule {condition} {waits} {value} {ends:?} {} {}", rule.once, rule.per_second));
        }
        form.extend(compiled.guards.iter().map(|guard| form_of(&guard.text.text, &named)));
        form.push(functions(text, &named));
        form.join("\n")
    }
}

/// A part of a script as its words, with `#` for each number.
fn form_of(text: &str, is_number: &dyn Fn(&str) -> bool) -> String {
    words(text).iter().map(|word| shown(word, is_number)).collect::<Vec<_>>().join(" ")
}

fn shown<'a>(word: &'a str, is_number: &dyn Fn(&str) -> bool) -> &'a str {
    if word.starts_with(|first: char| first.is_ascii_digit()) || is_number(word) { "#" } else { word }
}

/// All functions of a script.
fn functions(text: &str, is_number: &dyn Fn(&str) -> bool) -> String {
    let (mut kept, mut depth, mut inside) = (Vec::new(), 0_usize, false);
    for word in words(text) {
        inside |= depth == 0 && word == "fn";
        depth = match word {
            "{" => depth + 1,
            "}" => depth.saturating_sub(1),
            _ => depth,
        };
        if inside {
            kept.push(shown(word, is_number));
        }
        inside &= depth > 0 || word != "}";
    }
    kept.join(" ")
}

/// The words of a script: names, numbers, strings, and each other sign by itself; no comments.
fn words(text: &str) -> Vec<&str> {
    let (mut words, mut rest) = (Vec::new(), text.trim_start());
    while let Some(first) = rest.chars().next() {
        let in_word = |c: char| c.is_alphanumeric() || c == '_';
        let length = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            rest.find("*/").map_or(rest.len(), |end| end + 2)
        } else if first == '"' || first == '`' {
            end_of_string(rest, first)
        } else if first.is_ascii_digit() {
            end_of_number(rest)
        } else if in_word(first) {
            rest.find(|c| !in_word(c)).unwrap_or(rest.len())
        } else {
            first.len_utf8()
        };
        let word = &rest[..length];
        if !word.starts_with("//") && !word.starts_with("/*") {
            words.push(word);
        }
        rest = rest[length..].trim_start();
    }
    words
}

fn end_of_string(text: &str, quote: char) -> usize {
    let mut escaped = false;
    for (at, c) in text.char_indices().skip(1) {
        if c == quote && !escaped {
            return at + c.len_utf8();
        }
        escaped = c == '\\' && !escaped;
    }
    text.len()
}

/// A point belongs to a number if a digit follows it: `1..5` is a range.
fn end_of_number(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digit = |at: usize| bytes.get(at).is_some_and(u8::is_ascii_digit);
    let mut at = 0;
    while at < bytes.len() {
        let part = bytes[at].is_ascii_alphanumeric() || bytes[at] == b'_';
        let point = bytes[at] == b'.' && digit(at + 1);
        let sign = matches!(bytes[at], b'-' | b'+') && matches!(bytes[at - 1], b'e' | b'E') && digit(at + 1);
        if !(part || point || sign) {
            break;
        }
        at += 1;
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostic::SourceText;

    fn form(rules: &str) -> String {
        let script = format!("world(\"room\");\nconst NEAR = 0.25;\n{rules}");
        Behaviour::parse("own", SourceText::new("scripts/own.rhai", script)).unwrap().reward_form()
    }

    #[test]
    fn numbers_names_and_comments_are_no_form() {
        let rule = form("rule \"near\" when laser.nearest <= NEAR => -1 then recover;");
        assert_eq!(form("rule \"close\" when laser.nearest <= 0.4 /* m */ => -2.5 then recover; // more"), rule);
        assert_ne!(form("rule \"near\" when laser.nearest < NEAR => -1 then recover;"), rule);
        assert_ne!(form("rule \"near\" when laser.left <= NEAR => -1 then recover;"), rule);
        assert_ne!(form("rule \"near\" when laser.nearest <= NEAR => -1;"), rule);
        assert_ne!(form("rule \"near\" when laser.nearest <= NEAR for 2 seconds => -1 then recover;"), rule);
    }

    #[test]
    fn a_time_is_a_number_and_a_measure_is_part_of_what_reads_it() {
        let waits =
            |time| form(&format!("rule \"lost\" when laser.right > 1.0 for {time} seconds => -1 then recover;"));
        assert_eq!(waits("6"), waits("2.5"));
        let measured = |what| form(&format!("measure way = {what};\nrule \"lost\" when way > 1.0 => -1 then recover;"));
        assert_ne!(measured("laser.right"), measured("laser.left"));
    }

    #[test]
    fn a_function_has_the_form_of_its_words() {
        let reward = |body: &str| form(&format!("fn reward(facts) {{ {body} }}"));
        assert_eq!(
            reward("if facts.robot.contact { -1.0 } else { 0.0 }"),
            reward("if facts.robot.contact { -2.0 } else { 0.5 }")
        );
        assert_ne!(
            reward("if facts.robot.contact { -1.0 } else { 0.0 }"),
            reward("if !facts.robot.contact { -1.0 } else { 0.0 }")
        );
    }
}
