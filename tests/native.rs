use std::path::{Path, PathBuf};
use std::process::Command;

use crate::support::filters::{c_native, digest, rust_native};
use crate::support::{Bench, root, told};

/// A hostile library in a scratch folder, with a script that uses it.
struct Hostile {
    bench: Bench,
    name: String,
}

impl Hostile {
    /// From a C file of the fixtures; nothing where there is no C compiler.
    fn c(name: &str, flags: &[&str]) -> Option<Self> {
        let hostile = Self::empty(name);
        c_native(&fixture(&format!("{name}.c")), flags, &hostile.library()).then_some(hostile)
    }

    /// From bytes.
    fn bytes(name: &str, bytes: &[u8]) -> Self {
        let hostile = Self::empty(name);
        std::fs::write(hostile.library(), bytes).unwrap();
        hostile
    }

    fn empty(name: &str) -> Self {
        let bench = Bench::new();
        let rule = "rule \"contact\" when robot.contact => -1 then recover;";
        let run = "run(#{ steps: 800, test_steps: 200 });";
        bench.write("mine.rhai", format!("world(\"small\");\n{run}\nfilter(\"{name}\");\n{rule}\n"));
        std::fs::create_dir(bench.path().join("filters")).unwrap();
        Self { bench, name: name.to_owned() }
    }

    fn library(&self) -> PathBuf {
        self.bench.path().join(format!("filters/{}.so", self.name))
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = self.bench.command(arguments);
        command.args(["--filter-dir", "filters"]).env("ENGINE_CONFIG_DIR", self.bench.path());
        command.env("LOADED_FILE", self.bench.path().join("loaded-file"));
        command
    }

    /// `engine run` with the library allowed, and isolated or not.
    fn run(&self, isolated: bool) -> Command {
        let mut command = self.command(&["run", "mine.rhai", "--out", "out"]);
        command.arg(format!("--allow-native={}", digest(&self.library())));
        if isolated {
            command.arg("--isolate");
        }
        command
    }

    fn was_loaded(&self) -> bool {
        self.bench.path().join("loaded-file").exists()
    }

    /// Runs it in both ways, and expects one exit status and words of the error.
    fn is_refused(&self, status: i32, words: &[&str]) {
        for isolated in [false, true] {
            expect(&mut self.run(isolated), status, words);
        }
    }

    /// Runs it in isolation, with frames counted from nothing.
    fn is_contained(&self, words: &[&str]) -> String {
        let count = self.bench.path().join("count");
        // There is no file before the first run.
        let _ = std::fs::remove_file(&count);
        expect(self.run(true).env("COUNT_FILE", count), 4, words)
    }
}

fn fixture(name: &str) -> PathBuf {
    root().join("tests/fixtures/filters").join(name)
}

fn expect(command: &mut Command, status: i32, words: &[&str]) -> String {
    let text = told(&command.output().unwrap());
    assert!(text.starts_with(&format!("exit status {status}\n")), "not {status}: {text}");
    for word in words {
        assert!(text.contains(word), "no '{word}' in: {text}");
    }
    text
}

/// The bytes of a good library, to be damaged.
fn good_bytes() -> Option<Vec<u8>> {
    let hostile = Hostile::c("bright", &[])?;
    Some(std::fs::read(hostile.library()).unwrap())
}

#[test]
fn a_library_that_nobody_allowed_is_not_even_loaded_and_the_words_that_allow_it_are_given() {
    let Some(loaded) = Hostile::c("loaded", &[]) else { return };
    let allow = format!("--allow-native={}", digest(&loaded.library()));
    loaded.bench.write("photo.png", std::fs::read(root().join("scripts/wall.png")).unwrap());
    for arguments in [
        &["run", "mine.rhai"][..],
        &["run", "mine.rhai", "--isolate"],
        &["bench", "--behaviour", "mine.rhai"],
        &["filter", "mine.rhai", "photo.png"],
        &["plugins", "show", "loaded"],
        &["plugins", "show", "loaded", "--isolate"],
    ] {
        expect(&mut loaded.command(arguments), 5, &["error[E-NATIVE-DENIED]", "all that you can do", &allow]);
        assert!(!loaded.was_loaded(), "{arguments:?}");
    }
    let list = loaded.command(&["plugins"]).output().unwrap();
    let list = String::from_utf8(list.stdout).unwrap();
    assert!(list.contains("cannot be used") && list.contains(&allow) && !loaded.was_loaded(), "{list}");
    expect(&mut loaded.command(&["plugins", "show", "loaded", &allow]), 0, &[]);
    assert!(loaded.was_loaded());
}

