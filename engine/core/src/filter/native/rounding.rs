//! How this thread rounds, kept over calls of foreign code: a library that sets another mode, or flushes small numbers to 0,
//! would change every later result of the engine. Some set it while they are loaded, without meaning to (`-ffast-math`).

#![allow(unsafe_code, reason = "control registers are read and written by instructions")]

/// Calls foreign code, and makes the thread round as before.
pub(super) fn kept<T>(call: impl FnOnce() -> T) -> T {
    let before = Control::read();
    let result = call();
    before.write();
    result
}

/// The control registers of floating-point arithmetic.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Control {
    #[cfg(target_arch = "x86_64")]
    vectors: u32,
    #[cfg(target_arch = "x86_64")]
    stack: u16,
    #[cfg(target_arch = "aarch64")]
    all: u64,
}

#[cfg(target_arch = "x86_64")]
impl Control {
    fn read() -> Self {
        let (mut vectors, mut stack) = (0_u32, 0_u16);
        // SAFETY: both instructions write the registers to these places and touch nothing else.
        unsafe {
            std::arch::asm!("stmxcsr [{}]", in(reg) &raw mut vectors, options(nostack, preserves_flags));
            std::arch::asm!("fnstcw [{}]", in(reg) &raw mut stack, options(nostack, preserves_flags));
        }
        Self { vectors, stack }
    }

    fn write(self) {
        let Self { vectors, stack } = self;
        // SAFETY: the values were read from the registers, so that they are valid; this restores what Rust relies on.
        unsafe {
            std::arch::asm!("ldmxcsr [{}]", in(reg) &raw const vectors, options(nostack, preserves_flags, readonly));
            std::arch::asm!("fldcw [{}]", in(reg) &raw const stack, options(nostack, preserves_flags, readonly));
        }
    }
}

#[cfg(target_arch = "aarch64")]
impl Control {
    fn read() -> Self {
        let all: u64;
        // SAFETY: the instruction reads a register.
        unsafe { std::arch::asm!("mrs {}, fpcr", out(reg) all, options(nomem, nostack, preserves_flags)) }
        Self { all }
    }

    fn write(self) {
        // SAFETY: the value was read from the register; this restores what Rust relies on.
        unsafe { std::arch::asm!("msr fpcr, {}", in(reg) self.all, options(nomem, nostack, preserves_flags)) }
    }
}

#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
impl Control {
    fn read() -> Self {
        Self {}
    }

    fn write(self) {}
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::*;

    /// Rounds upwards and flushes small numbers to 0: bits 14, 15 and 6 of the register.
    const OTHER: u32 = 0x1f80 | 0x4000 | 0x8000 | 0x40;

    #[test]
    fn a_call_that_rounds_otherwise_leaves_the_thread_as_it_was() {
        let before = Control::read();
        // The division must not move past the instructions around it.
        let third = |of: f64| std::hint::black_box(std::hint::black_box(of) / std::hint::black_box(3.0));
        let right = third(1.0);
        let within = kept(|| {
            Control { vectors: OTHER, ..before }.write();
            third(1.0)
        });
        // 1/3 lies between two numbers; the nearer one is below it.
        assert!(within > right);
        assert_eq!((third(1.0), Control::read().vectors & !0x3f), (right, before.vectors & !0x3f));
    }
}
