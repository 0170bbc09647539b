use pack::Digest;

use super::forge::{HEAD, pack_of, small_files};
use crate::support::{Bench, root};

const SCRIPT: &[u8] = b"world(\"small\");\nfilter(\"ink\");\nrun(#{ steps: 400, test_steps: 100 });\n\
    rule \"contact\" when robot.contact => -1 then recover;\n";

/// A pack with one filter of its own, under this capability.
fn with_filter(capability: &str, path: &str, bytes: &[u8]) -> Vec<u8> {
    let files = small_files();
    let head = format!("{HEAD}\n[capabilities]\n{capability} = [\"{path}\"]\n");
    pack_of(&head, &[(path, bytes), files[0], (files[1].0, SCRIPT), files[2]])
}

#[test]
fn a_native_filter_of_a_pack_needs_its_grant_and_its_digest() {
    let bench = Bench::new();
    let library = b"\x7fELF and nothing more";
    bench.write("a.pack", with_filter("native", "filters/libink.so", library));
    let unsigned = "--allow-unsigned";
    let text = bench.failure(&["run", "a.pack", unsigned]);
    assert!(text.starts_with("exit status 5\nerror[E-TRUST-CAPABILITY]"), "{text}");
    let text = bench.failure(&["pack", "install", "a.pack", unsigned]);
    assert!(text.starts_with("exit status 5\nerror[E-TRUST-CAPABILITY]"), "{text}");
    assert!(text.contains("--grant native:filters/libink.so"), "{text}");
    bench.ok(&["pack", "install", "a.pack", unsigned, "--grant", "native:filters/libink.so"]);
    assert!(bench.read("engine.lock").contains("granted = [\"native:filters/libink.so\"]"));
    // Granted to be there is not yet allowed to run: that takes the digest of the very library.
    let text = bench.failure(&["run", "eve/small"]);
    let allow = format!("--allow-native=sha256:{}", Digest::of(library));
    assert!(text.starts_with("exit status 5\nerror[E-NATIVE-DENIED]") && text.contains(&allow), "{text}");
    let text = bench.failure(&["run", "eve/small", &allow]);
    assert!(text.starts_with("exit status 3") && !text.contains("E-NATIVE-DENIED"), "{text}");
}

#[test]
fn a_sandboxed_filter_of_a_pack_is_looked_for_in_the_pack() {
    let bench = Bench::new();
    let module = b"\0asm\x01\0\0\0";
    bench.write("a.pack", with_filter("filters_wasm", "filters/ink.wasm", module));
    bench.ok(&["pack", "install", "a.pack", "--allow-unsigned", "--grant", "filters_wasm:filters/ink.wasm"]);
    let text = bench.failure(&["run", "eve/small"]);
    // An empty module is no filter; a program without the sandbox says so. Both have found the file.
    assert!(text.contains("ink.wasm") && !text.contains("there is no filter"), "{text}");
    // The same script without the filter in the pack does not find one elsewhere.
    let files = small_files();
    bench
        .write("b.pack", pack_of(&HEAD.replace("eve/small", "eve/other"), &[files[0], (files[1].0, SCRIPT), files[2]]));
    assert!(bench.failure(&["run", "b.pack", "--allow-unsigned"]).contains("there is no filter 'ink'"));
}

#[test]
fn a_bridge_that_the_engine_does_not_have_is_not_given() {
    let bench = Bench::new();
    bench.write("a.pack", pack_of(&format!("{HEAD}\n[capabilities]\nbridge = true\n"), &small_files()));
    bench.ok(&["pack", "install", "a.pack", "--allow-unsigned", "--grant", "bridge"]);
    let text = bench.failure(&["run", "eve/small"]);
    assert!(text.starts_with("exit status 5\nerror[E-TRUST-CAPABILITY]"), "{text}");
}

/// A behaviour with a filter that is no part of the engine.
const BRIGHT: &str = "world(\"small\");\nfilter(\"bright\", #{ level: 118 });\nrun(#{ steps: 800, test_steps: 400 });\n\
    rule \"contact\" when robot.contact => -1 then recover;\n";

/// That filter in WebAssembly.
fn bright() -> Vec<u8> {
    wat::parse_str(std::fs::read_to_string(root().join("tests/fixtures/filters/bright.wat")).unwrap()).unwrap()
}

