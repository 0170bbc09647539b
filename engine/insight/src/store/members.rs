//! The policies that a script names: found, read and checked before anything runs.

use std::path::{Path, PathBuf};

use super::parts::{RUN_FILE, check_policy_of_file};
use super::policy_file::StoredPolicy;
use super::{read_stored, used};
use engine::diagnostic::{Diagnostic, Result, SourceText, printable};
use engine::experiment::{Member, Plan};

/// What is stored of a policy.
#[derive(Debug, Clone)]
pub struct PolicyText {
    /// Its `policy.toml`.
    pub policy: SourceText,
    /// The `run.toml` beside it, which says what robot and script it is of; nothing if there is none.
    pub run: Option<SourceText>,
}

impl PolicyText {
    /// A policy with nothing beside it.
    #[must_use]
    pub fn alone(policy: SourceText) -> Self {
        Self { policy, run: None }
    }
}

/// The plan with every policy that its script names, in its order; the plan itself if it learns.
///
/// # Errors
/// If one is missing or damaged, or was learned with another grid shape or other actions; each points at its call.
pub fn with_policies(plan: Plan) -> Result<Plan> {
    with_policies_or(plan, &|_| Ok(None))
}

/// As [`with_policies`]; `packed` gives what stands in a pack, by the path of its file or by its name where there is no file.
///
/// # Errors
/// As [`with_policies`], and those of `packed`.
pub fn with_policies_or(plan: Plan, packed: &dyn Fn(&Path) -> Result<Option<PolicyText>>) -> Result<Plan> {
    let policies = plan.settings.policies.iter().enumerate();
    let texts: Vec<_> = policies.map(|(index, policy)| find(&plan, index, &policy.path, packed)).collect();
    if texts.iter().all(Result::is_ok) {
        return with_policy_texts(plan, texts.into_iter().collect::<Result<_>>()?);
    }
    // Of those that are there, what is wrong with them too.
    let read = |index: usize, text: PolicyText| match plan.behaviour.hands_over() {
        true => used::used(&plan, index, text).map(drop),
        false => member(&plan, index, &text.policy).map(drop),
    };
    all(texts.into_iter().enumerate().map(|(index, text)| read(index, text?)))?;
    Ok(plan)
}

/// All that was read, or all that is wrong as one error.
pub(super) fn all<T>(results: impl Iterator<Item = Result<T>>) -> Result<Vec<T>> {
    let (mut read, mut first): (Vec<T>, Option<Box<Diagnostic>>) = (Vec::new(), None);
    for result in results {
        match (result, &mut first) {
            (Ok(one), _) => read.push(one),
            (Err(error), None) => first = Some(error),
            (Err(error), Some(first)) => first.others.push(*error),
        }
    }
    first.map_or(Ok(read), Err)
}

/// The plan with policies from texts that are at hand: those that a stored run or a pack holds.
///
/// # Errors
/// As [`with_policies`], and if there are not as many texts as policies.
pub fn with_policy_texts(plan: Plan, texts: Vec<PolicyText>) -> Result<Plan> {
    if texts.len() != plan.settings.policies.len() {
        let message = format!("the run holds {} of {} policies", texts.len(), plan.settings.policies.len());
        return Diagnostic::new("E-RUN-FILE", message).help("run the behaviour again").fail();
    }
    if plan.behaviour.hands_over() {
        return used::with_used(plan, texts);
    }
    let texts = texts.iter().enumerate();
    let members = all(texts.map(|(index, text)| member(&plan, index, &text.policy)))?;
    Ok(plan.with_members(members))
}

fn member(plan: &Plan, index: usize, source: &SourceText) -> Result<Member> {
    let name = &plan.settings.policies[index].name;
    let stored = StoredPolicy::parse(source).map_err(|error| {
        // The place in the policy's own file goes into words, since the caret stands in the script.
        let line = error.place.as_ref().map(|place| {
            let (line, _) = place.source.position(place.span.start);
            format!(" (line {line}: {})", printable(place.label.lines().next().unwrap_or_default()))
        });
        let message = format!("policy \"{}\": {}{}", printable(name), error.message, line.unwrap_or_default());
        wrong(plan, index, message, "this policy", "learn its behaviour again")
    })?;
    if !stored.parts.is_empty() {
        let message = format!("policy \"{}\" has states of several parts: these cannot be combined", printable(name));
        return Err(wrong(plan, index, message, "this policy", "combine policies of one view, without stages"));
    }
    stored.suits(&plan.settings, &*plan.state_map()?).map_err(|[own, wanted]| {
        let message = format!("policy \"{}\" was learned with {own}, this script has {wanted}", printable(name));
        let path = printable(&source.path.display().to_string());
        let help = "learn it with the grid shape and the actions of this script, or give this script its own";
        wrong(plan, index, message, &format!("'{path}'"), help)
    })?;
    let mut entries = stored.entries.iter();
    let foreign = entries.try_for_each(|entry| entry.check(&plan.filters));
    foreign.map_err(|error| wrong(plan, index, error.message, "this policy", "give its filters: --filter-dir DIR"))?;
    let StoredPolicy { behaviour, filters, grid, policy, .. } = stored;
    let member = Member { name: name.clone(), behaviour, filters, grid, policy, source: source.clone() };
    member.eyes(plan).map_err(|error| wrong(plan, index, error.message, "this policy", "learn its behaviour again"))?;
    Ok(member)
}

