//! The set-up calls at the top of a script: written down while it runs, then turned into settings.

use super::named_body::{BodyFiles, NamedBody};
use super::setup_table::SETUP;
use super::source::Code;
use super::state_parts::WrittenBins;
use super::unread::Unread;
use crate::diagnostic::{Diagnostic, Mistakes, Result, SourceText, printable};
use crate::judge::explain;
use crate::judge::views::number;
use crate::settings::{self, CONDITION, Edition, PolicySettings, RecoverTo, Settings, Value};
use rhai::{AST, ASTNode, Dynamic, Engine, Expr, FnCallExpr, Map, Position, Stmt};
use std::any::TypeId;
use std::cell::OnceCell;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

/// Most set-up calls in one script.
const MAX_CALLS: usize = 256;
/// Most arguments of one call: a view's name, its filters and its grid.
const MAX_ARGUMENTS: usize = 10;

/// A set-up call as it was carried out.
#[derive(Debug)]
pub(super) struct Call {
    pub name: &'static str,
    pub arguments: Vec<Dynamic>,
    pub position: Position,
}

/// What a call gives back, so that another can be about it: its number in the log.
#[derive(Debug, Clone, Copy)]
pub(super) struct CallToken(pub usize);

/// What the script called while its top level ran.
#[derive(Debug, Clone)]
pub(super) struct Log(Arc<Mutex<(bool, Vec<Call>)>>);

impl Log {
    /// A log that is written until it is closed, and the calls that write it.
    pub(super) fn register(engine: &mut Engine) -> Self {
        let log = Self(Arc::new(Mutex::new((true, Vec::new()))));
        // A parameter is a value, not a setting.
        for row in SETUP.iter().filter(|row| row.name != "param") {
            for count in 0..=MAX_ARGUMENTS {
                let (log, name) = (log.clone(), row.name);
                engine.register_raw_fn(name, vec![TypeId::of::<Dynamic>(); count], move |context, arguments| {
                    let arguments = arguments.iter().map(|argument| (**argument).clone()).collect();
                    log.write(name, context.call_position(), arguments)
                });
            }
        }
        log
    }

