//! Signatures in the format of minisign: Ed25519 over the whole pack, with a comment that names what was signed.

use std::io::Cursor;

use minisign::{KeyPair, PublicKey, SecretKey, SecretKeyBox, SignatureBox};

use super::{Pack, distrusted};
use engine::diagnostic::{Diagnostic, Result, printable};

/// The first word of the trusted comment: a signature for anything else never fits a pack.
const DOMAIN: &str = "engine-pack-v1";
/// Digits of the two signatures in their lines: 74 and 64 bytes in Base64.
const LINE_DIGITS: [usize; 2] = [100, 88];

/// A signature as it stands beside a pack, in `X.pack.minisig`.
#[derive(Clone)]
pub struct Signature {
    parsed: SignatureBox,
    text: String,
}

impl Signature {
    /// Reads a signature; nothing is verified yet.
    ///
    /// # Errors
    /// `E-TRUST-SIGNATURE` if it has not the form of minisign with prehashing, the only algorithm.
    pub fn parse(text: &str) -> Result<Self> {
        let wrong = || {
            let message = "the signature is not of the form that 'engine pack sign' and 'minisign -S' write";
            Box::new(distrusted("E-TRUST-SIGNATURE", message).help("get the pack and its signature again"))
        };
        let lines: Vec<&str> = text.lines().collect();
        let [_, first, _, second] = lines[..] else { return Err(wrong()) };
        // The library trusts these lengths.
        if [first.len(), second.len()] != LINE_DIGITS {
            return Err(wrong());
        }
        let parsed = SignatureBox::from_string(text).map_err(|_| wrong())?;
        if !parsed.is_prehashed() {
            return Err(wrong());
        }
        Ok(Self { parsed, text: text.to_owned() })
    }

    /// The text of the file.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The key's number as minisign shows it; a hint, since anyone can choose one.
    #[must_use]
    pub fn key_id(&self) -> String {
        hex_id(self.parsed.keynum())
    }

    /// Verifies the signature of a pack by a public key, and that the pack is the one that the signer meant.
    ///
    /// # Errors
    /// `E-TRUST-SIGNATURE` if it does not fit.
    pub fn verify(&self, pack: &Pack, public_key: &str) -> Result<()> {
        let key = public(public_key)?;
        let wrong = |what: &str| {
            let message = format!("the signature by key {} does not fit {}: {what}", self.key_id(), pack.title());
            Box::new(
                distrusted("E-TRUST-SIGNATURE", message).help("do not use this pack; get it again from its author"),
            )
        };
        minisign::verify(&key, &self.parsed, Cursor::new(pack.bytes()), true, false, false)
            .map_err(|_| wrong("the pack or the signature was changed, or they belong to others"))?;
        let comment = self.parsed.trusted_comment().map_err(|_| wrong("its comment is missing"))?;
        let meant = trusted_comment(pack);
        if comment != meant && !comment.starts_with(DOMAIN) {
            let unnamed = *wrong("its trusted comment does not name the pack, as when minisign signs without -t");
            return unnamed.help(format!("sign with engine pack sign, or with minisign -S -t '{meant}'")).fail();
        }
        if comment != meant {
            return Err(wrong(&format!("it was made for '{}'", printable(&comment))));
        }
        Ok(())
    }
}

impl std::fmt::Debug for Signature {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("Signature").field(&self.key_id()).finish()
    }
}

/// What a signature says about what it signs.
fn trusted_comment(pack: &Pack) -> String {
    let manifest = pack.manifest();
    format!("{DOMAIN} {} {} sha256:{}", manifest.name, manifest.version, pack.content())
}

/// What protects a secret key.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Password {
    /// Nothing.
    None,
    /// What a person types when they are asked on the terminal.
    Ask,
    /// This.
    Given(String),
}

/// Signs a pack; the password opens a protected key.
///
/// # Errors
/// If the key or its password is wrong.
pub fn sign(pack: &Pack, secret_key: &str, password: Password) -> Result<Signature> {
    let key = secret(secret_key, password)?;
    let comment = trusted_comment(pack);
    let untrusted = format!("signature of {}", pack.manifest().file_name());
    let signed = minisign::sign(None, &key, Cursor::new(pack.bytes()), Some(&comment), Some(&untrusted));
    let signed = signed.map_err(|error| key_error(&format!("signing failed: {error}")))?;
    Signature::parse(&signed.into_string())
}

pub(super) fn secret(text: &str, password: Password) -> Result<SecretKey> {
    let form = || key_error("the file holds no secret key in the form of minisign");
    let boxed = SecretKeyBox::from_string(text).map_err(|_| form())?;
    let password = match password {
        Password::None => {
            return boxed
                .into_unencrypted_secret_key()
                .map_err(|_| key_error("the key is protected by a password, or the file holds no secret key"));
        }
        Password::Ask => None,
        Password::Given(text) => Some(text),
    };
    boxed.into_secret_key(password).map_err(|_| key_error("the password does not open the key"))
}

/// Makes a pair of keys: the text of the secret and of the public one. Without a password the secret one is plain to read.
///
/// # Errors
/// If the system gives no random bytes.
pub fn new_keys(password: Password) -> Result<[String; 2]> {
    let pair = match password {
        Password::None => KeyPair::generate_unencrypted_keypair(),
        Password::Ask => KeyPair::generate_encrypted_keypair(None),
        Password::Given(text) => KeyPair::generate_encrypted_keypair(Some(text)),
    };
    let failed = |error| key_error(&format!("cannot make keys: {error}"));
    let KeyPair { pk, sk } = pair.map_err(failed)?;
    let secret = sk.to_box(Some("secret key for behaviour packs: keep it to yourself")).map_err(failed)?;
    let public = pk.to_box().map_err(failed)?;
    Ok([secret.into_string(), public.into_string()])
}

/// The number of a public key, as minisign shows it.
///
/// # Errors
/// If the text is no public key.
pub fn key_id(public_key: &str) -> Result<String> {
    Ok(hex_id(public(public_key)?.keynum()))
}

pub(super) fn public(text: &str) -> Result<PublicKey> {
    PublicKey::from_base64(text).map_err(|_| key_error("this is no public key of minisign: it starts with RW"))
}

/// The bytes of a key's number in minisign's order: the last byte first.
fn hex_id(bytes: &[u8]) -> String {
    bytes.iter().rev().map(|byte| format!("{byte:02X}")).collect()
}

fn key_error(message: &str) -> Box<Diagnostic> {
    let diagnostic = Diagnostic::new("E-PACK-KEY", message);
    Box::new(diagnostic.help("make keys with: engine pack keygen, or minisign -G"))
}

/// The line of a public key's file that holds the key; the text itself if it has only one line.
///
/// # Errors
/// If there is no such line.
pub fn key_line(text: &str) -> Result<String> {
    let line = text.lines().map(str::trim).rfind(|line| !line.is_empty() && !line.starts_with("untrusted comment:"));
    let line = line.ok_or_else(|| key_error("the file holds no public key"))?;
    public(line)?;
    Ok(line.to_owned())
}

/// Whether a secret key's file is protected by a password.
#[must_use]
pub fn needs_password(secret_key: &str) -> bool {
    SecretKeyBox::from_string(secret_key).is_ok_and(|boxed| boxed.into_unencrypted_secret_key().is_err())
}
