//! The contract as C sees it: the layout of `filter.h`, which a test compares with this file.
//!
//! Only hosts and [`export!`](crate::export) need it; the author of a filter in Rust never does.

use std::ffi::c_void;
use std::os::raw::c_char;

/// The version of the contract. A host loads filters of every version from [`OLDEST_VERSION`] to this.
pub const ABI_VERSION: u32 = 2;

/// The oldest version that a host loads: its plugins end after [`RawFirst`].
pub const OLDEST_VERSION: u32 = 1;

/// The name of the static [`RawPlugin`] of a native library, and of the function of a WebAssembly module that returns its
/// address.
pub const PLUGIN_SYMBOL: &str = "engine_filter";

/// Bytes of every message buffer, the ending 0 included.
pub const MESSAGE_BYTES: usize = 256;

/// A bit of [`RawFirst::reads`]: of colour the filter sees the brightness alone, and so likes grey frames best.
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

/// How the camera is mounted; see [`Mount`](crate::Mount).
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct RawMount {
    /// Pixels; of a fisheye, pixels for each radian.
    pub focal_px: f64,
    /// Metres ahead of the robot's centre.
    pub forward_m: f64,
    /// Metres above the ground.
    pub height_m: f64,
    /// The sine of the angle by which the camera looks down.
    pub tilt_sin: f64,
    /// Its cosine.
    pub tilt_cos: f64,
    /// 1 if the lens is an equidistant fisheye, else 0.
    pub fisheye: u32,
}

/// How the robot moved; see [`Moved`](crate::Moved).
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct RawMoved {
    /// Metres.
    pub driven_m: f64,
    /// Radians, positive to the left.
    pub turned_rad: f64,
    /// 1 if the robot was put elsewhere, else 0.
    pub jumped: u32,
}

/// Makes an instance.
pub type RawCreate = unsafe extern "C" fn(*const f64, u32, *mut *mut c_void, *mut c_char) -> i32;
/// Fills a frame from a frame.
pub type RawProcess = unsafe extern "C" fn(*mut c_void, *const RawFrame, *const RawFrame, *mut c_char) -> i32;
/// Frees an instance.
pub type RawDestroy = unsafe extern "C" fn(*mut c_void);

/// Hears how the camera is mounted.
pub type RawMountFilter = unsafe extern "C" fn(*mut c_void, *const RawMount, *mut c_char) -> i32;
/// Hears how the robot moved.
pub type RawTellMoved = unsafe extern "C" fn(*mut c_void, *const RawMoved);
/// How many bytes an instance keeps.
pub type RawKeeps = unsafe extern "C" fn(*mut c_void) -> u32;
/// Writes what an instance keeps.
pub type RawSave = unsafe extern "C" fn(*mut c_void, *mut u8);
/// Reads what an instance keeps.
pub type RawLoad = unsafe extern "C" fn(*mut c_void, *const u8, u32, *mut c_char) -> i32;

/// What a library says of itself, and its functions, as in the first version of the contract.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct RawFirst {
    /// The version that the library was built for; first, in every version.
    pub abi_version: u32,
    /// The size of the whole plugin.
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

/// A plugin: what there was in the first version, then what came with the second. Each of the new functions may be left out.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct RawPlugin {
    /// What there was in the first version.
    pub first: RawFirst,
    /// Hears how the camera is mounted.
    pub mount: Option<RawMountFilter>,
    /// Hears how the robot moved.
    pub moved: Option<RawTellMoved>,
    /// How many bytes an instance keeps.
    pub keeps: Option<RawKeeps>,
    /// Writes what an instance keeps.
    pub save: Option<RawSave>,
    /// Reads what an instance keeps.
    pub load: Option<RawLoad>,
}

/// A value that holds pointers to statics only, and so may be shared between threads.
#[repr(transparent)]
#[derive(Debug, Clone, Copy)]
pub struct Shared<T>(pub T);

// SAFETY: `export!`, which alone makes these, points only at constants of the library, which never change.
#[allow(unsafe_code)]
unsafe impl<T> Sync for Shared<T> {}
