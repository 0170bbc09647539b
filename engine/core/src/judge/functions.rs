//! The functions that a script may call: one list, and their meaning.
//!
//! Everything transcendental goes through `libm`, so that a script's numbers are the same on every machine; a platform's
//! own `sin` is not.

use super::expression::Comparison;
use rhai::Engine;

/// One row of the list.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Function {
    /// Its name.
    pub name: &'static str,
    /// How it is written: `atan2(y, x)`.
    pub form: &'static str,
    /// Least and greatest number of arguments; for what is written after a dot, the thing before the dot is the first.
    pub arguments: (usize, usize),
    /// One sentence: what it does.
    pub purpose: &'static str,
}

const fn row(name: &'static str, form: &'static str, arguments: usize, purpose: &'static str) -> Function {
    Function { name, form, arguments: (arguments, arguments), purpose }
}

/// Every function that a script may call, besides its own and the facts.
pub(crate) const FUNCTIONS: &[Function] = &[
    row("abs", "abs(x)", 1, "The value without its sign."),
    row("sign", "sign(x)", 1, "-1, 0 or 1."),
    row("min", "min(a, b)", 2, "The smaller of two numbers."),
    row("max", "max(a, b)", 2, "The larger of two numbers."),
    row("clamp", "clamp(x, low, high)", 3, "The number, held between two others."),
    row("sqrt", "sqrt(x)", 1, "The square root."),
    row("pow", "pow(x, y)", 2, "x to the power of y."),
    row("hypot", "hypot(x, y)", 2, "The length of (x, y)."),
    row("exp", "exp(x)", 1, "e to the power of x."),
    row("ln", "ln(x)", 1, "The natural logarithm."),
    row("sin", "sin(angle)", 1, "The sine of an angle in radians."),
    row("cos", "cos(angle)", 1, "The cosine of an angle in radians."),
    row("tan", "tan(angle)", 1, "The tangent of an angle in radians."),
    row("asin", "asin(x)", 1, "The angle in radians with this sine."),
    row("acos", "acos(x)", 1, "The angle in radians with this cosine."),
    row("atan", "atan(x)", 1, "The angle in radians with this tangent."),
    row("atan2", "atan2(y, x)", 2, "The angle of the point (x, y) in radians, -pi to pi."),
    row("tanh", "tanh(x)", 1, "The hyperbolic tangent, -1 to 1."),
    row("radians", "radians(degrees)", 1, "Degrees turned into radians."),
    row("degrees", "degrees(radians)", 1, "Radians turned into degrees."),
    row("floor", "floor(x)", 1, "The next whole value below, as a number."),
    row("ceiling", "ceiling(x)", 1, "The next whole value above, as a number."),
    row("round", "round(x)", 1, "The nearest whole value, halves away from 0, as a number."),
    row("to_int", "to_int(x)", 1, "The number without its fraction, as a whole number."),
    row("to_float", "to_float(x)", 1, "A whole number as a number with a fraction, so that division keeps it."),
    row("len", "array.len()", 1, "How many values an array or a map holds."),
    row("push", "array.push(value)", 2, "Puts a value at the end of an array."),
    row("contains", "array.contains(value)", 2, "Whether a value is in an array, or a key in a map."),
    Function {
        name: "range",
        form: "range(from, to, step)",
        arguments: (2, 3),
        purpose: "The numbers from `from` to before `to`, for a loop.",
    },
];

/// Functions that remember, or read what is remembered: only in rules, measures and parts of the state.
pub(crate) const WINDOWS: &[Function] = &[
    Function {
        name: "change",
        form: "change(x, seconds)",
        arguments: (1, 2),
        purpose: "How much a number has changed since so long ago; without a time, since the step before.",
    },
    row("average", "average(x, seconds)", 2, "The mean of a number over the last steps of that time."),
    row("fired", "fired(\"rule\")", 1, "How often a rule has fired since the attempt began."),
    row("since", "since(\"rule\")", 1, "How long ago a rule fired last, seconds; 1e6 if it has not."),
];

/// A function of one number.
pub(crate) type OneArgument = fn(f64) -> f64;
/// A function of two numbers.
pub(crate) type TwoArguments = fn(f64, f64) -> f64;

