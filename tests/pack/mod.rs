/// Packs with filters of their own: granted, allowed, found.
mod filters;
/// Tars by hand, honest and hostile.
mod forge;

/// Archives that a reader could be fooled by, each refused with its error, through the library and the program.
mod archives;
/// What may be claimed, and how much of it may be measured again.
mod evidence;
/// From a new folder to an installed pack: every command in the order of its use.
pub(crate) mod flow;
/// Packs over https, from a real server with a certificate of its own.
#[cfg(feature = "share")]
mod https;
/// A small pack with every byte flipped, every file deleted, every truncation; and seeded mutants.
mod mutants;
/// Packs that build on packs.
mod needs;
/// Push and pull, with a real registry where one is installed.
mod places;
/// Strangers' scripts in a pack: all of them end, and in a clear error.
mod scripts;
/// The forty attacks of a stranger who gives away a pack, and where each is refused.
mod strangers;
/// Keys, signatures, locks: who is refused, and what to type then.
mod trust;
/// Scripts that use learned policies, and policies that come from packs.
mod uses;
