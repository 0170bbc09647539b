//! From the script's tree to a native one; what is not understood stays with the interpreter.

use super::access::{Access, Link};
use crate::judge::expression::{Arithmetic, Comparison, Flag, Number, Typed};
use crate::judge::fact_columns::Getter;
use crate::judge::fact_table::{FactId, value};
use crate::judge::functions::{OF_ONE, OF_ONE_FRACTION, OF_TWO, OF_TWO_FRACTION, OneArgument, TwoArguments};
use crate::judge::needs::{Needs, SlotUse};
use rhai::{Expr, FnCallExpr, Position, Scope};

/// The way from one tree to the other.
pub(super) struct Compiler<'a> {
    /// The script's constants.
    pub constants: &'a Scope<'static>,
    pub needs: &'a mut Needs,
}

// Up to here whole numbers and their floating-point forms are equal, or not, alike.
const EXACT: i64 = 1 << 50;

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
            Expr::FnCall(call, _) if !call.is_qualified() => self.call(call)?,
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

    fn number(&mut self, expr: &Expr) -> Option<Number> {
        number(self.expression(expr)?)
    }

    fn variable(&mut self, expr: &Expr) -> Option<Typed> {
        let access = Access::of(expr)?;
        if access.root == "calibrated" {
            return Some(Typed::Number(self.calibrated(String::new(), None, access.position)));
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

    fn calibrated(&mut self, key: String, length: Option<usize>, position: Position) -> Number {
        let slots = &mut self.needs.slots;
        let slot = slots.iter().position(|known| *known == key).unwrap_or_else(|| {
            slots.push(key);
            slots.len() - 1
        });
        self.needs.slot_uses.push(SlotUse { slot, length, position });
        Number::Calibrated(slot)
    }

    /// `calibrated` or `calibrated.key`.
    fn calibrated_key(access: &Access<'_>) -> Option<String> {
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
        match (group, links) {
            (_, [Link::Property(key, _)]) => Typed::of_fact(value(group, key)?),
            ("laser", [Link::Index(beam)]) => Some(Typed::Number(Number::Beam(self.beam(beam)?))),
            ("camera", [Link::Call(call, _)]) if call.name == "cell" && call.args.len() == 2 => {
                let (row, column) = (self.constant_whole(&call.args[0])?, self.constant_whole(&call.args[1])?);
                self.needs.cells.push((row, column, call.args[0].start_position()));
                Some(Typed::Number(Number::Cell(usize::try_from(row).ok()?, usize::try_from(column).ok()?)))
            }
            ("laser", [Link::Call(call, _), rest]) => {
                let (from, to) = self.sector(call)?;
                self.sector_fact(from, to, *rest)
            }
            _ => None,
        }
    }

    pub(super) fn sector(&mut self, call: &FnCallExpr) -> Option<(usize, usize)> {
        if call.name != "sector" || call.args.len() != 2 {
            return None;
        }
        let (from, to) = (self.beam(&call.args[0])?, self.beam(&call.args[1])?);
        (from <= to).then_some((from, to))
    }

    fn sector_fact(&mut self, from: usize, to: usize, link: Link<'_>) -> Option<Typed> {
        match link {
            Link::Property(key, _) => match value("sector", key)?.get {
                Getter::Sector(get) => Some(Typed::Number(Number::Sector(from, to, get))),
                _ => None,
            },
            Link::Call(call, _) if call.args.len() == 1 => match call.name.as_str() {
                "count_below" => {
                    let limit = self.number(&call.args[0])?;
                    Some(Typed::Whole(Number::CountBelow(from, to, Box::new(limit))))
                }
                "excess" => {
                    let slot = self.expected(from, to, call)?;
                    Some(Typed::Number(Number::Excess(from, to, slot)))
                }
                _ => None,
            },
            _ => None,
        }
    }

    /// Where `excess(calibrated)` finds its expected ranges.
    pub(super) fn expected(&mut self, from: usize, to: usize, call: &FnCallExpr) -> Option<usize> {
        let access = Access::of(call.args.first()?)?;
        let key = Self::calibrated_key(&access)?;
        match self.calibrated(key, Some(to - from + 1), access.position) {
            Number::Calibrated(slot) => Some(slot),
            _ => None,
        }
    }

    fn constant_whole(&mut self, expr: &Expr) -> Option<i64> {
        match self.expression(expr)? {
            Typed::Whole(Number::Constant(value)) => Some(value as i64),
            _ => None,
        }
    }

    pub(super) fn beam(&mut self, expr: &Expr) -> Option<usize> {
        let beam = self.constant_whole(expr)?;
        self.needs.beams.push((beam, expr.start_position()));
        usize::try_from(beam).ok()
    }

    fn call(&mut self, call: &FnCallExpr) -> Option<Typed> {
        let name = call.name.as_str();
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
            _ => None,
        }
    }

    fn call_of_one(&mut self, name: &str, of: &Expr) -> Option<Typed> {
        let find = |list: &[(&str, OneArgument)]| list.iter().find(|row| row.0 == name).map(|row| row.1);
        match (name, self.expression(of)?) {
            ("!", Typed::Flag(flag)) => Some(Typed::Flag(Flag::Not(Box::new(flag)))),
            ("-", Typed::Number(number)) => Some(Typed::Number(Number::Negate(Box::new(number)))),
            ("-", Typed::Whole(Number::Constant(value))) => Some(Typed::Whole(Number::Constant(0.0 - value))),
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

    /// A number; or the laser or a sector, which stand for their nearest range.
    pub(super) fn range(&mut self, expr: &Expr) -> Option<Number> {
        let access = Access::of(expr);
        match access.as_ref().and_then(Access::group) {
            Some(("laser", [])) => number(Typed::of_fact(FactId::LaserNearest.fact())?),
            Some(("laser", [Link::Call(call, _)])) => {
                let (from, to) = self.sector(call)?;
                match FactId::SectorNearest.fact().get {
                    Getter::Sector(get) => Some(Number::Sector(from, to, get)),
                    _ => None,
                }
            }
            _ => self.number(expr),
        }
    }
}

fn number(typed: Typed) -> Option<Number> {
    match typed {
        Typed::Number(number) | Typed::Whole(number) => Some(number),
        Typed::Flag(_) => None,
    }
}

fn whole(value: i64) -> Option<Typed> {
    (-EXACT..=EXACT).contains(&value).then_some(Typed::Whole(Number::Constant(value as f64)))
}
