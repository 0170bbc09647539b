//! Rules and functions evaluated on the present facts.

use super::budget;
use super::compiled::{CompiledScript, variable};
use super::explain;
use super::expression::{Slot, StepFacts, Typed};
use super::facts::Facts;
use super::memory::{Measure, Memory, Remembered};
use super::readings::Part;
use super::rule::{Clause, CompiledRule, ScriptClause};
use super::running;
use super::views::{AllFacts, SeenView, number, view};
use crate::diagnostic::{Diagnostic, Result, nearest_name, printable};
use crate::outcome::{Destination, Then};
use rhai::{CallFnOptions, Dynamic, EvalAltResult, Map, Position, Scope};
use std::ops::Range;
use std::sync::Arc;

/// What the script says of one step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Judgement {
    /// The sum of all that fired.
    pub reward: f64,
    /// What the script says if the attempt ends here.
    pub then: Option<Then>,
    /// Where the next attempt begins, if the script says so.
    pub to: Option<Destination>,
    /// The stage that the script wants next, whether or not it is another one.
    pub stage: Option<usize>,
}

/// A script, and what it can read in this step.
#[derive(Debug)]
pub(crate) struct Present {
    pub compiled: Arc<CompiledScript>,
    pub facts: Arc<Facts>,
    /// The facts of the step before.
    pub previous: Arc<Facts>,
    pub memory: Memory,
    /// What `fn calibrate` returned; nothing before it ran.
    pub calibrated: Option<Arc<Dynamic>>,
    /// The present step as native trees read it.
    pub slots: Vec<Slot>,
    /// The names of the world's starts; nothing where the world is not known.
    pub starts: Option<Vec<String>>,
}

