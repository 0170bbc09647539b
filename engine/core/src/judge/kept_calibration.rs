//! What `fn calibrate` returned, as bytes: for checkpoints.

use super::compiled::CompiledScript;
use super::expression::Slot;
use super::judging::Judge;
use crate::saved::{Passed, Passing, Unfit};
use rhai::{Dynamic, Map};
use std::sync::Arc;

/// How deep arrays and maps stand in one another at most.
const MOST_DEPTH: usize = 32;

/// The kinds of value that a script can make, by their numbers in a checkpoint.
const UNIT: u32 = 0;
const NUMBER: u32 = 1;
const WHOLE: u32 = 2;
const FLAG: u32 = 3;
const TEXT: u32 = 4;
const ARRAY: u32 = 5;
const MAP: u32 = 6;
const LETTER: u32 = 7;

impl Judge {
    /// Passes what was calibrated in each world: it may have been seen long ago, and from elsewhere.
    pub(super) fn pass_calibrated(&mut self, by: &mut Passing<'_>) -> Passed {
        if self.present.compiled.calibrate.is_none() {
            return Ok(());
        }
        let compiled = Arc::clone(&self.present.compiled);
        pass_result(by, &compiled, &mut self.present.calibrated, &mut self.present.slots)?;
        by.all(&mut self.elsewhere, |by, world| {
            let (calibrated, slots) = world.calibration_mut();
            pass_result(by, &compiled, calibrated, slots)
        })
    }
}

fn pass_result(
    by: &mut Passing<'_>,
    compiled: &CompiledScript,
    calibrated: &mut Option<Arc<Dynamic>>,
    slots: &mut Vec<Slot>,
) -> Passed {
    let mut result = calibrated.as_deref().cloned();
    by.option(&mut result, |by, value| pass_value(by, value, MOST_DEPTH))?;
    if let Passing::In(_) = by {
        *slots = match &result {
            Some(result) => compiled.slots_of(result).map_err(|_| Unfit)?,
            None => Vec::new(),
        };
        *calibrated = result.map(Arc::new);
    }
    Ok(())
}

fn pass_value(by: &mut Passing<'_>, value: &mut Dynamic, depth: usize) -> Passed {
    let depth = depth.checked_sub(1).ok_or(Unfit)?;
    let mut kind = kind_of(value)?;
    by.small(&mut kind)?;
    match kind {
        UNIT => *value = Dynamic::UNIT,
        NUMBER => {
            let mut number = value.as_float().unwrap_or_default();
            by.number(&mut number)?;
            *value = number.into();
        }
        WHOLE => {
            let mut whole = value.as_int().unwrap_or_default().cast_unsigned();
            by.whole(&mut whole)?;
            *value = whole.cast_signed().into();
        }
        FLAG => {
            let mut flag = value.as_bool().unwrap_or_default();
            by.flag(&mut flag)?;
            *value = flag.into();
        }
        TEXT => {
            let mut text = value.clone().into_string().unwrap_or_default();
            pass_text(by, &mut text)?;
            *value = text.into();
        }
        LETTER => {
            let mut code = u32::from(value.as_char().unwrap_or_default());
            by.small(&mut code)?;
            *value = char::from_u32(code).ok_or(Unfit)?.into();
        }
        ARRAY => {
            let mut array = std::mem::take(value).into_array().unwrap_or_default();
            by.list(&mut array, |by, value| pass_value(by, value, depth))?;
            *value = Dynamic::from_array(array);
        }
        MAP => {
            let map = std::mem::take(value).try_cast::<Map>().unwrap_or_default();
            let mut entries: Vec<(String, Dynamic)> =
                map.into_iter().map(|(key, value)| (key.to_string(), value)).collect();
            by.list(&mut entries, |by, (key, value)| {
                pass_text(by, key)?;
                pass_value(by, value, depth)
            })?;
            *value = Dynamic::from_map(entries.into_iter().map(|(key, value)| (key.into(), value)).collect());
        }
        _ => return Err(Unfit),
    }
    Ok(())
}

/// The number of a value's kind; there is none of what is no value, such as a function.
fn kind_of(value: &Dynamic) -> Result<u32, Unfit> {
    Ok(match () {
        () if value.is_unit() => UNIT,
        () if value.is_float() => NUMBER,
        () if value.is_int() => WHOLE,
        () if value.is_bool() => FLAG,
        () if value.is_string() => TEXT,
        () if value.is_char() => LETTER,
        () if value.is_array() => ARRAY,
        () if value.is_map() => MAP,
        () => return Err(Unfit),
    })
}

fn pass_text(by: &mut Passing<'_>, text: &mut String) -> Passed {
    let mut bytes = std::mem::take(text).into_bytes();
    by.bytes(&mut bytes)?;
    *text = String::from_utf8(bytes).map_err(|_| Unfit)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::saved::{Loading, Saving};
    use rhai::Array;

    fn out(value: &Dynamic) -> Result<Vec<u8>, Unfit> {
        let mut by = Passing::Out(Saving::default());
        pass_value(&mut by, &mut value.clone(), MOST_DEPTH)?;
        let Passing::Out(saving) = by else { panic!() };
        Ok(saving.into_bytes())
    }

    #[test]
    fn a_result_of_any_kind_comes_back_as_it_was() {
        let inner: Array =
            vec![Dynamic::from(0.5), Dynamic::from(-3_i64), true.into(), "a".into(), 'a'.into(), Dynamic::UNIT];
        let map: Map = [("area".into(), inner.into()), ("b".into(), 2.0.into())].into_iter().collect();
        let value = Dynamic::from_map(map);
        let bytes = out(&value).unwrap();
        let mut back = Dynamic::from(7.0);
        let mut by = Passing::In(Loading::new(&bytes));
        pass_value(&mut by, &mut back, MOST_DEPTH).unwrap();
        assert_eq!(format!("{back:?}"), format!("{value:?}"));
    }

    #[test]
    fn what_is_too_deep_is_refused_and_not_followed() {
        let deep = (0..MOST_DEPTH).fold(Dynamic::UNIT, |value, _| Dynamic::from_array(vec![value]));
        assert_eq!(out(&deep), Err(Unfit));
    }
}
