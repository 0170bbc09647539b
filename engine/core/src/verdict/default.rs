//! What is called success where a script does not say it.

use super::figures::TestFigure;
use super::own_word::OwnWord;
use super::success::SuccessCondition;
use super::term::{FigureOf, FigureUse, Subject, Term};
use crate::judge::expression::{Arithmetic, Comparison};

/// In which ways an attempt may end, by the text of a script.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Endable {
    pub failure: bool,
    pub goal: bool,
    /// Whether a rule pays for a contact.
    pub contact_pays: bool,
    /// Whether there are stages.
    pub stages: bool,
    /// Which figures are the script's own word.
    pub own: OwnWord,
}

/// At most so many failures in 1,000 steps.
const FEW_FAILURES: f64 = 10.0;
/// At most so many steps with a contact: where goals can be reached, a crash may be called one.
const FEW_CONTACTS: f64 = 20.0;
/// At most this share of the goals in whose last step it touches something or falls.
const FEW_CRASHES: f64 = 0.2;
/// At most so many restarts: who is put back every few seconds is carried, and gets along by that.
const FEW_RESTARTS: f64 = 10.0;
/// At least this share of the attempts.
const MOST_GOALS: f64 = 0.8;
/// So many times as far between two interventions as a robot that knows nothing.
const BEATS_CHANCE: f64 = 5.0;
/// Net along the route, m/s: half of the paper's cruising speed.
const ALONG_M_PER_S: f64 = 0.1;
/// At most this share of steps off the route: a circle that touches it on two sides is no way along it.
const MOST_OFF: f64 = 0.25;
/// At most this share of spells without getting anywhere.
const MOST_IDLE: f64 = 0.5;

/// The conditions for a script whose attempts may end so, in a world with a lap route or without one; `seconds` is how long
/// the test takes. None if nothing can be told.
pub(crate) fn default_conditions(endable: Endable, has_route: bool, seconds: f64) -> Vec<SuccessCondition> {
    use Comparison::{Greater, GreaterOrEqual, Less, LessOrEqual};
    use Subject::{Test, Untrained};
    let figure = |subject, name| {
        let figure = TestFigure::of(name);
        let of = FigureOf::Whole;
        figure.map_or(Term::Constant(f64::NAN), |figure| {
            Term::TestFigure(FigureUse { subject, figure, of, of_reward: endable.own.has(figure) })
        })
    };
    let compare = |comparison, a, b| Term::Compare(comparison, Box::new([a, b]));
    let than = |comparison, subject, name, limit| compare(comparison, figure(subject, name), Term::Constant(limit));
    let mut conditions = Vec::new();
    let mut ask = |name: &str, text: &str, term| conditions.push(SuccessCondition::by_default(name, text, term));
    if endable.failure {
        let few = than(LessOrEqual, Test, "failures_per_1000", FEW_FAILURES);
        ask("fails little", "test.failures_per_1000 <= 10", few);
    }
    if endable.goal {
        let goals = than(GreaterOrEqual, Test, "goal_rate", MOST_GOALS);
        let chance = than(Less, Untrained, "goal_rate", MOST_GOALS);
        ask("reaches its goals", "test.goal_rate >= 0.8 && untrained.goal_rate < 0.8", Term::And(vec![goals, chance]));
        let text = format!("test.contacts_per_1000 <= {FEW_CONTACTS} && test.goal_crashes <= {FEW_CRASHES}");
        let few = than(LessOrEqual, Test, "contacts_per_1000", FEW_CONTACTS);
        ask("touches little", &text, Term::And(vec![few, than(LessOrEqual, Test, "goal_crashes", FEW_CRASHES)]));
    } else if endable.failure {
        let chance = figure(Untrained, "metres_per_intervention");
        let chance = Term::Binary(Arithmetic::Multiply, Box::new([Term::Constant(BEATS_CHANCE), chance]));
        let beats = compare(GreaterOrEqual, figure(Test, "metres_per_intervention"), chance);
        ask("beats chance", "test.metres_per_intervention >= 5 * untrained.metres_per_intervention", beats);
        let by_itself = than(LessOrEqual, Test, "restarts_per_1000", FEW_RESTARTS);
        if endable.stages {
            // What is wanted is the way from stage to stage.
        } else if has_route {
            let along = Term::OfOne(f64::abs, Box::new(figure(Test, "net_route_m")));
            let along_m = ALONG_M_PER_S * seconds;
            let along = compare(GreaterOrEqual, along, Term::Constant(along_m));
            let on = than(LessOrEqual, Test, "off_route", MOST_OFF);
            let text = format!(
                "abs(test.net_route_m) >= {along_m:.0} && test.off_route <= {MOST_OFF} && test.restarts_per_1000 <= {FEW_RESTARTS}"
            );
            ask("gets along", &text, Term::And(vec![along, on, by_itself]));
        } else {
            let moves = than(LessOrEqual, Test, "idle", MOST_IDLE);
            let text = format!("test.idle <= {MOST_IDLE} && test.restarts_per_1000 <= {FEW_RESTARTS}");
            ask("gets along", &text, Term::And(vec![moves, by_itself]));
        }
    }
    if endable.contact_pays && endable.failure && !endable.goal {
        let text = format!("test.contacts_per_1000 <= {FEW_CONTACTS}");
        ask("touches little", &text, than(LessOrEqual, Test, "contacts_per_1000", FEW_CONTACTS));
    }
    if endable.stages && !endable.goal {
        let (own, chance) = (figure(Test, "stages_per_1000"), figure(Untrained, "stages_per_1000"));
        let twice = Term::Binary(Arithmetic::Multiply, Box::new([Term::Constant(2.0), chance]));
        let more = compare(Greater, own.clone(), twice);
        let some = compare(Greater, own, Term::Constant(0.0));
        let text = "test.stages_per_1000 > 2 * untrained.stages_per_1000 && test.stages_per_1000 > 0";
        ask("goes round", text, Term::And(vec![more, some]));
    }
    conditions
}
