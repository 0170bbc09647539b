//! The outline of a script: its rules, what stands in its functions, and which names are used at all.

use super::access::{Access, Link};
use super::outline::{BeamLoop, Gathers, ScriptOutline, UnusedName};
use super::params::param_call;
use super::positions::{body_end, span};
use super::reader::{Local, OutlineReader};
use super::source::Code;
use super::syntax::{is_success_expr, written_measures, written_rules};
use crate::judge::rule::CompiledRule;
use rhai::{AST, ASTNode, Expr, Scope, Stmt};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// A function: its name, the bytes of its name, and where its body ends.
struct OwnFunction {
    name: String,
    span: Range<usize>,
    end: usize,
}

/// The outline of a script without a mistake, with its compiled rules.
pub(super) fn outline_of(code: &Code, ast: &AST, constants: &Scope<'static>, rules: &[CompiledRule]) -> ScriptOutline {
    let reader = OutlineReader { code, constants, measures: written_measures(ast.statements()) };
    let written = written_rules(ast.statements());
    let rules = rules.iter().zip(&written).map(|(rule, written)| reader.rule(rule, written)).collect();
    let mut outline = ScriptOutline { rules, ..ScriptOutline::default() };
    read(&reader, ast, &mut outline);
    outline
}

/// Reads all functions, and which names the whole script uses.
fn read(reader: &OutlineReader<'_>, ast: &AST, outline: &mut ScriptOutline) {
    let functions = functions(reader, ast);
    let reached = reached(reader, &functions);
    let bodies = ast.clone_functions_only();
    let locals = locals(reader, &bodies, &functions);
    outline.reward = functions.iter().find(|function| function.name == "reward").map(|function| function.span.clone());
    let mut groups = BTreeSet::new();
    let mut seen = BTreeSet::new();
    bodies.walk(&mut |path: &[ASTNode<'_>]| {
        let Some(at) = path.last().map(|node| reader.at(node.position())) else { return true };
        let within = functions.iter().find(|function| (function.span.start..function.end).contains(&at));
        let Some(function) = within else { return true };
        let judges = reached.contains(function.name.as_str());
        let local = |name: &str| locals.get(&(function.name.clone(), name.to_owned())).cloned();
        if let Some(ASTNode::Expr(expr)) = path.last() {
            outline.comparisons.extend(reader.compared(expr, &local));
            if judges {
                groups.extend(group(reader.code, expr));
                outline.reward_recovers |= recovers(expr);
            }
        }
        if judges
            && let Some(found) = beam_loop(reader, path)
            && seen.insert(found.span.start)
        {
            outline.loops.push(found);
        }
        true
    });
    let statements = ast.clone_statements_only();
    statements.walk(&mut |path: &[ASTNode<'_>]| {
        let read = |expr: &Expr| matches!(expr, Expr::Custom(..)) && !is_success_expr(expr);
        let in_rule = path.iter().any(|node| matches!(node, ASTNode::Expr(expr) if read(expr)));
        if let Some(ASTNode::Expr(Expr::FnCall(call, _))) = path.last()
            && let ("fired" | "since", [Expr::StringConstant(rule, _)]) = (call.name.as_str(), call.args.as_slice())
        {
            outline.remembered.push(rule.to_string());
        }
        if let (true, Some(ASTNode::Expr(expr))) = (in_rule, path.last()) {
            groups.extend(group(reader.code, expr));
        }
        true
    });
    outline.comparisons.sort_by_key(|compared| compared.span.start);
    outline.loops.sort_by_key(|found| found.span.start);
    let measures = written_measures(ast.statements());
    outline.measures = measures.iter().map(|one| (one.name.to_owned(), span(reader.code, one.expression))).collect();
    outline.groups = groups.into_iter().collect();
    outline.unused = unused(reader, ast, &functions);
}

fn functions(reader: &OutlineReader<'_>, ast: &AST) -> Vec<OwnFunction> {
    let names = ast.iter_functions().map(|function| function.name.to_owned());
    let mut functions: Vec<OwnFunction> = names
        .filter_map(|name| {
            let span = reader.code.function(&name)?;
            let end = body_end(&reader.code.plain, span.start);
            Some(OwnFunction { name, span, end })
        })
        .collect();
    functions.sort_by_key(|function| function.span.start);
    functions
}

