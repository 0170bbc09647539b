//! The sandbox: a module may compute, write into its own memory and say a few words. It sees no file, clock or network.
//!
//! Fuel bounds its work: every instruction costs one, bulk instructions one for each byte. So a module that runs for ever is
//! stopped after the same instruction on every machine.

use std::path::Path;
use std::sync::Arc;

use filter_api::abi::{ABI_VERSION, MESSAGE_BYTES, OK};
use filter_api::{Descriptor, Format, Frame, FrameMut, Mount, Moved};
use wasmtime::{
    Caller, Config, Engine, Extern, ExternType, Instance, Linker, Memory, Module, OperatorCost, Store, StoreLimits,
    StoreLimitsBuilder, Trap, TypedFunc,
};

use super::kept::{KeptFunctions, mount_bytes, moved_bytes};
use super::layout::{FRAME_BYTES, Fault, MOUNT_BYTES, PARAMETER_BYTES, PLUGIN_BYTES, describe};
use super::limits::damaged;
use crate::diagnostic::{Diagnostic, Result, printable};
use crate::digest::Digest;
use crate::filter::described::{DescribedFilter, check_frames};
use crate::filter::entry::{Entry, Form};
use crate::filter::running::{Running, failed, refused, wrong_length};

const MEMORY_BYTES: usize = 64 << 20;
const TABLE_ELEMENTS: usize = 10_000;
const STACK_BYTES: usize = 512 << 10;
/// For loading, or creating an instance.
pub(super) const START_FUEL: u64 = 50_000_000;
/// For one frame, and for each of its pixels on top.
const FRAME_FUEL: u64 = 20_000_000;
const PIXEL_FUEL: u64 = 2_000;
/// A line of log costs as much as a thousand instructions, which is what it costs the host.
const LOG_FUEL: u64 = 1_000;
const LOG_BYTES: usize = 4096;

/// Compiles a module, and runs as much of it as is needed to hear what it is.
pub(super) fn open(path: &Path, bytes: &[u8]) -> Result<Entry> {
    let shown = printable(&path.display().to_string());
    let engine = engine().map_err(|error| {
        Box::new(Diagnostic::new("E-WASM-ENGINE", format!("WebAssembly does not work here: {error}")))
    })?;
    let module = Module::from_binary(&engine, bytes).map_err(|error| damaged(&shown, &error.to_string()))?;
    check_imports(&shown, &module)?;
    let sandbox = Arc::new(Sandbox { shown, engine, module });
    let descriptor = sandbox.describe()?.check("E-WASM-ABI", path)?;
    let create =
        move |values: &[f64]| -> Result<Box<dyn Running>> { Ok(Box::new(sandbox.create(descriptor, values)?)) };
    let (path, sha256) = (Some(path.to_owned()), Some(Digest::of(bytes).to_string()));
    Ok(Entry { descriptor, form: Form::Wasm, path, sha256, by_condition: false, create: Box::new(create) })
}

fn engine() -> wasmtime::Result<Engine> {
    // Growing memory moves it, and calls into the host: dearer than one instruction.
    let cost = OperatorCost { MemoryGrow: u8::MAX, TableGrow: u8::MAX, ..OperatorCost::new() };
    let mut config = Config::new();
    config.consume_fuel(true).operator_cost(cost);
    config.max_wasm_stack(STACK_BYTES);
    // Where the standard leaves a choice, machines could differ.
    config.cranelift_nan_canonicalization(true).wasm_relaxed_simd(false);
    config.wasm_memory64(false).wasm_multi_memory(false);
    Engine::new(&config)
}

fn check_imports(shown: &str, module: &Module) -> Result<()> {
    for import in module.imports() {
        let is_log = (import.module(), import.name()) == ("env", "log");
        let fits = matches!(import.ty(), ExternType::Func(function)
            if function.results().len() == 0 && function.params().len() == 2 && function.params().all(|ty| ty.is_i32()));
        if is_log && fits {
            continue;
        }
        let (from, name) = (printable(import.module()), printable(import.name()));
        let message = format!("'{shown}' wants '{name}' from '{from}'");
        let help = "filters may import only env.log(address: i32, length: i32); build without WASI, for \
                    wasm32-unknown-unknown or with clang --target=wasm32";
        return Diagnostic::new("E-WASM-IMPORT", message).help(help).fail();
    }
    Ok(())
}

struct Sandbox {
    shown: String,
    engine: Engine,
    module: Module,
}

/// What the host keeps for one instance.
struct Kept {
    limits: StoreLimits,
    log: String,
}

/// A module with its own memory.
pub(super) struct Guest {
    shown: String,
    store: Store<Kept>,
    memory: Memory,
    instance: Instance,
}

