//! A script, loaded and checked.

use super::compile::{Compiler, Needs};
use super::explain;
use super::expression::Number;
use super::fact_table::GROUPS;
use super::judge::Judge;
use super::outline::Outline;
use super::readings::{self, Part};
use super::rule::{Clause, Rule, RuleText};
use super::setup::{self, Log, Places};
use super::source::{self, Code};
use super::{names, reach, rehearsal, running, sandbox, syntax};
use crate::diagnostic::{Diagnostic, Kind, Result, SourceText, printable};
use crate::settings::{LaserSettings, Settings};
use rhai::{AST, Dynamic, Engine, Module, Position, Scope, Stmt};
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

/// A script, loaded and checked; shared by all seeds.
#[derive(Debug)]
pub struct Behaviour {
    name: String,
    settings: Settings,
    places: Places,
    rules: Vec<RuleText>,
    outline: Outline,
    loaded: Arc<Loaded>,
}

/// What judging needs of a script.
#[derive(Debug)]
pub(super) struct Loaded {
    pub code: Code,
    pub engine: Engine,
    pub ast: AST,
    pub constants: Scope<'static>,
    pub rules: Vec<Rule>,
    pub needs: Needs,
    /// Where the name of `fn reward` stands, if there is one.
    pub reward: Option<Range<usize>>,
    /// What `fn reward` reads.
    pub reward_parts: Vec<Part>,
    /// Where the name of `fn calibrate` stands, if there is one.
    pub calibrate: Option<Range<usize>>,
}

impl Behaviour {
    /// Loads a script and checks it.
    ///
    /// # Errors
    /// If the file cannot be read as a script, or anything in it is wrong: in the user's own line, with what to write.
    pub fn load(path: &Path) -> Result<Self> {
        let name = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        Self::parse(&name, source::read(path)?)
    }

    /// The same from a text.
    ///
    /// # Errors
    /// If anything in it is wrong.
    pub fn parse(name: &str, source: SourceText) -> Result<Self> {
        let code = source::check(source)?;
        let mut engine = sandbox::engine();
        let log = Log::register(&mut engine);
        let ast = tree(&mut engine, &code)?;
        let mut needs = Needs::default();
        names::check(&code, &ast, &mut needs)?;
        let mut constants = Scope::new();
        let ran = engine.run_ast_with_scope(&mut constants, &ast);
        ran.map_err(|error| Box::new(running::explain(&code.source, &error)))?;
        let (settings, places) = setup::finish(&log, &code, &ast)?;
        engine.register_global_module(constants_module(&constants).into());
        let rules = rules(&code, &ast, &constants, &mut needs)?;
        let function = |name| if has_function(&ast, name) { code.function(name) } else { None };
        let (reward, calibrate) = (function("reward"), function("calibrate"));
        if rules.is_empty() && reward.is_none() {
            return empty(&code).into();
        }
        let mut texts: Vec<RuleText> = rules.iter().map(|rule| rule.text.clone()).collect();
        texts.extend(reward.clone().map(|span| {
            let (line, _) = code.source.position(span.start);
            let text = code.source.text[code.source.line_range(line)].trim().to_owned();
            RuleText { name: "reward".to_owned(), line, text }
        }));
        let mut compiler = Compiler { constants: &constants, needs: &mut needs };
        let parts = |span| readings::function_parts(&code, &ast, span, &mut compiler);
        let reward_parts = reward.as_ref().map_or_else(Vec::new, parts);
        let outline = Outline::new(&code, &ast, &constants, &rules);
        let loaded = Arc::new(Loaded { code, engine, ast, constants, rules, needs, reward, reward_parts, calibrate });
        let behaviour = Self { name: name.to_owned(), settings, places, rules: texts, outline, loaded };
        behaviour.check()?;
        Ok(behaviour)
    }

    fn check(&self) -> Result<()> {
        let Settings { run, laser, grid, .. } = &self.settings;
        self.loaded.check_beams(laser.beams as usize)?;
        self.loaded.check_cells((grid.rows as usize, grid.columns as usize))?;
        self.check_reach(laser, f64::INFINITY)?;
        rehearsal::rehearse(self.judge(run.period_s, laser.beams as usize)?, &self.settings)
    }

    /// Checks that every rule can fire with this laser, on a floor at most `drop_m` metres below the robot's own ground;
    /// infinite where that is not known.
    ///
    /// # Errors
    /// `E-SCRIPT-RULE` at the condition of the first rule that never can.
    pub fn check_reach(&self, laser: &LaserSettings, drop_m: f64) -> Result<()> {
        let limits = reach::Limits::new(laser, drop_m);
        self.loaded.rules.iter().try_for_each(|rule| reach::check(&self.loaded.code.source, rule, &limits))
    }

    /// The name: the file's, without its ending.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The text.
    #[must_use]
    pub fn source(&self) -> &SourceText {
        &self.loaded.code.source
    }

    /// What the set-up calls said, over the defaults.
    #[must_use]
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Where a setting was set: `world`, `actions`, `filter:0`, `filter:0.threshold`, `camera.tilt_deg`.
    #[must_use]
    pub fn place_of(&self, setting: &str) -> Option<Range<usize>> {
        self.places.get(setting).cloned()
    }

    /// The rules in their order, and last `reward` if the script has `fn reward`.
    #[must_use]
    pub fn rules(&self) -> &[RuleText] {
        &self.rules
    }

