//! The functions that came with the second version of the contract: what a filter is told besides frames, and what it keeps.

use std::ffi::c_void;
use std::os::raw::c_char;
use std::panic::{catch_unwind, AssertUnwindSafe};

use super::{fail, panic_message};
use crate::abi::{RawMount, RawMoved, ERROR, OK, PANIC};
use crate::{Filter, FilterError, Mount, Moved};

/// Tells an instance how the camera is mounted.
///
/// # Safety
/// `instance` is one that [`create`](super::create) made and runs nowhere else; `mount` can be read; `message` has
/// [`MESSAGE_BYTES`](crate::abi::MESSAGE_BYTES) bytes.
pub unsafe extern "C" fn mount(instance: *mut c_void, mount: *const RawMount, message: *mut c_char) -> i32 {
    let RawMount { focal_px, forward_m, height_m, tilt_sin, tilt_cos, fisheye } = *mount;
    let mount = Mount { focal_px, fisheye: fisheye != 0, forward_m, height_m, tilt_sin, tilt_cos };
    outcome(instance, message, |filter| filter.mount(&mount))
}

/// Tells an instance how the robot moved.
///
/// # Safety
/// As for [`mount`].
pub unsafe extern "C" fn moved(instance: *mut c_void, moved: *const RawMoved) {
    let RawMoved { driven_m, turned_rad, jumped } = *moved;
    let filter = &mut *instance.cast::<Box<dyn Filter>>();
    // There is nobody to tell of a panic here; the next frame will show it.
    drop(catch_unwind(AssertUnwindSafe(|| filter.moved(&Moved { driven_m, turned_rad, jumped: jumped != 0 }))));
}

/// How many bytes an instance keeps.
///
/// # Safety
/// As for [`mount`].
pub unsafe extern "C" fn keeps(instance: *mut c_void) -> u32 {
    let filter = &mut *instance.cast::<Box<dyn Filter>>();
    catch_unwind(AssertUnwindSafe(|| filter.keeps() as u32)).unwrap_or(0)
}

/// Writes what an instance keeps.
///
/// # Safety
/// As for [`mount`]; `kept` has as many bytes as [`keeps`] said.
pub unsafe extern "C" fn save(instance: *mut c_void, kept: *mut u8) {
    let bytes = keeps(instance) as usize;
    let filter = &mut *instance.cast::<Box<dyn Filter>>();
    let kept = if bytes == 0 { &mut [][..] } else { std::slice::from_raw_parts_mut(kept, bytes) };
    drop(catch_unwind(AssertUnwindSafe(|| filter.save(kept))));
}

/// Lets an instance go on from what another one kept.
///
/// # Safety
/// As for [`mount`]; `kept` has so many bytes.
pub unsafe extern "C" fn load(instance: *mut c_void, kept: *const u8, bytes: u32, message: *mut c_char) -> i32 {
    let kept = if bytes == 0 { &[][..] } else { std::slice::from_raw_parts(kept, bytes as usize) };
    outcome(instance, message, |filter| filter.load(kept))
}

unsafe fn outcome(
    instance: *mut c_void,
    message: *mut c_char,
    call: impl FnOnce(&mut dyn Filter) -> Result<(), FilterError>,
) -> i32 {
    let filter = &mut *instance.cast::<Box<dyn Filter>>();
    match catch_unwind(AssertUnwindSafe(|| call(filter.as_mut()))) {
        Ok(Ok(())) => OK,
        Ok(Err(error)) => fail(ERROR, &error.0, message),
        Err(panic) => fail(PANIC, panic_message(panic.as_ref()), message),
    }
}
