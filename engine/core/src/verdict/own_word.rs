//! Which figures are the script's own word: the reward, and what is counted by rules that read nothing but what the robot itself does.

use super::figures::TestFigure;

/// Of a script, what only such rules bring about; false too where no rule does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct OwnWord {
    /// Every end of an attempt. One that ends by time alone tells something as soon as the world may end it before.
    pub endings: bool,
    /// Every change of the stage.
    pub stages: bool,
}

impl OwnWord {
    /// Whether a figure of the whole test is the script's own word.
    pub(crate) fn has(self, figure: &TestFigure) -> bool {
        match figure.name {
            "reward_per_1000" => true,
            "failures_per_1000" | "goals_per_1000" | "restarts_per_1000" | "goal_rate" | "goal_s" | "attempts" => {
                self.endings
            }
            "stages_per_1000" | "rounds_per_1000" | "stage_rate" => self.stages,
            _ => false,
        }
    }
}
