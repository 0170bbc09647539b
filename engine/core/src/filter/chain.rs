//! Filters one after the other, types checked before the first frame.

use std::ops::Range;
use std::sync::Arc;

use filter_api::{Descriptor, FilterError, Format, Frame, FrameMut, Parameter, ParameterKind};

use super::beginning::{descriptor_of, first_reads};
use super::catalogue::Catalogue;
use super::condition::{self, ConditionError, EXAMPLE};
use super::entry::{Entry, Form};
use super::purity;
use super::running::Running;
use crate::diagnostic::{Diagnostic, Result, nearest_name, printable};
use crate::sensors::observation::Image;
use crate::settings::{CONDITION, FilterSettings};

/// What a camera image passes through to become a mask.
pub struct Chain {
    pub(super) stages: Vec<Stage>,
    /// What each stage was made from.
    pub(super) settings: Vec<FilterSettings>,
    width_px: usize,
    height_px: usize,
}

pub(super) struct Stage {
    pub(super) descriptor: &'static Descriptor,
    pub(super) filter: Box<dyn Running>,
    pub(super) output: Vec<u8>,
}

/// Why a chain cannot be built, and which of its stages (counted from 0) is to blame.
#[derive(Debug, Clone)]
pub struct ChainError {
    /// The stage's index in the settings.
    pub stage: usize,
    /// The parameter at fault, if it is one.
    pub parameter: Option<String>,
    /// Where in the text of a condition, and what stands there.
    pub within: Option<(Range<usize>, &'static str)>,
    /// What is wrong, and what to write instead.
    pub error: Box<Diagnostic>,
}

impl ChainError {
    fn new(stage: usize, message: String, help: Option<String>) -> Self {
        let error = Diagnostic::new("E-FILTER-SETTING", message);
        Self { stage, parameter: None, within: None, error: Box::new(Diagnostic { help, ..error }) }
    }
}

impl Chain {
    /// Builds the chain for images of one size. Without any stage it is one Sobel filter with its defaults.
    ///
    /// # Errors
    /// If a filter or a parameter is unknown, a value is out of range, a stage cannot read what comes before it, or a
    /// stranger's filter may not be loaded or breaks the law.
    pub fn new(
        settings: &[FilterSettings],
        width_px: usize,
        height_px: usize,
        catalogue: &Catalogue,
    ) -> std::result::Result<Self, ChainError> {
        let default = [FilterSettings::new("sobel")];
        let settings = if settings.is_empty() { &default[..] } else { settings };
        if let Some(fault) = Self::faults(settings, catalogue).into_iter().next() {
            return Err(fault);
        }
        let mut stages: Vec<Stage> = Vec::with_capacity(settings.len());
        let mut format = first_reads(settings, catalogue);
        for (index, filter) in settings.iter().enumerate() {
            let at_stage = |error| ChainError { stage: index, parameter: None, within: None, error };
            let entry = catalogue.find(&filter.name).map_err(at_stage)?;
            let descriptor = descriptor_of(&entry, filter);
            let (values, _) = values(index, filter, descriptor.parameters);
            let filter = match (entry.by_condition, &filter.condition) {
                (true, Some(text)) => condition::create(text).map_err(|wrong| in_condition(index, wrong))?,
                _ => create(&entry, &values, format).map_err(at_stage)?,
            };
            format = descriptor.writes;
            stages.push(Stage { descriptor, filter, output: vec![0; width_px * height_px * format.channels()] });
        }
        Ok(Self { stages, settings: settings.to_vec(), width_px, height_px })
    }

