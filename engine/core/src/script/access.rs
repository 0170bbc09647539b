//! `facts.laser.sector(50, 130).nearest` taken apart: a root and what follows it.

use crate::judge::fact_table::{Fact, FactId, call, value};
use rhai::{ASTFlags, Expr, FnCallExpr, Position};

/// One thing after the root.
#[derive(Debug, Clone, Copy)]
pub(super) enum Link<'a> {
    /// `.name`
    Property(&'a str, Position),
    /// `.name(arguments)`
    Call(&'a FnCallExpr, Position),
    /// `[index]`
    Index(&'a Expr),
}

/// A root variable and what follows it.
#[derive(Debug)]
pub(super) struct Access<'a> {
    /// The variable's name.
    pub root: &'a str,
    /// Whether the parser found a local variable of this name.
    pub is_local: bool,
    /// Where the root stands.
    pub position: Position,
    /// What follows it.
    pub links: Vec<Link<'a>>,
}

impl<'a> Access<'a> {
    /// Takes an expression apart, if it begins with a variable.
    pub(super) fn of(expr: &'a Expr) -> Option<Self> {
        let mut links = Vec::new();
        let root = match expr {
            Expr::Dot(pair, flags, _) => {
                follow(&pair.rhs, flags.contains(ASTFlags::BREAK), false, &mut links);
                &pair.lhs
            }
            Expr::Index(pair, flags, _) => {
                follow(&pair.rhs, flags.contains(ASTFlags::BREAK), true, &mut links);
                &pair.lhs
            }
            root => root,
        };
        match root {
            Expr::Variable(variable, short, position) if variable.2.is_empty() => {
                let is_local = short.is_some() || variable.0.is_some();
                Some(Self { root: &variable.1, is_local, position: *position, links })
            }
            _ => None,
        }
    }

    /// The group of facts that it reads, and what follows it: `laser.x` and `facts.laser.x` alike.
    pub(super) fn group(&self) -> Option<(&'a str, &[Link<'a>])> {
        if self.root == "facts" { self.group_of_facts() } else { Some((self.root, &self.links)) }
    }

    /// The group of facts that it reads if its root, whatever the name, is all the facts.
    pub(super) fn group_of_facts(&self) -> Option<(&'a str, &[Link<'a>])> {
        match self.links.split_first() {
            Some((Link::Property(group, _), rest)) => Some((group, rest)),
            _ => None,
        }
    }
}

/// The fact that a group and what follows it name. The laser and a sector of it stand for their nearest range.
pub(super) fn fact_of(group: &str, links: &[Link<'_>]) -> Option<&'static Fact> {
    match (group, links) {
        ("laser", []) => Some(FactId::LaserNearest.fact()),
        ("laser", [Link::Index(_)]) => Some(FactId::LaserBeam.fact()),
        ("laser", [Link::Call(sector, _), rest @ ..]) if matches!(sector.name.as_str(), "sector" | "between") => {
            match rest {
                [] => Some(FactId::SectorNearest.fact()),
                [Link::Property(key, _)] => value("sector", key),
                [Link::Call(of_sector, _)] => call("sector", &of_sector.name),
                _ => None,
            }
        }
        (_, [Link::Property(key, _)]) => value(group, key),
        (_, [Link::Call(of_group, _)]) => call(group, &of_group.name),
        _ => None,
    }
}

// The parser nests to the right: `a.b[c].d` is `a . (b [ (c . d) ])`; a flag says where the nesting ends.
fn follow<'a>(expr: &'a Expr, ends: bool, indexed: bool, links: &mut Vec<Link<'a>>) {
    match expr {
        Expr::Dot(pair, flags, _) if !ends => {
            link(&pair.lhs, indexed, links);
            follow(&pair.rhs, flags.contains(ASTFlags::BREAK), false, links);
        }
        Expr::Index(pair, flags, _) if !ends => {
            link(&pair.lhs, indexed, links);
            follow(&pair.rhs, flags.contains(ASTFlags::BREAK), true, links);
        }
        last => link(last, indexed, links),
    }
}

fn link<'a>(expr: &'a Expr, indexed: bool, links: &mut Vec<Link<'a>>) {
    links.push(match expr {
        index if indexed => Link::Index(index),
        Expr::Property(property, position) => Link::Property(&property.2, *position),
        Expr::MethodCall(call, position) => Link::Call(call, *position),
        other => Link::Index(other),
    });
}