impl Sandbox {
    /// Starts an instance: its start function runs now.
    fn start(&self) -> Result<Guest> {
        let limits = StoreLimitsBuilder::new().memory_size(MEMORY_BYTES).table_elements(TABLE_ELEMENTS);
        let kept = Kept { limits: limits.memories(1).tables(4).instances(1).build(), log: String::new() };
        let mut store = Store::new(&self.engine, kept);
        store.limiter(|kept| &mut kept.limits);
        let stopped = |error: wasmtime::Error| trapped(&self.shown, "loading", &error, "");
        store.set_fuel(START_FUEL).map_err(stopped)?;
        let mut linker = Linker::new(&self.engine);
        linker.func_wrap("env", "log", log).map_err(stopped)?;
        let instance = linker.instantiate(&mut store, &self.module).map_err(stopped)?;
        let memory = instance.get_memory(&mut store, "memory").ok_or_else(|| self.lacks("memory", "a memory"))?;
        Ok(Guest { shown: self.shown.clone(), store, memory, instance })
    }

    fn lacks(&self, name: &str, wanted: &str) -> Box<Diagnostic> {
        let message = format!("'{}' has no export '{name}' that is {wanted}", self.shown);
        let help = "end the filter with filter_api::export!(PLUGIN), or FILTER_EXPORT in C";
        Box::new(Diagnostic::new("E-WASM-ABI", message).help(help))
    }

    fn describe(&self) -> Result<DescribedFilter> {
        let mut guest = self.start()?;
        let plugin =
            guest.function::<(), u32>("engine_filter").map_err(|_| self.lacks("engine_filter", "() -> i32"))?;
        self.functions(&mut guest)?;
        let address = guest.call(&plugin, (), START_FUEL, "describing itself")?;
        describe(guest.memory.data(&guest.store), address).map_err(|fault| {
            let (code, what) = match fault {
                Fault::Outside => ("E-WASM-OUTPUT", "points at a descriptor outside of its memory".to_owned()),
                Fault::Version(version) => (
                    "E-WASM-ABI",
                    format!("was built for version {version} of the filter contract, this engine has {ABI_VERSION}"),
                ),
                Fault::Sizes(sizes) => {
                    let wanted = [PLUGIN_BYTES, PARAMETER_BYTES, FRAME_BYTES];
                    ("E-WASM-ABI", format!("has structs of {sizes:?} bytes where this engine has {wanted:?}"))
                }
                Fault::Parameters(count) => ("E-WASM-ABI", format!("has {count} parameters; a filter may have 64")),
            };
            let help = "build it again with the filter-api (or filter.h) that belongs to this engine";
            Box::new(Diagnostic::new(code, format!("'{}' {what}", self.shown)).help(help))
        })
    }

    fn functions(&self, guest: &mut Guest) -> Result<Functions> {
        let wanted = |name: &str, arguments: &str| self.lacks(name, &format!("({arguments}) -> i32"));
        let create = guest.function("engine_filter_create");
        let process = guest.function("engine_filter_process");
        let allocate = guest.function("engine_filter_allocate");
        Ok(Functions {
            create: create.map_err(|_| wanted("engine_filter_create", "i32, i32, i32, i32"))?,
            process: process.map_err(|_| wanted("engine_filter_process", "i32, i32, i32, i32"))?,
            allocate: allocate.map_err(|_| wanted("engine_filter_allocate", "i32"))?,
            kept: KeptFunctions::of(guest),
        })
    }

    fn create(&self, descriptor: &'static Descriptor, values: &[f64]) -> Result<Sandboxed> {
        let mut guest = self.start()?;
        let functions = self.functions(&mut guest)?;
        let values_bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        // The values, the place for the instance, what it is told, two frames and the message, in this order.
        let fixed = values_bytes.len() as u32 + 8 + MOUNT_BYTES + 2 * FRAME_BYTES + 8 + MESSAGE_BYTES as u32;
        let start = guest.allocate(&functions, fixed)?;
        let place = start + values_bytes.len() as u32;
        let (told, frames) = (place + 8, place + 8 + MOUNT_BYTES);
        let message = frames + 2 * FRAME_BYTES + 8;
        guest.write(start, &values_bytes)?;
        guest.write(place, &[0; 4])?;
        guest.write(message, &[0])?;
        let arguments = (start, values.len() as u32, place, message);
        let status = guest.call(&functions.create, arguments, START_FUEL, "creating an instance")?;
        if status != OK {
            return Err(refused(&guest.words(message)));
        }
        let instance = guest.number(place)?;
        let keeps = functions.kept.keeps(&mut guest, instance)?;
        let kept_at = if keeps == 0 { 0 } else { guest.allocate(&functions, keeps)? };
        let (kept, pixels) = ((kept_at, keeps), [(0, 0); 2]);
        Ok(Sandboxed { descriptor, guest, functions, instance, told, frames, message, kept, pixels })
    }
}

