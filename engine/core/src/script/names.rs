//! Every name in a script checked before anything runs: facts, functions, and where a rule may stand.

use super::access::{Access, Link, fact_of};
use super::guards::is_guard_expr;
use super::setup_table::SETUP;
use super::source::Code;
use super::spoilt::Spoilt;
use super::state_parts::is_bins_expr;
use super::syntax::{Forms, is_measure_expr, is_success_expr};
use super::tree::Tree;
use super::unknown::Unknown;
use super::uses::is_use_expr;
use crate::diagnostic::{Diagnostic, Mistakes};
use crate::judge::explain;
use crate::judge::fact_table::takes_arguments;
use crate::judge::functions::{FUNCTIONS, WINDOWS};
use crate::judge::needs::Needs;
use crate::settings::UNNAMED_VIEW;
use rhai::{AST, ASTNode, Expr, FnCallExpr, Position, Stmt};
use std::collections::BTreeSet;

/// The groups and set-up calls of the first version of the language: scripts never could use these names for their own things.
/// What came later is the script's own where it defines it.
const FIRST_GROUPS: [&str; 6] = ["laser", "camera", "action", "robot", "state", "time"];
const FIRST_SETUP: [&str; 13] = [
    "world", "filter", "actions", "run", "robot", "camera", "laser", "grid", "learner", "recovery", "movers", "policy",
    "combine",
];

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
    let figures = Forms::of(code).success;
    let in_function = false;
    let measures = &tree.known.measures;
    let mut names = Names {
        code,
        own,
        measures,
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

/// Whether a node is an argument of `state`, or a part of one.
fn is_in_state(path: &[ASTNode<'_>]) -> bool {
    let call = |node: &ASTNode<'_>| match node {
        ASTNode::Stmt(Stmt::FnCall(call, _)) | ASTNode::Expr(Expr::FnCall(call, _)) => call.name == "state",
        _ => false,
    };
    path.iter().any(call)
}

/// Whether a form stands where it may: at the top level by itself; `bins` as an argument of `state` there.
fn stands_well(path: &[ASTNode<'_>], depth: usize) -> bool {
    let is_state = |call: &FnCallExpr| call.name == "state";
    match (&path[..depth], &path[depth]) {
        (above, ASTNode::Expr(expr)) if is_bins_expr(expr) => match above {
            [ASTNode::Stmt(Stmt::FnCall(call, _))] | [ASTNode::Stmt(_), ASTNode::Expr(Expr::FnCall(call, _))] => {
                is_state(call)
            }
            _ => false,
        },
        (above, _) => above.len() == 1,
    }
}

pub(super) struct Names<'a> {
    pub(super) code: &'a Code,
    own: Vec<(String, usize)>,
    /// Names of measures, read as facts are.
    measures: &'a [String],
    facts_names: Vec<String>,
    /// Variables at the top level; nothing if the parser knows every variable.
    variables: Option<BTreeSet<&'a str>>,
    spoilt: &'a Spoilt<'a>,
    calibrates: bool,
    /// Whether `test` and `untrained` are figures, and not the script's own names.
    figures: bool,
    in_function: bool,
    /// Where calls stand that do not exist: what they are given is not looked at.
    pub(super) unknown_calls: BTreeSet<Position>,
    pub(super) needs: &'a mut Needs,
    unknown: Unknown,
    pub(super) mistakes: &'a mut Mistakes,
}

impl Names<'_> {
    pub(super) fn mistake(
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
            let taken = FUNCTIONS.iter().any(|row| row.name == name) || FIRST_SETUP.contains(&name.as_str());
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
        let misplaced = form.is_some_and(|depth| self.in_function || !stands_well(path, depth));
        let in_rule = form.is_some();
        let success = path.iter().any(|node| matches!(node, ASTNode::Expr(expr) if is_success_expr(expr)));
        match path.last() {
            Some(ASTNode::Expr(Expr::Custom(_, position))) if misplaced => {
                let measure = matches!(path.last(), Some(ASTNode::Expr(expr)) if is_measure_expr(expr));
                if matches!(path.last(), Some(ASTNode::Expr(expr)) if is_bins_expr(expr)) {
                    return self.bins_elsewhere(*position);
                }
                let is = |form: fn(&Expr) -> bool| matches!(path.last(), Some(ASTNode::Expr(expr)) if form(expr));
                let what = match (success, measure) {
                    _ if is(is_guard_expr) => "a guard",
                    _ if is(is_use_expr) => "a use",
                    (true, _) => "a condition of success",
                    (_, true) => "a measure",
                    _ => "a rule",
                };
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
            Some(ASTNode::Expr(expr @ Expr::Variable(..))) if !in_rule && is_in_state(path) => self.bare_part(expr),
            Some(ASTNode::Expr(expr @ Expr::Variable(..))) => self.variable(expr, in_rule),
            _ => {}
        }
    }

    fn bins_elsewhere(&mut self, position: Position) {
        let message = "bins stands inside state(...)".to_owned();
        self.mistake("E-SCRIPT-RULE", position, message, "found here", "write state(bins(laser.front, [0.5, 1.0]));");
    }

    /// A fact in `state(...)` that is not told apart by ranges.
    fn bare_part(&mut self, expr: &Expr) {
        let Some(Access { root, is_local: false, position, .. }) = Access::of(expr) else { return };
        if self.is_group(root) || self.measures.iter().any(|name| name == root) {
            let message = "a value in a state is told apart by ranges".to_owned();
            let help = "write bins(laser.front, [0.5, 1.0]), or a view by its name in quotes";
            return self.mistake("E-SCRIPT-SETTING", position, message, "which ranges?", help);
        }
        self.variable(expr, false);
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
        if FIRST_GROUPS.contains(&name) || matches!(name, "facts" | "calibrated") {
            let message = format!("'{name}' is the name of facts");
            self.mistake("E-SCRIPT-NAME", position, message, "defined here", "choose another name");
        }
    }

    fn variable(&mut self, expr: &Expr, in_rule: bool) {
        let Some(Access { root, is_local: false, position, .. }) = Access::of(expr) else { return };
        if root == UNNAMED_VIEW && !self.is_group(root) {
            return self.no_group(root, position);
        }
        let is_group = self.is_group(root) && !self.code.defines(root) || self.measures.iter().any(|name| name == root);
        if !is_group && !matches!(root, "facts" | "calibrated") {
            let defined = self.variables.as_ref().is_none_or(|known| known.contains(root)) || self.spoilt.has(root);
            if matches!(root, "test" | "untrained") && (self.figures || !defined) {
                let message = format!("'{root}' can be read only in a success: nothing is tested yet");
                let help = "success \"name\" when test.failures_per_1000 <= 2;";
                return self.mistake("E-SCRIPT-SUCCESS", position, message, "read too early", help);
            }
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
            self.mistake(
                "E-SCRIPT-FACT",
                position,
                message,
                "read too early",
                "move it into a rule, or name it by a measure: measure gap = laser.front;",
            );
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
        let is_own = self.own.iter().any(|row| row.0 == name);
        if SETUP.iter().any(|row| row.name == name) && receiver == 0 && !is_own {
            if self.in_function || in_rule {
                let message = format!("'{name}' sets up: it cannot be used here");
                let help = if name == "laser" { explain::BEAMS } else { "move it to the top of the script" };
                self.mistake("E-SCRIPT-SETTING", position, message, "too late", help);
            }
            return;
        }
        let own: Vec<usize> = self.own.iter().filter(|row| row.0 == name).map(|row| row.1).collect();
        if !is_own && receiver == 0 && WINDOWS.iter().any(|row| row.name == name) {
            return self.window(name, found, position, in_rule);
        }
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

    /// `change`, `average`, `fired`, `since`: where they may stand, and with how many arguments.
    fn window(&mut self, name: &str, found: usize, position: Position, in_rule: bool) {
        let Some(row) = WINDOWS.iter().find(|row| row.name == name) else { return };
        if self.in_function || !in_rule {
            let message = format!("'{name}' can be used only in rules and measures");
            let help = format!("name it outside of the function: measure m = {}; and read facts.m here", row.form);
            self.mistake("E-SCRIPT-WINDOW", position, message, "not here", help);
        } else if !(row.arguments.0..=row.arguments.1).contains(&found) {
            let message = format!("'{name}' takes another number of arguments");
            self.mistake("E-SCRIPT-NAME", position, message, "here", format!("write {}", row.form));
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
        group.is_some_and(|(group, links)| {
            self.code.views.group_of(group).is_some_and(|group| fact_of(group, links).is_some())
        })
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
                    && !self.is_group(group)
                    && !self.measures.iter().any(|name| name == group)
                {
                    return self.no_group(group, position);
                }
                // As a dictionary is read elsewhere: `params["speed"]`.
                if let Some(Link::Index(Expr::StringConstant(group, position))) = access.links.first()
                    && !self.is_group(group)
                {
                    return self.no_group(group, *position);
                }
                access.group_of_facts()
            }
            (false, false) if in_rule && !access.is_local => access.group(),
            _ => {
                self.look_anywhere(&access);
                None
            }
        };
        if let Some((group, links)) = group
            && self.is_group(group)
        {
            self.group(group, links);
        }
    }

    /// Whether it is a group of facts, a view among them.
    pub(super) fn is_group(&self, name: &str) -> bool {
        self.code.views.group_of(name).is_some()
    }
}
