//! Chains that begin alike: what they share is worked out once.

use super::Chain;
use crate::diagnostic::Result;
use crate::sensors::observation::Image;

impl Chain {
    /// How many of its first stages are those of another chain too, so that they make the same of an image.
    #[must_use]
    pub(crate) fn shared_with(&self, other: &Self) -> usize {
        self.settings.iter().zip(&other.settings).take_while(|(own, other)| own == other).count()
    }

    /// As [`Chain::apply`], where another chain has made of the same image what the first `shared` stages make.
    ///
    /// # Errors
    /// As [`Chain::apply`].
    pub(crate) fn apply_after(&mut self, image: &Image, other: &Self, shared: usize) -> Result<&[u8]> {
        for (stage, done) in self.stages.iter_mut().zip(&other.stages).take(shared) {
            stage.output.copy_from_slice(&done.output);
        }
        self.apply_from(image, shared)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filter::Catalogue;
    use crate::settings::FilterSettings;
    use filter_api::Format;

    fn chain(filters: &[(&str, &[(&str, f64)])]) -> Chain {
        let filters: Vec<FilterSettings> = filters
            .iter()
            .map(|(name, parameters)| FilterSettings {
                parameters: parameters.iter().map(|(key, value)| ((*key).to_owned(), *value)).collect(),
                ..FilterSettings::new(name)
            })
            .collect();
        Chain::new(&filters, 32, 16, &Catalogue::linked_in()).unwrap()
    }

    fn image() -> Image {
        let mut image = Image::of(Format::Rgb, 32, 16);
        image.pixels.iter_mut().enumerate().for_each(|(at, pixel)| *pixel = (at * 37 % 251) as u8);
        image
    }

    #[test]
    fn a_chain_that_goes_on_from_another_makes_the_same_bytes() {
        let mut first = chain(&[("blur", &[]), ("sobel", &[("threshold", 60.0)])]);
        let mut second = chain(&[("blur", &[]), ("sobel", &[("threshold", 90.0)])]);
        assert_eq!(second.shared_with(&first), 1);
        let (alone, image) = (second.apply(&image()).unwrap().to_vec(), image());
        let mut third = chain(&[("blur", &[]), ("sobel", &[("threshold", 90.0)])]);
        first.apply(&image).unwrap();
        assert_eq!(third.apply_after(&image, &first, 1).unwrap(), alone);
        assert!(third.stages().zip(second.stages()).all(|(one, other)| one.1 == other.1));
    }

    #[test]
    fn only_equal_beginnings_are_shared() {
        let plain = chain(&[("sobel", &[("threshold", 60.0)])]);
        assert_eq!(plain.shared_with(&chain(&[("sobel", &[("threshold", 61.0)])])), 0);
        assert_eq!(plain.shared_with(&chain(&[("sobel", &[("threshold", 60.0)])])), 1);
    }
}
