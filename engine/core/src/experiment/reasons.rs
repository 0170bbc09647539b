//! Why one recorded step was rewarded as it was: rule by rule, with the facts and the beam that made it so.

use serde::Serialize;

use super::{Cycle, Plan, Playback, ValueReasons};
use crate::diagnostic::Result;
use crate::judge::{FactRead, Judge, Leave, PartRead, RuleText};
use crate::outcome::{Ending, Then};
use crate::robot::Robot;

/// One step with its reasons.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StepReasons {
    /// The step's number, from 0.
    pub step: usize,
    /// When it ended, seconds since the phase began; time in recovery is not counted.
    pub time_s: f64,
    /// The state in which the action was chosen, and its cells, row by row from the top left.
    pub state: StateCells,
    /// The state at the end of the step, before any recovery, and its cells.
    pub next_state: StateCells,
    /// The action's number.
    pub action: usize,
    /// Its forward speed, m/s, and turning speed, rad/s, anticlockwise positive.
    pub motion: [f64; 2],
    /// Whether the action was not the best known one of its state.
    pub explored: bool,
    /// The sum of what the rules added.
    pub reward: f64,
    /// Whether the step ended the attempt.
    pub recover: bool,
    /// What the script said then: `recover`, `fail`, `goal` or `restart`; absent if the attempt went on.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub then: Option<&'static str>,
    /// How: `failure`, `goal` or `restart`; null if it did not.
    pub ending: Option<&'static str>,
    /// Where the script said that the next attempt begins, by name; null if it did not say.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub to: Option<String>,
    /// Whether the body touched something.
    pub contact: bool,
    /// Whether the robot lost its footing.
    pub fallen: bool,
    /// The true pose at the end: metres, metres, radians.
    pub pose: [f64; 3],
    /// The true pose of the prey, if there is one.
    pub prey: Option<[f32; 3]>,
    /// Of a run in several worlds: the name of the one in which it was done.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub world_name: Option<String>,
    /// What was drawn for its attempt: each key with its value.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub drawn: Vec<(String, String)>,
    /// Whether the attempt was broken off after it, which is no outcome.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub hop: bool,
    /// Every rule, and `fn reward` last.
    pub rules: Vec<RuleReasons>,
    /// The guards that took actions away when this one was chosen.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub guards: Vec<GuardReasons>,
    /// The use under which a learned policy chose the action; absent where the script's own choice was it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub used: Option<UseReasons>,
    /// Why the action had its value when it was chosen, if a learner that remembers its steps was led along.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub value: Option<ValueReasons>,
}

/// Why a learned policy drove.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UseReasons {
    /// What the script calls the policy.
    pub name: String,
    /// The line of the use in the script, from 1.
    pub line: usize,
    /// The state that the policy perceived, and that in words.
    pub state: usize,
    /// That state in words.
    pub text: String,
    /// The parts of the use's condition, as they were then; none if it always holds, or in these stages.
    pub parts: Vec<PartReasons>,
}

/// What one guard kept from.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GuardReasons {
    /// Its name.
    pub name: String,
    /// Its line in the script, from 1.
    pub line: usize,
    /// The actions that it took away.
    pub actions: Vec<usize>,
    /// The parts of its condition, as they were then.
    pub parts: Vec<PartReasons>,
}

/// A state with the cells that it stands for.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct StateCells {
    /// Its number.
    pub index: usize,
    /// What it stands for, in words.
    pub text: String,
    /// Which cells are filled, row by row from the top left.
    pub cells: Vec<bool>,
}

/// What one rule said of a step, and why.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RuleReasons {
    /// Its name; `reward` for the function.
    pub name: String,
    /// Its line in the script, from 1.
    pub line: usize,
    /// What it added; null if it did not fire.
    pub added: Option<f64>,
    /// Whether it was asked at all: a rule before it may have ended the step with recovery.
    pub asked: bool,
    /// For how many steps its condition has held; 0 when it has just fired.
    pub held: u32,
    /// For how many steps it must hold to fire.
    pub needed: u32,
    /// Whether it fires once, has fired, and its condition has held ever since.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub spent: bool,
    /// The parts of its condition.
    pub parts: Vec<PartReasons>,
}

/// One part of a condition.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PartReasons {
    /// Its text in the script.
    pub text: String,
    /// Its first and last byte in the script, the last one not included.
    pub span: [usize; 2],
    /// Whether it held; null where only the whole condition was judged.
    pub holds: Option<bool>,
    /// The facts that it read.
    pub facts: Vec<FactReasons>,
}

/// One fact as it was.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FactReasons {
    /// As it stands in the script.
    pub name: String,
    /// Its value; flags are 0 or 1.
    pub value: f64,
    /// The unit, in words; empty for flags.
    pub unit: &'static str,
    /// The beam of the laser that made it so.
    pub beam: Option<usize>,
    /// Where that beam looks, degrees from straight ahead, positive to the left.
    pub angle_deg: Option<f64>,
}

