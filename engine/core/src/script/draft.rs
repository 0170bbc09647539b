//! A script as far as it can be understood, with all that is wrong in it.

use super::behaviour::Behaviour;
use super::compile::Compiler;
use super::outline::Outline;
use super::setup::{self, Log, SetUp};
use super::source::{self, Code};
use super::spoilt::Spoilt;
use super::tree::{Known, Tree, tree};
use super::unread::Unread;
use super::{names, parts, rehearsal, rule, syntax, top_level};
use crate::diagnostic::{Diagnostic, Mistakes, Result, SourceText, printable};
use crate::judge::loaded::Loaded;
use crate::judge::needs::Needs;
use crate::judge::rule::Rule;
use crate::judge::{explain, sandbox};
use crate::settings::Settings;
use rhai::{AST, Module, Scope};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::Path;

/// A script as far as it is understood. What a mistake keeps from being understood is not in it.
#[derive(Debug)]
pub struct Draft {
    /// What is understood; to be learned only if there is no mistake.
    pub behaviour: Behaviour,
    /// All that is wrong.
    pub mistakes: Mistakes,
    /// Settings that are not what the script's author wrote.
    pub unread: Unread,
}

impl Draft {
    /// Loads a script and looks for mistakes in it.
    ///
    /// # Errors
    /// If nothing can be understood after a mistake: the file cannot be read as a script, or a limit stopped it.
    pub fn load(path: &Path) -> Result<Self> {
        let name = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        Self::read(&name, source::read(path)?)
    }

    /// The same from a text.
    ///
    /// # Errors
    /// As [`Draft::load`].
    pub fn read(name: &str, source: SourceText) -> Result<Self> {
        let code = source::check(source)?;
        let mut mistakes = Mistakes::new(&code.source);
        match Self::understood(name, code, &mut mistakes) {
            Ok((behaviour, unread)) => Ok(Self { behaviour, mistakes, unread }),
            Err(last) => Err(mistakes.ended_by(last)),
        }
    }

    /// The behaviour.
    ///
    /// # Errors
    /// If there is a mistake.
    pub fn end(self) -> Result<Behaviour> {
        self.mistakes.end().map(|()| self.behaviour)
    }

    fn understood(
        name: &str,
        code: Code,
        mistakes: &mut Mistakes,
    ) -> std::result::Result<(Behaviour, Unread), Diagnostic> {
        let mut engine = sandbox::engine();
        syntax::register(&mut engine);
        let log = Log::register(&mut engine);
        let tree = tree(&mut engine, &code, mistakes)?;
        let mut needs = Needs::default();
        let spoilt = Spoilt::new(&code, &tree.ast, &tree.known, &BTreeSet::new(), mistakes);
        let before = mistakes.count();
        let undefined = names::check(&code, &tree, &spoilt, &mut needs, mistakes);
        if let Some(refused) = &tree.refused
            && mistakes.count() == before
        {
            return Err(Diagnostic::clone(refused));
        }
        let constants = top_level::run(&engine, &code, &tree, &log, &undefined, mistakes)?;
        let spoilt = Spoilt::new(&code, &tree.ast, &tree.known, &undefined, mistakes);
        let calls = spoilt.setup_calls(&code, mistakes);
        let SetUp { settings, places, mut unread } = setup::finish(&log, &code, &tree.ast, mistakes);
        calls.into_iter().for_each(|call| unread.all_of(call));
        engine.register_global_module(constants_module(&constants).into());
        let rules = rules(&code, &tree.ast, &constants, &mut needs, &spoilt, mistakes);
        let function = |name| if has_function(&tree.ast, name) { code.function(name) } else { None };
        let (reward, calibrate) = (function("reward"), function("calibrate"));
        if rules.is_empty() && reward.is_none() && mistakes.is_empty() {
            return Err(empty(&code));
        }
        let parts = |span: &Range<usize>, needs: &mut Needs| {
            parts::function_parts(&code, &tree.ast, span, &mut Compiler { constants: &constants, needs })
        };
        let reward_parts = reward.as_ref().map_or_else(Vec::new, |span| parts(span, &mut needs));
        let outline = match mistakes.is_empty() {
            true => Outline::new(&code, &tree.ast, &constants, &rules),
            false => Outline::default(),
        };
        let Tree { ast, known, .. } = tree;
        let source = code.source.clone();
        let loaded = Loaded { source, engine, ast, constants, rules, needs, reward, reward_parts, calibrate };
        let behaviour = Behaviour::new(name, settings, places, outline, loaded);
        check(&code, &behaviour, &known, &undefined, &unread, mistakes)?;
        Ok((behaviour, unread))
    }
}

