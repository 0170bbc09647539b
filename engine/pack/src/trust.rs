//! Whom the user trusts: which key signs the packs of which owner.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::manifest::toml_error;
use super::name::check_part;
use super::{MAX_MANIFEST_BYTES, Pack, Revocations, Rotation, Signature, Statement, bundle, distrusted, key_id};
use engine::diagnostic::{Diagnostic, Result, SourceText, printable};
use insight::disk::{is_there, write_atomic};

/// The format of `trust.toml`; the first one has neither keys that handed over nor lists.
const FORMAT: u32 = 2;

/// `trust.toml`: keys, and the owners that they sign for.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrustStore {
    #[serde(default = "first_format")]
    format: u32,
    /// Native filters that may be loaded: the same file lists them, and here they are only kept.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    native: Vec<String>,
    #[serde(rename = "key", default, skip_serializing_if = "Vec::is_empty")]
    keys: Vec<TrustedKey>,
    /// Public keys that are trusted for nothing any more.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    revoked: Vec<String>,
    /// Keys that handed over to others.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    retired: Vec<RetiredKey>,
    /// The newest list of revoked keys of each owner.
    #[serde(rename = "revocations", default, skip_serializing_if = "Vec::is_empty")]
    lists: Vec<RevocationList>,
}

/// A key that handed over to another one: what it has signed stays valid.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RetiredKey {
    /// The owner.
    pub owner: String,
    /// The old public key.
    pub key: String,
    /// The public key that took its place.
    pub by: String,
    /// The day on which it said so.
    pub date: String,
}

/// What an owner has revoked; it binds for the packs of that owner.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RevocationList {
    /// The owner.
    pub owner: String,
    /// The number of the list.
    pub number: u64,
    /// The day of the list.
    pub date: String,
    /// The public keys: those of all lists so far, since nothing is ever taken back.
    pub keys: Vec<String>,
}

/// One key and whose packs it signs.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrustedKey {
    /// An owner; `lab-*` stands for every owner that starts with `lab-`.
    pub owner: String,
    /// The public key of minisign.
    pub key: String,
}

/// Who signed a pack.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Signer {
    /// Nobody, and the user accepts that.
    Nobody,
    /// A key that is trusted for the pack's owner.
    Trusted {
        /// The public key.
        key: String,
        /// The keys of the same owner that handed over to it, one after the other.
        replaces: Vec<String>,
    },
}

impl Signer {
    /// The public key.
    #[must_use]
    pub fn key(&self) -> Option<&str> {
        match self {
            Self::Nobody => None,
            Self::Trusted { key, .. } => Some(key),
        }
    }

    /// Whether a key handed over to the one that signed.
    #[must_use]
    pub fn took_over(&self, key: &str) -> bool {
        matches!(self, Self::Trusted { replaces, .. } if replaces.iter().any(|old| old == key))
    }
}

fn first_format() -> u32 {
    1
}

impl Default for TrustStore {
    fn default() -> Self {
        let (keys, retired) = (Vec::new(), Vec::new());
        Self { format: FORMAT, native: Vec::new(), keys, revoked: Vec::new(), retired, lists: Vec::new() }
    }
}

impl TrustStore {
    /// Reads `trust.toml`; without a file, nobody is trusted.
    ///
    /// # Errors
    /// If the file is there but cannot be read, or is wrong.
    pub fn load(path: &Path) -> Result<Self> {
        if !is_there(path)? {
            return Ok(Self::default());
        }
        let wrong =
            || Box::new(distrusted("E-TRUST-STORE", format!("'{}' is no list of trusted keys", path.display())));
        let text = String::from_utf8(bundle::read_limited(path, MAX_MANIFEST_BYTES)?).map_err(|_| wrong())?;
        let source = SourceText::new(path, text);
        let store: Self = toml::from_str(&source.text).map_err(|error| toml_error(&source, &error))?;
        // A list of a later engine could hold refusals that this one would miss.
        if !(1..=FORMAT).contains(&store.format) {
            return Err(wrong());
        }
        let keys = store.keys.iter().map(|key| &key.key).chain(&store.revoked);
        let keys = keys.chain(store.retired.iter().flat_map(|retired| [&retired.key, &retired.by]));
        keys.chain(store.lists.iter().flat_map(|list| &list.keys)).try_for_each(|key| key_id(key).map(|_| ()))?;
        Ok(Self { format: FORMAT, ..store })
    }

