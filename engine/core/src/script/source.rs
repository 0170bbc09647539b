//! The text of a script: read from disk, checked for what must not be in it, and its plain code.

use super::view_names::ViewNames;
use crate::diagnostic::{Diagnostic, Mistakes, Result, SourceText, nearest_name, printable};
use std::collections::BTreeSet;
use std::ops::Range;
use std::path::Path;

/// Longest script, bytes.
pub(super) const MAX_BYTES: u64 = 1 << 20;

/// Reads a script.
///
/// # Errors
/// If there is no such file (with the near names in its folder), or it is no text that can be a script.
pub(super) fn read(path: &Path) -> Result<SourceText> {
    let wrong = |message: String| Diagnostic::new("E-SCRIPT-FILE", message);
    let shown = printable(&path.display().to_string());
    let metadata = match std::fs::metadata(path) {
        Ok(metadata) => metadata,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            return wrong(format!("there is no script '{shown}'")).help(near_files(path)).fail();
        }
        Err(error) => return Err(unreadable(path, &error)),
    };
    if metadata.is_dir() {
        let help = near_files(&path.join("script.rhai"));
        return wrong(format!("'{shown}' is a folder, not a script")).help(help).fail();
    }
    if !metadata.is_file() {
        return wrong(format!("'{shown}' is not an ordinary file")).fail();
    }
    if metadata.len() > MAX_BYTES {
        let message = format!("'{shown}' is too long for a script: {} bytes, at most {MAX_BYTES}", metadata.len());
        return Diagnostic::new("E-SCRIPT-SOURCE", message).fail();
    }
    let bytes = std::fs::read(path).map_err(|error| unreadable(path, &error))?;
    if let Some(form) = other_form(&bytes) {
        let message = format!("'{shown}' is {form}, not a script");
        return Diagnostic::new("E-SCRIPT-SOURCE", message).help("a script is a text file, '.rhai'").fail();
    }
    match String::from_utf8(bytes) {
        Ok(text) => Ok(SourceText::new(path, text)),
        Err(error) => {
            let valid = error.utf8_error().valid_up_to();
            let line = error.as_bytes()[..valid].iter().filter(|&&byte| byte == b'\n').count() + 1;
            let message = format!("'{shown}' is not UTF-8 text: line {line} has a byte that is no character");
            Diagnostic::new("E-SCRIPT-SOURCE", message).help("save the file as UTF-8").fail()
        }
    }
}

fn unreadable(path: &Path, error: &std::io::Error) -> Box<Diagnostic> {
    let mut diagnostic = Diagnostic::disk("read", path, error);
    diagnostic.code = "E-SCRIPT-FILE";
    Box::new(diagnostic)
}

fn other_form(bytes: &[u8]) -> Option<&'static str> {
    let forms: [(&[u8], &str); 6] = [
        (b"\x89PNG", "a PNG image"),
        (b"\xff\xd8\xff", "a JPEG image"),
        (b"PK\x03\x04", "a ZIP archive"),
        (b"\x1f\x8b", "a compressed file"),
        (b"\x7fELF", "a program"),
        (b"\0asm", "a WebAssembly module"),
    ];
    forms.iter().find(|(start, _)| bytes.starts_with(start)).map(|(_, form)| *form)
}

fn near_files(path: &Path) -> String {
    let folder = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let Ok(entries) = std::fs::read_dir(folder) else {
        return format!("there is no folder '{}' either", printable(&folder.display().to_string()));
    };
    let mut names: Vec<String> = entries
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter(|name| name.ends_with(".rhai"))
        .collect();
    names.sort();
    let wanted = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let stem = |name: &str| name.trim_end_matches(".rhai").to_owned();
    let near = nearest_name(&wanted, names.iter().map(String::as_str))
        .or_else(|| names.iter().map(String::as_str).find(|name| stem(name) == stem(&wanted)));
    let path_of = |name: &str| printable(&path.with_file_name(name).display().to_string());
    match near {
        Some(near) => format!("did you mean '{}'?", path_of(near)),
        None if names.is_empty() => "there is no script in that folder".to_owned(),
        None => format!("that folder has: {}", printable(&names.join(", "))),
    }
}

