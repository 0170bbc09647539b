//! What a condition reads, found part by part in the script's tree.

use super::access::{Access, Link, fact_of};
use super::compile::Compiler;
use super::positions::{access_end, body_end, first, part_end};
use super::source::Code;
use crate::judge::explain::offset;
use crate::judge::expression::{BeamSpan, Typed};
use crate::judge::fact_columns::Beam;
use crate::judge::fact_table::{FACTS, FactId};
use crate::judge::functions::WINDOWS;
use crate::judge::readings::{ALL, BeamSought, Part, Reading};
use crate::settings::UNNAMED_VIEW;
use rhai::{AST, ASTNode, Expr};
use std::ops::Range;

/// The parts of a condition.
pub(super) fn parts(code: &Code, condition: &Expr, compiler: &mut Compiler<'_>) -> Vec<Part> {
    let uses = compiler.needs.slot_uses.len();
    let mut parts = Vec::new();
    add(code, condition, compiler, &mut parts);
    compiler.needs.slot_uses.truncate(uses);
    parts
}

/// `fn reward` as one part: what its body reads. The order of the tree is not that of the text, so it is sorted.
pub(super) fn function_parts(code: &Code, ast: &AST, name: &Range<usize>, compiler: &mut Compiler<'_>) -> Vec<Part> {
    let body = name.start..body_end(&code.plain, name.start);
    let uses = compiler.needs.slot_uses.len();
    let mut found = Vec::new();
    ast.clone_functions_only().walk(&mut |path: &[ASTNode<'_>]| {
        if let Some(ASTNode::Expr(expr)) = path.last() {
            collect(code, expr, compiler, &mut found);
        }
        true
    });
    compiler.needs.slot_uses.truncate(uses);
    found.retain(|(start, _)| body.contains(start));
    found.sort_by_key(|(start, _)| *start);
    let mut readings: Vec<Reading> = Vec::new();
    for (_, reading) in found {
        if !readings.iter().any(|known| known.name == reading.name) {
            readings.push(reading);
        }
    }
    // Under another name than 'facts' only whole names are found.
    let text = &code.plain[body];
    let is_named = |name: &str| {
        let after = |at: usize| text[at..].chars().next().is_none_or(|c| !c.is_alphanumeric() && c != '_');
        text.match_indices(name).any(|(at, found)| after(at + found.len()))
    };
    for fact in FACTS {
        let views = compiler.script.views.iter().enumerate().filter(|_| fact.group == UNNAMED_VIEW);
        let of_views = views.map(|(view, name)| (view, format!("{name}.{}", fact.key)));
        let own = (fact.group != UNNAMED_VIEW).then(|| (0, fact.name()));
        for (view, name) in of_views.chain(own).filter(|(_, name)| is_named(name)) {
            if !readings.iter().any(|known| known.name == name) {
                readings.extend(Reading::of_fact(fact, name, view));
            }
        }
    }
    vec![Part { span: name.clone(), flag: None, readings }]
}

fn add(code: &Code, expr: &Expr, compiler: &mut Compiler<'_>, parts: &mut Vec<Part>) {
    if let Expr::And(all, _) | Expr::Or(all, _) = expr {
        return all.iter().for_each(|part| add(code, part, compiler, parts));
    }
    let start = offset(&code.source, first(expr));
    let flag = match compiler.expression(expr) {
        Some(Typed::Flag(flag)) => Some(flag),
        _ => None,
    };
    parts.push(Part { span: start..part_end(code, start), flag, readings: readings(code, expr, compiler) });
}

fn readings(code: &Code, expr: &Expr, compiler: &mut Compiler<'_>) -> Vec<Reading> {
    let mut found = Vec::new();
    expr.walk(&mut Vec::new(), &mut |path: &[ASTNode<'_>]| {
        if let Some(ASTNode::Expr(expr)) = path.last() {
            collect(code, expr, compiler, &mut found);
        }
        true
    });
    found.into_iter().map(|(_, reading)| reading).collect()
}

/// Adds what an expression reads, with where it begins, if it is one fact.
fn collect(code: &Code, expr: &Expr, compiler: &mut Compiler<'_>, found: &mut Vec<(usize, Reading)>) {
    if let Expr::FnCall(call, position) = expr
        && WINDOWS.iter().any(|row| row.name == call.name)
        && let Some(typed) = compiler.expression(expr)
    {
        let start = offset(&code.source, *position);
        let name = code.source.text[start..access_end(code, start)].to_owned();
        return found.push((start, Reading { name, typed, id: None, look: BeamSought::Nowhere }));
    }
    let Some(access) = Access::of(expr) else { return };
    let start = offset(&code.source, access.position);
    // The outermost of a chain comes first; its parts begin where it begins.
    if found.iter().any(|(known, _)| *known == start) {
        return;
    }
    let typed = compiler.range(expr).map(Typed::Number).or_else(|| compiler.expression(expr));
    if let (Some(typed), Some((id, look))) = (typed, describe(code, &access, compiler)) {
        let name = code.source.text[start..access_end(code, start)].trim_start_matches("facts.").to_owned();
        found.push((start, Reading { name, typed, id, look }));
    }
}

/// Which fact a chain reads, nothing for what was calibrated; and which beam to name with it.
fn describe(code: &Code, access: &Access<'_>, compiler: &mut Compiler<'_>) -> Option<(Option<FactId>, BeamSought)> {
    let (group, links) = access.group()?;
    let (group, links) = match links {
        // Of the step before, whose beams are no longer to be seen.
        [Link::Property(group, _), rest @ ..] if access.root == "previous" => {
            return fact_of(code.views.group_of(group)?, rest).map(|fact| (Some(fact.id), BeamSought::Nowhere));
        }
        links => (group, links),
    };
    let known = code.views.group_of(group);
    if links.is_empty() && known.is_none() || group == "calibrated" {
        return Some((None, BeamSought::Nowhere));
    }
    let fact = fact_of(known?, links)?;
    let look = match (fact.beam, links) {
        (Beam::Given, [Link::Index(beam)]) => BeamSought::One(compiler.beam(beam)?),
        (Beam::Given, [Link::Call(call, _)]) if group == "laser" => match (call.name.as_str(), call.args.as_slice()) {
            ("hit", [of]) => BeamSought::One(compiler.beam(of)?),
            (_, [of]) => BeamSought::Given(compiler.bearing(of)?),
            _ => BeamSought::Nowhere,
        },
        (beam, [Link::Call(call, _), rest @ ..]) if group == "laser" => {
            let span = compiler.sector(call)?;
            match (beam, rest) {
                (Beam::Worst, [Link::Call(call, _)]) if let BeamSpan::Numbers(from, to) = span => compiler
                    .expected(from, to, call)
                    .map_or(BeamSought::Nowhere, |slot| BeamSought::Worst(from, to, slot)),
                _ => BeamSought::of(beam, span),
            }
        }
        (beam, _) => BeamSought::of(beam, ALL),
    };
    Some((Some(fact.id), look))
}
