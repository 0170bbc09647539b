//! Filters one after the other, types checked before the first frame.

use crate::diagnostic::{nearest_name, printable};
use crate::sensors::observation::Image;
use crate::settings::FilterSettings;
use filter_api::{Descriptor, Filter, FilterError, Format, Frame, FrameMut, Parameter, Plugin};

use super::registry;

/// What a camera image passes through to become a mask.
pub struct Chain {
    stages: Vec<Stage>,
    width_px: usize,
    height_px: usize,
}

struct Stage {
    plugin: &'static Plugin,
    filter: Box<dyn Filter>,
    output: Vec<u8>,
}

/// Why a chain cannot be built, and which of its stages (counted from 0) is to blame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ChainError {
    /// The stage's index in the settings.
    pub stage: usize,
    /// The parameter at fault, if it is one.
    pub parameter: Option<String>,
    /// What is wrong.
    pub message: String,
    /// What to write instead.
    pub help: Option<String>,
}

impl Chain {
    /// Builds the chain for images of one size. Without any stage it is one Sobel filter with its defaults.
    ///
    /// # Errors
    /// If a filter or a parameter is unknown, a value is out of range, or a stage cannot read what comes before it.
    pub fn new(settings: &[FilterSettings], width_px: usize, height_px: usize) -> Result<Self, ChainError> {
        let default = [FilterSettings { name: "sobel".to_owned(), parameters: Vec::new() }];
        let settings = if settings.is_empty() { &default[..] } else { settings };
        let mut stages: Vec<Stage> = Vec::with_capacity(settings.len());
        let mut format = Format::Rgb;
        for (index, filter) in settings.iter().enumerate() {
            let fail = |(message, help)| ChainError { stage: index, parameter: None, message, help };
            let plugin = registry::find(&filter.name)
                .map_err(|help| fail((format!("there is no filter '{}'", printable(&filter.name)), Some(help))))?;
            let descriptor = plugin.descriptor;
            if !descriptor.reads.contains(&format) {
                let message =
                    format!("filter '{}' reads {}, not {}", filter.name, names(descriptor.reads), name(format));
                return Err(fail((message, Some(better_place(descriptor.reads, &stages)))));
            }
            let values = values(index, filter, descriptor.parameters)?;
            let filter = (plugin.create)(&values).map_err(|FilterError(message)| fail((message, None)))?;
            format = descriptor.writes;
            stages.push(Stage { plugin, filter, output: vec![0; width_px * height_px * format.channels()] });
        }
        if format != Format::Mask {
            let message = format!("the last filter writes {}, but the grid needs a mask", name(format));
            let help = Some("end the chain with a filter that writes a mask, such as sobel or colour".to_owned());
            return Err(ChainError { stage: settings.len() - 1, parameter: None, message, help });
        }
        Ok(Self { stages, width_px, height_px })
    }

    /// The mask of an image: one byte for each pixel, 0 or 255.
    ///
    /// # Errors
    /// If the image has another size than the chain was built for, or a filter fails.
    pub fn apply(&mut self, image: &Image) -> Result<&[u8], FilterError> {
        let (width, height) = (self.width_px, self.height_px);
        let mut input = image.frame()?;
        if (input.width_px(), input.height_px()) != (width, height) {
            return Err(FilterError(format!("the image is not {width}x{height} pixels")));
        }
        for stage in &mut self.stages {
            let format = stage.plugin.descriptor.writes;
            stage.filter.process(input, FrameMut::new(width, height, format, &mut stage.output)?)?;
            input = Frame::new(width, height, format, &stage.output)?;
        }
        Ok(self.mask())
    }

    /// The mask that [`Chain::apply`] made last.
    #[must_use]
    pub fn mask(&self) -> &[u8] {
        self.stages.last().map_or(&[], |stage| &stage.output)
    }

    /// What each stage made of the last image, in order: the filter's descriptor and its pixels.
    pub fn stages(&self) -> impl Iterator<Item = (&'static Descriptor, &[u8])> {
        self.stages.iter().map(|stage| (stage.plugin.descriptor, stage.output.as_slice()))
    }
}

/// Where in the chain a filter could read what is there, as an advice.
fn better_place(reads: &[Format], before: &[Stage]) -> String {
    let written = before.iter().map(|stage| stage.plugin.descriptor.writes);
    if std::iter::once(Format::Rgb).chain(written).any(|format| reads.contains(&format)) {
        return "put it earlier in the chain".to_owned();
    }
    let wanted = |plugin: &&Plugin| {
        let descriptor = plugin.descriptor;
        reads.contains(&descriptor.writes) && !descriptor.reads.iter().all(|format| reads.contains(format))
    };
    let names: Vec<_> = registry::built_in().iter().filter(wanted).map(|plugin| plugin.descriptor.name).collect();
    format!("put one before it that writes {}: {}", self::names(reads), names.join(", "))
}

