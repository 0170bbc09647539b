//! Any bytes as a pack: refused with an error, or read and then written again as the same bytes.

#![no_main]

use std::path::Path;

use pack::{Pack, Signature, archive};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    // The tail is also tried as a signature, which is read before anything is trusted.
    if let Ok(text) = std::str::from_utf8(bytes) {
        drop(Signature::parse(text));
    }
    let Ok(pack) = Pack::parse(Path::new("fuzz.pack"), bytes.to_vec()) else { return };
    let mut files: Vec<(&str, &[u8])> = pack.files().collect();
    files.sort_by_key(|(path, _)| (*path != "manifest.toml", *path));
    let mut again = Vec::new();
    archive::write(files, &mut again).expect("memory takes everything");
    assert!(again == bytes, "a pack has one form");
});
