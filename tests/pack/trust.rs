use std::path::Path;
use std::process::{Command, Stdio};

use pack::{Lock, Locked, Pack, PackName, Signer};

use super::flow::{signed_pack, small_folder};
use super::forge::{HEAD, pack_of, small_files};
use crate::support::Bench;

/// What the program refuses with, and the exit status of trust.
#[track_caller]
fn refused(bench: &Bench, arguments: &[&str], code: &str) -> String {
    let text = bench.failure(arguments);
    assert!(text.starts_with(&format!("exit status 5\nerror[{code}]")), "{text}");
    text
}

fn rebuild(bench: &Bench, version: &str, key: &str) -> String {
    small_folder(bench, "again", "ada/short");
    let text = bench.read("again/pack.toml").replace("version = \"0.1.0\"", &format!("version = \"{version}\""));
    bench.write("again/pack.toml", text);
    let file = format!("ada-short-{version}-{key}.pack");
    bench.ok(&["pack", "build", "again", "--out", &file]);
    bench.ok(&["pack", "sign", &file, "--key", &format!("{key}.key")]);
    std::fs::remove_dir_all(bench.path().join("again")).unwrap();
    file
}

#[test]
pub(super) fn an_unsigned_pack_is_refused_unless_that_is_said() {
    let bench = Bench::new();
    bench.write("small.pack", super::forge::small());
    for command in [
        &["pack", "verify", "small.pack"][..],
        &["pack", "install", "small.pack"],
        &["run", "small.pack"],
        &["test", "small.pack"],
    ] {
        assert!(refused(&bench, command, "E-TRUST-UNSIGNED").contains("--allow-unsigned"));
    }
    bench.ok(&["pack", "install", "small.pack", "--allow-unsigned"]);
    let output = bench.engine(&["run", "small.pack", "--allow-unsigned", "--out", "out"]);
    assert!(matches!(output.status.code(), Some(0 | 1)));
}

#[test]
pub(super) fn a_key_that_is_revoked_stops_what_is_installed_and_no_fault_of_the_disk_gives_it_back() {
    let bench = Bench::new();
    let file = signed_pack(&bench, "ada/short");
    bench.ok(&["pack", "install", &file]);
    let run = &["run", "ada/short", "--out", "out", "--force"][..];
    assert!(matches!(bench.engine(run).status.code(), Some(0 | 1)));
    bench.ok(&["pack", "trust", "--revoke", "--key", "ada.pub"]);
    for command in [run, &["test", "ada/short"], &["check", "ada/short"]] {
        refused(&bench, command, "E-TRUST-REVOKED");
    }
    // A list that cannot be read is not an empty one.
    let list = bench.path().join(".config/trust.toml");
    let before = std::fs::read(&list).unwrap();
    std::fs::remove_file(&list).unwrap();
    std::fs::create_dir(&list).unwrap();
    bench.ok(&["pack", "keygen", "carl", "--no-password"]);
    for command in [run, &["pack", "trust", "carl", "--key", "carl.pub"]] {
        assert!(!bench.engine(command).status.success(), "{command:?}");
    }
    std::fs::remove_dir(&list).unwrap();
    std::fs::write(&list, before).unwrap();
    refused(&bench, run, "E-TRUST-REVOKED");
}

#[test]
pub(super) fn of_two_that_change_trust_or_pins_at_once_one_is_told_who_does() {
    let bench = Bench::new();
    let file = signed_pack(&bench, "ada/short");
    let held = |of: &str| insight::disk::Lock::take(&bench.path().join(of)).unwrap();
    for (of, command) in [
        (".config/trust.toml", &["pack", "trust", "--revoke", "--key", "ada.pub"][..]),
        ("engine.lock", &["pack", "install", &file]),
        (".data/engine.lock", &["pack", "install", &file]),
        (".data/store", &["pack", "install", &file]),
    ] {
        std::fs::create_dir_all(bench.path().join(".data")).unwrap();
        let lock = held(of);
        let text = bench.failure(command);
        assert!(text.starts_with("exit status 6\nerror[E-LOCKED]"), "{of}: {text}");
        drop(lock);
    }
    bench.ok(&["pack", "install", &file]);
}

