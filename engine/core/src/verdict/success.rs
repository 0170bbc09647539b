//! The conditions of success of one behaviour in one world, and from which step on learning meets them.

use std::ops::Range;
use std::sync::Arc;

use super::asked::Request;
use super::base_lines::BaseLines;
use super::default::{Endable, default_conditions};
use super::judged::{Because, ConditionVerdict, FigureVerdict, SuccessVerdict};
use super::measured::TestFigures;
use super::term::{FigureUse, SideBySide, Subject, Term};
use super::window::{WINDOW_STEPS, WindowCounts};
use crate::outcome::Endings;
use crate::settings::RunSettings;

/// So many good windows in a row are asked for.
const GOOD_WINDOWS: usize = 4;
/// A window is good with at most so many failures.
const FEW_FAILURES: u64 = 1;
/// Where failures and goals can happen: so many times as many goals as failures, over the good windows.
const GOALS_PER_FAILURE: u64 = 4;
/// A share of fewer attempts is chance.
const FEWEST_ATTEMPTS: u64 = 5;
/// Where only goals can happen: this share of the attempts, over the good windows.
const MOST_GOALS: f64 = 0.8;

/// One condition.
#[derive(Debug, Clone)]
pub struct SuccessCondition {
    /// Its name.
    pub name: String,
    /// What must hold, as it stands in the script.
    pub text: String,
    /// Its bytes in the script; nothing for a condition of the default.
    pub span: Option<Range<usize>>,
    pub(crate) term: Term,
}

impl SuccessCondition {
    pub(super) fn by_default(name: &str, text: &str, term: Term) -> Self {
        Self { name: name.to_owned(), text: text.to_owned(), span: None, term }
    }

    /// Whether it reads rewards, or what else is the script's own word.
    fn reads_rewards(&self) -> bool {
        self.term.figures().iter().any(|asked| asked.of_reward)
    }

    /// Whether it reads nothing but rewards.
    fn reads_only_rewards(&self) -> bool {
        self.term.figures().iter().all(|asked| asked.of_reward)
    }

    /// Whether every window of learning can be asked.
    fn is_of_windows(&self) -> bool {
        let figures = self.term.figures();
        figures.iter().all(|asked| asked.subject == Subject::Test && asked.figure.is_of_windows())
    }
}

/// What is called success.
#[derive(Debug, Clone)]
pub struct Success {
    conditions: Vec<SuccessCondition>,
    endable: Endable,
    /// Whether the robot's state tells anything of what it senses.
    looks: bool,
    /// Steps of the whole test.
    steps: u64,
    /// How long they take, seconds of the robot.
    seconds: f64,
}

impl Success {
    /// The script's own conditions, or the default in a world with a lap route or without one.
    pub(crate) fn new(own: &[SuccessCondition], endable: Endable, has_route: bool, run: &RunSettings) -> Self {
        let (steps, seconds) = (run.test_steps, run.test_steps as f64 * run.period_s);
        let conditions = if own.is_empty() { default_conditions(endable, has_route, seconds) } else { own.to_vec() };
        Self { conditions, endable, looks: true, steps, seconds }
    }

    /// For a robot whose state tells nothing of what it senses.
    pub(crate) fn of_a_blind_robot(self) -> Self {
        Self { looks: false, ..self }
    }

    /// All of them must hold; none if a script says nothing by which success could be told.
    #[must_use]
    pub fn conditions(&self) -> &[SuccessCondition] {
        &self.conditions
    }

    /// What a test must measure since a condition asks for it, each once.
    #[must_use]
    pub fn requests(&self) -> Vec<Arc<Request>> {
        let mut requests: Vec<Arc<Request>> = Vec::new();
        for asked in self.conditions.iter().flat_map(|condition| condition.term.figures()) {
            if let Some(request) = asked.of.request().filter(|request| !requests.contains(request)) {
                requests.push(Arc::clone(request));
            }
        }
        requests
    }

    /// Whether a test is a success, beside what robots do in the same test that know nothing or do not look.
    #[must_use]
    pub fn verdict(&self, test: &TestFigures, lines: &BaseLines) -> SuccessVerdict {
        let untrained = &lines.untrained;
        let (own, chance) = (self.of(test, untrained), self.of(untrained, untrained));
        let conditions: Vec<_> = self.conditions.iter().map(|condition| self.judged(condition, own, chance)).collect();
        let holds = conditions.iter().all(|condition| condition.holds);
        let blind = lines.blind.as_ref().map(|blind| &blind.test).filter(|blind| blind.steps == test.steps);
        let why = if conditions.is_empty() {
            Because::NothingToTellBy
        } else if test.steps < self.steps || untrained.steps < self.steps {
            Because::BrokenOff
        } else if self.conditions.iter().all(SuccessCondition::reads_only_rewards) {
            Because::RewardOnly
        } else if !holds && self.fails_unmeasured(own) {
            Because::NotMeasured
        } else if !holds {
            Because::Fails
        } else if self.counts_too_few(test) {
            Because::TooFew
        } else if conditions.iter().all(|condition| condition.untrained) {
            Because::UntrainedToo
        } else if self.tells_only_rewards(test, lines) {
            Because::RewardOnly
        } else if !self.looks || blind.is_some_and(|blind| self.is_met_by(blind, untrained)) {
            Because::BlindToo
        } else {
            Because::Holds
        };
        let success = match why {
            Because::Holds => Some(true),
            Because::Fails => Some(false),
            Because::UntrainedToo
            | Because::BlindToo
            | Because::RewardOnly
            | Because::BrokenOff
            | Because::TooFew
            | Because::NotMeasured
            | Because::NothingToTellBy => None,
        };
        SuccessVerdict { success, why, conditions }
    }

