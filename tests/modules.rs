use std::time::Duration;

use engine::diagnostic::Diagnostic;
use engine::filter::{Catalogue, Chain, Sources};
use engine::random::{Random, Stream};
use engine::sensors::observation::Image;
use engine::settings::FilterSettings;

use crate::support::filters::catalogue;
use crate::support::mutate::mutate;
use crate::support::{Bench, root};

/// How long any module may take to be loaded, tried and used for one frame.
const DEADLINE: Duration = Duration::from_secs(1);

/// What this thread has had of a processor, which other work on the machine does not change; zero where nobody counts it.
fn worked() -> Duration {
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    Duration::from_nanos(told.split(' ').next().and_then(|nanoseconds| nanoseconds.parse().ok()).unwrap_or(0))
}

fn bright() -> String {
    std::fs::read_to_string(root().join("tests/fixtures/filters/bright.wat")).unwrap()
}

/// The good module with one piece of its text replaced.
fn changed(piece: &str, by: &str) -> Vec<u8> {
    let text = bright();
    assert_eq!(text.matches(piece).count(), 1, "{piece}");
    wat::parse_str(text.replace(piece, by)).unwrap()
}

/// The good module with code at the beginning of one of its functions: `;; plugin`, `create`, `process` or `allocate`.
fn doing(function: &str, code: &str) -> Vec<u8> {
    changed(&format!(";; {function}\n"), code)
}

/// Loads a module and filters one frame of 160x120 with it; the mask, or what was wrong.
fn tried(bytes: &[u8]) -> Result<Vec<u8>, Box<Diagnostic>> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("bright.wasm"), bytes).unwrap();
    let sources = Sources { folders: vec![folder.path().to_owned()], without_linked_in: true, ..Sources::default() };
    let catalogue = Catalogue::new(sources)?;
    let bright = FilterSettings::new("bright");
    let mut chain = Chain::new(&[bright], 160, 120, &catalogue).map_err(|error| error.error)?;
    chain.apply(&Image::new(160, 120)).map(<[u8]>::to_vec)
}

/// Expects a module to be refused with a code, in time, with exit status 4.
fn refused(what: &str, bytes: &[u8], code: &str, words: &str) {
    let started = worked();
    let error = tried(bytes).err().unwrap_or_else(|| panic!("{what}: not refused"));
    let took = worked() - started;
    assert_eq!((error.code, error.kind().exit_status()), (code, 4), "{what}: {error}");
    let text = error.render(false);
    assert!(text.contains(words), "{what}: no '{words}' in: {text}");
    assert!(took < DEADLINE, "{what}: {took:?}");
}

#[test]
fn the_good_module_marks_what_is_bright_green() {
    let bench = Bench::new();
    bench.write("filters/bright.wasm", wat::parse_str(bright()).unwrap());
    let entry = catalogue(&bench.path().join("filters"), false).find("bright").unwrap();
    let mut out = [7; 3];
    let pixels = [255, 127, 255, 0, 128, 0, 0, 129, 0];
    let input = filter_api::Frame::new(3, 1, filter_api::Format::Rgb, &pixels).unwrap();
    let output = filter_api::FrameMut::new(3, 1, filter_api::Format::Mask, &mut out).unwrap();
    entry.start(&[128.0]).unwrap().process(input, output).unwrap();
    assert_eq!(out, [0, 255, 255]);
    let parameter = entry.descriptor.parameters[0];
    assert_eq!((parameter.name, parameter.min, parameter.max, parameter.default), ("level", 0.0, 255.0, 128.0));
}

#[test]
fn endless_work_runs_out_of_fuel() {
    for function in ["plugin", "create", "process", "allocate"] {
        refused(function, &doing(function, "(loop (br 0))"), "E-WASM-FUEL", "more instructions");
    }
    let start = changed(
        ";; plugin\n",
        "(i32.const 1024))\n(func $forever (loop (br 0)))\n(start $forever)\n(func (result i32)\n",
    );
    refused("a start function", &start, "E-WASM-FUEL", "while loading");
    let fill = "(loop (memory.fill (i32.const 0) (i32.const 0) (i32.const 131072)) (br 0))";
    refused("bulk work", &doing("process", fill), "E-WASM-FUEL", "more instructions");
    let copy = "(drop (memory.grow (i32.const 900))) (loop (memory.copy (i32.const 0) (i32.const 1) (i32.const 50000000)) (br 0))";
    refused("a large copy", &doing("process", copy), "E-WASM-FUEL", "more instructions");
    let grow = "(loop (drop (memory.grow (i32.const 1))) (br 0))";
    refused("growing for ever", &doing("process", grow), "E-WASM-FUEL", "more instructions");
    let talk = bright().replace(";; imports\n", "(import \"env\" \"log\" (func $log (param i32 i32)))\n");
    let talk = talk.replace(";; process\n", "(loop (call $log (i32.const 0) (i32.const 65536)) (br 0))");
    refused("talking for ever", &wat::parse_str(talk).unwrap(), "E-WASM-FUEL", "more instructions");
}

