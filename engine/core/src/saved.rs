//! State as bytes: what a checkpoint keeps of a learner, little-endian, one value after the other.
//!
//! [`Passing`] is for state that is written and read by one and the same list, so that the two cannot differ.
//! Whoever saves knows what it has written, so there are no names and no lengths but those of lists.

use crate::geometry::{Pose, Twist};
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

    /// Bytes, with how many they are.
    pub fn bytes(&mut self, bytes: &[u8]) {
        self.whole(bytes.len() as u64);
        self.0.extend_from_slice(bytes);
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

    /// Bytes, as many as were written.
    ///
    /// # Errors
    /// If fewer are left.
    pub fn bytes(&mut self) -> Result<&'a [u8], Unfit> {
        let length = usize::try_from(self.whole()?).map_err(|_| Unfit)?;
        let (bytes, rest) = self.0.split_at_checked(length).ok_or(Unfit)?;
        self.0 = rest;
        Ok(bytes)
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

/// State on its way into bytes, or out of them: whoever has some passes it in the same order both ways.
#[derive(Debug)]
pub enum Passing<'a> {
    /// It is written.
    Out(Saving),
    /// It becomes what was written.
    In(Loading<'a>),
}

/// Whether what was written fits; writing always does.
pub type Passed = Result<(), Unfit>;

impl Passing<'_> {
    /// A whole number.
    ///
    /// # Errors
    /// If nothing is left, or what is there cannot be.
    pub fn whole(&mut self, value: &mut u64) -> Passed {
        match self {
            Self::Out(saving) => saving.whole(*value),
            Self::In(loading) => *value = loading.whole()?,
        }
        Ok(())
    }

    /// An index or a count.
    ///
    /// # Errors
    /// As [`Passing::whole`].
    pub fn size(&mut self, value: &mut usize) -> Passed {
        let mut whole = *value as u64;
        self.whole(&mut whole)?;
        *value = usize::try_from(whole).map_err(|_| Unfit)?;
        Ok(())
    }

    /// A whole number of 32 bits.
    ///
    /// # Errors
    /// As [`Passing::whole`].
    pub fn small(&mut self, value: &mut u32) -> Passed {
        let mut whole = u64::from(*value);
        self.whole(&mut whole)?;
        *value = u32::try_from(whole).map_err(|_| Unfit)?;
        Ok(())
    }

    /// A flag.
    ///
    /// # Errors
    /// As [`Passing::whole`].
    pub fn flag(&mut self, value: &mut bool) -> Passed {
        let mut whole = u64::from(*value);
        self.whole(&mut whole)?;
        *value = match whole {
            0 => false,
            1 => true,
            _ => return Err(Unfit),
        };
        Ok(())
    }

    /// A number, bit for bit, infinite ones too.
    ///
    /// # Errors
    /// As [`Passing::whole`].
    pub fn number(&mut self, value: &mut f64) -> Passed {
        let mut bits = value.to_bits();
        self.whole(&mut bits)?;
        *value = f64::from_bits(bits);
        Ok(())
    }

    /// A number of single precision, bit for bit.
    ///
    /// # Errors
    /// As [`Passing::whole`].
    pub fn single(&mut self, value: &mut f32) -> Passed {
        let mut bits = value.to_bits();
        self.small(&mut bits)?;
        *value = f32::from_bits(bits);
        Ok(())
    }

    /// Numbers, one after the other.
    ///
    /// # Errors
    /// As [`Passing::whole`].
    pub fn numbers<const N: usize>(&mut self, values: [&mut f64; N]) -> Passed {
        values.into_iter().try_for_each(|value| self.number(value))
    }

    /// Bytes; as many as there were.
    ///
    /// # Errors
    /// As [`Passing::whole`].
    pub fn bytes(&mut self, bytes: &mut Vec<u8>) -> Passed {
        match self {
            Self::Out(saving) => saving.bytes(bytes),
            Self::In(loading) => *bytes = loading.bytes()?.to_vec(),
        }
        Ok(())
    }

    /// A place and a heading.
    ///
    /// # Errors
    /// As [`Passing::whole`].
    pub fn pose(&mut self, pose: &mut Pose) -> Passed {
        self.numbers([&mut pose.x_m, &mut pose.y_m, &mut pose.yaw_rad])
    }

    /// Two speeds.
    ///
    /// # Errors
    /// As [`Passing::whole`].
    pub fn twist(&mut self, twist: &mut Twist) -> Passed {
        self.numbers([&mut twist.linear_m_per_s, &mut twist.angular_rad_per_s])
    }

    /// Where a stream of random numbers stands.
    ///
    /// # Errors
    /// As [`Passing::whole`].
    pub fn random(&mut self, random: &mut Random) -> Passed {
        match self {
            Self::Out(saving) => saving.random(random),
            Self::In(loading) => loading.random(random)?,
        }
        Ok(())
    }

    /// As many things as there must be.
    ///
    /// # Errors
    /// As [`Passing::whole`].
    pub fn all<T>(&mut self, things: &mut [T], mut each: impl FnMut(&mut Self, &mut T) -> Passed) -> Passed {
        let mut count = things.len();
        self.size(&mut count)?;
        if count != things.len() {
            return Err(Unfit);
        }
        things.iter_mut().try_for_each(|thing| each(self, thing))
    }

    /// As many things as there were; their room is kept.
    ///
    /// # Errors
    /// As [`Passing::whole`].
    pub fn list<T: Default>(
        &mut self,
        things: &mut Vec<T>,
        mut each: impl FnMut(&mut Self, &mut T) -> Passed,
    ) -> Passed {
        let mut count = things.len();
        self.size(&mut count)?;
        if let Self::In(_) = self {
            things.truncate(count);
        }
        things.iter_mut().try_for_each(|thing| each(self, thing))?;
        // One by one: a count that is wrong soon meets the end of the bytes.
        for _ in things.len()..count {
            let mut thing = T::default();
            each(self, &mut thing)?;
            things.push(thing);
        }
        Ok(())
    }

    /// A thing, or none.
    ///
    /// # Errors
    /// As [`Passing::whole`].
    pub fn option<T: Default>(
        &mut self,
        thing: &mut Option<T>,
        mut each: impl FnMut(&mut Self, &mut T) -> Passed,
    ) -> Passed {
        let mut is_there = thing.is_some();
        self.flag(&mut is_there)?;
        if !is_there {
            *thing = None;
            return Ok(());
        }
        each(self, thing.get_or_insert_default())
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
    fn what_is_passed_out_comes_in_as_it_was() {
        let pass = |by: &mut Passing<'_>, numbers: &mut Vec<f64>, thing: &mut Option<u64>, flag: &mut bool| {
            by.list(numbers, Passing::number)?;
            by.option(thing, Passing::whole)?;
            by.flag(flag)
        };
        let (mut numbers, mut thing, mut flag) = (vec![0.5, f64::INFINITY], Some(7), true);
        let mut out = Passing::Out(Saving::default());
        pass(&mut out, &mut numbers, &mut thing, &mut flag).unwrap();
        let Passing::Out(saving) = out else { panic!() };
        let bytes = saving.into_bytes();
        let (mut others, mut none, mut unset) = (vec![1.0; 5], None, false);
        let mut into = Passing::In(Loading::new(&bytes));
        pass(&mut into, &mut others, &mut none, &mut unset).unwrap();
        assert_eq!((others, none, unset), (numbers, thing, flag));
        let mut cut = Passing::In(Loading::new(&bytes[..bytes.len() - 1]));
        assert_eq!(pass(&mut cut, &mut Vec::new(), &mut None, &mut false), Err(Unfit));
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
