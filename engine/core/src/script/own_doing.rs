//! Which rules and measures read nothing but what the robot itself does: figures of these can be had like a reward.

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
            match path.last() {
                Some(ASTNode::Expr(Expr::Variable(variable, ..))) => {
                    let name = variable.1.as_str();
                    let measured = measures.contains(&name) && !self.measures.contains(&name);
                    more |= measured || name == "facts" || is_group(name) && !OWN.contains(&name);
                }
                // Another rule may read anything.
                Some(ASTNode::Expr(Expr::FnCall(call, _))) => more |= matches!(call.name.as_str(), "fired" | "since"),
                _ => {}
            }
            true
        });
        more
    }
}
