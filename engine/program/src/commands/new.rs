//! `engine new filter`: a working filter to start from, with the contract beside it, so that it builds anywhere.

use std::path::{Path, PathBuf};

use engine::diagnostic::{Diagnostic, Result, printable};
use engine::filter::LINKED_IN;
use insight::disk::write_atomic;
use insight::folder::create_folder;

use crate::cli::{NewArguments, NewCommand};
use crate::console::{Console, ConsoleError};

/// The files of a new filter, with `@name@` for its name and `@version@` for the contract's version.
const TEMPLATE: &[(&str, &str)] = &[
    ("Cargo.toml", include_str!("../../templates/filter/Cargo.toml.txt")),
    ("README.md", include_str!("../../templates/filter/README.md")),
    ("example.rhai", include_str!("../../templates/filter/example.rhai")),
    ("src/lib.rs", include_str!("../../templates/filter/lib.rs")),
    (".gitignore", "/target\n"),
    ("filter-api/Cargo.toml", include_str!("../../templates/filter/contract.toml.txt")),
    ("filter-api/README.md", include_str!("../../../../plugins/filter-api/README.md")),
    ("filter-api/filter.h", include_str!("../../../../plugins/filter-api/filter.h")),
    ("filter-api/src/abi.rs", include_str!("../../../../plugins/filter-api/src/abi.rs")),
    ("filter-api/src/export.rs", include_str!("../../../../plugins/filter-api/src/export.rs")),
    ("filter-api/src/export/kept.rs", include_str!("../../../../plugins/filter-api/src/export/kept.rs")),
    ("filter-api/src/frame.rs", include_str!("../../../../plugins/filter-api/src/frame.rs")),
    ("filter-api/src/lib.rs", include_str!("../../../../plugins/filter-api/src/lib.rs")),
    ("filter-api/src/told.rs", include_str!("../../../../plugins/filter-api/src/told.rs")),
];

pub(crate) fn run(arguments: &NewArguments, console: &mut Console) -> std::result::Result<u8, ConsoleError> {
    let NewCommand::Filter { name, out } = &arguments.what;
    let folder = out.clone().unwrap_or_else(|| PathBuf::from(name));
    check_name(name, &folder)?;
    for (path, text) in TEMPLATE {
        let path = folder.join(path);
        create_folder(path.parent().unwrap_or(&folder))?;
        write_atomic(&path, fill(text, name).as_bytes())?;
    }
    console.line(&format!("wrote the filter '{name}' to {}", folder.display()))?;
    console.line("next:")?;
    for step in ["cargo build --release", "engine plugins --filter-dir target/release"] {
        console.line(&format!("    {step}"))?;
    }
    console.line(&format!("in {}; its README.md goes on from there", folder.display()))?;
    Ok(0)
}

fn fill(text: &str, name: &str) -> String {
    text.replace("@name@", name).replace("@version@", env!("CARGO_PKG_VERSION"))
}

fn check_name(name: &str, folder: &Path) -> Result<()> {
    let wrong = |message: String, help: &str| Diagnostic::new("E-NEW", message).help(help).fail();
    let legal = |c: u8| c.is_ascii_lowercase() || c.is_ascii_digit() || c == b'_';
    let shown = printable(name);
    if !name.starts_with(|c: char| c.is_ascii_lowercase()) || !name.bytes().all(legal) || name.len() > 64 {
        let message = format!("'{shown}' cannot be the name of a filter");
        return wrong(message, "use lower case letters, digits and '_', and begin with a letter, such as dark_floor");
    }
    if LINKED_IN.iter().any(|plugin| plugin.descriptor.name == name) {
        return wrong(format!("there is a filter '{shown}' already"), "choose another name");
    }
    // Names that cargo or the language keeps for themselves.
    if ["filter_api", "test", "core", "std", "alloc", "self", "super", "crate", "fn", "mod"].contains(&name) {
        return wrong(format!("'{shown}' means something else to cargo"), "choose another name");
    }
    if insight::disk::is_there(folder)? {
        let message = format!("'{}' exists already", printable(&folder.display().to_string()));
        return wrong(message, "choose another name, or another folder: --out DIR");
    }
    Ok(())
}
