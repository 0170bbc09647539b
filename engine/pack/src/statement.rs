//! What an owner says about keys, signed: that a new key takes the place of the old one, and which keys are revoked.
//!
//! A statement is a small text: a first line that says what it is, lines of `word: value`, an empty line, and a signature of
//! minisign over all before that line. Whoever has the public key can verify it with `minisign` too.

use std::io::Cursor;

use minisign::{PublicKey, SignatureBox};

use super::signature::{Password, public, secret};
use super::{distrusted, key_id};
use engine::diagnostic::{Diagnostic, Result, printable};

const ROTATION: &str = "engine-key-rotation-v1";
const REVOCATIONS: &str = "engine-revocations-v1";
/// Most keys of one list.
const MOST_REVOKED: usize = 200;

/// A key that takes the place of another one, in the words of the old key's owner.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rotation {
    /// Whose packs both keys sign.
    pub owner: String,
    /// The public key that signs this.
    pub old: String,
    /// The public key that signs the owner's packs from now on.
    pub new: String,
    /// The day: `2026-11-28`.
    pub date: String,
}

/// Keys that an owner revokes. Each list of an owner has a higher number than the one before.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Revocations {
    /// Whose list it is: it speaks for the packs of this owner alone.
    pub owner: String,
    /// The public key that signs this.
    pub issuer: String,
    /// Which list it is, from 1.
    pub number: u64,
    /// The day: `2026-11-28`.
    pub date: String,
    /// The public keys.
    pub revoked: Vec<String>,
}

/// What a signed text says.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Statement {
    /// A new key.
    Rotation(Rotation),
    /// A list of revoked keys.
    Revocations(Revocations),
}

impl Statement {
    /// Makes a statement of the public key of a secret one: its text with its signature.
    ///
    /// # Errors
    /// `E-PACK-KEY` if the secret key or its password is wrong; `E-TRUST-STATEMENT` if a word of the statement is.
    pub fn sign(make: impl FnOnce(String) -> Self, secret_key: &str, password: Password) -> Result<String> {
        let failed = |error| Box::new(Diagnostic::new("E-PACK-KEY", format!("signing failed: {error}")));
        let key = secret(secret_key, password)?;
        let statement = make(PublicKey::from_secret_key(&key).map_err(failed)?.to_base64());
        let (body, domain) = (statement.body(), statement.domain());
        Self::read(&body)?;
        let signed = minisign::sign(None, &key, Cursor::new(body.as_bytes()), Some(domain), Some("statement on keys"));
        Ok(format!("{body}\n{}", signed.map_err(failed)?.into_string()))
    }

    /// Reads a signed text and verifies it by the key that it names; whether that key may say this is not judged here.
    ///
    /// # Errors
    /// `E-TRUST-STATEMENT` if it has another form, or its signature does not fit.
    pub fn open(text: &str) -> Result<Self> {
        let (body, signature) = text.split_once("\n\n").ok_or_else(|| wrong("it has no signature"))?;
        let body = format!("{body}\n");
        let statement = Self::read(&body)?;
        let lengths: Vec<usize> = signature.lines().map(str::len).collect();
        // The library trusts these lengths.
        if !matches!(lengths[..], [_, 100, _, 88]) {
            return Err(wrong("its signature is not of the form of minisign"));
        }
        let parsed = SignatureBox::from_string(signature).map_err(|_| wrong("its signature cannot be read"))?;
        let key: PublicKey = public(statement.signer())?;
        let fits = parsed.is_prehashed()
            && minisign::verify(&key, &parsed, Cursor::new(body.as_bytes()), true, false, false).is_ok()
            && parsed.trusted_comment().is_ok_and(|comment| comment == statement.domain());
        if fits {
            Ok(statement)
        } else {
            Err(wrong("its signature does not fit: it was changed, or made by another key"))
        }
    }

