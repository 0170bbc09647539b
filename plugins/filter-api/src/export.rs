//! What `export!` writes into a library: a filter in Rust behind the functions of the C contract, panics caught.

#![allow(unsafe_code)] // The other side of a C interface: every function here is called with raw pointers.

use std::any::Any;
use std::ffi::c_void;
use std::os::raw::c_char;
use std::panic::{catch_unwind, AssertUnwindSafe};

use crate::abi::{
    RawCreate, RawFirst, RawFrame, RawParameter, RawPlugin, RawText, ABI_VERSION, BRIGHTNESS, ERROR, MESSAGE_BYTES, OK,
    PANIC,
};
use crate::{Filter, FilterError, Format, Frame, FrameMut, Parameter, Plugin};

mod kept;

pub use kept::{keeps, load, mount, moved, save};

/// Makes a [`Plugin`] the one filter of a library: `filter_api::export!(PLUGIN);`, once for each library.
///
/// A panic in the filter is caught and becomes an error with its message.
#[macro_export]
macro_rules! export {
    ($plugin:expr) => {
        #[allow(unsafe_code, unreachable_pub, missing_docs, non_upper_case_globals)]
        const _: () = {
            use std::{ffi::c_void, os::raw::c_char};
            use $crate::abi::{RawFrame, RawMount, RawMoved, RawParameter, RawPlugin, Shared};

            const EXPORTED: $crate::Plugin = $plugin;
            const PARAMETERS: &[RawParameter; EXPORTED.descriptor.parameters.len()] =
                &$crate::export::parameters(EXPORTED.descriptor.parameters);

            #[cfg_attr(target_family = "wasm", export_name = "engine_filter_create")]
            pub unsafe extern "C" fn create(
                values: *const f64,
                count: u32,
                instance: *mut *mut c_void,
                message: *mut c_char,
            ) -> i32 {
                $crate::export::create(&EXPORTED, values, count, instance, message)
            }

            #[cfg_attr(not(target_family = "wasm"), no_mangle)]
            pub static engine_filter: Shared<RawPlugin> =
                Shared($crate::export::plugin(&EXPORTED, PARAMETERS.as_ptr(), create));

            #[cfg(target_family = "wasm")]
            #[export_name = "engine_filter"]
            pub extern "C" fn plugin() -> *const RawPlugin {
                &engine_filter.0
            }

            #[cfg(target_family = "wasm")]
            #[export_name = "engine_filter_process"]
            pub unsafe extern "C" fn process(
                instance: *mut c_void,
                input: *const RawFrame,
                output: *const RawFrame,
                message: *mut c_char,
            ) -> i32 {
                $crate::export::process(instance, input, output, message)
            }

            #[cfg(target_family = "wasm")]
            #[export_name = "engine_filter_mount"]
            pub unsafe extern "C" fn mount(instance: *mut c_void, mount: *const RawMount, message: *mut c_char) -> i32 {
                $crate::export::mount(instance, mount, message)
            }

            #[cfg(target_family = "wasm")]
            #[export_name = "engine_filter_moved"]
            pub unsafe extern "C" fn moved(instance: *mut c_void, moved: *const RawMoved) {
                $crate::export::moved(instance, moved)
            }

            #[cfg(target_family = "wasm")]
            #[export_name = "engine_filter_keeps"]
            pub unsafe extern "C" fn keeps(instance: *mut c_void) -> u32 {
                $crate::export::keeps(instance)
            }

            #[cfg(target_family = "wasm")]
            #[export_name = "engine_filter_save"]
            pub unsafe extern "C" fn save(instance: *mut c_void, kept: *mut u8) {
                $crate::export::save(instance, kept)
            }

            #[cfg(target_family = "wasm")]
            #[export_name = "engine_filter_load"]
            pub unsafe extern "C" fn load(
                instance: *mut c_void,
                kept: *const u8,
                bytes: u32,
                message: *mut c_char,
            ) -> i32 {
                $crate::export::load(instance, kept, bytes, message)
            }

            #[cfg(target_family = "wasm")]
            #[export_name = "engine_filter_allocate"]
            pub extern "C" fn allocate(bytes: u32) -> *mut c_void {
                $crate::export::allocate(bytes)
            }
        };
    };
}

/// The parameters of a descriptor as C sees them.
#[must_use]
pub const fn parameters<const COUNT: usize>(parameters: &[Parameter]) -> [RawParameter; COUNT] {
    const NONE: RawText = text("");
    let mut raw =
        [RawParameter { min: 0.0, max: 0.0, default: 0.0, name: NONE, unit: NONE, purpose: NONE, kind: 0 }; COUNT];
    let mut index = 0;
    while index < COUNT {
        let parameter = &parameters[index];
        raw[index] = RawParameter {
            min: parameter.min,
            max: parameter.max,
            default: parameter.default,
            name: text(parameter.name),
            unit: text(parameter.unit),
            purpose: text(parameter.purpose),
            kind: parameter.kind as u32,
        };
        index += 1;
    }
    raw
}

