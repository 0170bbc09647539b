//! Builds filters for tests, and opens them. Where a compiler is missing, a test says so and skips that form; with
//! `ENGINE_COMPILERS=required` in the environment it fails instead.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Arc, OnceLock};

use engine::filter::{Catalogue, Entry, Sources, Trust};
use sha2::{Digest, Sha256};

use super::root;

/// The filters of this project, none of which needs another library: they can be built without Cargo.
pub(crate) const FILTERS: [&str; 9] =
    ["blur", "chroma", "colour", "floor", "horizon", "relief", "scharr", "sobel", "threshold"];

/// What they are built with: the contract, and what compiles them for each processor.
const LIBRARIES_OF_FILTERS: [(&str, &str); 2] =
    [("filter_api", "plugins/filter-api/src/lib.rs"), ("dispatch", "engine/dispatch/src/lib.rs")];

/// SHA-256 of a file as `--allow-native` wants it.
pub(crate) fn digest(path: &Path) -> String {
    let hash = Sha256::digest(std::fs::read(path).unwrap());
    format!("sha256:{}", hash.iter().map(|byte| format!("{byte:02x}")).collect::<String>())
}

/// Only the filters of a folder, its native ones allowed; isolated with the program that is tested.
pub(crate) fn catalogue(folder: &Path, isolated: bool) -> Arc<Catalogue> {
    let mut trust = Trust::default();
    for entry in std::fs::read_dir(folder).unwrap() {
        trust.allow(&digest(&entry.unwrap().path())).unwrap();
    }
    let worker = isolated.then(|| env!("CARGO_BIN_EXE_engine").into());
    let sources = Sources { folders: vec![folder.to_owned()], trust, worker, without_linked_in: true };
    Arc::new(Catalogue::new(sources).unwrap())
}

/// Every filter of a catalogue, opened.
pub(crate) fn entries(catalogue: &Catalogue) -> Vec<Arc<Entry>> {
    catalogue.list().map(|(name, ..)| catalogue.find(name).unwrap()).collect()
}

/// The filters of this project in every form but linked in, by the words for it; built once.
pub(crate) fn forms() -> Vec<(&'static str, Arc<Catalogue>)> {
    static FOLDERS: OnceLock<Vec<(&str, PathBuf)>> = OnceLock::new();
    let folders = FOLDERS.get_or_init(|| {
        let mut folders = vec![("native", native())];
        if cfg!(feature = "wasm") {
            folders.extend(wasm("").map(|folder| ("WebAssembly", folder)));
            folders.extend(wasm("+simd128").map(|folder| ("WebAssembly with vectors", folder)));
        }
        folders
    });
    let mut forms: Vec<_> = folders.iter().map(|(form, folder)| (*form, catalogue(folder, false))).collect();
    forms.push(("native and isolated", catalogue(&folders[0].1, true)));
    forms
}