#[test]
fn the_digest_of_another_file_allows_nothing() {
    let Some(loaded) = Hostile::c("loaded", &[]) else { return };
    let other = format!("--allow-native=sha256:{}", "0".repeat(64));
    let words = ["error[E-NATIVE-DENIED]", &digest(&loaded.library())];
    expect(&mut loaded.command(&["run", "mine.rhai", &other]), 5, &words);
    loaded.bench.write("trust.toml", format!("native = [\"sha256:{}\"]\n", "f".repeat(64)));
    expect(&mut loaded.command(&["run", "mine.rhai"]), 5, &words);
    assert!(!loaded.was_loaded());
    let upper = format!("--allow-native={}", digest(&loaded.library()).to_uppercase());
    expect(&mut loaded.command(&["run", "mine.rhai", &upper]), 2, &["error[E-NATIVE-DIGEST]"]);
    assert!(!loaded.was_loaded());
}

#[test]
fn a_file_that_is_no_library_of_this_machine_is_refused() {
    Hostile::bytes("text", b"int main() {}").is_refused(3, &["error[E-NATIVE-ABI]", "is not a native library"]);
    Hostile::bytes("empty", b"").is_refused(3, &["error[E-NATIVE-ABI]", "is not a native library"]);
    let Some(good) = good_bytes() else { return };
    let mut foreign = good.clone();
    // The machine of an ELF file, e_machine: 8 is MIPS.
    foreign[18..20].copy_from_slice(&8_u16.to_ne_bytes());
    Hostile::bytes("foreign", &foreign).is_refused(3, &["error[E-NATIVE-ABI]", "machines", "again on this machine"]);
}

#[test]
fn a_library_cut_anywhere_is_refused() {
    let Some(good) = good_bytes() else { return };
    for length in [4, 5, 63, 64, 100, good.len() / 4, good.len() / 2, good.len() - 1] {
        Hostile::bytes("cut", &good[..length]).is_refused(3, &["error[E-NATIVE-ABI]", "again"]);
    }
}

#[test]
fn a_library_without_a_filter_is_refused_before_it_is_loaded() {
    let Some(no_symbol) = Hostile::c("no_symbol", &[]) else { return };
    no_symbol.is_refused(3, &["error[E-NATIVE-ABI]", "it has no 'engine_filter'", "FILTER_EXPORT"]);
    assert!(!no_symbol.was_loaded());
}

#[test]
fn another_version_or_other_sizes_are_refused_before_the_library_is_loaded() {
    let sizes = |plugin: &str| format!("-DHEAD=1,{plugin},sizeof(filter_parameter),sizeof(filter_frame)");
    for (head, words) in [
        ("-DHEAD=0,sizeof(filter_plugin),sizeof(filter_parameter),sizeof(filter_frame)", "for version 0 of"),
        ("-DHEAD=999,sizeof(filter_plugin),sizeof(filter_parameter),sizeof(filter_frame)", "for version 999 of"),
        ("-DHEAD=1,sizeof(filter_plugin),0,sizeof(filter_frame)", "has structs of"),
        ("-DHEAD=1,sizeof(filter_plugin),sizeof(filter_parameter),0xffffffffu", "has structs of"),
        (&sizes("0"), "has structs of [0,"),
        (&sizes("0xffffffffu"), "has structs of [4294967295,"),
    ] {
        let Some(wrong) = Hostile::c("wrong_head", &[head]) else { return };
        wrong.is_refused(3, &["error[E-NATIVE-ABI]", words, "build it again"]);
        assert!(!wrong.was_loaded(), "{head}");
    }
}

