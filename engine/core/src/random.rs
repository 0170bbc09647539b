//! Randomness is handed out: one seed, one named stream for each consumer.
//!
//! Streams are ChaCha8 keyed by the seed; the name chooses the stream number, so that a new consumer never shifts the
//! draws of another. Numbers are derived from raw 32- and 64-bit words here, never by a library's distribution, so that
//! they stay the same across library versions.

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::sync::LazyLock;

/// Who draws random numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u64)]
pub enum Stream {
    /// The learner's first values and choices.
    Learner = 1,
    /// Speed noise of the drive.
    Drive = 2,
    /// Pixel noise.
    Camera = 3,
    /// Range noise.
    Laser = 4,
    /// Where recovery puts the robot.
    Recovery = 5,
    /// The learner's choices in the frozen test.
    Test = 6,
    /// The choices of a robot that knows nothing, in its test.
    Untrained = 7,
    /// What is drawn anew for each attempt.
    Variation = 8,
    /// The speeds of movers that have a range of them.
    Movers = 9,
    /// Which world comes next.
    Worlds = 10,
    /// What stands in a world that is made by rule.
    Families = 11,
    /// The choices of learned policies that a script uses.
    Used = 12,
    /// The worlds and seeds of a certificate.
    Certify = 13,
}

/// One stream of random numbers.
#[derive(Debug, Clone)]
pub struct Random {
    generator: ChaCha8Rng,
}

impl Random {
    /// The stream of one consumer under a run's seed.
    #[must_use]
    pub fn new(seed: u64, stream: Stream) -> Self {
        Self::of_body(seed, stream, 0)
    }

    /// The stream of one consumer in one of the bodies of a world; for body 0 it is that of [`Random::new`].
    ///
    /// The body's index stands in the upper half of the stream's number, above every named stream, so that no two
    /// bodies and no two consumers share one.
    #[must_use]
    pub(crate) fn of_body(seed: u64, stream: Stream, body: u32) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(u64::from(body) << 32 | stream as u64);
        Self { generator }
    }

    /// Where the stream stands, in words of 32 bits: the lower and the upper half of the number.
    #[must_use]
    pub(crate) fn position(&self) -> (u64, u64) {
        let words = self.generator.get_word_pos();
        (words as u64, (words >> 64) as u64)
    }

    /// Puts the stream where it stood once, see [`Random::position`].
    pub(crate) fn set_position(&mut self, low: u64, high: u64) {
        self.generator.set_word_pos(u128::from(low) | u128::from(high) << 64);
    }

    /// A number in [0, 1), a multiple of 2^-53.
    pub fn unit(&mut self) -> f64 {
        (self.generator.next_u64() >> 11) as f64 * (1.0 / (1_u64 << 53) as f64)
    }

    /// A number in [low, high).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// A whole number below `bound`, which must not be 0. The bias is below `bound` / 2^32.
    pub fn below(&mut self, bound: u32) -> u32 {
        ((u64::from(self.generator.next_u32()) * u64::from(bound)) >> 32) as u32
    }

    /// A draw from the normal distribution with mean 0 and deviation 1 (Box and Muller 1958).
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * libm::log(1.0 - self.unit())).sqrt();
        radius * libm::cos(std::f64::consts::TAU * self.unit())
    }
}

/// Length of [`normal_table`]'s part in which a run may start.
pub(crate) const NORMAL_STARTS: usize = 1 << 15;
/// How many draws follow every start of [`normal_table`].
pub(crate) const NORMAL_RUN: usize = 1280 * 3;

/// Draws from the normal distribution, computed once: `NORMAL_STARTS + NORMAL_RUN` of them.
///
/// Sensor noise takes runs of consecutive draws from a start that the seed chooses: adding a run is a vector operation,
/// and thousands of fresh draws for each frame would cost more than the frame.
#[must_use]
pub(crate) fn normal_table() -> &'static [f32] {
    static TABLE: LazyLock<Vec<f32>> = LazyLock::new(|| {
        let mut random = Random::new(0, Stream::Camera);
        (0..NORMAL_STARTS + NORMAL_RUN).map(|_| random.normal() as f32).collect()
    });
    &TABLE
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_of_one_seed_differ_and_repeat() {
        let draw = |seed, stream| Random::new(seed, stream).unit();
        assert_eq!(draw(7, Stream::Drive), draw(7, Stream::Drive));
        assert_ne!(draw(7, Stream::Drive), draw(7, Stream::Laser));
        assert_ne!(draw(7, Stream::Drive), draw(8, Stream::Drive));
    }

    #[test]
    fn the_first_body_has_the_streams_of_a_robot_alone_and_the_others_have_their_own() {
        let draw = |stream, body| Random::of_body(7, stream, body).unit();
        assert_eq!(draw(Stream::Drive, 0), Random::new(7, Stream::Drive).unit());
        let bodies: Vec<_> = (0..4).flat_map(|body| [draw(Stream::Drive, body), draw(Stream::Camera, body)]).collect();
        assert!((1..bodies.len()).all(|index| !bodies[..index].contains(&bodies[index])), "{bodies:?}");
    }

    #[test]
    fn normal_draws_have_mean_zero_and_deviation_one() {
        let table = normal_table();
        let count = table.len() as f32;
        let mean = table.iter().sum::<f32>() / count;
        let variance = table.iter().map(|x| x * x).sum::<f32>() / count;
        assert!(mean.abs() < 0.02, "{mean}");
        assert!((variance - 1.0).abs() < 0.03, "{variance}");
    }
}
