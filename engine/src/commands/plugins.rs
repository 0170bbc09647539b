//! `engine plugins`: the filters that scripts can use, from what each says of itself.

use engine::diagnostic::{Diagnostic, Kind, printable};
use engine::filter::{built_in, find};
use filter_api::{Descriptor, Format, Parameter};
use serde_json::{Value, json};

use crate::cli::{PluginsArguments, PluginsCommand};
use crate::console::{Console, ConsoleError};

/// How a filter comes into the program; other forms stand beside it once there are some.
const FORM: &str = "linked in";

pub(crate) fn run(arguments: &PluginsArguments, console: &mut Console) -> Result<u8, ConsoleError> {
    match &arguments.command {
        Some(PluginsCommand::Show { name }) => show(name, console)?,
        None => list(console)?,
    }
    Ok(0)
}

fn list(console: &mut Console) -> Result<(), ConsoleError> {
    let filters = || built_in().iter().map(|plugin| plugin.descriptor);
    console.json(&filters().map(entry).collect::<Vec<_>>())?;
    let mut rows = vec![["NAME", "VERSION", "FORM", "READS", "WRITES", "PURPOSE"].map(str::to_owned)];
    rows.extend(filters().map(|filter| {
        let (reads, writes) = (reads(filter), word(filter.writes));
        [filter.name, filter.version, FORM, &reads, writes, filter.purpose].map(str::to_owned)
    }));
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..5).map(width).collect();
    for row in &rows {
        let cells = row.iter().zip(&widths).map(|(cell, width)| format!("{cell:width$}  "));
        console.line(&format!("{}{}", cells.collect::<String>(), row[5]))?;
    }
    Ok(())
}

fn show(name: &str, console: &mut Console) -> Result<(), ConsoleError> {
    let plugin = find(name).map_err(|help| {
        let message = format!("there is no filter '{}'", printable(name));
        Box::new(Diagnostic::new(Kind::Usage, "E-PLUGIN", message).help(help))
    })?;
    let filter = plugin.descriptor;
    console.json(&manual(filter))?;
    console.line(&format!("{} {}", filter.name, filter.version))?;
    console.line(filter.purpose)?;
    console.line("")?;
    console.line(&format!("form:     {FORM}"))?;
    console.line(&format!("licence:  {}", filter.licence))?;
    console.line(&format!("reads:    {}", reads(filter)))?;
    console.line(&format!("writes:   {}", word(filter.writes)))?;
    console.line("")?;
    if filter.parameters.is_empty() {
        console.line("It has no parameters.")?;
    }
    for Parameter { name, unit, min, max, default, purpose } in filter.parameters {
        console.line(&format!("{name}: {min} to {max} ({unit}), default {default}"))?;
        console.line(&format!("    {purpose}"))?;
    }
    console.line("")?;
    console.line("in a script:")?;
    console.line(&format!("    {}", script(filter)))
}

fn entry(filter: &Descriptor) -> Value {
    json!({
        "name": filter.name,
        "version": filter.version,
        "form": FORM,
        "reads": filter.reads.iter().map(|format| word(*format)).collect::<Vec<_>>(),
        "writes": word(filter.writes),
        "purpose": filter.purpose,
    })
}

fn manual(filter: &Descriptor) -> Value {
    let parameter = |parameter: &Parameter| {
        let Parameter { name, unit, min, max, default, purpose } = parameter;
        json!({ "name": name, "unit": unit, "min": min, "max": max, "default": default, "purpose": purpose })
    };
    let mut manual = entry(filter);
    manual["licence"] = json!(filter.licence);
    manual["parameters"] = filter.parameters.iter().map(parameter).collect();
    manual["script"] = json!(script(filter));
    manual
}

/// The line of a script that uses the filter with all its defaults.
fn script(filter: &Descriptor) -> String {
    if filter.parameters.is_empty() {
        return format!("filter(\"{}\");", filter.name);
    }
    let parameters: Vec<String> =
        filter.parameters.iter().map(|parameter| format!("{}: {}", parameter.name, parameter.default)).collect();
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
    }
}
