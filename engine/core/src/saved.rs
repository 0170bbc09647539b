//! State as bytes: what a checkpoint keeps of a learner, little-endian, one value after the other.
//!
//! Whoever saves knows what it has written, so there are no names and no lengths but those of lists.

use crate::random::Random;

/// Bytes that are being written.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Saving(Vec<u8>);

impl Saving {
    /// All that was written.
    #[must_use]
    pub fn into_bytes(self) -> Vec<u8> {
        self.0
    }

    /// A whole number.
    pub fn whole(&mut self, value: u64) {
        self.0.extend_from_slice(&value.to_le_bytes());
    }

    /// A number, bit for bit.
    pub fn number(&mut self, value: f64) {
        self.whole(value.to_bits());
    }

    /// Numbers, with how many they are.
    pub fn numbers(&mut self, values: &[f64]) {
        self.whole(values.len() as u64);
        values.iter().for_each(|value| self.number(*value));
    }

    /// Whole numbers, with how many they are.
    pub fn wholes(&mut self, values: &[u64]) {
        self.whole(values.len() as u64);
        values.iter().for_each(|value| self.whole(*value));
    }

    /// A stream of random numbers, where it stands.
    pub fn random(&mut self, random: &Random) {
        let (low, high) = random.position();
        self.whole(low);
        self.whole(high);
    }
}

/// Why bytes do not fit: they end too early, or hold what cannot be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Unfit;

/// Bytes that are being read in the order in which they were written.
#[derive(Debug, Clone, Copy)]
pub struct Loading<'a>(&'a [u8]);

impl<'a> Loading<'a> {
    /// From the beginning.
    #[must_use]
    pub const fn new(bytes: &'a [u8]) -> Self {
        Self(bytes)
    }

    /// Nothing is left.
    ///
    /// # Errors
    /// If something is.
    pub const fn end(self) -> Result<(), Unfit> {
        if self.0.is_empty() { Ok(()) } else { Err(Unfit) }
    }

    /// A whole number.
    ///
    /// # Errors
    /// If nothing is left.
    pub fn whole(&mut self) -> Result<u64, Unfit> {
        let (bytes, rest) = self.0.split_first_chunk().ok_or(Unfit)?;
        self.0 = rest;
        Ok(u64::from_le_bytes(*bytes))
    }

    /// A whole number below a bound, as an index or a count.
    ///
    /// # Errors
    /// If nothing is left, or the number is not below.
    pub fn index(&mut self, below: usize) -> Result<usize, Unfit> {
        usize::try_from(self.whole()?).ok().filter(|index| *index < below).ok_or(Unfit)
    }

    /// A finite number.
    ///
    /// # Errors
    /// If nothing is left, or it is not finite.
    pub fn number(&mut self) -> Result<f64, Unfit> {
        Some(f64::from_bits(self.whole()?)).filter(|number| number.is_finite()).ok_or(Unfit)
    }

    /// As many numbers as there must be, into `values`.
    ///
    /// # Errors
    /// If there are others.
    pub fn numbers(&mut self, values: &mut [f64]) -> Result<(), Unfit> {
        if self.whole()? != values.len() as u64 {
            return Err(Unfit);
        }
        values.iter_mut().try_for_each(|value| self.number().map(|number| *value = number))
    }

    /// As many whole numbers as there must be, into `values`.
    ///
    /// # Errors
    /// If there are others.
    pub fn wholes(&mut self, values: &mut [u64]) -> Result<(), Unfit> {
        if self.whole()? != values.len() as u64 {
            return Err(Unfit);
        }
        values.iter_mut().try_for_each(|value| self.whole().map(|whole| *value = whole))
    }

    /// Puts a stream of random numbers where it stood.
    ///
    /// # Errors
    /// If nothing is left.
    pub fn random(&mut self, random: &mut Random) -> Result<(), Unfit> {
        random.set_position(self.whole()?, self.whole()?);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    #[test]
    fn what_was_written_is_read_back_in_its_order() {
        let mut random = Random::new(3, Stream::Learner);
        random.unit();
        let mut saving = Saving::default();
        saving.numbers(&[0.1, -0.0]);
        saving.whole(7);
        saving.random(&random);
        let bytes = saving.into_bytes();
        let (mut loading, mut values) = (Loading::new(&bytes), [1.0; 2]);
        loading.numbers(&mut values).unwrap();
        assert_eq!(values.map(f64::to_bits), [0.1_f64, -0.0].map(f64::to_bits));
        assert_eq!(loading.index(8), Ok(7));
        let mut again = Random::new(3, Stream::Learner);
        loading.random(&mut again).unwrap();
        assert_eq!(again.unit(), random.unit());
        assert_eq!(loading.end(), Ok(()));
    }

    #[test]
    fn bytes_that_do_not_fit_are_refused() {
        let mut saving = Saving::default();
        saving.number(f64::NAN);
        let bytes = saving.into_bytes();
        assert_eq!(Loading::new(&bytes).number(), Err(Unfit));
        assert_eq!(Loading::new(&bytes).numbers(&mut [0.0]), Err(Unfit));
        assert_eq!(Loading::new(&bytes[..7]).whole(), Err(Unfit));
        assert_eq!(Loading::new(&bytes).end(), Err(Unfit));
    }
}
