//! What a library or a module says of itself, read out of it and checked before anything believes it.

use std::path::Path;

use filter_api::abi::BRIGHTNESS;
use filter_api::{Descriptor, FilterError, Format, Frame, FrameMut, Parameter, ParameterKind};
use serde::{Deserialize, Serialize};

use super::running::failed;
use crate::diagnostic::{Diagnostic, Result, printable};

/// The most parameters that a filter may have.
pub(super) const MOST_PARAMETERS: usize = 64;
/// The longest text of a descriptor that is read at all, in bytes.
pub(super) const LONGEST_TEXT_BYTES: usize = 800;

/// A descriptor as it was found, not checked yet.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct DescribedFilter {
    pub(super) name: String,
    pub(super) version: String,
    pub(super) licence: String,
    pub(super) purpose: String,
    pub(super) reads: u32,
    pub(super) writes: u32,
    pub(super) parameters: Vec<DescribedParameter>,
}

/// A parameter as it was found.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct DescribedParameter {
    pub(super) name: String,
    pub(super) unit: String,
    pub(super) purpose: String,
    pub(super) kind: u32,
    pub(super) min: f64,
    pub(super) max: f64,
    pub(super) default: f64,
}

impl DescribedFilter {
    /// The descriptor, if it keeps the law. It lives as long as the program: libraries are never unloaded.
    ///
    /// # Errors
    /// With the first clause that it breaks.
    pub(super) fn check(self, code: &'static str, path: &Path) -> Result<&'static Descriptor> {
        // What a filter likes best stands first.
        let order = if self.reads & BRIGHTNESS == 0 { [1, 2, 4, 16] } else { [2, 1, 4, 16] };
        let reads: Vec<Format> =
            order.into_iter().filter(|bit| self.reads & bit != 0).filter_map(Format::from_bit).collect();
        let writes = Format::from_bit(self.writes);
        let fault = self.fault().or_else(|| {
            let unknown = reads.is_empty() || self.reads > 31 || !matches!(writes, Some(Format::Grey | Format::Mask));
            unknown.then(|| "it must read colour, grey, masks or depth, and write grey frames or masks".to_owned())
        });
        let (None, Some(writes)) = (&fault, writes) else {
            let shown = printable(&path.display().to_string());
            let message = format!("the descriptor of '{shown}' is wrong: {}", fault.unwrap_or_default());
            let help = "tell its author; the law of filters is plugins/filter-api/README.md";
            return Diagnostic::new(code, message).help(help).fail();
        };
        let parameters: Vec<Parameter> = self.parameters.into_iter().filter_map(DescribedParameter::keep).collect();
        Ok(Box::leak(Box::new(Descriptor {
            name: self.name.leak(),
            version: self.version.leak(),
            licence: self.licence.leak(),
            purpose: self.purpose.leak(),
            reads: reads.leak(),
            writes,
            parameters: parameters.leak(),
        })))
    }

    fn fault(&self) -> Option<String> {
        if !is_name(&self.name) {
            return Some(format!(
                "the name '{}' must be of lower case letters, digits and '_', and begin with a letter",
                printable(&self.name)
            ));
        }
        let texts = [("version", &self.version), ("licence", &self.licence), ("purpose", &self.purpose)];
        if let Some((what, _)) = texts.iter().find(|(_, text)| !is_text(text)) {
            return Some(format!("its {what} must be one line of 1 to 200 characters"));
        }
        let twice = |index: usize, name: &str| self.parameters[..index].iter().any(|before| before.name == name);
        let mut parameters = self.parameters.iter().enumerate();
        parameters.find_map(|(index, parameter)| {
            let fault = if twice(index, &parameter.name) { Some("exists twice") } else { parameter.fault() };
            fault.map(|fault| format!("parameter '{}' {fault}", printable(&parameter.name)))
        })
    }
}

impl DescribedParameter {
    fn fault(&self) -> Option<&'static str> {
        let Self { min, max, default, .. } = *self;
        let whole = |value: f64| value.fract() == 0.0;
        let fits = match kind(self.kind) {
            None => return Some("has a type that this engine does not know"),
            Some(ParameterKind::Number) => true,
            Some(ParameterKind::Whole) => whole(min) && whole(max) && whole(default),
            Some(ParameterKind::Switch) => min == 0.0 && max == 1.0 && whole(default),
        };
        if !is_name(&self.name) {
            return Some("must be named with lower case letters, digits and '_'");
        }
        if !is_text(&self.unit) || !is_text(&self.purpose) {
            return Some("must have a unit and a purpose, one line each");
        }
        let ordered = min.is_finite() && max.is_finite() && min <= default && default <= max;
        (!fits || !ordered).then_some("has a range or a default that does not fit its type")
    }

