//! `engine pack inspect`: what is in a pack, from its manifest; nothing in it is run.

use std::path::Path;

use engine::diagnostic::{Result, printable};
use insight::disk::is_there;
use insight::folder::certificate_lines;
use pack::{Evidence, Manifest, PACK_ENDING, Pack, Signature, fingerprint, key_id};
use serde_json::{Value, json};

use super::places::{Places, signature_of};
use crate::cli::InspectArguments;
use crate::console::{Console, ConsoleError};

pub(super) fn inspect(arguments: &InspectArguments, console: &mut Console) -> std::result::Result<u8, ConsoleError> {
    let (pack, signature) = open(&arguments.pack)?;
    let signed = match &signature {
        None => "not signed".to_owned(),
        Some(signature) => match Places::find()?.trust()?.judge(&pack, Some(signature), false) {
            Ok(signer) => super::verify::signed_by(&signer)?,
            Err(error) => format!("by key {}, not accepted: {}", signature.key_id(), error.message),
        },
    };
    console.json(&description(&pack, Some(&signed)))?;
    let manifest = pack.manifest();
    console.line(&format!("pack:      {}: {}", pack.title(), printable(&manifest.description)))?;
    console.line(&format!("licence:   {}", printable(&manifest.license)))?;
    console.line(&format!("engine:    {}", manifest.engine))?;
    console.line(&format!("content:   sha256:{}", pack.content()))?;
    console.line(&format!("file:      sha256:{}", pack.blob()))?;
    console.line(&format!("signature: {signed}"))?;
    let asks = manifest.capabilities.lines();
    console.line(&format!("asks for:  {}", if asks.is_empty() { "nothing".to_owned() } else { asks.join(", ") }))?;
    for dependency in &manifest.depends {
        console.line(&format!("builds on: {} {}", dependency.name, dependency.version))?;
    }
    print_evidence(console, manifest)?;
    if let Some(evidence) = &manifest.evidence {
        let same = if evidence.behaves == fingerprint()? { "as this one does" } else { "not as this one does" };
        console.line(&format!("measured:  by engine {}, which behaves {same}", printable(&evidence.engine)))?;
    }
    console.line("files:")?;
    for line in &manifest.files {
        console.line(&format!("  {:>9}  {}", line.size, line.path))?;
    }
    Ok(0)
}

fn open(argument: &Path) -> Result<(Pack, Option<Signature>)> {
    let is_file = is_there(argument)? || argument.extension().is_some_and(|ending| ending == PACK_ENDING);
    if !is_file
        && let (Some(text), Ok(places)) = (argument.to_str(), Places::find())
        && let Some(locked) = places.locked(text)?
    {
        let pack = places.shelf().get(&locked)?;
        return Ok((pack, places.shelf().signature(locked.content)?));
    }
    Ok((Pack::load(argument)?, signature_of(argument)?))
}

/// All of a pack for a program: its manifest, its digests and who signed it.
pub(super) fn description(pack: &Pack, signed: Option<&str>) -> Value {
    json!({ "manifest": pack.manifest(), "blob": pack.blob(), "content": pack.content(), "signature": signed })
}

/// What is claimed, a line for each seed.
pub(super) fn print_evidence(console: &mut Console, manifest: &Manifest) -> std::result::Result<(), ConsoleError> {
    let Some(Evidence { steps, test_steps, seeds, params, .. }) = &manifest.evidence else {
        return console.line("claims:    nothing");
    };
    console.line(&format!("claims:    {} seeds, {steps} steps of learning, {test_steps} of test", seeds.len()))?;
    for (name, shown) in params {
        console.line(&format!("  parameter {}: {}", printable(name), printable(shown)))?;
    }
    for claim in seeds {
        let learned = match claim.learned_at {
            Some(step) => format!("learned at step {step}"),
            None if *steps == 0 => "combined".to_owned(),
            None => "not learned".to_owned(),
        };
        let success = match claim.success {
            Some(true) => "success, ",
            Some(false) => "no success, ",
            None => "",
        };
        let untrained = claim.untrained_failures_per_1000;
        let untrained = untrained.map_or(String::new(), |failures| format!(" (untrained {failures:.1})"));
        let laps = claim.laps.map_or(String::new(), |laps| format!(", {laps:.1} laps"));
        let (seed, failures, contacts) = (claim.seed, claim.failures_per_1000, claim.contacts);
        console.line(&format!(
            "  seed {seed}: {success}{learned}; test: {failures:.1} failures in 1000 steps{untrained}, contacts: {contacts}{laps}"
        ))?;
    }
    if let Some(certificate) = manifest.evidence.as_ref().and_then(|evidence| evidence.certificate.as_ref()) {
        for line in certificate_lines(certificate) {
            console.line(&format!("  unseen worlds: {line}"))?;
        }
    }
    Ok(())
}

/// The key of a signature or of a locked pack, as it is shown.
pub(super) fn key_shown(key: Option<&str>) -> String {
    key.and_then(|key| key_id(key).ok()).unwrap_or_else(|| "unsigned".to_owned())
}