#[test]
pub(super) fn unknown_foreign_changed_and_revoked_keys_are_refused() {
    let bench = Bench::new();
    let file = signed_pack(&bench, "ada/short");
    bench.ok(&["pack", "verify", &file]);
    std::fs::remove_file(bench.path().join(".config/trust.toml")).unwrap();
    assert!(refused(&bench, &["pack", "verify", &file], "E-TRUST-KEY").contains("engine pack trust ada --key"));
    let missing = bench.failure(&["pack", "trust", "bob", "--key", "nosuch.pub"]);
    assert!(missing.contains("there is no key file 'nosuch.pub'"), "{missing}");
    bench.ok(&["pack", "trust", "bob", "--key", "ada.pub"]);
    refused(&bench, &["pack", "verify", &file], "E-TRUST-OWNER");
    bench.ok(&["pack", "keygen", "other", "--no-password"]);
    bench.ok(&["pack", "trust", "ada", "--key", "other.pub"]);
    refused(&bench, &["pack", "verify", &file], "E-TRUST-KEY-CHANGED");
    refused(&bench, &["pack", "trust", "ada", "--key", "ada.pub"], "E-TRUST-KEY-CHANGED");
    bench.ok(&["pack", "trust", "ada", "--key", "ada.pub", "--replace"]);
    bench.ok(&["pack", "verify", &file]);
    bench.ok(&["pack", "trust", "--revoke", "--key", "ada.pub"]);
    refused(&bench, &["pack", "verify", &file], "E-TRUST-REVOKED");
    refused(&bench, &["pack", "trust", "ada", "--key", "ada.pub"], "E-TRUST-REVOKED");
}

#[test]
pub(super) fn the_signature_of_another_pack_does_not_fit() {
    let bench = Bench::new();
    let file = signed_pack(&bench, "ada/short");
    let second = rebuild(&bench, "0.2.0", "ada");
    std::fs::copy(bench.path().join(format!("{file}.minisig")), bench.path().join(format!("{second}.minisig")))
        .unwrap();
    refused(&bench, &["pack", "verify", &second], "E-TRUST-SIGNATURE");
    let text = bench.read(&format!("{file}.minisig"));
    for broken in ["", "none", &text.replace("RUQ", "RWQ"), &text.replace("RUR", "RWR"), &text[..100]] {
        if broken != text {
            bench.write(&format!("{file}.minisig"), broken);
            refused(&bench, &["pack", "verify", &file], "E-TRUST-SIGNATURE");
        }
    }
}

#[test]
pub(super) fn a_changed_key_an_older_version_and_another_build_are_hard_stops() {
    let bench = Bench::new();
    let file = signed_pack(&bench, "ada/short");
    let newer = rebuild(&bench, "0.2.0", "ada");
    bench.ok(&["pack", "install", &newer]);
    assert!(refused(&bench, &["pack", "install", &file], "E-TRUST-VERSION").contains("--allow-older"));
    bench.ok(&["pack", "install", &file, "--allow-older"]);
    bench.ok(&["pack", "keygen", "other", "--no-password"]);
    let changed = rebuild(&bench, "0.3.0", "other");
    bench.ok(&["pack", "trust", "ada", "--key", "other.pub", "--replace"]);
    assert!(
        refused(&bench, &["pack", "install", &changed], "E-TRUST-KEY-CHANGED").contains("engine pack remove ada/short")
    );
    bench.ok(&["pack", "remove", "ada/short"]);
    bench.ok(&["pack", "install", &changed]);
}

#[test]
pub(super) fn what_is_installed_is_checked_again_before_it_runs() {
    let bench = Bench::new();
    let file = signed_pack(&bench, "ada/short");
    bench.ok(&["pack", "install", &file]);
    let lock = bench.read("engine.lock");
    let content = Pack::load(&bench.path().join(&file)).unwrap().content().to_string();
    bench.write("engine.lock", lock.replace(&content, &"0".repeat(64)));
    assert!(bench.failure(&["run", "ada/short"]).contains("E-PACK-MISSING"));
    bench.write("engine.lock", &lock);
    let script = bench.path().join(".data/store").join(content).join("scripts/short.rhai");
    std::fs::remove_file(&script).unwrap();
    std::fs::write(&script, "rule \"x\" when robot.contact => 1;").unwrap();
    refused(&bench, &["run", "ada/short"], "E-TRUST-DIGEST");
    refused(&bench, &["test", "ada/short"], "E-TRUST-DIGEST");
}

