//! What a condition computes: numbers and truth values of a pixel, each from those before it.

/// What a pixel is asked for by name; [`ASKED`] is the list.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Asked {
    Red,
    Green,
    Blue,
    Hue,
    Saturation,
    Value,
    Brightness,
    Nearness,
}

/// The names of a condition, with how people say them elsewhere.
pub(super) const ASKED: [(&str, Asked, &[&str]); 8] = [
    ("r", Asked::Red, &["red", "R"]),
    ("g", Asked::Green, &["green", "G"]),
    ("b", Asked::Blue, &["blue", "B"]),
    ("hue_deg", Asked::Hue, &["h", "hue", "H"]),
    ("saturation", Asked::Saturation, &["s", "sat", "S"]),
    ("value", Asked::Value, &["v", "val", "V", "max_rgb"]),
    ("nearness", Asked::Nearness, &["depth", "distance", "z", "range", "disparity"]),
    ("brightness", Asked::Brightness, &["luma", "grey", "gray", "luminance", "intensity", "y"]),
];

/// A number of a pixel; `usize` is the place of another one before it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Number {
    Constant(f32),
    Pixel(Asked),
    Negative(usize),
    Absolute(usize),
    Two(Sum, usize, usize),
}

/// What is made of two numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Sum {
    Add,
    Subtract,
    Multiply,
    Divide,
    Least,
    Greatest,
}

/// A truth value of a pixel; a comparison's `usize`s are places of numbers, the others' of truth values before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Truth {
    Compare(Comparison, usize, usize),
    Not(usize),
    And(usize, usize),
    Or(usize, usize),
}

/// How two numbers are compared; what is no number compares with nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Comparison {
    Less,
    AtMost,
    Equal,
    Different,
}

/// A condition that can be computed: its last truth value says whether a pixel is marked.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Program {
    pub numbers: Vec<Number>,
    pub truths: Vec<Truth>,
    /// The place of the truth value that counts.
    pub result: usize,
}

impl Program {
    /// The place of a number; what is computed already is not computed again.
    pub(super) fn number(&mut self, number: Number) -> usize {
        place(&mut self.numbers, number)
    }

    /// The place of a truth value.
    pub(super) fn truth(&mut self, truth: Truth) -> usize {
        place(&mut self.truths, truth)
    }

    /// Whether it asks for nearness, which a depth image has.
    pub(super) fn looks_at_depth(&self) -> bool {
        self.numbers.contains(&Number::Pixel(Asked::Nearness))
    }

    /// Whether it asks for a colour.
    pub(super) fn looks_at_colour(&self) -> bool {
        self.numbers.iter().any(|number| matches!(number, Number::Pixel(asked) if *asked != Asked::Nearness))
    }

    /// How much is computed for each pixel.
    pub(super) fn size(&self) -> usize {
        self.numbers.len() + self.truths.len()
    }
}

fn place<T: PartialEq>(all: &mut Vec<T>, one: T) -> usize {
    all.iter().position(|other| *other == one).unwrap_or_else(|| {
        all.push(one);
        all.len() - 1
    })
}
