//! What an author does: `engine pack new`, `check` and `build`.

use std::path::{Path, PathBuf};

use engine::diagnostic::Diagnostic;
use engine::experiment::{Progress, WINDOW_STEPS};
use insight::disk::{is_there, write_atomic};
use pack::{Pack, PackName, draft, scaffold};
use serde_json::json;

use super::super::behaviour::depends;
use super::super::sources::sources;
use super::super::stop::on_ctrl_c;
use crate::cli::{BuildArguments, FolderArguments, PackNewArguments};
use crate::console::{Console, ConsoleError};

pub(super) fn new(arguments: &PackNewArguments, console: &mut Console) -> Result<u8, ConsoleError> {
    let text = &arguments.name;
    let full = if text.contains('/') { text.clone() } else { format!("local/{text}") };
    let name = PackName::try_from(full)
        .map_err(|what| Box::new(Diagnostic::new("E-PACK-NAME", what).help("such as ada/wall")))?;
    let folder = arguments.out.clone().unwrap_or_else(|| PathBuf::from(name.name()));
    let from = match &arguments.from {
        Some(script) => Some((script.as_path(), sources(&arguments.filters)?)),
        None => None,
    };
    if from.is_none() && !arguments.filters.filter_dir.is_empty() {
        let error = Diagnostic::new("E-PACK-FOLDER", "--filter-dir takes the filters of a script, and none is named");
        return Err(Box::new(error.help("add --from SCRIPT")).into());
    }
    scaffold(&name, &folder, from)?;
    let shown = folder.display().to_string();
    console.json(&json!({ "name": name, "folder": shown }))?;
    console.line(&format!("pack:   {name} in {shown}"))?;
    console.line(&format!("next:   engine run {shown}"))?;
    console.line(&format!("then:   edit {shown}/pack.toml; engine pack check {shown}; engine pack build {shown}"))?;
    Ok(0)
}

pub(super) fn check_folder(arguments: &FolderArguments, console: &mut Console) -> Result<u8, ConsoleError> {
    let folder = &arguments.folder;
    let pack = draft(folder)?;
    let (depends, stop) = (depends(&pack)?, on_ctrl_c()?);
    let findings = pack::check_pack(folder, &depends, sources(&arguments.filters)?, &stop, &|_| ())?;
    console.json(&json!({ "name": pack.manifest().name, "findings": findings }))?;
    for finding in &findings {
        console.line(&format!("{:12} {}", format!("{}:", finding.about), finding.text))?;
    }
    let files = pack.manifest().files.len();
    let result = if findings.is_empty() { "ready to build" } else { "not ready" };
    console.line(&format!("{}: {files} files, {result}", pack.title()))?;
    Ok(u8::from(!findings.is_empty()))
}

pub(super) fn build(arguments: &BuildArguments, console: &mut Console) -> Result<u8, ConsoleError> {
    let draft = draft(&arguments.folder)?;
    let (depends, stop) = (depends(&draft)?, on_ctrl_c()?);
    let bar = console.bar(0);
    let report = |_: Progress| bar.inc(WINDOW_STEPS);
    let built = pack::build(&arguments.folder, &depends, sources(&arguments.filters)?, 0, &stop, &report);
    bar.finish_and_clear();
    let pack = built?;
    let out = arguments.out.clone().unwrap_or_else(|| PathBuf::from(pack.manifest().file_name()));
    write_pack(&out, &pack)?;
    console.json(&super::inspect::description(&pack, None))?;
    console.line(&format!("pack:      {}, {} bytes", pack.title(), pack.bytes().len()))?;
    console.line(&format!("file:      {}", out.display()))?;
    console.line(&format!("content:   sha256:{}", pack.content()))?;
    super::inspect::print_evidence(console, pack.manifest())?;
    console.line(&format!("next:      engine pack sign {}", out.display()))?;
    Ok(0)
}

/// Writes a pack's file. A signature of what stood there before would not fit any more, and is removed.
fn write_pack(path: &Path, pack: &Pack) -> engine::diagnostic::Result<()> {
    let signature = super::places::signature_path(path);
    let same = std::fs::read(path).is_ok_and(|bytes| bytes == pack.bytes());
    if !same && is_there(&signature)? {
        std::fs::remove_file(&signature).map_err(|error| Box::new(Diagnostic::disk("remove", &signature, &error)))?;
    }
    write_atomic(path, pack.bytes())
}