#[test]
pub(super) fn something_new_that_is_asked_for_is_granted_by_name_or_refused() {
    let head = format!("{HEAD}\n[capabilities]\nfilters_wasm = [\"filters/edges.wasm\"]\n");
    let mut files = small_files();
    files.insert(0, ("filters/edges.wasm", b"\0asm\x01\0\0\0"));
    let pack = Pack::parse(Path::new("a.pack"), pack_of(&head, &files)).unwrap();
    let plain = Pack::parse(Path::new("b.pack"), super::forge::small()).unwrap();
    let mut lock = Lock::default();
    lock.admit(&plain, &Signer::Nobody, &[], false).unwrap();
    let error = lock.admit(&pack, &Signer::Nobody, &[], false).unwrap_err();
    assert_eq!(error.code, "E-TRUST-CAPABILITY");
    assert_eq!(
        error.help.as_deref(),
        Some("if you want that: engine pack install, with --grant filters_wasm:filters/edges.wasm")
    );
    lock.admit(&pack, &Signer::Nobody, &["filters_wasm:filters/edges.wasm".to_owned()], false).unwrap();
    // What was granted once is not asked again, for this pack.
    lock.put(Locked::new(&pack, &Signer::Nobody));
    lock.admit(&pack, &Signer::Nobody, &[], false).unwrap();
    assert!(lock.get(&PackName::try_from("eve/small".to_owned()).unwrap()).is_some());
}

#[test]
pub(super) fn a_name_that_looks_like_another_is_warned_of() {
    let bench = Bench::new();
    bench.write("small.pack", super::forge::small());
    bench.write("fake.pack", pack_of(&HEAD.replace("eve/small", "eve/sma11"), &small_files()));
    bench.ok(&["pack", "install", "small.pack", "--allow-unsigned"]);
    let output = bench.engine(&["pack", "install", "fake.pack", "--allow-unsigned"]);
    let text = String::from_utf8(output.stderr).unwrap();
    assert!(text.contains("'eve/sma11' looks like 'eve/small'"), "{text}");
}

#[test]
pub(super) fn a_pack_for_another_engine_is_refused_before_it_is_installed() {
    let bench = Bench::new();
    bench.write("a.pack", pack_of(&HEAD.replace(">=0.1", ">=99"), &small_files()));
    assert!(bench.failure(&["pack", "install", "a.pack", "--allow-unsigned"]).contains("E-PACK-ENGINE"));
    assert!(!bench.path().join("engine.lock").exists());
}

#[test]
pub(super) fn a_policy_of_another_shape_is_the_authors_mistake() {
    let bench = Bench::new();
    bench.engine(&["run", "short.rhai", "--out", "run"]);
    let policy = bench.read("run/policy.toml").replace("rows = 3", "rows = 4");
    let head = format!("{HEAD}policy = \"policy.toml\"\n");
    let mut files = small_files();
    files.insert(0, ("policy.toml", policy.as_bytes()));
    bench.write("a.pack", pack_of(&head, &files));
    let text = bench.failure(&["test", "a.pack", "--allow-unsigned"]);
    assert!(text.starts_with("exit status 3\nerror[E-PACK-POLICY]"), "{text}");
}

