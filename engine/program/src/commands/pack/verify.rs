//! `engine pack verify`: is it what its author signed, and does it do what they claim?

use engine::diagnostic::Result;
use engine::experiment::{Overrides, Progress, WINDOW_STEPS};
use engine::filter::Sources;
use pack::{Difference, Evidence, Pack, Signer, TrustStore, fingerprint, key_id, replay};
use serde_json::json;

use super::super::behaviour::depends;
use super::super::sources::sources;
use super::super::stop::on_ctrl_c;
use super::places::{Places, public_key, signature_of};
use crate::cli::VerifyArguments;
use crate::console::{Console, ConsoleError};

pub(super) fn verify(arguments: &VerifyArguments, console: &mut Console) -> std::result::Result<u8, ConsoleError> {
    let pack = Pack::load(&arguments.pack)?;
    let signature = signature_of(&arguments.pack)?;
    let store = match &arguments.key {
        Some(key) => {
            let mut store = TrustStore::default();
            store.trust(pack.manifest().name.owner(), &public_key(key)?, false)?;
            store
        }
        None => Places::find()?.trust()?,
    };
    let signer = store.judge(&pack, signature.as_ref(), arguments.allow_unsigned)?;
    let differences =
        if arguments.replay { Some(replayed(&pack, sources(&arguments.filters)?, console)?) } else { None };
    console.json(&json!({
        "name": pack.manifest().name,
        "version": pack.manifest().version,
        "blob": pack.blob(),
        "content": pack.content(),
        "key_id": signer.key().map(key_id).transpose()?,
        "reproduced": differences.as_ref().map(Vec::is_empty),
        "differences": differences,
    }))?;
    console.line(&format!("pack:      {}: {} files, each as its manifest says", pack.title(), pack.files().count()))?;
    console.line(&format!("content:   sha256:{}", pack.content()))?;
    console.line(&format!("signature: {}", signed_by(&signer)?))?;
    let Some(differences) = differences else { return Ok(0) };
    print_replay(&pack, &differences, console)?;
    Ok(u8::from(!differences.is_empty()))
}

/// `by key 1234, which you trust`.
pub(super) fn signed_by(signer: &Signer) -> Result<String> {
    Ok(match signer {
        Signer::Nobody => "none, which you accepted".to_owned(),
        Signer::Trusted { key, .. } => format!("valid, by key {}", key_id(key)?),
    })
}

fn replayed(pack: &Pack, sources: Sources, console: &Console) -> Result<Vec<Difference>> {
    let runnable = pack.plan(&depends(pack)?, &Overrides::default(), sources)?;
    let stop = on_ctrl_c()?;
    let evidence = pack.manifest().evidence.as_ref();
    let bar = console.bar(evidence.map_or(0, |evidence| evidence.steps * evidence.seeds.len() as u64));
    let differences = replay(pack, &runnable, &stop, &|_: Progress| bar.inc(WINDOW_STEPS));
    bar.finish_and_clear();
    differences
}

fn print_replay(
    pack: &Pack,
    differences: &[Difference],
    console: &mut Console,
) -> std::result::Result<(), ConsoleError> {
    let Some(Evidence { engine, behaves, seeds, .. }) = &pack.manifest().evidence else { return Ok(()) };
    if differences.is_empty() {
        return console.line(&format!("replay:    reproduced bit for bit: {} seeds", seeds.len()));
    }
    for Difference { seed, what, .. } in differences {
        console.line(&format!("replay:    seed {seed}: {what}"))?;
    }
    let same = *behaves == fingerprint()?;
    let why = if same {
        "this engine behaves as the author's does: the claims are not what the pack does".to_owned()
    } else {
        format!("this engine does not behave as the author's, engine {engine}: with that one it may be reproduced")
    };
    console.line(&format!("why:       {why}"))
}
