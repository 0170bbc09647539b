//! What a script calls success, checked and compiled: conditions over the figures of the test.

use super::access::{Access, Link};
use super::own_doing::OwnDoing;
use super::positions::{first, span};
use super::source::Code;
use super::spoilt::Spoilt;
use super::syntax::{WrittenSuccess, written_successes};
use crate::diagnostic::{Diagnostic, Mistakes, nearest_name, printable};
use crate::judge::explain::mistake;
use crate::judge::expression::{Arithmetic, Comparison};
use crate::judge::fact_table::is_group;
use crate::judge::functions::{OF_ONE, OF_ONE_FRACTION, OF_TWO, OF_TWO_FRACTION};
use crate::verdict::{
    FIGURES, FigureOf, FigureUse, OwnWord, Request, Subject, SuccessCondition, Takes, Term, TestFigure, exclude,
    why_never,
};
use rhai::{AST, Expr, FnCallExpr, Position, Scope};
use std::ops::Range;

const CODE: &str = "E-SCRIPT-SUCCESS";

/// Most conditions of success of one script.
const MOST_CONDITIONS: usize = 16;

/// What figures can be of, by name.
#[derive(Debug)]
pub(super) struct FigureNames<'a> {
    pub rules: Vec<&'a str>,
    pub stages: Vec<&'a str>,
    pub measures: Vec<&'a str>,
    /// Of rules and measures those that tell only what the robot itself does.
    pub own_doing: OwnDoing<'a>,
    /// What such rules alone bring about.
    pub own_word: OwnWord,
}

impl FigureNames<'_> {
    /// Whether a figure is the script's own word: the reward, or what reads nothing but what the robot itself does.
    fn is_of_reward(&self, figure: &TestFigure, of: &FigureOf) -> bool {
        let own = |names: &[&str], index: usize, own: &[&str]| names.get(index).is_some_and(|name| own.contains(name));
        match of {
            FigureOf::Rule(index) => own(&self.rules, *index, &self.own_doing.rules),
            FigureOf::Measure(index) => own(&self.measures, *index, &self.own_doing.measures),
            _ => self.own_word.has(figure),
        }
    }
}

/// Every condition of success without a mistake in it.
pub(super) fn conditions(
    code: &Code,
    ast: &AST,
    constants: &Scope<'static>,
    names: &FigureNames<'_>,
    spoilt: &Spoilt<'_>,
    mistakes: &mut Mistakes,
) -> Vec<SuccessCondition> {
    let compiler = SuccessCompiler { code, constants, names };
    let mut conditions: Vec<SuccessCondition> = Vec::new();
    let written = written_successes(ast.statements());
    if let Some(one_too_many) = written.get(MOST_CONDITIONS) {
        let message = format!("a script may have {MOST_CONDITIONS} conditions of success, found {}", written.len());
        let at = one_too_many.name_position;
        let wrong = mistake(&code.source, "E-SCRIPT-LIMIT", at, message, "one too many");
        mistakes.add(wrong.help("join some by &&"));
    }
    for written in &written {
        let bytes = span(code, written.condition);
        if spoilt.touches(&bytes, mistakes) {
            continue;
        }
        let named = |message: String, label| mistake(&code.source, CODE, written.name_position, message, label);
        let (name, count) = (written.name, mistakes.count());
        if name.trim().is_empty() {
            mistakes.add(named("a condition of success needs a name".to_owned(), "no name"));
        } else if conditions.iter().any(|before| before.name == name) {
            let message = format!("there are two conditions of success called \"{}\"", printable(name));
            mistakes.add(named(message, "the second one").help("choose another name"));
        }
        match compiler.condition(written) {
            Ok(term) if mistakes.count() == count => {
                if let Some(never) = never(code, name, (&term, bytes.clone()), &conditions) {
                    mistakes.add(never);
                    continue;
                }
                let text = code.source.text[bytes.clone()].split_whitespace().collect::<Vec<_>>().join(" ");
                conditions.push(SuccessCondition { name: name.to_owned(), text, span: Some(bytes), term });
            }
            Ok(_) => {}
            Err(wrong) => {
                let parts = compiler.mistakes_in(written.condition);
                (if parts.is_empty() { vec![*wrong] } else { parts }).into_iter().for_each(|wrong| mistakes.add(wrong));
            }
        }
    }
    conditions
}

