//! What constants and variables of the top level come to in expressions: a result that is no number, and a fraction that is
//! dropped, are told where they are written.

use super::access::Access;
use super::positions::{first, operand_end};
use super::source::Code;
use crate::diagnostic::{Diagnostic, Mistakes};
use crate::judge::explain::offset;
use crate::judge::expression::{Arithmetic, Comparison};
use crate::judge::functions::{OF_ONE, OF_ONE_FRACTION, OF_TWO, OF_TWO_FRACTION};
use rhai::{AST, ASTNode, Expr, FnCallExpr, Scope, Stmt};

/// A number that is known before anything is learned.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Known {
    Whole(i64),
    Fraction(f64),
}

/// Adds every expression that is no number or drops a fraction, of those that read nothing but `constants`: the top level as
/// it has run. Outermost first: what a mistake has in it is not told again.
pub(super) fn check_known(code: &Code, ast: &AST, constants: &Scope<'_>, mistakes: &mut Mistakes) {
    let mut looking = Looking { code, ast, constants, assigned: Vec::new(), in_function: false };
    looking.assigned = assigned(ast);
    for (part, in_function) in [(ast.clone_statements_only(), false), (ast.clone_functions_only(), true)] {
        let looking = Looking { in_function, assigned: looking.assigned.clone(), ..looking };
        part.walk(&mut |path: &[ASTNode<'_>]| {
            let Some((ASTNode::Expr(expr), above)) = path.split_last() else { return true };
            let told = |node: &ASTNode<'_>| matches!(node, ASTNode::Expr(expr) if looking.wrong(expr).is_some());
            if !above.iter().any(told)
                && let Some(wrong) = looking.wrong(expr)
            {
                mistakes.add(wrong);
            }
            true
        });
    }
}

/// Variables that get another value somewhere: what they are at the end is not what they are everywhere.
fn assigned(ast: &AST) -> Vec<String> {
    let mut names = Vec::new();
    ast.walk(&mut |path: &[ASTNode<'_>]| {
        if let Some(ASTNode::Stmt(Stmt::Assignment(assignment))) = path.last()
            && let Some(access) = Access::of(&assignment.1.lhs)
        {
            names.push(access.root.to_owned());
        }
        true
    });
    names
}

struct Looking<'a> {
    code: &'a Code,
    ast: &'a AST,
    constants: &'a Scope<'a>,
    assigned: Vec<String>,
    in_function: bool,
}