#[test]
fn recursion_is_stopped() {
    let code = "(drop (call $process (i32.const 0) (i32.const 0) (i32.const 0) (i32.const 0)))";
    refused("recursion", &doing("process", code), "E-WASM-TRAP", "too deep");
}

#[test]
fn more_memory_than_there_may_be_is_not_given() {
    let use_it = "(drop (memory.grow (i32.const 65534))) (i32.store8 (i32.const 0xfffffff0) (i32.const 1))";
    refused("growing to 4 GiB", &doing("process", use_it), "E-WASM-TRAP", "out of bounds");
    let memory = "(memory (export \"memory\") 2)";
    refused("4 GiB at once", &changed(memory, &memory.replace(" 2)", " 65536)")), "E-WASM-MEM", "while loading");
    let table = doing("plugin", "(i32.const 1024)) (table 4000000000 funcref) (func (result i32)");
    refused("a table of 4e9", &table, "E-WASM-MEM", "while loading");
    let allocate = "(drop (memory.grow (i32.const 65534)))";
    assert!(tried(&doing("allocate", allocate)).is_ok(), "a module lives on when it gets no memory");
}

#[test]
fn what_the_processor_refuses_is_an_error() {
    let outside = "(drop (i32.load (i32.const 0x7ffffff0)))";
    refused("reading outside", &doing("process", outside), "E-WASM-TRAP", "out of bounds");
    refused("unreachable code", &doing("process", "(unreachable)"), "E-WASM-TRAP", "unreachable");
    refused("a division", &doing("process", "(drop (i32.div_s (i32.const 1) (i32.const 0)))"), "E-WASM-TRAP", "zero");
    let log = "(import \"env\" \"log\" (func $log (param i32 i32)))";
    let lies =
        bright().replace(";; imports\n", log).replace(";; process\n", "(call $log (i32.const 1) (i32.const -1))");
    refused("a log from outside", &wat::parse_str(lies).unwrap(), "E-WASM-TRAP", "out of bounds");
    let last = "(call $log (i32.const 1280) (i32.const 6)) (unreachable)";
    let said = bright().replace(";; imports\n", log).replace(";; process\n", last);
    refused("last words", &wat::parse_str(said).unwrap(), "E-WASM-TRAP", "its last words: bright");
}

#[test]
fn only_the_log_may_be_imported() {
    for import in [
        "(import \"wasi_snapshot_preview1\" \"fd_write\" (func (param i32 i32 i32 i32) (result i32)))",
        "(import \"env\" \"time\" (func (result i64)))",
        "(import \"env\" \"log\" (func (param i64)))",
        "(import \"env\" \"log\" (global i32))",
        "(import \"env\" \"table\" (table 1 funcref))",
    ] {
        refused(import, &changed(";; imports\n", import), "E-WASM-IMPORT", "filters may import only env.log");
    }
}

#[test]
fn a_missing_or_different_export_is_told_with_the_wanted_one() {
    for (name, signature) in [
        ("engine_filter", "() -> i32"),
        ("engine_filter_create", "(i32, i32, i32, i32) -> i32"),
        ("engine_filter_process", "(i32, i32, i32, i32) -> i32"),
        ("engine_filter_allocate", "(i32) -> i32"),
        ("memory", "a memory"),
    ] {
        let export = format!("(export \"{name}\")");
        refused(name, &changed(&export, ""), "E-WASM-ABI", signature);
        let other = wat::parse_str(
            bright()
                .replace(&export, "")
                .replace(";; imports\n", &format!("(func (export \"{name}\") (param i64) (result i64) (local.get 0))")),
        );
        refused(name, &other.unwrap(), "E-WASM-ABI", signature);
    }
}