    /// Writes `trust.toml`.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn save(&self, path: &Path) -> Result<()> {
        let text = toml::to_string(self).map_err(|error| {
            Box::new(Diagnostic::new("E-IO", format!("the trusted keys cannot be written: {error}")))
        })?;
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder)
                .map_err(|error| Box::new(Diagnostic::disk("create the folder", folder, &error)))?;
        }
        write_atomic(path, text.as_bytes())
    }

    /// The trusted keys.
    #[must_use]
    pub fn keys(&self) -> &[TrustedKey] {
        &self.keys
    }

    /// Trusts a key for an owner, in place of another key only with `replace`.
    ///
    /// # Errors
    /// `E-TRUST-KEY-CHANGED` if the owner has another key, `E-TRUST-REVOKED` for a revoked one.
    pub fn trust(&mut self, owner: &str, key: &str, replace: bool) -> Result<()> {
        let id = key_id(key)?;
        check_part(owner.strip_suffix('*').map_or(owner, |prefix| prefix.trim_end_matches(['.', '_', '-'])))
            .map_err(|what| Box::new(Diagnostic::new("E-PACK-NAME", what)))?;
        if self.is_revoked(owner, |revoked| revoked == key) {
            return distrusted("E-TRUST-REVOKED", format!("key {id} was revoked, and stays so")).fail();
        }
        if let Some(known) = self.keys.iter_mut().find(|known| known.owner == owner) {
            if known.key != key && !replace {
                let message = format!("'{owner}' has key {}, and {id} is another", key_id(&known.key)?);
                let help = "ask the owner over another way first; then: the same command with --replace";
                return distrusted("E-TRUST-KEY-CHANGED", message).help(help).fail();
            }
            key.clone_into(&mut known.key);
        } else {
            self.keys.push(TrustedKey { owner: owner.to_owned(), key: key.to_owned() });
            self.keys.sort_by(|a, b| a.owner.cmp(&b.owner));
        }
        Ok(())
    }

    /// Never trusts a key again.
    ///
    /// # Errors
    /// If the text is no public key.
    pub fn revoke(&mut self, key: &str) -> Result<()> {
        key_id(key)?;
        self.keys.retain(|known| known.key != key);
        if !self.revoked.iter().any(|known| known == key) {
            self.revoked.push(key.to_owned());
            self.revoked.sort();
        }
        Ok(())
    }

    /// Takes what an owner said of their keys, if a key that is trusted for them signed it. What a list revokes stays revoked.
    ///
    /// # Errors
    /// `E-TRUST-KEY` if the signer is not trusted for that owner, `E-TRUST-REVOKED` for a revoked signer or new key,
    /// `E-TRUST-ROLLBACK` if the owner has said something newer.
    pub fn take(&mut self, statement: &Statement) -> Result<()> {
        match statement {
            Statement::Rotation(rotation) => self.rotate(rotation),
            Statement::Revocations(list) => self.take_list(list),
        }
    }

    fn rotate(&mut self, rotation: &Rotation) -> Result<()> {
        let Rotation { owner, old, new, date } = rotation;
        let handed = |known: &RetiredKey| known.owner == *owner && known.key == *old;
        if let Some(known) = self.retired.iter().find(|known| handed(known)) {
            // Said twice is said once; a second heir is an older or a stolen word.
            let message = format!("key {} has handed over to another key on {}", key_id(old)?, known.date);
            return if known.by == *new { Ok(()) } else { distrusted("E-TRUST-ROLLBACK", message).fail() };
        }
        self.check_speaker(owner, old)?;
        if self.is_revoked(owner, |revoked| revoked == new) || self.retired.iter().any(|known| known.key == *new) {
            return distrusted("E-TRUST-REVOKED", format!("key {} was revoked or has retired", key_id(new)?)).fail();
        }
        match self.keys.iter_mut().find(|known| known.owner == *owner) {
            Some(known) => new.clone_into(&mut known.key),
            // Trusted by a pattern of several owners: this one now has a key of its own.
            None => self.keys.push(TrustedKey { owner: owner.clone(), key: new.clone() }),
        }
        self.keys.sort_by(|a, b| a.owner.cmp(&b.owner));
        let (owner, key, by) = (owner.clone(), old.clone(), new.clone());
        self.retired.push(RetiredKey { owner, key, by, date: date.clone() });
        Ok(())
    }

    fn take_list(&mut self, list: &Revocations) -> Result<()> {
        let Revocations { owner, issuer, number, date, revoked } = list;
        self.check_speaker(owner, issuer)?;
        let known = self.lists.iter_mut().find(|known| known.owner == *owner);
        if let Some(known) = &known
            && (*number < known.number || *date < known.date)
        {
            let message = format!(
                "list {number} of '{owner}', of {date}, is older than list {} of {}, which you have",
                known.number, known.date
            );
            return distrusted("E-TRUST-ROLLBACK", message).help("ask its owner for the newest list").fail();
        }
        let known = match known {
            Some(known) => known,
            None => {
                let (owner, date) = (owner.clone(), date.clone());
                self.lists.push(RevocationList { owner, number: *number, date, keys: Vec::new() });
                self.lists.sort_by(|a, b| a.owner.cmp(&b.owner));
                return self.take_list(list);
            }
        };
        (known.number, known.date) = (*number, date.clone());
        known.keys.extend_from_slice(revoked);
        known.keys.sort();
        known.keys.dedup();
        Ok(())
    }

    /// Refuses a statement by a key that may not speak for an owner.
    fn check_speaker(&self, owner: &str, key: &str) -> Result<()> {
        let id = key_id(key)?;
        if self.is_revoked(owner, |revoked| revoked == key) {
            return distrusted("E-TRUST-REVOKED", format!("the statement is signed by key {id}, which was revoked"))
                .fail();
        }
        if self.keys.iter().any(|known| known.key == key && matches(&known.owner, owner)) {
            return Ok(());
        }
        let message = format!("the statement is signed by key {id}, which is not trusted for '{owner}'");
        let help = format!("trust that key first, if it is theirs: engine pack trust {owner} --key KEY");
        distrusted("E-TRUST-KEY", message).help(help).fail()
    }

    /// Whether a key is revoked: by the user for everybody, or by an owner for their own packs.
    fn is_revoked(&self, owner: &str, is_it: impl Fn(&str) -> bool) -> bool {
        let of_owner = self.lists.iter().filter(|list| list.owner == owner).flat_map(|list| &list.keys);
        self.revoked.iter().chain(of_owner).any(|key| is_it(key))
    }

    /// A trusted key with those that handed over to it, the last one first.
    fn signer(&self, owner: &str, key: &str) -> Signer {
        let mut replaces: Vec<String> = Vec::new();
        let before = |key: &str| self.retired.iter().find(|known| known.owner == owner && known.by == key);
        let mut now = key;
        while let Some(known) = before(now).filter(|known| !replaces.contains(&known.key)) {
            replaces.push(known.key.clone());
            now = &known.key;
        }
        Signer::Trusted { key: key.to_owned(), replaces }
    }

    /// The keys that handed over to others.
    #[must_use]
    pub fn retired(&self) -> &[RetiredKey] {
        &self.retired
    }

    /// The newest list of revoked keys of each owner.
    #[must_use]
    pub fn lists(&self) -> &[RevocationList] {
        &self.lists
    }

    /// Who signed a pack, if that is enough: a valid signature by a key that is trusted for its owner, or no signature
    /// where `allow_unsigned` says so.
    ///
    /// # Errors
    /// `E-TRUST-...`: unsigned, unknown key, another owner's key, changed key, revoked key, or a signature that does not fit.
    pub fn judge(&self, pack: &Pack, signature: Option<&Signature>, allow_unsigned: bool) -> Result<Signer> {
        let owner = pack.manifest().name.owner();
        let Some(signature) = signature else {
            if allow_unsigned {
                return Ok(Signer::Nobody);
            }
            let message = format!("{} is not signed: nobody says that it is what it claims to be", pack.title());
            let help = "get its .minisig file beside it, or accept that with --allow-unsigned";
            return distrusted("E-TRUST-UNSIGNED", message).help(help).fail();
        };
        let id = signature.key_id();
        let has_id = |key: &str| key_id(key).is_ok_and(|own| own == id);
        if self.is_revoked(owner, has_id) {
            return distrusted("E-TRUST-REVOKED", format!("{} is signed by key {id}, which was revoked", pack.title()))
                .fail();
        }
        let (own, others): (Vec<_>, Vec<_>) = self.keys.iter().partition(|known| matches(&known.owner, owner));
        if let Some(known) = own.iter().find(|known| has_id(&known.key)) {
            signature.verify(pack, &known.key)?;
            return Ok(self.signer(owner, &known.key));
        }
        if let Some(known) = self.retired.iter().find(|known| known.owner == owner && has_id(&known.key)) {
            signature.verify(pack, &known.key)?;
            return Ok(self.signer(owner, &known.key));
        }
        if let Some(other) = own.first() {
            let message = format!(
                "{} is signed by key {id}, but the packs of '{owner}' are signed by {}",
                pack.title(),
                key_id(&other.key)?
            );
            let help =
                format!("ask '{owner}' over another way; for a new key: engine pack trust {owner} --key KEY --replace");
            return distrusted("E-TRUST-KEY-CHANGED", message).help(help).fail();
        }
        if let Some(other) = others.iter().find(|known| has_id(&known.key)) {
            let message =
                format!("{} is signed by a key that is trusted for '{}' only", pack.title(), printable(&other.owner));
            return distrusted("E-TRUST-OWNER", message).help("do not use this pack").fail();
        }
        let message = format!("{} is signed by key {id}, which you do not know", pack.title());
        let help = format!("get the public key of '{owner}' from them, then: engine pack trust {owner} --key KEY");
        distrusted("E-TRUST-KEY", message).help(help).fail()
    }
}

fn matches(pattern: &str, owner: &str) -> bool {
    pattern.strip_suffix('*').map_or(pattern == owner, |prefix| owner.starts_with(prefix))
}
