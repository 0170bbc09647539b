//! Facts of a script compiled to native trees: which one a chain of names reads.

use super::access::{Access, Link};
use super::compile::{Compiler, number, remembered};
use super::fact_names::cells_named;
use crate::judge::ViewFacts;
use crate::judge::expression::{BeamSpan, Flag, Number, Typed};
use crate::judge::fact_columns::Getter;
use crate::judge::fact_table::{FactId, value};
use crate::settings::UNNAMED_VIEW;
use rhai::{Expr, FnCallExpr};

impl Compiler<'_> {
    pub(super) fn of_group(&mut self, group: &str, links: &[Link<'_>]) -> Option<Typed> {
        match (group, links) {
            ("previous", [Link::Property(group, _), rest @ ..]) => match self.of_group(group, rest)? {
                Typed::Number(number) => Some(Typed::Number(Number::Before(Box::new(number)))),
                Typed::Whole(number) => Some(Typed::Whole(Number::Before(Box::new(number)))),
                Typed::Flag(flag) => Some(Typed::Flag(Flag::Before(Box::new(flag)))),
            },
            (name, []) if let Some((index, typed)) = self.script.measure(name) => Some(remembered(index, typed)),
            (view, links) if let Some(view) = self.script.views.iter().position(|name| name == view) => {
                self.of_view(view, links)
            }
            (_, [Link::Property(key, _)]) => Typed::of_fact(value(group, key)?, 0),
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
            ("laser", [Link::Call(call, _), rest]) => {
                let span = self.sector(call)?;
                self.sector_fact(span, *rest)
            }
            _ => None,
        }
    }

    /// A fact of a view.
    fn of_view(&mut self, view: usize, links: &[Link<'_>]) -> Option<Typed> {
        let call = match links {
            [Link::Property(key, _)] => return Typed::of_fact(value(UNNAMED_VIEW, key)?, view),
            [Link::Call(call, _)] if call.args.len() == 2 => call,
            _ => return None,
        };
        let (from, to) = (self.constant_whole(&call.args[0])?, self.constant_whole(&call.args[1])?);
        let named = [Some(from), Some(to)].into_iter();
        self.needs.cells.extend(cells_named(view, &call.name, named, call.args[0].start_position()));
        let (from, to) = (usize::try_from(from).ok()?, usize::try_from(to).ok()?);
        match call.name.as_str() {
            "cell" => Some(Typed::Number(Number::Cell(view, from, to))),
            "rows" if from <= to => Some(Typed::Number(Number::Band(view, ViewFacts::rows, (from, to)))),
            "columns" if from <= to => Some(Typed::Number(Number::Band(view, ViewFacts::columns, (from, to)))),
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

    /// A number; or the laser or a sector, which stand for their nearest range.
    pub(super) fn range(&mut self, expr: &Expr) -> Option<Number> {
        let access = Access::of(expr);
        match access.as_ref().and_then(Access::group) {
            Some(("laser", [])) => number(Typed::of_fact(FactId::LaserNearest.fact(), 0)?),
            Some(("laser", [Link::Call(call, _)])) if matches!(call.name.as_str(), "sector" | "between") => {
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
