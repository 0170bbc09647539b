//! The body that a script names: where its file is looked for, and what it says.

use crate::diagnostic::{Diagnostic, Result, SourceText, nearest_name, printable};
use crate::settings::{SHIPPED_BODIES, Settings, read_body, shipped_body};
use std::path::{Path, PathBuf};

/// Longest body file, bytes.
const MOST_BYTES: u64 = 1 << 16;

/// The file of a body by its name, before those that ship are looked at; nothing if there is none.
pub type BodyFiles<'a> = dyn Fn(&str) -> Result<Option<SourceText>> + 'a;

/// What a script's body is.
#[derive(Debug)]
pub(super) struct NamedBody {
    /// Its file.
    pub source: SourceText,
    /// Whether it lists actions.
    pub lists_actions: bool,
}

/// The files of bodies beside a script: in its folder `robots`, and in one beside its folder.
pub(super) fn beside(script: &Path) -> impl Fn(&str) -> Result<Option<SourceText>> + use<> {
    let folder = script.parent().unwrap_or(Path::new("")).to_owned();
    move |name| {
        let mut tried = ["robots", "../robots"].iter().map(|part| folder.join(part).join(format!("{name}.toml")));
        tried.find(|path| path.exists()).map(|path| read(&path)).transpose()
    }
}

fn read(path: &Path) -> Result<SourceText> {
    let shown = printable(&path.display().to_string());
    let wrong = |reason: &str, help: &str| {
        Diagnostic::new("E-ROBOT-FILE", format!("cannot read the body file '{shown}': {reason}")).help(help).fail()
    };
    let unreadable = |error| Box::new(Diagnostic { code: "E-ROBOT-FILE", ..Diagnostic::disk("read", path, &error) });
    let metadata = std::fs::metadata(path).map_err(unreadable)?;
    if !metadata.is_file() || metadata.len() > MOST_BYTES {
        return wrong("it is no file of at most 64 KiB", "a body file is a short text; see robots/README.md");
    }
    match String::from_utf8(std::fs::read(path).map_err(unreadable)?) {
        Ok(text) => Ok(SourceText::new(PathBuf::from(path), text)),
        Err(_) => wrong("it is not text in UTF-8", "save it as UTF-8"),
    }
}

/// Reads the body of a name into settings that have the engine's defaults.
///
/// # Errors
/// If there is no such body, or its file is wrong: at its place there.
pub(super) fn named_body(name: &str, files: &BodyFiles<'_>, settings: &mut Settings) -> Result<NamedBody> {
    let plain = !name.is_empty()
        && name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || matches!(c, '-' | '_'));
    let source = match if plain { files(name)? } else { None } {
        Some(source) => Some(source),
        None => shipped_body(name),
    };
    let Some(source) = source else {
        let message = format!("there is no robot '{}'", printable(name));
        let names = || SHIPPED_BODIES.iter().map(|(name, _)| *name);
        let help = match (plain, nearest_name(name, names())) {
            (false, _) => {
                "a robot is named in lower case, without folder and ending: robots/NAME.toml stands beside the script"
                    .to_owned()
            }
            (_, Some(near)) => format!("did you mean \"{near}\"?"),
            (_, None) => {
                let names = names().collect::<Vec<_>>().join(", ");
                format!("write robots/{name}.toml beside the script, or take one that ships: {names}")
            }
        };
        return Diagnostic::new("E-ROBOT-FILE", message).help(help).fail();
    };
    let lists_actions = read_body(&source, settings)?;
    Ok(NamedBody { source, lists_actions })
}
