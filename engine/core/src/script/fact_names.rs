//! The names behind a group of facts: whether there is such a fact, how it is read, and which beams, cells and stages it names.

use super::access::{Access, Link};
use super::names::Names;
use super::source::Code;
use crate::diagnostic::Diagnostic;
use crate::judge::Look;
use crate::judge::explain;
use crate::judge::fact_table::{self, Fact, value};
use crate::judge::needs::CellNamed;
use crate::settings::UNNAMED_VIEW;
use rhai::{Expr, FnCallExpr, Position};

impl Names<'_> {
    pub(super) fn no_group(&mut self, name: &str, position: Position) {
        let source = &self.code.source;
        if self.mistakes.wants(source, explain::offset(source, position)) {
            self.mistakes.add(match name {
                UNNAMED_VIEW => no_unnamed_view(self.code, position),
                name => explain::unknown_group(source, position, name),
            });
        }
    }

    pub(super) fn group(&mut self, group: &str, links: &[Link<'_>]) {
        match links {
            [Link::Property(inner, position), rest @ ..] if group == "previous" => match *inner {
                "previous" | "stage" => {
                    let message = format!("'{inner}' has no previous value");
                    let help = "name it: measure m = ...; change(m) is how much it changed since the step before";
                    self.mistake("E-SCRIPT-FACT", *position, message, "not known", help);
                }
                inner if self.is_group(inner) => self.group(inner, rest),
                inner => self.no_group(inner, *position),
            },
            [] if group == "previous" => {}
            [Link::Call(call, position), ..] if group == "stage" && call.name == "at" => self.stage(call, *position),
            [Link::Index(beam), ..] if group == "laser" => self.beam(beam),
            [Link::Call(call, position), rest @ ..] => {
                self.call_of_facts(group, call, *position);
                if let ("laser", "between", [from, to]) = (group, call.name.as_str(), call.args.as_slice()) {
                    self.bearings(from, to, *position);
                }
                if let ("sector" | "between", [next, ..]) = (call.name.as_str(), rest) {
                    self.sector(next);
                }
            }
            [Link::Property(key @ ("left" | "right"), position), ..] if group == "laser" => {
                self.needs.bearings.push((if *key == "left" { 90.0 } else { -90.0 }, *position));
            }
            [Link::Property(key, position), ..] => match value(self.row_group(group), key) {
                None => self.no_fact(group, key, *position),
                Some(fact) => self.look(self.code.views.index(group), fact),
            },
            _ => {}
        }
    }

    /// Bearings grow from right to left: the first is the lesser one.
    fn bearings(&mut self, from: &Expr, to: &Expr, position: Position) {
        let degrees = |expr: &Expr| match expr {
            Expr::FloatConstant(value, _) => Some(**value),
            Expr::IntegerConstant(value, _) => Some(*value as f64),
            Expr::FnCall(call, _) => match (call.name.as_str(), call.args.as_slice()) {
                ("-", [Expr::FloatConstant(value, _)]) => Some(-**value),
                ("-", [Expr::IntegerConstant(value, _)]) => Some(-*value as f64),
                _ => None,
            },
            _ => None,
        };
        if let (Some(from), Some(to)) = (degrees(from), degrees(to))
            && from >= to
        {
            let message = format!("no beam lies between {from}° and {to}°: the lesser bearing comes first");
            // From the left over the back to the right.
            let help = if from > to && from.abs() > 90.0 && to.abs() > 90.0 {
                format!("write min(laser.between({from}, 180).nearest, laser.between(-180, {to}).nearest)")
            } else {
                format!("write between({to}, {from})")
            };
            self.mistake("E-SCRIPT-FACT", position, message, "empty", help);
        }
    }

    /// A view in a variable of a function: which one is not known, so that it may be any.
    pub(super) fn look_anywhere(&mut self, access: &Access<'_>) {
        for link in &access.links {
            if let Link::Property(key, _) = link
                && let Some(fact) = value(UNNAMED_VIEW, key)
            {
                (0..self.code.views.all().len()).for_each(|view| self.look(Some(view), fact));
            }
        }
    }

    /// The group in the list of facts: that of the views for the name of one.
    fn row_group<'b>(&self, group: &'b str) -> &'b str {
        self.code.views.group_of(group).unwrap_or(group)
    }

    /// Notes what a fact of a view needs to have found in its mask.
    fn look(&mut self, view: Option<usize>, fact: &Fact) {
        let (Some(view), Some(wanted)) = (view, fact.id.look()) else { return };
        if self.needs.looks.len() <= view {
            self.needs.looks.resize_with(view + 1, Look::default);
        }
        let look = &mut self.needs.looks[view];
        (look.patch, look.line) = (look.patch || wanted.patch, look.line || wanted.line);
    }

    fn sector(&mut self, link: &Link<'_>) {
        match link {
            Link::Property(key, position) if value("sector", key).is_none() => {
                self.no_fact("sector", key, *position);
            }
            Link::Call(call, position) => self.call_of_facts("sector", call, *position),
            _ => {}
        }
    }

    fn no_fact(&mut self, group: &str, key: &str, position: Position) {
        match fact_table::call(self.row_group(group), key).and_then(Fact::form) {
            Some((form, _)) => {
                // A view is called by its own name.
                let row = self.row_group(group);
                let form = form.strip_prefix(row).map_or_else(|| form.to_owned(), |rest| format!("{group}{rest}"));
                let message = format!("'{key}' needs arguments");
                self.mistake("E-SCRIPT-FACT", position, message, "here", format!("write {form}"));
            }
            None => self.unknown_fact(group, key, position),
        }
    }

    fn unknown_fact(&mut self, group: &str, key: &str, position: Position) {
        let source = &self.code.source;
        if self.mistakes.wants(source, explain::offset(source, position)) {
            self.mistakes.add(explain::unknown_fact(source, position, (group, self.row_group(group)), key));
        }
    }

    fn call_of_facts(&mut self, group: &str, call: &FnCallExpr, position: Position) {
        let name = call.name.as_str();
        match fact_table::call(self.row_group(group), name).and_then(Fact::form) {
            None if value(self.row_group(group), name).is_some() => {
                let message = format!("'{group}.{name}' is a value, not a function");
                self.mistake("E-SCRIPT-FACT", position, message, "here", format!("write {group}.{name}"));
            }
            None => {
                self.unknown_calls.insert(position);
                self.unknown_fact(group, name, position);
            }
            Some((form, arguments)) if arguments != call.args.len() => {
                let message = format!("'{name}' takes {arguments} arguments, found {}", call.args.len());
                self.mistake("E-SCRIPT-FACT", position, message, "here", format!("write {form}"));
            }
            Some(_) if matches!(name, "sector" | "hit") => call.args.iter().for_each(|beam| self.beam(beam)),
            Some(_) if matches!(name, "at" | "hit_at" | "between") && group == "laser" => {
                call.args.iter().for_each(|of| self.bearing(of));
            }
            Some(_) if matches!(name, "cell" | "rows" | "columns") => {
                let view = self.code.views.index(group).unwrap_or(0);
                let whole = |argument: &Expr| match argument {
                    Expr::IntegerConstant(number, _) => Some(*number),
                    _ => None,
                };
                if let Some(position) = call.args.first().map(Expr::start_position) {
                    self.needs.cells.extend(cells_named(view, name, call.args.iter().map(whole), position));
                }
            }
            Some(_) => {}
        }
    }

    fn stage(&mut self, call: &FnCallExpr, position: Position) {
        let [Expr::StringConstant(name, at)] = call.args.as_slice() else {
            let message = "'at' needs the name of a stage".to_owned();
            return self.mistake("E-SCRIPT-STAGE", position, message, "here", "write stage.at(\"name\")");
        };
        self.needs.stages.push((name.to_string(), *at));
    }

    fn bearing(&mut self, bearing: &Expr) {
        let (bearing_deg, position) = match bearing {
            Expr::IntegerConstant(number, position) => (*number as f64, *position),
            Expr::FloatConstant(number, position) => (**number, *position),
            _ => return,
        };
        self.needs.bearings.push((bearing_deg, position));
    }

    fn beam(&mut self, beam: &Expr) {
        if let Expr::IntegerConstant(number, position) = beam {
            self.needs.beams.push((*number, *position));
        }
    }
}

/// The rows and columns that a call with these arguments names.
pub(super) fn cells_named(
    view: usize,
    name: &str,
    arguments: impl Iterator<Item = Option<i64>>,
    position: Position,
) -> Vec<CellNamed> {
    let numbers: Vec<Option<i64>> = arguments.collect();
    let named = |row, column| CellNamed { view, row, column, position };
    match (name, numbers.as_slice()) {
        ("cell", [row, column]) => vec![named(*row, *column)],
        ("rows", rows) => rows.iter().map(|row| named(*row, None)).collect(),
        (_, columns) => columns.iter().map(|column| named(None, *column)).collect(),
    }
}

/// A script that names its views has none without a name, unless it calls `filter` or `grid` by itself.
fn no_unnamed_view(code: &Code, position: Position) -> Diagnostic {
    let views = code.views.all();
    let message = "this script has no view without a name".to_owned();
    let help = match views.first() {
        Some(first) => format!("write {first}.seen; its views are: {}", views.join(", ")),
        None => String::new(),
    };
    explain::mistake(&code.source, "E-SCRIPT-VIEW", position, message, "which view?").help(help)
}