/// The files of those policies that the plan's script names and that are there, sound or not.
#[must_use]
pub fn policy_files(plan: &Plan) -> Vec<PathBuf> {
    let folder = plan.behaviour.source().path.parent().unwrap_or(Path::new(""));
    let files = plan.settings.policies.iter().map(|policy| first_file(&tried(folder, &policy.path)).cloned());
    files.flatten().collect()
}

/// Where a policy may be, the likelier place first.
fn tried(scripts: &Path, path: &str) -> [PathBuf; 2] {
    let file = |path: PathBuf| if path.is_dir() { path.join("policy.toml") } else { path };
    [file(scripts.join(path)), file(PathBuf::from(path))]
}

/// Only ordinary files: others may never end.
fn first_file(tried: &[PathBuf]) -> Option<&PathBuf> {
    tried.iter().find(|path| path.is_file())
}

/// The text of a policy: its path is meant from the script or, if it is not there, from where the user stands.
fn find(
    plan: &Plan,
    index: usize,
    path: &str,
    packed: &dyn Fn(&Path) -> Result<Option<PolicyText>>,
) -> Result<PolicyText> {
    let folder = plan.behaviour.source().path.parent().unwrap_or(Path::new(""));
    let tried = tried(folder, path);
    let found = first_file(&tried);
    if found.is_none_or(|found| found.extension().is_some_and(|ending| ending == "pack"))
        && let Some(text) = packed(found.map_or(Path::new(path), PathBuf::as_path))?
    {
        return Ok(text);
    }
    let Some(found) = found else {
        let name = printable(&plan.settings.policies[index].name);
        let message =
            format!("policy \"{name}\" is not there: no file '{}'", printable(&tried[1].display().to_string()));
        return Err(wrong(plan, index, message, "not found", &maker(folder, path)));
    };
    let read = |path: &Path| {
        let read = read_stored(path);
        read.map_err(|error| wrong(plan, index, error.message, "this policy", "learn its behaviour again"))
    };
    let beside = found.with_file_name(RUN_FILE);
    let run = (plan.behaviour.hands_over() && beside.is_file()).then(|| read(&beside)).transpose()?;
    let policy = read(found)?;
    // What is wrong with the file itself is told by whoever reads it.
    if let Ok(stored) = StoredPolicy::parse(&policy) {
        check_policy_of_file(found, &stored.policy).map_err(|error| {
            let help = error.help.unwrap_or_default();
            let mut placed = wrong(plan, index, error.message, "this policy", &help);
            placed.code = error.code;
            placed
        })?;
    }
    Ok(PolicyText { policy, run })
}

/// The command that makes a missing policy, as far as its path tells.
fn maker(scripts: &Path, path: &str) -> String {
    let parts: Vec<&str> = path.split('/').filter(|part| !matches!(*part, "" | "." | "policy.toml")).collect();
    if let [.., name, seed] = parts[..]
        && let Ok(seed) = seed.parse::<u64>()
    {
        let script = scripts.join(format!("{name}.rhai"));
        if script.is_file() {
            let seed = if seed == 1 { String::new() } else { format!(" --seed {seed}") };
            return format!("make it with: engine run {}{seed}", printable(&script.display().to_string()));
        }
    }
    "make it with: engine run SCRIPT, then write the folder of that run here".to_owned()
}

pub(super) fn wrong(plan: &Plan, index: usize, message: String, label: &str, help: &str) -> Box<Diagnostic> {
    let error = Diagnostic::new("E-POLICY", message).help(help);
    Box::new(match plan.behaviour.place_of(&format!("policy:{index}")) {
        Some(span) => error.at(plan.behaviour.source(), span, label),
        None => error,
    })
}