/// A checked script.
#[derive(Debug)]
pub(super) struct Code {
    /// The text as the user wrote it, without a byte order mark.
    pub source: SourceText,
    /// The text for the parser: of the same length, a `#!` line made a comment.
    pub parsed: String,
    /// The text without comments and without what stands in quotes: of the same length, blanks instead.
    pub plain: String,
    /// The views that it names.
    pub views: ViewNames,
    /// The names that it defines: variables, functions and their arguments.
    own: BTreeSet<String>,
}

/// The names that a text without comments and quotes defines.
fn defined(plain: &str) -> BTreeSet<String> {
    let part = |c: char| c.is_alphanumeric() || c == '_';
    let words = |text: &str| -> Vec<String> {
        text.split(|c: char| !part(c)).filter(|word| !word.is_empty()).map(str::to_owned).collect()
    };
    let mut own = BTreeSet::new();
    let (mut rest, mut last) = (plain, "");
    while let Some(start) = rest.find(part) {
        let (gap, tail) = rest.split_at(start);
        let (word, after) = tail.split_at(tail.find(|c: char| !part(c)).unwrap_or(tail.len()));
        let follows = !gap.is_empty() && gap.trim().is_empty();
        if follows && matches!(last, "let" | "const" | "fn" | "for") {
            own.insert(word.to_owned());
        }
        if follows && last == "fn" {
            let arguments = after.trim_start().strip_prefix('(').unwrap_or_default();
            let end = arguments.find(['(', ')', '{', '}', ';']).unwrap_or(arguments.len());
            own.extend(words(&arguments[..end]));
        }
        (rest, last) = (after, word);
    }
    own
}

/// Checks a script's characters, comments and quotes.
///
/// # Errors
/// With the place of the first character that must not be there, or of the comment or text that never ends.
pub(super) fn check_text(source: SourceText) -> Result<Code> {
    let source = match source.text.strip_prefix('\u{feff}') {
        Some(rest) => SourceText::new(source.path.clone(), rest.to_owned()),
        None => source,
    };
    if source.text.len() as u64 > MAX_BYTES {
        let message = format!("the script is too long: {} bytes, at most {MAX_BYTES}", source.text.len());
        return Diagnostic::new("E-SCRIPT-SOURCE", message).fail();
    }
    check_characters(&source)?;
    let parsed = match source.text.strip_prefix("#!") {
        Some(rest) => format!("//{rest}"),
        None => source.text.to_string(),
    };
    let plain = plain_code(&source, &parsed)?;
    let own = defined(&plain);
    let code = Code { source, parsed, plain, views: ViewNames::default(), own };
    Ok(Code { views: ViewNames::of(&code), ..code })
}

fn check_characters(source: &SourceText) -> Result<()> {
    let mut mistakes = Mistakes::new(source);
    // One for each line: a file of another kind is full of them.
    let mut told = false;
    for (offset, c) in source.text.char_indices() {
        told &= c != '\n';
        let what = match c {
            '\n' | '\r' | '\t' => continue,
            '\0' => "a NUL byte",
            '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{200e}' | '\u{200f}' => {
                "a character that changes the direction of the text: the line may read as something else than it is"
            }
            c if c.is_control() => "a control character",
            _ => continue,
        };
        if !told && mistakes.wants(source, offset) {
            told = true;
            let wrong = Diagnostic::new("E-SCRIPT-SOURCE", format!("the script holds {what}"));
            let label = format!("character {}", c.escape_unicode());
            mistakes.add(wrong.at(source, offset..offset + c.len_utf8(), label).help("delete it"));
        }
    }
    mistakes.end()
}