    fn keep(self) -> Option<Parameter> {
        let Self { min, max, default, .. } = self;
        let (name, unit, purpose) = (self.name.leak(), self.unit.leak(), self.purpose.leak());
        Some(Parameter { name, kind: kind(self.kind)?, unit, min, max, default, purpose })
    }
}

fn kind(number: u32) -> Option<ParameterKind> {
    let kinds = [ParameterKind::Number, ParameterKind::Whole, ParameterKind::Switch];
    kinds.into_iter().find(|kind| *kind as u32 == number)
}

fn is_name(name: &str) -> bool {
    let legal = |c: u8| c.is_ascii_lowercase() || c.is_ascii_digit() || c == b'_';
    (1..=64).contains(&name.len()) && name.as_bytes()[0].is_ascii_lowercase() && name.bytes().all(legal)
}

/// Whether a text may be printed as it is: one line without control characters.
fn is_text(text: &str) -> bool {
    !text.is_empty() && printable(text) == text
}

/// Checks what a stranger's filter may rely on: frames of its formats, equal in size.
///
/// # Errors
/// If they are not.
pub(super) fn check_frames(descriptor: &Descriptor, input: &Frame<'_>, output: &FrameMut<'_>) -> Result<()> {
    let fault = match output.check_same_size(input) {
        Err(FilterError(words)) => words,
        Ok(()) if descriptor.reads.contains(&input.format()) && descriptor.writes == output.format() => return Ok(()),
        Ok(()) => format!("it does not make {:?} of {:?} frames", output.format(), input.format()),
    };
    Err(failed("E-FILTER", descriptor.name, &fault))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ink() -> DescribedFilter {
        let text = |words: &str| words.to_owned();
        let level = DescribedParameter {
            name: text("level"),
            unit: text("grey levels"),
            purpose: text("How dark ink is."),
            kind: 1,
            min: 0.0,
            max: 255.0,
            default: 40.0,
        };
        DescribedFilter {
            name: text("ink"),
            version: text("1.0"),
            licence: text("MIT"),
            purpose: text("Marks ink."),
            reads: 3,
            writes: 4,
            parameters: vec![level],
        }
    }

    #[test]
    fn a_descriptor_that_keeps_the_law_is_believed() {
        let descriptor = ink().check("E-NATIVE-ABI", Path::new("ink.so")).unwrap();
        assert_eq!((descriptor.name, descriptor.writes), ("ink", Format::Mask));
        assert_eq!(descriptor.reads, [Format::Rgb, Format::Grey]);
        let bright =
            DescribedFilter { reads: 3 | BRIGHTNESS, ..ink() }.check("E-NATIVE-ABI", Path::new("ink.so")).unwrap();
        assert_eq!(bright.reads, [Format::Grey, Format::Rgb]);
        assert_eq!(descriptor.parameters[0].kind, ParameterKind::Whole);
    }

    #[test]
    fn every_broken_clause_is_named() {
        let fault = |change: fn(&mut DescribedFilter)| {
            let mut described = ink();
            change(&mut described);
            described.check("E-NATIVE-ABI", Path::new("ink.so")).err().unwrap().message
        };
        assert!(fault(|ink| ink.name = "../ink".to_owned()).contains("lower case"));
        assert!(fault(|ink| ink.purpose = "two\nlines".to_owned()).contains("one line"));
        assert!(fault(|ink| ink.writes = 1).contains("write grey frames or masks"));
        assert!(fault(|ink| ink.reads = 32).contains("must read"));
        assert!(fault(|ink| ink.parameters.push(ink.parameters[0].clone())).contains("twice"));
        assert!(fault(|ink| ink.parameters[0].kind = 9).contains("type"));
        assert!(fault(|ink| ink.parameters[0].default = f64::NAN).contains("range or a default"));
        assert!(fault(|ink| ink.parameters[0].default = 0.5).contains("range or a default"));
        assert!(fault(|ink| ink.parameters[0].unit.clear()).contains("unit"));
    }
}