#[test]
fn a_descriptor_of_another_version_or_size_or_with_wrong_texts_is_refused() {
    let head = "\"\\01\\00\\00\\00\" \"\\4c\\00\\00\\00\" \"\\38\\00\\00\\00\" \"\\14\\00\\00\\00\"";
    for (wrong, words) in [
        ("\"\\00\\00\\00\\00\"", "version 0 of"),
        ("\"\\e7\\03\\00\\00\"", "version 999 of"),
        ("\"\\01\\00\\00\\00\" \"\\00\\00\\00\\00\" \"\\38\\00\\00\\00\" \"\\14\\00\\00\\00\"", "structs of [0,"),
        (
            "\"\\01\\00\\00\\00\" \"\\ff\\ff\\ff\\ff\" \"\\38\\00\\00\\00\" \"\\14\\00\\00\\00\"",
            "structs of [4294967295,",
        ),
    ] {
        refused(words, &changed(head, wrong), "E-WASM-ABI", words);
    }
    let long = changed("\"\\00\\05\\00\\00\" \"\\06\\00\\00\\00\"", "\"\\00\\05\\00\\00\" \"\\ff\\ff\\ff\\ff\"");
    let error = tried(&long).err().unwrap();
    assert_eq!(error.code, "E-WASM-ABI", "{error}");
    let many = changed("\"\\04\\00\\00\\00\" \"\\01\\00\\00\\00\"", "\"\\04\\00\\00\\00\" \"\\ff\\ff\\ff\\ff\"");
    refused("4294967295 parameters", &many, "E-WASM-ABI", "a filter may have 64");
}

#[test]
fn addresses_outside_of_the_memory_are_refused() {
    for address in ["-16", "-76", "131072", "131064"] {
        if address != "131064" {
            refused(address, &doing("plugin", &format!("(return (i32.const {address}))")), "E-WASM-OUTPUT", "outside");
        }
        let memory = doing("allocate", &format!("(return (i32.const {address}))"));
        refused(address, &memory, "E-WASM-OUTPUT", "gave memory that it does not have");
    }
    refused("no memory", &doing("allocate", "(return (i32.const 0))"), "E-WASM-OUTPUT", "no more memory");
    refused("odd memory", &doing("allocate", "(return (i32.const 4099))"), "E-WASM-OUTPUT", "gave memory");
    let text = "\"\\00\\05\\00\\00\" \"\\06\\00\\00\\00\"";
    for wrong in ["\"\\f0\\ff\\ff\\ff\" \"\\20\\00\\00\\00\"", "\"\\ff\\ff\\ff\\ff\" \"\\ff\\00\\00\\00\""] {
        refused("a text", &changed(text, wrong), "E-WASM-OUTPUT", "outside");
    }
    let list = "\"\\50\\04\\00\\00\"";
    for wrong in ["\"\\f8\\ff\\ff\\ff\"", "\"\\f8\\ff\\01\\00\""] {
        refused("a list", &changed(list, wrong), "E-WASM-OUTPUT", "outside");
    }
}

#[test]
fn a_module_cut_anywhere_is_refused() {
    let whole = wat::parse_str(bright()).unwrap();
    // What comes last is the section of names, which nobody needs: a 0, its length, and its own name.
    let names = whole.windows(5).position(|bytes| bytes == b"\x04name").unwrap();
    let end = (0..names).rev().find(|index| whole[*index] == 0).unwrap();
    assert!(tried(&whole[..end]).is_ok());
    for length in 0..end {
        let started = worked();
        let error = tried(&whole[..length]).err().unwrap_or_else(|| panic!("{length} bytes are enough"));
        // A cut between two sections leaves a whole module that lacks something.
        assert!(["E-WASM-FORM", "E-WASM-ABI", "E-WASM-OUTPUT"].contains(&error.code), "{length}: {error}");
        assert!(worked() - started < DEADLINE, "{length}");
    }
    refused("half of it", &whole[..whole.len() / 2], "E-WASM-FORM", "copy or build it again");
}

#[test]
fn the_text_form_is_answered_with_how_to_translate_it() {
    refused("text", b" (module)", "E-WASM-FORM", "wat2wasm");
    refused("something else", b"\x7fELF", "E-WASM-FORM", "is not a WebAssembly module");
    refused("nothing", b"", "E-WASM-FORM", "is not a WebAssembly module");
}

