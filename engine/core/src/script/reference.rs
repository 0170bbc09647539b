//! The page about the script language, and what editors need, from the lists that the engine itself uses.

use super::setup_table::SETUP;
use super::{rules, source};
use crate::judge::Unit;
use crate::judge::budget;
use crate::judge::fact_table::{FACTS, Fact, GROUPS};
use crate::judge::functions::{FUNCTIONS, Function, WINDOWS};
use crate::judge::sandbox;
use crate::settings::{SETTINGS, Settings};
use crate::verdict::{FIGURES, Takes, TestFigure};
use std::fmt::Write;

/// The page about the script language: `scripts/README.md`.
#[must_use]
pub fn reference() -> String {
    include_str!("reference.md")
        .replace("{{SETUP}}", &setup())
        .replace("{{ACTIONS}}", &actions())
        .replace("{{SETTINGS}}", &settings())
        .replace("{{FIGURES}}", &figures())
        .replace("{{FACTS}}", &facts())
        .replace("{{WINDOWS}}", &functions(WINDOWS))
        .replace("{{FUNCTIONS}}", &functions(FUNCTIONS))
        .replace("{{LIMITS}}", &limits())
}

fn table(heads: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let mut out = format!("| {} |\n|{}", heads.join(" | "), "---|".repeat(heads.len()));
    for row in rows {
        let _ = write!(out, "\n| {} |", row.join(" | "));
    }
    out
}

fn setup() -> String {
    table(&["call", "what it sets"], SETUP.iter().map(|row| vec![format!("`{}`", row.form), row.purpose.to_owned()]))
}

/// The actions of a script that names none, by their numbers.
fn actions() -> String {
    let own = Settings::default().actions;
    let words = own.iter().map(|action| format!("`[{}, {}]`", action.linear_m_per_s, action.angular_rad_per_s));
    words.collect::<Vec<_>>().join(" ")
}

fn settings() -> String {
    let defaults = Settings::default();
    let row = |row: &crate::settings::Setting| {
        let default = format!("`{}`", (row.get)(&defaults));
        vec![format!("`{}`", row.key), row.allowed(), default, row.purpose.to_owned()]
    };
    let mut groups: Vec<&str> = SETTINGS.iter().map(|row| row.group).collect();
    groups.dedup();
    let tables = groups.iter().map(|group| {
        let rows = SETTINGS.iter().filter(|row| row.group == *group).map(row);
        format!("### `{group}`\n\n{}", table(&["setting", "may be", "default", "what it changes"], rows))
    });
    tables.collect::<Vec<_>>().join("\n\n")
}

fn facts() -> String {
    let groups = GROUPS.iter().map(|(group, about)| {
        let in_group = move |of: &str| of == *group || *group == "laser" && of == "sector";
        let values = values().filter(|fact| fact.group == *group).map(|fact| {
            let unit = if fact.unit == Unit::Without { fact.kind() } else { fact.unit.words() };
            vec![format!("`{}`", fact.name()), unit.to_owned(), fact.reach.words(), fact.purpose.to_owned()]
        });
        let calls = calls().filter(move |(fact, ..)| in_group(fact.group)).map(|(fact, form, _)| {
            vec![format!("`{form}`"), fact.unit.words().to_owned(), String::new(), fact.purpose.to_owned()]
        });
        let sector = of_sectors().filter(move |_| in_group("sector")).map(|fact| {
            let form = format!("`laser.sector(from, to).{}`", fact.key);
            vec![form, fact.unit.words().to_owned(), fact.reach.words(), fact.purpose.to_owned()]
        });
        let rows = values.chain(calls).chain(sector);
        format!("### `{group}`\n\n{about}\n\n{}", table(&["fact", "unit", "values", "what it is"], rows))
    });
    groups.collect::<Vec<_>>().join("\n\n")
}