/// `fn reward` and every function that it calls, directly or not.
fn reached<'a>(reader: &OutlineReader<'_>, functions: &'a [OwnFunction]) -> BTreeSet<&'a str> {
    let mut reached = BTreeSet::from(["reward"]);
    loop {
        let texts: Vec<&str> = functions
            .iter()
            .filter(|function| reached.contains(function.name.as_str()))
            .map(|function| &reader.code.plain[function.span.end..function.end])
            .collect();
        let called = functions.iter().map(|function| function.name.as_str());
        let more: Vec<&str> =
            called.filter(|name| !reached.contains(name) && texts.iter().any(|text| uses(text, name) > 0)).collect();
        if more.is_empty() {
            return reached;
        }
        reached.extend(more);
    }
}

/// Local variables that stand for a fact or a number and are never assigned again, by function and name.
fn locals(reader: &OutlineReader<'_>, bodies: &AST, functions: &[OwnFunction]) -> BTreeMap<(String, String), Local> {
    let mut locals = BTreeMap::new();
    let mut spoilt = BTreeSet::new();
    bodies.walk(&mut |path: &[ASTNode<'_>]| {
        let Some(ASTNode::Stmt(statement)) = path.last() else { return true };
        let at = reader.at(statement.position());
        let Some(function) = functions.iter().find(|f| (f.span.start..f.end).contains(&at)) else { return true };
        match statement {
            Stmt::Var(variable, ..) => {
                let key = (function.name.clone(), variable.0.name.to_string());
                let fact = reader.fact(&variable.1).map(Local::Fact);
                let local = fact.or_else(|| reader.number(&variable.1, &|_| None).map(Local::Number));
                match (local, locals.contains_key(&key)) {
                    (Some(local), false) => drop(locals.insert(key, local)),
                    _ => drop(spoilt.insert(key)),
                }
            }
            Stmt::Assignment(assignment) => {
                if let Some(access) = Access::of(&assignment.1.lhs) {
                    spoilt.insert((function.name.clone(), access.root.to_owned()));
                }
            }
            _ => {}
        }
        true
    });
    locals.retain(|key, _| !spoilt.contains(key));
    locals
}

/// The group of facts that an expression reads.
fn group(code: &Code, expr: &Expr) -> Option<String> {
    if !matches!(expr, Expr::Dot(..) | Expr::Index(..) | Expr::Variable(..)) {
        return None;
    }
    let access = Access::of(expr)?;
    let of_first = || match access.links.first() {
        Some(Link::Property(group, _)) => code.views.group_of(group),
        // Facts handed to another function as a whole are told apart there.
        _ => None,
    };
    code.views.group_of(access.root).or_else(of_first).map(str::to_owned)
}

/// Whether it is a map that asks for recovery.
fn recovers(expr: &Expr) -> bool {
    match expr {
        Expr::Map(map, _) => map.0.iter().any(|(key, value)| match key.name.as_str() {
            "then" => true,
            "recover" => !matches!(value, Expr::BoolConstant(false, _)),
            _ => false,
        }),
        // A constant map is folded to one value.
        Expr::DynamicConstant(value, _) => value.read_lock::<rhai::Map>().is_some_and(|map| {
            map.contains_key("then") || map.get("recover").is_some_and(|on| on.as_bool() == Ok(true))
        }),
        _ => false,
    }
}

