//! Which rules and measures read nothing but what the robot itself does: figures of these can be had like a reward.

use super::access::{Access, Link};
use super::syntax::{written_measures, written_rules};
use rhai::{ASTNode, Expr, Stmt};

/// Groups of facts that say what the robot does, not what comes of it.
const OWN: [&str; 3] = ["action", "time", "stage"];

/// The names of such rules and measures.
#[derive(Debug, Default)]
pub(super) struct OwnDoing<'a> {
    pub rules: Vec<&'a str>,
    pub measures: Vec<&'a str>,
}

impl<'a> OwnDoing<'a> {
    /// Looks through measures: each stands above those that read it.
    pub(super) fn of(statements: &'a [Stmt], is_group: &dyn Fn(&str) -> bool) -> Self {
        let (written, mut own) = (written_measures(statements), Self::default());
        let measures: Vec<&str> = written.iter().map(|one| one.name).collect();
        for measure in &written {
            if !own.reads_more(measure.expression, &measures, is_group) {
                own.measures.push(measure.name);
            }
        }
        let rules = written_rules(statements);
        let does = rules.iter().filter(|rule| !own.reads_more(rule.condition, &measures, is_group));
        let rules = does.map(|rule| rule.name).collect();
        Self { rules, ..own }
    }

    /// Whether an expression reads anything else, or hands it to a function.
    fn reads_more(&self, expr: &Expr, measures: &[&str], is_group: &dyn Fn(&str) -> bool) -> bool {
        let mut more = false;
        expr.walk(&mut Vec::new(), &mut |path: &[ASTNode<'_>]| {
            match path {
                [above @ .., ASTNode::Expr(Expr::Variable(variable, ..))] => {
                    let name = variable.1.as_str();
                    let group = group_read(name, above.last());
                    let own = OWN.contains(&group) || self.measures.contains(&group);
                    // What is no group is a constant, unless it is asked of the facts.
                    let is_fact = is_group(group) || measures.contains(&group) || matches!(name, "facts" | "previous");
                    more |= is_fact && !own;
                }
                // Another rule may read anything.
                [.., ASTNode::Expr(Expr::FnCall(call, _))] => {
                    more |= matches!(call.name.as_str(), "fired" | "since");
                }
                _ => {}
            }
            true
        });
        more
    }
}

/// The group that a variable begins: that of `previous.action.linear` and of `facts.action.linear` is `action`.
fn group_read<'a>(variable: &'a str, above: Option<&ASTNode<'a>>) -> &'a str {
    let Some(ASTNode::Expr(whole)) = above else { return variable };
    let Some(access) = Access::of(whole).filter(|access| access.root == variable) else { return variable };
    let properties = access.links.iter().map_while(|link| match link {
        Link::Property(name, _) => Some(*name),
        _ => None,
    });
    let mut path = std::iter::once(access.root).chain(properties);
    path.find(|name| !matches!(*name, "facts" | "previous")).unwrap_or(variable)
}