pub(super) struct Functions {
    create: TypedFunc<(u32, u32, u32, u32), i32>,
    process: TypedFunc<(u32, u32, u32, u32), i32>,
    allocate: TypedFunc<u32, u32>,
    pub(super) kept: KeptFunctions,
}

/// An instance of a sandboxed filter, with the addresses of what it shares with the host.
struct Sandboxed {
    descriptor: &'static Descriptor,
    guest: Guest,
    functions: Functions,
    instance: u32,
    told: u32,
    frames: u32,
    message: u32,
    /// Address and length of what it keeps.
    kept: (u32, u32),
    /// Address and length of the pixels to read and of those to fill.
    pixels: [(u32, u32); 2],
}

impl Running for Sandboxed {
    fn process(&mut self, input: Frame<'_>, mut output: FrameMut<'_>) -> Result<()> {
        check_frames(self.descriptor, &input, &output)?;
        let guest = &mut self.guest;
        let (width, height, writes) = (input.width_px() as u32, input.height_px() as u32, output.format());
        let to = output.pixels();
        for ((address, length), wanted) in self.pixels.iter_mut().zip([input.pixels().len(), to.len()]) {
            if (*length as usize) < wanted {
                (*address, *length) = (guest.allocate(&self.functions, wanted as u32)?, wanted as u32);
            }
        }
        let frame = |format: Format, pixels: u32| {
            [width, height, width * format.channels() as u32, format.bit(), pixels].map(u32::to_le_bytes)
        };
        let [(from_address, _), (to_address, _)] = self.pixels;
        guest.write(from_address, input.pixels())?;
        // What the filter leaves out is what stood there, as in every form; a module must not keep frames by it.
        guest.write(to_address, to)?;
        guest.write(self.frames, frame(input.format(), from_address).as_flattened())?;
        guest.write(self.frames + FRAME_BYTES, frame(writes, to_address).as_flattened())?;
        guest.write(self.message, &[0])?;
        let fuel = FRAME_FUEL + PIXEL_FUEL * u64::from(width) * u64::from(height);
        let arguments = (self.instance, self.frames, self.frames + FRAME_BYTES, self.message);
        if guest.call(&self.functions.process, arguments, fuel, "filtering a frame")? != OK {
            return Err(failed("E-FILTER", self.descriptor.name, &guest.words(self.message)));
        }
        to.copy_from_slice(guest.read(to_address, to.len())?);
        Ok(())
    }

    fn mount(&mut self, mount: &Mount) -> Result<()> {
        let Some(function) = &self.functions.kept.mount else { return Ok(()) };
        self.guest.write(self.told, &mount_bytes(mount))?;
        self.guest.write(self.message, &[0])?;
        let arguments = (self.instance, self.told, self.message);
        let status = self.guest.call(function, arguments, START_FUEL, "hearing of the camera")?;
        self.outcome(status)
    }

    fn moved(&mut self, moved: &Moved) -> Result<()> {
        let Some(function) = &self.functions.kept.moved else { return Ok(()) };
        self.guest.write(self.told, &moved_bytes(moved))?;
        self.guest.call(function, (self.instance, self.told), START_FUEL, "hearing of the way")
    }

    fn keeps(&self) -> usize {
        self.kept.1 as usize
    }

    fn save(&mut self, kept: &mut [u8]) -> Result<()> {
        let (Some(function), (address, _)) = (&self.functions.kept.save, self.kept) else { return Ok(()) };
        self.guest.call(function, (self.instance, address), START_FUEL, "saving what it keeps")?;
        kept.copy_from_slice(self.guest.read(address, kept.len())?);
        Ok(())
    }

    fn load(&mut self, kept: &[u8]) -> Result<()> {
        let (Some(function), (address, bytes)) = (&self.functions.kept.load, self.kept) else { return Ok(()) };
        if kept.len() != bytes as usize {
            return Err(wrong_length(self.descriptor.name, bytes as usize, kept.len()));
        }
        self.guest.write(address, kept)?;
        self.guest.write(self.message, &[0])?;
        let arguments = (self.instance, address, bytes, self.message);
        let status = self.guest.call(function, arguments, START_FUEL, "loading what it kept")?;
        self.outcome(status)
    }
}