impl Present {
    pub(crate) fn inputs(&self) -> StepFacts<'_> {
        StepFacts { facts: &self.facts, previous: &self.previous, slots: &self.slots, memory: &self.memory }
    }

    /// What a rule, or after the last one `fn reward`, reads.
    pub(crate) fn parts(&self, rule: usize) -> &[Part] {
        self.compiled.rules.get(rule).map_or(&self.compiled.reward_parts, |rule| &rule.parts)
    }

    pub(crate) fn condition(&self, rule: &CompiledRule) -> Result<bool> {
        let script = match &rule.condition {
            Clause::Native(flag) => return Ok(flag.holds(self.inputs())),
            Clause::Script(script) => script,
        };
        let result = self.run(script)?;
        result.as_bool().map_err(|kind| {
            let message = "a condition must be true or false";
            let label = format!("this is {}", explain::plain_kind(kind));
            let wrong = Diagnostic::new("E-SCRIPT-RULE", message);
            Box::new(
                wrong
                    .at(&self.compiled.source, rule.condition_span.clone(), label)
                    .help("compare it: laser.nearest < 0.25"),
            )
        })
    }

    pub(crate) fn value(&self, rule: &CompiledRule) -> Result<f64> {
        let script = match &rule.value {
            Clause::Native(number) => return Ok(number.value(self.inputs())),
            Clause::Script(script) => script,
        };
        let result = self.run(script)?;
        number(&result).ok_or_else(|| {
            let label = format!("this is {}", explain::plain_kind(result.type_name()));
            let wrong = Diagnostic::new("E-SCRIPT-RULE", "a rule's value must be a number");
            Box::new(wrong.at(&self.compiled.source, rule.value_span.clone(), label).help("write a number, such as -1"))
        })
    }

    fn run(&self, script: &ScriptClause) -> Result<Dynamic> {
        let compiled = &*self.compiled;
        let mut scope = Scope::new();
        let place = script.ast.statements().first().map_or(Position::NONE, |first| first.position());
        let copied = |value: &Dynamic| {
            budget::spend_values(budget::size(value)).map_err(|mut error| {
                error.set_position(place);
                self.told(error)
            })
        };
        for root in &script.roots {
            match root.as_str() {
                "facts" => drop(scope.push("facts", self.all())),
                "previous" => drop(scope.push_dynamic("previous", view("previous", &self.previous))),
                "calibrated" => {
                    copied(&self.calibration())?;
                    scope.push_dynamic("calibrated", self.calibration().as_ref().clone());
                }
                name if let Some(value) = self.measure(name) => drop(scope.push_dynamic(name, value)),
                name if let Some(view) = compiled.views.iter().position(|view| view == name) => {
                    scope.push(name, SeenView { facts: Arc::clone(&self.facts), view });
                }
                group => match view(group, &self.facts) {
                    unknown if unknown.is_unit() => {}
                    known => drop(scope.push_dynamic(group, known)),
                },
            }
        }
        for index in 0..script.variables {
            if let Some((name, value)) = variable(&compiled.constants, index) {
                copied(&value)?;
                scope.push_dynamic(name, value);
            }
        }
        let result = compiled.engine.eval_ast_with_scope::<Dynamic>(&mut scope, &script.ast);
        result.map_err(|error| self.told(error))
    }

    fn told(&self, mut error: Box<EvalAltResult>) -> Box<Diagnostic> {
        let source = &self.compiled.source;
        self.compiled.stops.move_into_called(&mut error, source);
        Box::new(running::explain(source, &error))
    }

    fn calibration(&self) -> Arc<Dynamic> {
        self.calibrated.as_ref().map_or_else(Arc::default, Arc::clone)
    }

    fn all(&self) -> AllFacts {
        let measures = self.measures().map(|(index, measure)| self.value_of(index, measure)).collect();
        AllFacts {
            facts: Arc::clone(&self.facts),
            previous: Arc::clone(&self.previous),
            calibrated: self.calibration(),
            measures: Arc::new(measures),
        }
    }

    pub(crate) fn measures(&self) -> impl Iterator<Item = (usize, &Measure)> {
        self.compiled.remembered.iter().enumerate().filter_map(|(index, remembered)| match remembered {
            Remembered::Measure(measure) => Some((index, measure)),
            _ => None,
        })
    }

    fn measure(&self, name: &str) -> Option<Dynamic> {
        let (index, measure) = self.measures().find(|(_, measure)| measure.name == name)?;
        Some(self.value_of(index, measure))
    }

    fn value_of(&self, index: usize, measure: &Measure) -> Dynamic {
        let value = self.memory.value(index);
        match measure.typed {
            Typed::Flag(_) => (value != 0.0).into(),
            Typed::Number(_) | Typed::Whole(_) => value.into(),
        }
    }

    pub(crate) fn call(&self, function: &str) -> Result<Dynamic> {
        let compiled = &*self.compiled;
        let options = CallFnOptions::new().eval_ast(false).rewind_scope(true);
        let arguments = (self.all(),);
        let CompiledScript { engine, ast, .. } = compiled;
        let operations = budget::left();
        let result = engine.call_fn_with_options(options, &mut Scope::new(), ast, function, arguments);
        let placed = |error| compiled.stops.placed_in(error, engine, function, Dynamic::from(self.all()), operations);
        result.map_err(|error| self.told(placed(error)))
    }

    /// What `fn reward` returns; its value may still be infinite.
    pub(crate) fn reward(&self, span: &Range<usize>) -> Result<Judgement> {
        let result = self.call("reward")?;
        if let Some(reward) = number(&result) {
            return Ok(Judgement { reward, ..Judgement::default() });
        }
        let kind = explain::plain_kind(result.type_name());
        let read = match result.try_cast::<Map>() {
            Some(map) => of_map(&map, &self.compiled.stages, self.starts.as_deref()),
            None => Err(format!("'fn reward' must return a number or a map, found {kind}")),
        };
        read.map_err(|message| {
            let wrong =
                Diagnostic::new("E-REWARD-VALUE", message).at(&self.compiled.source, span.clone(), "defined here");
            Box::new(wrong.help("return a number, or #{ value: -1, then: \"fail\" }"))
        })
    }

    /// The error for a value that is not finite.
    pub(crate) fn not_finite(&self, what: &str, value: f64, span: Range<usize>) -> Diagnostic {
        let value = if value.is_nan() { "no number (NaN)".to_owned() } else { value.to_string() };
        let message = format!("{what} gave {value} as its value");
        Diagnostic::new("E-REWARD-VALUE", message)
            .at(&self.compiled.source, span, format!("gave {value}"))
            .help("look for a division by 0, or the root or logarithm of a negative number")
    }
}