#[test]
fn nulls_where_the_law_wants_something_are_refused() {
    let Some(function) = Hostile::c("null_function", &[]) else { return };
    function.is_refused(3, &["error[E-NATIVE-ABI]", "leaves out a part"]);
    Hostile::c("null_parameters", &[]).unwrap().is_refused(3, &["error[E-NATIVE-ABI]", "leaves out a part"]);
}

#[test]
fn a_null_instance_is_the_filter_s_own_business() {
    let Some(instance) = Hostile::c("null_instance", &[]) else { return };
    let bright = Hostile::c("bright", &[]).unwrap();
    let wanted = state_hash(&mut bright.run(false));
    assert_eq!([false, true].map(|isolated| state_hash(&mut instance.run(isolated))), [wanted.clone(), wanted]);
}

#[test]
fn a_text_of_4_gib_is_not_read() {
    let Some(huge) = Hostile::c("huge_text", &[]) else { return };
    huge.is_refused(3, &["error[E-NATIVE-ABI]", "the name '' must be"]);
}

#[test]
fn a_frame_that_is_not_filled_or_overfilled_is_found_out() {
    let Some(small) = Hostile::c("too_small", &[]) else { return };
    small.is_refused(4, &["error[E-NATIVE-STATE]", "'too_small' breaks the law of filters"]);
    let large = Hostile::c("too_large", &[]).unwrap();
    large.is_contained(&["error[E-FILTER-CRASH]", "'too_large'", "frame 0: its worker ended", "SIGSEGV"]);
    let forger = Hostile::c("forger", &[]).unwrap();
    forger.is_contained(&["error[E-FILTER-CRASH]", "'forger'", "frame 0: its worker sent a frame of another size"]);
}

#[test]
fn a_filter_with_a_memory_breaks_the_law() {
    let Some(stateful) = Hostile::c("stateful", &[]) else { return };
    stateful.is_refused(4, &["error[E-NATIVE-STATE]", "one frame in two ways", "same output"]);
}

#[test]
fn a_panic_is_an_error_with_its_words() {
    let panics = Hostile::empty("panics");
    rust_native(&fixture("panics.rs"), "panics", &panics.bench.path().join("filters"));
    std::fs::rename(panics.bench.path().join("filters/libpanics.so"), panics.library()).unwrap();
    panics.is_refused(4, &["error[E-FILTER-CRASH]", "'panics'", "no more room for 24 pixels"]);
    expect(&mut panics.run(true), 4, &["frame 0"]);
}

/// Ends of a filter, and how the worker's end is told.
const ENDS: [(&str, &str); 4] = [
    ("-DBREAK=exit(0)", "its worker ended (exit status: 0)"),
    ("-DBREAK=abort()", "SIGABRT"),
    ("-DBREAK=*(volatile char *)(intptr_t)getpid() = 1", "SIGSEGV"),
    ("-DBREAK=raise(SIGKILL)", "SIGKILL"),
];

#[test]
fn an_end_at_the_first_frame_is_contained() {
    for (end, words) in ENDS {
        let Some(breaks) = Hostile::c("breaks", &[end, "-DAT=1"]) else { return };
        breaks.is_contained(&["error[E-FILTER-CRASH]", "'breaks'", "frame 0", words]);
        assert!(!breaks.bench.path().join("out/policy.toml").exists());
    }
}

