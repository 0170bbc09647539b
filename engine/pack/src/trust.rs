//! Whom the user trusts: which key signs the packs of which owner.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::manifest::toml_error;
use super::name::check_part;
use super::{MAX_MANIFEST_BYTES, Pack, Signature, bundle, distrusted, key_id};
use engine::diagnostic::{Diagnostic, Result, SourceText, printable};
use insight::disk::{is_there, write_atomic};

/// The format of `trust.toml`.
const FORMAT: u32 = 1;

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
    },
}

impl Signer {
    /// The public key.
    #[must_use]
    pub fn key(&self) -> Option<&str> {
        match self {
            Self::Nobody => None,
            Self::Trusted { key } => Some(key),
        }
    }
}

fn first_format() -> u32 {
    FORMAT
}

impl Default for TrustStore {
    fn default() -> Self {
        Self { format: FORMAT, native: Vec::new(), keys: Vec::new(), revoked: Vec::new() }
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
        if store.format != FORMAT {
            return Err(wrong());
        }
        store.keys.iter().map(|key| &key.key).chain(&store.revoked).try_for_each(|key| key_id(key).map(|_| ()))?;
        Ok(store)
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
        if self.revoked.iter().any(|revoked| revoked == key) {
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
        if self.revoked.iter().any(|key| has_id(key)) {
            return distrusted("E-TRUST-REVOKED", format!("{} is signed by key {id}, which was revoked", pack.title()))
                .fail();
        }
        let (own, others): (Vec<_>, Vec<_>) = self.keys.iter().partition(|known| matches(&known.owner, owner));
        if let Some(known) = own.iter().find(|known| has_id(&known.key)) {
            signature.verify(pack, &known.key)?;
            return Ok(Signer::Trusted { key: known.key.clone() });
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
