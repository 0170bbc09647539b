//! Keys: `engine pack keygen`, `sign` and `trust`.

use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};

use engine::diagnostic::{Diagnostic, Result};
use insight::disk::{is_there, write_atomic};
use pack::{Pack, Password, key_id, key_line, needs_password, new_keys};
use serde_json::json;

use super::places::{Places, public_key, read_text, signature_path};
use crate::cli::{KeygenArguments, SignArguments, TrustArguments};
use crate::console::{Console, ConsoleError};

pub(super) fn keygen(arguments: &KeygenArguments, console: &mut Console) -> std::result::Result<u8, ConsoleError> {
    let [secret, public] = ["key", "pub"].map(|ending| with_ending(&arguments.name, ending));
    for path in [&secret, &public] {
        if is_there(path)? {
            let message = format!("'{}' is there already, and a lost key cannot be made again", path.display());
            let error = Diagnostic::new("E-PACK-KEY-USE", message).help("give another name");
            return Err(Box::new(error).into());
        }
    }
    let password = if arguments.no_password { Password::None } else { password(arguments.password_stdin)? };
    let [secret_text, public_text] = new_keys(password)?;
    write_secret(&secret, &secret_text)?;
    write_atomic(&public, public_text.as_bytes())?;
    let line = key_line(&public_text)?;
    let id = key_id(&line)?;
    console.json(&json!({ "key_id": id, "secret": secret, "public": public, "key": line }))?;
    console.line(&format!("key:      {id}"))?;
    console.line(&format!("secret:   {}: keep it to yourself, and keep a copy", secret.display()))?;
    console.line(&format!("public:   {}: give it to everyone", public.display()))?;
    console.line(&format!("they say: engine pack trust OWNER --key {line}"))?;
    Ok(0)
}

pub(super) fn sign(arguments: &SignArguments, console: &mut Console) -> std::result::Result<u8, ConsoleError> {
    let pack = Pack::load(&arguments.pack)?;
    let secret = read_text(&arguments.key)?;
    let password = if needs_password(&secret) { password(arguments.password_stdin)? } else { Password::None };
    let signature = pack::sign(&pack, &secret, password)?;
    let path = signature_path(&arguments.pack);
    write_atomic(&path, signature.text().as_bytes())?;
    console.json(&json!({ "name": pack.manifest().name, "key_id": signature.key_id(), "signature": path }))?;
    console.line(&format!("signed:    {} by key {}", pack.title(), signature.key_id()))?;
    console.line(&format!("signature: {}", path.display()))?;
    Ok(0)
}

pub(super) fn trust(arguments: &TrustArguments, console: &mut Console) -> std::result::Result<u8, ConsoleError> {
    if let Some(said) = &arguments.said {
        return super::statements::take(said, console);
    }
    let places = Places::find()?;
    let TrustArguments { owner, key, replace, revoke, .. } = arguments;
    let _held = key.as_ref().map(|_| places.hold_trust()).transpose()?;
    let mut store = places.trust()?;
    match (owner, key) {
        (_, None) => {
            console.json(&store)?;
            if store.keys().is_empty() {
                console.line("no key is trusted yet; write: engine pack trust OWNER --key KEY")?;
            }
            for known in store.keys() {
                console.line(&format!("{:20} {}  {}", known.owner, key_id(&known.key)?, known.key))?;
            }
            for old in store.retired() {
                let (id, by) = (key_id(&old.key)?, key_id(&old.by)?);
                console.line(&format!("{:20} {id}  handed over to {by} on {}", old.owner, old.date))?;
            }
            for list in store.lists() {
                let keys = list.keys.len();
                console
                    .line(&format!("{:20} list {} of {} revokes {keys} keys", list.owner, list.number, list.date))?;
            }
        }
        (_, Some(key)) if *revoke => {
            let key = public_key(key)?;
            store.revoke(&key)?;
            store.save(&places.trust_path())?;
            console.json(&store)?;
            console.line(&format!("revoked:  key {}: no pack that it signed is accepted any more", key_id(&key)?))?;
        }
        (Some(owner), Some(key)) => {
            let key = public_key(key)?;
            store.trust(owner, &key, *replace)?;
            store.save(&places.trust_path())?;
            console.json(&store)?;
            console.line(&format!("trusted:  key {} signs the packs of '{owner}'", key_id(&key)?))?;
        }
        (None, Some(_)) => {
            let error = Diagnostic::new("E-PACK-KEY-USE", "whose key is it?");
            return Err(Box::new(error.help("write: engine pack trust OWNER --key KEY")).into());
        }
    }
    Ok(0)
}

fn with_ending(name: &Path, ending: &str) -> PathBuf {
    let mut path = name.as_os_str().to_owned();
    path.push(".");
    path.push(ending);
    PathBuf::from(path)
}

/// A password from the terminal, or from standard input if that was asked for.
pub(super) fn password(from_input: bool) -> Result<Password> {
    if from_input {
        let mut line = String::new();
        std::io::stdin()
            .read_line(&mut line)
            .map_err(|error| Box::new(Diagnostic::disk("read", Path::new("standard input"), &error)))?;
        return Ok(Password::Given(line.trim_end_matches(['\n', '\r']).to_owned()));
    }
    if std::io::stdin().is_terminal() {
        return Ok(Password::Ask);
    }
    let error = Diagnostic::new("E-PACK-KEY-USE", "there is no terminal to ask for the key's password");
    error.help("add --password-stdin; 'keygen' also takes --no-password").fail()
}

/// Writes a secret that only its owner can read.
fn write_secret(path: &Path, text: &str) -> Result<()> {
    let mut options = std::fs::OpenOptions::new();
    options.write(true).create_new(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    let disk = |error: std::io::Error| Box::new(Diagnostic::disk("write", path, &error));
    let mut file = options.open(path).map_err(disk)?;
    file.write_all(text.as_bytes()).and_then(|()| file.sync_all()).map_err(disk)
}
