//! What a recording holds, for the person who asked for it.

/// What was recorded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Recording {
    /// Steps of learning and of the test.
    pub steps: u64,
    /// Images of the camera.
    pub images: u64,
    /// Size of the file.
    pub bytes: u64,
}
