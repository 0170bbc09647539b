//! `engine plugins`: the filters that scripts can use, from what each says of itself.

use std::path::Path;
use std::sync::Arc;

use engine::diagnostic::{Diagnostic, Result, printable};
use engine::filter::{Catalogue, EXAMPLE, Entry, Form, LANGUAGE, conformance};
use engine::settings::CONDITION;
use filter_api::{Descriptor, Format, Parameter, ParameterKind};
use serde_json::{Value, json};

use super::sources::catalogue;
use crate::cli::{PluginsArguments, PluginsCommand};
use crate::console::{Console, ConsoleError};

pub(crate) fn run(arguments: &PluginsArguments, console: &mut Console) -> std::result::Result<u8, ConsoleError> {
    let filters = catalogue(&arguments.filters)?;
    match &arguments.command {
        Some(PluginsCommand::Show { name }) => show(find(&filters, name)?.as_ref(), console)?,
        Some(PluginsCommand::Check { name }) => check_filter(find(&filters, name)?.as_ref(), console)?,
        None => list(&filters, console)?,
    }
    Ok(0)
}

/// A filter of the list, and what became of opening it.
struct ListedFilter<'a> {
    name: &'a str,
    form: Form,
    path: Option<&'a Path>,
    entry: Result<Arc<Entry>>,
}

fn list(filters: &Catalogue, console: &mut Console) -> std::result::Result<(), ConsoleError> {
    let all: Vec<ListedFilter> =
        filters.list().map(|(name, form, path)| ListedFilter { name, form, path, entry: filters.find(name) }).collect();
    console.json(&all.iter().map(listed).collect::<Vec<_>>())?;
    let mut rows = vec![["NAME", "VERSION", "FORM", "READS", "WRITES", "PURPOSE"].map(str::to_owned)];
    rows.extend(all.iter().map(row));
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..5).map(width).collect();
    for row in &rows {
        let cells = row.iter().zip(&widths).map(|(cell, width)| format!("{cell:width$}  "));
        console.line(&format!("{}{}", cells.collect::<String>(), row[5]))?;
    }
    for ListedFilter { name, path, entry, .. } in &all {
        let Some(path) = path else { continue };
        console.line(&format!("\n{}: {}", printable(name), printable(&path.display().to_string())))?;
        match entry {
            Ok(entry) => console.line(&format!("    sha256:{}", entry.sha256.as_deref().unwrap_or_default()))?,
            Err(error) => {
                console.line(&format!("    cannot be used: {error}"))?;
                console.line(&format!("    {}", error.help.as_deref().unwrap_or_default()))?;
            }
        }
    }
    Ok(())
}

fn row(listed: &ListedFilter) -> [String; 6] {
    let form = listed.form.name();
    match &listed.entry {
        Ok(entry) => {
            let filter = entry.descriptor;
            let (reads, writes) = (reads(filter), word(filter.writes));
            [filter.name, filter.version, form, &reads, writes, filter.purpose].map(str::to_owned)
        }
        Err(_) => [&printable(listed.name), "?", form, "?", "?", "cannot be used, see below"].map(str::to_owned),
    }
}

fn find(filters: &Catalogue, name: &str) -> Result<Arc<Entry>> {
    filters.find(name).map_err(|error| match error.code {
        // A name on the command line is the command line's mistake.
        "E-FILTER-SETTING" => Box::new(Diagnostic { code: "E-PLUGIN", ..*error }),
        _ => error,
    })
}

fn check_filter(entry: &Entry, console: &mut Console) -> std::result::Result<(), ConsoleError> {
    let frames = conformance(entry)?;
    let name = entry.descriptor.name;
    console.json(&json!({ "name": name, "form": entry.form.name(), "frames": frames, "keeps_the_law": true }))?;
    console.line(&format!("filter '{name}' ({}) keeps the law of filters: {frames} frames", entry.form.name()))
}