    /// Everything that is wrong with a chain as it is written, before any filter is tried; in the order of the stages.
    #[must_use]
    pub(crate) fn faults(settings: &[FilterSettings], catalogue: &Catalogue) -> Vec<ChainError> {
        let mut faults = Vec::new();
        let mut before: Vec<&'static Descriptor> = Vec::with_capacity(settings.len());
        // What comes out of the stage before; unknown behind an unknown filter.
        let mut format = Some(first_reads(settings, catalogue));
        for (index, filter) in settings.iter().enumerate() {
            let (descriptor, by_condition) = match catalogue.find(&filter.name) {
                Ok(entry) => (descriptor_of(&entry, filter), entry.by_condition),
                Err(error) => {
                    faults.push(ChainError { stage: index, parameter: None, within: None, error });
                    format = None;
                    continue;
                }
            };
            if let Some(format) = format.filter(|format| !descriptor.reads.contains(format)) {
                let message =
                    format!("filter '{}' reads {}, not {}", filter.name, names(descriptor.reads), name(format));
                let place = better_place(descriptor, &before, catalogue);
                faults.push(ChainError::new(index, message, Some(place)));
            }
            faults.extend(fault_of_condition(index, filter, by_condition));
            if !by_condition {
                faults.extend(values(index, filter, descriptor.parameters).1);
            }
            format = Some(descriptor.writes);
            before.push(descriptor);
        }
        if let Some(format) =
            format.filter(|format| *format != Format::Mask && faults.is_empty() && !settings.is_empty())
        {
            let message = format!("the last filter writes {}, but the grid needs a mask", name(format));
            let help = Some("end the chain with a filter that writes a mask, such as sobel or colour".to_owned());
            faults.push(ChainError::new(settings.len() - 1, message, help));
        }
        faults
    }

    /// What its first filter likes best, colour or grey: the mask of an image in this format is that of its colours.
    #[must_use]
    pub(crate) fn likes(&self) -> Format {
        self.stages.first().and_then(|stage| stage.descriptor.reads.first()).copied().unwrap_or(Format::Rgb)
    }

    /// The mask of an image: one byte for each pixel, 0 or 255.
    ///
    /// # Errors
    /// If the image has another size than the chain was built for, or a filter fails.
    pub fn apply(&mut self, image: &Image) -> Result<&[u8]> {
        self.apply_from(image, 0)
    }

