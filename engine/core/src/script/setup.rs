//! The set-up calls at the top of a script: written down while it runs, then turned into settings.

use super::setup_table::SETUP;
use super::source::Code;
use super::unread::Unread;
use crate::diagnostic::{Diagnostic, Mistakes, Result, printable};
use crate::geometry::Twist;
use crate::judge::explain;
use crate::judge::views::number;
use crate::settings::{self, FilterSettings, PolicySettings, RecoverTo, Settings, Value};
use rhai::{AST, ASTNode, Dynamic, Engine, Expr, FnCallExpr, Map, NativeCallContext, Position, Stmt};
use std::cell::OnceCell;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

/// Most set-up calls in one script.
const MAX_CALLS: usize = 256;
/// Most actions.
const MAX_ACTIONS: usize = 64;
/// Most stages.
const MAX_STAGES: usize = 16;
/// Fastest forward motion of an action, m/s.
const MAX_LINEAR: f64 = 2.0;
/// Fastest turn of an action, rad/s.
const MAX_ANGULAR: f64 = 6.0;

#[derive(Debug)]
struct Call {
    name: &'static str,
    arguments: Vec<Dynamic>,
    position: Position,
}

/// What the script called while its top level ran.
#[derive(Debug, Clone)]
pub(super) struct Log(Arc<Mutex<(bool, Vec<Call>)>>);

impl Log {
    /// A log that is written until it is closed, and the calls that write it.
    pub(super) fn register(engine: &mut Engine) -> Self {
        let log = Self(Arc::new(Mutex::new((true, Vec::new()))));
        for row in SETUP {
            let name = row.name;
            let one = log.clone();
            engine.register_fn(name, move |c: NativeCallContext| one.write(name, c.call_position(), vec![]));
            let one = log.clone();
            engine
                .register_fn(name, move |c: NativeCallContext, a: Dynamic| one.write(name, c.call_position(), vec![a]));
            let one = log.clone();
            engine.register_fn(name, move |c: NativeCallContext, a: Dynamic, b: Dynamic| {
                one.write(name, c.call_position(), vec![a, b])
            });
            let one = log.clone();
            engine.register_fn(name, move |c: NativeCallContext, a: Dynamic, b: Dynamic, d: Dynamic| {
                one.write(name, c.call_position(), vec![a, b, d])
            });
        }
        log
    }

    fn write(
        &self,
        name: &'static str,
        position: Position,
        arguments: Vec<Dynamic>,
    ) -> std::result::Result<(), Box<rhai::EvalAltResult>> {
        let mut log = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let fault = match &*log {
            (false, _) => format!("'{name}' sets up: it belongs at the top of the script, not into a function"),
            (true, calls) if calls.len() >= MAX_CALLS => format!("more than {MAX_CALLS} set-up calls"),
            _ => {
                log.1.push(Call { name, arguments, position });
                return Ok(());
            }
        };
        Err(Box::new(rhai::EvalAltResult::ErrorRuntime(fault.into(), position)))
    }

    /// Forgets what was called: the top level will run again.
    pub(super) fn clear(&self) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).1.clear();
    }

    /// Whether nothing more can be called.
    pub(super) fn is_full(&self) -> bool {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).1.len() >= MAX_CALLS
    }

    fn close(&self) -> Vec<Call> {
        let mut log = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        log.0 = false;
        std::mem::take(&mut log.1)
    }
}

/// Settings, and where each was set.
pub(super) type SettingPlaces = BTreeMap<String, Range<usize>>;

/// What the set-up calls say.
#[derive(Debug)]
pub(super) struct SetUp {
    pub settings: Settings,
    pub places: SettingPlaces,
    pub unread: Unread,
}

/// Ends the set-up: the settings that the calls make, over the defaults. Every call that is wrong is added to `mistakes`,
/// with its place: an unknown key, a value out of range, a setting made twice.
pub(super) fn finish(log: &Log, code: &Code, ast: &AST, mistakes: &mut Mistakes) -> SetUp {
    let (settings, places, unread) = (Settings::default(), SettingPlaces::new(), Unread::default());
    let mut setup =
        SetupReader { code, ast, settings, places, unread, mistakes, call: Position::NONE, entries: OnceCell::new() };
    for call in log.close() {
        setup.call = call.position;
        if let Err(wrong) = setup.apply(call.name, call.arguments) {
            setup.mistakes.add(*wrong);
            setup.unread.all_of(call.name);
        }
    }
    SetUp { settings: setup.settings, places: setup.places, unread: setup.unread }
}

/// Where keys and their values stand, by call and key.
type Entries = BTreeMap<(Position, String), (Position, Position)>;

pub(super) struct SetupReader<'a> {
    code: &'a Code,
    ast: &'a AST,
    settings: Settings,
    places: SettingPlaces,
    unread: Unread,
    mistakes: &'a mut Mistakes,
    pub(super) call: Position,
    entries: OnceCell<Entries>,
}

