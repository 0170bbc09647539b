//! Parameters: constants of a script that may be set from outside, within a range.
//!
//! ```text
//! const near = param(0.25, #{ low: 0.15, high: 0.5, unit: "m" });
//! ```

use super::setup_table::SETUP;
use super::source::Code;
use super::tree::Tree;
use crate::diagnostic::{Diagnostic, Mistakes, Result, nearest_name, printable};
use crate::judge::functions::{FUNCTIONS, WINDOWS};
use crate::judge::{explain, fact_table};
use crate::settings::SETTINGS;
use rhai::{ASTFlags, Dynamic, Engine, Expr, Map, NativeCallContext, Position, Stmt};
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

/// Most parameters of one script.
const MOST_PARAMS: usize = 32;
/// How a parameter is written.
const FORM: &str = "const near = param(0.25, #{ low: 0.15, high: 0.5, unit: \"m\" });";

/// Values of parameters by name, as somebody sets them.
pub type ParamValues = BTreeMap<String, f64>;

/// A number that a script names and that may be changed without changing the script.
#[derive(Debug, Clone, PartialEq)]
pub struct Param {
    /// The constant's name.
    pub name: String,
    /// What it is now.
    pub value: f64,
    /// What the script says.
    pub default: f64,
    /// The least value, included.
    pub low: f64,
    /// The greatest value, included.
    pub high: f64,
    /// Whether only whole numbers will do: all three numbers of the script are whole.
    pub whole: bool,
    /// The unit in words, or nothing.
    pub unit: String,
    /// The bytes of its name where it is defined.
    pub span: Range<usize>,
}

impl Param {
    /// Checks a value that somebody sets.
    ///
    /// # Errors
    /// `E-SET` if it is out of range, or not whole where it must be.
    pub fn check(&self, value: f64) -> Result<()> {
        if (self.low..=self.high).contains(&value) && (!self.whole || value.fract() == 0.0) {
            return Ok(());
        }
        let Self { name, low, high, default, .. } = self;
        let (whole, unit) = (if self.whole { "a whole number from " } else { "" }, self.unit_words());
        let message = format!("'{}' must be {whole}{low} to {high}{unit}, not {value}", printable(name));
        Diagnostic::new("E-SET", message).help(format!("the script says {default}{unit}")).fail()
    }

    /// The unit behind a number, with the blank between them.
    fn unit_words(&self) -> String {
        if self.unit.is_empty() { String::new() } else { format!(" {}", printable(&self.unit)) }
    }

    /// The value with its unit, and what else it may be: `0.3 m (0.15 to 0.5; the script says 0.25)`.
    #[must_use]
    pub fn shown(&self) -> String {
        let Self { value, default, low, high, .. } = self;
        let said = if value == default { String::new() } else { format!("; the script says {default}") };
        format!("{value}{} ({low} to {high}{said})", self.unit_words())
    }
}

/// Checks values by name.
///
/// # Errors
/// `E-SET` if a script has no such parameter, or a value is out of its range.
pub(super) fn check_values(params: &[Param], values: &ParamValues) -> Result<()> {
    values.iter().try_for_each(|(name, value)| match params.iter().find(|param| param.name == *name) {
        Some(param) => param.check(*value),
        None => no_param(params, name).fail(),
    })
}

/// There is no such parameter.
pub(crate) fn no_param(params: &[Param], name: &str) -> Diagnostic {
    let names = params.iter().map(|param| param.name.as_str());
    let help = match nearest_name(name, names.clone()) {
        Some(near) => format!("did you mean '{}'?", printable(near)),
        None if params.is_empty() => format!("the script has no parameters; one is written {FORM}"),
        None => format!("there are: {}", printable(&names.collect::<Vec<_>>().join(", "))),
    };
    Diagnostic::new("E-SET", format!("there is no parameter '{}'", printable(name))).help(help)
}

/// What a call of `param` was given.
type Given = Vec<(Position, Vec<Dynamic>)>;

/// The parameters that a script declares, while its top level runs.
pub(super) struct Declared {
    /// Constants by the place of their call.
    names: Vec<(Position, String, Position)>,
    given: Arc<Mutex<Given>>,
}

impl Declared {
    /// Finds the declarations, and teaches the call to an engine: a constant becomes its value of `values`, or the script's own.
    pub(super) fn register(engine: &mut Engine, tree: &Tree, values: &ParamValues) -> Self {
        let names: Vec<_> = tree.ast.statements().iter().filter_map(declaration).collect();
        let given: Arc<Mutex<Given>> = Arc::default();
        let set: BTreeMap<(usize, usize), f64> =
            names.iter().filter_map(|(at, name, _)| values.get(name).map(|value| (place(*at), *value))).collect();
        let (log, set) = (Arc::clone(&given), Arc::new(set));
        let called = move |at: Position, arguments: Vec<Dynamic>| {
            let value = match (set.get(&place(at)), read(&arguments)) {
                (Some(value), Ok(read)) if read.takes(*value) => of_kind(*value, read.whole),
                _ => arguments.first().cloned().unwrap_or_default(),
            };
            let mut log = log.lock().unwrap_or_else(PoisonError::into_inner);
            // The top level may run again.
            log.retain(|(before, _)| *before != at);
            log.push((at, arguments));
            value
        };
        let (one, two, three) = (called.clone(), called.clone(), called);
        engine.register_fn("param", move |c: NativeCallContext, a: Dynamic| one(c.call_position(), vec![a]));
        engine.register_fn("param", move |c: NativeCallContext, a: Dynamic, b: Dynamic| {
            two(c.call_position(), vec![a, b])
        });
        engine.register_fn("param", move |c: NativeCallContext, a: Dynamic, b: Dynamic, d: Dynamic| {
            three(c.call_position(), vec![a, b, d])
        });
        Self { names, given }
    }

