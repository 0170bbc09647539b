//! From a pack to what can run: its script, its world and its policies, all from inside the pack.
//!
//! A pack's script names files as any script does; here they are looked for in the pack and in what it builds on, never
//! on the disk, so that a stranger's script cannot point at a file of the user's.

use std::io::Write;
use std::sync::Arc;

use tempfile::TempDir;

use super::{EntryPath, Pack, malformed};
use engine::diagnostic::{Diagnostic, Result, SourceText, printable};
use engine::experiment::{Overrides, Plan};
use engine::filter::{Catalogue, Sources};
use engine::learner::Policy;
use engine::script::{Behaviour, ParamValues};
use engine::settings::WorldShare;
use engine::world::{FamilyRange, Layout, WorldSet};
use insight::store::{PolicyText, policy_from_toml, policy_to_toml, with_policy_texts};

/// A pack's behaviour, ready to be learned or tested.
#[derive(Clone)]
pub struct Runnable {
    /// The behaviour with its world and the policies that it combines.
    pub plan: Plan,
    /// The folder that the pack's own filters were unpacked to; it goes when the last copy of this goes.
    pub unpacked: Option<Arc<TempDir>>,
}

impl Runnable {
    /// The text of a policy that this behaviour learned.
    pub(super) fn policy_text(&self, policy: &Policy) -> Result<String> {
        policy_to_toml(&self.plan, policy, None)
    }
}

impl Pack {
    /// The behaviour of the pack, with the command line's changes; `depends` are the packs that it builds on, in the
    /// manifest's order, and `sources` the user's own filters and which native ones are allowed. The script's set-up runs here for the first time, inside the limits of all scripts.
    ///
    /// # Errors
    /// If the pack asks for what this engine does not have, or anything in it is wrong.
    pub fn plan(&self, depends: &[Self], overrides: &Overrides, mut sources: Sources) -> Result<Runnable> {
        let manifest = self.manifest();
        manifest.check_engine()?;
        if manifest.capabilities.bridge {
            let message = format!("{} asks for 'bridge', and this engine has no bridge to a robot", self.title());
            return Diagnostic::new("E-TRUST-CAPABILITY", message).help("get an engine that has one").fail();
        }
        let script = manifest.entry.script.as_str();
        let stem = script.rsplit('/').next().and_then(|file| file.strip_suffix(".rhai")).unwrap_or(script);
        let bodies = |name: &str| self.body(name, depends).map(Some);
        let behaviour =
            Arc::new(Behaviour::parse_in(manifest.edition()?, stem, self.text(script)?, &bodies, &ParamValues::new())?);
        let settings = behaviour.settings().clone();
        let worlds = self.worlds(&behaviour, depends)?;
        let unpacked = self.unpack_filters(depends)?;
        sources.folders.extend(unpacked.iter().map(|folder| folder.path().to_owned()));
        let filters = Arc::new(Catalogue::new(sources)?);
        let plan = Plan::with_worlds(Arc::clone(&behaviour), settings, worlds, filters)?.with_changes(overrides)?;
        let plan = with_policy_texts(plan, self.policies(&behaviour)?)?;
        Ok(Runnable { plan, unpacked })
    }

    /// The learned policy that the pack carries, if it carries one.
    ///
    /// # Errors
    /// `E-PACK-POLICY` if it does not fit the pack's own behaviour.
    pub fn policy(&self, plan: &Plan) -> Result<Option<Policy>> {
        let Some(path) = &self.manifest().entry.policy else { return Ok(None) };
        let source = self.text(path.as_str())?;
        let policy = policy_from_toml(&source, plan);
        policy.map(Some).map_err(|mut error| {
            // The run is the user's, but the file is the author's: an input, not a state.
            error.code = "E-PACK-POLICY";
            error
        })
    }

    /// The worlds of the script: files of the pack or of what it builds on, and worlds made by rule.
    fn worlds(&self, behaviour: &Behaviour, depends: &[Self]) -> Result<WorldSet> {
        let settings = behaviour.settings();
        let alone = [WorldShare { name: settings.world.clone(), weight: 1 }];
        let shares = if settings.worlds.is_empty() { &alone[..] } else { &settings.worlds };
        let mut loaded = Vec::new();
        for WorldShare { name, weight } in shares {
            let texts = match FamilyRange::of(name) {
                Some(Ok(range)) => range.texts().map(|(name, text)| SourceText::new(name, text)).collect(),
                Some(Err((message, help))) => {
                    let wrong = Diagnostic::new("E-WORLD-FILE", message).help(help);
                    return at(behaviour, "world", wrong, "no such worlds").fail();
                }
                None => vec![self.world(behaviour, name, depends)?],
            };
            let layouts = texts.into_iter().map(|text| Layout::parse(text, &settings.robot.body).map(Arc::new));
            loaded.push((*weight, layouts.collect::<Result<Vec<_>>>()?));
        }
        WorldSet::new(loaded).ok_or_else(|| {
            let message = format!("the worlds of {} cannot be shared out", self.title());
            Box::new(malformed("E-PACK-WORLD", message).help("its author gives each a whole weight from 1"))
        })
    }

