//! What a script may cost in one step: counted work, the same on every machine.
//!
//! The interpreter counts one operation for each thing that it evaluates, however long the arrays are that it reads. Here
//! what is copied or compared is charged by its length too, from one budget for all rules of a step, so that a step of the
//! worst script ends within a fifth of a second.

use super::sandbox::{MAX_ARRAY, MAX_OPERATIONS};
use rhai::{Dynamic, Engine, EvalAltResult, EvalContext, Map, Position, Scope};
use std::cell::Cell;
use std::collections::BTreeMap;

/// So many values are copied for the price of one operation.
pub(crate) const VALUES_PER_OPERATION: u64 = 32;

thread_local! {
    // A step is judged on one thread, and the interpreter is shared by all seeds: what is left belongs to the thread.
    static LEFT: Cell<u64> = const { Cell::new(MAX_OPERATIONS) };
}

/// Begins anew with so many operations.
pub(crate) fn refill(operations: u64) {
    LEFT.set(operations);
}

/// The operations that are left.
pub(crate) fn left() -> u64 {
    LEFT.get()
}

/// Takes operations away; whether they were there.
pub(crate) fn charge(operations: u64) -> bool {
    let left = LEFT.get().checked_sub(operations);
    LEFT.set(left.unwrap_or(0));
    left.is_some()
}

/// As [`charge`], for a function of the interpreter.
///
/// # Errors
/// If they were not there.
pub(crate) fn spend(operations: u64) -> Result<(), Box<EvalAltResult>> {
    if charge(operations) { Ok(()) } else { Err(EvalAltResult::ErrorTooManyOperations(Position::NONE).into()) }
}

/// Charges the copy of so many values.
pub(crate) fn spend_values(values: usize) -> Result<(), Box<EvalAltResult>> {
    spend(values as u64 / VALUES_PER_OPERATION)
}

/// How many values an array or a map holds, those in its values too; 0 for anything else. What is nested counts twice: it
/// has a place of its own in memory.
pub(crate) fn size(value: &Dynamic) -> usize {
    if let Some(array) = value.read_lock::<rhai::Array>() {
        return 1 + array.iter().map(|value| 1 + size(value)).sum::<usize>();
    }
    // A key is copied and compared as a text.
    value.read_lock::<Map>().map_or(0, |map| 1 + map.values().map(|value| 2 + size(value)).sum::<usize>())
}

/// Lets every operation of an engine, and every variable that it reads, be charged.
pub(crate) fn register(engine: &mut Engine) {
    engine.on_progress(|_| (!charge(1)).then_some(Dynamic::UNIT));
    charge_variables(engine, BTreeMap::new());
}

/// As [`register`], once the top level has run: functions read its constants from elsewhere.
pub(crate) fn register_constants(engine: &mut Engine, constants: &Scope<'_>) {
    let sizes = constants.iter().map(|(name, _, value)| (name.to_owned(), size(&value)));
    charge_variables(engine, sizes.filter(|(_, size)| *size > 0).collect());
}

#[expect(deprecated, reason = "volatile by its own words; the version of the interpreter is pinned")]
fn charge_variables(engine: &mut Engine, constants: BTreeMap<String, usize>) {
    engine.on_var(move |name: &str, _: usize, context: EvalContext<'_, '_, '_, '_, '_, '_>| {
        let size = match context.scope().get(name) {
            Some(value) if value.is_array() || value.is_map() => size(value),
            Some(_) => 0,
            None => constants.get(name).copied().unwrap_or(0),
        };
        spend_values(size).map(|()| None)
    });
}

// The price of the longest array is far below the budget, so that any script can read each of its arrays.
const _: () = assert!(MAX_ARRAY as u64 / VALUES_PER_OPERATION < MAX_OPERATIONS / 1000);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_map_costs_its_keys_and_all_that_is_in_it() {
        let array: rhai::Array = vec![1.into(), 2.into(), 3.into()];
        let map: Map = [("a".into(), Dynamic::from(array)), ("b".into(), 1.into())].into_iter().collect();
        // The map, two keys at 2, and the array with its three values.
        assert_eq!((size(&map.into()), size(&5.into())), (9, 0));
    }

    #[test]
    fn what_is_not_there_cannot_be_charged() {
        refill(3);
        assert!(charge(2) && !charge(2) && left() == 0);
        refill(MAX_OPERATIONS);
    }
}