/// A number as WebAssembly writes lengths: seven bits in each byte.
fn leb128(mut number: usize) -> Vec<u8> {
    let mut bytes = Vec::new();
    while number > 127 {
        bytes.push(number as u8 | 128);
        number >>= 7;
    }
    bytes.push(number as u8);
    bytes
}

/// A module of functions without arguments or results, all with one body.
fn functions(count: usize, body: &[u8]) -> Vec<u8> {
    let section = |kind: u8, content: &[u8]| [&[kind][..], &leb128(content.len()), content].concat();
    let types = section(1, &[1, 0x60, 0, 0]);
    let declared = section(3, &[leb128(count), vec![0; count]].concat());
    let bodies = [&leb128(body.len())[..], body].concat().repeat(count);
    [b"\0asm\x01\0\0\0", &types[..], &declared, &section(10, &[leb128(count), bodies].concat())].concat()
}

#[test]
fn what_would_take_long_to_compile_is_refused_before() {
    let nops = [&[0][..], &[1; 10 << 20], &[0x0b]].concat();
    refused("10 MB in one function", &functions(1, &nops), "E-WASM-SIZE", "bytes");
    refused("500,000 functions", &functions(500_000, &[0, 0x0b]), "E-WASM-SIZE", "functions");
    // 50,000 locals in each of 10,000 functions, which take ten bytes each.
    let locals = [&[1][..], &leb128(50_000), &[0x7f, 0x0b]].concat();
    refused("locals", &functions(10_000, &locals), "E-WASM-SIZE", "locals");
    // Loops in each other, and locals that are read in the innermost: each loop has to pass each of them on.
    let mut nested = [&[1][..], &leb128(5_000), &[0x7f]].concat();
    nested.extend([0x03, 0x40].repeat(10_000));
    (0..5_000).for_each(|local| nested.extend([&[0x20][..], &leb128(local), &[0x1a]].concat()));
    nested.extend([0x0c, 0x00]);
    nested.extend([0x0b].repeat(10_001));
    refused("nested loops", &functions(1, &nested), "E-WASM-SIZE", "locals");
}

#[test]
fn a_filter_with_a_memory_breaks_the_law() {
    let stateful = "(global.set $memory_of_frames (i32.xor (global.get $memory_of_frames) (i32.const 1)))
        (local.set $instance (select (i32.const 1) (local.get $instance) (global.get $memory_of_frames)))";
    refused("a memory", &doing("process", stateful), "E-WASM-STATE", "one frame in two ways");
    refused("nothing filled", &doing("process", "(return (i32.const 0))"), "E-WASM-STATE", "breaks the law");
    refused("a failure", &doing("process", "(return (i32.const 1))"), "E-FILTER", "did not say why");
}

#[test]
fn a_failure_of_a_module_is_exit_status_4_of_the_program() {
    let bench = Bench::new();
    bench.write("filters/bright.wasm", doing("process", "(loop (br 0))"));
    bench.write("mine.rhai", "world(\"small\");\nfilter(\"bright\");\nrule \"c\" when robot.contact => -1;\n");
    let text = bench.failure(&["run", "mine.rhai", "--filter-dir", "filters"]);
    assert!(text.starts_with("exit status 4\nerror[E-WASM-FUEL]") && text.contains("mine.rhai:2"), "{text}");
}

/// A damaged module; most of them shall get further than the first check.
fn damaged(random: &mut Random, bytes: &mut Vec<u8>) {
    mutate(random, bytes);
    bytes.resize(bytes.len().max(16), 0);
    bytes[..8].copy_from_slice(b"\0asm\x01\0\0\0");
}

#[test]
fn a_damaged_module_is_refused_or_works_and_never_takes_long() {
    let count = if std::env::var_os("ENGINE_LONG").is_some() { 100_000 } else { 2_000 };
    let whole = wat::parse_str(bright()).unwrap();
    let mut random = Random::new(4, Stream::Test);
    let (mut slowest, mut codes) = (Duration::ZERO, std::collections::BTreeMap::new());
    for index in 0..count {
        let mut bytes = whole.clone();
        damaged(&mut random, &mut bytes);
        let started = worked();
        let code = tried(&bytes).map_or_else(|error| error.code, |_| "works");
        let took = worked() - started;
        slowest = slowest.max(took);
        assert!(took < DEADLINE, "module {index}: {code} after {took:?}");
        *codes.entry(code).or_insert(0) += 1;
    }
    println!("{count} damaged modules, slowest {slowest:?}: {codes:?}");
}
