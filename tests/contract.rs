use std::fmt::Write;
use std::mem::offset_of;

use filter_api::abi::{
    ABI_VERSION, BRIGHTNESS, ERROR, MESSAGE_BYTES, OK, PANIC, PLUGIN_SYMBOL, RawFirst, RawFrame, RawMount, RawMoved,
    RawParameter, RawPlugin, RawText,
};
use filter_api::{Format, ParameterKind};

use crate::support::filters::{c_native, c_wasm};
use crate::support::{Bench, root};

/// A C file that compiles only if the header agrees with these sizes, offsets and constants.
struct Claims(String);

impl Claims {
    fn new() -> Self {
        let mut claims = Self("#include \"filter.h\"\n".to_owned());
        let constants = [
            ("FILTER_ABI_VERSION", ABI_VERSION as usize),
            ("FILTER_MESSAGE_BYTES", MESSAGE_BYTES),
            ("FILTER_OK", OK as usize),
            ("FILTER_ERROR", ERROR as usize),
            ("FILTER_PANIC", PANIC as usize),
            ("FILTER_RGB", Format::Rgb.bit() as usize),
            ("FILTER_GREY", Format::Grey.bit() as usize),
            ("FILTER_MASK", Format::Mask.bit() as usize),
            ("FILTER_DEPTH", Format::Depth.bit() as usize),
            ("FILTER_BRIGHTNESS", BRIGHTNESS as usize),
            ("FILTER_NUMBER", ParameterKind::Number as usize),
            ("FILTER_WHOLE", ParameterKind::Whole as usize),
            ("FILTER_SWITCH", ParameterKind::Switch as usize),
        ];
        for (constant, value) in constants {
            claims.equal(constant, value);
        }
        claims
    }

    fn equal(&mut self, expression: &str, value: usize) {
        writeln!(self.0, "_Static_assert({expression} == {value}, \"{expression} is not {value}\");").unwrap();
    }

    fn size(&mut self, of: &str, bytes: usize) {
        self.equal(&format!("sizeof({of})"), bytes);
    }

    fn offset(&mut self, of: &str, field: &str, bytes: usize) {
        self.equal(&format!("offsetof({of}, {field})"), bytes);
    }

    /// As a C file, whose object file nobody needs.
    fn file(self, bench: &Bench) -> std::path::PathBuf {
        bench.write("claims.c", self.0);
        bench.path().join("claims.c")
    }
}

/// Says of each field of a struct where Rust has it, by the name that it has in C.
macro_rules! fields {
    ($claims:expr, $c:literal, $rust:ty: $($field:ident $(as $other:literal)?),*) => {
        $claims.size($c, size_of::<$rust>());
        offsets!($claims, $c, $rust: $($field $(as $other)?),*);
    };
}

/// Says so of some fields alone.
macro_rules! offsets {
    ($claims:expr, $c:literal, $rust:ty: $($field:ident $(as $other:literal)?),*) => {
        $($claims.offset($c, [$($other,)? stringify!($field)][0], offset_of!($rust, $field));)*
    };
}

#[test]
fn the_header_lays_structs_out_as_rust_does() {
    let mut claims = Claims::new();
    fields!(claims, "filter_text", RawText: bytes, length);
    fields!(claims, "filter_parameter", RawParameter: min, max, default as "default_value", name, unit, purpose, kind);
    fields!(claims, "filter_frame", RawFrame: width_px, height_px, stride_bytes, format, pixels);
    fields!(claims, "filter_mount", RawMount: focal_px, forward_m, height_m, tilt_sin, tilt_cos, fisheye);
    fields!(claims, "filter_moved", RawMoved: driven_m, turned_rad, jumped);
    fields!(claims, "filter_plugin", RawPlugin: first as "abi_version", mount, moved, keeps, save, load);
    offsets!(claims, "filter_plugin", RawFirst: abi_version, plugin_bytes, parameter_bytes, frame_bytes, name, version,
        licence, purpose, reads, writes, parameter_count, parameters, create, process, destroy);
    let bench = Bench::new();
    let out = bench.path().join("claims.o");
    c_native(&claims.file(&bench), &["-c"], &out);
}

