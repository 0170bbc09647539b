//! The filter `where`: a mask of the pixels for which a condition holds, written as text and compiled when it is loaded.
//!
//! It belongs to the engine and is no crate of `plugins/`, since the contract of filters knows numbers only. All else of the law
//! holds for it too. The arithmetic is that of 32-bit floating point, in the order that is written.

mod kernel;
mod parser;
mod program;
mod words;

use std::ops::Range;

use dispatch::Processor;
use filter_api::{Descriptor, FilterError, Format, Frame, FrameMut};

use self::kernel::Kernel;
use super::running::Running;
use super::running::failed;
use crate::diagnostic::Result;

/// What the filter says of itself.
pub(super) const DESCRIPTOR: Descriptor = Descriptor {
    name: "where",
    version: env!("CARGO_PKG_VERSION"),
    licence: "MIT OR Apache-2.0",
    purpose: "Marks the pixels for which a condition holds, such as r > 1.5 * g && r > 60.",
    reads: &[Format::Rgb],
    writes: Format::Mask,
    parameters: &[],
};

/// What the filter says of itself where its condition looks at depth.
pub(super) const OF_DEPTH: Descriptor = Descriptor { reads: &[Format::Depth], ..DESCRIPTOR };

/// A condition to begin with; a script always writes its own.
pub const EXAMPLE: &str = "r > 1.5 * g && r > 60";

/// What a condition may say, in words.
pub const LANGUAGE: &str = "A condition over a pixel: r, g, b, value and brightness (0 to 255), hue_deg (0 to 360), saturation (0 to 1); or, of a depth \
     camera, nearness (1/m, 0 where nothing is seen); numbers, + - * /, abs, min, max, < <= > >= == !=, && || ! and parentheses.";

/// A mistake in a condition.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct ConditionError {
    /// What is wrong.
    pub message: String,
    /// What stands there.
    pub label: &'static str,
    /// What to write instead.
    pub help: String,
    /// Where, in bytes of the condition.
    pub span: Range<usize>,
}

impl ConditionError {
    fn new(message: String, label: &'static str, help: &str, span: Range<usize>) -> Self {
        Self { message, label, help: help.to_owned(), span }
    }
}

/// A running filter of a condition.
struct Where(Kernel);

/// Looks for a mistake in a condition.
///
/// # Errors
/// The first.
pub(super) fn check(condition: &str) -> std::result::Result<(), ConditionError> {
    parser::parse(condition).map(|_| ())
}

/// Whether a condition without a mistake looks at depth.
pub(super) fn looks_at_depth(condition: &str) -> bool {
    parser::parse(condition).is_ok_and(|program| program.looks_at_depth())
}

/// A filter that marks where a condition holds.
///
/// # Errors
/// The condition's first mistake.
pub(super) fn create(condition: &str) -> std::result::Result<Box<dyn Running>, ConditionError> {
    Ok(Box::new(Where(Kernel::new(parser::parse(condition)?, Processor::best()))))
}

impl Running for Where {
    fn process(&mut self, input: Frame<'_>, mut output: FrameMut<'_>) -> Result<()> {
        let fail = |FilterError(words)| failed("E-FILTER", DESCRIPTOR.name, &words);
        output.check_same_size(&input).map_err(fail)?;
        let wanted = if self.0.looks_at_depth() { Format::Depth } else { Format::Rgb };
        if input.format() != wanted {
            return Err(fail(FilterError(format!("its condition looks at {wanted:?} frames"))));
        }
        self.0.mark(input.pixels(), output.pixels());
        Ok(())
    }
}

#[cfg(test)]
mod tests;