/// Why no test meets a condition, by itself or beside those before it; nothing if one may.
fn never(
    code: &Code,
    name: &str,
    (term, bytes): (&Term, Range<usize>),
    before: &[SuccessCondition],
) -> Option<Diagnostic> {
    let wrong = |message: String, label: String| Diagnostic::new(CODE, message).at(&code.source, bytes.clone(), label);
    let shown = printable(name);
    if let Some(why) = why_never(term) {
        let help = "every condition must hold at once; write || where either will do, or turn the comparison";
        return Some(wrong(format!("success \"{shown}\" can never hold"), why).help(help));
    }
    let other = printable(&before.iter().find(|other| exclude(&other.term, term))?.name);
    let message = format!("success \"{shown}\" and success \"{other}\" can never hold together");
    let label = format!("this excludes \"{other}\"");
    Some(wrong(message, label).help("every condition must hold at once: join the two by || if either will do"))
}

/// A term with its kind.
enum Kinded {
    Number(Term),
    Flag(Term),
}

type Compiled<T> = Result<T, Box<Diagnostic>>;

struct SuccessCompiler<'a> {
    code: &'a Code,
    constants: &'a Scope<'static>,
    names: &'a FigureNames<'a>,
}

impl SuccessCompiler<'_> {
    fn wrong<T>(
        &self,
        position: Position,
        message: impl Into<String>,
        label: &str,
        help: impl Into<String>,
    ) -> Compiled<T> {
        mistake(&self.code.source, CODE, position, message.into(), label).help(help).fail()
    }

    fn condition(&self, written: &WrittenSuccess<'_>) -> Compiled<Term> {
        match self.term(written.condition)? {
            Kinded::Flag(term) if term.figures().is_empty() => {
                let help = "write a figure of the test: test.failures_per_1000 <= 2";
                self.wrong(first(written.condition), "this is the same for every test", "no figure is read here", help)
            }
            Kinded::Flag(term) => Ok(term),
            Kinded::Number(_) => {
                let message = "a condition of success must be true or false";
                self.wrong(first(written.condition), message, "this is a number", "compare it: test.laps >= 5")
            }
        }
    }

    /// What is wrong in an expression, each part told by itself; nothing if only the whole is.
    fn mistakes_in(&self, expr: &Expr) -> Vec<Diagnostic> {
        let parts: &[Expr] = match expr {
            Expr::And(parts, _) | Expr::Or(parts, _) => parts,
            Expr::FnCall(call, _) => &call.args,
            _ => &[],
        };
        let wrong = |part: &Expr| match self.term(part) {
            Ok(_) => Vec::new(),
            Err(whole) => {
                let inner = self.mistakes_in(part);
                if inner.is_empty() { vec![*whole] } else { inner }
            }
        };
        parts.iter().flat_map(wrong).collect()
    }

    fn term(&self, expr: &Expr) -> Compiled<Kinded> {
        let flags = |parts: &[Expr]| parts.iter().map(|part| self.flag(part)).collect::<Compiled<Vec<_>>>();
        match expr {
            Expr::FloatConstant(value, _) => Ok(Kinded::Number(Term::Constant(**value))),
            Expr::IntegerConstant(value, _) => Ok(Kinded::Number(Term::Constant(*value as f64))),
            Expr::BoolConstant(value, _) => Ok(Kinded::Flag(Term::Flag(*value))),
            Expr::And(parts, _) => Ok(Kinded::Flag(Term::And(flags(parts)?))),
            Expr::Or(parts, _) => Ok(Kinded::Flag(Term::Or(flags(parts)?))),
            Expr::FnCall(call, position) => self.call(call, *position),
            other => self.read(other),
        }
    }

    fn number(&self, expr: &Expr) -> Compiled<Term> {
        match self.term(expr)? {
            Kinded::Number(term) => Ok(term),
            Kinded::Flag(_) => {
                let help = "compare numbers with numbers, and join comparisons with && or ||";
                self.wrong(first(expr), "a number is needed here", "this is true or false", help)
            }
        }
    }

    fn flag(&self, expr: &Expr) -> Compiled<Term> {
        match self.term(expr)? {
            Kinded::Flag(term) => Ok(term),
            Kinded::Number(_) => {
                let message = "something true or false is needed here";
                self.wrong(first(expr), message, "this is a number", "compare it: test.laps >= 5")
            }
        }
    }

    fn call(&self, call: &FnCallExpr, position: Position) -> Compiled<Kinded> {
        let name = call.name.as_str();
        match call.args.as_slice() {
            [of] if name == "!" => Ok(Kinded::Flag(Term::Not(Box::new(self.flag(of)?)))),
            [of] if name == "-" => Ok(Kinded::Number(Term::Negate(Box::new(self.number(of)?)))),
            [of] if let Some(row) = OF_ONE.iter().chain(OF_ONE_FRACTION).find(|row| row.0 == name) => {
                Ok(Kinded::Number(Term::OfOne(row.1, Box::new(self.number(of)?))))
            }
            [a, b] if let Some(comparison) = Comparison::of(name) => {
                let sides = [self.number(a)?, self.number(b)?];
                self.check_share(&sides, [first(a), first(b)])?;
                Ok(Kinded::Flag(Term::Compare(comparison, Box::new(sides))))
            }
            [a, b] if let Some(operator) = Arithmetic::of(name) => {
                Ok(Kinded::Number(Term::Binary(operator, Box::new([self.number(a)?, self.number(b)?]))))
            }
            [a, b] if let Some(row) = OF_TWO.iter().chain(OF_TWO_FRACTION).find(|row| row.0 == name) => {
                Ok(Kinded::Number(Term::OfTwo(row.1, Box::new([self.number(a)?, self.number(b)?]))))
            }
            _ => {
                let message = format!("'{}' cannot be used in a condition of success", printable(name));
                let help = "there are: && || ! + - * / % < <= > >= == != abs min max and the other functions of one or two numbers";
                self.wrong(position, message, "not here", help)
            }
        }
    }

    /// A share is never beyond 0 to 1, so whoever compares it with 90 means 0.9.
    fn check_share(&self, sides: &[Term; 2], at: [Position; 2]) -> Compiled<()> {
        let (figure, value, at) = match sides {
            [Term::TestFigure(asked), Term::Constant(value)] => (asked.figure, *value, at[1]),
            [Term::Constant(value), Term::TestFigure(asked)] => (asked.figure, *value, at[0]),
            _ => return Ok(()),
        };
        if figure.unit != "share" || (0.0..=1.0).contains(&value) {
            return Ok(());
        }
        let message = format!("'{}' is a share, from 0 to 1: it never comes to {value}", figure.name);
        let help = match (1.0..=100.0).contains(&value) {
            true => format!("{value} % is written {}", value / 100.0),
            false => "write a number from 0 to 1".to_owned(),
        };
        self.wrong(at, message, "beyond it", help)
    }

    /// A constant of the script, or a figure.
    fn read(&self, expr: &Expr) -> Compiled<Kinded> {
        let Some(access) = Access::of(expr) else {
            return self.wrong(first(expr), "this is no figure and no number", "not known", "write test.laps >= 5");
        };
        let subject = match access.root {
            "test" => Subject::Test,
            "untrained" => Subject::Untrained,
            root => return self.constant(root, &access),
        };
        match access.links.as_slice() {
            [Link::Property(name, position)] => match TestFigure::of(name) {
                Some(figure) => self.figure(subject, figure, None, *position),
                None => self.unknown(name, *position),
            },
            [Link::Call(call, position)] => match TestFigure::of(call.name.as_str()) {
                Some(figure) => self.figure(subject, figure, Some(&call.args), *position),
                None => self.unknown(call.name.as_str(), *position),
            },
            _ => {
                let help = format!("write {}.NAME, such as {}.failures_per_1000", subject.word(), subject.word());
                self.wrong(access.position, "a figure has a name", "of what?", help)
            }
        }
    }

    /// A figure with what stands in its parentheses, if it has any.
    fn figure(
        &self,
        subject: Subject,
        figure: &'static TestFigure,
        arguments: Option<&[Expr]>,
        position: Position,
    ) -> Compiled<Kinded> {
        let name = figure.name;
        let form = format!("write {}.{}", subject.word(), figure.takes().form(name));
        let (message, of) = match (figure.takes(), arguments) {
            (Takes::Nothing, None) => {
                let request = figure.probe().map(|probe| Request { figure: name, probe, of: None, metres: 0.0 });
                (
                    String::new(),
                    request.map_or(Some(FigureOf::Whole), |request| Some(FigureOf::Request(request.into()))),
                )
            }
            (Takes::Nothing, Some(_)) => (format!("'{name}' is a figure, not a function"), None),
            (Takes::Rule, Some([Expr::StringConstant(rule, at)])) => {
                (String::new(), Some(FigureOf::Rule(self.named("rule", &self.names.rules, rule, *at)?)))
            }
            (Takes::Rule, _) => (format!("'{name}' needs the name of a rule"), None),
            (Takes::Stage, Some([Expr::StringConstant(stage, at)])) => {
                (String::new(), Some(FigureOf::Stage(self.named("stage", &self.names.stages, stage, *at)?)))
            }
            (Takes::Stage, _) => (format!("'{name}' needs the name of a stage"), None),
            (Takes::Measure, Some([Expr::StringConstant(measure, at)])) => {
                let of = self.named("measure", &self.names.measures, measure, *at)?;
                (String::new(), Some(FigureOf::Measure(of)))
            }
            (Takes::Measure, _) => (format!("'{name}' needs the name of a measure"), None),
            (Takes::Mover | Takes::Place, Some([Expr::StringConstant(of, _)])) => {
                (String::new(), Self::of_named(figure, of.as_str(), 0.0))
            }
            (Takes::Place, _) => (format!("'{name}' needs the name of a place of the world"), None),
            (Takes::Mover, _) => (format!("'{name}' needs the name of a mover of the world"), None),
            (Takes::MoverAndMetres, Some([Expr::StringConstant(mover, _), metres])) => match self.number(metres)? {
                Term::Constant(metres) => (String::new(), Self::of_named(figure, mover.as_str(), metres)),
                _ => (format!("the distance that '{name}' is measured from must be a plain number"), None),
            },
            (Takes::MoverAndMetres, _) => {
                (format!("'{name}' needs the name of a mover of the world, and a distance"), None)
            }
        };
        match of {
            Some(of) => {
                let of_reward = self.names.is_of_reward(figure, &of);
                Ok(Kinded::Number(Term::TestFigure(FigureUse { subject, figure, of, of_reward })))
            }
            None => self.wrong(position, message, "here", form),
        }
    }

    fn of_named(figure: &TestFigure, of: &str, metres: f64) -> Option<FigureOf> {
        let request = Request { figure: figure.name, probe: figure.probe()?, of: Some(of.to_owned()), metres };
        Some(FigureOf::Request(request.into()))
    }

    /// The number of a name among others of its kind.
    fn named(&self, kind: &str, names: &[&str], name: &str, at: Position) -> Compiled<usize> {
        if let Some(index) = names.iter().position(|own| *own == name) {
            return Ok(index);
        }
        let help = match nearest_name(name, names.iter().copied()) {
            Some(near) => format!("did you mean \"{}\"?", printable(near)),
            None if names.is_empty() => format!("the script has no {kind}"),
            None => format!("there are: {}", printable(&names.join(", "))),
        };
        self.wrong(at, format!("there is no {kind} \"{}\"", printable(name)), "not known", help)
    }

    fn unknown<T>(&self, name: &str, position: Position) -> Compiled<T> {
        let help = match nearest_name(name, FIGURES.iter().map(|figure| figure.name)) {
            Some(near) => format!("did you mean '{near}'?"),
            None => {
                let names: Vec<_> = FIGURES.iter().map(|figure| figure.name).collect();
                format!("there are: {}", names.join(", "))
            }
        };
        self.wrong(position, format!("there is no figure '{}' of a test", printable(name)), "not known", help)
    }

    fn constant(&self, root: &str, access: &Access<'_>) -> Compiled<Kinded> {
        let value = self.constants.get(root).filter(|_| access.links.is_empty());
        let number =
            value.and_then(|value| value.as_float().ok().or_else(|| value.as_int().ok().map(|whole| whole as f64)));
        let flag = value.and_then(|value| value.as_bool().ok());
        match (number, flag) {
            (Some(number), _) => Ok(Kinded::Number(Term::Constant(number))),
            (_, Some(flag)) => Ok(Kinded::Flag(Term::Flag(flag))),
            _ if is_group(root) || self.code.views.group_of(root).is_some() || root == "facts" => {
                let message = format!("'{root}' is measured in every step: success is told by the test as a whole");
                let help = "write a figure of the test, such as test.failures_per_1000 <= 2";
                self.wrong(access.position, message, "a fact of a step", help)
            }
            _ => {
                let message = format!("'{}' is no figure and no constant number", printable(root));
                self.wrong(access.position, message, "not known", "write a figure of the test, such as test.laps >= 5")
            }
        }
    }
}
