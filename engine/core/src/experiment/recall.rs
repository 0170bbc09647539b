//! Why a learner that remembers its steps values an action as it does: each thing behind the value, and the very steps.

use serde::Serialize;

use super::relay::UsedDrivers;
use super::{Chooser, Learns, Ledger, Phase, Plan, Playback};
use crate::diagnostic::Result;
use crate::learner::{Carry, ChainLink, Learner, MemoryLearner, ShippedLearner};
use crate::settings::LearnerKind;
use crate::state::StateMap;

/// How the value of an action in a state comes about.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ValueReasons {
    /// The value: the last link's.
    pub value: f64,
    /// The spread of returns that first values and temperatures are shares of.
    pub unit: f64,
    /// What speaks, from what stands behind all else to the action's own tries.
    pub links: Vec<ValueLink>,
    /// The remembered steps of this action in this state, the latest first.
    pub tries: Vec<TryReasons>,
}

/// One thing that stands behind a value.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ValueLink {
    /// In words: `first value`, `columns 1 2`, `similar actions`, `own tries`.
    pub name: String,
    /// How many tries it has, the latest counting most.
    pub tries: f64,
    /// The mean of the returns that followed them; null if there are none.
    pub mean: Option<f64>,
    /// The value by it, with what stands behind it.
    pub value: f64,
}

/// A remembered step.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TryReasons {
    /// Its number among the steps of learning, from 0.
    pub step: u64,
    /// The return that followed it: its reward and what came later, discounted.
    pub gain: f64,
    /// How much it counts, by the latest step.
    pub weight: f64,
}

impl ValueReasons {
    /// Of an action in a state as it was before a step of learning; of a test, as it was at the end of learning. Nothing if
    /// the learner remembers no steps, or not all of them were recorded.
    ///
    /// # Errors
    /// If the learning steps cannot be played again.
    pub fn of(
        plan: &Plan,
        seed: u64,
        learning: &Ledger,
        step: Option<usize>,
        choice: [usize; 2],
    ) -> Result<Option<Self>> {
        let whole = learning.len() as u64 == learning.steps();
        let steps = step.unwrap_or(learning.len());
        if plan.settings.learner.kind != LearnerKind::Memory || (step.is_none() && !whole) {
            return Ok(None);
        }
        let learner = led(plan, seed, learning, steps)?;
        let map = plan.state_map()?;
        Ok(learner.memory().map(|memory| Self::from(memory, &*map, choice)))
    }

    fn from(memory: &MemoryLearner, map: &dyn StateMap, [state, action]: [usize; 2]) -> Self {
        let chain = memory.chain(state, action);
        let links = chain.links.into_iter().map(|(link, tries, mean, value)| {
            let name = match link {
                ChainLink::FirstValue => "first value".to_owned(),
                ChainLink::Digits(digits) => digits_in_words(map, &digits),
                ChainLink::SimilarActions => "similar actions".to_owned(),
                ChainLink::OwnTries => "own tries".to_owned(),
            };
            ValueLink { name, tries, mean, value }
        });
        let tries =
            chain.tries.into_iter().map(|past| TryReasons { step: past.step, gain: past.gain, weight: past.weight });
        Self { value: chain.value, unit: memory.unit(), links: links.collect(), tries: tries.collect() }
    }
}

/// The plan's learner, led along the first so many recorded steps of learning.
fn led(plan: &Plan, seed: u64, learning: &Ledger, steps: usize) -> Result<ShippedLearner> {
    let rescored = plan.swaps().filter(|(_, carry, ..)| *carry == Carry::Rescore).map(|(_, _, leg, _)| leg);
    let others: Vec<&Plan> = rescored.collect();
    let mut playback = Playback::watched(plan, seed, Phase::Learning, learning, &others)?;
    let (first, mut swaps) = (plan.first_leg(), plan.swaps().peekable());
    let map = first.state_map()?;
    let mut learner = first.first_learner(&*map, seed)?;
    let mut used = UsedDrivers::new(plan, seed);
    while playback.done() < steps {
        while let Some((_, carry, leg, _)) = swaps.next_if(|(from, ..)| *from <= playback.done() as u64) {
            learner.swap(&leg.settings.learner, leg.mirror(&*map)?, carry);
            if carry == Carry::Rescore {
                learner.rescore(&playback.dismiss_witness());
            }
        }
        let Some(step) = playback.advance()? else { break };
        if step.driver.is_none() {
            learner.visit(step.state);
        }
        used.with(Learns(&mut learner)).learn(&step);
        if step.moves() {
            learner.forget();
        }
    }
    Ok(learner)
}

/// `columns 1 2`, `camera columns 1 2, laser.front`: some digits of a state.
fn digits_in_words(map: &dyn StateMap, digits: &[usize]) -> String {
    let (all, table) = (map.digits(), map.to_table());
    let parts = table.get("part").and_then(toml::Value::as_array);
    let name = |part: usize| {
        let part = parts?.get(part)?;
        let text = |key: &str| part.get(key).and_then(toml::Value::as_str).map(str::to_owned);
        text("view").or_else(|| text("bins")).or_else(|| Some("stage".to_owned()))
    };
    let mut words: Vec<String> = Vec::new();
    let mut last = None;
    for digit in digits.iter().filter_map(|digit| all.get(*digit)) {
        let alone = all.iter().filter(|other| other.part == digit.part).count() == 1;
        if last != Some((digit.part, digit.column)) && !(alone && parts.is_some()) {
            let new_part = last.is_none_or(|(part, _)| part != digit.part);
            let of = name(digit.part).filter(|_| new_part).map_or(String::new(), |name| format!("{name} "));
            match words.last_mut().filter(|_| !new_part) {
                Some(columns) => columns.push_str(&format!(" {}", digit.column + 1)),
                None => words.push(format!("{of}columns {}", digit.column + 1)),
            }
        } else if alone {
            words.extend(name(digit.part));
        }
        last = Some((digit.part, digit.column));
    }
    words.join(", ")
}