#[cfg(feature = "wasm")]
#[test]
fn a_pack_with_a_sandboxed_filter_goes_the_whole_way() {
    let bench = Bench::new();
    bench.write("bright.rhai", BRIGHT);
    bench.write("mine/bright.wasm", bright());
    bench.write("mine/other.wasm", b"never opened");
    bench.ok(&["pack", "new", "ada/bright", "--from", "bright.rhai", "--filter-dir", "mine"]);
    std::fs::remove_dir_all(bench.path().join("mine")).unwrap();
    let text = bench.read("bright/pack.toml");
    assert_eq!(text.matches("\"filters/bright.wasm\"").count(), 2, "listed and asked for: {text}");
    assert!(!text.contains("other"), "{text}");
    bench.ok(&["pack", "build", "bright", "--out", "a.pack"]);
    std::fs::remove_dir_all(bench.path().join("bright")).unwrap();
    bench.ok(&["pack", "keygen", "ada", "--no-password"]);
    bench.ok(&["pack", "sign", "a.pack", "--key", "ada.key"]);
    bench.ok(&["pack", "trust", "ada", "--key", "ada.pub"]);
    assert!(bench.ok(&["pack", "verify", "a.pack", "--replay"]).contains("reproduced bit for bit: 3 seeds"));
    assert!(bench.ok(&["pack", "inspect", "a.pack"]).contains("filters_wasm:filters/bright.wasm"));
    let text = bench.failure(&["pack", "install", "a.pack"]);
    assert!(text.starts_with("exit status 5\nerror[E-TRUST-CAPABILITY]"), "{text}");
    bench.ok(&["pack", "install", "a.pack", "--grant", "filters_wasm:filters/bright.wasm"]);
    let output = bench.engine(&["run", "ada/bright", "--seed", "2", "--out", "out"]);
    assert!(matches!(output.status.code(), Some(0 | 1)), "{}", crate::support::told(&output));
    // What the author measured is what the user sees, through the filter of the pack.
    let summary: serde_json::Value = serde_json::from_str(&bench.read("out/summary.json")).unwrap();
    let pack = pack::Pack::load(&bench.path().join("a.pack")).unwrap();
    let claim = &pack.manifest().evidence.as_ref().unwrap().seeds[1];
    assert_eq!((claim.seed, Some(claim.state_hash.as_str())), (2, summary["state_hash"].as_str()));
    let tested = bench.engine(&["test", "ada/bright"]);
    assert!(matches!(tested.status.code(), Some(0 | 1)), "{}", crate::support::told(&tested));
}

#[cfg(not(feature = "wasm"))]
#[test]
fn without_the_sandbox_a_pack_with_such_a_filter_says_how_to_get_it() {
    let bench = Bench::new();
    bench.write("bright.rhai", BRIGHT);
    bench.write("mine/bright.wasm", bright());
    let refused = |arguments: &[&str]| {
        let text = bench.failure(arguments);
        assert!(text.starts_with("exit status 2\nerror[E-WASM-BUILD]") && text.contains("--features wasm"), "{text}");
    };
    refused(&["pack", "new", "ada/bright", "--from", "bright.rhai", "--filter-dir", "mine"]);
    assert!(!bench.path().join("bright").exists());
    let (files, module) = (small_files(), bright());
    let head = format!("{HEAD}\n[capabilities]\nfilters_wasm = [\"filters/bright.wasm\"]\n");
    let script = (files[1].0, BRIGHT.as_bytes());
    bench.write("a.pack", pack_of(&head, &[("filters/bright.wasm", &module), files[0], script, files[2]]));
    refused(&["pack", "verify", "a.pack", "--allow-unsigned", "--replay"]);
    // Looking at it and installing it take no sandbox: nothing of it runs.
    bench.ok(&["pack", "verify", "a.pack", "--allow-unsigned"]);
    bench.ok(&["pack", "install", "a.pack", "--allow-unsigned", "--grant", "filters_wasm:filters/bright.wasm"]);
    refused(&["run", "eve/small"]);
}

#[test]
fn a_folder_of_filters_needs_a_script_that_uses_one() {
    let bench = Bench::new();
    bench.write("mine/bright.wasm", bright());
    let text = bench.failure(&["pack", "new", "ada/wall", "--filter-dir", "mine"]);
    assert!(text.starts_with("exit status 2\nerror[E-PACK-FOLDER]") && text.contains("add --from SCRIPT"), "{text}");
    bench.ok(&["pack", "new", "ada/short", "--from", "short.rhai", "--filter-dir", "mine"]);
    assert!(!bench.read("short/pack.toml").contains("bright") && !bench.path().join("short/filters").exists());
    // A native filter is opened only if that is said, for a pack as for a run.
    bench.write("native/libink.so", b"\x7fELF and nothing more");
    bench.write("ink.rhai", SCRIPT);
    let text = bench.failure(&["pack", "new", "ada/ink", "--from", "ink.rhai", "--filter-dir", "native"]);
    assert!(text.starts_with("exit status 5\nerror[E-NATIVE-DENIED]"), "{text}");
    assert!(!bench.path().join("ink").exists());
}