#[test]
fn a_worker_says_which_law_a_filter_broke() {
    let past = "((volatile uint8_t *)output->pixels)[(size_t)output->stride_bytes * output->height_px + 8] = 7";
    let before = "((volatile uint8_t *)output->pixels)[-5] = 7";
    let faults = [
        (past, "frame 0: it wrote outside of the frame that it is to fill, 8 bytes past the end"),
        (before, "frame 0: it wrote outside of the frame that it is to fill, 5 bytes before its beginning"),
        ("exit(0)", "frame 0: its worker ended (exit status: 0): it left the program by itself, as with exit()"),
    ];
    for (fault, words) in faults {
        let flag = format!("-DBEFORE_FRAME={fault};");
        let Some(breaks) = Hostile::c("bright", &[&flag, "-include", "stdlib.h"]) else { return };
        expect(&mut breaks.run(true), 4, &["error[E-FILTER-CRASH]", "'bright'", words]);
    }
    let threads = Hostile::c("threads", &[]).unwrap();
    let words = "frame 0: it started 1 threads that still run after the call";
    expect(&mut threads.run(true), 4, &["error[E-FILTER-CRASH]", "'threads'", words]);
}

#[test]
#[cfg(target_arch = "x86_64")]
fn a_filter_that_rounds_otherwise_changes_nothing_else() {
    let Some(plain) = Hostile::c("bright", &[]) else { return };
    // Flushes small numbers to 0 and rounds upwards, from its first frame on.
    let other = "-DBEFORE_FRAME=__builtin_ia32_ldmxcsr(0x1f80 | 0x8000 | 0x4000 | 0x40);";
    let rounds = Hostile::c("bright", &[other]).unwrap();
    let wanted = state_hash(&mut plain.run(false));
    assert_eq!([false, true].map(|isolated| state_hash(&mut rounds.run(isolated))), [wanted.clone(), wanted]);
}

#[test]
fn what_was_learned_until_a_filter_ended_is_kept() {
    for (end, words) in ENDS {
        let Some(breaks) = Hostile::c("breaks", &[end, "-DAT=500"]) else { return };
        breaks.is_contained(&["what was learned in", "error[E-FILTER-CRASH]", "'breaks'", "frame ", words]);
        let policy = breaks.bench.read("out/policy.toml");
        assert!(policy.parse::<toml::Table>().is_ok(), "{policy}");
    }
}

#[test]
fn an_endless_loop_is_ended_and_what_was_learned_is_kept() {
    let Some(at_once) = Hostile::c("breaks", &["-DBREAK=for (;;) sleep(1)", "-DAT=1"]) else { return };
    at_once.is_contained(&["error[E-FILTER-CRASH]", "'breaks'", "frame 0: no answer in 2 seconds"]);
    let later = Hostile::c("breaks", &["-DBREAK=for (;;) sleep(1)", "-DAT=500"]).unwrap();
    later.is_contained(&["what was learned in", "error[E-FILTER-CRASH]", "no answer in 2 seconds"]);
    assert!(later.bench.path().join("out/policy.toml").exists());
}

fn state_hash(command: &mut Command) -> String {
    let output = command.arg("--json").output().unwrap();
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|error| panic!("{error}: {}", String::from_utf8_lossy(&output.stderr)));
    summary["state_hash"].as_str().unwrap().to_owned()
}

#[test]
fn a_filter_that_ends_once_is_started_again_and_nothing_changes() {
    let Some(bright) = Hostile::c("bright", &[]) else { return };
    let wanted = state_hash(&mut bright.run(false));
    assert_eq!(state_hash(&mut bright.run(true)), wanted);
    for (end, _) in ENDS {
        let breaks = Hostile::c("breaks", &[end, "-DAT=500", "-DONCE"]).unwrap();
        let count = breaks.bench.path().join("count");
        assert_eq!(state_hash(breaks.run(true).env("COUNT_FILE", &count)), wanted, "{end}");
        assert!(length(&count) > 1_000, "{end}");
    }
}

fn length(path: &Path) -> u64 {
    std::fs::metadata(path).unwrap().len()
}

#[test]
fn what_an_isolated_filter_prints_is_neither_a_reply_nor_output() {
    let Some(bright) = Hostile::c("bright", &[]) else { return };
    let printer = Hostile::c("printer", &[]).unwrap();
    assert_eq!(state_hash(&mut printer.run(true)), state_hash(&mut bright.run(false)));
}
