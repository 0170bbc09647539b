//! Filters in native libraries, loaded into this process. They are not sandboxed: a library can do all that its user can,
//! from the moment it is loaded, so only those come in whose digest the user named.

#![allow(unsafe_code, reason = "the room where native plugins are loaded")]

use std::ffi::{CStr, c_char, c_void};
use std::io::Write;
use std::path::Path;
use std::ptr::null_mut;

use filter_api::abi::{
    MESSAGE_BYTES, OK, OLDEST_VERSION, PANIC, PLUGIN_SYMBOL, RawDestroy, RawFirst, RawFrame, RawMount, RawMoved,
    RawParameter, RawPlugin, RawProcess, RawText,
};
use filter_api::{Descriptor, Format, Frame, FrameMut, Mount, Moved};
use libloading::Library;

use super::{library, rounding};
use crate::diagnostic::{Diagnostic, Result, printable};
use crate::filter::described::{
    DescribedFilter, DescribedParameter, LONGEST_TEXT_BYTES, MOST_PARAMETERS, check_frames,
};
use crate::filter::entry::Entry;
use crate::filter::running::{Running, failed, refused};
use crate::filter::trust::Trust;

/// Loads a library that the user allowed.
///
/// # Errors
/// If it is not allowed, is no library for this machine and this version of the contract, or describes itself wrongly.
pub(super) fn open(path: &Path, trust: &Trust) -> Result<Entry> {
    let (bytes, sha256) = library::read(path, trust)?;
    let plugin = load(path, &bytes)?;
    let descriptor = describe(plugin, path)?.check("E-NATIVE-ABI", path)?;
    let name = descriptor.name;
    let create = move |values: &[f64]| -> Result<Box<dyn Running>> {
        let native = Native::new(plugin, values).map_err(|Failure { panicked, words }| {
            if panicked { failed("E-FILTER-CRASH", name, &words) } else { refused(&words) }
        })?;
        Ok(Box::new(InProcess { descriptor, native }))
    };
    Ok(Entry::native(descriptor, path, sha256, Box::new(create)))
}

/// A plugin of a library, which stays loaded until the program ends.
#[derive(Clone, Copy)]
pub(super) struct LoadedLibrary {
    first: &'static RawFirst,
    /// The whole plugin; nothing of a library of the first version of the contract.
    whole: Option<&'static RawPlugin>,
}

// SAFETY: it points at constants of a library that is never unloaded.
unsafe impl Send for LoadedLibrary {}
// SAFETY: as above; the contract lets create run on many threads at once.
unsafe impl Sync for LoadedLibrary {}

/// Loads the bytes that were checked, not whatever stands at their path by now.
pub(super) fn load(path: &Path, bytes: &[u8]) -> Result<LoadedLibrary> {
    let disk = |error| Box::new(Diagnostic::disk("copy the library", path, &error));
    // The folder is private to this user, so nobody else can change the copy before it is loaded.
    let folder = tempfile::tempdir().map_err(disk)?;
    let copy = folder.path().join(path.file_name().unwrap_or_default());
    let mut file = std::fs::File::create(&copy).map_err(disk)?;
    file.write_all(bytes).map_err(disk)?;
    drop(file);
    let shown = printable(&path.display().to_string());
    let wrong = |why: &libloading::Error| {
        let message = format!("'{shown}' cannot be loaded: {}", printable(&why.to_string()));
        let help = "a library that it needs may be missing; build it again on this machine";
        Box::new(Diagnostic::new("E-NATIVE-ABI", message).help(help))
    };
    // SAFETY: loading runs the library's constructors; the user allowed this very file to do so.
    let library = rounding::kept(|| unsafe { Library::new(&copy) }).map_err(|error| wrong(&error))?;
    // Never unloaded: threads, statics and destructors of a library outlive its last filter.
    let library: &'static Library = Box::leak(Box::new(library));
    // SAFETY: `library::read` found a symbol of this name, of the size and version of a `RawPlugin`.
    let symbol = unsafe { library.get::<*const RawFirst>(PLUGIN_SYMBOL.as_bytes()) }.map_err(|error| wrong(&error))?;
    // SAFETY: as above; the static is constant and never unloaded.
    let first = unsafe { &**symbol };
    // SAFETY: as above; a plugin of a later version is a whole one.
    let whole = (first.abi_version > OLDEST_VERSION).then(|| unsafe { &*symbol.cast::<RawPlugin>() });
    Ok(LoadedLibrary { first, whole })
}