impl Looking<'_> {
    /// What is wrong with an expression itself.
    fn wrong(&self, expr: &Expr) -> Option<Diagnostic> {
        let Expr::FnCall(call, position) = expr else { return None };
        let source = &self.code.source;
        let place = offset(source, first(expr))..operand_end(self.code, expr);
        if let Some((a, b)) = self.dropped(call) {
            let at = offset(source, *position);
            let (left, right) = (source.text[place.start..at].trim(), source.text[at + 1..place.end].trim());
            let literal = matches!(call.args.last(), Some(Expr::IntegerConstant(..)));
            let help = if literal { format!("write {left} / {b}.0") } else { format!("write 1.0 * {left} / {right}") };
            let message = "a division of whole numbers drops the fraction";
            let label = format!("{a} / {b} is {} here", a / b);
            return Some(Diagnostic::new("E-SCRIPT-TYPE", message).at(source, at..at + 1, label).help(help));
        }
        // Two texts have an order.
        if let Some(side) = call.args.iter().find(|side| self.has_no_order(side))
            && !call.args.iter().all(|side| self.has_no_order(side) || matches!(side, Expr::StringConstant(..)))
            && Comparison::of(&call.name).is_some_and(Comparison::orders)
        {
            let (start, end) = (offset(source, first(side)), operand_end(self.code, side));
            let message = format!("'{}' is no number: it cannot be more or less", &source.text[start..end]);
            let wrong = Diagnostic::new("E-SCRIPT-TYPE", message).at(source, start..end, "a text, an array or a map");
            return Some(wrong.help("compare with a number, or with one value of it: values[0]"));
        }
        let Some(Known::Fraction(value)) = self.known(expr) else { return None };
        let (message, label, help) = match () {
            () if value.is_nan() => (
                "this gives no number",
                "always NaN",
                "look for a division by 0, or the root or logarithm of a negative number",
            ),
            () if value.is_infinite() => (
                "this gives no finite number",
                "always infinite",
                "look for a division by 0, or a number too large; for a limit that is never reached write 1e6",
            ),
            () => return None,
        };
        Some(Diagnostic::new("E-SCRIPT-TYPE", message).at(source, place, label).help(help))
    }

    /// Two whole numbers of which the first is no multiple of the second. Two literals are told elsewhere.
    fn dropped(&self, call: &FnCallExpr) -> Option<(i64, i64)> {
        let ("/", [a, b]) = (call.name.as_str(), call.args.as_slice()) else { return None };
        let literal = |expr: &Expr| matches!(expr, Expr::IntegerConstant(..));
        match (self.known(a)?, self.known(b)?) {
            (Known::Whole(a_value), Known::Whole(b_value)) if !(literal(a) && literal(b)) => {
                let rest = a_value.checked_rem(b_value)?;
                (rest != 0).then_some((a_value, b_value))
            }
            _ => None,
        }
    }

    /// What an expression comes to, if it reads nothing else and is a number.
    fn known(&self, expr: &Expr) -> Option<Known> {
        match expr {
            Expr::IntegerConstant(value, _) => Some(Known::Whole(*value)),
            Expr::FloatConstant(value, _) => Some(Known::Fraction(**value)),
            Expr::Variable(..) => self.variable(expr),
            Expr::FnCall(call, _) if !call.is_qualified() => self.call(call),
            _ => None,
        }
    }

    /// A variable of the top level; in a function the parser finds only the function's own.
    fn variable(&self, expr: &Expr) -> Option<Known> {
        let access = Access::of(expr).filter(|access| access.links.is_empty())?;
        if self.in_function && access.is_local || self.assigned.iter().any(|name| name == access.root) {
            return None;
        }
        let value = self.constants.get(access.root)?;
        value.as_int().map(Known::Whole).or_else(|_| value.as_float().map(Known::Fraction)).ok()
    }

    /// Whether it is a constant that is neither more nor less than anything.
    fn has_no_order(&self, expr: &Expr) -> bool {
        let alone = |access: &Access<'_>| access.links.is_empty() && !(self.in_function && access.is_local);
        let value = Access::of(expr).filter(alone).and_then(|access| self.constants.get(access.root));
        value.is_some_and(|value| value.is_string() || value.is_array() || value.is_map())
    }

    fn call(&self, call: &FnCallExpr) -> Option<Known> {
        let name = call.name.as_str();
        if self.ast.iter_functions().any(|own| own.name == name) {
            return None;
        }
        match call.args.as_slice() {
            [of] => match (name, self.known(of)?) {
                ("-", Known::Whole(of)) => of.checked_neg().map(Known::Whole),
                ("-", Known::Fraction(of)) => Some(Known::Fraction(-of)),
                (_, Known::Whole(_)) if OF_ONE_FRACTION.iter().any(|row| row.0 == name) => None,
                (_, of) => {
                    let function = OF_ONE.iter().chain(OF_ONE_FRACTION).find(|row| row.0 == name)?.1;
                    Some(Known::Fraction(function(of.number())))
                }
            },
            [a, b] => match (Arithmetic::of(name), self.known(a)?, self.known(b)?) {
                (Some(operator), Known::Whole(a), Known::Whole(b)) => whole(operator, a, b).map(Known::Whole),
                (Some(operator), a, b) => Some(Known::Fraction(operator.apply(a.number(), b.number()))),
                (None, Known::Whole(_), Known::Whole(_)) if OF_TWO_FRACTION.iter().any(|row| row.0 == name) => None,
                (None, a, b) => {
                    let function = OF_TWO.iter().chain(OF_TWO_FRACTION).find(|row| row.0 == name)?.1;
                    Some(Known::Fraction(function(a.number(), b.number())))
                }
            },
            _ => None,
        }
    }
}

impl Known {
    fn number(self) -> f64 {
        match self {
            Self::Whole(value) => value as f64,
            Self::Fraction(value) => value,
        }
    }
}

/// Nothing where the interpreter would stop.
fn whole(operator: Arithmetic, a: i64, b: i64) -> Option<i64> {
    match operator {
        Arithmetic::Add => a.checked_add(b),
        Arithmetic::Subtract => a.checked_sub(b),
        Arithmetic::Multiply => a.checked_mul(b),
        Arithmetic::Divide => a.checked_div(b),
        Arithmetic::Remainder => a.checked_rem(b),
    }
}
