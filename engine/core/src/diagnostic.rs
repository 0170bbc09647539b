//! One clear error: what is wrong, where, and what to type next.

use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

mod codes;
mod excerpt;
mod lines;
mod mistakes;
mod render;
mod told;
mod visible;

pub use codes::{all_codes, code_page};
pub use excerpt::excerpt;
use lines::Lines;
pub(crate) use mistakes::{MOST_MISTAKES, Mistakes};
pub use told::Told;
pub use visible::{for_json, for_table, for_terminal, is_hidden};

/// The result of anything that a user's input can make fail.
pub type Result<T> = std::result::Result<T, Box<Diagnostic>>;

/// The kind of a failure decides the exit status of the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// The command line is wrong: exit status 2.
    Usage,
    /// An input file is wrong: exit status 3.
    Input,
    /// A limit stopped a script or a plugin: exit status 4.
    Limit,
    /// A sensor, the system or a server failed: exit status 4.
    Fault,
    /// Refused for trust: exit status 5.
    Trust,
    /// Files and disk: exit status 6.
    Disk,
    /// Recorded state does not fit: exit status 7.
    State,
}

impl Kind {
    /// The exit status of the program.
    #[must_use]
    pub const fn exit_status(self) -> u8 {
        match self {
            Self::Usage => 2,
            Self::Input => 3,
            Self::Limit | Self::Fault => 4,
            Self::Trust => 5,
            Self::Disk => 6,
            Self::State => 7,
        }
    }
}

/// How bad it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// It must be mended before anything can be learned.
    Error,
    /// Most likely not what is meant.
    Warning,
}

/// A text file as the user wrote it, kept so that errors can show its lines.
#[derive(Debug, Clone)]
pub struct SourceText {
    /// The path as the user gave it.
    pub path: PathBuf,
    /// The whole text.
    pub text: Arc<str>,
    lines: Arc<OnceLock<Lines>>,
}

impl SourceText {
    /// A source from a path and its text.
    #[must_use]
    pub fn new(path: impl Into<PathBuf>, text: impl Into<Arc<str>>) -> Self {
        Self { path: path.into(), text: text.into(), lines: Arc::default() }
    }

    fn lines(&self) -> &Lines {
        self.lines.get_or_init(|| Lines::new(&self.text))
    }

    /// The byte range of one line, 1-based, without its line break; an empty range at the end if there is no such line.
    #[must_use]
    pub(crate) fn line_range(&self, line: usize) -> Range<usize> {
        let (lines, end) = (self.lines(), self.text.len());
        let Some(start) = lines.start(line) else { return end..end };
        let text = &self.text[start..lines.start(line + 1).unwrap_or(end)];
        start..start + text.trim_end_matches(['\n', '\r']).len()
    }

    /// The byte offset of a line and a column, both 1-based and counted in characters; clamped to the line's end.
    #[must_use]
    pub(crate) fn offset(&self, line: usize, column: usize) -> usize {
        let range = self.line_range(line);
        self.lines().offset(&self.text, line, column).map_or(range.end, |at| at.min(range.end))
    }

    /// The line and column, both 1-based, of a byte offset.
    #[must_use]
    pub fn position(&self, offset: usize) -> (usize, usize) {
        let mut offset = offset.min(self.text.len());
        while !self.text.is_char_boundary(offset) {
            offset -= 1;
        }
        self.lines().position(&self.text, offset)
    }

    /// The byte range of the word (letters, digits, underscore) at `offset`, at least one character long where possible.
    #[must_use]
    pub(crate) fn word_at(&self, offset: usize) -> Range<usize> {
        let tail = &self.text[offset.min(self.text.len())..];
        let word = tail.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(tail.len());
        let length = if word > 0 { word } else { tail.chars().next().filter(|c| *c != '\n').map_or(0, char::len_utf8) };
        offset..offset + length
    }
}