impl SetupReader<'_> {
    fn apply(&mut self, name: &'static str, arguments: Vec<Dynamic>) -> Result<()> {
        let form = SETUP.iter().find(|row| row.name == name).map_or("", |row| row.form);
        let mut arguments = arguments.into_iter();
        let (first, second) = (arguments.next(), arguments.next());
        match (name, first, second, arguments.next()) {
            ("world", Some(world), None, None) if world.is_string() => {
                self.settings.world = self.word(world, form)?;
                self.mark("world".to_owned(), self.call)
            }
            ("filter", Some(filter), parameters, None) if filter.is_string() => self.filter(filter, parameters, form),
            ("actions", Some(actions), None, None) if actions.is_array() => {
                self.settings.actions = self.actions(actions)?;
                self.mark("actions".to_owned(), self.call)
            }
            ("stages", Some(stages), None, None) if stages.is_array() => {
                self.settings.stages = self.stages(stages)?;
                self.mark("stages".to_owned(), self.call)
            }
            ("starts", Some(names), options, None) if names.is_array() => {
                self.settings.starts = self.starts(names, options, form)?;
                self.mark("starts".to_owned(), self.call)
            }
            ("policy", Some(policy), Some(path), None) if policy.is_string() && path.is_string() => {
                let policy = PolicySettings { name: self.word(policy, form)?, path: self.word(path, form)? };
                let place = format!("policy:{}", self.settings.policies.len());
                self.settings.policies.push(policy);
                self.mark(place, self.call)
            }
            ("learner" | "recovery" | "combine", Some(kind), map, None) if kind.is_string() => {
                let key = match name {
                    "learner" => "kind",
                    "recovery" => "to",
                    _ => "way",
                };
                let mut kind = self.word(kind, form)?;
                if name == "recovery" && RecoverTo::of(&kind).is_none() {
                    // The name of a start: whether the world has it is known later.
                    self.settings.recovery.at = Some(std::mem::replace(&mut kind, RecoverTo::Start.word().to_owned()));
                }
                self.set_or_tell(name, key, &Value::Text(kind), self.call);
                map.map_or(Ok(()), |map| self.group(name, map, form))
            }
            (group, Some(map), None, None)
                if !matches!(group, "world" | "filter" | "actions" | "stages" | "starts" | "policy") =>
            {
                self.group(group, map, form)
            }
            _ => self.wrong(self.call, format!("'{name}' is written otherwise"), "found this", form),
        }
    }

    pub(super) fn wrong<T>(&self, position: Position, message: String, label: &str, form: &str) -> Result<T> {
        let diagnostic = explain::mistake(&self.code.source, "E-SCRIPT-SETTING", position, message, label);
        diagnostic.help(format!("write {form}")).fail()
    }

    pub(super) fn word(&self, value: Dynamic, form: &str) -> Result<String> {
        let word = value.into_string().unwrap_or_default();
        if word.trim().is_empty() {
            return self.wrong(self.call, "the name is empty".to_owned(), "no name", form);
        }
        Ok(word)
    }

    fn mark(&mut self, setting: String, position: Position) -> Result<()> {
        let source = &self.code.source;
        let span = source.word_at(explain::offset(source, position));
        if let Some(before) = self.places.get(&setting) {
            let (line, _) = source.position(before.start);
            return Diagnostic::new("E-SCRIPT-SETTING", format!("'{setting}' is set twice"))
                .at(source, span, "the second time")
                .help(format!("keep one of the two; the first is in line {line}"))
                .fail();
        }
        self.places.insert(setting, span);
        Ok(())
    }

    fn group(&mut self, group: &'static str, map: Dynamic, form: &str) -> Result<()> {
        let Some(map) = map.try_cast::<Map>() else {
            return self.wrong(
                self.call,
                format!("'{group}' needs its settings by name"),
                "found something else",
                form,
            );
        };
        for (key, value) in map {
            let (at_key, at_value) = self.entry(&key);
            let known = settings::SETTINGS.iter().any(|row| row.group == group && row.key == key.as_str());
            let value = match (number(&value), value.as_bool(), value.clone().into_string()) {
                (Some(number), ..) => Value::Number(number),
                (_, Ok(flag), _) => Value::Flag(flag),
                (.., Ok(text)) => Value::Text(text),
                // Whatever its value is: the key is what is wrong.
                _ if !known => Value::Flag(false),
                _ => {
                    let message = format!("'{}' must be one value", printable(&key));
                    let wrong = self.wrong(at_value, message, "found something else", form);
                    self.tell(group, &key, wrong);
                    continue;
                }
            };
            self.set_or_tell(group, &key, &value, if known { at_value } else { at_key });
        }
        Ok(())
    }

    fn set_or_tell(&mut self, group: &'static str, key: &str, value: &Value, position: Position) {
        let result = self.set(group, key, value, position);
        self.tell(group, key, result);
    }

    /// Adds the mistake in one setting; the others can still be read.
    fn tell(&mut self, group: &'static str, key: &str, result: Result<()>) {
        if let Err(wrong) = result {
            self.mistakes.add(*wrong);
            self.unread.one_of(group, key);
        }
    }

    fn set(&mut self, group: &'static str, key: &str, value: &Value, position: Position) -> Result<()> {
        if let Err(error) = settings::apply(&mut self.settings, group, key, value) {
            let source = &self.code.source;
            let mut wrong = explain::mistake(source, "E-SCRIPT-SETTING", position, error.message, error.found);
            wrong.help = error.help;
            return wrong.fail();
        }
        self.mark(format!("{group}.{key}"), position)
    }

    fn filter(&mut self, name: Dynamic, parameters: Option<Dynamic>, form: &str) -> Result<()> {
        let mut filter = FilterSettings { name: self.word(name, form)?, parameters: Vec::new() };
        let stage = format!("filter:{}", self.settings.filters.len());
        self.mark(stage.clone(), self.call)?;
        let parameters = parameters.unwrap_or_else(|| Map::new().into());
        let Some(parameters) = parameters.try_cast::<Map>() else {
            return self.wrong(
                self.call,
                "a filter needs its parameters by name".to_owned(),
                "found something else",
                form,
            );
        };
        for (key, value) in parameters {
            let (_, position) = self.entry(&key);
            let switch = value.as_bool().ok().map(|on| f64::from(u8::from(on)));
            match number(&value).or(switch).filter(|number| number.is_finite()) {
                Some(number) => filter.parameters.push((key.to_string(), number)),
                None => {
                    let message = format!("the parameter '{}' must be a number, false or true", printable(&key));
                    let wrong = self.wrong(position, message, "found something else", form);
                    self.tell("filter", &key, wrong);
                }
            }
            self.mark(format!("{stage}.{key}"), position)?;
        }
        self.settings.filters.push(filter);
        Ok(())
    }

    fn actions(&self, actions: Dynamic) -> Result<Vec<Twist>> {
        let form = "actions([[0.4, 0.2], [0.4, 0.0]]); with forward speed in m/s and turning speed in rad/s";
        let list = actions.into_array().unwrap_or_default();
        if list.is_empty() || list.len() > MAX_ACTIONS {
            let message = format!("there must be 1 to {MAX_ACTIONS} actions, found {}", list.len());
            return self.wrong(self.call, message, "set here", form);
        }
        let mut twists = Vec::new();
        for (index, action) in list.into_iter().enumerate() {
            let pair = action.into_array().unwrap_or_default();
            let [Some(linear), Some(angular)] = pair.iter().map(number).collect::<Vec<_>>()[..] else {
                return self.wrong(self.call, format!("action {index} is not a pair of numbers"), "set here", form);
            };
            let within = |value: f64, most: f64| (-most..=most).contains(&value);
            if !within(linear, MAX_LINEAR) || !within(angular, MAX_ANGULAR) {
                let message = format!(
                    "action {index} is [{linear}, {angular}]: at most {MAX_LINEAR} m/s and {MAX_ANGULAR} rad/s, either way"
                );
                return self.wrong(self.call, message, "set here", form);
            }
            twists.push(Twist::new(linear, angular));
        }
        Ok(twists)
    }

    fn stages(&self, stages: Dynamic) -> Result<Vec<String>> {
        let form = "stages([\"search\", \"approach\"]);";
        let list = stages.into_array().unwrap_or_default();
        if !(2..=MAX_STAGES).contains(&list.len()) {
            let message = format!("there must be 2 to {MAX_STAGES} stages, found {}", list.len());
            return self.wrong(self.call, message, "set here", form);
        }
        let mut names: Vec<String> = Vec::new();
        for stage in list {
            let name = self.word(stage, form)?;
            if names.contains(&name) {
                return self.wrong(
                    self.call,
                    format!("there are two stages \"{}\"", printable(&name)),
                    "set here",
                    form,
                );
            }
            names.push(name);
        }
        Ok(names)
    }

    /// Where a key and its value stand in the map of the present call; the call itself if they are not written there.
    pub(super) fn entry(&self, key: &str) -> (Position, Position) {
        let entries = self.entries.get_or_init(|| entries(self.ast));
        entries.get(&(self.call, key.to_owned())).copied().unwrap_or((self.call, self.call))
    }
}

/// Where each key of each set-up call and its value stand.
fn entries(ast: &AST) -> Entries {
    let mut entries = Entries::new();
    let is_setup = |call: &FnCallExpr| SETUP.iter().any(|row| row.name == call.name);
    ast.walk(&mut |path: &[ASTNode<'_>]| {
        if let Some(ASTNode::Stmt(Stmt::FnCall(call, at)) | ASTNode::Expr(Expr::FnCall(call, at))) = path.last()
            && is_setup(call)
        {
            for argument in &call.args {
                let Expr::Map(map, _) = argument else { continue };
                for (ident, value) in &map.0 {
                    let place = (ident.pos, value.start_position());
                    entries.entry((*at, ident.name.to_string())).or_insert(place);
                }
            }
        }
        true
    });
    entries
}
