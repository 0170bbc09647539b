//! The filter contract: a filter turns a frame into a frame.
//!
//! The law stands in `README.md`. A filter crate makes one [`Plugin`]: its [`Descriptor`], which a host can print without
//! starting anything, and the function that creates an instance from checked parameters. Linked into the engine that is
//! all; [`export!`] makes a native library or a WebAssembly module of it, through the C contract of `filter.h`.
//!
//! It depends on nothing, and on no compiler newer than Rust 1.63.

#![deny(unsafe_code)]

pub mod abi;
#[doc(hidden)]
pub mod export;
mod frame;

mod told;

pub use frame::{Format, Frame, FrameMut, NEARNESS_ONE};
pub use told::{Mount, Moved};

/// What a filter says of itself; a host lists it without creating an instance.
#[derive(Debug, Clone, Copy)]
pub struct Descriptor {
    /// The name that scripts use, lower case: `sobel`.
    pub name: &'static str,
    /// The version of the filter itself.
    pub version: &'static str,
    /// The SPDX expression of its licence.
    pub licence: &'static str,
    /// One sentence: what it does.
    pub purpose: &'static str,
    /// The formats that it reads, the one that it likes best first; the host converts nothing. A filter that likes grey
    /// best and reads colour too sees only its brightness: it gives the same for [`Frame::write_luma`] of a frame. The C
    /// contract carries no order: a loaded filter gets colour if it reads it.
    pub reads: &'static [Format],
    /// The format that it writes.
    pub writes: Format,
    /// Its parameters, in the order in which [`Plugin::create`] takes them.
    pub parameters: &'static [Parameter],
}

/// One number that a user may set.
#[derive(Debug, Clone, Copy)]
pub struct Parameter {
    /// The key in the script: `threshold`.
    pub name: &'static str,
    /// What kind of number it is.
    pub kind: ParameterKind,
    /// The unit, in words: `grey levels`.
    pub unit: &'static str,
    /// The least value, included.
    pub min: f64,
    /// The greatest value, included.
    pub max: f64,
    /// The value where the user gives none.
    pub default: f64,
    /// One sentence: what it changes.
    pub purpose: &'static str,
}

/// What kind of number a parameter is; a host refuses every other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum ParameterKind {
    /// Any finite number.
    Number = 0,
    /// A whole number.
    Whole = 1,
    /// 0 (off) or 1 (on); a script may also write `false` or `true`.
    Switch = 2,
}

/// A running filter.
pub trait Filter: Send {
    /// Fills `output` from `input`.
    ///
    /// # Errors
    /// Where the frames' sizes or formats are not those of the contract.
    fn process(&mut self, input: Frame<'_>, output: FrameMut<'_>) -> Result<(), FilterError>;

    /// Hears how the camera is mounted: once, before the first frame.
    ///
    /// # Errors
    /// If it cannot work with this camera.
    fn mount(&mut self, mount: &Mount) -> Result<(), FilterError> {
        let _ = mount;
        Ok(())
    }

    /// Hears how the robot moved since the last frame: before each frame, if it [keeps](Filter::keeps) something.
    fn moved(&mut self, moved: &Moved) {
        let _ = moved;
    }

    /// How many bytes it keeps from frame to frame, the same number for all of its life; 0 if it keeps nothing, which is the law
    /// for a filter that says nothing here.
    fn keeps(&self) -> usize {
        0
    }

    /// Writes all that it keeps into [`Filter::keeps`] bytes.
    fn save(&self, kept: &mut [u8]) {
        let _ = kept;
    }

    /// What it keeps, in words for a person: a sentence, or nothing. The C contract has no words.
    fn words(&self) -> String {
        String::new()
    }

    /// Goes on as if it had seen and heard all that the filter had that saved this, and nothing else.
    ///
    /// # Errors
    /// If these bytes are not what such a filter saves.
    fn load(&mut self, kept: &[u8]) -> Result<(), FilterError> {
        match kept {
            [] => Ok(()),
            _ => Err(FilterError(format!("it keeps nothing, and is given {} bytes", kept.len()))),
        }
    }
}

/// What a filter crate exports.
#[derive(Clone, Copy)]
pub struct Plugin {
    /// What the filter says of itself.
    pub descriptor: &'static Descriptor,
    /// Creates an instance. The host passes one finite value for each parameter, in order and within its range.
    pub create: Create,
}

/// Creates a filter from the values of its parameters, in the order of its descriptor.
pub type Create = fn(&[f64]) -> Result<Box<dyn Filter>, FilterError>;

/// Why a filter could not do its work, in words for the person who set it up.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FilterError(pub String);

impl std::fmt::Display for FilterError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for FilterError {}
