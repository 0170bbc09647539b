//! Truth values and numbers told apart at load: the interpreter compares the two without a word, and the answer is always the
//! same. What has no type that can be read from the text is let through.

use super::access::{Access, Link, fact_of};
use super::positions::{first, operand_end};
use super::source::Code;
use super::syntax::{is_success_expr, written_measures};
use crate::diagnostic::{Diagnostic, Mistakes};
use crate::judge::explain::offset;
use crate::judge::expression::{Arithmetic, Comparison};
use crate::judge::fact_table::{Fact, names_in};
use crate::judge::functions::{FUNCTIONS, OF_ONE, OF_ONE_FRACTION};
use rhai::{AST, ASTFlags, ASTNode, Expr, FnCallExpr, Position, Stmt};

/// What a value is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Flag,
    Number,
}

/// Adds every operator between a truth value and a number, outermost first: what a mistake has in it is not told again.
pub(super) fn check_types(code: &Code, ast: &AST, mistakes: &mut Mistakes) {
    let mut facts = vec!["facts"];
    let functions = ast.iter_functions().filter(|function| matches!(function.name, "reward" | "calibrate"));
    facts.extend(functions.filter_map(|function| function.params.first().copied()));
    let mut checker = TypeChecker { code, facts: &facts, named: Vec::new(), in_function: false };
    checker.named = named(ast, &checker);
    for (part, in_function) in [(ast.clone_statements_only(), false), (ast.clone_functions_only(), true)] {
        checker.in_function = in_function;
        part.walk(&mut |path: &[ASTNode<'_>]| {
            let Some((ASTNode::Expr(expr), above)) = path.split_last() else { return true };
            let is =
                |node: &ASTNode<'_>, test: &dyn Fn(&Expr) -> bool| matches!(node, ASTNode::Expr(expr) if test(expr));
            let told =
                above.iter().any(|node| is(node, &|expr| is_success_expr(expr) || checker.wrong(expr).is_some()));
            if !told && let Some(wrong) = checker.wrong(expr) {
                mistakes.add(wrong);
            }
            true
        });
    }
}

struct TypeChecker<'a> {
    code: &'a Code,
    /// The names by which all facts are known.
    facts: &'a [&'a str],
    /// Measures and constants, each with what it is.
    named: Vec<(String, Kind)>,
    /// Whether it is a function's own variable that the parser found where it says so, not the top level's.
    in_function: bool,
}

/// What measures and constants are, as far as each can be told without those that it reads.
fn named(ast: &AST, checker: &TypeChecker<'_>) -> Vec<(String, Kind)> {
    let constant = |statement: &Stmt| match statement {
        Stmt::Var(variable, flags, _) if flags.contains(ASTFlags::CONSTANT) => {
            Some((variable.0.name.to_string(), checker.kind(&variable.1)?))
        }
        _ => None,
    };
    let constants = ast.statements().iter().filter_map(constant);
    let measures = written_measures(ast.statements());
    let measures = measures.iter().filter_map(|one| Some((one.name.to_owned(), checker.kind(one.expression)?)));
    constants.chain(measures).collect()
}

/// What an operator is applied to.
fn operands(expr: &Expr) -> &[Expr] {
    match expr {
        Expr::And(parts, _) | Expr::Or(parts, _) => parts,
        Expr::FnCall(call, _) if call.is_operator_call() => &call.args,
        _ => &[],
    }
}

