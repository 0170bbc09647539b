//! How large a module may be: checked before it is compiled, since compiling takes time that no fuel bounds.

use std::path::Path;

use wasmparser::{BinaryReaderError, CompositeInnerType, FunctionBody, Operator, Parser, Payload, TypeSectionReader};

use crate::diagnostic::{self, Diagnostic, printable};

const MOST_FUNCTIONS: u32 = 10_000;
const MOST_CODE_BYTES: usize = 2 << 20;
const MOST_FUNCTION_BYTES: usize = 64 << 10;
const MOST_DATA_BYTES: usize = 16 << 20;
const MOST_ITEMS: u32 = 10_000;
/// For one function or block, arguments and results each.
const MOST_ARGUMENTS: usize = 32;
/// Over all functions, blocks times locals: a compiler may have to pass each local on to each block.
const MOST_PASSED: u64 = 2_000_000;

/// Checks the sizes of a module's parts.
///
/// # Errors
/// If one is over its limit, or the module cannot be read.
pub(super) fn check_limits(path: &Path, bytes: &[u8]) -> diagnostic::Result<()> {
    let shown = printable(&path.display().to_string());
    let broken = |error: BinaryReaderError| damaged(&shown, error.message());
    let (mut code_bytes, mut passed) = (0, 0);
    for payload in Parser::new(0).parse_all(bytes) {
        let payload = payload.map_err(broken)?;
        let fault = match &payload {
            Payload::CodeSectionStart { count, size, .. } => {
                code_bytes = *size as usize;
                over("functions", u64::from(*count), u64::from(MOST_FUNCTIONS))
                    .or_else(|| over("bytes of code", u64::from(*size), MOST_CODE_BYTES as u64))
            }
            Payload::CodeSectionEntry(body) => {
                let bytes = over("bytes in one function", body.range().len() as u64, MOST_FUNCTION_BYTES as u64);
                if bytes.is_none() {
                    passed += passed_on(body).map_err(broken)?;
                }
                bytes.or_else(|| over("locals that go through blocks", passed, MOST_PASSED))
            }
            Payload::DataSection(section) => {
                over("bytes of data", section.range().len() as u64, MOST_DATA_BYTES as u64)
            }
            Payload::TypeSection(section) => match items("types", section.count()) {
                None => over("arguments or results", most_arguments(section).map_err(broken)?, MOST_ARGUMENTS as u64),
                fault => fault,
            },
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
            return Diagnostic::new("E-WASM-SIZE", message).help(help).fail();
        }
    }
    if code_bytes == 0 {
        return Err(damaged(&shown, "it has no code"));
    }
    Ok(())
}

/// Blocks times locals of a function: how much its compiler may have to pass on.
fn passed_on(body: &FunctionBody<'_>) -> Result<u64, BinaryReaderError> {
    let mut locals = MOST_ARGUMENTS as u64;
    for group in body.get_locals_reader()? {
        locals += u64::from(group?.0);
    }
    let mut blocks = 1;
    for operator in body.get_operators_reader()? {
        let opens = matches!(operator?, Operator::Block { .. } | Operator::Loop { .. } | Operator::If { .. });
        blocks += u64::from(opens);
    }
    Ok(locals * blocks)
}

/// The most arguments, or results, that a type of the module has.
fn most_arguments(section: &TypeSectionReader<'_>) -> Result<u64, BinaryReaderError> {
    let mut most = 0;
    for group in section.clone() {
        for ty in group?.types() {
            if let CompositeInnerType::Func(function) = &ty.composite_type.inner {
                most = most.max(function.params().len()).max(function.results().len());
            }
        }
    }
    Ok(most as u64)
}

/// A module that cannot be read.
pub(super) fn damaged(shown: &str, why: &str) -> Box<Diagnostic> {
    let message = format!("'{shown}' is not a whole WebAssembly module: {}", printable(why));
    Box::new(Diagnostic::new("E-WASM-FORM", message).help("copy or build it again"))
}

fn items(what: &str, found: u32) -> Option<String> {
    over(what, u64::from(found), u64::from(MOST_ITEMS))
}

fn over(what: &str, found: u64, most: u64) -> Option<String> {
    (found > most).then(|| format!("{found} {what}; a filter may have {most}"))
}
