//! The contract as C sees it: the layout of `filter.h`, which a test compares with this file.
//!
//! Only hosts and [`export!`](crate::export) need it; the author of a filter in Rust never does.

use std::ffi::c_void;
use std::os::raw::c_char;

/// The version of the contract; a host loads only filters of its own version.
pub const ABI_VERSION: u32 = 1;

/// The name of the static [`RawPlugin`] of a native library, and of the function of a WebAssembly module that returns its
/// address.
pub const PLUGIN_SYMBOL: &str = "engine_filter";

/// Bytes of every message buffer, the ending 0 included.
pub const MESSAGE_BYTES: usize = 256;

/// A bit of [`RawPlugin::reads`]: of colour the filter sees the brightness alone, and so likes grey frames best.
pub const BRIGHTNESS: u32 = 8;

/// It worked.
pub const OK: i32 = 0;
/// It did not; the message says why.
pub const ERROR: i32 = 1;
/// The filter broke down.
pub const PANIC: i32 = 2;

/// UTF-8 without an ending 0.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct RawText {
    /// The first byte.
    pub bytes: *const u8,
    /// How many bytes.
    pub length: u32,
}

/// One number that a user may set.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct RawParameter {
    /// The least value, included.
    pub min: f64,
    /// The greatest value, included.
    pub max: f64,
    /// The value where the user gives none.
    pub default: f64,
    /// The key in the script.
    pub name: RawText,
    /// The unit, in words.
    pub unit: RawText,
    /// One sentence: what it changes.
    pub purpose: RawText,
    /// A [`ParameterKind`](crate::ParameterKind) as a number.
    pub kind: u32,
}

/// One picture.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct RawFrame {
    /// Pixels in a row.
    pub width_px: u32,
    /// Rows.
    pub height_px: u32,
    /// Bytes from one row to the next.
    pub stride_bytes: u32,
    /// A [`Format`](crate::Format) as a bit.
    pub format: u32,
    /// The first byte of the first row.
    pub pixels: *mut u8,
}

/// Makes an instance.
pub type RawCreate = unsafe extern "C" fn(*const f64, u32, *mut *mut c_void, *mut c_char) -> i32;
/// Fills a frame from a frame.
pub type RawProcess = unsafe extern "C" fn(*mut c_void, *const RawFrame, *const RawFrame, *mut c_char) -> i32;
/// Frees an instance.
pub type RawDestroy = unsafe extern "C" fn(*mut c_void);

/// What a library says of itself, and its functions.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct RawPlugin {
    /// [`ABI_VERSION`]; first, in every version.
    pub abi_version: u32,
    /// The size of this struct.
    pub plugin_bytes: u32,
    /// The size of [`RawParameter`].
    pub parameter_bytes: u32,
    /// The size of [`RawFrame`].
    pub frame_bytes: u32,
    /// The name that scripts use.
    pub name: RawText,
    /// The version of the filter itself.
    pub version: RawText,
    /// The SPDX expression of its licence.
    pub licence: RawText,
    /// One sentence: what it does.
    pub purpose: RawText,
    /// The formats that it reads, as bits.
    pub reads: u32,
    /// The format that it writes.
    pub writes: u32,
    /// How many parameters there are.
    pub parameter_count: u32,
    /// The first of them.
    pub parameters: *const RawParameter,
    /// Makes an instance.
    pub create: Option<RawCreate>,
    /// Fills a frame from a frame.
    pub process: Option<RawProcess>,
    /// Frees an instance.
    pub destroy: Option<RawDestroy>,
}

/// A value that holds pointers to statics only, and so may be shared between threads.
#[repr(transparent)]
#[derive(Debug, Clone, Copy)]
pub struct Shared<T>(pub T);

// SAFETY: `export!`, which alone makes these, points only at constants of the library, which never change.
#[allow(unsafe_code)]
unsafe impl<T> Sync for Shared<T> {}
