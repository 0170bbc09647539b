//! From the script's tree to a native one; what is not understood stays with the interpreter.

use super::access::{Access, Link};
use crate::judge::expression::{Arithmetic, BeamSpan, Comparison, Flag, Number, Typed};
use crate::judge::fact_columns::Getter;
use crate::judge::fact_table::{FactId, value};
use crate::judge::functions::{OF_ONE, OF_ONE_FRACTION, OF_TWO, OF_TWO_FRACTION, OneArgument, TwoArguments, WINDOWS};
use crate::judge::memory::Remembered;
use crate::judge::needs::{Needs, SlotUse};
use crate::judge::rule::Persistence;
use rhai::{Expr, FnCallExpr, Position, Scope};

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
    pub stages: Vec<String>,
    /// Names of functions that the script defines itself.
    pub own: Vec<String>,
}

impl Vocabulary {
    fn measure(&self, name: &str) -> Option<(usize, &Typed)> {
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
        self.of_group(group, links)
    }

    fn of_group(&mut self, group: &str, links: &[Link<'_>]) -> Option<Typed> {
        match (group, links) {
            ("previous", [Link::Property(group, _), rest @ ..]) => match self.of_group(group, rest)? {
                Typed::Number(number) => Some(Typed::Number(Number::Before(Box::new(number)))),
                Typed::Whole(number) => Some(Typed::Whole(Number::Before(Box::new(number)))),
                Typed::Flag(flag) => Some(Typed::Flag(Flag::Before(Box::new(flag)))),
            },
            (name, []) if let Some((index, typed)) = self.script.measure(name) => Some(remembered(index, typed)),
            (_, [Link::Property(key, _)]) => Typed::of_fact(value(group, key)?),
            ("stage", [Link::Call(call, _)]) if call.name == "at" => {
                let [Expr::StringConstant(name, _)] = call.args.as_slice() else { return None };
                let stage = self.script.stages.iter().position(|stage| stage == name.as_str())?;
                Some(Typed::Flag(Flag::Stage(stage)))
            }
            ("laser", [Link::Call(call, _)]) if let [of] = call.args.as_slice() => match call.name.as_str() {
                "at" => Some(Typed::Number(Number::BeamAt(self.bearing(of)?))),
                "hit_at" => Some(Typed::Flag(Flag::HitAt(self.bearing(of)?))),
                "hit" => Some(Typed::Flag(Flag::Hit(self.beam(of)?))),
                _ => None,
            },
            ("laser", [Link::Index(beam)]) => Some(Typed::Number(Number::Beam(self.beam(beam)?))),
            ("camera", [Link::Call(call, _)]) if call.name == "cell" && call.args.len() == 2 => {
                let (row, column) = (self.constant_whole(&call.args[0])?, self.constant_whole(&call.args[1])?);
                self.needs.cells.push((row, column, call.args[0].start_position()));
                Some(Typed::Number(Number::Cell(usize::try_from(row).ok()?, usize::try_from(column).ok()?)))
            }
            ("laser", [Link::Call(call, _), rest]) => {
                let span = self.sector(call)?;
                self.sector_fact(span, *rest)
            }
            _ => None,
        }
    }

    pub(super) fn sector(&mut self, call: &FnCallExpr) -> Option<BeamSpan> {
        let [from, to] = call.args.as_slice() else { return None };
        match call.name.as_str() {
            "sector" => {
                let (from, to) = (self.beam(from)?, self.beam(to)?);
                (from <= to).then_some(BeamSpan::Numbers(from, to))
            }
            "between" => {
                let (from, to) = (self.bearing(from)?, self.bearing(to)?);
                (from < to).then_some(BeamSpan::Bearings(from, to))
            }
            _ => None,
        }
    }

    fn sector_fact(&mut self, span: BeamSpan, link: Link<'_>) -> Option<Typed> {
        match link {
            Link::Property(key, _) => match value("sector", key)?.get {
                Getter::Sector(get) => Some(Typed::Number(Number::Sector(span, get))),
                Getter::Hits => Some(Typed::Whole(Number::Hits(span))),
                _ => None,
            },
            Link::Call(call, _) if call.args.len() == 1 => match call.name.as_str() {
                "count_below" => {
                    let limit = self.number(&call.args[0])?;
                    Some(Typed::Whole(Number::CountBelow(span, Box::new(limit))))
                }
                "excess" => {
                    let BeamSpan::Numbers(from, to) = span else { return None };
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

    /// A constant number.
    pub(super) fn constant(&mut self, expr: &Expr) -> Option<f64> {
        match self.expression(expr)? {
            Typed::Number(Number::Constant(value)) | Typed::Whole(Number::Constant(value)) => Some(value),
            Typed::Number(Number::Negate(of)) => match *of {
                Number::Constant(value) => Some(-value),
                _ => None,
            },
            _ => None,
        }
    }

    fn constant_whole(&mut self, expr: &Expr) -> Option<i64> {
        match self.expression(expr)? {
            Typed::Whole(Number::Constant(value)) => Some(value as i64),
            _ => None,
        }
    }

    /// A constant bearing, degrees.
    pub(super) fn bearing(&mut self, expr: &Expr) -> Option<f64> {
        let bearing_deg = self.constant(expr)?;
        self.needs.bearings.push((bearing_deg, expr.start_position()));
        Some(bearing_deg)
    }

    pub(super) fn beam(&mut self, expr: &Expr) -> Option<usize> {
        let beam = self.constant_whole(expr)?;
        self.needs.beams.push((beam, expr.start_position()));
        usize::try_from(beam).ok()
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
                let span = self.sector(call)?;
                match FactId::SectorNearest.fact().get {
                    Getter::Sector(get) => Some(Number::Sector(span, get)),
                    _ => None,
                }
            }
            _ => self.number(expr),
        }
    }
}

/// What was worked out for a measure.
fn remembered(index: usize, typed: &Typed) -> Typed {
    match typed {
        Typed::Flag(_) => Typed::Flag(Flag::Remembered(index)),
        Typed::Number(_) | Typed::Whole(_) => Typed::Number(Number::Remembered(index)),
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
