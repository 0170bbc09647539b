//! Every name in a script checked before anything runs: facts, functions, and where a rule may stand.

use super::access::{Access, Link, fact_of};
use super::setup_table::SETUP;
use super::source::Code;
use super::spoilt::Spoilt;
use super::success;
use super::syntax::is_success_expr;
use super::tree::Tree;
use super::unknown::Unknown;
use crate::diagnostic::{Diagnostic, Mistakes};
use crate::judge::explain;
use crate::judge::fact_table::{self, Fact, is_group, takes_arguments, value};
use crate::judge::functions::FUNCTIONS;
use crate::judge::needs::Needs;
use rhai::{AST, ASTNode, Expr, FnCallExpr, Position, Stmt};
use std::collections::BTreeSet;

/// Checks the names of a script: adds every mistake to `mistakes`, and what it finds of beams and cells to `needs`.
/// Gives the names that nothing defines and that look like no other name.
pub(super) fn check_names(
    code: &Code,
    tree: &Tree,
    spoilt: &Spoilt<'_>,
    needs: &mut Needs,
    mistakes: &mut Mistakes,
) -> BTreeSet<String> {
    let ast = &tree.ast;
    let own: Vec<(String, usize)> = ast.iter_functions().map(|f| (f.name.to_owned(), f.params.len())).collect();
    let mut facts_names = vec!["facts".to_owned()];
    for function in ast.iter_functions().filter(|f| matches!(f.name, "reward" | "calibrate")) {
        facts_names.extend(function.params.first().map(|&name| name.to_owned()));
    }
    let calibrates = own.iter().any(|(name, _)| name == "calibrate") || spoilt.has("calibrate");
    let variables = tree.refused.is_some().then(|| tree.known.variables.iter().map(String::as_str).collect());
    let unknown = Unknown::default();
    let figures = success::is_asked_for(code);
    let in_function = false;
    let mut names = Names {
        code,
        own,
        facts_names,
        variables,
        spoilt,
        calibrates,
        figures,
        in_function,
        unknown_calls: BTreeSet::new(),
        needs,
        unknown,
        mistakes,
    };
    names.own_functions();
    names.walk(&ast.clone_statements_only());
    names.in_function = true;
    names.walk(&ast.clone_functions_only());
    let functions: Vec<String> = names.own.into_iter().map(|(name, _)| name).collect();
    names.unknown.tell(code, &tree.known.variables, &functions, mistakes)
}

struct Names<'a> {
    code: &'a Code,
    own: Vec<(String, usize)>,
    facts_names: Vec<String>,
    /// Variables at the top level; nothing if the parser knows every variable.
    variables: Option<BTreeSet<&'a str>>,
    spoilt: &'a Spoilt<'a>,
    calibrates: bool,
    /// Whether `test` and `untrained` are figures, and not the script's own names.
    figures: bool,
    in_function: bool,
    /// Where calls stand that do not exist: what they are given is not looked at.
    unknown_calls: BTreeSet<Position>,
    needs: &'a mut Needs,
    unknown: Unknown,
    mistakes: &'a mut Mistakes,
}