fn show(entry: &Entry, console: &mut Console) -> std::result::Result<(), ConsoleError> {
    let filter = entry.descriptor;
    console.json(&manual(entry))?;
    console.line(&format!("{} {}", filter.name, filter.version))?;
    console.line(filter.purpose)?;
    console.line("")?;
    console.line(&format!("form:     {}", entry.form.name()))?;
    if let (Some(path), Some(sha256)) = (&entry.path, &entry.sha256) {
        console.line(&format!("file:     {}", printable(&path.display().to_string())))?;
        console.line(&format!("digest:   sha256:{sha256}"))?;
    }
    console.line(&format!("licence:  {}", filter.licence))?;
    console.line(&format!("reads:    {}", reads(filter)))?;
    console.line(&format!("writes:   {}", word(filter.writes)))?;
    console.line("")?;
    if entry.by_condition {
        console.line(&format!("{CONDITION}: {LANGUAGE}"))?;
    } else if filter.parameters.is_empty() {
        console.line("It has no parameters.")?;
    }
    for parameter in filter.parameters {
        let Parameter { name, unit, min, max, default, purpose, .. } = parameter;
        match parameter.kind {
            ParameterKind::Number => console.line(&format!("{name}: {min} to {max} ({unit}), default {default}"))?,
            ParameterKind::Whole => {
                console.line(&format!("{name}: {min} to {max} ({unit}, whole), default {default}"))?;
            }
            ParameterKind::Switch => {
                console.line(&format!("{name}: false or true ({unit}), default {}", *default != 0.0))?;
            }
        }
        console.line(&format!("    {purpose}"))?;
    }
    console.line("")?;
    console.line("in a script:")?;
    console.line(&format!("    {}", script(entry)))
}

fn listed(listed: &ListedFilter) -> Value {
    match &listed.entry {
        Ok(entry) => brief(entry),
        Err(error) => json!({
            "name": listed.name,
            "form": listed.form.name(),
            "path": listed.path.map(|path| path.display().to_string()),
            "error": { "code": error.code, "message": error.message, "help": error.help },
        }),
    }
}

fn brief(entry: &Entry) -> Value {
    let filter = entry.descriptor;
    json!({
        "name": filter.name,
        "version": filter.version,
        "form": entry.form.name(),
        "path": entry.path.as_ref().map(|path| path.display().to_string()),
        "sha256": entry.sha256,
        "reads": filter.reads.iter().map(|format| word(*format)).collect::<Vec<_>>(),
        "writes": word(filter.writes),
        "purpose": filter.purpose,
    })
}

fn manual(entry: &Entry) -> Value {
    let filter = entry.descriptor;
    let parameter = |parameter: &Parameter| {
        let Parameter { name, kind, unit, min, max, default, purpose } = parameter;
        let kind = match kind {
            ParameterKind::Number => "number",
            ParameterKind::Whole => "whole",
            ParameterKind::Switch => "switch",
        };
        json!({
            "name": name, "type": kind, "unit": unit, "min": min, "max": max, "default": default, "purpose": purpose,
        })
    };
    let mut manual = brief(entry);
    manual["licence"] = json!(filter.licence);
    manual["parameters"] = filter.parameters.iter().map(parameter).collect();
    if entry.by_condition {
        manual[CONDITION] = json!(LANGUAGE);
    }
    manual["script"] = json!(script(entry));
    manual
}

/// The line of a script that uses the filter with all its defaults.
fn script(entry: &Entry) -> String {
    let filter = entry.descriptor;
    if entry.by_condition {
        return format!("filter(\"{}\", \"{EXAMPLE}\");", filter.name);
    }
    if filter.parameters.is_empty() {
        return format!("filter(\"{}\");", filter.name);
    }
    let parameters: Vec<String> =
        filter.parameters.iter().map(|parameter| format!("{}: {}", parameter.name, default(parameter))).collect();
    format!("filter(\"{}\", #{{ {} }});", filter.name, parameters.join(", "))
}

fn reads(filter: &Descriptor) -> String {
    filter.reads.iter().map(|format| word(*format)).collect::<Vec<_>>().join(" or ")
}

fn word(format: Format) -> &'static str {
    match format {
        Format::Rgb => "colour",
        Format::Grey => "grey",
        Format::Mask => "mask",
        Format::Depth => "depth",
    }
}

/// A default as a script writes it.
fn default(parameter: &Parameter) -> String {
    match parameter.kind {
        ParameterKind::Switch => (parameter.default != 0.0).to_string(),
        _ => parameter.default.to_string(),
    }
}
