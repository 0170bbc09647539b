//! What BEHAVIOUR stands for: a script, a pack's file, a pack's folder, or an installed pack's name.

use std::path::Path;

use engine::diagnostic::{Diagnostic, Result, SourceText};
use engine::experiment::{Overrides, Plan};
use insight::disk::is_there;
use insight::store::{POLICY_FILE, PolicyText, RUN_FILE, policy_to_toml, run_to_toml, with_policies_or};
use pack::{Evidence, Locked, PACK_ENDING, Pack, PackName, Runnable, draft};

use super::pack::places::{Places, signature_of};
use super::sources::{catalogue, sources};
use crate::cli::FilterSources;

/// The file that makes a folder a pack's folder.
const AUTHOR_FILE: &str = "pack.toml";

/// The behaviour that an argument means, ready to run.
pub(super) fn open(
    argument: &Path,
    overrides: &Overrides,
    filters: &FilterSources,
    allow_unsigned: bool,
) -> Result<Runnable> {
    let runnable = open_to_look(argument, overrides, filters, allow_unsigned)?;
    if !runnable.plan.members.is_empty() || !runnable.plan.used.is_empty() {
        return Ok(runnable);
    }
    let packed = |path: &Path| packed_policy(path, filters, allow_unsigned);
    Ok(Runnable { plan: with_policies_or(runnable.plan, &packed)?, ..runnable })
}

/// The policy of a pack, as the run of its behaviour that it would have been learned in; nothing if there is no such pack.
pub(super) fn packed_policy(
    argument: &Path,
    filters: &FilterSources,
    allow_unsigned: bool,
) -> Result<Option<PolicyText>> {
    let Some((pack, depends)) = open_pack(argument, allow_unsigned)? else { return Ok(None) };
    let Runnable { plan, .. } = pack.plan(&depends, &Overrides::default(), sources(filters)?)?;
    let Some(policy) = pack.policy(&plan)? else {
        let message = format!("{} carries no learned policy", pack.title());
        return Diagnostic::new("E-PACK-POLICY", message).help("name a pack that was built, or a run").fail();
    };
    let seed = pack.manifest().evidence.as_ref().and_then(Evidence::shown).map_or(1, |claim| claim.seed);
    let run = run_to_toml(&plan, seed)?;
    let policy = policy_to_toml(&plan, &policy, Some(&run))?;
    let text = |file: &str, text: String| SourceText::new(argument.join(file), text);
    Ok(Some(PolicyText { policy: text(POLICY_FILE, policy), run: Some(text(RUN_FILE, run)) }))
}

/// The behaviour that an argument means, without the policies that a script combines, which may not have been learned yet.
pub(super) fn open_to_look(
    argument: &Path,
    overrides: &Overrides,
    filters: &FilterSources,
    allow_unsigned: bool,
) -> Result<Runnable> {
    if let Some((pack, depends)) = open_pack(argument, allow_unsigned)? {
        return pack.plan(&depends, overrides, sources(filters)?);
    }
    let plan = Plan::load(argument, overrides, || catalogue(filters))?;
    Ok(Runnable { plan, unpacked: None })
}

/// The pack that an argument means, and what it builds on; nothing if it means something else.
pub(super) fn open_pack(argument: &Path, allow_unsigned: bool) -> Result<Option<(Pack, Vec<Pack>)>> {
    let pack = if argument.is_dir() && is_there(&argument.join(AUTHOR_FILE))? {
        draft(argument)?
    } else if argument.extension().is_some_and(|ending| ending == PACK_ENDING) {
        let pack = Pack::load(argument)?;
        let places = Places::find()?;
        let signer = places.trust()?.judge(&pack, signature_of(argument)?.as_ref(), allow_unsigned)?;
        // The file of an installed pack is held to its key and to what it was granted; any version may be looked at.
        places.index()?.admit(&pack, &signer, &[], true)?;
        pack
    } else {
        match locked(argument)? {
            Some((places, locked)) => places.open(&locked)?,
            None => return Ok(None),
        }
    };
    let depends = depends(&pack)?;
    Ok(Some((pack, depends)))
}

/// The packs that a pack builds on, from the lock.
pub(super) fn depends(pack: &Pack) -> Result<Vec<Pack>> {
    if pack.manifest().depends.is_empty() {
        return Ok(Vec::new());
    }
    let places = Places::find()?;
    pack.manifest().depends.iter().map(|dependency| places.dependency(pack, dependency)).collect()
}

/// The installed pack of a name. An argument that could be a path of something else is one.
fn locked(argument: &Path) -> Result<Option<(Places, Locked)>> {
    let Some(text) = argument.to_str() else { return Ok(None) };
    let full = if text.contains('/') { text.to_owned() } else { format!("local/{text}") };
    if argument.exists() || text.ends_with(".rhai") || PackName::try_from(full).is_err() {
        return Ok(None);
    }
    // Without a home there are no installed packs, and a missing script is the error to tell.
    let Ok(places) = Places::find() else { return Ok(None) };
    Ok(places.locked(text)?.map(|locked| (places, locked)))
}
