//! What owners say of their keys: `engine pack rotate`, `revoke`, and `trust --said`.

use std::path::{Path, PathBuf};
use std::time::SystemTime;

use engine::diagnostic::Result;
use insight::disk::write_atomic;
use pack::{Password, Revocations, Rotation, Statement, key_id, needs_password};
use serde_json::json;

use super::keys::password;
use super::places::{Places, public_key, read_text};
use crate::cli::{RevokeArguments, RotateArguments, SigningArguments};
use crate::console::{Console, ConsoleError};

pub(super) fn rotate(arguments: &RotateArguments, console: &mut Console) -> std::result::Result<u8, ConsoleError> {
    let (owner, new, date) = (arguments.owner.clone(), public_key(&arguments.to)?, day(&arguments.signing));
    let statement = |old| Statement::Rotation(Rotation { owner, old, new, date });
    let path = sign(&arguments.owner, "rotation", &arguments.signing, statement)?;
    told(&path, console)
}

pub(super) fn revoke(arguments: &RevokeArguments, console: &mut Console) -> std::result::Result<u8, ConsoleError> {
    let revoked = arguments.keys.iter().map(|key| public_key(key)).collect::<Result<Vec<_>>>()?;
    let (owner, number, date) = (arguments.owner.clone(), arguments.number, day(&arguments.signing));
    let statement = |issuer| Statement::Revocations(Revocations { owner, issuer, number, date, revoked });
    let path = sign(&arguments.owner, "revoked", &arguments.signing, statement)?;
    told(&path, console)
}

/// Takes a statement into the list of trusted keys.
pub(super) fn take(path: &Path, console: &mut Console) -> std::result::Result<u8, ConsoleError> {
    let statement = Statement::open(&read_text(path)?)?;
    let places = Places::find()?;
    let _held = places.hold_trust()?;
    let mut store = places.trust()?;
    store.take(&statement)?;
    store.save(&places.trust_path())?;
    console.json(&store)?;
    let line = match &statement {
        Statement::Rotation(Rotation { owner, old, new, .. }) => {
            format!("trusted:  key {} signs the packs of '{owner}', as key {} says", key_id(new)?, key_id(old)?)
        }
        Statement::Revocations(Revocations { owner, number, date, revoked, .. }) => {
            let ids = revoked.iter().map(|key| key_id(key)).collect::<Result<Vec<_>>>()?;
            format!("revoked:  for the packs of '{owner}', by list {number} of {date}: {}", ids.join(", "))
        }
    };
    console.line(&line)?;
    Ok(0)
}

fn sign(
    owner: &str,
    ending: &str,
    signing: &SigningArguments,
    statement: impl FnOnce(String) -> Statement,
) -> Result<PathBuf> {
    let secret = read_text(&signing.key)?;
    let password = if needs_password(&secret) { password(signing.password_stdin)? } else { Password::None };
    let text = Statement::sign(statement, &secret, password)?;
    let path = signing.out.clone().unwrap_or_else(|| PathBuf::from(format!("{owner}.{ending}")));
    write_atomic(&path, text.as_bytes())?;
    Ok(path)
}

fn told(path: &Path, console: &mut Console) -> std::result::Result<u8, ConsoleError> {
    console.json(&json!({ "statement": path }))?;
    console.line(&format!("signed:   {}", path.display()))?;
    console.line(&format!("give it to everyone; they say: engine pack trust --said {}", path.display()))?;
    Ok(0)
}

/// The day that was given, or today in Greenwich.
fn day(signing: &SigningArguments) -> String {
    let now = || SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default().as_secs();
    signing.date.clone().unwrap_or_else(|| day_of(now() / 86_400))
}

/// A day by its number since 1970.
fn day_of(days: u64) -> String {
    let (year, month, day) = insight::disk::date(days);
    format!("{year:04}-{month:02}-{day:02}")
}

#[cfg(test)]
mod tests {
    use super::day_of;

    #[test]
    fn days_are_those_of_the_calendar() {
        // 2000-02-29 is day 11016, 2024-12-31 is day 20088.
        assert_eq!([0, 11_016, 11_017, 20_088].map(day_of), ["1970-01-01", "2000-02-29", "2000-03-01", "2024-12-31"]);
    }
}
