//! How a script sees the facts: `facts`, its groups and sectors, each a handle on the measurements of one step.

use super::budget;
use super::fact_columns::Getter;
use super::fact_table::FACTS;
use super::facts::{self, Facts};
use super::view_facts::ViewFacts;
use rhai::{Dynamic, Engine, EvalAltResult, Position, Variant};
use std::sync::Arc;

type Evaluated<T> = Result<T, Box<EvalAltResult>>;

/// A group of facts as a script's variable.
pub(crate) trait FactView: Variant + Clone {
    /// The group's name.
    const GROUP: &'static str;
    /// The handle on these measurements.
    fn new(facts: Arc<Facts>) -> Self;
    /// The measurements.
    fn facts(&self) -> &Facts;
}

macro_rules! views {
    ($($(#[$doc:meta])* $name:ident $group:literal,)*) => {
        $($(#[$doc])* #[derive(Clone)]
        pub(crate) struct $name(Arc<Facts>);

        impl FactView for $name {
            const GROUP: &'static str = $group;
            fn new(facts: Arc<Facts>) -> Self {
                Self(facts)
            }
            fn facts(&self) -> &Facts {
                &self.0
            }
        })*

        /// Makes every group known to an engine.
        fn register_groups(engine: &mut Engine) {
            engine.register_type_with_name::<AllFacts>("facts");
            engine.register_get("calibrated", |all: &mut AllFacts| -> Evaluated<Dynamic> {
                budget::spend_values(budget::size(&all.calibrated))?;
                Ok(Dynamic::clone(&all.calibrated))
            });
            engine.register_get("previous", |all: &mut AllFacts| PreviousView::new(Arc::clone(&all.previous)));
            $(register_group::<$name>(engine);)*
            $(engine.register_get($group, |before: &mut PreviousView| $name::new(Arc::clone(&before.0)));)*
            register_seen(engine);
        }

        /// The group of this name over these measurements, as a script's value; nothing for the name of a view.
        pub(crate) fn view(group: &str, facts: &Arc<Facts>) -> Dynamic {
            match group {
                $($group => Dynamic::from($name::new(Arc::clone(facts))),)*
                _ => Dynamic::UNIT,
            }
        }
    };
}

views! {
    /// `laser`
    LaserView "laser",
    /// `action`
    ActionView "action",
    /// `robot`
    RobotView "robot",
    /// `state`
    StateView "state",
    /// `time`
    TimeView "time",
    /// `odometry`
    OdometryView "odometry",
    /// `ground`
    GroundView "ground",
    /// `stage`
    StageView "stage",
    /// `previous`, whose groups are those of the step before
    PreviousView "previous",
}

/// `facts`: all groups, the step before, what `fn calibrate` returned, and the measures.
#[derive(Clone)]
pub(crate) struct AllFacts {
    pub facts: Arc<Facts>,
    pub previous: Arc<Facts>,
    pub calibrated: Arc<Dynamic>,
    /// In the order of the script.
    pub measures: Arc<Vec<Dynamic>>,
}

/// Makes the measures and the views of a script known to its functions, as `facts.NAME`, and the names of its stages to all of
/// it.
pub(crate) fn register_own(engine: &mut Engine, measures: &[&str], views: &[String], stages: &[String]) {
    for (view, name) in views.iter().enumerate() {
        engine.register_get(name, move |all: &mut AllFacts| SeenView { facts: Arc::clone(&all.facts), view });
        engine.register_get(name, move |before: &mut PreviousView| SeenView { facts: Arc::clone(&before.0), view });
    }
    for (index, name) in measures.iter().enumerate() {
        engine.register_get(*name, move |all: &mut AllFacts| all.measures.get(index).cloned().unwrap_or_default());
    }
    let stages = stages.to_vec();
    engine.register_fn("at", move |stage: &mut StageView, name: &str| -> Evaluated<bool> {
        let index = stages.iter().position(|stage| stage == name);
        let index = index.ok_or_else(|| fault(format!("there is no stage \"{name}\"")))?;
        Ok(stage.0.stage.index == index)
    });
}

/// What one view sees: `camera`, or a view's own name.
#[derive(Clone)]
pub(crate) struct SeenView {
    pub facts: Arc<Facts>,
    pub view: usize,
}

impl SeenView {
    fn seen(&self) -> &ViewFacts {
        self.facts.view(self.view)
    }
}

fn register_seen(engine: &mut Engine) {
    engine.register_type_with_name::<SeenView>("camera");
    for fact in FACTS {
        match fact.get {
            Getter::ViewNumber(get) => engine.register_get(fact.key, move |view: &mut SeenView| get(view.seen())),
            Getter::ViewWhole(get) => engine.register_get(fact.key, move |view: &mut SeenView| get(view.seen())),
            Getter::ViewFlag(get) => engine.register_get(fact.key, move |view: &mut SeenView| get(view.seen())),
            _ => continue,
        };
    }
    engine.register_fn("cell", |view: &mut SeenView, row: i64, column: i64| -> Evaluated<f64> {
        let (rows, columns) = view.seen().grid;
        let row = index(row, rows, "row numbers")?;
        Ok(view.seen().cell(row, index(column, columns, "column numbers")?))
    });
    engine.register_fn("rows", |view: &mut SeenView, from: i64, to: i64| -> Evaluated<f64> {
        let (from, to) = band(from, to, view.seen().grid.0, "row")?;
        Ok(view.seen().rows(from, to))
    });
    engine.register_fn("columns", |view: &mut SeenView, from: i64, to: i64| -> Evaluated<f64> {
        let (from, to) = band(from, to, view.seen().grid.1, "column")?;
        Ok(view.seen().columns(from, to))
    });
}

fn band(from: i64, to: i64, count: usize, what: &str) -> Evaluated<(usize, usize)> {
    let numbers = format!("{what} numbers");
    let (from, to) = (index(from, count, &numbers)?, index(to, count, &numbers)?);
    if from > to {
        return Err(fault(format!("the lower {what} comes first, found {from} to {to}")));
    }
    Ok((from, to))
}

/// `laser.sector(from, to)`.
#[derive(Clone)]
struct SectorView {
    facts: Arc<Facts>,
    from: usize,
    to: usize,
}

impl SectorView {
    /// Whoever asks reads them all.
    fn ranges(&self) -> &[f32] {
        budget::charge((self.to - self.from) as u64 / budget::VALUES_PER_OPERATION);
        self.facts.sector_m(self.from, self.to)
    }
    fn nearest(&self) -> f64 {
        facts::decimal(facts::least(self.ranges()))
    }
}

/// Makes every fact known to an engine.
pub(crate) fn register(engine: &mut Engine) {
    register_groups(engine);
    register_laser(engine);
    register_sector(engine);
}

fn register_group<T: FactView>(engine: &mut Engine) {
    engine.register_type_with_name::<T>(T::GROUP);
    if T::GROUP != PreviousView::GROUP {
        engine.register_get(T::GROUP, |all: &mut AllFacts| T::new(Arc::clone(&all.facts)));
    }
    for fact in FACTS.iter().filter(|fact| fact.group == T::GROUP) {
        match fact.get {
            Getter::Number(get) => engine.register_get(fact.key, move |view: &mut T| get(view.facts())),
            Getter::Whole(get) => engine.register_get(fact.key, move |view: &mut T| get(view.facts())),
            Getter::Flag(get) => engine.register_get(fact.key, move |view: &mut T| get(view.facts())),
            _ => continue,
        };
    }
}

fn register_laser(engine: &mut Engine) {
    engine.register_indexer_get(|laser: &mut LaserView, beam: i64| -> Evaluated<f64> {
        let beam = index(beam, laser.0.ranges_m.len(), "beam numbers")?;
        Ok(laser.0.beam_m(beam))
    });
    engine.register_fn("sector", |laser: &mut LaserView, from: i64, to: i64| -> Evaluated<SectorView> {
        let count = laser.0.ranges_m.len();
        let (from, to) = (index(from, count, "beam numbers")?, index(to, count, "beam numbers")?);
        if from > to {
            return Err(fault(format!("a sector runs from the lower beam to the higher one, found {from} to {to}")));
        }
        Ok(SectorView { facts: Arc::clone(&laser.0), from, to })
    });
    engine.register_fn("at", |laser: &mut LaserView, bearing_deg: f64| laser.0.beam_m(laser.0.beam_at(bearing_deg)));
    engine.register_fn("at", |laser: &mut LaserView, bearing_deg: i64| {
        laser.0.beam_m(laser.0.beam_at(bearing_deg as f64))
    });
    engine.register_fn("between", |laser: &mut LaserView, from: Dynamic, to: Dynamic| -> Evaluated<SectorView> {
        let (Some(from), Some(to)) = (number(&from), number(&to)) else {
            return Err(fault("'between' needs two bearings in degrees".to_owned()));
        };
        let (from, to) = laser.0.beams_between(from, to);
        Ok(SectorView { facts: Arc::clone(&laser.0), from, to })
    });
    engine.register_fn("hit", |laser: &mut LaserView, beam: i64| -> Evaluated<bool> {
        Ok(laser.0.hit(index(beam, laser.0.ranges_m.len(), "beam numbers")?))
    });
    engine.register_fn("hit_at", |laser: &mut LaserView, bearing_deg: f64| laser.0.hit(laser.0.beam_at(bearing_deg)));
    engine.register_fn("hit_at", |laser: &mut LaserView, bearing_deg: i64| {
        laser.0.hit(laser.0.beam_at(bearing_deg as f64))
    });
    compare(engine, |laser: &LaserView| facts::decimal(facts::least(&laser.0.ranges_m)));
}

fn register_sector(engine: &mut Engine) {
    engine.register_type_with_name::<SectorView>("sector");
    for fact in FACTS {
        if let Getter::Sector(get) = fact.get {
            engine.register_get(fact.key, move |sector: &mut SectorView| get(sector.ranges()));
        }
    }
    engine.register_get("hits", |sector: &mut SectorView| below(sector, sector.facts.laser_range_m.1));
    engine.register_fn("count_below", |sector: &mut SectorView, limit_m: f64| below(sector, limit_m));
    engine.register_fn("count_below", |sector: &mut SectorView, limit_m: i64| below(sector, limit_m as f64));
    engine.register_fn("excess", |sector: &mut SectorView, expected: rhai::Array| -> Evaluated<f64> {
        let ranges = sector.ranges();
        let expected: Option<Vec<f64>> = expected.iter().map(number).collect();
        match expected {
            Some(expected) if expected.len() == ranges.len() => Ok(facts::excess(ranges, &expected)),
            Some(expected) => Err(fault(wrong_length(ranges.len(), expected.len()))),
            None => Err(fault("'excess' needs an array of numbers".to_owned())),
        }
    });
    compare(engine, SectorView::nearest);
}

/// The message for an array of expected ranges that does not fit its sector.
pub(crate) fn wrong_length(beams: usize, found: usize) -> String {
    format!("'excess' needs one expected range for each of the {beams} beams of its sector, found {found}")
}

fn below(sector: &SectorView, limit_m: f64) -> i64 {
    facts::count_below(sector.ranges(), limit_m) as i64
}

/// A number of a script, whole or not.
pub(crate) fn number(value: &Dynamic) -> Option<f64> {
    value.as_float().ok().or_else(|| value.as_int().ok().map(|whole| whole as f64))
}

fn index(wanted: i64, count: usize, what: &str) -> Evaluated<usize> {
    usize::try_from(wanted)
        .ok()
        .filter(|&index| index < count)
        .ok_or_else(|| fault(format!("{what} run from 0 to {}, found {wanted}", count.saturating_sub(1))))
}

fn fault(message: String) -> Box<EvalAltResult> {
    Box::new(EvalAltResult::ErrorRuntime(message.into(), Position::NONE))
}

/// Comparison with a number, on either side, for something that stands for one range.
fn compare<T: Variant + Clone>(engine: &mut Engine, range_m: fn(&T) -> f64) {
    type Holds = fn(f64, f64) -> bool;
    let operators: [(&str, Holds); 4] =
        [("<", |a, b| a < b), ("<=", |a, b| a <= b), (">", |a, b| a > b), (">=", |a, b| a >= b)];
    for (operator, holds) in operators {
        engine.register_fn(operator, move |a: T, b: f64| holds(range_m(&a), b));
        engine.register_fn(operator, move |a: T, b: i64| holds(range_m(&a), b as f64));
        engine.register_fn(operator, move |a: f64, b: T| holds(a, range_m(&b)));
        engine.register_fn(operator, move |a: i64, b: T| holds(a as f64, range_m(&b)));
    }
}

#[cfg(test)]
mod tests {
    use super::super::fact_table::GROUPS;
    use super::*;

    #[test]
    fn every_group_of_facts_can_be_seen() {
        let groups = GROUPS.iter().filter(|(group, _)| *group != "camera");
        assert!(groups.into_iter().all(|(group, _)| !view(group, &Arc::default()).is_unit()));
    }
}