    fn write(
        &self,
        name: &'static str,
        position: Position,
        arguments: Vec<Dynamic>,
    ) -> std::result::Result<Dynamic, Box<rhai::EvalAltResult>> {
        let mut log = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let fault = match &*log {
            (false, _) => format!("'{name}' sets up: it belongs at the top of the script, not into a function"),
            (true, calls) if calls.len() >= MAX_CALLS => format!("more than {MAX_CALLS} set-up calls"),
            _ => {
                log.1.push(Call { name, arguments, position });
                return Ok(Dynamic::from(CallToken(log.1.len() - 1)));
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
    /// The values of the script that its states tell apart.
    pub bins: Vec<WrittenBins>,
    /// The file of the body that is named.
    pub body: Option<SourceText>,
    /// The edition whose defaults these are.
    pub edition: Edition,
}

/// Ends the set-up: the settings that the calls make, over the defaults of the body that
/// it names in `files`, or of the edition: the one that it says, else `edition`. Every call that is wrong is added to `mistakes`,
/// with its place: an unknown key, a value out of range, a setting made twice.
pub(super) fn finish(
    log: &Log,
    code: &Code,
    ast: &AST,
    (files, mut edition): (&BodyFiles<'_>, Edition),
    mistakes: &mut Mistakes,
) -> SetUp {
    let (settings, places, unread) = (Settings::default(), SettingPlaces::new(), Unread::default());
    let (call, entries, bins) = (Position::NONE, OnceCell::new(), Vec::new());
    let body = None;
    let mut setup = SetupReader { code, ast, settings, places, unread, mistakes, call, entries, bins, body };
    let mut calls = log.close();
    // It stays in its place for now: views know what belongs to them by the number of the call.
    for call in calls.iter().filter(|call| call.name == "edition") {
        match setup.edition(call) {
            Ok(said) => edition = said,
            Err(wrong) => setup.mistakes.add(*wrong),
        }
    }
    setup.settings = Settings::of_edition(edition);
    for call in calls.iter().filter(|call| call.name == "robot") {
        setup.call = call.position;
        let named = call.arguments.first().filter(|name| name.is_string() && call.arguments.len() < 3);
        let form = SETUP.iter().find(|row| row.name == "robot").map_or("", |row| row.form);
        if let Some(Err(wrong)) = named.map(|name| setup.body(name.clone(), form, files)) {
            setup.mistakes.add(*wrong);
            ["robot", "camera", "laser", "actions"].iter().for_each(|group| setup.unread.all_of(group));
        }
    }
    setup.views(&mut calls);
    for call in calls.into_iter().filter(|call| call.name != "edition") {
        setup.call = call.position;
        if let Err(wrong) = setup.apply(call.name, call.arguments) {
            setup.mistakes.add(*wrong);
            setup.unread.all_of(call.name);
        }
    }
    // Of a list with mistakes the other actions are looked at all the same.
    let listed = !setup.unread.any_of("actions") || setup.places.contains_key("actions");
    if !setup.unread.any_of("robot") && listed {
        setup.check_actions();
    }
    let SetupReader { settings, places, unread, bins, body, .. } = setup;
    SetUp { settings, places, unread, bins, body: body.map(|body| body.source), edition }
}

/// Where keys and their values stand, by call and key.
type Entries = BTreeMap<(Position, String), (Position, Position)>;

pub(super) struct SetupReader<'a> {
    pub(super) code: &'a Code,
    pub(super) ast: &'a AST,
    pub(super) settings: Settings,
    pub(super) places: SettingPlaces,
    pub(super) unread: Unread,
    pub(super) mistakes: &'a mut Mistakes,
    /// Where the present call stands.
    pub(super) call: Position,
    entries: OnceCell<Entries>,
    pub(super) bins: Vec<WrittenBins>,
    pub(super) body: Option<NamedBody>,
}

impl SetupReader<'_> {
    fn apply(&mut self, name: &'static str, arguments: Vec<Dynamic>) -> Result<()> {
        let form = SETUP.iter().find(|row| row.name == name).map_or("", |row| row.form);
        let mut arguments = arguments.into_iter();
        let (first, second) = (arguments.next(), arguments.next());
        match (name, first, second, arguments.next()) {
            ("world", Some(world), None, None) if world.is_string() => {
                self.settings.world = self.word(world, form)?;
                self.mark("world".to_owned(), self.call)?;
                self.check_worlds_alone(form)
            }
            ("worlds", Some(list), None, None) if list.is_array() || list.is_map() => self.worlds(list, form),
            ("randomise", Some(map), None, None) if map.is_map() => self.randomise(map.cast::<Map>(), form),
            ("filter", Some(filter), parameters, None) if filter.is_string() => {
                self.in_unnamed_view(|setup, view| setup.filter(view, filter, parameters, form))
            }
            ("state", first, second, third) => {
                self.state(first.into_iter().chain(second).chain(third).chain(arguments))
            }
            ("actions", Some(actions), None, None) if actions.is_array() => self.actions(actions),
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
            // The body itself is read before any setting.
            ("robot", Some(name), map, None) if name.is_string() => {
                map.map_or(Ok(()), |map| self.group("robot", map, form))
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
                if !matches!(
                    group,
                    "world" | "worlds" | "randomise" | "filter" | "view" | "actions" | "stages" | "starts" | "policy"
                ) =>
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

    pub(super) fn mark(&mut self, setting: String, position: Position) -> Result<()> {
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

    pub(super) fn group(&mut self, group: &'static str, map: Dynamic, form: &str) -> Result<()> {
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
    pub(super) fn tell(&mut self, group: &'static str, key: &str, result: Result<()>) {
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
            if let ("filter", [_, condition]) = (call.name.as_str(), call.args.as_slice()) {
                entries.insert((*at, CONDITION.to_owned()), (condition.start_position(), condition.start_position()));
            }
            for argument in &call.args {
                // What stands in a list has its number for a key.
                if let ("worlds", Expr::Array(list, _)) = (call.name.as_str(), argument) {
                    for (number, value) in list.iter().enumerate() {
                        entries.insert((*at, format!("#{number}")), (value.start_position(), value.start_position()));
                    }
                }
                let Expr::Map(map, _) = argument else { continue };
                for (ident, value) in &map.0 {
                    let place = (ident.pos, value.start_position());
                    entries.insert((*at, ident.name.to_string()), place);
                }
            }
        }
        true
    });
    entries
}
