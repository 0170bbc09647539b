//! A behaviour in one file that carries its own evidence and cannot hurt who opens it.
//!
//! A pack is an uncompressed tar in one canonical form. Reading goes through narrowing gates: [`archive`] allows regular
//! files with harmless names only, the manifest says which files there must be, and [`Pack`] is what passed both. Nothing
//! here runs what a pack holds but [`Pack::plan`] and what builds on it.

pub mod archive;
mod author;
mod bundle;
mod certified;
mod check;
mod entry_path;
mod evidence;
mod gallery;
mod lock;
mod manifest;
mod marks;
mod name;
mod probe;
mod resolve;
mod runnable;
mod scaffold;
mod shelf;
mod signature;
mod statement;
mod trust;

pub use author::{Author, build, draft};
pub use bundle::Pack;
pub use certified::CertifyLine;
pub use check::{PackFinding, check_pack};
pub use engine::digest::Digest;
pub use entry_path::EntryPath;
pub use evidence::measure;
pub use evidence::{Difference, Evidence, Proof, SeedClaim, replay};
pub use gallery::{Card, SignatureLine, gallery, signature_line};
pub use lock::{Lock, Locked};
pub use manifest::{Capabilities, Dependency, FileLine, Manifest, PackEntry};
pub use name::PackName;
pub use probe::fingerprint;
pub use resolve::{Offer, resolve};
pub use runnable::Runnable;
pub use scaffold::scaffold;
pub use shelf::Shelf;
pub use signature::{Password, Signature, key_id, key_line, needs_password, new_keys, sign};
pub use statement::{Revocations, Rotation, Statement};
pub use trust::{RetiredKey, RevocationList, Signer, TrustStore, TrustedKey};

use std::path::Path;

use engine::diagnostic::{Diagnostic, Result};

/// The largest pack, bytes.
pub const MAX_PACK_BYTES: usize = 64 << 20;
/// The most files in a pack, its manifest included.
pub const MAX_FILES: usize = 1000;
/// The most seeds that a pack's evidence can have.
const MAX_SEEDS: usize = 100;
/// The most steps of one seed's evidence, learning and test.
pub const MAX_SEED_STEPS: u64 = 1_000_000;
/// The most steps of a pack's evidence, all seeds together.
pub const MAX_EVIDENCE_STEPS: u64 = 10_000_000;
/// The largest manifest, bytes.
pub const MAX_MANIFEST_BYTES: usize = 512 << 10;
/// The largest key or signature, bytes.
const MAX_KEY_BYTES: usize = 16 << 10;
/// The ending of a pack's file.
pub const PACK_ENDING: &str = "pack";

/// A pack whose form is wrong: exit status 3.
fn malformed(code: &'static str, message: impl Into<String>) -> Diagnostic {
    Diagnostic::new(code, message)
}

/// A pack that cannot be trusted: exit status 5.
fn distrusted(code: &'static str, message: impl Into<String>) -> Diagnostic {
    Diagnostic::new(code, message)
}

/// Reads a small file of packs: a key or a signature.
///
/// # Errors
/// If it cannot be read, or is larger than any key.
pub fn read_small(path: &Path) -> Result<Vec<u8>> {
    bundle::read_limited(path, MAX_KEY_BYTES)
}
