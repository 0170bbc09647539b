//! A script as far as it can be understood, with all that is wrong in it.

use super::behaviour::Behaviour;
use super::bodies::outline_of;
use super::compile::{Compiler, Vocabulary};
use super::named_body::{BodyFiles, beside};
use super::outline::ScriptOutline;
use super::own_doing::OwnDoing;
use super::params::{self, Declared, ParamValues};
use super::rules::{rules, stage};
use super::setup::{self, Log, SetUp};
use super::source::{self, Code};
use super::spoilt::Spoilt;
use super::state_parts::WrittenBins;
use super::success::FigureNames;
use super::syntax::{Forms, written_rules};
use super::tree::{Tree, tree};
use super::unread::Unread;
use super::{
    guards, is_key, known, measures, memory, names, parts, rehearsal, state_parts, stops, success, syntax, top_level,
    types, uses,
};
use crate::diagnostic::{Diagnostic, Mistakes, Result, SourceText, printable};
use crate::judge::Look;
use crate::judge::budget;
use crate::judge::compiled::CompiledScript;
use crate::judge::needs::Needs;
use crate::judge::rule::CompiledRule;
use crate::judge::sandbox;
use crate::judge::views::register_own;
use crate::settings::{Edition, PolicySettings, Settings};
use crate::verdict::{OwnWord, SuccessCondition};
use rhai::{AST, Engine, Module, Scope};
use std::path::Path;

/// A script as far as it is understood. What a mistake keeps from being understood is not in it.
#[derive(Debug)]
pub(crate) struct Draft {
    /// What is understood; to be learned only if there is no mistake.
    pub behaviour: Behaviour,
    /// All that is wrong.
    pub mistakes: Mistakes,
    /// Settings that are not what the script's author wrote.
    pub unread: Unread,
}

impl Draft {
    /// Loads a script with these values of its parameters and looks for mistakes in it.
    ///
    /// # Errors
    /// If nothing can be understood after a mistake: the file cannot be read as a script, or a limit stopped it.
    pub(crate) fn load(path: &Path, values: &ParamValues) -> Result<Self> {
        let name = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        let source = source::read(path)?;
        // Folders are named after it.
        if name.chars().all(|c| c == '.') {
            let message = format!("'{}' has no name but dots", printable(&path.display().to_string()));
            return Diagnostic::new("E-SCRIPT-FILE", message).help("rename the file: mine.rhai").fail();
        }
        Self::read(&name, source, &beside(path), values, Edition::NEWEST)
    }

    /// Looks for mistakes in a script's text; `name` is the behaviour's. `edition` is its own if it says none.
    ///
    /// # Errors
    /// As [`Draft::load`].
    pub(super) fn read(
        name: &str,
        source: SourceText,
        files: &BodyFiles<'_>,
        values: &ParamValues,
        edition: Edition,
    ) -> Result<Self> {
        let code = source::check_text(source)?;
        let mut mistakes = Mistakes::new(&code.source);
        match Self::understood(name, &code, (files, edition), values, &mut mistakes) {
            Ok((behaviour, unread)) => Ok(Self { behaviour, mistakes, unread }),
            Err(last) => Err(mistakes.ended_by(last)),
        }
    }

    /// The behaviour, with or without anything to learn.
    ///
    /// # Errors
    /// If there is a mistake.
    pub(super) fn end(self) -> Result<Behaviour> {
        self.mistakes.end().map(|()| self.behaviour)
    }

    /// This draft, unless there is nothing to learn in it and nothing else is wrong.
    ///
    /// # Errors
    /// `E-SCRIPT-EMPTY`.
    pub(crate) fn not_empty(self) -> Result<Self> {
        let is_empty = self.behaviour.rules().is_empty() && self.mistakes.is_empty();
        if is_empty { empty(self.behaviour.source()).fail() } else { Ok(self) }
    }

