//! A frame in a worker, with bytes around it that nobody may write: a filter that writes past its frame is found out at
//! once, not when the memory that it has spoilt is used.

use std::ops::Range;

/// Bytes before and behind a frame.
const GUARD: usize = 4096;
/// What stands in them.
const PATTERN: [u8; 8] = [0xa5, 0x5a, 0xc3, 0x3c, 0x96, 0x69, 0xf0, 0x0f];

/// Pixels between two guards.
#[derive(Default)]
pub(super) struct Guarded {
    bytes: Vec<u8>,
}

impl Guarded {
    /// Makes room for so many pixel bytes; what they hold is not said.
    pub(super) fn resize(&mut self, length: usize) {
        if self.bytes.len() == length + 2 * GUARD {
            return;
        }
        self.bytes.clear();
        self.bytes.resize(length + 2 * GUARD, 0);
        for place in [0..GUARD, GUARD + length..length + 2 * GUARD] {
            self.bytes[place].iter_mut().zip(PATTERN.iter().cycle()).for_each(|(byte, pattern)| *byte = *pattern);
        }
    }

    fn place(&self) -> Range<usize> {
        GUARD.min(self.bytes.len())..self.bytes.len().saturating_sub(GUARD)
    }

    /// The pixels.
    pub(super) fn pixels(&self) -> &[u8] {
        &self.bytes[self.place()]
    }

    /// The pixels, to be written.
    pub(super) fn pixels_mut(&mut self) -> &mut [u8] {
        let place = self.place();
        &mut self.bytes[place]
    }

    /// How far outside of the pixels something was written, in words; nothing if nowhere.
    pub(super) fn overrun(&self) -> Option<String> {
        let Range { start, end } = self.place();
        let spoilt = |place: Range<usize>| {
            self.bytes[place].iter().zip(PATTERN.iter().cycle()).position(|(byte, pattern)| byte != pattern)
        };
        if let Some(past) = spoilt(end..self.bytes.len()) {
            return Some(format!("{past} bytes past the end of its {} bytes", end - start));
        }
        spoilt(0..start).map(|at| format!("{} bytes before its beginning", start - at))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_byte_outside_of_the_pixels_is_found() {
        let mut frame = Guarded::default();
        frame.resize(100);
        frame.pixels_mut().fill(7);
        assert_eq!((frame.pixels().len(), frame.overrun()), (100, None));
        frame.bytes[GUARD + 100 + 8] = 7;
        assert_eq!(frame.overrun().unwrap(), "8 bytes past the end of its 100 bytes");
        frame.bytes.clear();
        frame.resize(100);
        frame.bytes[GUARD - 3] = 7;
        assert_eq!(frame.overrun().unwrap(), "3 bytes before its beginning");
    }
}
