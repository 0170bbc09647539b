//! Several worlds, and what is drawn anew for each attempt.

use super::setup::SetupReader;
use crate::diagnostic::{Diagnostic, Result, nearest_name, printable};
use crate::judge::explain;
use crate::judge::views::number;
use crate::settings::{DrawnFrom, Value, Varied, VariedKey, WorldShare};
use rhai::{Dynamic, Map, Position};
use std::ops::Range;

/// Most entries of `worlds`.
const MAX_WORLDS: usize = 64;
/// Most keys of `randomise`.
const MAX_KEYS: usize = 32;
/// Greatest weight of a world.
const MAX_WEIGHT: f64 = 1000.0;

impl SetupReader<'_> {
    /// The list of `worlds(["room", "hallway"])`, or the weights of `worlds(#{ "room": 3 })`.
    pub(super) fn worlds(&mut self, list: Dynamic, form: &str) -> Result<()> {
        let mut shares: Vec<WorldShare> = Vec::new();
        if let Some(map) = list.clone().try_cast::<Map>() {
            for (name, weight) in map {
                let at = self.entry(&name);
                self.places.insert(format!("worlds:{}", shares.len()), self.string_at(at.0));
                let weight = number(&weight).filter(|weight| weight.fract() == 0.0);
                let Some(weight) = weight.filter(|weight| (1.0..=MAX_WEIGHT).contains(weight)) else {
                    let message =
                        format!("the weight of \"{}\" must be a whole number from 1 to {MAX_WEIGHT}", printable(&name));
                    return self.wrong(at.1, message, "found something else", form);
                };
                shares.push(WorldShare { name: name.to_string(), weight: weight as u32 });
            }
        } else {
            let form = "worlds([\"room\", \"hallway\"]);, or with weights worlds(#{ \"room\": 3, \"hallway\": 1 });";
            for (number, name) in list.into_array().unwrap_or_default().into_iter().enumerate() {
                let at = self.entry(&format!("#{number}")).0;
                let Some(name) = name.into_string().ok().filter(|name| !name.trim().is_empty()) else {
                    let message = "the name of a world must be a text in quotes".to_owned();
                    return self.wrong(at, message, "no name", form);
                };
                if shares.iter().any(|share| share.name == name) {
                    let message = format!("the world \"{}\" is listed twice", printable(&name));
                    return self.wrong(at, message, "the second time", form);
                }
                self.places.insert(format!("worlds:{}", shares.len()), self.string_at(at));
                shares.push(WorldShare { name, weight: 1 });
            }
        }
        if !(1..=MAX_WORLDS).contains(&shares.len()) {
            let message = format!("there must be 1 to {MAX_WORLDS} worlds, found {}", shares.len());
            return self.wrong(self.call, message, "set here", form);
        }
        self.settings.worlds = shares;
        self.mark("worlds".to_owned(), self.call)?;
        self.check_worlds_alone(form)
    }

    /// The text in quotes at a position, or the word there.
    fn string_at(&self, at: Position) -> Range<usize> {
        let (source, from) = (&self.code.source, explain::offset(&self.code.source, at));
        let text = source.text[from..].strip_prefix('"').and_then(|text| text.find('"'));
        text.map_or_else(|| source.word_at(from), |length| from..from + length + 2)
    }

    /// `world` and `worlds` exclude each other.
    pub(super) fn check_worlds_alone(&self, form: &str) -> Result<()> {
        if !["world", "worlds"].iter().all(|call| self.places.contains_key(*call)) {
            return Ok(());
        }
        let message = "'world' and 'worlds' both say where to learn: keep one of the two".to_owned();
        self.wrong(self.call, message, "the second of them", form)
    }

    /// The keys of `randomise(#{ "camera.tilt_deg": [40, 44] })`.
    pub(super) fn randomise(&mut self, map: Map, form: &str) -> Result<()> {
        if !(1..=MAX_KEYS).contains(&map.len()) {
            let message = format!("there must be 1 to {MAX_KEYS} keys, found {}", map.len());
            return self.wrong(self.call, message, "set here", form);
        }
        self.mark("randomise".to_owned(), self.call)?;
        for (key, values) in map {
            let (at_key, at_values) = self.entry(&key);
            let result = self.varied(&key, values, at_key, at_values);
            let place = format!("randomise.{key}");
            match result.and_then(|varied| self.mark(place, at_key).map(|()| varied)) {
                Ok(varied) => self.settings.randomise.push(varied),
                Err(wrong) => {
                    self.mistakes.add(*wrong);
                    self.unread.all_of("randomise");
                }
            }
        }
        Ok(())
    }

    fn varied(&self, key: &str, values: Dynamic, at_key: Position, at_values: Position) -> Result<Varied> {
        let source = &self.code.source;
        let wrong = |position, message: String, label: &str, help: String| {
            explain::mistake(source, "E-SCRIPT-SETTING", position, message, label).help(help)
        };
        let Some((_, shape)) = VariedKey::of(key) else {
            return cannot_vary(wrong, key, at_key).fail();
        };
        let shown = printable(key);
        let example = format!("write \"{shown}\": [low, high], or three values or more to choose from");
        let values: Vec<Value> = match values.into_array() {
            Ok(values) => values.iter().map(value).collect::<Option<_>>().unwrap_or_default(),
            Err(_) => Vec::new(),
        };
        if values.len() < 2 {
            let message = format!("'{shown}' needs the least and the greatest value, or several to choose from");
            return wrong(at_values, message, "found something else", example).fail();
        }
        if let Some(value) = values.iter().find(|value| !shape.accepts(value)) {
            let message = format!("'{shown}' must be {}", shape.allowed(""));
            return wrong(at_values, message, &format!("found {value}"), example).fail();
        }
        let from = match values.as_slice() {
            [Value::Number(low), Value::Number(high)] if low <= high => DrawnFrom::Range(*low, *high),
            [Value::Number(low), Value::Number(high)] => {
                let message = format!("the least value of '{shown}' is greater than the greatest");
                return wrong(at_values, message, "in this order", format!("write [{high}, {low}]")).fail();
            }
            _ => DrawnFrom::OneOf(values),
        };
        Ok(Varied { key: key.to_owned(), from })
    }
}

fn cannot_vary(wrong: impl Fn(Position, String, &str, String) -> Diagnostic, key: &str, at: Position) -> Diagnostic {
    let all = VariedKey::all;
    let of_group: Vec<_> = all().filter(|known| known.split_once('.').is_some_and(|(group, _)| group == key)).collect();
    let help = match nearest_name(key, all().filter(|known| !known.contains("NAME"))) {
        _ if !of_group.is_empty() => format!(
            "write {}",
            of_group.iter().map(|known| format!("\"{known}\": [low, high]")).collect::<Vec<_>>().join(" or ")
        ),
        Some(near) => format!("did you mean '{near}'?"),
        None => format!("these can: {}", all().collect::<Vec<_>>().join(", ")),
    };
    wrong(at, format!("'{}' cannot vary from attempt to attempt", printable(key)), "not among those that can", help)
}

fn value(value: &Dynamic) -> Option<Value> {
    let text = || value.clone().into_string().ok().map(Value::Text);
    number(value).map(Value::Number).or_else(|| value.as_bool().ok().map(Value::Flag)).or_else(text)
}