impl StepReasons {
    /// Plays one more step and tells why it was rewarded; nothing after the last step.
    ///
    /// # Errors
    /// As [`Playback::advance`].
    pub fn of_next(playback: &mut Playback<'_>) -> Result<Option<Self>> {
        let (index, ledger) = (playback.done(), playback.ledger());
        // What a guard read is known before the step alone.
        playback.seek(index)?;
        let guards = GuardReasons::all(playback.plan(), playback.cycle().judge(), playback.cycle().leave());
        let used = UseReasons::of(playback.plan(), playback.cycle());
        // A policy that is used chooses by values of its own.
        let own = ledger.record(index).filter(|_| used.is_none());
        let value = own.and_then(|record| playback.value_of([record.state as usize, usize::from(record.action)]));
        let (Some(step), Some(record)) = (playback.advance()?, ledger.record(index)) else { return Ok(None) };
        let plan = playback.plan();
        let (cycle, twist) = (playback.cycle(), plan.motions()[step.action]);
        let cells = |state: usize| {
            let described = cycle.state_map().describe(state);
            let cells = described.cells.map_or_else(Vec::new, |cells| cells.filled);
            StateCells { index: state, text: described.text, cells }
        };
        let stopped_by = cycle.fired().iter().rposition(Option::is_some).filter(|_| step.then.is_some());
        let rules = plan.behaviour.rules().iter().enumerate();
        let rules = rules.map(|(rule, text)| RuleReasons {
            added: cycle.fired()[rule],
            asked: stopped_by.is_none_or(|last| rule <= last),
            ..RuleReasons::of(plan, text, cycle.judge(), rule)
        });
        let pose = record.pose;
        let (attempt, layouts) = (ledger.attempt(index), plan.worlds.layouts());
        let layout = &layouts[attempt.as_ref().map_or(0, |attempt| attempt.world).min(layouts.len() - 1)];
        let keys = || plan.settings.randomise.iter();
        let drawn = attempt.iter().flat_map(|attempt| keys().zip(&attempt.drawn));
        Ok(Some(Self {
            step: index,
            time_s: (index + 1) as f64 * plan.settings.run.period_s,
            state: cells(step.state),
            next_state: cells(step.next_state),
            action: step.action,
            motion: [twist.linear_m_per_s, twist.angular_rad_per_s],
            explored: record.explored,
            reward: step.reward,
            recover: step.then.is_some(),
            then: step.then.map(Then::word),
            ending: step.ending().map(Ending::word),
            to: step.to.map(|to| layout.name_of(to).to_owned()),
            contact: step.contact,
            fallen: record.fallen,
            pose: [pose.x_m, pose.y_m, pose.yaw_rad],
            prey: record.prey,
            world_name: (layouts.len() > 1).then(|| layout.name.clone()),
            drawn: drawn.map(|(varied, drawn)| (varied.key.clone(), varied.shown(*drawn))).collect(),
            hop: step.hop,
            rules: rules.collect(),
            guards,
            used: used.filter(|_| step.driver.is_some()),
            value,
        }))
    }
}

impl RuleReasons {
    fn of(plan: &Plan, text: &RuleText, judge: &Judge, rule: usize) -> Self {
        let (held, needed) = judge.held(rule);
        Self {
            name: text.name.clone(),
            line: text.line,
            added: None,
            asked: true,
            held,
            needed,
            spent: judge.is_spent(rule),
            parts: judge.evidence(rule).into_iter().map(|part| PartReasons::of(plan, part)).collect(),
        }
    }
}

impl PartReasons {
    fn of(plan: &Plan, PartRead { span, holds, facts }: PartRead) -> Self {
        let fan = plan.settings.laser.fan();
        let fact = |fact: FactRead| FactReasons {
            angle_deg: fact.beam.map(|beam| fan.bearing_deg(beam)),
            name: fact.name,
            value: fact.value,
            unit: fact.unit,
            beam: fact.beam,
        };
        Self {
            text: plan.behaviour.source().text.get(span.clone()).unwrap_or_default().to_owned(),
            span: [span.start, span.end],
            holds,
            facts: facts.into_iter().map(fact).collect(),
        }
    }
}

impl UseReasons {
    /// Of the use that holds now.
    fn of<R: Robot>(plan: &Plan, cycle: &Cycle<R>) -> Option<Self> {
        let (judge, (state, text)) = (cycle.judge(), cycle.handed_state()?);
        let driver = judge.driver()?;
        let (said, _) = plan.behaviour.uses().nth(driver)?;
        let parts = judge.use_evidence(driver).into_iter().map(|part| PartReasons::of(plan, part));
        Some(Self { name: said.name.clone(), line: said.line, state, text, parts: parts.collect() })
    }
}

impl GuardReasons {
    /// Of the guards that hold now.
    fn all(plan: &Plan, judge: &Judge, leave: Leave) -> Vec<Self> {
        let guards = plan.behaviour.guards().enumerate().filter(|(index, _)| leave.holds(*index));
        let of = |(index, text): (usize, &RuleText)| {
            let forbidden = judge.guarding().forbidden(index);
            Self {
                name: text.name.clone(),
                line: text.line,
                actions: (0..plan.motions().len()).filter(|action| forbidden.contains(*action)).collect(),
                parts: judge.guard_evidence(index).into_iter().map(|part| PartReasons::of(plan, part)).collect(),
            }
        };
        guards.map(of).collect()
    }
}
