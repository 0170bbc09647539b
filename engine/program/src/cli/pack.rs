//! The command line of `engine pack`.

use std::path::PathBuf;

use clap::{Args, Subcommand};

use super::FilterSources;

const PACK_STATUS: &str = "Exit status: 0 done; 1 checked or replayed, but not good enough; 2 usage; 3 not a pack, or a wrong \
                           one; 4 a limit stopped it; 5 refused for trust; 6 files and disk.";

#[derive(Debug, Args)]
#[command(after_help = PACK_STATUS)]
pub(crate) struct PackArguments {
    #[command(subcommand)]
    pub(crate) command: PackCommand,
    /// Print as JSON on standard output, and nothing else there
    #[arg(long, global = true)]
    pub(crate) json: bool,
}

#[derive(Debug, Subcommand)]
pub(crate) enum PackCommand {
    /// Make a folder to start a pack from; it runs at once
    #[command(after_help = PACK_STATUS)]
    New(PackNewArguments),
    /// Is a pack's folder ready? It loads, every file is listed, it is licensed, a few seeds learn
    #[command(after_help = PACK_STATUS)]
    Check(FolderArguments),
    /// Learn the behaviour and make the pack: the same bytes from the same folder on every machine
    #[command(after_help = PACK_STATUS)]
    Build(BuildArguments),
    /// Make a pair of keys to sign packs with, in the format of minisign
    #[command(after_help = PACK_STATUS)]
    Keygen(KeygenArguments),
    /// Sign a pack: writes PACK.minisig beside it
    #[command(after_help = PACK_STATUS)]
    Sign(SignArguments),
    /// Trust a key to sign an owner's packs, or never trust it again; without an owner, list the trusted keys
    #[command(after_help = PACK_STATUS)]
    Trust(TrustArguments),
    /// Hand over to a new key: writes a statement, signed by the old one, that 'pack trust --said' takes
    #[command(after_help = PACK_STATUS)]
    Rotate(RotateArguments),
    /// Revoke keys of yours: writes a numbered list, signed by your key, that 'pack trust --said' takes
    #[command(after_help = PACK_STATUS)]
    Revoke(RevokeArguments),
    /// Check a pack's digests and signature; with --replay, learn it again and compare
    #[command(after_help = PACK_STATUS)]
    Verify(VerifyArguments),
    /// What is in a pack, who signed it, what it asks for, its figures; nothing in it is run
    #[command(after_help = PACK_STATUS)]
    Inspect(InspectArguments),
    /// Verify a pack and put it where 'engine run NAME' finds it; pins it in engine.lock
    #[command(after_help = PACK_STATUS)]
    Install(InstallArguments),
    /// The installed packs; with --gallery, as a page with a card for each
    #[command(after_help = PACK_STATUS)]
    List(ListArguments),
    /// Remove an installed pack
    #[command(after_help = PACK_STATUS)]
    Remove(RemoveArguments),
    /// Copy a pack and its signature to a folder or, built with the feature 'share', to an OCI registry
    #[command(after_help = PACK_STATUS)]
    Push(PushArguments),
    /// Fetch a pack and its signature from a file, a folder or, with the feature 'share', https or an OCI registry
    #[command(after_help = PACK_STATUS)]
    Pull(PullArguments),
}

#[derive(Debug, Args)]
pub(crate) struct PackNewArguments {
    /// The pack's name, owner/name such as ada/wall; without an owner, 'local' stands for it
    pub(crate) name: String,
    /// A script to make the pack of, with its world, its policies and its own filters; without it, wall following
    #[arg(long, value_name = "SCRIPT")]
    pub(crate) from: Option<PathBuf>,
    /// The folder [default: the name without its owner]
    #[arg(long, value_name = "FOLDER")]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) filters: FilterSources,
}

#[derive(Debug, Args)]
pub(crate) struct FolderArguments {
    /// The pack's folder
    #[arg(default_value = ".")]
    pub(crate) folder: PathBuf,
    #[command(flatten)]
    pub(crate) filters: FilterSources,
}

#[derive(Debug, Args)]
pub(crate) struct BuildArguments {
    /// The pack's folder
    #[arg(default_value = ".")]
    pub(crate) folder: PathBuf,
    /// Where the pack goes [default: OWNER-NAME-VERSION.pack]
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) filters: FilterSources,
}

#[derive(Debug, Args)]
pub(crate) struct KeygenArguments {
    /// The files are NAME.key, which is secret, and NAME.pub
    #[arg(default_value = "pack")]
    pub(crate) name: PathBuf,
    /// Do not protect the secret key by a password
    #[arg(long, conflicts_with = "password_stdin")]
    pub(crate) no_password: bool,
    /// Read the password from the first line of standard input
    #[arg(long)]
    pub(crate) password_stdin: bool,
}

#[derive(Debug, Args)]
pub(crate) struct SignArguments {
    /// The pack's file
    pub(crate) pack: PathBuf,
    /// The secret key's file
    #[arg(long, default_value = "pack.key", value_name = "FILE")]
    pub(crate) key: PathBuf,
    /// Read the password from the first line of standard input
    #[arg(long)]
    pub(crate) password_stdin: bool,
}