/// Beams, cells, rules that never fire, and a rehearsal: as far as the settings that these depend on are known.
fn check(
    code: &Code,
    behaviour: &Behaviour,
    known: &Known,
    undefined: &BTreeSet<String>,
    unread: &Unread,
    mistakes: &mut Mistakes,
) -> std::result::Result<(), Diagnostic> {
    let (Settings { run, laser, grid, .. }, loaded) = (behaviour.settings(), behaviour.loaded());
    let beams = laser.beams as usize;
    if !unread.has("laser", "beams") {
        mistakes.take(loaded.check_beams(beams));
    }
    if !unread.has("grid", "rows") && !unread.has("grid", "columns") {
        mistakes.take(loaded.check_cells((grid.rows as usize, grid.columns as usize)));
    }
    if !unread.any_of("laser") {
        behaviour.find_unreachable(laser, f64::INFINITY, mistakes);
    }
    // Rules that name beams of another laser cannot be tried.
    if unread.has("laser", "beams") && loaded.check_beams(beams).is_err() {
        return Ok(());
    }
    let mut spoilt = Spoilt::new(code, &loaded.ast, known, undefined, mistakes);
    let judge = behaviour.unchecked_judge(run.period_s, beams);
    rehearsal::rehearse(judge, code, behaviour.settings(), &mut spoilt, mistakes).map_err(|last| *last)
}

fn constants_module(constants: &Scope<'_>) -> Module {
    let mut module = Module::new();
    for (name, _, value) in constants.iter() {
        module.set_var(name, value);
    }
    module
}

fn rules(
    code: &Code,
    ast: &AST,
    constants: &Scope<'static>,
    needs: &mut Needs,
    spoilt: &Spoilt,
    mistakes: &mut Mistakes,
) -> Vec<Rule> {
    let mut rules: Vec<Rule> = Vec::new();
    let mut lines: BTreeMap<&str, usize> = BTreeMap::new();
    let mut compiler = Compiler { constants, needs };
    let has_reward = has_function(ast, "reward");
    let written = syntax::written_rules(ast.statements());
    for written in &written {
        let name_at = |message: String, label: &str| {
            explain::mistake(&code.source, "E-SCRIPT-RULE", written.name_position, message, label)
        };
        let (line, _) = code.source.position(explain::offset(&code.source, written.position));
        if let Some(before) = lines.get(written.name) {
            let wrong =
                name_at(format!("there are two rules called \"{}\"", printable(written.name)), "the second one");
            mistakes.add(wrong.help(format!("choose another name; the first is in line {before}")));
        } else if written.name == "reward" && has_reward {
            mistakes.add(name_at("a rule cannot be called \"reward\" beside 'fn reward'".to_owned(), "here"));
        }
        lines.entry(written.name).or_insert(line);
        rules.extend(rule::compiled(code, written, ast.shared_lib(), &mut compiler, spoilt, mistakes));
    }
    rules
}

fn has_function(ast: &AST, name: &str) -> bool {
    ast.iter_functions().any(|function| function.name == name)
}

fn empty(code: &Code) -> Diagnostic {
    let path = printable(&code.source.path.display().to_string());
    let message = format!("'{path}' has neither a rule nor 'fn reward': nothing could be learned");
    Diagnostic::new("E-SCRIPT-EMPTY", message)
        .help("write a rule: rule \"too close\" when laser.nearest < 0.25 => -1 then recover;")
}