fn figures() -> String {
    let row = |figure: &TestFigure| {
        let name = figure.takes().form(figure.name);
        let of = match (figure.needs_route(), figure.takes(), figure.is_of_windows()) {
            (true, ..) => "a route",
            (false, Takes::Mover | Takes::MoverAndMetres, _) => "a mover",
            (false, Takes::Place, _) => "a place",
            (false, _, true) => "a test, a window",
            (false, _, false) => "a test",
        };
        vec![format!("`test.{name}`"), figure.unit.to_owned(), of.to_owned(), figure.about.to_owned()]
    };
    table(&["figure", "unit", "of", "what it is"], FIGURES.iter().map(row))
}

fn values() -> impl Iterator<Item = &'static Fact> {
    FACTS.iter().filter(|fact| fact.form().is_none() && fact.group != "sector")
}

fn of_sectors() -> impl Iterator<Item = &'static Fact> {
    FACTS.iter().filter(|fact| fact.form().is_none() && fact.group == "sector")
}

/// Facts with arguments: how each is written, and how many it takes.
fn calls() -> impl Iterator<Item = (&'static Fact, &'static str, usize)> {
    FACTS.iter().filter_map(|fact| fact.form().map(|(form, arguments)| (fact, form, arguments)))
}

fn functions(rows: &[Function]) -> String {
    table(&["function", "what it does"], rows.iter().map(|row| vec![format!("`{}`", row.form), row.purpose.to_owned()]))
}

fn limits() -> String {
    let rows = [
        ("operations in one step, of all rules together", sandbox::MAX_OPERATIONS),
        ("values of an array or a map that are read for one operation more", budget::VALUES_PER_OPERATION),
        ("functions that call one another", sandbox::MAX_CALL_LEVELS as u64),
        ("brackets and operators within one another", sandbox::MAX_NESTING as u64),
        ("bytes of one text", sandbox::MAX_TEXT_BYTES as u64),
        ("values in an array", sandbox::MAX_ARRAY as u64),
        ("keys in a map", sandbox::MAX_MAP as u64),
        ("variables at one time", sandbox::MAX_VARIABLES as u64),
        ("functions in a script", sandbox::MAX_FUNCTIONS as u64),
        ("rules in a script", rules::MOST_RULES as u64),
        ("bytes of a script", source::MAX_BYTES),
    ];
    table(&["what", "at most"], rows.iter().map(|(what, most)| vec![(*what).to_owned(), most.to_string()]))
}

/// What an editor needs to complete and explain a script: a Rhai definition file.
#[must_use]
pub fn definitions() -> String {
    let mut out = "module static;\n".to_owned();
    for (group, about) in GROUPS {
        let _ = write!(out, "\n/// {about}\nlet {group}: {};\n", type_of(group));
        for fact in values().filter(|fact| fact.group == *group) {
            let kind = match fact.kind() {
                "number" => "float",
                "whole number" => "int",
                _ => "bool",
            };
            let unit = fact.unit.words();
            let unit = if unit.is_empty() { String::new() } else { format!(" ({unit})") };
            let _ = write!(
                out,
                "/// {}{unit}\nfn get {}({group}: {}) -> {kind};\n",
                fact.purpose,
                fact.key,
                type_of(group)
            );
        }
    }
    for fact in of_sectors() {
        let _ = write!(out, "\n/// {} (metres)\nfn get {}(sector: Sector) -> float;\n", fact.purpose, fact.key);
    }
    for (call, form, arguments) in calls() {
        let _ = write!(out, "\n/// {} Written: {}\n", call.purpose, form);
        let (name, arguments) = match call.key {
            "[" => ("index$get$", "int".to_owned()),
            key => (key, vec!["_"; arguments].join(", ")),
        };
        let _ = writeln!(out, "fn {name}({}: {}, {arguments});", call.group, type_of(call.group));
    }
    for row in FUNCTIONS {
        let _ = write!(out, "\n/// {}\nfn {};\n", row.purpose, row.form.replace("array.", ""));
    }
    for row in SETUP {
        let _ = write!(out, "\n/// {} For example {}\nfn {}(...);\n", row.purpose, row.form, row.name);
    }
    out
}

fn type_of(group: &str) -> String {
    let mut chars = group.chars();
    chars.next().map_or(String::new(), |first| first.to_uppercase().chain(chars).collect())
}
