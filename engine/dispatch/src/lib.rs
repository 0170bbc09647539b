//! Vector code without assembler: one plain function, compiled for several processors, chosen at run time.
//!
//! Every compilation comes from the same source. Rust never reorders floating-point arithmetic, so all of them give the
//! same bytes; the processor decides the time alone. On AArch64 every processor has NEON, so the portable compilation
//! is the vector code there.
//!
//! It depends on nothing, and where there is but the portable compilation, on no compiler newer than Rust 1.63.

use std::sync::atomic::{AtomicU8, Ordering};

/// The level above which [`Processor::best`] does not go.
static MOST: AtomicU8 = AtomicU8::new(u8::MAX);

/// Instructions that this machine has: only detection makes one, so that holding it proves them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Processor(Level);

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Level {
    Portable,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl Processor {
    /// What every machine of this architecture has.
    pub const PORTABLE: Self = Self(Level::Portable);

    /// The most that this machine has, unless [`Processor::limit_best`] says less.
    #[must_use]
    pub fn best() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            let most = MOST.load(Ordering::Relaxed);
            if most >= Level::Avx512 as u8 && has_avx512() {
                return Self(Level::Avx512);
            }
            if most >= Level::Avx2 as u8 && has_avx2() {
                return Self(Level::Avx2);
            }
        }
        Self::PORTABLE
    }

    /// Makes `most` the best from now on, in every thread: for tests that compare whole runs. Nothing but time changes.
    #[doc(hidden)]
    pub fn limit_best(most: Self) {
        MOST.store(most.0 as u8, Ordering::Relaxed);
    }

    /// Everything that this machine can run, to compare one compilation with another.
    #[must_use]
    pub fn all() -> Vec<Self> {
        #[cfg_attr(not(target_arch = "x86_64"), allow(unused_mut))]
        let mut all = vec![Self::PORTABLE];
        #[cfg(target_arch = "x86_64")]
        {
            all.extend(has_avx2().then_some(Self(Level::Avx2)));
            all.extend(has_avx512().then_some(Self(Level::Avx512)));
        }
        all
    }

    /// In words: `portable`, `AVX2` or `AVX-512`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self.0 {
            Level::Portable => "portable",
            #[cfg(target_arch = "x86_64")]
            Level::Avx2 => "AVX2",
            #[cfg(target_arch = "x86_64")]
            Level::Avx512 => "AVX-512",
        }
    }

    /// Does the work, compiled for this processor.
    #[inline]
    pub fn run<W: Work>(self, work: W) -> W::Output {
        #[cfg(target_arch = "x86_64")]
        {
            #[target_feature(enable = "avx2")]
            fn avx2<W: Work>(work: W) -> W::Output {
                work.run()
            }
            #[target_feature(enable = "avx2,avx512f,avx512bw,avx512dq,avx512vl,avx512vbmi")]
            fn avx512<W: Work>(work: W) -> W::Output {
                work.run()
            }
            // The one call of safe functions compiled for features that were detected.
            #[allow(unsafe_code)]
            match self.0 {
                // SAFETY: these values exist only on machines that have these features.
                Level::Avx512 => return unsafe { avx512(work) },
                Level::Avx2 => return unsafe { avx2(work) },
                Level::Portable => {}
            }
        }
        work.run()
    }
}

/// Something to compute, its inputs within. Its `run` must be `#[inline(always)]`, or nothing is gained;
/// [`compiled_for_each_processor`] takes care of that.
pub trait Work {
    /// What comes out.
    type Output;

    /// Computes it.
    fn run(self) -> Self::Output;
}

#[cfg(target_arch = "x86_64")]
fn has_avx2() -> bool {
    std::arch::is_x86_feature_detected!("avx2")
}

#[cfg(target_arch = "x86_64")]
fn has_avx512() -> bool {
    has_avx2()
        && std::arch::is_x86_feature_detected!("avx512f")
        && std::arch::is_x86_feature_detected!("avx512bw")
        && std::arch::is_x86_feature_detected!("avx512dq")
        && std::arch::is_x86_feature_detected!("avx512vl")
        && std::arch::is_x86_feature_detected!("avx512vbmi")
}

/// Defines a function whose first argument, a [`Processor`], chooses which compilation of its body runs.
#[macro_export]
macro_rules! compiled_for_each_processor {
    ($(#[$doc:meta])* $visibility:vis fn $name:ident<$life:lifetime>($($argument:ident: $type:ty),* $(,)?) $body:block) => {
        $(#[$doc])*
        $visibility fn $name<$life>(processor: $crate::Processor, $($argument: $type),*) {
            struct Inputs<$life> {
                $($argument: $type,)*
            }

            impl<$life> $crate::Work for Inputs<$life> {
                type Output = ();

                #[inline(always)]
                fn run(self) {
                    let Self { $($argument),* } = self;
                    $body
                }
            }

            processor.run(Inputs { $($argument),* });
        }
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    compiled_for_each_processor! {
        /// Doubles every byte.
        fn double<'a>(bytes: &'a mut [u8]) {
            for byte in bytes {
                *byte = byte.wrapping_mul(2);
            }
        }
    }

    #[test]
    fn every_compilation_gives_the_same_bytes() {
        for processor in Processor::all() {
            let mut bytes: Vec<u8> = (0..=255).collect();
            double(processor, &mut bytes);
            assert!(bytes.iter().zip(0..=255_u8).all(|(byte, index)| *byte == index.wrapping_mul(2)));
        }
    }

    #[test]
    fn the_best_is_the_last_of_all() {
        assert_eq!(Processor::all().last(), Some(&Processor::best()));
        assert_eq!(Processor::all()[0].name(), "portable");
    }
}