    fn understood(
        name: &str,
        code: &Code,
        defaults: (&BodyFiles<'_>, Edition),
        values: &ParamValues,
        mistakes: &mut Mistakes,
    ) -> std::result::Result<(Behaviour, Unread), Diagnostic> {
        let mut engine = sandbox::engine();
        syntax::register(&mut engine, Forms::of(code));
        is_key::allow(&mut engine, code);
        let log = Log::register(&mut engine);
        let tree = tree(&mut engine, code, mistakes)?;
        let mut needs = Needs::default();
        let mut spoilt = Spoilt::new(code, &tree);
        spoilt.spread(mistakes);
        let before = mistakes.count();
        code.views.check(code, &tree.known.variables, mistakes);
        let undefined = names::check_names(code, &tree, &spoilt, &mut needs, mistakes);
        undefined.into_iter().for_each(|name| spoilt.insert(name));
        memory::check_memory(code, &tree.ast, mistakes);
        types::check_types(code, &tree.ast, mistakes);
        if let Some(refused) = &tree.refused
            && mistakes.count() == before
        {
            return Err(Diagnostic::clone(refused));
        }
        let declared = Declared::register(&mut engine, &tree, values);
        let constants = top_level::run(&engine, code, &tree, &log, &mut spoilt, mistakes)?;
        let params = declared.finish(code, values, mistakes);
        // A variable whose statement a mistake spoils has no value.
        known::check_known(code, &tree.ast, &constants, mistakes);
        spoilt.spread(mistakes);
        let calls = spoilt.setup_calls(mistakes);
        let SetUp { settings, places, mut unread, bins, body, edition } =
            setup::finish(&log, code, &tree.ast, defaults, mistakes);
        calls.into_iter().for_each(|call| unread.all_of(call));
        engine.register_global_module(constants_module(&constants).into());
        budget::register_constants(&mut engine, &constants);
        let policies = (!unread.any_of("policy")).then_some(settings.policies.as_slice());
        let read = ReadScript { code, tree, engine, constants, settings: &settings, policies, needs, bins };
        let (compiled, outline, (success, own)) = read.compile(&mut spoilt, mistakes)?;
        let behaviour = Behaviour::new(name, settings, places, outline, compiled);
        let behaviour = behaviour.with_success(success, own).with_body(body).with_params(params).of_edition(edition);
        check_with_settings(&behaviour, &mut spoilt, &unread, mistakes)?;
        Ok((behaviour, unread))
    }
}

/// A script whose top level has run, with all that its rules are compiled from.
struct ReadScript<'a> {
    code: &'a Code,
    tree: Tree,
    engine: Engine,
    constants: Scope<'static>,
    settings: &'a Settings,
    /// The policies that it names; nothing if a call that names one is wrong.
    policies: Option<&'a [PolicySettings]>,
    needs: Needs,
    bins: Vec<WrittenBins>,
}

/// Its conditions of success, and which figures are its own word.
type OwnSuccess = (Vec<SuccessCondition>, OwnWord);

