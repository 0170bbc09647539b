//! What `fn calibrate` returned: taken once, and handed to native trees as numbers and arrays of numbers.

use super::compiled::CompiledScript;
use super::evaluate::Present;
use super::explain;
use super::expression::Slot;
use super::views::{number, wrong_length};
use crate::diagnostic::{Diagnostic, Result};
use rhai::{Dynamic, Map, Position};
use std::sync::Arc;

impl Present {
    /// Runs `fn calibrate(facts)` on the present facts, if there is one.
    ///
    /// # Errors
    /// If it fails, or its result is not what the rules need.
    pub(super) fn calibrate(&mut self) -> Result<()> {
        let compiled = Arc::clone(&self.compiled);
        let source = &compiled.source;
        let Some(span) = compiled.calibrate.clone() else { return Ok(()) };
        let result = plain(self.call("calibrate")?);
        let is_kept = number(&result).is_some() || result.is_bool() || result.is_array() || result.is_map();
        if !is_kept {
            let found = explain::plain_kind(result.type_name());
            return Diagnostic::new(
                "E-SCRIPT-REWARD",
                format!("'fn calibrate' must return a number, an array or a map, found {found}"),
            )
            .at(source, span, "defined here")
            .fail();
        }
        self.slots = compiled.slots_of(&result).map_err(|(position, message)| {
            Box::new(explain::mistake(source, "E-SCRIPT-REWARD", position, message, "needed here"))
        })?;
        self.calibrated = Some(Arc::new(result));
        Ok(())
    }
}

impl CompiledScript {
    /// What native trees read of a result; or where one needs something else, and what.
    pub(super) fn slots_of(&self, result: &Dynamic) -> std::result::Result<Vec<Slot>, (Position, String)> {
        let slots: Vec<Slot> = self.needs.slots.iter().map(|key| slot(result, key)).collect();
        for wanted in &self.needs.slot_uses {
            let message = match (&slots[wanted.slot], wanted.length) {
                (Slot::Number(_), None) => continue,
                (Slot::Numbers(values), Some(length)) if values.len() == length => continue,
                (Slot::Numbers(values), Some(length)) => wrong_length(length, values.len()),
                (_, Some(_)) => "'fn calibrate' has not returned an array of numbers for this".to_owned(),
                (_, None) => "'fn calibrate' has not returned a number for this".to_owned(),
            };
            return Err((wanted.position, message));
        }
        Ok(slots)
    }
}

/// A value with every whole number as one with a fraction: what was measured is not counted.
fn plain(value: Dynamic) -> Dynamic {
    if let Ok(whole) = value.as_int() {
        return Dynamic::from(whole as f64);
    }
    if value.is_array() {
        return value.into_array().unwrap_or_default().into_iter().map(plain).collect::<rhai::Array>().into();
    }
    if value.is_map() {
        return value.cast::<Map>().into_iter().map(|(key, value)| (key, plain(value))).collect::<Map>().into();
    }
    value
}

fn slot(result: &Dynamic, key: &str) -> Slot {
    let map = result.read_lock::<Map>();
    let value = match (key, &map) {
        ("", _) => Some(result),
        (key, Some(map)) => map.get(key),
        _ => None,
    };
    match value.map(|value| (number(value), value.read_lock::<rhai::Array>())) {
        Some((Some(value), _)) => Slot::Number(value),
        Some((_, Some(array))) => array.iter().map(number).collect::<Option<_>>().map_or(Slot::Other, Slot::Numbers),
        _ => Slot::Other,
    }
}