#[test]
fn the_minisign_program_agrees_about_signatures() {
    let Ok(version) = Command::new("minisign").arg("-v").output() else {
        println!("skipped: minisign is not installed");
        return;
    };
    assert!(version.status.success());
    let bench = Bench::new();
    let file = signed_pack(&bench, "ada/short");
    let minisign = |arguments: &[&str]| {
        let mut command = Command::new("minisign");
        command.args(arguments).current_dir(bench.path()).stdin(Stdio::null());
        command.output().unwrap().status.success()
    };
    assert!(minisign(&["-V", "-p", "ada.pub", "-m", &file]));
    // And theirs, with our comment, is one of ours.
    let pack = Pack::load(&bench.path().join(&file)).unwrap();
    let comment = format!("engine-pack-v1 ada/short 0.1.0 sha256:{}", pack.content());
    assert!(minisign(&["-G", "-W", "-p", "their.pub", "-s", "their.key"]));
    assert!(minisign(&["-S", "-s", "their.key", "-m", &file, "-t", &comment]));
    bench.ok(&["pack", "verify", &file, "--key", "their.pub"]);
    assert!(minisign(&["-S", "-s", "their.key", "-m", &file, "-t", "another comment"]));
    refused(&bench, &["pack", "verify", &file, "--key", "their.pub"], "E-TRUST-SIGNATURE");
    assert!(minisign(&["-S", "-s", "their.key", "-m", &file]));
    let unnamed = refused(&bench, &["pack", "verify", &file, "--key", "their.pub"], "E-TRUST-SIGNATURE");
    assert!(unnamed.contains(&format!("minisign -S -t '{comment}'")), "{unnamed}");
}

