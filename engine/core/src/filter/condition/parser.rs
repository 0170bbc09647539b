//! From the text of a condition to what it computes, with the first mistake at its place.
//!
//! ```text
//! any   = all { "||" all }          all  = one { "&&" one }        one = sum [ COMPARISON sum ]
//! sum   = product { + - product }   product = factor { * / factor }
//! factor = - factor | ! factor | NUMBER | NAME | ( any ) | abs(sum) | min(sum, sum) | max(sum, sum)
//! ```

use std::ops::Range;

use super::ConditionError;
use super::program::{ASKED, Comparison, Number, Program, Sum, Truth};
use super::words::{Word, words};
use crate::diagnostic::{nearest_name, printable};

/// Longest text, in bytes.
const LONGEST: usize = 1_000;
/// Most numbers and truth values that are computed for a pixel.
const MOST: usize = 64;
/// Deepest nesting.
const DEEPEST: usize = 24;
const FUNCTIONS: [(&str, usize); 3] = [("abs", 1), ("min", 2), ("max", 2)];

/// A part of a condition: what it is, where it is computed and where it stands.
#[derive(Debug, Clone)]
struct Part {
    kind: Kind,
    place: usize,
    span: Range<usize>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Number,
    Truth,
}

struct Parser<'a> {
    text: &'a str,
    words: Vec<(Word<'a>, Range<usize>)>,
    next: usize,
    depth: usize,
    program: Program,
}

type Parsed<T> = Result<T, ConditionError>;

/// The program of a condition.
///
/// # Errors
/// The first mistake.
pub(super) fn parse(text: &str) -> Parsed<Program> {
    if text.len() > LONGEST {
        let message = format!("the condition is longer than {LONGEST} bytes");
        return Err(ConditionError::new(message, "too long", "write a shorter one", 0..text.len()));
    }
    let mut parser = Parser { text, words: words(text)?, next: 0, depth: 0, program: Program::default() };
    if parser.word() == Word::End {
        let message = "the condition is empty".to_owned();
        return Err(ConditionError::new(message, "nothing here", "write which pixels are marked: r > 1.5 * g", 0..0));
    }
    let whole = parser.any()?;
    if parser.word() != Word::End {
        return Err(parser.unexpected("the condition ends before this"));
    }
    parser.truth(&whole)?;
    let mut program = parser.program;
    if program.looks_at_depth() && program.looks_at_colour() {
        let message = "the condition looks at colour and at nearness: those are two images".to_owned();
        let help = "make two views, one that looks at colour and one at nearness";
        return Err(ConditionError::new(message, "both in one", help, 0..text.len()));
    }
    program.result = whole.place;
    if program.size() > MOST {
        let message = format!("the condition computes more than {MOST} numbers and truth values for each pixel");
        return Err(ConditionError::new(message, "too much", "write a shorter one", 0..text.len()));
    }
    Ok(program)
}

