//! The names behind a group of facts: whether there is such a fact, how it is read, and which beams, cells and stages it names.

use super::access::Link;
use super::names::Names;
use crate::judge::explain;
use crate::judge::fact_table::{self, Fact, is_group, value};
use rhai::{Expr, FnCallExpr, Position};

impl Names<'_> {
    pub(super) fn no_group(&mut self, name: &str, position: Position) {
        let source = &self.code.source;
        if self.mistakes.wants(source, explain::offset(source, position)) {
            self.mistakes.add(explain::unknown_group(source, position, name));
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
                inner if is_group(inner) => self.group(inner, rest),
                inner => self.no_group(inner, *position),
            },
            [] if group == "previous" => {}
            [Link::Call(call, position), ..] if group == "stage" && call.name == "at" => self.stage(call, *position),
            [Link::Index(beam), ..] if group == "laser" => self.beam(beam),
            [Link::Call(call, position), rest @ ..] => {
                self.call_of_facts(group, call, *position);
                if let ("sector" | "between", [next, ..]) = (call.name.as_str(), rest) {
                    self.sector(next);
                }
            }
            [Link::Property(key @ ("left" | "right"), position), ..] if group == "laser" => {
                self.needs.bearings.push((if *key == "left" { 90.0 } else { -90.0 }, *position));
            }
            [Link::Property(key, position), ..] if value(group, key).is_none() => self.no_fact(group, key, *position),
            _ => {}
        }
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
        match fact_table::call(group, key).and_then(Fact::form) {
            Some((form, _)) => {
                let message = format!("'{key}' needs arguments");
                self.mistake("E-SCRIPT-FACT", position, message, "here", format!("write {form}"));
            }
            None => self.unknown_fact(group, key, position),
        }
    }

    fn unknown_fact(&mut self, group: &str, key: &str, position: Position) {
        let source = &self.code.source;
        if self.mistakes.wants(source, explain::offset(source, position)) {
            self.mistakes.add(explain::unknown_fact(source, position, group, key));
        }
    }

    fn call_of_facts(&mut self, group: &str, call: &FnCallExpr, position: Position) {
        let name = call.name.as_str();
        match fact_table::call(group, name).and_then(Fact::form) {
            None if value(group, name).is_some() => {
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
            Some(_) if matches!(name, "at" | "hit_at" | "between") => call.args.iter().for_each(|of| self.bearing(of)),
            Some(_) if name == "cell" => {
                if let [Expr::IntegerConstant(row, at), Expr::IntegerConstant(column, _)] = call.args.as_slice() {
                    self.needs.cells.push((*row, *column, *at));
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
