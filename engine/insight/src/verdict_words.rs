//! Verdicts in words: whether a run is a success and why, when it was learned.

use engine::experiment::{ConditionSpread, Plan, Summary};
use engine::verdict::{Because, ConditionVerdict, FigureVerdict, SuccessVerdict};

use crate::words::brief;

/// What to write where nothing can be told.
const WRITE: &str = "success \"name\" when test.failures_per_1000 <= 2;";

/// Whether it is a success, and why, on one line.
#[must_use]
pub fn headline(verdict: &SuccessVerdict) -> String {
    let names = |holds: bool| {
        let wanted = verdict.conditions.iter().filter(|condition| condition.holds == holds);
        wanted.map(|condition| format!("\"{}\"", condition.name)).collect::<Vec<_>>().join(", ")
    };
    match verdict.why {
        Because::Holds => "yes".to_owned(),
        Because::Fails => {
            let several = verdict.conditions.iter().filter(|condition| !condition.holds).count() > 1;
            format!("no: {} {} not hold", names(false), if several { "do" } else { "does" })
        }
        Because::UntrainedToo => {
            "cannot be told: a robot that knows nothing meets every condition too; ask for what it must do".to_owned()
        }
        Because::BlindToo => {
            "cannot be told: a robot that does not look meets every condition too; ask for what it must see".to_owned()
        }
        Because::TooFew => {
            "cannot be told: fewer than five attempts ended in the test; test it longer: engine test RUN --steps N".to_owned()
        }
        Because::NotMeasured => {
            "cannot be told: no attempt lasts 20 s, over which standing, spinning and going to and fro are told; let attempts \
             last longer, or name a success of your own"
                .to_owned()
        }
        Because::BrokenOff => "cannot be told: the test was broken off; test it again: engine test RUN".to_owned(),
        Because::RewardOnly => {
            format!("cannot be told from rewards alone, which are the script's own word; write: {WRITE}")
        }
        Because::NothingToTellBy => {
            format!("cannot be told from this script: it names no failure, no goal and no success; write: {WRITE}")
        }
    }
}

/// The figures of a condition, each beside that of a robot that knows nothing.
#[must_use]
pub fn figures(condition: &ConditionVerdict) -> String {
    let figure = |FigureVerdict { name, value, untrained }: &FigureVerdict| {
        let number = |value: &Option<f64>| value.map_or("unknown".to_owned(), brief);
        format!("{name} {}, untrained {}", number(value), number(untrained))
    };
    condition.figures.iter().map(figure).collect::<Vec<_>>().join("; ")
}

/// The figures of a condition over many seeds.
#[must_use]
pub fn spread_of_figures(condition: &ConditionSpread) -> String {
    let number = |value: Option<f64>| value.map_or("unknown".to_owned(), brief);
    let figure = |figure: &engine::experiment::FigureSpread| {
        let engine::experiment::FigureSpread { name, median, least, greatest, untrained } = figure;
        let [median, least, greatest, untrained] = [median, least, greatest, untrained].map(|value| number(*value));
        format!("{name} {median} ({least} to {greatest}), untrained {untrained}")
    };
    condition.figures.iter().map(figure).collect::<Vec<_>>().join("; ")
}

/// When a seed learned, on one line.
#[must_use]
pub fn learned(plan_tells: bool, summary: &Summary) -> String {
    match summary.learned_at {
        Some(0) if summary.verdict.why == Because::UntrainedToo => {
            "from the start: nothing had to be learned".to_owned()
        }
        Some(0) => "within the first window of 400 steps".to_owned(),
        Some(step) => format!("at step {step} of {}", summary.steps),
        None if !plan_tells => "cannot be told: no failure and no goal can happen".to_owned(),
        None => format!("not within {} steps", summary.steps),
    }
}

/// Whether the script says anything by which it can be told when it was learned.
#[must_use]
pub fn tells_learning(plan: &Plan) -> bool {
    plan.success().tells_learning()
}
