//! A filter that can be used, and how it comes into the program.

#[cfg(feature = "native-filters")]
use std::path::Path;
use std::path::PathBuf;

use filter_api::Descriptor;

use super::running::Running;
use crate::diagnostic::Result;

/// How a filter comes into the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Part of the program.
    LinkedIn,
    /// A native shared library, with all rights of the user.
    Native,
    /// A WebAssembly module in a sandbox.
    Wasm,
}

impl Form {
    /// In words.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::LinkedIn => "linked in",
            Self::Native => "native",
            Self::Wasm => "WebAssembly",
        }
    }
}

/// Makes an instance from checked values.
pub(super) type Create = Box<dyn Fn(&[f64]) -> Result<Box<dyn Running>> + Send + Sync>;

/// A filter that can be used.
pub struct Entry {
    /// What the filter says of itself.
    pub descriptor: &'static Descriptor,
    /// How it comes into the program.
    pub form: Form,
    /// The file that it was loaded from.
    pub path: Option<PathBuf>,
    /// SHA-256 of that file, 64 hexadecimal digits.
    pub sha256: Option<String>,
    /// Whether it marks by a condition, which a script writes as text.
    pub by_condition: bool,
    pub(super) create: Create,
}

impl Entry {
    /// A filter of a native library with this digest.
    #[cfg(feature = "native-filters")]
    pub(super) fn native(descriptor: &'static Descriptor, path: &Path, sha256: String, create: Create) -> Self {
        let (path, sha256) = (Some(path.to_owned()), Some(sha256));
        Self { descriptor, form: Form::Native, path, sha256, by_condition: false, create }
    }

    /// An instance with one value for each parameter, each within its range; whether it keeps the law is not tried.
    ///
    /// # Errors
    /// If the filter refuses the values, breaks down, or is stopped by a limit.
    pub fn start(&self, values: &[f64]) -> Result<Box<dyn Running>> {
        (self.create)(values)
    }
}