#[derive(Debug, Args)]
pub(crate) struct TrustArguments {
    /// The owner, such as ada; lab-* stands for every owner that starts with lab-
    #[arg(requires = "key")]
    pub(crate) owner: Option<String>,
    /// The public key, or the file that holds it
    #[arg(long, value_name = "KEY")]
    pub(crate) key: Option<String>,
    /// Put the key in the place of another one of the owner
    #[arg(long, requires = "owner")]
    pub(crate) replace: bool,
    /// Take what an owner said of their keys: a file of 'engine pack rotate' or 'engine pack revoke'
    #[arg(long, value_name = "FILE", conflicts_with_all = ["owner", "key", "replace", "revoke"])]
    pub(crate) said: Option<PathBuf>,
    /// Never trust this key again, for nobody
    #[arg(long, requires = "key", conflicts_with_all = ["owner", "replace"])]
    pub(crate) revoke: bool,
}

#[derive(Debug, Args)]
pub(crate) struct RotateArguments {
    /// The owner whose packs both keys sign
    pub(crate) owner: String,
    /// The new public key, or the file that holds it
    #[arg(long, value_name = "KEY")]
    pub(crate) to: String,
    #[command(flatten)]
    pub(crate) signing: SigningArguments,
}

#[derive(Debug, Args)]
pub(crate) struct RevokeArguments {
    /// The owner whose packs are meant
    pub(crate) owner: String,
    /// The public keys to revoke, or the files that hold them
    #[arg(required = true)]
    pub(crate) keys: Vec<String>,
    /// Which list this is: one more than the last one that you gave away
    #[arg(long, default_value_t = 1)]
    pub(crate) number: u64,
    #[command(flatten)]
    pub(crate) signing: SigningArguments,
}

#[derive(Debug, Args)]
pub(crate) struct SigningArguments {
    /// The secret key that signs the statement
    #[arg(long, default_value = "pack.key", value_name = "FILE")]
    pub(crate) key: PathBuf,
    /// The day of the statement, such as 2026-11-28 [default: today]
    #[arg(long, value_name = "DAY")]
    pub(crate) date: Option<String>,
    /// Where the statement goes [default: OWNER.rotation, OWNER.revoked]
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// Read the password from the first line of standard input
    #[arg(long)]
    pub(crate) password_stdin: bool,
}

#[derive(Debug, Args)]
pub(crate) struct VerifyArguments {
    /// The pack's file
    pub(crate) pack: PathBuf,
    /// Verify with this public key, or the file that holds it; without it, with the trusted keys
    #[arg(long, value_name = "KEY")]
    pub(crate) key: Option<String>,
    /// Accept a pack that is not signed
    #[arg(long)]
    pub(crate) allow_unsigned: bool,
    /// Learn what the pack claims again, and compare bit for bit
    #[arg(long)]
    pub(crate) replay: bool,
    #[command(flatten)]
    pub(crate) filters: FilterSources,
}

#[derive(Debug, Args)]
pub(crate) struct InspectArguments {
    /// The pack's file, or the name of an installed pack
    pub(crate) pack: PathBuf,
}

#[derive(Debug, Args)]
pub(crate) struct InstallArguments {
    /// A file, a folder, https://... or oci://host/name:version
    pub(crate) source: String,
    /// Which pack of a folder: owner/name, or owner/name@version
    #[arg(long)]
    pub(crate) name: Option<String>,
    /// A folder of packs that this one may build on; may be given again
    #[arg(long, value_name = "FOLDER")]
    pub(crate) from: Vec<PathBuf>,
    /// Grant what the pack asks for, such as filters_wasm:filters/edges.wasm; may be given again
    #[arg(long, value_name = "CAPABILITY")]
    pub(crate) grant: Vec<String>,
    /// Accept packs that are not signed
    #[arg(long)]
    pub(crate) allow_unsigned: bool,
    /// Accept an older version than the installed one
    #[arg(long)]
    pub(crate) allow_older: bool,
}

#[derive(Debug, Args)]
pub(crate) struct ListArguments {
    /// The packs in this folder instead of the installed ones
    #[arg(long, value_name = "FOLDER")]
    pub(crate) from: Option<PathBuf>,
    /// Write a page with a card for each pack to this folder: index.html
    #[arg(long, value_name = "FOLDER")]
    pub(crate) gallery: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct RemoveArguments {
    /// The pack's name
    pub(crate) name: String,
}

#[derive(Debug, Args)]
pub(crate) struct PushArguments {
    /// The pack's file
    pub(crate) pack: PathBuf,
    /// A folder, or oci://host/name; the version becomes the tag
    pub(crate) target: String,
    /// Push a pack that is not signed
    #[arg(long)]
    pub(crate) allow_unsigned: bool,
}

#[derive(Debug, Args)]
pub(crate) struct PullArguments {
    /// A file, a folder, https://..., oci://host/name:version or oci://host/name@sha256:...
    pub(crate) source: String,
    /// Which pack of a folder: owner/name, or owner/name@version
    #[arg(long)]
    pub(crate) name: Option<String>,
    /// The folder that the pack is written to
    #[arg(long, default_value = ".", value_name = "FOLDER")]
    pub(crate) out: PathBuf,
    /// Refuse anything but the pack with this digest: sha256:...
    #[arg(long, value_name = "DIGEST")]
    pub(crate) digest: Option<String>,
}
