//! Why a learner that remembers its steps values an action as it does: each thing behind the value, and the very steps.

use serde::Serialize;

use super::relay::UsedDrivers;
use super::{Chooser, Learns, Plan, Step};
use crate::diagnostic::Result;
use crate::learner::{Carry, ChainLink, Learner, Rejudged, ShippedLearner};
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
    /// How many remembered steps of this action in this state there are.
    pub own_tries: usize,
    /// These steps, the latest first; of very many, the latest.
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
    /// It was a step of the run that this one goes on from; of several, counted from the first one's first.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub earlier: bool,
    /// The return that followed it: its reward and what came later, discounted.
    pub gain: f64,
    /// How much it counts, by the latest step.
    pub weight: f64,
}

/// A learner that is led along recorded steps, to be asked why it values an action as it does.
pub struct Recall {
    learner: ShippedLearner,
    used: UsedDrivers,
    map: Box<dyn StateMap>,
    /// Steps that were learned in the runs that this one goes on from.
    before: u64,
}

impl Recall {
    /// The plan's learner before its first step; nothing if it remembers no steps.
    ///
    /// # Errors
    /// If the plan does not work, or the run that it goes on from does not come out as it was recorded.
    pub(super) fn new(plan: &Plan, seed: u64) -> Result<Option<Self>> {
        let first = plan.first_leg();
        if plan.settings.learner.kind != LearnerKind::Memory {
            return Ok(None);
        }
        let map = first.state_map()?;
        let learner = first.first_learner(&*map, seed)?;
        Ok(Some(Self { learner, used: UsedDrivers::new(plan, seed), map, before: plan.steps_before(seed) }))
    }

    /// Learns from a recorded step.
    pub(super) fn follow(&mut self, step: &Step) {
        if step.driver.is_none() {
            self.learner.visit(step.state);
        }
        self.used.with(Learns(&mut self.learner)).learn(step);
        if step.moves() {
            self.learner.forget();
        }
    }

    /// Goes on under the rules of another leg.
    pub(super) fn swap(&mut self, leg: &Plan, carry: Carry, said: &[Rejudged]) -> Result<()> {
        self.used.settle(&mut Learns(&mut self.learner));
        self.learner.swap(&leg.settings.learner, leg.mirror(&*self.map)?, carry);
        if carry == Carry::Rescore {
            self.learner.rescore(said);
        }
        Ok(())
    }

    /// Learning has ended.
    pub(super) fn finish(&mut self) {
        self.used.settle(&mut Learns(&mut self.learner));
        self.learner.forget();
    }

    /// How the value of an action in a state comes about now.
    #[must_use]
    pub fn of(&self, [state, action]: [usize; 2]) -> Option<ValueReasons> {
        let memory = self.learner.memory()?;
        let chain = memory.chain(state, action);
        let links = chain.links.into_iter().map(|(link, tries, mean, value)| {
            let name = match link {
                ChainLink::FirstValue => "first value".to_owned(),
                ChainLink::Digits(digits) => digits_in_words(&*self.map, &digits),
                ChainLink::SimilarActions => "similar actions".to_owned(),
                ChainLink::OwnTries => "own tries".to_owned(),
            };
            ValueLink { name, tries, mean, value }
        });
        let tries = chain.tries.iter().map(|past| TryReasons {
            step: past.step.checked_sub(self.before).unwrap_or(past.step),
            earlier: past.step < self.before,
            gain: past.gain,
            weight: past.weight,
        });
        let (links, tries): (_, Vec<TryReasons>) = (links.collect(), tries.collect());
        Some(ValueReasons { value: chain.value, unit: memory.unit(), links, own_tries: tries.len(), tries })
    }
}

impl ValueReasons {
    /// These reasons for a reader: of the steps behind the value only the latest few, all numbers with five digits.
    #[must_use]
    pub fn brief(mut self, tries: usize) -> Self {
        self.tries.truncate(tries);
        let links = self.links.iter_mut();
        let of_links =
            links.flat_map(|link| [Some(&mut link.tries), link.mean.as_mut(), Some(&mut link.value)]).flatten();
        let of_tries = self.tries.iter_mut().flat_map(|one| [&mut one.gain, &mut one.weight]);
        for number in of_links.chain(of_tries).chain([&mut self.value, &mut self.unit]) {
            *number = five_digits(*number);
        }
        self
    }
}

fn five_digits(number: f64) -> f64 {
    format!("{number:.4e}").parse().unwrap_or(number)
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
