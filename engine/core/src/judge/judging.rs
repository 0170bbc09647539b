//! One run's judging: refilled facts in, one judgement for each step out.

use super::compiled::CompiledScript;
use super::evaluate::{Judgement, Present};
use super::explain;
use super::expression::Slot;
use super::facts::Facts;
use super::readings::{self, PartRead};
use super::views::{number, wrong_length};
use crate::diagnostic::{Diagnostic, Result};
use rhai::{Dynamic, Map};
use std::sync::Arc;

/// One run's judging of a behaviour: counters, and what was calibrated.
#[derive(Debug)]
pub struct Judge {
    present: Present,
    beams: usize,
    /// For each rule, how many steps its condition must hold.
    needed: Vec<u32>,
    held: Vec<u32>,
    /// For each rule, what a step in which its condition holds builds up: its fixed value over the steps that it needs.
    built_up: Vec<f64>,
    fired: Vec<Option<f64>>,
}

impl Judge {
    pub(crate) fn new(compiled: Arc<CompiledScript>, period_s: f64, beams: usize) -> Self {
        let needed: Vec<u32> = compiled.rules.iter().map(|rule| rule.persistence.steps(period_s)).collect();
        let entries = needed.len() + usize::from(compiled.reward.is_some());
        let facts = Arc::new(Facts { ranges_m: vec![0.0; beams], ..Facts::default() });
        let calibrated = compiled.calibrate.is_none().then(Arc::default);
        let (held, fired) = (vec![0; needed.len()], vec![None; entries]);
        let built_up = compiled.rules.iter().zip(&needed).map(|(rule, needed)| match rule.fixed_value() {
            Some(value) if *needed > 1 => value / f64::from(*needed),
            _ => 0.0,
        });
        let built_up = built_up.collect();
        let present = Present { compiled, facts, calibrated, slots: Vec::new() };
        Self { present, beams, needed, held, built_up, fired }
    }

    /// The facts of the last step.
    #[must_use]
    pub fn facts(&self) -> &Facts {
        &self.present.facts
    }

    /// The measurements of the present step, to be refilled in place.
    pub fn facts_mut(&mut self) -> &mut Facts {
        // No script value outlives its step, so that this never copies.
        Arc::make_mut(&mut self.present.facts)
    }

    /// Runs `fn calibrate(facts)` on the present facts, if there is one; rules read its result as `calibrated`.
    ///
    /// # Errors
    /// If it fails, or its result is not what the rules need.
    pub fn calibrate(&mut self) -> Result<()> {
        let present = &mut self.present;
        let compiled = Arc::clone(&present.compiled);
        let source = &compiled.source;
        let Some(span) = compiled.calibrate.clone() else { return Ok(()) };
        let result = plain(present.call("calibrate")?);
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
        present.slots = compiled.needs.slots.iter().map(|key| slot(&result, key)).collect();
        for wanted in &compiled.needs.slot_uses {
            let message = match (&present.slots[wanted.slot], wanted.length) {
                (Slot::Number(_), None) => continue,
                (Slot::Numbers(values), Some(length)) if values.len() == length => continue,
                (Slot::Numbers(values), Some(length)) => wrong_length(length, values.len()),
                (_, Some(_)) => "'fn calibrate' has not returned an array of numbers for this".to_owned(),
                (_, None) => "'fn calibrate' has not returned a number for this".to_owned(),
            };
            return explain::mistake(source, "E-SCRIPT-REWARD", wanted.position, message, "needed here").fail();
        }
        present.calibrated = Some(Arc::new(result));
        Ok(())
    }

    /// Judges the present facts.
    ///
    /// # Errors
    /// If the script fails or is stopped, or a value is not a finite number: in its line of the script.
    pub fn judge(&mut self) -> Result<Judgement> {
        self.check_facts()?;
        let Self { present, held, needed, fired, .. } = self;
        fired.fill(None);
        let mut judgement = Judgement::default();
        let rules = &present.compiled.rules;
        for (index, rule) in rules.iter().enumerate() {
            if !present.condition(rule)? {
                held[index] = 0;
                continue;
            }
            held[index] += 1;
            if held[index] < needed[index] {
                continue;
            }
            held[index] = 0;
            let value = present.value(rule)?;
            if !value.is_finite() {
                return present.not_finite(&rule.shown(), value, rule.value_span.clone()).fail();
            }
            fired[index] = Some(value);
            judgement.reward += value;
            if rule.then.is_some() {
                judgement.then = rule.then;
                return Ok(judgement);
            }
        }
        if let Some(span) = &present.compiled.reward {
            let own = present.reward(span)?;
            if !own.reward.is_finite() {
                return present.not_finite("'fn reward'", own.reward, span.clone()).fail();
            }
            fired[rules.len()] = Some(own.reward);
            judgement.reward += own.reward;
            judgement.then = own.then;
        }
        Ok(judgement)
    }

    /// What each rule added in the last step, in the order of the behaviour's rules.
    #[must_use]
    pub fn fired(&self) -> &[Option<f64>] {
        &self.fired
    }

    /// The beam behind the last rule that fired in the last step, if it read the laser. Allocates nothing.
    #[must_use]
    pub(crate) fn fired_beam(&self) -> Option<usize> {
        let last = self.fired.iter().rposition(Option::is_some)?;
        readings::beam(self.present.parts(last), self.present.inputs())
    }

    /// What the condition of a rule reads in the present facts, part by part.
    #[must_use]
    pub fn evidence(&self, rule: usize) -> Vec<PartRead> {
        self.present.parts(rule).iter().map(|part| part.evidence(self.present.inputs())).collect()
    }

    /// Whether a rule's condition holds in the present facts; false where it fails.
    #[must_use]
    pub fn holds(&self, rule: usize) -> bool {
        let rule = self.present.compiled.rules.get(rule);
        rule.is_some_and(|rule| self.present.condition(rule).unwrap_or(false))
    }

    /// For how many steps a rule's condition has held since it last fired, and how many it needs.
    #[must_use]
    pub fn held(&self, rule: usize) -> (u32, u32) {
        (self.held.get(rule).copied().unwrap_or(0), self.needed.get(rule).copied().unwrap_or(1))
    }

    /// The robot has been brought back: every persistence starts again.
    pub fn recovered(&mut self) {
        self.held.fill(0);
    }

    /// What the rules that must hold for a time have built up: the sum of each one's fixed value times the share of the time
    /// for which it has held.
    #[must_use]
    pub fn potential(&self) -> f64 {
        self.held.iter().zip(&self.built_up).map(|(held, value)| f64::from(*held) * value).sum()
    }

    fn check_facts(&self) -> Result<()> {
        let wrong = |message: String| Diagnostic::new("E-REWARD-FACTS", message);
        if self.present.facts.ranges_m.len() != self.beams {
            let message =
                format!("the judge was made for {} beams, found {}", self.beams, self.present.facts.ranges_m.len());
            return wrong(message).fail();
        }
        if self.present.calibrated.is_none() {
            return wrong("the script has not been calibrated yet".to_owned()).fail();
        }
        self.present.compiled.check_cells(self.present.facts.grid)
    }

    pub(crate) fn present(&self) -> &Present {
        &self.present
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