/// Where the engine reads a field out of a 32-bit module: the struct, the field, the offset, and the engine's own words.
const READ_AT: &[(&str, &str, usize, &str)] = &[
    ("filter_plugin", "abi_version", 0, "let version = field(0)?"),
    ("filter_plugin", "plugin_bytes", 4, "[field(4)?, field(8)?, field(12)?]"),
    ("filter_plugin", "parameter_bytes", 8, "[field(4)?, field(8)?, field(12)?]"),
    ("filter_plugin", "frame_bytes", 12, "[field(4)?, field(8)?, field(12)?]"),
    ("filter_plugin", "name", 16, "name: text_at(16)?"),
    ("filter_plugin", "version", 24, "version: text_at(24)?"),
    ("filter_plugin", "licence", 32, "licence: text_at(32)?"),
    ("filter_plugin", "purpose", 40, "purpose: text_at(40)?"),
    ("filter_plugin", "reads", 48, "reads: field(48)?"),
    ("filter_plugin", "writes", 52, "writes: field(52)?"),
    ("filter_plugin", "parameter_count", 56, "(count, first) = (field(56)?, field(60)?)"),
    ("filter_plugin", "parameters", 60, "(count, first) = (field(56)?, field(60)?)"),
    ("filter_parameter", "min", 0, "min: real(0)?"),
    ("filter_parameter", "max", 8, "max: real(8)?"),
    ("filter_parameter", "default_value", 16, "default: real(16)?"),
    ("filter_parameter", "name", 24, "name: text(memory, address + 24)?"),
    ("filter_parameter", "unit", 32, "unit: text(memory, address + 32)?"),
    ("filter_parameter", "purpose", 40, "purpose: text(memory, address + 40)?"),
    ("filter_parameter", "kind", 48, "kind: number(memory, address + 48)?"),
    ("filter_text", "bytes", 0, "let start = number(memory, address)?"),
    ("filter_text", "length", 4, "let length = number(memory, address.checked_add(4)"),
];

#[test]
fn the_engine_reads_a_module_where_the_header_puts_its_fields() {
    let mut claims = Claims::new();
    let layout = std::fs::read_to_string(root().join("engine/core/src/filter/wasm/layout.rs")).unwrap();
    for (of, field, offset, words) in READ_AT {
        claims.offset(of, field, *offset);
        assert!(layout.contains(words), "layout.rs reads {field} of {of} elsewhere");
    }
    for (constant, of, bytes) in [
        ("PLUGIN", "filter_plugin", 96),
        ("PARAMETER", "filter_parameter", 56),
        ("FRAME", "filter_frame", 20),
        ("MOUNT", "filter_mount", 48),
        ("MOVED", "filter_moved", 24),
    ] {
        claims.size(of, bytes);
        assert!(layout.contains(&format!("const {constant}_BYTES: u32 = {bytes};")), "{constant}_BYTES");
    }
    // The engine writes frames as five numbers in a row.
    for (index, field) in ["width_px", "height_px", "stride_bytes", "format", "pixels"].into_iter().enumerate() {
        claims.offset("filter_frame", field, 4 * index);
    }
    let bench = Bench::new();
    let out = bench.path().join("claims.o");
    c_wasm(&claims.file(&bench), &["-c", "-Wno-unused-command-line-argument"], &out);
}

#[test]
fn the_header_exports_the_symbol_that_the_engine_looks_for() {
    let header = std::fs::read_to_string(root().join("plugins/filter-api/filter.h")).unwrap();
    assert!(header.contains(&format!("const filter_plugin {PLUGIN_SYMBOL} = ")));
    for function in ["", "_create", "_process", "_allocate", "_mount", "_moved", "_keeps", "_save", "_load"] {
        assert!(header.contains(&format!("FILTER_EXPORT_AS(\"{PLUGIN_SYMBOL}{function}\")")), "{function}");
    }
}
