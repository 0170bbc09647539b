use engine::pack::Digest;

use super::forge::{HEAD, pack_of, small_files};
use crate::support::Bench;

const SCRIPT: &[u8] = b"world(\"small\");\nfilter(\"ink\");\nrun(#{ steps: 400, test_steps: 100 });\n\
    rule \"contact\" when robot.contact => -1 then recover;\n";

/// A pack with one filter of its own, under this capability.
fn with_filter(capability: &str, path: &'static str, bytes: &'static [u8]) -> Vec<u8> {
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
    assert!(text.starts_with("exit status 5\nerror[E-PACK-CAPABILITY]"), "{text}");
}