/// A plugin as C sees it.
#[must_use]
pub const fn plugin(plugin: &Plugin, parameters: *const RawParameter, create: RawCreate) -> RawPlugin {
    let descriptor = plugin.descriptor;
    let mut reads = if likes_grey(descriptor.reads) { BRIGHTNESS } else { 0 };
    let mut index = 0;
    while index < descriptor.reads.len() {
        reads |= descriptor.reads[index].bit();
        index += 1;
    }
    let first = RawFirst {
        abi_version: ABI_VERSION,
        plugin_bytes: std::mem::size_of::<RawPlugin>() as u32,
        parameter_bytes: std::mem::size_of::<RawParameter>() as u32,
        frame_bytes: std::mem::size_of::<RawFrame>() as u32,
        name: text(descriptor.name),
        version: text(descriptor.version),
        licence: text(descriptor.licence),
        purpose: text(descriptor.purpose),
        reads,
        writes: descriptor.writes.bit(),
        parameter_count: descriptor.parameters.len() as u32,
        parameters,
        create: Some(create),
        process: Some(process),
        destroy: Some(destroy),
    };
    RawPlugin { first, mount: Some(mount), moved: Some(moved), keeps: Some(keeps), save: Some(save), load: Some(load) }
}

/// Whether grey stands first, and more than it: the order in which a filter likes its formats.
const fn likes_grey(reads: &[Format]) -> bool {
    reads.len() > 1 && matches!(reads[0], Format::Grey)
}

const fn text(text: &str) -> RawText {
    RawText { bytes: text.as_ptr(), length: text.len() as u32 }
}

/// Makes an instance of `plugin` behind a pointer.
///
/// # Safety
/// `values` has `count` numbers, `instance` can be written, and `message` has [`MESSAGE_BYTES`] bytes.
pub unsafe fn create(
    plugin: &Plugin,
    values: *const f64,
    count: u32,
    instance: *mut *mut c_void,
    message: *mut c_char,
) -> i32 {
    // This library has its own copy of the standard library: silence its report, the host tells of the panic.
    std::panic::set_hook(Box::new(|_| {}));
    let values = if count == 0 { &[] } else { std::slice::from_raw_parts(values, count as usize) };
    let made = catch_unwind(|| {
        if values.len() == plugin.descriptor.parameters.len() {
            return (plugin.create)(values);
        }
        let wanted = plugin.descriptor.parameters.len();
        Err(FilterError(format!("{} values for {wanted} parameters", values.len())))
    });
    match made {
        Ok(Ok(filter)) => {
            *instance = Box::into_raw(Box::new(filter)).cast();
            OK
        }
        Ok(Err(error)) => fail(ERROR, &error.0, message),
        Err(panic) => fail(PANIC, panic_message(panic.as_ref()), message),
    }
}

/// Runs an instance that [`create`] made.
///
/// # Safety
/// `instance` is such an instance and runs nowhere else; the frames are as `filter.h` says; `message` has
/// [`MESSAGE_BYTES`] bytes.
pub unsafe extern "C" fn process(
    instance: *mut c_void,
    input: *const RawFrame,
    output: *const RawFrame,
    message: *mut c_char,
) -> i32 {
    let filter = &mut *instance.cast::<Box<dyn Filter>>();
    let (input, output) = (&*input, &*output);
    let run = catch_unwind(AssertUnwindSafe(|| {
        let (format, length) = layout(input)?;
        let pixels = std::slice::from_raw_parts(input.pixels, length);
        let input = Frame::new(input.width_px as usize, input.height_px as usize, format, pixels)?;
        let (format, length) = layout(output)?;
        let pixels = std::slice::from_raw_parts_mut(output.pixels, length);
        filter.process(input, FrameMut::new(output.width_px as usize, output.height_px as usize, format, pixels)?)
    }));
    match run {
        Ok(Ok(())) => OK,
        Ok(Err(error)) => fail(ERROR, &error.0, message),
        Err(panic) => fail(PANIC, panic_message(panic.as_ref()), message),
    }
}

/// Frees an instance that [`create`] made.
///
/// # Safety
/// `instance` is such an instance, and is not used again.
pub unsafe extern "C" fn destroy(instance: *mut c_void) {
    let instance = Box::from_raw(instance.cast::<Box<dyn Filter>>());
    // A panic must not cross into the host, and has nobody to tell.
    drop(catch_unwind(AssertUnwindSafe(|| drop(instance))));
}

/// Memory for the host of a WebAssembly module: aligned for numbers, never freed, zero filled.
#[must_use]
pub fn allocate(bytes: u32) -> *mut c_void {
    let words = vec![0_u64; bytes as usize / 8 + 1];
    Box::leak(words.into_boxed_slice()).as_mut_ptr().cast()
}

/// The format of a frame, and its length in bytes if its rows follow each other without padding.
fn layout(frame: &RawFrame) -> Result<(Format, usize), FilterError> {
    let format = Format::from_bit(frame.format)
        .ok_or_else(|| FilterError(format!("there is no frame format {}", frame.format)))?;
    let row = frame.width_px as usize * format.channels();
    if frame.stride_bytes as usize == row {
        return Ok((format, row * frame.height_px as usize));
    }
    Err(FilterError(format!("rows of {row} bytes stand {} bytes apart", frame.stride_bytes)))
}

fn panic_message(panic: &(dyn Any + Send)) -> &str {
    let words = panic.downcast_ref::<&str>().copied();
    words.or_else(|| panic.downcast_ref::<String>().map(String::as_str)).unwrap_or("the filter broke down")
}

/// Writes what fits of `words` and an ending 0.
unsafe fn fail(status: i32, words: &str, message: *mut c_char) -> i32 {
    let mut length = words.len().min(MESSAGE_BYTES - 1);
    while !words.is_char_boundary(length) {
        length -= 1;
    }
    std::ptr::copy_nonoverlapping(words.as_ptr(), message.cast(), length);
    *message.add(length) = 0;
    status
}
