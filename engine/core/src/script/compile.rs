//! From the script's tree to a native one; what is not understood stays with the interpreter.

use super::access::{Access, Link};
use crate::judge::expression::{Arithmetic, Comparison, Flag, Number, Typed};
use crate::judge::functions::{
    OF_ONE, OF_ONE_FRACTION, OF_TWO, OF_TWO_FRACTION, OneArgument, TwoArguments, WINDOWS, sign,
};
use crate::judge::memory::Remembered;
use crate::judge::needs::{Needs, SlotUse};
use crate::judge::rule::Persistence;
use rhai::{Expr, FnCallExpr, Position, Scope, Stmt, StmtBlock};

/// The way from one tree to the other.
pub(super) struct Compiler<'a> {
    /// The script's constants.
    pub constants: &'a Scope<'static>,
    pub needs: &'a mut Needs,
    /// What else the script names, and what is remembered for it.
    pub script: &'a mut Vocabulary,
}

/// What a script names besides facts and constants, and what is remembered of it, in the order in which it is worked out.
#[derive(Debug, Default)]
pub(super) struct Vocabulary {
    pub remembered: Vec<Remembered>,
    /// Which of these a window is, by the place of its call.
    pub windows: Vec<(Position, usize)>,
    /// The rules' names in their order, and last `reward` if there is `fn reward`.
    pub rules: Vec<String>,
    /// The names of the views, the first one first.
    pub views: Vec<String>,
    pub stages: Vec<String>,
    /// Names of functions that the script defines itself.
    pub own: Vec<String>,
}

impl Vocabulary {
    pub(super) fn measure(&self, name: &str) -> Option<(usize, &Typed)> {
        self.remembered.iter().enumerate().find_map(|(index, remembered)| match remembered {
            Remembered::Measure(measure) if measure.name == name => Some((index, &measure.typed)),
            _ => None,
        })
    }
}

// Up to here whole numbers and their floating-point forms are equal, or not, alike.
const EXACT: i64 = 1 << 50;
/// The longest window, seconds.
pub(super) const LONGEST_WINDOW_S: f64 = 600.0;