impl Names<'_> {
    fn mistake(
        &mut self,
        code: &'static str,
        position: Position,
        message: String,
        label: &str,
        help: impl Into<String>,
    ) {
        let source = &self.code.source;
        if self.mistakes.wants(source, explain::offset(source, position)) {
            self.mistakes.add(explain::mistake(source, code, position, message, label).help(help));
        }
    }

    fn own_functions(&mut self) {
        for (name, arguments) in self.own.clone() {
            let span = || self.code.function(&name).unwrap_or(0..0);
            let at = |code, message: String| Diagnostic::new(code, message);
            let taken = FUNCTIONS.iter().any(|row| row.name == name) || SETUP.iter().any(|row| row.name == name);
            if taken {
                let wrong = at("E-SCRIPT-NAME", format!("'{name}' is the name of one of the engine's functions"));
                self.mistakes.add(wrong.at(&self.code.source, span(), "defined here").help("choose another name"));
            } else if matches!(name.as_str(), "reward" | "calibrate") && arguments != 1 {
                let wrong =
                    at("E-SCRIPT-REWARD", format!("'fn {name}' takes one argument, the facts; found {arguments}"));
                let help = format!("write fn {name}(facts) {{ ... }}");
                self.mistakes.add(wrong.at(&self.code.source, span(), "defined here").help(help));
            }
        }
    }

    fn walk(&mut self, ast: &AST) {
        ast.walk(&mut |path: &[ASTNode<'_>]| {
            self.node(path);
            true
        });
    }

    fn node(&mut self, path: &[ASTNode<'_>]) {
        let form = path.iter().position(|node| matches!(node, ASTNode::Expr(Expr::Custom(..))));
        let (in_rule, misplaced) = (form.is_some(), form.is_some_and(|depth| self.in_function || depth != 1));
        let success = path.iter().any(|node| matches!(node, ASTNode::Expr(expr) if is_success_expr(expr)));
        match path.last() {
            Some(ASTNode::Expr(Expr::Custom(_, position))) if misplaced => {
                let what = if success { "a condition of success" } else { "a rule" };
                let message = format!("{what} stands by itself, not inside a function, a loop or a condition");
                self.mistake(
                    "E-SCRIPT-RULE",
                    *position,
                    message,
                    "found here",
                    "move it to the top level of the script",
                );
            }
            // It reads other names where it belongs; what a success reads is looked at where it is compiled.
            _ if misplaced || success || self.is_given_to_unknown(path) => {}
            Some(ASTNode::Stmt(Stmt::Var(variable, ..))) if !self.in_function && path.len() == 1 => {
                self.defined(&variable.0.name, variable.0.pos);
            }
            Some(ASTNode::Stmt(Stmt::FnCall(call, position)) | ASTNode::Expr(Expr::FnCall(call, position))) => {
                self.called(call, *position, in_rule, 0);
            }
            Some(ASTNode::Expr(Expr::MethodCall(call, position))) => self.called(call, *position, in_rule, 1),
            Some(ASTNode::Expr(expr @ (Expr::Dot(..) | Expr::Index(..)))) => self.chain(expr, in_rule),
            Some(ASTNode::Expr(expr @ Expr::Variable(..))) => self.variable(expr, in_rule),
            _ => {}
        }
    }

    fn is_given_to_unknown(&self, path: &[ASTNode<'_>]) -> bool {
        let above = path.split_last().map_or(path, |(_, above)| above);
        !self.unknown_calls.is_empty()
            && above.iter().any(|node| match node {
                ASTNode::Stmt(Stmt::FnCall(_, position))
                | ASTNode::Expr(Expr::FnCall(_, position) | Expr::MethodCall(_, position)) => {
                    self.unknown_calls.contains(position)
                }
                _ => false,
            })
    }

    fn defined(&mut self, name: &str, position: Position) {
        if is_group(name) || matches!(name, "facts" | "calibrated") {
            let message = format!("'{name}' is the name of facts");
            self.mistake("E-SCRIPT-NAME", position, message, "defined here", "choose another name");
        }
    }

    fn variable(&mut self, expr: &Expr, in_rule: bool) {
        let Some(Access { root, is_local: false, position, .. }) = Access::of(expr) else { return };
        let is_group = is_group(root);
        if !is_group && !matches!(root, "facts" | "calibrated") {
            if matches!(root, "test" | "untrained") && self.figures {
                let message = format!("'{root}' can be read only in a success: nothing is tested yet");
                let help = "success \"name\" when test.failures_per_1000 <= 2;";
                return self.mistake("E-SCRIPT-SUCCESS", position, message, "read too early", help);
            }
            let defined = self.variables.as_ref().is_none_or(|known| known.contains(root)) || self.spoilt.has(root);
            if !defined && !self.own.iter().any(|(name, _)| name == root) {
                self.unknown.variable(root, explain::offset(&self.code.source, position));
            }
            return;
        }
        if self.in_function {
            let message = format!("a function sees facts only through its argument: '{root}' is not known here");
            let help = if is_group {
                format!("write facts.{root}")
            } else {
                "give the function an argument: facts".to_owned()
            };
            self.mistake("E-SCRIPT-FACT", position, message, "not known here", help);
        } else if !in_rule {
            let message = format!("'{root}' can be read only in rules and functions: nothing is measured yet");
            self.mistake("E-SCRIPT-FACT", position, message, "read too early", "move it into a rule");
        } else if root == "calibrated" && !self.calibrates {
            let message = "there is no 'fn calibrate', so nothing is calibrated".to_owned();
            self.mistake("E-SCRIPT-FACT", position, message, "not known", "write fn calibrate(facts) { ... }");
        }
    }

    fn called(&mut self, call: &FnCallExpr, position: Position, in_rule: bool, receiver: usize) {
        let (name, found) = (call.name.as_str(), call.args.len() + receiver);
        if call.is_operator_call() || !name.starts_with(|c: char| c.is_alphabetic() || c == '_') {
            self.text_compared(call, position);
            return self.whole_division(call, position);
        }
        if SETUP.iter().any(|row| row.name == name) && receiver == 0 {
            if self.in_function || in_rule {
                let message = format!("'{name}' sets up: it cannot be used here");
                self.mistake("E-SCRIPT-SETTING", position, message, "too late", "move it to the top of the script");
            }
            return;
        }
        let own: Vec<usize> = self.own.iter().filter(|row| row.0 == name).map(|row| row.1).collect();
        let wanted = FUNCTIONS.iter().find(|row| row.name == name);
        let of_facts = takes_arguments(name) && receiver == 1;
        if of_facts || own.contains(&found) {
            return;
        }
        if let Some(row) = wanted {
            if !(row.arguments.0..=row.arguments.1).contains(&found) {
                let message = format!("'{name}' takes another number of arguments");
                self.mistake("E-SCRIPT-NAME", position, message, "here", format!("write {}", row.form));
            }
        } else if let Some(wanted) = own.first() {
            let message = format!("'{name}' takes {wanted} arguments, found {found}");
            self.mistake("E-SCRIPT-NAME", position, message, "here", "look at its definition");
        } else if !self.spoilt.has(name) {
            self.unknown_calls.insert(position);
            self.unknown.function(name, explain::offset(&self.code.source, position));
        }
    }

    /// A comparison of a number with a text is never true, silently.
    fn text_compared(&mut self, call: &FnCallExpr, position: Position) {
        let [a, b] = call.args.as_slice() else { return };
        let is_text = |expr: &Expr| matches!(expr, Expr::StringConstant(..) | Expr::InterpolatedString(..));
        let orders = matches!(call.name.as_str(), "<" | "<=" | ">" | ">=");
        let equals = matches!(call.name.as_str(), "==" | "!=");
        let wrong = orders || equals && (self.is_fact(a) || self.is_fact(b));
        if wrong && (is_text(a) || is_text(b)) {
            let message = "a number cannot be compared with a text".to_owned();
            self.mistake("E-SCRIPT-NAME", position, message, "here", "write a number without quotes");
        }
    }

    fn is_fact(&self, expr: &Expr) -> bool {
        let Some(access) = Access::of(expr) else { return false };
        let all = self.facts_names.iter().any(|name| name == access.root);
        let group = if all { access.group_of_facts() } else { access.group() };
        group.is_some_and(|(group, links)| is_group(group) && fact_of(group, links).is_some())
    }

    /// `1 / 2` is 0 between whole numbers: nobody means that.
    fn whole_division(&mut self, call: &FnCallExpr, position: Position) {
        if let ("/", [Expr::IntegerConstant(a, _), Expr::IntegerConstant(b, _)]) =
            (call.name.as_str(), call.args.as_slice())
            && a.checked_rem(*b) != Some(0)
        {
            let message = "a division of whole numbers drops the fraction".to_owned();
            self.mistake("E-SCRIPT-RULE", position, message, "here", format!("write {a}.0 / {b}.0"));
        }
    }

    fn chain(&mut self, expr: &Expr, in_rule: bool) {
        let Some(access) = Access::of(expr) else { return };
        let is_facts = self.facts_names.iter().any(|name| name == access.root);
        let group = match (self.in_function, is_facts && (access.is_local || in_rule)) {
            (_, true) => {
                if let Some(Link::Property(group, position)) = access.links.first().copied()
                    && group != "calibrated"
                    && !is_group(group)
                {
                    return self.no_group(group, position);
                }
                // As a dictionary is read elsewhere: `params["speed"]`.
                if let Some(Link::Index(Expr::StringConstant(group, position))) = access.links.first()
                    && !is_group(group)
                {
                    return self.no_group(group, *position);
                }
                access.group_of_facts()
            }
            (false, false) if in_rule && !access.is_local => access.group(),
            _ => None,
        };
        if let Some((group, links)) = group
            && is_group(group)
        {
            self.group(group, links);
        }
    }

    fn no_group(&mut self, name: &str, position: Position) {
        let source = &self.code.source;
        if self.mistakes.wants(source, explain::offset(source, position)) {
            self.mistakes.add(explain::unknown_group(source, position, name));
        }
    }

    fn group(&mut self, group: &str, links: &[Link<'_>]) {
        match links {
            [Link::Index(beam), ..] if group == "laser" => self.beam(beam),
            [Link::Call(call, position), rest @ ..] => {
                self.call_of_facts(group, call, *position);
                if let ("sector", [next, ..]) = (call.name.as_str(), rest) {
                    self.sector(next);
                }
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
            Some(_) if name == "sector" => call.args.iter().for_each(|beam| self.beam(beam)),
            Some(_) if name == "cell" => {
                if let [Expr::IntegerConstant(row, at), Expr::IntegerConstant(column, _)] = call.args.as_slice() {
                    self.needs.cells.push((*row, *column, *at));
                }
            }
            Some(_) => {}
        }
    }

    fn beam(&mut self, beam: &Expr) {
        if let Expr::IntegerConstant(number, position) = beam {
            self.needs.beams.push((*number, *position));
        }
    }
}