impl Sandboxed {
    fn outcome(&self, status: i32) -> Result<()> {
        match status {
            OK => Ok(()),
            _ => Err(failed("E-FILTER", self.descriptor.name, &self.guest.words(self.message))),
        }
    }
}

impl Guest {
    pub(super) fn function<Arguments, Results>(&mut self, name: &str) -> wasmtime::Result<TypedFunc<Arguments, Results>>
    where
        Arguments: wasmtime::WasmParams,
        Results: wasmtime::WasmResults,
    {
        self.instance.get_typed_func(&mut self.store, name)
    }

    pub(super) fn call<Arguments, Results>(
        &mut self,
        function: &TypedFunc<Arguments, Results>,
        arguments: Arguments,
        fuel: u64,
        doing: &str,
    ) -> Result<Results>
    where
        Arguments: wasmtime::WasmParams,
        Results: wasmtime::WasmResults,
    {
        let called = self.store.set_fuel(fuel).and_then(|()| function.call(&mut self.store, arguments));
        called.map_err(|error| trapped(&self.shown, doing, &error, &self.store.data().log))
    }

    /// Memory of the module that belongs to the host from now on.
    fn allocate(&mut self, functions: &Functions, bytes: u32) -> Result<u32> {
        let address = self.call(&functions.allocate, bytes, START_FUEL, "giving memory")?;
        // Numbers stand at multiples of 8.
        if address == 0 || address % 8 != 0 || self.read(address, bytes as usize).is_err() {
            return Err(self.outside("gave memory that it does not have, or no more memory"));
        }
        Ok(address)
    }

    fn read(&self, address: u32, length: usize) -> Result<&[u8]> {
        let memory = self.memory.data(&self.store);
        let found = memory.get(address as usize..).and_then(|bytes| bytes.get(..length));
        found.ok_or_else(|| self.outside("took memory back"))
    }

    fn write(&mut self, address: u32, bytes: &[u8]) -> Result<()> {
        let written = self.memory.write(&mut self.store, address as usize, bytes);
        written.map_err(|_| self.outside("took memory back"))
    }

    fn number(&self, address: u32) -> Result<u32> {
        let bytes = self.read(address, 4)?;
        Ok(bytes.first_chunk().map_or(0, |bytes| u32::from_le_bytes(*bytes)))
    }

    fn words(&self, address: u32) -> String {
        let bytes = self.read(address, MESSAGE_BYTES).unwrap_or_default();
        let words = bytes.split(|byte| *byte == 0).next().map(String::from_utf8_lossy).unwrap_or_default();
        if words.is_empty() { "it did not say why".to_owned() } else { words.into_owned() }
    }

    fn outside(&self, what: &str) -> Box<Diagnostic> {
        Box::new(Diagnostic::new("E-WASM-OUTPUT", format!("'{}' {what}", self.shown)))
    }
}

/// The one function that a module may import; it keeps the first words, and drops the rest.
fn log(mut caller: Caller<'_, Kept>, address: u32, length: u32) -> wasmtime::Result<()> {
    let left = caller.get_fuel()?;
    caller.set_fuel(left.checked_sub(LOG_FUEL).ok_or(Trap::OutOfFuel)?)?;
    let Some(Extern::Memory(memory)) = caller.get_export("memory") else { return Ok(()) };
    let (memory, kept) = memory.data_and_store_mut(&mut caller);
    let bytes = memory.get(address as usize..).and_then(|bytes| bytes.get(..length as usize));
    let bytes = bytes.ok_or(Trap::MemoryOutOfBounds)?;
    if kept.log.len() < LOG_BYTES {
        let rest = LOG_BYTES - kept.log.len();
        kept.log.push_str(&String::from_utf8_lossy(&bytes[..bytes.len().min(rest)]));
        kept.log.push('\n');
    }
    Ok(())
}

/// Why the module was stopped.
fn trapped(shown: &str, doing: &str, error: &wasmtime::Error, log: &str) -> Box<Diagnostic> {
    let (code, why) = match error.downcast_ref::<Trap>() {
        Some(Trap::OutOfFuel) => ("E-WASM-FUEL", "it took more instructions than a filter may".to_owned()),
        Some(Trap::StackOverflow) => ("E-WASM-TRAP", "its functions call each other too deep".to_owned()),
        Some(trap) => ("E-WASM-TRAP", trap.to_string()),
        // Without a trap it is one of the limits of the store, or of the module's own start.
        None => ("E-WASM-MEM", error.to_string()),
    };
    let said = log.lines().last().map_or(String::new(), |line| format!("; its last words: {}", printable(line)));
    let message = format!("'{shown}' was stopped while {doing}: {}{said}", printable(&why));
    Box::new(Diagnostic::new(code, message))
}