/// A folder for one form, which later runs of the tests write again.
fn folder(form: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(form);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn native() -> PathBuf {
    let folder = folder("native");
    for name in FILTERS {
        let source = root().join(format!("plugins/{name}/src/lib.rs"));
        rust_native(&source, name, &folder);
    }
    folder
}

/// A Rust filter as a native library of this machine.
pub(crate) fn rust_native(source: &Path, name: &str, folder: &Path) {
    static LIBRARIES: OnceLock<Vec<String>> = OnceLock::new();
    let libraries = LIBRARIES.get_or_init(|| {
        let build = |(name, source): (&str, &str)| {
            let path = self::folder("contract").join(format!("lib{name}.rlib"));
            let mut rustc = Command::new("rustc");
            rustc.args(["--edition=2021", "-Copt-level=3", "--crate-type=rlib", "--crate-name", name, "-o"]);
            done(rustc.arg(&path).arg(root().join(source)));
            format!("--extern={name}={}", path.display())
        };
        LIBRARIES_OF_FILTERS.map(build).into()
    });
    let mut rustc = Command::new("rustc");
    rustc.args([
        "--edition=2024",
        "-Copt-level=3",
        "--crate-type=cdylib",
        "--cfg=filter_library",
        "--crate-name",
        name,
    ]);
    rustc.args(libraries);
    rustc.env("CARGO_PKG_VERSION", env!("CARGO_PKG_VERSION")).arg(source);
    done(rustc.arg("-o").arg(folder.join(format!("lib{name}.so"))));
}

/// The filters as WebAssembly, if some Rust compiler here can make it.
fn wasm(features: &str) -> Option<PathBuf> {
    let has_target = |rustc: &&str| {
        let told = Command::new(rustc).args(["--print", "sysroot"]).output();
        let sysroot = told.map(|told| String::from_utf8_lossy(&told.stdout).trim().to_owned()).unwrap_or_default();
        Path::new(&sysroot).join("lib/rustlib/wasm32-unknown-unknown/lib").is_dir()
    };
    let Some(rustc) = ["rustc", "/usr/bin/rustc"].into_iter().find(has_target) else {
        missing("a Rust compiler for wasm32-unknown-unknown");
        return None;
    };
    let folder = folder(if features.is_empty() { "wasm" } else { "wasm-simd" });
    let command = |crate_type: &str, name: &str, source: &Path, out: &Path| {
        let mut command = Command::new(rustc);
        command.args(["--edition=2021", "-O", "--target=wasm32-unknown-unknown", "-Cpanic=abort", "-Cstrip=symbols"]);
        command.arg(format!("-Ctarget-feature={features}")).args(["--crate-type", crate_type, "--crate-name", name]);
        if exists("wasm-ld") {
            command.arg("-Clinker=wasm-ld");
        }
        command.env("CARGO_PKG_VERSION", env!("CARGO_PKG_VERSION")).arg(source).arg("-o").arg(out);
        command
    };
    let libraries = LIBRARIES_OF_FILTERS.map(|(name, source)| {
        let path = self::folder("contract").join(format!("lib{name}-wasm{features}.rlib"));
        done(&mut command("rlib", name, &root().join(source), &path));
        format!("--extern={name}={}", path.display())
    });
    for name in FILTERS {
        let (source, out) = (root().join(format!("plugins/{name}/src/lib.rs")), folder.join(format!("{name}.wasm")));
        let mut command = command("cdylib", name, &source, &out);
        done(command.arg("--cfg=filter_library").args(&libraries));
    }
    Some(folder)
}

/// A C filter as a native library, without a warning.
pub(crate) fn c_native(source: &Path, flags: &[&str], out: &Path) -> bool {
    c("cc", source, &[&["-shared", "-fPIC"], flags].concat(), out)
}

/// A C filter as a WebAssembly module, without a warning.
pub(crate) fn c_wasm(source: &Path, flags: &[&str], out: &Path) -> bool {
    if !exists("wasm-ld") {
        return missing("wasm-ld");
    }
    c("clang", source, &[&["--target=wasm32", "-nostdlib", "-Wl,--no-entry"], flags].concat(), out)
}

fn c(compiler: &str, source: &Path, flags: &[&str], out: &Path) -> bool {
    if !exists(compiler) {
        return missing(compiler);
    }
    let mut command = Command::new(compiler);
    command.args(["-std=c11", "-O2", "-Wall", "-Wextra", "-pedantic", "-Werror", "-I"]);
    command.arg(root().join("plugins/filter-api")).args(flags).arg(source).arg("-o").arg(out);
    done(&mut command);
    true
}

/// Whether a program can be started.
pub(crate) fn exists(program: &str) -> bool {
    Command::new(program).arg("--version").output().is_ok()
}

/// Says what a test leaves out for want of a compiler.
#[allow(clippy::print_stderr, reason = "nobody else would tell")]
pub(crate) fn missing(what: &str) -> bool {
    assert!(std::env::var_os("ENGINE_COMPILERS").is_none_or(|words| words != "required"), "there is no {what}");
    eprintln!("skipped: there is no {what}");
    false
}

fn done(command: &mut Command) {
    let told = command.output().unwrap();
    assert!(told.status.success(), "{command:?}\n{}", String::from_utf8_lossy(&told.stderr));
}