    fn world(&self, behaviour: &Behaviour, name: &str, depends: &[Self]) -> Result<SourceText> {
        if let Some(path) = self.manifest().entry.world.as_ref().filter(|_| behaviour.settings().worlds.is_empty()) {
            return self.text(path.as_str());
        }
        let folder = self.script_folder();
        let tried: Vec<Option<String>> = if name.contains(['/', '\\']) || name.ends_with(".toml") {
            vec![inside(folder, name)]
        } else {
            let file = format!("{name}.toml");
            vec![
                inside("", &format!("worlds/{file}")),
                inside(folder, &format!("worlds/{file}")),
                inside(folder, &file),
            ]
        };
        for pack in std::iter::once(self).chain(depends) {
            if let Some(path) = tried.iter().flatten().find(|path| pack.file(path).is_some()) {
                return pack.text(path);
            }
        }
        let message = format!("{} has no world '{}'", self.title(), printable(name));
        let help = format!("its author puts worlds/{}.toml into the pack", printable(name));
        at(behaviour, "world", malformed("E-PACK-WORLD", message).help(help), "not in the pack").fail()
    }

    /// The file of a body that the script names: the pack carries it, so that its evidence holds with another engine too.
    fn body(&self, name: &str, depends: &[Self]) -> Result<SourceText> {
        let file = format!("robots/{name}.toml");
        let tried = [inside("", &file), inside(self.script_folder(), &file)];
        for pack in std::iter::once(self).chain(depends) {
            if let Some(path) = tried.iter().flatten().find(|path| pack.file(path).is_some()) {
                return pack.text(path);
            }
        }
        let message = format!("{} has no robot '{}'", self.title(), printable(name));
        malformed("E-PACK-ROBOT", message).help(format!("its author puts {file} into the pack")).fail()
    }

    fn policies(&self, behaviour: &Behaviour) -> Result<Vec<PolicyText>> {
        let named = behaviour.settings().policies.iter().enumerate();
        let text = |(index, policy): (usize, &engine::settings::PolicySettings)| {
            let path = inside(self.script_folder(), &policy.path);
            let tried = path.into_iter().flat_map(|path| [format!("{path}/policy.toml"), path]);
            match tried.into_iter().find(|path| self.file(path).is_some()) {
                Some(path) => {
                    let run = path.strip_suffix("policy.toml").map(|folder| format!("{folder}run.toml"));
                    let run = run.filter(|run| self.file(run).is_some()).map(|run| self.text(&run)).transpose()?;
                    Ok(PolicyText { policy: self.text(&path)?, run })
                }
                None => {
                    let message = format!("{} has no policy '{}'", self.title(), printable(&policy.path));
                    let error = malformed("E-PACK-POLICY", message)
                        .help("its author puts that run's policy.toml into the pack");
                    at(behaviour, &format!("policy:{index}"), error, "not in the pack").fail()
                }
            }
        };
        named.map(text).collect()
    }

    /// The filters of the pack and of what it builds on, in a fresh folder that only this user can enter: the bytes that
    /// were checked are the bytes that are loaded.
    fn unpack_filters(&self, depends: &[Self]) -> Result<Option<Arc<TempDir>>> {
        let code = |pack: &'_ Self| {
            let asked = &pack.manifest().capabilities;
            asked.filters_wasm.iter().chain(&asked.native).cloned().collect::<Vec<_>>()
        };
        let all: Vec<(&Self, EntryPath)> = std::iter::once(self)
            .chain(depends)
            .flat_map(|pack| code(pack).into_iter().map(move |path| (pack, path)))
            .collect();
        if all.is_empty() {
            return Ok(None);
        }
        let disk =
            |error: std::io::Error| Box::new(Diagnostic::disk("unpack filters into", &std::env::temp_dir(), &error));
        let folder = TempDir::with_prefix("engine-filters-").map_err(disk)?;
        for (pack, path) in all {
            let name = path.as_str().rsplit('/').next().unwrap_or_default();
            let mut file = std::fs::File::create_new(folder.path().join(name)).map_err(|_| {
                Box::new(malformed("E-PACK-CAPABILITY", format!("two filters of {} are called '{name}'", self.title())))
            })?;
            file.write_all(pack.file(path.as_str()).unwrap_or_default()).map_err(disk)?;
        }
        Ok(Some(Arc::new(folder)))
    }

    fn script_folder(&self) -> &str {
        self.manifest().entry.script.as_str().rsplit_once('/').map_or("", |(folder, _)| folder)
    }
}

fn at(behaviour: &Behaviour, place: &str, error: Diagnostic, label: &str) -> Diagnostic {
    match behaviour.place_of(place) {
        Some(span) => error.at(behaviour.source(), span, label),
        None => error,
    }
}

/// `path` as meant from `folder`, both inside the pack; nothing if it leaves the pack.
pub(super) fn inside(folder: &str, path: &str) -> Option<String> {
    if path.starts_with('/') || path.contains('\\') {
        return None;
    }
    let mut parts: Vec<&str> = folder.split('/').filter(|part| !part.is_empty()).collect();
    for part in path.split('/') {
        match part {
            "" | "." => {}
            ".." => {
                parts.pop()?;
            }
            other => parts.push(other),
        }
    }
    Some(parts.join("/"))
}

#[cfg(test)]
mod tests {
    use super::inside;

    #[test]
    fn a_path_stays_in_the_pack_or_is_nothing() {
        assert_eq!(inside("scripts", "../worlds/room.toml").as_deref(), Some("worlds/room.toml"));
        assert_eq!(inside("", "worlds//./room.toml").as_deref(), Some("worlds/room.toml"));
        for out in ["../../etc/passwd", "/etc/passwd", "..\\x", "a/../../../x"] {
            assert_eq!(inside("scripts", out), None, "{out}");
        }
    }
}
