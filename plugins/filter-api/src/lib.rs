//! The filter contract: a filter turns a frame into a frame.
//!
//! # The law
//!
//! * **Frames** are row-major, top row first, left pixel first, without padding between rows. A colour frame has three
//!   bytes for each pixel (red, green, blue), a grey frame one byte, a mask one byte that is either 0 or 255.
//! * **Purity**: the same frame and the same parameters give the same output, whatever was processed before. A filter may
//!   keep scratch memory between frames, never knowledge.
//! * **Size**: the output has the width and height of the input. The host allocates both.
//! * **Time**: `process` allocates nothing after its first frame of a size, reads no clock, file or random number. A
//!   filter that wraps a library which allocates says so in its README.
//! * **Errors** are values. A filter never panics on any frame of the formats that its descriptor names.
//!
//! A filter crate exports one [`Plugin`]: its [`Descriptor`], which a host can print without starting anything, and the
//! function that creates an instance from checked parameters.

#![forbid(unsafe_code)]

mod frame;

pub use frame::{Format, Frame, FrameMut};

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
    /// The formats that it reads; the host converts nothing.
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

/// A running filter.
pub trait Filter: Send {
    /// Fills `output` from `input`.
    ///
    /// # Errors
    /// Where the frames' sizes or formats are not those of the contract.
    fn process(&mut self, input: Frame<'_>, output: FrameMut<'_>) -> Result<(), FilterError>;
}

/// What a filter crate exports.
#[derive(Debug, Clone, Copy)]
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
