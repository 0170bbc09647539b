//! Figures that are measured only where a condition asks for them, since they are of something that it names.

use std::fmt;

use serde::{Deserialize, Serialize};

/// A figure as a condition asks for it, with what stands in its parentheses.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// The figure's name.
    pub figure: &'static str,
    /// What to measure.
    pub probe: Probe,
    /// The name of a mover or of a place, where the figure is of one.
    pub of: Option<String>,
    /// The distance that is asked for, metres, where the figure takes one; else 0.
    pub metres: f64,
}

/// What can be measured on request.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Probe {
    /// Upper median of the gap between the robot's body and a mover's, seen from above, metres.
    Gap,
    /// Mean distance of that gap from another one, metres.
    GapError,
    /// Steps in which the two touched.
    ContactsWith,
    /// Share of the floor that the body covered.
    FloorCovered,
    /// Entries into a place, for 1,000 steps.
    Visits,
    /// Gates passed in order and direction, for 1,000 steps.
    Gates,
    /// Share of the passed gates that were passed out of order or backwards.
    GateErrors,
}

/// A figure that was asked for, and what it came to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AskedFigure {
    /// As it is written after `test.`, such as `gap_m("prey")`.
    pub name: String,
    /// Its value; null where the robot does not know it.
    pub value: Option<f64>,
}

impl fmt::Display for Request {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (&self.of, self.probe) {
            (Some(of), Probe::GapError) => write!(f, "{}(\"{of}\", {})", self.figure, self.metres),
            (Some(of), _) => write!(f, "{}(\"{of}\")", self.figure),
            (None, _) => f.write_str(self.figure),
        }
    }
}