#[test]
fn a_key_with_a_password_opens_only_with_it() {
    let bench = Bench::new();
    let file = signed_pack(&bench, "ada/short");
    let with = |arguments: &[&str], password: &str| {
        let mut child = bench
            .command(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        std::io::Write::write_all(&mut child.stdin.take().unwrap(), format!("{password}\n").as_bytes()).unwrap();
        child.wait().unwrap().code().unwrap()
    };
    assert_eq!(with(&["pack", "keygen", "kept", "--password-stdin"], "open sesame"), 0);
    assert_eq!(with(&["pack", "sign", &file, "--key", "kept.key", "--password-stdin"], "sesame"), 3);
    assert_eq!(with(&["pack", "sign", &file, "--key", "kept.key", "--password-stdin"], "open sesame"), 0);
    bench.ok(&["pack", "verify", &file, "--key", "kept.pub"]);
    assert!(bench.failure(&["pack", "keygen", "kept", "--no-password"]).contains("is there already"));
}

#[test]
fn verify_and_inspect_open_no_socket_and_start_no_process() {
    let bench = Bench::new();
    let file = signed_pack(&bench, "ada/short");
    for command in ["verify", "inspect", "install"] {
        let mut trace = Command::new("strace");
        trace.args(["-f", "-o", "trace.txt", "-e", "trace=%network,execve,execveat,fork,vfork,clone,clone3"]);
        trace.arg(env!("CARGO_BIN_EXE_engine")).args(["pack", command, &file]).current_dir(bench.path());
        trace.env("ENGINE_CONFIG_DIR", bench.path().join(".config")).env("ENGINE_DATA_DIR", bench.path().join(".data"));
        let Ok(output) = trace.output() else {
            println!("skipped: strace is not installed");
            return;
        };
        if String::from_utf8_lossy(&output.stderr).contains("ptrace") {
            println!("skipped: strace may not trace here");
            return;
        }
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let calls = bench.read("trace.txt");
        let calls: Vec<&str> = calls.lines().filter(|line| line.contains('(')).collect();
        // The one call is the start of the program itself.
        assert!(calls.len() == 1 && calls[0].contains("execve"), "{command}: {calls:?}");
    }
}

/// A key of this name, and the pack of a version signed by it.
fn keygen(bench: &Bench, name: &str) {
    bench.ok(&["pack", "keygen", name, "--no-password"]);
}

#[test]
pub(super) fn a_key_hands_over_by_a_word_that_it_has_signed_and_never_back() {
    let bench = Bench::new();
    let old = signed_pack(&bench, "ada/short");
    bench.ok(&["pack", "install", &old]);
    keygen(&bench, "new");
    keygen(&bench, "eve");
    let new = rebuild(&bench, "0.2.0", "new");
    // Nobody hands over who is not trusted, and nobody but the key itself.
    bench.ok(&["pack", "rotate", "ada", "--to", "new.pub", "--key", "eve.key", "--out", "eve.rotation"]);
    refused(&bench, &["pack", "trust", "--said", "eve.rotation"], "E-TRUST-KEY");
    refused(&bench, &["pack", "install", &new], "E-TRUST-KEY-CHANGED");
    bench.ok(&["pack", "rotate", "ada", "--to", "new.pub", "--key", "ada.key", "--date", "2026-11-28"]);
    let text = bench.read("ada.rotation");
    bench.write("changed.rotation", text.replace("2026-11-28", "2026-11-29"));
    refused(&bench, &["pack", "trust", "--said", "changed.rotation"], "E-TRUST-STATEMENT");
    bench.ok(&["pack", "trust", "--said", "ada.rotation"]);
    // What the old key signed goes on; the new one replaces it; then there is no way back.
    let run = &["run", "ada/short", "--out", "out", "--force"][..];
    assert!(matches!(bench.engine(run).status.code(), Some(0 | 1)));
    bench.ok(&["pack", "install", &new]);
    assert!(matches!(bench.engine(run).status.code(), Some(0 | 1)));
    let newer = rebuild(&bench, "0.3.0", "ada");
    refused(&bench, &["pack", "install", &newer], "E-TRUST-KEY-CHANGED");
    // A second heir of the old key is refused, the same word again is not.
    bench.ok(&["pack", "rotate", "ada", "--to", "eve.pub", "--key", "ada.key", "--out", "second.rotation"]);
    refused(&bench, &["pack", "trust", "--said", "second.rotation"], "E-TRUST-ROLLBACK");
    bench.ok(&["pack", "trust", "--said", "ada.rotation"]);
}

#[test]
pub(super) fn a_signed_list_revokes_for_its_owner_and_is_never_rolled_back() {
    let bench = Bench::new();
    let file = signed_pack(&bench, "ada/short");
    bench.ok(&["pack", "install", &file]);
    keygen(&bench, "new");
    keygen(&bench, "bob");
    bench.ok(&["pack", "trust", "bob", "--key", "bob.pub"]);
    let list = |number: &str, day: &str, owner: &str, revoked: &str, key: &str| {
        let out = format!("{owner}-{number}-{revoked}");
        let key = format!("{key}.key");
        bench.ok(&["pack", "revoke", owner, revoked, "--number", number, "--date", day, "--key", &key, "--out", &out]);
        out
    };
    // Bob speaks for his own packs alone.
    let theirs = list("1", "2026-11-01", "ada", "ada.pub", "bob");
    refused(&bench, &["pack", "trust", "--said", &theirs], "E-TRUST-KEY");
    let own = list("1", "2026-11-01", "bob", "ada.pub", "bob");
    bench.ok(&["pack", "trust", "--said", &own]);
    let run = &["run", "ada/short", "--out", "out", "--force"][..];
    assert!(matches!(bench.engine(run).status.code(), Some(0 | 1)));
    // Ada hands over, and the new key revokes the old one: what is installed stops.
    bench.ok(&["pack", "rotate", "ada", "--to", "new.pub", "--key", "ada.key"]);
    bench.ok(&["pack", "trust", "--said", "ada.rotation"]);
    let second = list("2", "2026-11-20", "ada", "ada.pub", "new");
    bench.ok(&["pack", "trust", "--said", &second]);
    refused(&bench, run, "E-TRUST-REVOKED");
    // An older list changes nothing, by number or by day.
    for (number, day) in [("1", "2026-11-20"), ("3", "2026-11-19")] {
        let older = list(number, day, "ada", "bob.pub", "new");
        refused(&bench, &["pack", "trust", "--said", &older], "E-TRUST-ROLLBACK");
    }
    // A later one adds to it.
    let third = list("3", "2026-11-21", "ada", "bob.pub", "new");
    bench.ok(&["pack", "trust", "--said", &third]);
    refused(&bench, run, "E-TRUST-REVOKED");
    assert!(bench.ok(&["pack", "trust"]).contains("list 3 of 2026-11-21 revokes 2 keys"));
}