    /// Whether every condition that does not hold reads a figure that the test does not have, such as shares of spells of 20 s
    /// where no attempt lasts so long.
    fn fails_unmeasured(&self, own: SideBySide<'_>) -> bool {
        let failing = self.conditions.iter().filter(|condition| !condition.term.holds_in(own));
        failing.into_iter().all(|condition| condition.term.figures().iter().any(|asked| asked.is_unmeasured(own)))
    }

    /// Whether a share of attempts is asked for, and there are too few of them to have one.
    fn counts_too_few(&self, test: &TestFigures) -> bool {
        let of_attempts = |asked: &FigureUse| asked.subject == Subject::Test && asked.figure.name == "goal_rate";
        let asks = self.conditions.iter().any(|condition| condition.term.figures().iter().any(of_attempts));
        asks && test.attempts() + test.hops < FEWEST_ATTEMPTS
    }

    /// Whether some policy's test meets all conditions.
    #[must_use]
    pub fn is_met_by(&self, test: &TestFigures, untrained: &TestFigures) -> bool {
        !self.conditions.is_empty()
            && self.conditions.iter().all(|condition| condition.term.holds_in(self.of(test, untrained)))
    }

    /// Whether all conditions hold as well if nothing but the figures of the reward is the test's, and every other one that of a
    /// robot that knows nothing: then these tell nothing. No two such robots do the same, so that it is asked of more than one:
    /// `test.distance_m != untrained.distance_m` holds of whatever moves.
    fn tells_only_rewards(&self, test: &TestFigures, lines: &BaseLines) -> bool {
        let own = self.of(test, &lines.untrained);
        let whole = lines.untrained_others.iter().filter(|other| other.steps == test.steps);
        std::iter::once(&lines.untrained).chain(whole).any(|chance| {
            let chance = self.of(chance, &lines.untrained);
            self.conditions.iter().all(|condition| condition.term.holds_by_rewards(own, chance))
        })
    }

    /// Whether rewards are asked for: other robots that know nothing then tell whether the rest says anything.
    #[must_use]
    pub fn reads_rewards(&self) -> bool {
        self.conditions.iter().any(SuccessCondition::reads_rewards)
    }

    fn of<'a>(&self, test: &'a TestFigures, untrained: &'a TestFigures) -> SideBySide<'a> {
        SideBySide { test, untrained, seconds: self.seconds }
    }

    fn judged(&self, condition: &SuccessCondition, own: SideBySide<'_>, chance: SideBySide<'_>) -> ConditionVerdict {
        let mut figures: Vec<FigureVerdict> = Vec::new();
        for asked in condition.term.figures() {
            let name = asked.of.written(asked.figure, own.test);
            if figures.iter().all(|known| known.name != name) {
                let asked = FigureUse { subject: Subject::Test, ..asked };
                figures.push(FigureVerdict { name, value: asked.read(own), untrained: asked.read(chance) });
            }
        }
        ConditionVerdict {
            name: condition.name.clone(),
            condition: condition.text.clone(),
            holds: condition.term.holds_in(own),
            untrained: condition.term.holds_in(chance),
            figures,
        }
    }

    /// The first step of learning from which four windows in a row are good, only whole windows counted: those in which the
    /// script's own conditions hold, as far as windows have their figures; else those with at most one failure, and goals
    /// where goals can be reached. Nothing if it is never, or cannot be told.
    #[must_use]
    pub fn learned_at(&self, windows: &[WindowCounts<'_>]) -> Option<u64> {
        let own: Vec<&SuccessCondition> =
            self.conditions.iter().filter(|own| own.span.is_some() && own.is_of_windows()).collect();
        let good = |four: &[WindowCounts<'_>]| {
            let ended: Endings = four.iter().map(|counts| counts.window.endings).sum();
            let few = four.iter().all(|counts| counts.window.endings.failures <= FEW_FAILURES);
            match self.endable {
                _ if four.iter().any(|counts| counts.window.steps < WINDOW_STEPS) => false,
                _ if !own.is_empty() => {
                    four.iter().all(|counts| own.iter().all(|condition| condition.term.holds_in_window(counts)))
                }
                Endable { failure: true, goal: false, .. } => few,
                Endable { failure: true, goal: true, .. } => {
                    few && ended.goals > 0 && ended.goals >= GOALS_PER_FAILURE * ended.failures
                }
                Endable { failure: false, goal: true, .. } => ended.goals > 0 && ended.goal_rate() >= MOST_GOALS,
                Endable { failure: false, goal: false, .. } => false,
            }
        };
        windows.windows(GOOD_WINDOWS).position(good).map(|index| index as u64 * WINDOW_STEPS)
    }

    /// Whether a curve of learning can say when it was learned.
    #[must_use]
    pub fn tells_learning(&self) -> bool {
        self.endable.failure
            || self.endable.goal
            || self.conditions.iter().any(|own| own.span.is_some() && own.is_of_windows())
    }
}