/// Copies a descriptor out of the library.
pub(super) fn describe(plugin: LoadedLibrary, path: &Path) -> Result<DescribedFilter> {
    let raw = plugin.first;
    let count = raw.parameter_count as usize;
    let functions = raw.create.is_some() && raw.process.is_some() && raw.destroy.is_some();
    if !functions || count > MOST_PARAMETERS || (count > 0 && raw.parameters.is_null()) {
        let message = format!("'{}' leaves out a part of its plugin", printable(&path.display().to_string()));
        let help = "its author must set create, process and destroy, and a list of at most 64 parameters";
        return Diagnostic::new("E-NATIVE-ABI", message).help(help).fail();
    }
    // SAFETY: the law says that a plugin points at `parameter_count` parameters.
    let parameters = if count == 0 { &[] } else { unsafe { std::slice::from_raw_parts(raw.parameters, count) } };
    Ok(DescribedFilter {
        name: text(raw.name),
        version: text(raw.version),
        licence: text(raw.licence),
        purpose: text(raw.purpose),
        reads: raw.reads,
        writes: raw.writes,
        parameters: parameters.iter().map(parameter).collect(),
    })
}

fn parameter(raw: &RawParameter) -> DescribedParameter {
    let RawParameter { kind, min, max, default, .. } = *raw;
    let (name, unit, purpose) = (text(raw.name), text(raw.unit), text(raw.purpose));
    DescribedParameter { name, unit, purpose, kind, min, max, default }
}

/// A text of a descriptor; what is too long to be one becomes an empty text, which no descriptor may have.
fn text(raw: RawText) -> String {
    if raw.bytes.is_null() || raw.length as usize > LONGEST_TEXT_BYTES {
        return String::new();
    }
    // SAFETY: the law says that a text points at `length` bytes that live as long as the library.
    let bytes = unsafe { std::slice::from_raw_parts(raw.bytes, raw.length as usize) };
    String::from_utf8_lossy(bytes).into_owned()
}

/// The most that a filter may keep, bytes.
const MOST_KEPT_BYTES: usize = 1 << 20;

/// Why a call of a library did not succeed.
#[derive(Debug, PartialEq)]
pub(super) struct Failure {
    /// Whether it broke down, rather than refused.
    pub(super) panicked: bool,
    /// Its own words.
    pub(super) words: String,
}

/// An instance of a native filter.
pub(super) struct Native {
    process: RawProcess,
    destroy: RawDestroy,
    /// What came with the second version of the contract.
    whole: Option<&'static RawPlugin>,
    instance: *mut c_void,
    keeps: usize,
}

// SAFETY: the law lets an instance move between threads; it never runs on two at once, since `process` borrows it.
unsafe impl Send for Native {}

impl Native {
    /// Creates an instance.
    pub(super) fn new(plugin: LoadedLibrary, values: &[f64]) -> std::result::Result<Self, Failure> {
        let LoadedLibrary { first, whole } = plugin;
        let (Some(create), Some(process), Some(destroy)) = (first.create, first.process, first.destroy) else {
            return Err(Failure { panicked: false, words: "it has no functions".to_owned() });
        };
        let mut instance = null_mut();
        let mut message = ForeignText::default();
        // SAFETY: the arguments are as the law says, and live through the call.
        let status = rounding::kept(|| unsafe {
            create(values.as_ptr(), values.len() as u32, &raw mut instance, message.pointer())
        });
        message.outcome(status)?;
        let mut native = Self { process, destroy, whole, instance, keeps: 0 };
        if let Some(keeps) = whole.and_then(|whole| whole.keeps) {
            // SAFETY: the instance is the library's own.
            native.keeps = rounding::kept(|| unsafe { keeps(instance) }) as usize;
        }
        if native.keeps > MOST_KEPT_BYTES {
            let words = format!("it wants to keep {} bytes; a filter may keep {MOST_KEPT_BYTES}", native.keeps);
            return Err(Failure { panicked: false, words });
        }
        Ok(native)
    }

    /// How many bytes it keeps.
    pub(super) fn keeps(&self) -> usize {
        self.keeps
    }

    /// Tells it how the camera is mounted.
    pub(super) fn mount(&mut self, mount: &Mount) -> std::result::Result<(), Failure> {
        let Some(function) = self.whole.and_then(|whole| whole.mount) else { return Ok(()) };
        let Mount { focal_px, fisheye, forward_m, height_m, tilt_sin, tilt_cos } = *mount;
        let raw = RawMount { focal_px, forward_m, height_m, tilt_sin, tilt_cos, fisheye: fisheye.into() };
        let mut message = ForeignText::default();
        // SAFETY: the instance is the library's own; the arguments live through the call.
        let status = rounding::kept(|| unsafe { function(self.instance, &raw const raw, message.pointer()) });
        message.outcome(status)
    }