    /// As [`Chain::apply`], with what its first `done` stages make of the image in place already.
    pub(super) fn apply_from(&mut self, image: &Image, done: usize) -> Result<&[u8]> {
        let (width, height) = (self.width_px, self.height_px);
        let wrong = |FilterError(words)| Box::new(Diagnostic::new("E-FILTER", format!("a filter failed: {words}")));
        let mut input = image.frame().map_err(wrong)?;
        if (input.width_px(), input.height_px()) != (width, height) {
            return Err(wrong(FilterError(format!("the image is not {width}x{height} pixels"))));
        }
        for (index, stage) in self.stages.iter_mut().enumerate() {
            let format = stage.descriptor.writes;
            if index < done {
                input = Frame::new(width, height, format, &stage.output).map_err(wrong)?;
                continue;
            }
            stage.filter.process(input, FrameMut::new(width, height, format, &mut stage.output).map_err(wrong)?)?;
            input = Frame::new(width, height, format, &stage.output).map_err(wrong)?;
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
        self.stages.iter().map(|stage| (stage.descriptor, stage.output.as_slice()))
    }
}

/// An instance; of a stranger's filter only after it was seen to keep the law with these values.
fn create(entry: &Arc<Entry>, values: &[f64], reads: Format) -> Result<Box<dyn Running>> {
    if entry.form != Form::LinkedIn {
        purity::check_purity(entry, values, reads)?;
    }
    (entry.create)(values)
}

/// Where in the chain a filter could read what is there, as an advice; nowhere beside another one that makes the mask.
fn better_place(filter: &Descriptor, before: &[&Descriptor], catalogue: &Catalogue) -> String {
    let makes_mask = |filter: &Descriptor| filter.writes == Format::Mask && !filter.reads.contains(&Format::Mask);
    if let (true, Some(other)) = (makes_mask(filter), before.iter().find(|other| makes_mask(other))) {
        return match other.name == filter.name {
            true => format!("one chain makes one mask: only one '{}' can be in it", filter.name),
            false => format!("one chain makes one mask: leave out '{}' or '{}'", other.name, filter.name),
        };
    }
    let reads = filter.reads;
    let written = before.iter().map(|descriptor| descriptor.writes);
    if [Format::Rgb, Format::Depth].into_iter().chain(written).any(|format| reads.contains(&format)) {
        return "put it earlier in the chain".to_owned();
    }
    let wanted = |descriptor: &&'static Descriptor| {
        reads.contains(&descriptor.writes) && !descriptor.reads.iter().all(|format| reads.contains(format))
    };
    let own = catalogue.own().map(|entry| entry.descriptor);
    let names: Vec<_> = own.filter(wanted).map(|descriptor| descriptor.name).collect();
    format!("put one before it that writes {}: {}", self::names(reads), names.join(", "))
}

/// What is wrong with a condition: its first mistake, or that it stands where none belongs, or does not where one does.
fn fault_of_condition(stage: usize, filter: &FilterSettings, by_condition: bool) -> Option<ChainError> {
    let fail = |parameter: &str, message, help| {
        let error = ChainError::new(stage, message, Some(help));
        Some(ChainError { parameter: Some(parameter.to_owned()), ..error })
    };
    let name = &filter.name;
    match (by_condition, &filter.condition, filter.parameters.first()) {
        (true, _, Some((key, _))) => {
            let message = format!("filter '{name}' has no parameter '{}'", printable(key));
            fail(key, message, format!("it has its condition: #{{ {CONDITION}: \"{EXAMPLE}\" }}"))
        }
        (true, Some(text), None) => condition::check(text).err().map(|wrong| in_condition(stage, wrong)),
        (true, None, None) => {
            let message = format!("filter '{name}' needs a condition: which pixels it marks");
            Some(ChainError::new(stage, message, Some(format!("write filter(\"{name}\", \"{EXAMPLE}\");"))))
        }
        (false, Some(_), _) => {
            let message = format!("filter '{name}' marks by no condition");
            fail(
                CONDITION,
                message,
                format!("give its parameters by name; a condition belongs to filter(\"where\", \"{EXAMPLE}\");"),
            )
        }
        (false, None, _) => None,
    }
}

fn in_condition(stage: usize, wrong: ConditionError) -> ChainError {
    let error = ChainError::new(stage, wrong.message, Some(wrong.help));
    ChainError { parameter: Some(CONDITION.to_owned()), within: Some((wrong.span, wrong.label)), ..error }
}

/// The value of each parameter, and what is wrong with those that are written.
fn values(stage: usize, filter: &FilterSettings, parameters: &[Parameter]) -> (Vec<f64>, Vec<ChainError>) {
    let mut values: Vec<f64> = parameters.iter().map(|parameter| parameter.default).collect();
    let mut faults = Vec::new();
    for (key, value) in &filter.parameters {
        let fail =
            |message, help| ChainError { parameter: Some(key.clone()), ..ChainError::new(stage, message, Some(help)) };
        let Some(index) = parameters.iter().position(|parameter| parameter.name == key) else {
            let names = parameters.iter().map(|parameter| parameter.name);
            let help = match nearest_name(key, names.clone()) {
                Some(near) => format!("did you mean '{near}'?"),
                None if parameters.is_empty() => "it has none".to_owned(),
                None => format!("it has: {}", names.collect::<Vec<_>>().join(", ")),
            };
            faults.push(fail(format!("filter '{}' has no parameter '{}'", filter.name, printable(key)), help));
            continue;
        };
        let Parameter { kind, min, max, unit, default, .. } = parameters[index];
        let (fits, words) = match kind {
            ParameterKind::Number => (true, ""),
            ParameterKind::Whole => (value.fract() == 0.0, ", a whole number"),
            ParameterKind::Switch => (value.fract() == 0.0, ", which is false or true"),
        };
        if !fits || !(min..=max).contains(value) {
            let message = format!("'{key}' of filter '{}' must be {min} to {max}{words} ({unit})", filter.name);
            faults.push(fail(message, format!("the default is {default}")));
            continue;
        }
        values[index] = *value;
    }
    (values, faults)
}

fn name(format: Format) -> &'static str {
    match format {
        Format::Rgb => "colour",
        Format::Grey => "grey",
        Format::Mask => "a mask",
        Format::Depth => "depth",
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
        FilterSettings { parameters, ..FilterSettings::new(name) }
    }

    fn chain(settings: &[FilterSettings], width_px: usize) -> std::result::Result<Chain, ChainError> {
        Chain::new(settings, width_px, 4, &Catalogue::linked_in())
    }

    fn error(settings: &[FilterSettings]) -> Box<Diagnostic> {
        chain(settings, 4).err().unwrap().error
    }

