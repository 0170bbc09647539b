//! How large a module may be: checked before it is compiled, since compiling takes time that no fuel bounds.

use std::path::Path;

use wasmparser::{Parser, Payload};

use crate::diagnostic::{Diagnostic, Kind, Result, printable};

const MOST_FUNCTIONS: u32 = 10_000;
const MOST_CODE_BYTES: usize = 2 << 20;
const MOST_FUNCTION_BYTES: usize = 64 << 10;
const MOST_DATA_BYTES: usize = 16 << 20;
const MOST_ITEMS: u32 = 10_000;

/// Checks the sizes of a module's parts.
///
/// # Errors
/// If one is over its limit, or the module cannot be read.
pub(super) fn check(path: &Path, bytes: &[u8]) -> Result<()> {
    let shown = printable(&path.display().to_string());
    let mut code_bytes = 0;
    for payload in Parser::new(0).parse_all(bytes) {
        let payload = payload.map_err(|error| damaged(&shown, error.message()))?;
        let fault = match &payload {
            Payload::CodeSectionStart { count, size, .. } => {
                code_bytes = *size as usize;
                over("functions", u64::from(*count), u64::from(MOST_FUNCTIONS))
                    .or_else(|| over("bytes of code", u64::from(*size), MOST_CODE_BYTES as u64))
            }
            Payload::CodeSectionEntry(body) => {
                over("bytes in one function", body.range().len() as u64, MOST_FUNCTION_BYTES as u64)
            }
            Payload::DataSection(section) => {
                over("bytes of data", section.range().len() as u64, MOST_DATA_BYTES as u64)
            }
            Payload::TypeSection(section) => items("types", section.count()),
            Payload::FunctionSection(section) => items("functions", section.count()),
            Payload::GlobalSection(section) => items("globals", section.count()),
            Payload::ExportSection(section) => items("exports", section.count()),
            Payload::ImportSection(section) => items("imports", section.count()),
            Payload::TableSection(section) => over("tables", u64::from(section.count()), 4),
            Payload::ElementSection(section) => items("element segments", section.count()),
            _ => None,
        };
        if let Some(fault) = fault {
            let message = format!("'{shown}' has {fault}");
            let help = "build it for size (opt-level, strip) and leave out what it does not use";
            return Diagnostic::new(Kind::Limit, "E-WASM-SIZE", message).help(help).into();
        }
    }
    if code_bytes == 0 {
        return Err(damaged(&shown, "it has no code"));
    }
    Ok(())
}

/// A module that cannot be read.
pub(super) fn damaged(shown: &str, why: &str) -> Box<Diagnostic> {
    let message = format!("'{shown}' is not a whole WebAssembly module: {}", printable(why));
    Box::new(Diagnostic::new(Kind::Limit, "E-WASM-FORM", message).help("copy or build it again"))
}

fn items(what: &str, found: u32) -> Option<String> {
    over(what, u64::from(found), u64::from(MOST_ITEMS))
}

fn over(what: &str, found: u64, most: u64) -> Option<String> {
    (found > most).then(|| format!("{found} {what}; a filter may have {most}"))
}