/// The loop around the last node, if that reads a single beam of the laser.
fn beam_loop(reader: &OutlineReader<'_>, path: &[ASTNode<'_>]) -> Option<BeamLoop> {
    let of_laser = |expr: &Expr| {
        let access = Access::of(expr)?;
        let at = if access.root == "laser" { 0 } else { 1 };
        let laser = at == 0 || matches!(access.links.first(), Some(Link::Property("laser", _)));
        match access.links.get(at) {
            // A beam that is a plain number is the same one in each turn.
            Some(Link::Index(beam)) if laser => Some(!matches!(beam, Expr::IntegerConstant(..))),
            _ => None,
        }
    };
    let reads = match path.last()? {
        ASTNode::Expr(expr @ (Expr::Dot(..) | Expr::Index(..))) => of_laser(expr) == Some(true),
        _ => false,
    };
    if !reads {
        return None;
    }
    let is_loop = |node: &&ASTNode<'_>| matches!(node, ASTNode::Stmt(Stmt::For(..) | Stmt::While(..) | Stmt::Do(..)));
    let node = path.iter().find(is_loop)?;
    let start = reader.at(node.position());
    let line = reader.code.source.text[start..].lines().next().unwrap_or_default();
    let text = &reader.code.plain[start..body_end(&reader.code.plain, start)];
    let beams = match node {
        ASTNode::Stmt(Stmt::For(parts, _)) => range(reader, &parts.2.expr),
        _ => None,
    };
    let compact: String = text.chars().filter(|c| !c.is_whitespace()).collect();
    let gathers = match () {
        () if compact.contains("+=1;") || compact.contains("+=1}") => Gathers::Count,
        () if compact.contains("+=") => Gathers::Sum,
        () => Gathers::Other,
    };
    Some(BeamLoop { span: start..start + line.trim_end().trim_end_matches('{').trim_end().len(), beams, gathers })
}

/// The first and the last of `from..=to` or `from..to`.
fn range(reader: &OutlineReader<'_>, expr: &Expr) -> Option<(i64, i64)> {
    let whole = |expr: &Expr| reader.number(expr, &|_| None).map(|value| value as i64);
    match expr {
        Expr::DynamicConstant(value, _) => {
            let inclusive = value.clone().try_cast::<std::ops::RangeInclusive<i64>>();
            let exclusive = || value.clone().try_cast::<Range<i64>>().map(|range| (range.start, range.end - 1));
            inclusive.map(|range| (*range.start(), *range.end())).or_else(exclusive)
        }
        Expr::FnCall(call, _) => match (call.name.as_str(), call.args.as_slice()) {
            ("..=", [from, to]) => Some((whole(from)?, whole(to)?)),
            (".." | "range", [from, to]) => Some((whole(from)?, whole(to)? - 1)),
            _ => None,
        },
        _ => None,
    }
}

/// How often a name stands in a text as a whole word.
fn uses(text: &str, name: &str) -> usize {
    let part = |c: char| c.is_alphanumeric() || c == '_';
    let whole = |at: usize| {
        let before = text[..at].chars().next_back();
        let after = text[at + name.len()..].chars().next();
        !before.is_some_and(|c| part(c) || c == '.' && !text[..at].ends_with("..")) && !after.is_some_and(part)
    };
    text.match_indices(name).filter(|(at, _)| whole(*at)).count()
}

fn unused(reader: &OutlineReader<'_>, ast: &AST, functions: &[OwnFunction]) -> Vec<UnusedName> {
    let (plain, source) = (&reader.code.plain, &reader.code.source);
    // What is spliced into a text is used too.
    let spliced: Vec<&str> = source.text.split("${").skip(1).filter_map(|tail| tail.split('}').next()).collect();
    let once = |name: &str| uses(plain, name) <= 1 && spliced.iter().all(|text| uses(text, name) == 0);
    let mut found: Vec<UnusedName> = Vec::new();
    for statement in ast.statements() {
        if let Stmt::Var(variable, flags, _) = statement {
            let (name, start) = (variable.0.name.as_str(), reader.at(variable.0.pos));
            let constant = flags.contains(rhai::ASTFlags::CONSTANT);
            let what = match (param_call(&variable.1), constant) {
                (Some(_), true) => "parameter",
                (_, true) => "constant",
                _ => "variable",
            };
            if once(name) {
                found.push(UnusedName { what, name: name.to_owned(), span: source.word_at(start) });
            }
        }
    }
    for function in functions {
        let called = if function.name == "calibrate" { "calibrated" } else { &function.name };
        let used = match function.name.as_str() {
            "reward" => true,
            "calibrate" => plain.contains(called),
            _ => !once(called),
        };
        if !used {
            found.push(UnusedName { what: "function", name: function.name.clone(), span: function.span.clone() });
        }
    }
    found.sort_by_key(|name| name.span.start);
    found
}