    #[test]
    fn the_default_chain_marks_edges() {
        let mut image = Image::new(4, 4);
        for pixel in image.pixels.chunks_exact_mut(12).flat_map(|row| row[6..].iter_mut()) {
            *pixel = 200;
        }
        let mut chain = chain(&[], 4).unwrap();
        assert_eq!(chain.apply(&image).unwrap(), [0, 255, 255, 0].repeat(4));
    }

    #[test]
    fn an_error_names_its_stage_and_its_parameter() {
        let error = chain(&[stage("sobel", &[]), stage("horizon", &[("top", 2.0)])], 4).err().unwrap();
        assert_eq!((error.stage, error.parameter.as_deref()), (1, Some("top")));
    }

    #[test]
    fn a_mask_cannot_feed_a_filter_that_needs_colour() {
        let error = error(&[stage("sobel", &[]), stage("colour", &[])]);
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
        let mask = |threshold| chain(&settings(threshold), 6).unwrap().apply(&step_image(40)).unwrap().to_vec();
        assert_eq!(mask(121.0), [0; 24]);
        assert_eq!(mask(120.0), [0, 0, 255, 255, 0, 0].repeat(4));
        assert_eq!(mask(40.0), [0, 255, 255, 255, 255, 0].repeat(4));
    }

    #[test]
    fn a_horizon_clears_the_upper_part_of_the_edges() {
        let settings = [stage("sobel", &[]), stage("horizon", &[("top", 0.5)])];
        let mask = chain(&settings, 6).unwrap().apply(&step_image(40)).unwrap().to_vec();
        assert_eq!(mask, [[0; 12], [0, 0, 255, 255, 0, 0, 0, 0, 255, 255, 0, 0]].concat());
    }

    #[test]
    fn a_chain_must_fit_together_from_colour_to_a_mask() {
        let after_mask = error(&[stage("threshold", &[]), stage("blur", &[])]);
        assert_eq!(after_mask.message, "filter 'blur' reads grey or colour, not a mask");
        assert_eq!(after_mask.help.as_deref(), Some("put it earlier in the chain"));
        let two_masks = error(&[stage("colour", &[]), stage("colour", &[])]);
        assert_eq!(two_masks.help.as_deref(), Some("one chain makes one mask: only one 'colour' can be in it"));
        let two_ways = error(&[stage("colour", &[]), stage("sobel", &[])]);
        assert_eq!(two_ways.help.as_deref(), Some("one chain makes one mask: leave out 'colour' or 'sobel'"));
        let first = error(&[stage("horizon", &[]), stage("sobel", &[])]);
        assert_eq!(first.message, "filter 'horizon' reads a mask, not colour");
        let help =
            "put one before it that writes a mask: chroma, colour, floor, relief, scharr, sobel, threshold, where";
        assert_eq!(first.help.as_deref(), Some(help));
        let grey_at_the_end = error(&[stage("blur", &[])]);
        assert_eq!(grey_at_the_end.message, "the last filter writes grey, but the grid needs a mask");
    }

    #[test]
    fn a_filter_that_likes_grey_best_sees_the_brightness_of_colours_alone() {
        let mut random = crate::random::Random::new(1, crate::random::Stream::Test);
        let (mut image, mut grey) = (Image::new(16, 12), Image::of(Format::Grey, 16, 12));
        image.pixels.fill_with(|| random.below(256) as u8);
        image.frame().unwrap().write_luma(&mut grey.pixels).unwrap();
        let catalogue = Catalogue::linked_in();
        for name in ["blur", "scharr", "sobel", "threshold"] {
            let stages = [stage(name, &[]), stage("threshold", &[])];
            let mut chain = Chain::new(&stages[..if name == "blur" { 2 } else { 1 }], 16, 12, &catalogue).unwrap();
            assert_eq!(chain.likes(), Format::Grey);
            let of_colours = chain.apply(&image).unwrap().to_vec();
            assert_eq!(chain.apply(&grey).unwrap(), of_colours, "{name}");
        }
    }

    #[test]
    fn a_switch_is_on_or_off() {
        let error = error(&[stage("threshold", &[("invert", 0.5)])]);
        assert_eq!(error.message, "'invert' of filter 'threshold' must be 0 to 1, which is false or true (on or off)");
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
        assert!(chain(&[], 4).unwrap().apply(&Image::new(5, 4)).is_err());
    }
}