impl Parser<'_> {
    fn word(&self) -> Word<'_> {
        self.words.get(self.next).map_or(Word::End, |(word, _)| *word)
    }

    fn span(&self) -> Range<usize> {
        self.words.get(self.next).map_or(self.text.len()..self.text.len(), |(_, span)| span.clone())
    }

    /// Takes one of some signs.
    fn sign(&mut self, signs: &[&'static str]) -> Option<&'static str> {
        let found = signs.iter().find(|sign| self.word() == Word::Sign(sign))?;
        self.next += 1;
        Some(found)
    }

    fn any(&mut self) -> Parsed<Part> {
        let mut left = self.all()?;
        while self.sign(&["||"]).is_some() {
            let right = self.all()?;
            left = self.joined(&left, &right, Truth::Or)?;
        }
        Ok(left)
    }

    fn all(&mut self) -> Parsed<Part> {
        let mut left = self.one()?;
        while self.sign(&["&&"]).is_some() {
            let right = self.one()?;
            left = self.joined(&left, &right, Truth::And)?;
        }
        Ok(left)
    }

    fn joined(&mut self, left: &Part, right: &Part, join: fn(usize, usize) -> Truth) -> Parsed<Part> {
        self.truth(left)?;
        self.truth(right)?;
        let place = self.program.truth(join(left.place, right.place));
        Ok(Part { kind: Kind::Truth, place, span: left.span.start..right.span.end })
    }

    fn one(&mut self) -> Parsed<Part> {
        const COMPARISONS: [&str; 6] = ["<", "<=", ">", ">=", "==", "!="];
        let left = self.sum()?;
        let Some(sign) = self.sign(&COMPARISONS) else { return Ok(left) };
        let right = self.sum()?;
        self.number(&left, "a truth value cannot be compared with a number")?;
        self.number(&right, "a number cannot be compared with a truth value")?;
        let (a, b) = (left.place, right.place);
        let span = left.span.start..right.span.end;
        let again = self.span();
        if self.sign(&COMPARISONS).is_some() {
            let (left, middle) = (&self.text[span.clone()], &self.text[right.span]);
            let message = format!("this compares the truth value of '{left}' with a number");
            let sign = &self.text[again.clone()];
            let rest = self.sum().map_or("...", |part| &self.text[part.span]);
            let help = format!("write {left} && {middle} {sign} {rest}");
            return Err(ConditionError::new(message, "the second comparison", &help, again));
        }
        let truth = match sign {
            "<" => Truth::Compare(Comparison::Less, a, b),
            ">" => Truth::Compare(Comparison::Less, b, a),
            "<=" => Truth::Compare(Comparison::AtMost, a, b),
            ">=" => Truth::Compare(Comparison::AtMost, b, a),
            "==" => Truth::Compare(Comparison::Equal, a, b),
            _ => Truth::Compare(Comparison::Different, a, b),
        };
        Ok(Part { kind: Kind::Truth, place: self.program.truth(truth), span })
    }

    fn sum(&mut self) -> Parsed<Part> {
        let mut left = self.product()?;
        while let Some(sign) = self.sign(&["+", "-"]) {
            let right = self.product()?;
            left = self.two(&left, &right, if sign == "+" { Sum::Add } else { Sum::Subtract })?;
        }
        Ok(left)
    }

    fn product(&mut self) -> Parsed<Part> {
        let mut left = self.factor()?;
        while let Some(sign) = self.sign(&["*", "/"]) {
            let right = self.factor()?;
            left = self.two(&left, &right, if sign == "*" { Sum::Multiply } else { Sum::Divide })?;
        }
        Ok(left)
    }

    fn two(&mut self, left: &Part, right: &Part, sum: Sum) -> Parsed<Part> {
        self.number(left, "a truth value is no number")?;
        self.number(right, "a truth value is no number")?;
        let place = self.program.number(Number::Two(sum, left.place, right.place));
        Ok(Part { kind: Kind::Number, place, span: left.span.start..right.span.end })
    }

    fn factor(&mut self) -> Parsed<Part> {
        self.depth += 1;
        if self.depth > DEEPEST {
            let message = format!("the condition is nested deeper than {DEEPEST} levels");
            return Err(ConditionError::new(message, "too deep", "leave out parentheses", self.span()));
        }
        let part = self.nested();
        self.depth -= 1;
        part
    }

    fn nested(&mut self) -> Parsed<Part> {
        let start = self.span().start;
        if self.sign(&["-"]).is_some() {
            let part = self.factor()?;
            self.number(&part, "a truth value is no number")?;
            let place = self.program.number(Number::Negative(part.place));
            return Ok(Part { kind: Kind::Number, place, span: start..part.span.end });
        }
        if self.sign(&["!"]).is_some() {
            let part = self.factor()?;
            if part.kind == Kind::Number {
                let message = "'!' turns a truth value round, and this is a number".to_owned();
                let help = "put the comparison into parentheses: !(r > 60)";
                return Err(ConditionError::new(message, "a number", help, part.span));
            }
            let place = self.program.truth(Truth::Not(part.place));
            return Ok(Part { kind: Kind::Truth, place, span: start..part.span.end });
        }
        if self.sign(&["("]).is_some() {
            let part = self.any()?;
            let end = self.expect(")", "a parenthesis is not closed")?;
            return Ok(Part { span: start..end, ..part });
        }
        let span = self.span();
        match self.words.get(self.next).map_or(Word::End, |(word, _)| *word) {
            Word::Number(number) => {
                self.next += 1;
                Ok(Part { kind: Kind::Number, place: self.program.number(Number::Constant(number)), span })
            }
            Word::Name(name) => self.named(name, span),
            _ => Err(self.unexpected("a number or a name is missing here")),
        }
    }

    fn named(&mut self, name: &str, span: Range<usize>) -> Parsed<Part> {
        self.next += 1;
        let is_call = self.word() == Word::Sign("(");
        if let Some((_, arguments)) = FUNCTIONS.iter().find(|(function, _)| is_call && *function == name) {
            return self.call(name, *arguments, span.start);
        }
        if let Some((_, asked, _)) = ASKED.iter().find(|(known, ..)| !is_call && *known == name) {
            return Ok(Part { kind: Kind::Number, place: self.program.number(Number::Pixel(*asked)), span });
        }
        self.next -= 1;
        Err(unknown(name, span, is_call))
    }

    fn call(&mut self, name: &str, arguments: usize, start: usize) -> Parsed<Part> {
        let usage = if arguments == 1 { "abs takes one number: abs(r - g)" } else { "it takes two: min(r, g)" };
        self.expect("(", usage)?;
        let first = self.sum()?;
        self.number(&first, usage)?;
        let number = if arguments == 1 {
            Number::Absolute(first.place)
        } else {
            self.expect(",", usage)?;
            let second = self.sum()?;
            self.number(&second, usage)?;
            Number::Two(if name == "min" { Sum::Least } else { Sum::Greatest }, first.place, second.place)
        };
        let end = self.expect(")", usage)?;
        Ok(Part { kind: Kind::Number, place: self.program.number(number), span: start..end })
    }

    /// Takes a sign that must come; gives where it ends.
    fn expect(&mut self, sign: &'static str, message: &str) -> Parsed<usize> {
        let end = self.span().end;
        match self.sign(&[sign]) {
            Some(_) => Ok(end),
            None => Err(self.unexpected(message)),
        }
    }

    fn number(&self, part: &Part, message: &str) -> Parsed<()> {
        if part.kind == Kind::Number {
            return Ok(());
        }
        let help = "compare numbers, and join comparisons by && and ||: r > 60 && g < 90";
        Err(ConditionError::new(message.to_owned(), "a truth value", help, part.span.clone()))
    }

    fn truth(&self, part: &Part) -> Parsed<()> {
        if part.kind == Kind::Truth {
            return Ok(());
        }
        let text = &self.text[part.span.clone()];
        let message = "this is a number: it does not say which pixels are marked".to_owned();
        Err(ConditionError::new(message, "a number", &format!("compare it: {text} > 60"), part.span.clone()))
    }

    /// The mistake that the next word is, answered by what it means elsewhere.
    fn unexpected(&self, message: &str) -> ConditionError {
        let help = match self.word() {
            Word::Sign("=") => "two numbers are compared by ==, or better by < and >",
            Word::Sign("**") => "write a power as a product: r * r",
            Word::Name("and") => "'and' is written &&",
            Word::Name("or") => "'or' is written ||",
            Word::Name("not") => "'not' is written !",
            Word::Number(_) | Word::Name(_) | Word::Sign("(") => "put a sign before it: * + - / < > && ||",
            Word::Sign(")") => "leave the parenthesis out, or write what belongs before it",
            _ => "write it as here: r > 1.5 * g && r > 60",
        };
        let label = if self.word() == Word::End { "the end" } else { "found this" };
        ConditionError::new(message.to_owned(), label, help, self.span())
    }
}

fn unknown(name: &str, span: Range<usize>, is_call: bool) -> ConditionError {
    let names = ASKED.iter().map(|(name, ..)| *name).chain(FUNCTIONS.iter().map(|(name, _)| *name));
    let of_others = |other: &str| ASKED.iter().find(|(_, _, others)| others.contains(&other)).map(|(name, ..)| *name);
    let others = ASKED.iter().flat_map(|(_, _, others)| others.iter().copied());
    let meant = nearest_name(name, others).and_then(of_others);
    let help = match (name, of_others(name).or_else(|| nearest_name(name, names.clone())).or(meant)) {
        ("and", _) => "'and' is written &&".to_owned(),
        ("or", _) => "'or' is written ||".to_owned(),
        ("not", _) => "'not' is written !".to_owned(),
        (_, Some(near)) => format!("did you mean {near}?"),
        _ => format!("there are: {}", names.collect::<Vec<_>>().join(", ")),
    };
    let what = if is_call { "function" } else { "number" };
    let message = format!("a pixel has no {what} '{}'", printable(name));
    ConditionError::new(message, "unknown", &help, span)
}