impl ReadScript<'_> {
    /// Measures, rules, success and functions, in this order: each may name what stands before it.
    fn compile(
        self,
        spoilt: &mut Spoilt<'_>,
        mistakes: &mut Mistakes,
    ) -> std::result::Result<(CompiledScript, ScriptOutline, OwnSuccess), Diagnostic> {
        let Self { code, tree, mut engine, constants, settings, policies, mut needs, bins } = self;
        let mut script = vocabulary(code, &tree, settings);
        check_stages(code, &needs, &script.stages, mistakes);
        measures::check_windows(code, &tree.ast, &script.rules, &script.own, mistakes);
        let mut compiler = Compiler { constants: &constants, needs: &mut needs, script: &mut script };
        measures::measures(code, &tree.ast, &tree.known.variables, &mut compiler, spoilt, mistakes);
        let bins = state_parts::bins(code, &tree.ast, &bins, &mut compiler, spoilt, mistakes);
        let rules = rules(code, &tree.ast, &mut compiler, spoilt, mistakes);
        let guards = guards::guards(code, &tree.ast, &mut compiler, spoilt, mistakes);
        let written_uses = uses::count(&tree.ast, Forms::of(code));
        let uses = uses::uses(code, &tree.ast, policies, &mut compiler, spoilt, mistakes);
        let names = figure_names(code, &tree, settings, &rules);
        let own_word = names.own_word;
        let success = (success::conditions(code, &tree.ast, &constants, &names, spoilt, mistakes), own_word);
        let function = |name| if has_function(&tree.ast, name) { code.function(name) } else { None };
        let (reward, calibrate) = (function("reward"), function("calibrate"));
        let mut compiler = Compiler { constants: &constants, needs: &mut needs, script: &mut script };
        let reward_parts =
            reward.as_ref().map_or_else(Vec::new, |span| parts::function_parts(code, &tree.ast, span, &mut compiler));
        let Vocabulary { remembered, views, stages, .. } = script;
        let measures: Vec<&str> = tree.known.measures.iter().map(String::as_str).collect();
        register_own(&mut engine, &measures, &views, &stages);
        let outline = match mistakes.is_empty() {
            true => outline_of(code, &tree.ast, &constants, &rules),
            false => ScriptOutline::default(),
        };
        let (source, stops, ast) = (code.source.clone(), stops::stop_places(&tree.ast), tree.ast);
        let reads_views = views.iter().any(|view| code.names_besides_calls(view));
        let reads = |word: &str| code.names(word) && !code.defines(word);
        let (counts_way, looks_back) = (reads("odometry") || reads("stage"), reads("previous"));
        let compiled = CompiledScript {
            source,
            engine,
            ast,
            constants,
            rules,
            looks: looks(&needs, views.len()),
            guards,
            uses,
            written_uses,
            needs,
            remembered,
            views,
            bins,
            stages,
            counts_way,
            reads_ground: reads("ground"),
            reads_views,
            looks_back,
            reward,
            reward_parts,
            calibrate,
            stops,
        };
        Ok((compiled, outline, success))
    }
}

impl Behaviour {
    /// Loads a script and checks it.
    ///
    /// # Errors
    /// If the file cannot be read as a script, or anything in it is wrong: each mistake in the user's own line, with what
    /// to write.
    pub fn load(path: &Path) -> Result<Self> {
        Draft::load(path, &ParamValues::new())?.not_empty()?.end()
    }

    /// Loads a script that need not say what is learned: for whoever looks through its filters.
    ///
    /// # Errors
    /// As [`Behaviour::load`], but for a script without rules.
    pub(crate) fn load_to_look(path: &Path, values: &ParamValues) -> Result<Self> {
        Draft::load(path, values)?.end()
    }

    /// Loads a script from its text; `name` is the behaviour's. Of bodies it knows those that ship.
    ///
    /// # Errors
    /// If anything in it is wrong.
    pub fn parse(name: &str, source: SourceText) -> Result<Self> {
        Self::parse_with(name, source, &|_| Ok(None), &ParamValues::new())
    }

    /// Loads a script from its text, with `bodies` before those that ship, and with these values of its parameters.
    ///
    /// # Errors
    /// If anything in it, or in the file of its body, is wrong, or a value is none of its parameters or out of range.
    pub fn parse_with(name: &str, source: SourceText, bodies: &BodyFiles<'_>, values: &ParamValues) -> Result<Self> {
        Self::parse_in(Edition::NEWEST, name, source, bodies, values)
    }

    /// As [`Behaviour::parse_with`], a script that has the defaults of `edition` if it says none.
    ///
    /// # Errors
    /// As [`Behaviour::parse_with`].
    pub fn parse_in(
        edition: Edition,
        name: &str,
        source: SourceText,
        bodies: &BodyFiles<'_>,
        values: &ParamValues,
    ) -> Result<Self> {
        let behaviour = Draft::read(name, source, bodies, values, edition)?.not_empty()?.end()?;
        params::check_values(behaviour.params(), values).map(|()| behaviour)
    }

    /// This script with other values of its parameters; those that are not named keep theirs.
    ///
    /// # Errors
    /// As [`Behaviour::parse_with`].
    pub fn with_values(&self, values: &ParamValues) -> Result<Self> {
        let mut all = self.param_values();
        all.extend(values.clone());
        let body = self.body().cloned();
        Self::parse_in(self.edition(), self.name(), self.source().clone(), &|_| Ok(body.clone()), &all)
    }
}