/// The text with comments and the insides of quotes blanked.
///
/// The parser takes an unfinished comment for the end of the script, silently; here it is an error.
fn plain_code(source: &SourceText, text: &str) -> Result<String> {
    let mut plain = text.as_bytes().to_vec();
    let mut at = 0;
    while let Some(&byte) = text.as_bytes().get(at) {
        let rest = &text[at..];
        let (length, inner) = match byte {
            b'/' if rest.starts_with("//") => (rest.find('\n').unwrap_or(rest.len()), 0),
            b'/' if rest.starts_with("/*") => match comment_length(rest.as_bytes()) {
                Some(length) => (length, 0),
                None => return unfinished(source, at..at + 2, "comment", "*/"),
            },
            b'"' => match quoted_length(rest.as_bytes(), b'"', false) {
                Some(length) => (length, 1),
                None => return unfinished(source, at..at + 1, "text", "\""),
            },
            b'`' => match quoted_length(rest.as_bytes(), b'`', true) {
                Some(length) => (length, 1),
                None => return unfinished(source, at..at + 1, "text", "`"),
            },
            b'\'' => (quoted_length(rest.as_bytes(), b'\'', false).filter(|&length| length <= 12).unwrap_or(1), 1),
            // Every other byte, the middle of a character too, stays as it is.
            _ => {
                at += rest.chars().next().map_or(1, char::len_utf8);
                continue;
            }
        };
        for blank in plain.iter_mut().take(at + length - inner.min(length)).skip(at + inner) {
            if *blank != b'\n' {
                *blank = b' ';
            }
        }
        at += length;
    }
    Ok(String::from_utf8(plain).unwrap_or_default())
}

fn unfinished(source: &SourceText, span: Range<usize>, what: &str, end: &str) -> Result<String> {
    Diagnostic::new("E-SCRIPT-SYNTAX", format!("this {what} never ends"))
        .at(source, span, "begins here")
        .help(format!("write {end} where it ends"))
        .fail()
}

fn comment_length(text: &[u8]) -> Option<usize> {
    let (mut depth, mut at) = (0_usize, 0);
    while at + 1 < text.len() {
        match &text[at..at + 2] {
            b"/*" => depth += 1,
            b"*/" => depth -= 1,
            _ => {
                at += 1;
                continue;
            }
        }
        at += 2;
        if depth == 0 {
            return Some(at);
        }
    }
    None
}

fn quoted_length(text: &[u8], quote: u8, many_lines: bool) -> Option<usize> {
    let mut at = 1;
    while at < text.len() {
        match text[at] {
            b'\\' => at += 1,
            b'\n' if !many_lines => return None,
            byte if byte == quote => return Some(at + 1),
            _ => {}
        }
        at += 1;
    }
    None
}

impl Code {
    /// The bytes of the statement that begins at `start`, to its `;` or the end.
    pub(super) fn statement(&self, start: usize) -> Range<usize> {
        self.statement_before(start, self.plain.len())
    }

    /// As before, to `end` at most.
    pub(super) fn statement_before(&self, start: usize, end: usize) -> Range<usize> {
        let tail = &self.plain[start..end];
        let mut depth = 0_i32;
        for (index, c) in tail.char_indices() {
            match c {
                '(' | '[' | '{' => depth += 1,
                ')' | ']' | '}' => depth -= 1,
                ';' if depth <= 0 => return start..start + index + 1,
                _ => {}
            }
        }
        start..start + tail.trim_end().len()
    }

    /// Whether a word stands anywhere in the script.
    pub(super) fn names(&self, word: &str) -> bool {
        let part = |c: char| c.is_alphanumeric() || c == '_';
        self.plain
            .match_indices(word)
            .any(|(at, _)| !self.plain[..at].ends_with(part) && !self.plain[at + word.len()..].starts_with(part))
    }

    /// Whether a word stands in the plain code otherwise than as the name of a call, as a group of facts does.
    pub(super) fn names_besides_calls(&self, word: &str) -> bool {
        let part = |c: char| c.is_alphanumeric() || c == '_';
        self.plain.match_indices(word).any(|(at, _)| {
            let after = &self.plain[at + word.len()..];
            let whole = !self.plain[..at].ends_with(part) && !after.starts_with(part);
            whole && !after.trim_start().starts_with('(')
        })
    }

    /// Whether the script defines a name itself, as a variable, a function or one of its arguments: then the word is its own.
    pub(super) fn defines(&self, name: &str) -> bool {
        self.own.contains(name)
    }

    /// The bytes of the name of a function where it is defined.
    pub(super) fn function(&self, name: &str) -> Option<Range<usize>> {
        let word = |c: char| c.is_alphanumeric() || c == '_';
        self.plain.match_indices("fn").find_map(|(at, _)| {
            let before = self.plain[..at].chars().next_back().is_some_and(word);
            let tail = self.plain[at + 2..].trim_start();
            let start = self.plain.len() - tail.len();
            let rest = tail.strip_prefix(name)?;
            let whole = !before && start > at + 2 && !rest.starts_with(word);
            whole.then_some(start..start + name.len())
        })
    }
}