/// A place in a source, with the words to write under it.
#[derive(Debug, Clone)]
pub struct Place {
    /// The text that holds the mistake.
    pub source: SourceText,
    /// The bytes to underline.
    pub span: Range<usize>,
    /// What is written beside the caret: what was found.
    pub label: String,
}

/// An error for a person, also where it is printed with `{:?}`: by `unwrap`, and by a `main` that returns it.
#[derive(Clone)]
pub struct Diagnostic {
    /// A stable code such as `E-SCRIPT-FACT`; the exit status belongs to it, see [`Diagnostic::kind`].
    pub code: &'static str,
    /// What is wrong: lower case, one sentence, no jargon.
    pub message: String,
    /// Where, if it is a place in a file.
    pub place: Option<Box<Place>>,
    /// What to type or change next.
    pub help: Option<String>,
    /// The further mistakes, in the order of the lines; none of them has others itself.
    pub others: Vec<Diagnostic>,
    /// How many more there are that are not among them.
    pub left_out: usize,
}

impl Diagnostic {
    /// The kind of failure that its code stands for.
    #[must_use]
    pub fn kind(&self) -> Kind {
        codes::kind_of(self.code)
    }

    /// As the failure of whatever the user wanted.
    ///
    /// # Errors
    /// Always: this error.
    pub fn fail<T>(self) -> Result<T> {
        Err(Box::new(self))
    }

    /// An error without a place.
    pub fn new(code: &'static str, message: impl Into<String>) -> Self {
        Self { code, message: message.into(), place: None, help: None, others: Vec::new(), left_out: 0 }
    }

    /// Points at `span` of `source` with `label` beside the caret.
    #[must_use]
    pub fn at(mut self, source: &SourceText, span: Range<usize>, label: impl Into<String>) -> Self {
        self.place = Some(Box::new(Place { source: source.clone(), span, label: label.into() }));
        self
    }

    /// Adds the next step; an empty text adds none.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into()).filter(|help: &String| !help.is_empty());
        self
    }

    /// A failed file operation, with the system's reason in plain words.
    #[must_use]
    pub fn disk(action: &str, path: &Path, error: &std::io::Error) -> Self {
        let reason = match error.kind() {
            std::io::ErrorKind::NotFound => "there is no such file or folder".to_owned(),
            std::io::ErrorKind::PermissionDenied => "permission denied".to_owned(),
            std::io::ErrorKind::StorageFull => "the disk is full".to_owned(),
            std::io::ErrorKind::ReadOnlyFilesystem => "the file system is read-only".to_owned(),
            _ => error.to_string(),
        };
        Self::new("E-IO", format!("cannot {action} '{}': {reason}", path.display()))
    }
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "error[{}]: {}", self.code, self.message)
    }
}

impl fmt::Debug for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.render(false).trim_end())
    }
}

impl std::error::Error for Diagnostic {}

/// The name nearest to `wrong` among `names`, if one is near enough to be meant.
pub fn nearest_name<'a>(wrong: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let allowed = (wrong.chars().count() / 3).clamp(1, 3);
    names
        .into_iter()
        .map(|name| (strsim::damerau_levenshtein(&wrong.to_lowercase(), &name.to_lowercase()), name))
        .filter(|(distance, _)| *distance <= allowed)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, name)| name)
}

/// Text from a stranger's file made safe for a terminal: control characters escaped, cut at 200 characters.
#[must_use]
pub fn printable(text: &str) -> String {
    let mut out = String::new();
    for (count, c) in text.chars().enumerate() {
        if count == 200 {
            out.push('…');
            break;
        }
        if is_hidden(c) { out.extend(c.escape_unicode()) } else { out.push(c) }
    }
    out
}

/// Digits with something between thousands: `5,200` with a comma.
#[must_use]
pub fn grouped(digits: &str, between: &str) -> String {
    let mut out = String::new();
    for (index, digit) in digits.char_indices() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            out.push_str(between);
        }
        out.push(digit);
    }
    out
}