    /// Tells it how the robot moved.
    pub(super) fn moved(&mut self, moved: &Moved) {
        if let Some(function) = self.whole.and_then(|whole| whole.moved) {
            let Moved { driven_m, turned_rad, jumped } = *moved;
            let raw = RawMoved { driven_m, turned_rad, jumped: jumped.into() };
            // SAFETY: as in `mount`.
            rounding::kept(|| unsafe { function(self.instance, &raw const raw) });
        }
    }

    /// Writes what it keeps; `kept` has as many bytes as it keeps, or nothing is written.
    pub(super) fn save(&mut self, kept: &mut [u8]) {
        if let Some(function) = self.whole.and_then(|whole| whole.save).filter(|_| kept.len() == self.keeps) {
            // SAFETY: the instance is the library's own; there are as many bytes as it said.
            rounding::kept(|| unsafe { function(self.instance, kept.as_mut_ptr()) });
        }
    }

    /// Lets it go on from what another one kept.
    pub(super) fn load(&mut self, kept: &[u8]) -> std::result::Result<(), Failure> {
        if kept.len() != self.keeps {
            let words = format!("it keeps {} bytes, and is given {}", self.keeps, kept.len());
            return Err(Failure { panicked: false, words });
        }
        let Some(function) = self.whole.and_then(|whole| whole.load) else { return Ok(()) };
        let mut message = ForeignText::default();
        // SAFETY: as in `save`.
        let status =
            rounding::kept(|| unsafe { function(self.instance, kept.as_ptr(), kept.len() as u32, message.pointer()) });
        message.outcome(status)
    }

    /// Fills `output` from `input`, which is as large.
    pub(super) fn process(&mut self, input: Frame<'_>, mut output: FrameMut<'_>) -> std::result::Result<(), Failure> {
        let (width_px, height_px) = (input.width_px() as u32, input.height_px() as u32);
        let raw = |pixels, format: Format| RawFrame {
            width_px,
            height_px,
            stride_bytes: width_px * format.channels() as u32,
            format: format.bit(),
            pixels,
        };
        let from = raw(input.pixels().as_ptr().cast_mut(), input.format());
        let format = output.format();
        let to = raw(output.pixels().as_mut_ptr(), format);
        let mut message = ForeignText::default();
        // SAFETY: the instance is the library's own; the frames are as the law says, equal in size, and live through the
        // call. The law forbids the library to write through the pixels of its input.
        let status = rounding::kept(|| unsafe {
            (self.process)(self.instance, &raw const from, &raw const to, message.pointer())
        });
        message.outcome(status)
    }
}

/// A native filter in this process.
struct InProcess {
    descriptor: &'static Descriptor,
    native: Native,
}

impl Running for InProcess {
    fn process(&mut self, input: Frame<'_>, output: FrameMut<'_>) -> Result<()> {
        check_frames(self.descriptor, &input, &output)?;
        let done = self.native.process(input, output);
        self.told(done)
    }

    fn mount(&mut self, mount: &Mount) -> Result<()> {
        let done = self.native.mount(mount);
        self.told(done)
    }

    fn moved(&mut self, moved: &Moved) -> Result<()> {
        self.native.moved(moved);
        Ok(())
    }

    fn keeps(&self) -> usize {
        self.native.keeps()
    }

    fn save(&mut self, kept: &mut [u8]) -> Result<()> {
        self.native.save(kept);
        Ok(())
    }

    fn load(&mut self, kept: &[u8]) -> Result<()> {
        let done = self.native.load(kept);
        self.told(done)
    }
}

impl InProcess {
    fn told(&self, done: std::result::Result<(), Failure>) -> Result<()> {
        done.map_err(|Failure { panicked, words }| {
            failed(if panicked { "E-FILTER-CRASH" } else { "E-FILTER" }, self.descriptor.name, &words)
        })
    }
}

impl Drop for Native {
    fn drop(&mut self) {
        // SAFETY: the instance is the library's own and is not used again.
        rounding::kept(|| unsafe { (self.destroy)(self.instance) });
    }
}

/// A buffer for what a filter has to say.
struct ForeignText([u8; MESSAGE_BYTES]);

impl Default for ForeignText {
    fn default() -> Self {
        Self([0; MESSAGE_BYTES])
    }
}

impl ForeignText {
    fn pointer(&mut self) -> *mut c_char {
        self.0.as_mut_ptr().cast()
    }

    fn outcome(&self, status: i32) -> std::result::Result<(), Failure> {
        if status == OK {
            return Ok(());
        }
        let words = CStr::from_bytes_until_nul(&self.0).map(CStr::to_string_lossy).unwrap_or_default();
        let words = if words.is_empty() { "it did not say why".to_owned() } else { words.into_owned() };
        Err(Failure { panicked: status == PANIC, words })
    }
}