/// Beams, cells, rules that never fire, and a rehearsal: as far as the settings that these depend on are known.
fn check_with_settings(
    behaviour: &Behaviour,
    spoilt: &mut Spoilt<'_>,
    unread: &Unread,
    mistakes: &mut Mistakes,
) -> std::result::Result<(), Diagnostic> {
    let (settings @ Settings { run, laser, .. }, compiled) = (behaviour.settings(), behaviour.compiled());
    let (fan, seen) = (laser.fan(), !unread.has("laser", "beams") && !unread.has("laser", "field_of_view_deg"));
    if seen {
        mistakes.take(compiled.check_beams(fan));
    }
    if !unread.has("grid", "rows") && !unread.has("grid", "columns") && !unread.any_of("view") {
        // A view that could not be read has any cell.
        mistakes.take(compiled.check_cells(|view| {
            let grid = settings.views().nth(view).map(|view| &view.grid);
            grid.map_or((usize::MAX, usize::MAX), |grid| (grid.rows as usize, grid.columns as usize))
        }));
    }
    if !unread.any_of("actions") {
        mistakes.take(behaviour.check_guards(&behaviour.settings().actions));
    }
    if !unread.any_of("laser") {
        behaviour.find_unreachable(laser, f64::INFINITY, mistakes);
    }
    // Rules that name beams of another laser cannot be tried.
    if !seen && compiled.check_beams(fan).is_err() {
        return Ok(());
    }
    spoilt.spread(mistakes);
    let judge = behaviour.unchecked_judge(run.period_s, fan);
    rehearsal::rehearse(judge, behaviour.settings(), spoilt, mistakes).map_err(|last| *last)
}

/// What a script names besides facts and constants.
fn vocabulary(code: &Code, tree: &Tree, settings: &Settings) -> Vocabulary {
    let written = written_rules(tree.ast.statements());
    let rules = written.iter().map(|rule| rule.name.to_owned());
    Vocabulary {
        rules: rules.chain(has_function(&tree.ast, "reward").then(|| "reward".to_owned())).collect(),
        views: code.views.all(),
        stages: settings.stages.clone(),
        own: tree.ast.iter_functions().map(|function| function.name.to_owned()).collect(),
        ..Vocabulary::default()
    }
}

/// What figures of a test may be asked for by name.
fn figure_names<'a>(code: &Code, tree: &'a Tree, settings: &'a Settings, rules: &'a [CompiledRule]) -> FigureNames<'a> {
    let reward_name = has_function(&tree.ast, "reward").then_some("reward");
    let own_doing = OwnDoing::of(tree.ast.statements(), &|name| code.views.group_of(name).is_some());
    FigureNames {
        own_word: own_doing.word(rules, reward_name.is_some()),
        rules: rules.iter().map(|rule| rule.text.name.as_str()).chain(reward_name).collect(),
        stages: settings.stages.iter().map(String::as_str).collect(),
        measures: tree.known.measures.iter().map(String::as_str).collect(),
        own_doing,
    }
}

/// What is read of each view besides its grid.
fn looks(needs: &Needs, views: usize) -> Vec<Look> {
    (0..views).map(|view| needs.looks.get(view).copied().unwrap_or_default()).collect()
}

/// Checks that every stage that is named exists.
fn check_stages(code: &Code, needs: &Needs, stages: &[String], mistakes: &mut Mistakes) {
    for (name, at) in &needs.stages {
        stage(code, (name, *at), stages, mistakes);
    }
}

fn constants_module(constants: &Scope<'_>) -> Module {
    let mut module = Module::new();
    for (name, _, value) in constants.iter() {
        module.set_var(name, value);
    }
    module
}

fn has_function(ast: &AST, name: &str) -> bool {
    ast.iter_functions().any(|function| function.name == name)
}

fn empty(source: &SourceText) -> Diagnostic {
    let path = printable(&source.path.display().to_string());
    let message = format!("'{path}' has neither a rule nor 'fn reward': nothing could be learned");
    Diagnostic::new("E-SCRIPT-EMPTY", message)
        .help("write a rule: rule \"too close\" when laser.nearest < 0.25 => -1 then recover;")
}