/// Functions from one number to one with a fraction.
pub(crate) const OF_ONE: &[(&str, OneArgument)] = &[
    ("sqrt", f64::sqrt),
    ("exp", libm::exp),
    ("ln", libm::log),
    ("sin", libm::sin),
    ("cos", libm::cos),
    ("tan", libm::tan),
    ("asin", libm::asin),
    ("acos", libm::acos),
    ("atan", libm::atan),
    ("tanh", libm::tanh),
    ("radians", f64::to_radians),
    ("degrees", f64::to_degrees),
    ("to_float", |x| x),
];

/// Functions that keep a whole number whole, for numbers with a fraction.
pub(crate) const OF_ONE_FRACTION: &[(&str, OneArgument)] =
    &[("abs", f64::abs), ("floor", f64::floor), ("ceiling", f64::ceil), ("round", f64::round)];

/// Functions from two numbers to one with a fraction.
pub(crate) const OF_TWO: &[(&str, TwoArguments)] =
    &[("pow", libm::pow), ("hypot", libm::hypot), ("atan2", libm::atan2)];

/// Functions that keep two whole numbers whole, for numbers with a fraction.
pub(crate) const OF_TWO_FRACTION: &[(&str, TwoArguments)] = &[("min", smaller), ("max", larger)];

// `f64::min` may answer either zero for 0.0 and -0.0; a comparison always answers the same one.
fn smaller(a: f64, b: f64) -> f64 {
    if b < a { b } else { a }
}

fn larger(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

/// -1, 0 or 1; 0 of what is no number.
pub(crate) fn sign(x: f64) -> f64 {
    f64::from(i8::from(x > 0.0) - i8::from(x < 0.0))
}

/// Makes the functions known to an engine, over those of Rhai's packages.
pub(crate) fn register(engine: &mut Engine) {
    for &(name, function) in OF_ONE {
        engine.register_fn(name, function);
        engine.register_fn(name, move |x: i64| function(x as f64));
    }
    for &(name, function) in OF_ONE_FRACTION {
        engine.register_fn(name, function);
        if name != "abs" {
            engine.register_fn(name, |x: i64| x);
        }
    }
    for &(name, function) in OF_TWO.iter().chain(OF_TWO_FRACTION) {
        engine.register_fn(name, function);
        engine.register_fn(name, move |a: i64, b: f64| function(a as f64, b));
        engine.register_fn(name, move |a: f64, b: i64| function(a, b as f64));
    }
    for &(name, function) in OF_TWO {
        engine.register_fn(name, move |a: i64, b: i64| function(a as f64, b as f64));
    }
    engine.register_fn("min", |a: i64, b: i64| a.min(b));
    engine.register_fn("max", |a: i64, b: i64| a.max(b));
    register_clamp(engine);
    register_comparisons(engine);
    engine.register_fn("sign", |x: f64| sign(x) as i64);
    engine.register_fn("to_int", |x: i64| x);
    // A conversion in Rust stops at the greatest whole number, so that no value is an error here.
    engine.register_fn("to_int", |x: f64| x as i64);
}

/// The interpreter's own comparisons take numbers for equal that differ by rounding, and nothing for greater or less than an
/// infinite one; those of compiled rules are put in their place.
fn register_comparisons(engine: &mut Engine) {
    engine.set_fast_operators(false);
    for (symbol, comparison) in Comparison::ALL {
        engine.register_fn(symbol, move |a: f64, b: f64| comparison.holds(a, b));
        engine.register_fn(symbol, move |a: f64, b: i64| comparison.holds(a, b as f64));
        engine.register_fn(symbol, move |a: i64, b: f64| comparison.holds(a as f64, b));
    }
}

fn register_clamp(engine: &mut Engine) {
    fn clamp(x: f64, low: f64, high: f64) -> f64 {
        smaller(larger(x, low), high)
    }
    engine.register_fn("clamp", clamp);
    engine.register_fn("clamp", |x: i64, low: i64, high: i64| x.max(low).min(high));
    engine.register_fn("clamp", |x: f64, low: i64, high: i64| clamp(x, low as f64, high as f64));
    engine.register_fn("clamp", |x: f64, low: i64, high: f64| clamp(x, low as f64, high));
    engine.register_fn("clamp", |x: f64, low: f64, high: i64| clamp(x, low, high as f64));
}
