//! The functions of a module that came with the second version of the contract, each of which may be missing.

use filter_api::{Mount, Moved};
use wasmtime::TypedFunc;

use super::layout::{MOUNT_BYTES, MOVED_BYTES};
use super::sandbox::{Guest, START_FUEL};
use crate::diagnostic::{Diagnostic, Result};

/// The most that a filter may keep, bytes.
const MOST_KEPT_BYTES: u32 = 1 << 20;

/// What tells a filter more than frames, and what it keeps.
pub(super) struct KeptFunctions {
    pub(super) mount: Option<TypedFunc<(u32, u32, u32), i32>>,
    pub(super) moved: Option<TypedFunc<(u32, u32), ()>>,
    keeps: Option<TypedFunc<u32, u32>>,
    pub(super) save: Option<TypedFunc<(u32, u32), ()>>,
    pub(super) load: Option<TypedFunc<(u32, u32, u32, u32), i32>>,
}

impl KeptFunctions {
    /// Those that a module exports.
    pub(super) fn of(guest: &mut Guest) -> Self {
        Self {
            mount: guest.function("engine_filter_mount").ok(),
            moved: guest.function("engine_filter_moved").ok(),
            keeps: guest.function("engine_filter_keeps").ok(),
            save: guest.function("engine_filter_save").ok(),
            load: guest.function("engine_filter_load").ok(),
        }
    }

    /// How many bytes an instance keeps.
    ///
    /// # Errors
    /// If it is stopped by a limit, or keeps more than a filter may.
    pub(super) fn keeps(&self, guest: &mut Guest, instance: u32) -> Result<u32> {
        let Some(keeps) = &self.keeps else { return Ok(0) };
        match guest.call(keeps, instance, START_FUEL, "saying what it keeps")? {
            bytes if bytes <= MOST_KEPT_BYTES => Ok(bytes),
            bytes => {
                let message = format!("a filter wants to keep {bytes} bytes; it may keep {MOST_KEPT_BYTES}");
                Diagnostic::new("E-WASM-MEM", message).fail()
            }
        }
    }
}

/// A mount as a module reads it.
pub(super) fn mount_bytes(mount: &Mount) -> [u8; MOUNT_BYTES as usize] {
    let numbers = [mount.focal_px, mount.forward_m, mount.height_m, mount.tilt_sin, mount.tilt_cos];
    with_flag(&numbers, mount.fisheye)
}

/// A movement as a module reads it.
pub(super) fn moved_bytes(moved: &Moved) -> [u8; MOVED_BYTES as usize] {
    with_flag(&[moved.driven_m, moved.turned_rad], moved.jumped)
}

/// Numbers, and a flag behind them.
fn with_flag<const BYTES: usize>(numbers: &[f64], flag: bool) -> [u8; BYTES] {
    let mut bytes = [0; BYTES];
    let words = numbers.iter().map(|number| number.to_le_bytes()).chain([u64::from(flag).to_le_bytes()]);
    for (place, word) in bytes.as_chunks_mut::<8>().0.iter_mut().zip(words) {
        *place = word;
    }
    bytes
}
