//! Whether two arrays or maps are equal, and whether an array holds a value: as the interpreter has it, each value charged.

use super::budget;
use rhai::{Dynamic, Engine, EvalAltResult, ImmutableString, Map, NativeCallContext};

type Evaluated<T> = Result<T, Box<EvalAltResult>>;

/// What comparing two values costs: as much as a call, since it may be one.
const COMPARING: u64 = 2;

/// Replaces the interpreter's own, which compare thousands of values in one operation.
pub(crate) fn register(engine: &mut Engine) {
    engine.register_fn("==", |context: NativeCallContext<'_>, a: &mut rhai::Array, mut b: rhai::Array| {
        arrays(&context, a, &mut b)
    });
    engine.register_fn("!=", |context: NativeCallContext<'_>, a: &mut rhai::Array, mut b: rhai::Array| {
        arrays(&context, a, &mut b).map(|equal| !equal)
    });
    engine.register_fn("==", |context: NativeCallContext<'_>, a: &mut Map, mut b: Map| maps(&context, a, &mut b));
    engine.register_fn("!=", |context: NativeCallContext<'_>, a: &mut Map, mut b: Map| {
        maps(&context, a, &mut b).map(|equal| !equal)
    });
    engine.register_fn("contains", |context: NativeCallContext<'_>, array: &mut rhai::Array, mut value: Dynamic| {
        for item in array {
            if values(&context, item, &mut value)? {
                return Ok(true);
            }
        }
        Evaluated::Ok(false)
    });
}

fn arrays(context: &NativeCallContext<'_>, a: &mut rhai::Array, b: &mut rhai::Array) -> Evaluated<bool> {
    if a.len() != b.len() {
        return Ok(false);
    }
    for (a, b) in a.iter_mut().zip(b) {
        if !values(context, a, b)? {
            return Ok(false);
        }
    }
    Ok(true)
}

fn maps(context: &NativeCallContext<'_>, a: &mut Map, b: &mut Map) -> Evaluated<bool> {
    if a.len() != b.len() {
        return Ok(false);
    }
    for (key, a) in a {
        let Some(b) = b.get_mut(key) else { return Ok(false) };
        if !values(context, a, b)? {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Whether two values are equal; what the language has no `==` for is not.
fn values(context: &NativeCallContext<'_>, a: &mut Dynamic, b: &mut Dynamic) -> Evaluated<bool> {
    budget::spend(COMPARING)?;
    if let (Ok(a), Ok(b)) = (a.as_int(), b.as_int()) {
        return Ok(a == b);
    }
    if let (Some(a), Some(b)) = (a.read_lock::<ImmutableString>(), b.read_lock::<ImmutableString>()) {
        return Ok(*a == *b);
    }
    if let (Some(mut a), Some(mut b)) = (a.write_lock::<rhai::Array>(), b.write_lock::<rhai::Array>()) {
        return arrays(context, &mut a, &mut b);
    }
    if let (Some(mut a), Some(mut b)) = (a.write_lock::<Map>(), b.write_lock::<Map>()) {
        return maps(context, &mut a, &mut b);
    }
    let same_kind = a.type_id() == b.type_id();
    match context.call_native_fn_raw("==", true, &mut [a, b]) {
        Ok(equal) => Ok(equal.as_bool().unwrap_or(false)),
        Err(error) if !same_kind && matches!(*error, EvalAltResult::ErrorFunctionNotFound(..)) => Ok(false),
        Err(error) => Err(error),
    }
}