    /// What it says, for whoever looks for mistakes in it.
    #[must_use]
    pub fn outline(&self) -> &Outline {
        &self.outline
    }

    /// What a rule adds whenever it fires; nothing if that depends on the step, as with `fn reward`.
    #[must_use]
    pub fn fixed_value(&self, rule: usize) -> Option<f64> {
        match self.loaded.rules.get(rule)?.value {
            Clause::Native(Number::Constant(value)) => Some(value),
            _ => None,
        }
    }

    /// A judge with fresh counters, for one seed; `period_s` is the time between two steps, in seconds.
    ///
    /// # Errors
    /// If a rule names a beam that a laser with `beams` beams does not have.
    pub fn judge(&self, period_s: f64, beams: usize) -> Result<Judge> {
        self.loaded.check_beams(beams)?;
        Ok(Judge::new(Arc::clone(&self.loaded), period_s, beams))
    }
}

impl Loaded {
    fn check_beams(&self, beams: usize) -> Result<()> {
        let source = &self.code.source;
        let outside = |beam: i64| usize::try_from(beam).map_or(true, |beam| beam >= beams);
        let Some((beam, position)) = self.needs.beams.iter().find(|(beam, _)| outside(*beam)) else {
            return Ok(());
        };
        let message = format!("beam numbers run from 0 to {}", beams.saturating_sub(1));
        explain::mistake(source, "E-SCRIPT-FACT", *position, message, format!("found {beam}")).into()
    }

    /// Checks that every grid cell that is named exists.
    ///
    /// # Errors
    /// For the first that does not.
    pub(super) fn check_cells(&self, (rows, columns): (usize, usize)) -> Result<()> {
        let outside = |number: i64, count: usize| usize::try_from(number).map_or(true, |number| number >= count);
        for (row, column, position) in &self.needs.cells {
            if outside(*row, rows) || outside(*column, columns) {
                let message = format!(
                    "the grid has rows 0 to {} and columns 0 to {}",
                    rows.saturating_sub(1),
                    columns.saturating_sub(1)
                );
                let found = format!("found row {row}, column {column}");
                return explain::mistake(&self.code.source, "E-SCRIPT-FACT", *position, message, found).into();
            }
        }
        Ok(())
    }
}

/// The script's tree. Functions see the names of top-level variables as constants, so those are collected first.
fn tree(engine: &mut Engine, code: &Code) -> Result<AST> {
    let names = |ast: &AST| -> Vec<(String, Position)> {
        let variables = ast.statements().iter().filter_map(|statement| match statement {
            Stmt::Var(variable, ..) => Some((variable.0.name.to_string(), variable.0.pos)),
            _ => None,
        });
        variables.collect()
    };
    engine.set_strict_variables(false);
    let first = engine.compile(&code.parsed);
    engine.set_strict_variables(true);
    let own = match &first {
        Ok(ast) => names(ast),
        Err(error) => return explain::syntax(&code.source, error, &[]).into(),
    };
    let mut known = Scope::new();
    for name in GROUPS.iter().map(|(group, _)| *group).chain(["facts", "calibrated"]) {
        known.push(name, ());
    }
    for (name, _) in &own {
        known.push(name.as_str(), ());
    }
    let own: Vec<String> = own.into_iter().map(|(name, _)| name).collect();
    engine
        .compile_with_scope(&known, &code.parsed)
        .map_err(|error| Box::new(explain::syntax(&code.source, &error, &own)))
}

fn constants_module(constants: &Scope<'_>) -> Module {
    let mut module = Module::new();
    for (name, _, value) in constants.iter() {
        module.set_var(name, value);
    }
    module
}

fn rules(code: &Code, ast: &AST, constants: &Scope<'static>, needs: &mut Needs) -> Result<Vec<Rule>> {
    let mut rules: Vec<Rule> = Vec::new();
    let mut compiler = Compiler { constants, needs };
    for written in syntax::written_rules(ast.statements()) {
        let rule = Rule::new(code, &written, ast.shared_lib(), &mut compiler)?;
        if let Some(before) = rules.iter().find(|known| known.text.name == rule.text.name) {
            let message = format!("there are two rules called \"{}\"", printable(written.name));
            let help = format!("choose another name; the first is in line {}", before.text.line);
            let wrong =
                explain::mistake(&code.source, "E-SCRIPT-RULE", written.name_position, message, "the second one");
            return wrong.help(help).into();
        }
        if rule.text.name == "reward" && has_function(ast, "reward") {
            let message = "a rule cannot be called \"reward\" beside 'fn reward'";
            return explain::mistake(&code.source, "E-SCRIPT-RULE", written.name_position, message, "here").into();
        }
        rules.push(rule);
    }
    Ok(rules)
}

fn has_function(ast: &AST, name: &str) -> bool {
    ast.iter_functions().any(|function| function.name == name)
}

fn empty(code: &Code) -> Diagnostic {
    let path = printable(&code.source.path.display().to_string());
    let message = format!("'{path}' has neither a rule nor 'fn reward': nothing could be learned");
    Diagnostic::new(Kind::Input, "E-SCRIPT-EMPTY", message)
        .help("write a rule: rule \"too close\" when laser.nearest < 0.25 => -1 then recover;")
}

/// The value of one top-level variable.
pub(super) fn variable(constants: &Scope<'_>, index: usize) -> Option<(String, Dynamic)> {
    constants.iter().nth(index).map(|(name, _, value)| (name.to_owned(), value))
}
