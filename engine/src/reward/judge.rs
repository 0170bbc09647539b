//! One run's judging: refilled facts in, one verdict for each step out.

use super::behaviour::{Loaded, variable};
use super::explain;
use super::expression::{Inputs, Slot};
use super::facts::Facts;
use super::rule::{Clause, Rule, ScriptClause};
use super::views::{All, number, view, wrong_length};
use crate::diagnostic::{Diagnostic, Kind, Result, nearest_name, printable};
use rhai::{CallFnOptions, Dynamic, Map, Scope};
use std::ops::Range;
use std::sync::Arc;

/// The verdict on one step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Verdict {
    /// The sum of all that fired.
    pub reward: f64,
    /// Whether the robot must be brought back.
    pub recover: bool,
}

/// One run's judging of a behaviour: counters, and what was calibrated.
#[derive(Debug)]
pub struct Judge {
    loaded: Arc<Loaded>,
    facts: Arc<Facts>,
    beams: usize,
    /// For each rule, how many steps its condition must hold.
    needed: Vec<u32>,
    held: Vec<u32>,
    fired: Vec<Option<f64>>,
    calibrated: Option<Arc<Dynamic>>,
    slots: Vec<Slot>,
}

impl Judge {
    pub(super) fn new(loaded: Arc<Loaded>, period_s: f64, beams: usize) -> Self {
        let needed: Vec<u32> = loaded.rules.iter().map(|rule| rule.persistence.steps(period_s)).collect();
        let entries = needed.len() + usize::from(loaded.reward.is_some());
        let facts = Arc::new(Facts { ranges_m: vec![0.0; beams], ..Facts::default() });
        let calibrated = loaded.calibrate.is_none().then(Arc::default);
        let (held, fired) = (vec![0; needed.len()], vec![None; entries]);
        Self { loaded, facts, beams, needed, held, fired, calibrated, slots: Vec::new() }
    }

    /// The facts of the last step.
    #[must_use]
    pub fn facts(&self) -> &Facts {
        &self.facts
    }

    /// The measurements of the present step, to be refilled in place.
    pub fn facts_mut(&mut self) -> &mut Facts {
        // No script value outlives its step, so that this never copies.
        Arc::make_mut(&mut self.facts)
    }

    /// Runs `fn calibrate(facts)` on the present facts, if there is one; rules read its result as `calibrated`.
    ///
    /// # Errors
    /// If it fails, or its result is not what the rules need.
    pub fn calibrate(&mut self) -> Result<()> {
        let Some(span) = self.loaded.calibrate.clone() else { return Ok(()) };
        let result = plain(self.call("calibrate")?);
        let source = &self.loaded.code.source;
        let is_kept = number(&result).is_some() || result.is_bool() || result.is_array() || result.is_map();
        if !is_kept {
            let found = explain::plain_kind(result.type_name());
            return Diagnostic::new(
                Kind::Input,
                "E-SCRIPT-REWARD",
                format!("'fn calibrate' must return a number, an array or a map, found {found}"),
            )
            .at(source, span, "defined here")
            .into();
        }
        self.slots = self.loaded.needs.slots.iter().map(|key| slot(&result, key)).collect();
        for wanted in &self.loaded.needs.slot_uses {
            let message = match (&self.slots[wanted.slot], wanted.length) {
                (Slot::Number(_), None) => continue,
                (Slot::Numbers(values), Some(length)) if values.len() == length => continue,
                (Slot::Numbers(values), Some(length)) => wrong_length(length, values.len()),
                (_, Some(_)) => "'fn calibrate' has not returned an array of numbers for this".to_owned(),
                (_, None) => "'fn calibrate' has not returned a number for this".to_owned(),
            };
            return explain::mistake(source, "E-SCRIPT-REWARD", wanted.position, message, "needed here").into();
        }
        self.calibrated = Some(Arc::new(result));
        Ok(())
    }

    /// Judges the present facts.
    ///
    /// # Errors
    /// If the script fails or is stopped, or a value is not a finite number: in its line of the script.
    pub fn judge(&mut self) -> Result<Verdict> {
        self.check_facts()?;
        self.fired.fill(None);
        let mut verdict = Verdict::default();
        let loaded = Arc::clone(&self.loaded);
        for (index, rule) in loaded.rules.iter().enumerate() {
            if !self.condition(rule)? {
                self.held[index] = 0;
                continue;
            }
            self.held[index] += 1;
            if self.held[index] < self.needed[index] {
                continue;
            }
            self.held[index] = 0;
            let value = self.value(rule)?;
            if !value.is_finite() {
                return self.not_finite(&rule.shown(), value, rule.value_span.clone()).into();
            }
            self.fired[index] = Some(value);
            verdict.reward += value;
            if rule.recover {
                verdict.recover = true;
                return Ok(verdict);
            }
        }
        if let Some(span) = &loaded.reward {
            let own = self.reward(span)?;
            if !own.reward.is_finite() {
                return self.not_finite("'fn reward'", own.reward, span.clone()).into();
            }
            self.fired[loaded.rules.len()] = Some(own.reward);
            verdict.reward += own.reward;
            verdict.recover = own.recover;
        }
        Ok(verdict)
    }

    /// What each rule added in the last step, in the order of [`super::Behaviour::rules`].
    #[must_use]
    pub fn fired(&self) -> &[Option<f64>] {
        &self.fired
    }

    /// The robot has been brought back: every persistence starts again.
    pub fn recovered(&mut self) {
        self.held.fill(0);
    }