impl TypeChecker<'_> {
    /// What is wrong with an expression itself, whatever is in it.
    fn wrong(&self, expr: &Expr) -> Option<Diagnostic> {
        if let Some(wrong) = operands(expr).iter().find_map(|operand| self.bare_group(operand)) {
            return Some(wrong);
        }
        match expr {
            Expr::And(parts, _) | Expr::Or(parts, _) => {
                let number = parts.iter().find(|part| self.kind(part) == Some(Kind::Number))?;
                Some(self.no_flag(number))
            }
            // `robot.contact in "search"`: Rhai's own word for a part of a text.
            Expr::FnCall(call, position)
                if call.name == "contains"
                    && matches!(call.args.as_slice(), [Expr::StringConstant(..), _])
                    && self.code.source.text[offset(&self.code.source, *position)..].starts_with("in ") =>
            {
                let at = offset(&self.code.source, *position);
                let message = "the order of a rule is: in, when, for, once, =>, per second, then";
                let wrong = Diagnostic::new("E-SCRIPT-RULE", message).at(&self.code.source, at..at + 2, "not here");
                Some(wrong.help("write the stages before 'when': rule \"found\" in \"search\" when ..."))
            }
            Expr::FnCall(call, position) => match call.args.as_slice() {
                [of] if call.name == "!" && self.kind(of) == Some(Kind::Number) => Some(self.no_flag(of)),
                [of] if self.kind(of) == Some(Kind::Flag) && (call.name == "-" || self.is_of_numbers(call)) => {
                    Some(self.no_number(of))
                }
                [a, b] if let Some(comparison) = Comparison::of(&call.name) => {
                    self.compared(comparison, call, *position, [a, b])
                }
                [a, b] if Arithmetic::of(&call.name).is_some() => {
                    let flag = [a, b].into_iter().find(|side| self.kind(side) == Some(Kind::Flag));
                    flag.map(|flag| self.no_number(flag)).or_else(|| self.drops_fraction(call, *position))
                }
                _ => None,
            },
            _ => None,
        }
    }

    /// A group of facts in the place of a value; the laser alone is its nearest range.
    fn bare_group(&self, operand: &Expr) -> Option<Diagnostic> {
        let access = Access::of(operand)?;
        let by_argument = self.facts.contains(&access.root);
        let (group, links) = if by_argument { access.group_of_facts()? } else { access.group()? };
        let own = !by_argument && (access.is_local || self.code.defines(group));
        let known = self.code.views.group_of(group).filter(|_| links.is_empty() && !own)?;
        if fact_of(known, links).is_some() {
            return None;
        }
        let (start, end) = (self.start(operand), self.end(operand));
        let help = match known {
            "stage" => "ask for a stage by its name: stage.at(\"search\")".to_owned(),
            "previous" => "write previous.laser.front".to_owned(),
            _ => {
                let facts: Vec<String> = names_in(known).iter().take(3).map(|fact| format!("{group}.{fact}")).collect();
                format!("name one of its facts, such as {}", facts.join(", "))
            }
        };
        Some(self.mistake(format!("'{group}' is a group of facts, and no value"), start..end, "no value", help))
    }

    fn compared(
        &self,
        comparison: Comparison,
        call: &FnCallExpr,
        position: Position,
        [a, b]: [&Expr; 2],
    ) -> Option<Diagnostic> {
        let (flag, flag_first) = match (self.kind(a), self.kind(b)) {
            (Some(Kind::Flag), Some(Kind::Number)) => (a, true),
            (Some(Kind::Number), Some(Kind::Flag)) => (b, false),
            (Some(Kind::Flag), Some(Kind::Flag)) if comparison.orders() => (a, true),
            _ => return None,
        };
        let operator = offset(&self.code.source, position);
        let (start, end) = (self.start(a), self.end(b));
        let text = |from: usize, to: usize| self.code.source.text[from..to].trim().trim_end_matches(')').to_owned();
        let (left, right) = (text(start, operator), text(self.start(b), end));
        // `0.3 < laser.front < 0.6` compares what the first comparison says.
        if let (true, Expr::FnCall(inner, _)) = (flag_first && comparison.orders(), a)
            && let [_, middle] = inner.args.as_slice()
            && Comparison::of(&inner.name).is_some()
        {
            let message = format!("this compares the truth value of `{left}` with {right}");
            let help = format!("write {left} && {} {} {right}", text(self.start(middle), operator), call.name);
            return Some(self.mistake(message, operator..end, "true or false is no number", help));
        }
        let name = text(self.start(flag), if flag_first { operator } else { end });
        let (never, help) = match (comparison, self.is_zero(if flag_first { b } else { a })) {
            (Comparison::Unequal, _) => ("always true", format!("write {name}, or !{name}")),
            (Comparison::Equal, true) => ("never true", format!("write !{name}")),
            _ => ("never true", format!("write {name}")),
        };
        let message = "a truth value cannot be compared with a number";
        let marked = if flag_first { operator..end } else { start..end };
        Some(self.mistake(message, marked, &format!("{never}: {name} is true or false"), help))
    }

    /// A fact that is a whole number, divided by a whole number.
    fn drops_fraction(&self, call: &FnCallExpr, position: Position) -> Option<Diagnostic> {
        let ("/", [a, b]) = (call.name.as_str(), call.args.as_slice()) else { return None };
        let literal = |expr: &Expr| matches!(expr, Expr::IntegerConstant(..));
        if !self.is_whole(a) || !self.is_whole(b) || literal(a) && literal(b) {
            return None;
        }
        let text = |expr: &Expr| &self.code.source.text[self.start(expr)..self.end(expr)];
        let help = match literal(b) {
            true => format!("write {} / {}.0", text(a), text(b)),
            false => format!("write 1.0 * {} / {}", text(a), text(b)),
        };
        let at = offset(&self.code.source, position);
        Some(self.mistake("a division of whole numbers drops the fraction", at..at + 1, "both are whole", help))
    }

    /// Whether it is one of the engine's functions of one number.
    fn is_of_numbers(&self, call: &FnCallExpr) -> bool {
        OF_ONE.iter().chain(OF_ONE_FRACTION).any(|row| row.0 == call.name)
    }

    fn is_whole(&self, expr: &Expr) -> bool {
        match expr {
            Expr::IntegerConstant(..) => true,
            Expr::FnCall(call, _) => {
                Arithmetic::of(&call.name).is_some() && call.args.iter().all(|of| self.is_whole(of))
            }
            _ => self.fact_of(expr).is_some_and(|fact| fact.kind() == "whole number"),
        }
    }

    fn no_flag(&self, number: &Expr) -> Diagnostic {
        let (start, end) = (self.start(number), self.end(number));
        let help = format!("compare it: {} < 0.5", &self.code.source.text[start..end]);
        self.mistake("a number is no truth value", start..end, "this is a number", help)
    }

    fn no_number(&self, flag: &Expr) -> Diagnostic {
        let (start, end) = (self.start(flag), self.end(flag));
        let help = format!("write if {} {{ 1.0 }} else {{ 0.0 }} in a function", &self.code.source.text[start..end]);
        self.mistake("a truth value is no number", start..end, "this is true or false", help)
    }

    fn mistake(&self, message: impl Into<String>, at: std::ops::Range<usize>, label: &str, help: String) -> Diagnostic {
        Diagnostic::new("E-SCRIPT-TYPE", message).at(&self.code.source, at, label).help(help)
    }

    fn is_zero(&self, expr: &Expr) -> bool {
        matches!(expr, Expr::IntegerConstant(0, _)) || matches!(expr, Expr::FloatConstant(value, _) if **value == 0.0)
    }

    fn start(&self, expr: &Expr) -> usize {
        offset(&self.code.source, first(expr))
    }

    fn end(&self, expr: &Expr) -> usize {
        operand_end(self.code, expr)
    }

    /// What an expression is, if its text says so.
    fn kind(&self, expr: &Expr) -> Option<Kind> {
        match expr {
            Expr::BoolConstant(..) | Expr::And(..) | Expr::Or(..) => Some(Kind::Flag),
            Expr::FloatConstant(..) | Expr::IntegerConstant(..) => Some(Kind::Number),
            Expr::FnCall(call, _) if call.name == "!" || Comparison::of(&call.name).is_some() => Some(Kind::Flag),
            Expr::FnCall(call, _) => {
                let known =
                    Arithmetic::of(&call.name).is_some() && call.args.iter().all(|side| self.kind(side).is_some());
                let function = FUNCTIONS.iter().any(|row| row.name == call.name && !row.form.starts_with("array."));
                (known || function).then_some(Kind::Number)
            }
            _ => self.fact(expr),
        }
    }

    fn fact(&self, expr: &Expr) -> Option<Kind> {
        let own = Access::of(expr).filter(|access| access.links.is_empty() && !(self.in_function && access.is_local));
        if let Some(own) = own
            && let Some((_, kind)) = self.named.iter().find(|(name, _)| name == own.root)
        {
            return Some(*kind);
        }
        Some(if self.fact_of(expr)?.kind() == "true or false" { Kind::Flag } else { Kind::Number })
    }

    fn fact_of(&self, expr: &Expr) -> Option<&'static Fact> {
        let access = Access::of(expr)?;
        let by_argument = self.facts.contains(&access.root);
        let (group, links) = if by_argument { access.group_of_facts()? } else { access.group()? };
        // A fact of the step before is what it is now.
        let (group, links) = match (group, links) {
            ("previous", [Link::Property(group, _), rest @ ..]) => (*group, rest),
            other => other,
        };
        let group = self.code.views.group_of(group).filter(|_| by_argument || !access.is_local)?;
        fact_of(group, links)
    }
}
