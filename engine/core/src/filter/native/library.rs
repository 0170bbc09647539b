//! What stands in a library file, seen without loading it: loading would already run the library's constructors.

use std::path::Path;

use filter_api::abi::{ABI_VERSION, OLDEST_VERSION, PLUGIN_SYMBOL, RawFirst, RawFrame, RawParameter, RawPlugin};
use object::{Architecture, BinaryFormat, Object, ObjectSegment, ObjectSymbol};

use crate::diagnostic::{Diagnostic, Result, printable};
use crate::digest::Digest;
use crate::filter::trust::{self, Trust};

/// Reads a library whose digest is allowed, and checks that it is a whole library for this machine with a filter of this
/// version of the contract. Its bytes and its digest come back.
///
/// # Errors
/// If it is not allowed: what that would mean, and the exact words that allow it. If it is no such library: the likely
/// cause, and the cure.
pub(super) fn read(path: &Path, trust: &Trust) -> Result<(Vec<u8>, String)> {
    let bytes = trust::read(path)?;
    let digest = Digest::of(&bytes);
    if !trust.allows(&digest) {
        return Err(denied(path, trust, &digest));
    }
    check_library(path, &bytes)?;
    Ok((bytes, digest.to_string()))
}

fn denied(path: &Path, trust: &Trust, digest: &Digest) -> Box<Diagnostic> {
    let shown = printable(&path.display().to_string());
    let what = if trust.is_empty() {
        "is a native library and was not loaded"
    } else {
        "is not one of the native libraries that are allowed"
    };
    let help = format!(
        "a native filter can do all that you can do: read, change and send your files. If you trust it: \
         --allow-native=sha256:{digest}"
    );
    Box::new(Diagnostic::new("E-NATIVE-DENIED", format!("'{shown}' {what}")).help(help))
}

fn check_library(path: &Path, bytes: &[u8]) -> Result<()> {
    fault(bytes).map_or(Ok(()), |(what, help)| {
        let message = format!("'{}' {what}", printable(&path.display().to_string()));
        Diagnostic::new("E-NATIVE-ABI", message).help(help).fail()
    })
}

fn fault(bytes: &[u8]) -> Option<(String, String)> {
    let say = |what: &str, help: &str| Some((what.to_owned(), help.to_owned()));
    let Ok(file) = object::File::parse(bytes) else {
        if bytes.starts_with(b"\x7fELF") {
            return say("is a damaged native library", "copy or build it again; a part of the file may be missing");
        }
        return say("is not a native library", "build one: cargo build --release, or cc -shared");
    };
    let machine = match std::env::consts::ARCH {
        "x86_64" => Architecture::X86_64,
        "aarch64" => Architecture::Aarch64,
        "x86" => Architecture::I386,
        "arm" => Architecture::Arm,
        "riscv64" => Architecture::Riscv64,
        _ => file.architecture(),
    };
    if file.architecture() != machine {
        let what = format!("is for {:?} machines, this one is {:?}", file.architecture(), machine);
        return Some((what, "build it again on this machine".to_owned()));
    }
    let within = |(start, length): (u64, u64)| start.checked_add(length).is_some_and(|end| end <= bytes.len() as u64);
    if !file.segments().all(|segment| within(segment.file_range())) {
        return say("ends too early", "copy or build it again; a part of the file is missing");
    }
    let Some(symbol) =
        file.dynamic_symbols().find(|symbol| symbol.is_definition() && is_plugin(file.format(), symbol.name()))
    else {
        let what = format!("is a library, but not a filter: it has no '{PLUGIN_SYMBOL}'");
        return Some((what, "end the filter with filter_api::export!(PLUGIN), or FILTER_EXPORT in C".to_owned()));
    };
    let Some(head) = file.segments().find_map(|segment| segment.data_range(symbol.address(), 16).ok().flatten()) else {
        return say("keeps its descriptor outside of the file", "build it again with the contract's own macro");
    };
    wrong_version(head, symbol.size())
}

/// Whether the loader will find a symbol of this name in the file when it is asked for the plugin.
fn is_plugin(format: BinaryFormat, name: object::read::Result<&str>) -> bool {
    let prefix = if format == BinaryFormat::MachO { "_" } else { "" };
    name.is_ok_and(|name| name.strip_prefix(prefix) == Some(PLUGIN_SYMBOL))
}