    fn check_facts(&self) -> Result<()> {
        let wrong = |message: String| Diagnostic::new(Kind::State, "E-REWARD-FACTS", message);
        if self.facts.ranges_m.len() != self.beams {
            let message = format!("the judge was made for {} beams, found {}", self.beams, self.facts.ranges_m.len());
            return wrong(message).into();
        }
        if self.calibrated.is_none() {
            return wrong("the script has not been calibrated yet".to_owned()).into();
        }
        self.loaded.check_cells(self.facts.grid)
    }

    fn not_finite(&self, what: &str, value: f64, span: Range<usize>) -> Diagnostic {
        let value = if value.is_nan() { "no number (NaN)".to_owned() } else { value.to_string() };
        let message = format!("{what} gave {value} as its value");
        Diagnostic::new(Kind::Input, "E-REWARD-VALUE", message)
            .at(&self.loaded.code.source, span, format!("gave {value}"))
            .help("look for a division by 0, or the root or logarithm of a negative number")
    }

    fn inputs(&self) -> Inputs<'_> {
        Inputs { facts: &self.facts, slots: &self.slots }
    }

    pub(super) fn condition(&self, rule: &Rule) -> Result<bool> {
        let script = match &rule.condition {
            Clause::Native(flag) => return Ok(flag.holds(self.inputs())),
            Clause::Script(script) => script,
        };
        let result = self.run(script)?;
        result.as_bool().map_err(|kind| {
            let message = "a condition must be true or false";
            let label = format!("this is {}", explain::plain_kind(kind));
            let wrong = Diagnostic::new(Kind::Input, "E-SCRIPT-RULE", message);
            Box::new(
                wrong
                    .at(&self.loaded.code.source, rule.condition_span.clone(), label)
                    .help("compare it: laser.nearest < 0.25"),
            )
        })
    }

    pub(super) fn value(&self, rule: &Rule) -> Result<f64> {
        let script = match &rule.value {
            Clause::Native(number) => return Ok(number.value(self.inputs())),
            Clause::Script(script) => script,
        };
        let result = self.run(script)?;
        number(&result).ok_or_else(|| {
            let label = format!("this is {}", explain::plain_kind(result.type_name()));
            let wrong = Diagnostic::new(Kind::Input, "E-SCRIPT-RULE", "a rule's value must be a number");
            Box::new(
                wrong.at(&self.loaded.code.source, rule.value_span.clone(), label).help("write a number, such as -1"),
            )
        })
    }

    fn run(&self, script: &ScriptClause) -> Result<Dynamic> {
        let loaded = &*self.loaded;
        let mut scope = Scope::new();
        for root in &script.roots {
            match root.as_str() {
                "facts" => drop(scope.push("facts", self.all())),
                "calibrated" => drop(scope.push_dynamic("calibrated", self.calibration().as_ref().clone())),
                group => match view(group, &self.facts) {
                    unknown if unknown.is_unit() => {}
                    known => drop(scope.push_dynamic(group, known)),
                },
            }
        }
        for index in 0..script.variables {
            if let Some((name, value)) = variable(&loaded.constants, index) {
                scope.push_dynamic(name, value);
            }
        }
        let result = loaded.engine.eval_ast_with_scope::<Dynamic>(&mut scope, &script.ast);
        result.map_err(|error| Box::new(explain::running(&loaded.code.source, &error)))
    }

    fn calibration(&self) -> Arc<Dynamic> {
        self.calibrated.as_ref().map_or_else(Arc::default, Arc::clone)
    }

    fn all(&self) -> All {
        All::new(&self.facts, &self.calibration())
    }

    fn call(&self, function: &str) -> Result<Dynamic> {
        let loaded = &*self.loaded;
        let options = CallFnOptions::new().eval_ast(false).rewind_scope(true);
        let arguments = (self.all(),);
        let result = loaded.engine.call_fn_with_options(options, &mut Scope::new(), &loaded.ast, function, arguments);
        result.map_err(|error| Box::new(explain::running(&loaded.code.source, &error)))
    }

    /// What `fn reward` returns; its value may still be infinite.
    pub(super) fn reward(&self, span: &Range<usize>) -> Result<Verdict> {
        let result = self.call("reward")?;
        if let Some(reward) = number(&result) {
            return Ok(Verdict { reward, recover: false });
        }
        let wrong = |message: String| {
            Diagnostic::new(Kind::Input, "E-REWARD-VALUE", message)
                .at(&self.loaded.code.source, span.clone(), "defined here")
                .help("return a number, or #{ value: -1, recover: true }")
        };
        let kind = explain::plain_kind(result.type_name());
        let Some(map) = result.try_cast::<Map>() else {
            return wrong(format!("'fn reward' must return a number or a map, found {kind}")).into();
        };
        if let Some(key) = map.keys().find(|key| !matches!(key.as_str(), "value" | "recover")) {
            let near = nearest_name(key, ["value", "recover"])
                .map_or(String::new(), |near| format!("; did you mean '{near}'?"));
            return wrong(format!("the map that 'fn reward' returned has a key '{}'{near}", printable(key))).into();
        }
        let recover = map.get("recover").map_or(Ok(false), Dynamic::as_bool);
        match (map.get("value").and_then(number), recover) {
            (Some(reward), Ok(recover)) => Ok(Verdict { reward, recover }),
            (None, _) => wrong("the map that 'fn reward' returned has no number as its 'value'".to_owned()).into(),
            (_, Err(_)) => {
                wrong("'recover' in the map that 'fn reward' returned must be true or false".to_owned()).into()
            }
        }
    }

    pub(super) fn loaded(&self) -> &Arc<Loaded> {
        &self.loaded
    }
}

/// The same value with every whole number as one with a fraction: what was measured is not counted.
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