fn values(stage: usize, filter: &FilterSettings, parameters: &[Parameter]) -> Result<Vec<f64>, ChainError> {
    let mut values: Vec<f64> = parameters.iter().map(|parameter| parameter.default).collect();
    for (key, value) in &filter.parameters {
        let fail = |message, help| ChainError { stage, parameter: Some(key.clone()), message, help: Some(help) };
        let Some(index) = parameters.iter().position(|parameter| parameter.name == key) else {
            let names = parameters.iter().map(|parameter| parameter.name);
            let help = match nearest_name(key, names.clone()) {
                Some(near) => format!("did you mean '{near}'?"),
                None => format!("it has: {}", names.collect::<Vec<_>>().join(", ")),
            };
            return Err(fail(format!("filter '{}' has no parameter '{}'", filter.name, printable(key)), help));
        };
        let Parameter { min, max, unit, default, .. } = parameters[index];
        if !(min..=max).contains(value) {
            let message = format!("'{key}' of filter '{}' must be {min} to {max} ({unit})", filter.name);
            return Err(fail(message, format!("the default is {default}")));
        }
        values[index] = *value;
    }
    Ok(values)
}

fn name(format: Format) -> &'static str {
    match format {
        Format::Rgb => "colour",
        Format::Grey => "grey",
        Format::Mask => "a mask",
    }
}

fn names(formats: &[Format]) -> String {
    formats.iter().map(|format| name(*format)).collect::<Vec<_>>().join(" or ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stage(name: &str, parameters: &[(&str, f64)]) -> FilterSettings {
        let parameters = parameters.iter().map(|(key, value)| ((*key).to_owned(), *value)).collect();
        FilterSettings { name: name.to_owned(), parameters }
    }

    fn error(settings: &[FilterSettings]) -> ChainError {
        Chain::new(settings, 4, 4).err().unwrap()
    }

    #[test]
    fn the_default_chain_marks_edges() {
        let mut image = Image::new(4, 4);
        for pixel in image.pixels.chunks_exact_mut(12).flat_map(|row| row[6..].iter_mut()) {
            *pixel = 200;
        }
        let mut chain = Chain::new(&[], 4, 4).unwrap();
        assert_eq!(chain.apply(&image).unwrap(), [0, 255, 255, 0].repeat(4));
    }

    #[test]
    fn a_mask_cannot_feed_a_filter_that_needs_colour() {
        let error = error(&[stage("sobel", &[]), stage("colour", &[])]);
        assert_eq!(error.stage, 1);
        assert_eq!(error.message, "filter 'colour' reads colour, not a mask");
    }

    /// A frame of 6x4 pixels, dark on the left and `step` brighter on the right.
    fn step_image(step: u8) -> Image {
        let mut image = Image::new(6, 4);
        for pixel in image.pixels.chunks_exact_mut(18).flat_map(|row| row[9..].iter_mut()) {
            *pixel = step;
        }
        image
    }

    #[test]
    fn a_blurred_step_is_wider_and_flatter() {
        // Luma 0 0 0 40 40 40 becomes 0 0 10 30 40 40: norms 0 40 120 120 40 0 instead of 0 0 160 160 0 0.
        let settings = |threshold| [stage("blur", &[("radius_px", 1.0)]), stage("sobel", &[("threshold", threshold)])];
        let mask = |threshold| Chain::new(&settings(threshold), 6, 4).unwrap().apply(&step_image(40)).unwrap().to_vec();
        assert_eq!(mask(121.0), [0; 24]);
        assert_eq!(mask(120.0), [0, 0, 255, 255, 0, 0].repeat(4));
        assert_eq!(mask(40.0), [0, 255, 255, 255, 255, 0].repeat(4));
    }

    #[test]
    fn a_horizon_clears_the_upper_part_of_the_edges() {
        let settings = [stage("sobel", &[]), stage("horizon", &[("top", 0.5)])];
        let mask = Chain::new(&settings, 6, 4).unwrap().apply(&step_image(40)).unwrap().to_vec();
        assert_eq!(mask, [[0; 12], [0, 0, 255, 255, 0, 0, 0, 0, 255, 255, 0, 0]].concat());
    }

    #[test]
    fn a_chain_must_fit_together_from_colour_to_a_mask() {
        let after_mask = error(&[stage("threshold", &[]), stage("blur", &[])]);
        assert_eq!(after_mask.message, "filter 'blur' reads colour or grey, not a mask");
        assert_eq!(after_mask.help.as_deref(), Some("put it earlier in the chain"));
        let first = error(&[stage("horizon", &[]), stage("sobel", &[])]);
        assert_eq!((first.stage, first.message.as_str()), (0, "filter 'horizon' reads a mask, not colour"));
        let help = "put one before it that writes a mask: colour, floor, scharr, sobel, threshold";
        assert_eq!(first.help.as_deref(), Some(help));
        let grey_at_the_end = error(&[stage("blur", &[])]);
        assert_eq!(grey_at_the_end.message, "the last filter writes grey, but the grid needs a mask");
    }

    #[test]
    fn a_filter_may_refuse_values_that_do_not_go_together() {
        let error = error(&[stage("threshold", &[("invert", 0.5)])]);
        assert_eq!(error.message, "'invert' of filter 'threshold' must be 0 or 1, not 0.5");
    }

    #[test]
    fn unknown_names_and_values_out_of_range_are_errors_with_a_way_out() {
        assert_eq!(error(&[stage("sobell", &[])]).help.as_deref(), Some("did you mean \"sobel\"?"));
        let unknown = error(&[stage("sobel", &[("treshold", 60.0)])]);
        assert_eq!(unknown.help.as_deref(), Some("did you mean 'threshold'?"));
        assert!(error(&[stage("sobel", &[("threshold", f64::NAN)])]).message.contains("must be 1 to 1443"));
    }

    #[test]
    fn an_image_of_another_size_is_refused() {
        assert!(Chain::new(&[], 4, 4).unwrap().apply(&Image::new(5, 4)).is_err());
    }
}
