//! Where a command's filters come from: its options become a catalogue.

use std::path::PathBuf;
use std::sync::Arc;

use engine::diagnostic::{Diagnostic, Result};
use engine::filter::{Catalogue, Sources, Trust, serve};
use insight::disk::is_there;

use crate::cli::{FilterSources, FilterWorkerArguments};
use crate::console::ConsoleError;

/// The filters that a command may use.
pub(super) fn catalogue(arguments: &FilterSources) -> Result<Arc<Catalogue>> {
    Ok(Arc::new(Catalogue::new(sources(arguments)?)?))
}

/// Where they come from, before any folder is read.
pub(super) fn sources(arguments: &FilterSources) -> Result<Sources> {
    let mut trust = Trust::default();
    for digest in &arguments.allow_native {
        trust.allow(digest)?;
    }
    let own = arguments.trust.is_none().then(own_trust_file).transpose()?.flatten();
    if let Some(file) = arguments.trust.clone().or(own) {
        trust.allow_file(&file)?;
    }
    let worker = match std::env::current_exe() {
        _ if !arguments.isolate => None,
        Ok(program) => Some(program),
        Err(error) => return Err(Box::new(Diagnostic::disk("find", "this program".as_ref(), &error))),
    };
    Ok(Sources { folders: arguments.filter_dir.clone(), trust, worker, without_linked_in: false })
}

/// The user's own trust file, if there is one.
fn own_trust_file() -> Result<Option<PathBuf>> {
    let folder = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    let config = folder("ENGINE_CONFIG_DIR")
        .or_else(|| folder("XDG_CONFIG_HOME").map(|folder| folder.join("engine")))
        .or_else(|| folder("HOME").map(|folder| folder.join(".config/engine")));
    let Some(file) = config.map(|config| config.join("trust.toml")) else { return Ok(None) };
    Ok(is_there(&file)?.then_some(file))
}

/// `engine filter-worker`: the other side of `--isolate`.
pub(crate) fn work(arguments: &FilterWorkerArguments) -> std::result::Result<u8, ConsoleError> {
    let mut trust = Trust::default();
    trust.allow(&arguments.allow_native)?;
    serve(&arguments.library, &trust)?;
    Ok(0)
}
