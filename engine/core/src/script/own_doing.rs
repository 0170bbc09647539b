//! Which rules and measures read nothing but what the robot itself does: figures of these can be had like a reward.

use super::access::{Access, Link};
use super::syntax::{WrittenRule, written_measures, written_rules};
use crate::judge::rule::CompiledRule;
use crate::outcome::Then;
use crate::verdict::OwnWord;
use rhai::{ASTNode, Expr, Stmt};

/// Groups of facts that say what the robot does, not what comes of it.
const OWN: [&str; 2] = ["action", "time"];
/// Of other groups such facts: how it turns is what it chose, unlike how it gets on, which a wall ends.
const OWN_FACTS: [(&str, &str); 2] = [("robot", "angular"), ("odometry", "turned_deg")];

/// The names of such rules and measures.
#[derive(Debug, Default)]
pub(super) struct OwnDoing<'a> {
    pub rules: Vec<&'a str>,
    pub measures: Vec<&'a str>,
    /// Whether the stage is one of these: no rule that reads anything else leads to one.
    stage: bool,
}

impl<'a> OwnDoing<'a> {
    /// Looks through measures: each stands above those that read it.
    pub(super) fn of(statements: &'a [Stmt], is_group: &dyn Fn(&str) -> bool) -> Self {
        let own = Self::with_stage(true, statements, is_group);
        let rules = written_rules(statements);
        let mut leading = rules.iter().filter(|rule| rule.to_stage.is_some());
        let stage = leading.all(|rule| own.rules.contains(&rule.name));
        if stage { own } else { Self::with_stage(false, statements, is_group) }
    }

    fn with_stage(stage: bool, statements: &'a [Stmt], is_group: &dyn Fn(&str) -> bool) -> Self {
        let (written, mut own) = (written_measures(statements), Self { stage, ..Self::default() });
        let measures: Vec<&str> = written.iter().map(|one| one.name).collect();
        for measure in &written {
            if !own.reads_more(measure.expression, &measures, is_group) {
                own.measures.push(measure.name);
            }
        }
        let rules = written_rules(statements);
        // A rule of some stages alone reads the stage.
        let reads_stage = |rule: &WrittenRule<'_>| !stage && !rule.stages.is_empty();
        let more = |rule: &WrittenRule<'_>| reads_stage(rule) || own.reads_more(rule.condition, &measures, is_group);
        let rules = rules.iter().filter(|rule| !more(rule)).map(|rule| rule.name).collect();
        Self { rules, ..own }
    }

    /// What these rules alone bring about; `fn reward` may read anything.
    pub(super) fn word(&self, rules: &[CompiledRule], by_function: bool) -> OwnWord {
        // A value that changes says by its sign how the attempt ended.
        let says = |rule: &CompiledRule| rule.then != Some(Then::Recover) || rule.fixed_value().is_some();
        let all_own = |brings: fn(&CompiledRule) -> bool| {
            let mut rules = rules.iter().filter(|rule| brings(rule)).peekable();
            let some = !by_function && rules.peek().is_some();
            some && rules.all(|rule| says(rule) && self.rules.contains(&rule.text.name.as_str()))
        };
        OwnWord { endings: all_own(|rule| rule.then.is_some()), stages: all_own(|rule| rule.to_stage.is_some()) }
    }

    /// Whether an expression reads anything else, or hands it to a function.
    fn reads_more(&self, expr: &Expr, measures: &[&str], is_group: &dyn Fn(&str) -> bool) -> bool {
        let mut more = false;
        expr.walk(&mut Vec::new(), &mut |path: &[ASTNode<'_>]| {
            match path {
                [above @ .., ASTNode::Expr(Expr::Variable(variable, ..))] => {
                    let name = variable.1.as_str();
                    let (group, key) = fact_read(name, above.last());
                    let own = OWN.contains(&group)
                        || self.measures.contains(&group)
                        || self.stage && group == "stage"
                        || OWN_FACTS.contains(&(group, key));
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

/// The group that a variable begins, and what is read of it: of `previous.action.linear` and of `facts.action.linear` these are
/// `action` and `linear`.
fn fact_read<'a>(variable: &'a str, above: Option<&ASTNode<'a>>) -> (&'a str, &'a str) {
    let Some(ASTNode::Expr(whole)) = above else { return (variable, "") };
    let Some(access) = Access::of(whole).filter(|access| access.root == variable) else { return (variable, "") };
    let properties = access.links.iter().map_while(|link| match link {
        Link::Property(name, _) => Some(*name),
        _ => None,
    });
    let mut path = std::iter::once(access.root).chain(properties);
    let group = path.find(|name| !matches!(*name, "facts" | "previous")).unwrap_or(variable);
    (group, path.next().unwrap_or_default())
}