    fn domain(&self) -> &'static str {
        match self {
            Self::Rotation(_) => ROTATION,
            Self::Revocations(_) => REVOCATIONS,
        }
    }

    fn signer(&self) -> &str {
        match self {
            Self::Rotation(rotation) => &rotation.old,
            Self::Revocations(list) => &list.issuer,
        }
    }

    fn body(&self) -> String {
        let domain = self.domain();
        match self {
            Self::Rotation(Rotation { owner, old, new, date }) => {
                format!("{domain}\nowner: {owner}\nold: {old}\nnew: {new}\ndate: {date}\n")
            }
            Self::Revocations(Revocations { owner, issuer, number, date, revoked }) => {
                let head = format!("{domain}\nowner: {owner}\nissuer: {issuer}\nnumber: {number}\ndate: {date}\n");
                revoked.iter().fold(head, |text, key| text + "revoked: " + key.as_str() + "\n")
            }
        }
    }

    fn read(body: &str) -> Result<Self> {
        let mut lines = body.lines();
        let domain = lines.next().unwrap_or_default();
        let mut value = |word: &'static str| {
            let line = lines.next().unwrap_or_default();
            let value = line.strip_prefix(word).and_then(|rest| rest.strip_prefix(": ")).unwrap_or_default();
            if value.is_empty() {
                Err(wrong(&format!("it has no line '{word}: ...' in its place")))
            } else {
                Ok(value.to_owned())
            }
        };
        let statement = match domain {
            ROTATION => Self::Rotation(Rotation {
                owner: value("owner")?,
                old: value("old")?,
                new: value("new")?,
                date: value("date")?,
            }),
            REVOCATIONS => {
                let (owner, issuer, number) = (value("owner")?, value("issuer")?, value("number")?);
                let number = number.parse().ok().filter(|number| *number > 0);
                let number = number.ok_or_else(|| wrong("its number must be 1 or more"))?;
                let date = value("date")?;
                let revoked: Vec<String> =
                    lines.by_ref().map(|line| line.strip_prefix("revoked: ").unwrap_or_default().to_owned()).collect();
                Self::Revocations(Revocations { owner, issuer, number, date, revoked })
            }
            other => return Err(wrong(&format!("it begins with '{}'", printable(other)))),
        };
        statement.check()?;
        // One form only: what is signed is what is read.
        if statement.body() == body { Ok(statement) } else { Err(wrong("it has lines that do not belong there")) }
    }

    fn check(&self) -> Result<()> {
        let (owner, date, keys) = match self {
            Self::Rotation(Rotation { owner, old, new, date }) => (owner, date, vec![old, new]),
            Self::Revocations(list) => {
                (&list.owner, &list.date, std::iter::once(&list.issuer).chain(&list.revoked).collect())
            }
        };
        super::name::check_part(owner).map_err(|what| wrong(&what))?;
        if keys.len() > MOST_REVOKED {
            return Err(wrong(&format!("it names {} keys, at most {MOST_REVOKED}", keys.len())));
        }
        keys.into_iter().try_for_each(|key| key_id(key).map(drop))?;
        if is_date(date) { Ok(()) } else { Err(wrong(&format!("'{}' is no day such as 2026-11-28", printable(date)))) }
    }
}

/// Whether a text is a day of the form `2026-11-28`: as texts, earlier days come first.
fn is_date(text: &str) -> bool {
    let digits = |part: &str, count: usize| part.len() == count && part.bytes().all(|byte| byte.is_ascii_digit());
    let parts: Vec<&str> = text.split('-').collect();
    let [year, month, day] = parts[..] else { return false };
    let within = |part: &str, most: u32| part.parse().is_ok_and(|number: u32| (1..=most).contains(&number));
    digits(year, 4) && digits(month, 2) && digits(day, 2) && within(month, 12) && within(day, 31)
}

fn wrong(what: &str) -> Box<Diagnostic> {
    let message = format!("this is no signed statement on keys: {what}");
    Box::new(distrusted("E-TRUST-STATEMENT", message).help("get the file again from its owner; do not edit it"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{key_line, new_keys};

    fn keys() -> [String; 2] {
        let [secret, public] = new_keys(Password::None).unwrap();
        [secret, key_line(&public).unwrap()]
    }

    #[test]
    fn what_was_signed_is_read_and_nothing_else() {
        let ([secret, old], [_, new]) = (keys(), keys());
        let rotation = |old| Rotation { owner: "ada".to_owned(), old, new: new.clone(), date: "2026-11-28".to_owned() };
        let text = Statement::sign(|old| Statement::Rotation(rotation(old)), &secret, Password::None).unwrap();
        assert_eq!(Statement::open(&text).unwrap(), Statement::Rotation(rotation(old)));
        // Each byte of the body is under the signature, and the body has one form.
        let body = text.split("\n\n").next().unwrap().len();
        for at in 0..body {
            let mut bytes = text.clone().into_bytes();
            bytes[at] ^= 1;
            let changed = String::from_utf8(bytes).unwrap();
            assert!(Statement::open(&changed).is_err(), "byte {at}");
        }
        assert!(Statement::open(&text.replace("date:", "date: ")).is_err());
        // Nobody speaks for another key.
        assert!(
            Statement::sign(|_| Statement::Rotation(rotation(new.clone())), &secret, Password::None)
                .is_ok_and(|text| Statement::open(&text).is_err())
        );
    }

    #[test]
    fn a_list_has_a_number_a_day_and_keys() {
        let [secret, public] = keys();
        let signed = |number, date: &str, key: &str| {
            let (owner, date, revoked) = ("ada".to_owned(), date.to_owned(), vec![key.to_owned()]);
            let list = |issuer| Statement::Revocations(Revocations { owner, issuer, number, date, revoked });
            Statement::sign(list, &secret, Password::None)
        };
        assert!(signed(1, "2026-11-28", &public).is_ok());
        for (number, date, key) in [
            (0, "2026-11-28", &*public),
            (1, "28.11.2026", &public),
            (1, "2026-13-01", &public),
            (1, "2026-11-28", "RWx"),
        ] {
            assert!(signed(number, date, key).is_err(), "{number} {date} {key}");
        }
    }
}