/// What a map that `fn reward` returned says, or what is wrong with it.
fn of_map(map: &Map, stages: &[String], starts: Option<&[String]>) -> std::result::Result<Judgement, String> {
    const KEYS: [&str; 5] = ["value", "then", "recover", "to", "stage"];
    if let Some(key) = map.keys().find(|key| !KEYS.contains(&key.as_str())) {
        let near = nearest_name(key, KEYS).map_or(String::new(), |near| format!("; did you mean '{near}'?"));
        return Err(format!("the map that 'fn reward' returned has a key '{}'{near}", printable(key)));
    }
    let Some(reward) = map.get("value").and_then(number) else {
        return Err("the map that 'fn reward' returned has no number as its 'value'".to_owned());
    };
    let Ok(recover) = map.get("recover").map_or(Ok(false), Dynamic::as_bool) else {
        return Err("'recover' in the map that 'fn reward' returned must be true or false".to_owned());
    };
    let then = match map.get("then").map(|then| then.clone().into_immutable_string()) {
        None => recover.then_some(Then::Recover),
        Some(_) if map.contains_key("recover") => {
            return Err(
                "the map that 'fn reward' returned has both 'then' and 'recover': leave out 'recover'".to_owned()
            );
        }
        Some(word) => {
            let words = Then::ALL.map(|(word, _)| format!("\"{word}\"")).join(", ");
            let then = word.ok().and_then(|word| Then::of(&word));
            Some(then.ok_or_else(|| format!("'then' in the map that 'fn reward' returned must be one of {words}"))?)
        }
    };
    let to = destination(map, then.is_some(), starts)?;
    Ok(Judgement { reward, then, to, stage: stage(map, stages)? })
}

/// Where the map says that the next attempt begins.
fn destination(map: &Map, ends: bool, starts: Option<&[String]>) -> std::result::Result<Option<Destination>, String> {
    let Some(to) = map.get("to") else { return Ok(None) };
    let Ok(name) = to.clone().into_immutable_string() else {
        return Err("'to' in the map that 'fn reward' returned must be the name of a start".to_owned());
    };
    if !ends {
        return Err("the map that 'fn reward' returned has 'to' without 'then': nothing ends".to_owned());
    }
    let Some(starts) = starts else { return Ok(None) };
    let known = Destination::of(&name, starts);
    let names = || starts.iter().map(|start| format!("\"{}\"", printable(start))).collect::<Vec<_>>().join(", ");
    known.map(Some).ok_or_else(|| {
        let name = printable(&name);
        format!("this world has no start \"{name}\"; it has {}, and there are the words of recovery", names())
    })
}

/// The stage that the map wants next.
fn stage(map: &Map, stages: &[String]) -> std::result::Result<Option<usize>, String> {
    match map.get("stage").map(|stage| stage.clone().into_immutable_string()) {
        None => Ok(None),
        Some(name) => {
            let known = name.ok().and_then(|name| stages.iter().position(|stage| *stage == name.as_str()));
            let words = stages.iter().map(|stage| format!("\"{stage}\"")).collect::<Vec<_>>().join(", ");
            known.map(Some).ok_or_else(|| match stages {
                [] => "the script has no stages: write stages([\"first\", \"second\"]);".to_owned(),
                _ => format!("'stage' in the map that 'fn reward' returned must be one of {words}"),
            })
        }
    }
}