/// Compares the first four numbers of a plugin, which stand in the file as they will stand in memory.
fn wrong_version(head: &[u8], symbol_bytes: u64) -> Option<(String, String)> {
    let numbers: Vec<u32> = head.as_chunks::<4>().0.iter().map(|bytes| u32::from_ne_bytes(*bytes)).collect();
    let [version, plugin, parameter, frame] = numbers[..] else { return None };
    if !(OLDEST_VERSION..=ABI_VERSION).contains(&version) {
        let what = format!("was built for version {version} of the filter contract, this engine has {ABI_VERSION}");
        return Some((what, "build it again with the filter-api (or filter.h) that belongs to this engine".to_owned()));
    }
    let plugin_bytes = if version == OLDEST_VERSION { size_of::<RawFirst>() } else { size_of::<RawPlugin>() };
    let wanted = [plugin_bytes, size_of::<RawParameter>(), size_of::<RawFrame>()];
    let found = [plugin, parameter, frame].map(|bytes| bytes as usize);
    // Only ELF states the size of a symbol.
    if found == wanted && (symbol_bytes == 0 || symbol_bytes >= wanted[0] as u64) {
        return None;
    }
    let what = format!("has structs of {found:?} bytes where this engine has {wanted:?}");
    Some((what, "build it again with the filter-api (or filter.h) that belongs to this engine".to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostic::Kind;

    #[test]
    fn a_library_is_read_only_if_its_digest_is_allowed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("ink.so");
        std::fs::write(&path, "abc").unwrap();
        // SHA-256 of "abc", FIPS 180-2 appendix B.1.
        let digest = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        let mut trust = Trust::default();
        let error = read(&path, &trust).err().unwrap();
        assert_eq!((error.code, error.kind()), ("E-NATIVE-DENIED", Kind::Trust));
        assert!(error.help.unwrap().ends_with(&format!("--allow-native=sha256:{digest}")));
        let file = folder.path().join("trust.toml");
        std::fs::write(&file, format!("native = [\"sha256:{digest}\"]\n")).unwrap();
        trust.allow_file(&file).unwrap();
        // Allowed, and now seen to be no library.
        assert_eq!(read(&path, &trust).err().unwrap().code, "E-NATIVE-ABI");
        std::fs::write(&path, "abd").unwrap();
        assert_eq!(read(&path, &trust).err().unwrap().code, "E-NATIVE-DENIED");
    }

    #[test]
    fn a_text_is_not_a_library() {
        let error = check_library(Path::new("ink.so"), b"int main() {}").err().unwrap();
        assert_eq!((error.code, error.message.as_str()), ("E-NATIVE-ABI", "'ink.so' is not a native library"));
    }

    #[test]
    fn a_library_that_is_no_filter_is_told_what_it_lacks() {
        // The program that runs this test is a whole file for this machine, and holds no filter.
        let program = std::fs::read(std::env::current_exe().unwrap()).unwrap();
        let error = check_library(Path::new("ink.so"), &program).err().unwrap();
        assert!(error.message.contains("not a filter"), "{}", error.message);
        assert!(check_library(Path::new("ink.so"), &program[..program.len() / 2]).is_err());
    }

    #[test]
    fn another_version_or_size_names_the_cure() {
        let head = |numbers: [u32; 4]| numbers.map(u32::to_ne_bytes).concat();
        let sizes = [size_of::<RawPlugin>(), size_of::<RawParameter>(), size_of::<RawFrame>()].map(|size| size as u32);
        assert_eq!(wrong_version(&head([2, sizes[0], sizes[1], sizes[2]]), 0), None);
        // A plugin of the first version is shorter.
        assert!(wrong_version(&head([1, sizes[0], sizes[1], sizes[2]]), 0).is_some());
        assert_eq!(wrong_version(&head([1, size_of::<RawFirst>() as u32, sizes[1], sizes[2]]), 0), None);
        for version in [0, 3, 999] {
            let (what, _) = wrong_version(&head([version, sizes[0], sizes[1], sizes[2]]), 0).unwrap();
            assert!(what.contains(&format!("version {version} ")), "{what}");
        }
        for plugin in [0, u32::MAX] {
            assert!(wrong_version(&head([2, plugin, sizes[1], sizes[2]]), 0).unwrap().0.contains("structs of"));
        }
        assert!(wrong_version(&head([2, sizes[0], sizes[1], sizes[2]]), 8).is_some());
    }
}