    /// The parameters in their order; what is wrong in them is added to `mistakes`.
    pub(super) fn finish(&self, code: &Code, values: &ParamValues, mistakes: &mut Mistakes) -> Vec<Param> {
        let mut params: Vec<Param> = Vec::new();
        let source = &code.source;
        let mut given = self.given.lock().unwrap_or_else(PoisonError::into_inner);
        given.sort_by_key(|(at, _)| place(*at));
        for (position, arguments) in given.iter().map(|(at, arguments)| (*at, arguments)) {
            let named = self.names.iter().find(|(call, ..)| *call == position);
            let wrong = |position, code, message: String, help: &str| {
                explain::mistake(source, code, position, message, "here").help(help)
            };
            let Some((_, name, name_at)) = named else {
                let message = "a parameter is a constant of the script's top level".to_owned();
                mistakes.add(wrong(position, "E-SCRIPT-SETTING", message, &format!("write {FORM}")));
                continue;
            };
            if let Some(message) = collides(name) {
                mistakes.add(wrong(*name_at, "E-SCRIPT-NAME", message, "choose another name"));
                continue;
            }
            match read(arguments) {
                Ok(Read { default, low, high, whole, unit }) => {
                    let span = source.word_at(explain::offset(source, *name_at));
                    let mut param = Param { name: name.clone(), value: default, default, low, high, whole, unit, span };
                    let set = values.get(name).filter(|value| param.check(**value).is_ok());
                    param.value = set.copied().unwrap_or(default);
                    params.push(param);
                }
                Err(message) => mistakes.add(wrong(position, "E-SCRIPT-SETTING", message, &format!("write {FORM}"))),
            }
        }
        if let Some(one_too_many) = params.get(MOST_PARAMS) {
            let message = format!("a script may have {MOST_PARAMS} parameters");
            let wrong = Diagnostic::new("E-SCRIPT-LIMIT", message);
            mistakes.add(wrong.at(source, one_too_many.span.clone(), "one too many").help("make it a plain constant"));
        }
        params
    }
}

/// `const NAME = param(...)`: where the call stands, the name, where it stands.
fn declaration(statement: &Stmt) -> Option<(Position, String, Position)> {
    let Stmt::Var(variable, flags, _) = statement else { return None };
    let call = param_call(&variable.1).filter(|_| flags.contains(ASTFlags::CONSTANT))?;
    Some((call, variable.0.name.to_string(), variable.0.pos))
}

/// Where the call stands, if an expression is one of `param`.
pub(super) fn param_call(expr: &Expr) -> Option<Position> {
    match expr {
        Expr::FnCall(call, at) if call.name == "param" => Some(*at),
        _ => None,
    }
}

fn place(at: Position) -> (usize, usize) {
    (at.line().unwrap_or(0), at.position().unwrap_or(0))
}

fn of_kind(value: f64, whole: bool) -> Dynamic {
    if whole { Dynamic::from(value as i64) } else { Dynamic::from(value) }
}

/// What a parameter must not be called, since it would be taken for something else where it is set.
fn collides(name: &str) -> Option<String> {
    let groups = SETTINGS.iter().map(|row| row.group);
    let is_group = groups.chain(["filter", "world"]).any(|group| group == name);
    let is_function = FUNCTIONS.iter().chain(WINDOWS).any(|row| row.name == name);
    let what = match () {
        () if is_group => "of settings",
        () if fact_table::is_group(name) => "of facts",
        () if is_function || SETUP.iter().any(|row| row.name == name) => "of one of the engine's functions",
        () => return None,
    };
    Some(format!("'{name}' is the name {what}"))
}

struct Read {
    default: f64,
    low: f64,
    high: f64,
    whole: bool,
    unit: String,
}

impl Read {
    fn takes(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value) && (!self.whole || value.fract() == 0.0)
    }
}

/// What a call says, or what is wrong with it.
fn read(arguments: &[Dynamic]) -> std::result::Result<Read, String> {
    let [default, map] = arguments else {
        return Err("a parameter has a number and its range".to_owned());
    };
    let Some(map) = map.read_lock::<Map>() else {
        return Err("a parameter has a number and its range by name".to_owned());
    };
    let number = |value: &Dynamic| value.as_float().ok().or_else(|| Some(value.as_int().ok()? as f64));
    let finite = |value: &Dynamic, what: &str| {
        number(value)
            .filter(|number| number.is_finite())
            .ok_or_else(|| format!("{what} of a parameter must be a number"))
    };
    let of = |key: &str| map.get(key).ok_or_else(|| format!("this parameter has no '{key}'"));
    if let Some(unknown) = map.keys().find(|key| !matches!(key.as_str(), "low" | "high" | "unit")) {
        return Err(format!("a parameter has low, high and unit, not '{}'", printable(unknown)));
    }
    let (low, high) = (of("low")?, of("high")?);
    let whole = [default, low, high].iter().all(|value| value.is_int());
    let unit = match map.get("unit") {
        None => String::new(),
        Some(unit) => unit.clone().into_string().map_err(|_| "the unit of a parameter is a text".to_owned())?,
    };
    if unit.chars().count() > 24 || unit.chars().any(char::is_control) {
        return Err("the unit of a parameter has at most 24 characters".to_owned());
    }
    let (default, low, high) = (finite(default, "the value")?, finite(low, "'low'")?, finite(high, "'high'")?);
    if low >= high {
        return Err(format!("'low' must be less than 'high', found {low} and {high}"));
    }
    if !(low..=high).contains(&default) {
        return Err(format!("the value {default} is not within {low} to {high}"));
    }
    Ok(Read { default, low, high, whole, unit })
}