impl Compiler<'_> {
    /// The native form of a whole condition or value, if all of it is understood.
    pub(super) fn clause(&mut self, expr: &Expr) -> Option<Typed> {
        let uses = self.needs.slot_uses.len();
        // What `calibrated` alone is, only a run can tell.
        let typed = self.expression(expr).filter(|typed| !matches!(typed, Typed::Number(Number::Calibrated(_))));
        if typed.is_none() {
            self.needs.slot_uses.truncate(uses);
        }
        typed
    }

    /// The native form of an expression, if all of it is understood.
    pub(super) fn expression(&mut self, expr: &Expr) -> Option<Typed> {
        Some(match expr {
            Expr::BoolConstant(value, _) => Typed::Flag(Flag::Constant(*value)),
            Expr::FloatConstant(value, _) => Typed::Number(Number::Constant(**value)),
            Expr::IntegerConstant(value, _) => whole(*value)?,
            Expr::And(parts, _) => Typed::Flag(Flag::And(self.flags(parts)?)),
            Expr::Or(parts, _) => Typed::Flag(Flag::Or(self.flags(parts)?)),
            Expr::Variable(..) => self.variable(expr)?,
            Expr::Dot(..) | Expr::Index(..) => self.fact(expr)?,
            Expr::FnCall(call, position) if !call.is_qualified() => self.call(call, *position)?,
            Expr::Stmt(block) => self.choice(block)?,
            _ => return None,
        })
    }

    /// `if a { b } else { c }` with two of a kind.
    fn choice(&mut self, block: &StmtBlock) -> Option<Typed> {
        let only = |block: &StmtBlock| match block.statements() {
            [Stmt::Expr(expr)] => Some(Expr::clone(expr)),
            [choice @ Stmt::If(..)] => {
                Some(Expr::Stmt(Box::new(StmtBlock::new([choice.clone()], Position::NONE, Position::NONE))))
            }
            _ => None,
        };
        let [Stmt::If(flow, _)] = block.statements() else { return None };
        let flag = self.flag(&flow.expr)?;
        let (a, b) = (only(&flow.body)?, only(&flow.branch)?);
        Some(match (self.expression(&a)?, self.expression(&b)?) {
            (Typed::Number(a), Typed::Number(b)) => Typed::Number(Number::Choose(Box::new(flag), Box::new([a, b]))),
            (Typed::Whole(a), Typed::Whole(b)) => Typed::Whole(Number::Choose(Box::new(flag), Box::new([a, b]))),
            (Typed::Flag(a), Typed::Flag(b)) => {
                let not = Flag::Not(Box::new(flag.clone()));
                Typed::Flag(Flag::Or(vec![Flag::And(vec![flag, a]), Flag::And(vec![not, b])]))
            }
            _ => return None,
        })
    }

    fn flags(&mut self, parts: &[Expr]) -> Option<Vec<Flag>> {
        parts.iter().map(|part| self.flag(part)).collect()
    }

    fn flag(&mut self, expr: &Expr) -> Option<Flag> {
        match self.expression(expr)? {
            Typed::Flag(flag) => Some(flag),
            _ => None,
        }
    }

    pub(super) fn number(&mut self, expr: &Expr) -> Option<Number> {
        number(self.expression(expr)?)
    }

    fn variable(&mut self, expr: &Expr) -> Option<Typed> {
        let access = Access::of(expr)?;
        if access.root == "calibrated" {
            return Some(Typed::Number(self.calibrated(String::new(), None, access.position)));
        }
        if let Some((index, typed)) = self.script.measure(access.root) {
            return Some(remembered(index, typed));
        }
        let value = self.constants.get(access.root)?;
        if let Ok(value) = value.as_float() {
            return Some(Typed::Number(Number::Constant(value)));
        }
        match (value.as_int(), value.as_bool()) {
            (Ok(value), _) => whole(value),
            (_, Ok(value)) => Some(Typed::Flag(Flag::Constant(value))),
            _ => None,
        }
    }

    pub(super) fn calibrated(&mut self, key: String, length: Option<usize>, position: Position) -> Number {
        let slots = &mut self.needs.slots;
        let slot = slots.iter().position(|known| *known == key).unwrap_or_else(|| {
            slots.push(key);
            slots.len() - 1
        });
        self.needs.slot_uses.push(SlotUse { slot, length, position });
        Number::Calibrated(slot)
    }

    /// `calibrated` or `calibrated.key`.
    pub(super) fn calibrated_key(access: &Access<'_>) -> Option<String> {
        match access.group()? {
            ("calibrated", []) => Some(String::new()),
            ("calibrated", [Link::Property(key, _)]) => Some((*key).to_owned()),
            _ => None,
        }
    }

    fn fact(&mut self, expr: &Expr) -> Option<Typed> {
        let access = Access::of(expr)?;
        if let Some(key) = Self::calibrated_key(&access) {
            return Some(Typed::Number(self.calibrated(key, None, access.position)));
        }
        let (group, links) = access.group()?;
        self.of_group(group, links)
    }

    fn call(&mut self, call: &FnCallExpr, position: Position) -> Option<Typed> {
        let name = call.name.as_str();
        if WINDOWS.iter().any(|row| row.name == name) && !self.script.own.iter().any(|own| own == name) {
            return self.window(call, position);
        }
        match call.args.as_slice() {
            [of] => self.call_of_one(name, of),
            [a, b] => match (Comparison::of(name), Arithmetic::of(name)) {
                (Some(comparison), _) => self.comparison(comparison, a, b),
                (_, Some(operator)) => {
                    let pair = self.pair(a, b)?;
                    Some(Typed::Number(Number::Binary(operator, pair)))
                }
                _ => self.call_of_two(name, a, b),
            },
            [of, low, high] if name == "clamp" => self.clamp(of, low, high),
            _ => None,
        }
    }

    /// `change(x)`, `change(x, seconds)`, `average(x, seconds)`, `fired("rule")`, `since("rule")`.
    fn window(&mut self, call: &FnCallExpr, position: Position) -> Option<Typed> {
        let rule = |script: &Vocabulary, name: &Expr| match name {
            Expr::StringConstant(name, _) => script.rules.iter().position(|rule| rule == name.as_str()),
            _ => None,
        };
        // A condition is looked at more than once.
        if let Some((_, index)) = self.script.windows.iter().find(|(known, _)| *known == position) {
            return Some(Typed::Number(Number::Remembered(*index)));
        }
        let window = match (call.name.as_str(), call.args.as_slice()) {
            ("fired", [name]) => return Some(Typed::Number(Number::Fired(rule(self.script, name)?))),
            ("since", [name]) => return Some(Typed::Number(Number::Since(rule(self.script, name)?))),
            ("change", [of]) => Remembered::Change(self.sampled(of)?, Persistence::Steps(1)),
            ("change", [of, time]) => Remembered::Change(self.sampled(of)?, self.span(time)?),
            ("average", [of, time]) => Remembered::Average(self.sampled(of)?, self.span(time)?),
            _ => return None,
        };
        self.script.remembered.push(window);
        let index = self.script.remembered.len() - 1;
        self.script.windows.push((position, index));
        Some(Typed::Number(Number::Remembered(index)))
    }

    /// A number, or something true (1) or false (0).
    fn sampled(&mut self, of: &Expr) -> Option<Number> {
        match self.expression(of)? {
            Typed::Number(number) | Typed::Whole(number) => Some(number),
            Typed::Flag(flag) => Some(Number::Truth(Box::new(flag))),
        }
    }

    /// A constant time in seconds, above 0 and at most that of the longest window.
    fn span(&mut self, time: &Expr) -> Option<Persistence> {
        self.constant(time).filter(|time| *time > 0.0 && *time <= LONGEST_WINDOW_S).map(Persistence::Seconds)
    }

    fn call_of_one(&mut self, name: &str, of: &Expr) -> Option<Typed> {
        let find = |list: &[(&str, OneArgument)]| list.iter().find(|row| row.0 == name).map(|row| row.1);
        match (name, self.expression(of)?) {
            ("!", Typed::Flag(flag)) => Some(Typed::Flag(Flag::Not(Box::new(flag)))),
            ("-", Typed::Number(number)) => Some(Typed::Number(Number::Negate(Box::new(number)))),
            ("-", Typed::Whole(Number::Constant(value))) => Some(Typed::Whole(Number::Constant(0.0 - value))),
            ("sign", Typed::Number(of) | Typed::Whole(of)) => Some(Typed::Whole(Number::OfOne(sign, Box::new(of)))),
            (_, Typed::Number(number)) => {
                let function = find(OF_ONE).or_else(|| find(OF_ONE_FRACTION))?;
                Some(Typed::Number(Number::OfOne(function, Box::new(number))))
            }
            (_, Typed::Whole(number)) => Some(Typed::Number(Number::OfOne(find(OF_ONE)?, Box::new(number)))),
            _ => None,
        }
    }

    fn call_of_two(&mut self, name: &str, a: &Expr, b: &Expr) -> Option<Typed> {
        let find = |list: &[(&str, TwoArguments)]| list.iter().find(|row| row.0 == name).map(|row| row.1);
        if let Some(function) = find(OF_TWO) {
            let pair = Box::new([self.number(a)?, self.number(b)?]);
            return Some(Typed::Number(Number::OfTwo(function, pair)));
        }
        let function = find(OF_TWO_FRACTION)?;
        Some(Typed::Number(Number::OfTwo(function, self.pair(a, b)?)))
    }

    /// A number with a fraction between any two, or a whole one between whole ones.
    fn clamp(&mut self, of: &Expr, low: &Expr, high: &Expr) -> Option<Typed> {
        let find = |name: &str| OF_TWO_FRACTION.iter().find(|row| row.0 == name).map(|row| row.1);
        let (larger, smaller) = (find("max")?, find("min")?);
        let within = |of: Number, low: Number, high: Number| {
            let least = Number::OfTwo(larger, Box::new([of, low]));
            Number::OfTwo(smaller, Box::new([least, high]))
        };
        match (self.expression(of)?, self.expression(low)?, self.expression(high)?) {
            (Typed::Whole(of), Typed::Whole(low), Typed::Whole(high)) => Some(Typed::Whole(within(of, low, high))),
            (Typed::Number(of), Typed::Number(low) | Typed::Whole(low), Typed::Number(high) | Typed::Whole(high)) => {
                Some(Typed::Number(within(of, low, high)))
            }
            _ => None,
        }
    }

    /// Two numbers of which at least one has a fraction.
    fn pair(&mut self, a: &Expr, b: &Expr) -> Option<Box<[Number; 2]>> {
        match (self.expression(a)?, self.expression(b)?) {
            (Typed::Number(a), Typed::Number(b) | Typed::Whole(b)) | (Typed::Whole(a), Typed::Number(b)) => {
                Some(Box::new([a, b]))
            }
            _ => None,
        }
    }

    fn comparison(&mut self, comparison: Comparison, a: &Expr, b: &Expr) -> Option<Typed> {
        if comparison.orders() {
            let (a, b) = (self.range(a)?, self.range(b)?);
            return Some(Typed::Flag(Flag::Compare(comparison, Box::new([a, b]))));
        }
        match (self.expression(a)?, self.expression(b)?) {
            (Typed::Flag(a), Typed::Flag(b)) => {
                let same = Flag::Same(Box::new([a, b]));
                let equal = comparison == Comparison::Equal;
                Some(Typed::Flag(if equal { same } else { Flag::Not(Box::new(same)) }))
            }
            (Typed::Number(a) | Typed::Whole(a), Typed::Number(b) | Typed::Whole(b)) => {
                Some(Typed::Flag(Flag::Compare(comparison, Box::new([a, b]))))
            }
            _ => None,
        }
    }
}

/// What was worked out for a measure.
pub(super) fn remembered(index: usize, typed: &Typed) -> Typed {
    match typed {
        Typed::Flag(_) => Typed::Flag(Flag::Remembered(index)),
        Typed::Number(_) | Typed::Whole(_) => Typed::Number(Number::Remembered(index)),
    }
}

pub(super) fn number(typed: Typed) -> Option<Number> {
    match typed {
        Typed::Number(number) | Typed::Whole(number) => Some(number),
        Typed::Flag(_) => None,
    }
}

fn whole(value: i64) -> Option<Typed> {
    (-EXACT..=EXACT).contains(&value).then_some(Typed::Whole(Number::Constant(value as f64)))
}
