//! The pictures of an explained step in the folder of its run, by name.

use engine::experiment::Phase;

/// A step that has pictures in the folder of its run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct ExplainedStep {
    /// Whether it is a step of learning or of the test.
    pub phase: Phase,
    /// Its number, from 0.
    pub step: usize,
}

/// When the picture was taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// As the robot chose.
    Before,
    /// At the end of the step.
    After,
}

impl ExplainedStep {
    /// The name of the picture's files, without their ending.
    #[must_use]
    pub fn stem(self, side: Side) -> String {
        let phase = match self.phase {
            Phase::Learning => "",
            Phase::Test => "test-",
        };
        let side = match side {
            Side::Before => "before",
            Side::After => "after",
        };
        format!("{phase}step-{}-{side}", self.step)
    }

    /// The step that a file of this name shows, if it is such a picture.
    #[must_use]
    pub fn of_file(name: &str) -> Option<Self> {
        let stem = name.strip_suffix(".svg").or_else(|| name.strip_suffix(".png"))?;
        let (phase, rest) = match stem.strip_prefix("test-") {
            Some(rest) => (Phase::Test, rest),
            None => (Phase::Learning, stem),
        };
        let (step, _) = rest.strip_prefix("step-")?.rsplit_once('-')?;
        let shown = Self { phase, step: step.parse().ok()? };
        [Side::Before, Side::After].iter().any(|&side| shown.stem(side) == stem).then_some(shown)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_pictures_say_the_step_and_nothing_else_is_taken_for_one() {
        for shown in [ExplainedStep { phase: Phase::Learning, step: 12 }, ExplainedStep { phase: Phase::Test, step: 0 }]
        {
            assert_eq!(ExplainedStep::of_file(&format!("{}.svg", shown.stem(Side::After))), Some(shown));
            assert_eq!(ExplainedStep::of_file(&format!("{}.png", shown.stem(Side::Before))), Some(shown));
        }
        for name in ["step-012-after.svg", "step--before.png", "step-3-during.svg", "paths.png", "step-3-after.txt"] {
            assert_eq!(ExplainedStep::of_file(name), None, "{name}");
        }
    }
}
