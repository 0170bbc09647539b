//! The ledger: one small record for each step, kept in memory while a robot learns or is tested.
//!
//! A record says what was decided and why it was rewarded, not what was seen: frame, scan and mask come back exactly by
//! driving the recorded actions again ([`super::Playback`]). Reading one: [`Ledger::record`] and [`Ledger::fired`].

mod record;

use std::ops::ControlFlow;

use super::{Cycle, Observer, Plan, Step};
use crate::robot::Robot;

pub use record::{Attempt, Record, RecordShape};
use record::{FIXED_BYTES, first_field};

/// The most steps that a ledger keeps: of a longer run it holds the beginning.
pub const MOST_STEPS: u64 = 1 << 20;

/// The records of one phase: learning, or a test. A run whose rules were swapped while it learned has a leg for each script.
#[derive(Debug, Clone, PartialEq)]
pub struct Ledger {
    /// What was learned under earlier scripts.
    earlier: Vec<LedgerLeg>,
    /// Records of the earlier legs.
    first: usize,
    shape: RecordShape,
    bytes: Vec<u8>,
    most: usize,
    steps: u64,
    /// What the filters kept before the first step; empty if they began anew, or keep nothing.
    kept: Vec<u8>,
}

/// The records of one leg.
#[derive(Debug, Clone, PartialEq)]
pub struct LedgerLeg {
    /// How they lie.
    pub shape: RecordShape,
    /// All of them, as they are stored.
    pub bytes: Vec<u8>,
    /// Steps of the leg; more than it has records if there was no room.
    pub steps: u64,
}

impl LedgerLeg {
    /// How many records it holds.
    #[must_use]
    pub fn len(&self) -> usize {
        self.bytes.len() / self.shape.bytes()
    }

    /// Whether it holds none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }

    /// Whether the records can be what so many steps left.
    fn fits(&self) -> bool {
        self.bytes.len().is_multiple_of(self.shape.bytes()) && self.len() as u64 <= self.steps
    }
}

impl Ledger {
    /// An empty ledger with room for `steps` steps; nothing is allocated later.
    #[must_use]
    pub fn new(plan: &Plan, steps: u64) -> Self {
        let shape = RecordShape::of(plan);
        let most = steps.min(MOST_STEPS) as usize * shape.bytes();
        Self { earlier: Vec::new(), first: 0, shape, bytes: Vec::with_capacity(most), most, steps: 0, kept: Vec::new() }
    }

    /// A ledger that keeps nothing.
    #[must_use]
    pub fn off() -> Self {
        Self::from_leg(LedgerLeg { shape: RecordShape::new(Vec::new()), bytes: Vec::new(), steps: 0 })
    }

    /// A ledger from records that were stored, leg by leg; nothing if they are not whole, or more than the steps.
    #[must_use]
    pub fn from_legs(mut legs: Vec<LedgerLeg>) -> Option<Self> {
        // Where records are missing, nothing that came later can be played.
        let mut after_whole = legs.iter().skip_while(|leg| leg.len() as u64 == leg.steps).skip(1);
        let fit = legs.iter().all(LedgerLeg::fits) && after_whole.all(LedgerLeg::is_empty);
        let last = legs.pop().filter(|_| fit)?;
        let first = legs.iter().map(LedgerLeg::len).sum();
        Some(Self { earlier: legs, first, ..Self::from_leg(last) })
    }

    fn from_leg(LedgerLeg { shape, bytes, steps }: LedgerLeg) -> Self {
        Self { earlier: Vec::new(), first: 0, most: bytes.len(), shape, bytes, steps, kept: Vec::new() }
    }

    /// Says what the filters kept before the first step, such as what a policy kept before its test.
    pub fn set_out_from(&mut self, kept: &[u8]) {
        self.kept = kept.to_vec();
    }

    /// What the filters kept before the first step; empty if they began anew, or keep nothing.
    #[must_use]
    pub fn kept(&self) -> &[u8] {
        &self.kept
    }

    /// From here on under another script, with room for `steps` more steps; none if the leg before was too long to be kept.
    pub(super) fn begin_leg(&mut self, plan: &Plan, steps: u64) {
        let shape = RecordShape::of(plan);
        let records = self.bytes.len() / self.shape.bytes();
        let is_whole = records as u64 == self.steps;
        self.first += records;
        let room = if is_whole { MOST_STEPS.saturating_sub(self.first as u64) } else { 0 };
        self.most = steps.min(room) as usize * shape.bytes();
        let shape = std::mem::replace(&mut self.shape, shape);
        let bytes = std::mem::replace(&mut self.bytes, Vec::with_capacity(self.most));
        self.earlier.push(LedgerLeg { shape, bytes, steps: std::mem::take(&mut self.steps) });
    }

    /// How many steps were done; more than [`Ledger::len`] if the run was longer than a ledger.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.earlier.iter().map(|leg| leg.steps).sum::<u64>() + self.steps
    }

    /// Steps that were done in the last leg, and how many of them it holds.
    #[must_use]
    pub fn last_leg(&self) -> (u64, usize) {
        (self.steps, self.len() - self.first)
    }

    /// The legs before the last one.
    #[must_use]
    pub fn earlier(&self) -> &[LedgerLeg] {
        &self.earlier
    }

    /// How many records it holds.
    #[must_use]
    pub fn len(&self) -> usize {
        self.first + self.bytes.len() / self.shape.bytes()
    }

    /// Whether it holds none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// How the records of the last leg lie.
    #[must_use]
    pub fn shape(&self) -> &RecordShape {
        &self.shape
    }

    /// All records as they are stored, leg by leg.
    pub fn legs(&self) -> impl Iterator<Item = (&RecordShape, &[u8])> {
        let earlier = self.earlier.iter().map(|leg| (&leg.shape, leg.bytes.as_slice()));
        earlier.chain([(&self.shape, self.bytes.as_slice())])
    }

    /// The leg of a step, and its number there.
    fn leg_of(&self, mut step: usize) -> (&RecordShape, &[u8], usize) {
        for (shape, bytes) in self.legs() {
            let records = bytes.len() / shape.bytes();
            if step < records {
                return (shape, bytes, step);
            }
            step -= records;
        }
        (&self.shape, &[], step)
    }

    /// Adds the step that the cycle has just done; before any recovery.
    fn add<R: Robot>(&mut self, cycle: &Cycle<R>, step: &Step) {
        self.steps += 1;
        if self.bytes.len() >= self.most {
            return;
        }
        let (robot, facts) = (cycle.robot(), cycle.facts());
        let (here, nearest_beam) = (robot.whereabouts().unwrap_or_default(), facts.nearest_beam());
        let record = Record {
            reward: step.reward,
            pose: here.pose,
            z_m: here.z_m as f32,
            prey: robot.prey().map(|prey| [prey.x_m as f32, prey.y_m as f32, prey.yaw_rad as f32]),
            state: step.state as u32,
            next_state: step.next_state as u32,
            action: step.action as u16,
            driver: step.driver.map(|driver| driver as u8),
            then: step.then,
            to: step.to,
            contact: step.contact,
            fallen: facts.fallen,
            explored: step.explored,
            beam: cycle.fired_beam().map(|beam| beam as u16),
            nearest_beam: nearest_beam as u16,
            nearest_m: facts.ranges_m.get(nearest_beam).copied().unwrap_or(0.0),
            coverage: cycle.coverage() as f32,
        };
        self.bytes.extend_from_slice(&record.to_bytes());
        self.add_fired(cycle.fired());
        if self.shape.varies() {
            let attempt = [robot.world_index() as u32, u32::from(step.hop)].map(u32::to_le_bytes);
            self.bytes.extend_from_slice(attempt.as_flattened());
            robot.drawn().iter().for_each(|drawn| self.bytes.extend_from_slice(&drawn.to_le_bytes()));
        }
    }

    /// The records of the last leg as they are stored, and the steps that were done in it.
    #[must_use]
    pub fn stored(&self) -> (&[u8], u64) {
        (&self.bytes, self.steps)
    }

    /// Goes on after records of the same plan that were stored, see [`Ledger::stored`]. False if they do not fit: then it is
    /// as it was.
    #[must_use]
    pub fn go_on_after(&mut self, records: &[u8], steps: u64) -> bool {
        let whole = records.len().is_multiple_of(self.shape.bytes());
        let done = (records.len() / self.shape.bytes()) as u64;
        let fits = whole && self.is_empty() && records.len() <= self.most && done <= steps;
        if fits && (done == steps || records.len() == self.most) {
            self.bytes.extend_from_slice(records);
            self.steps = steps;
            return true;
        }
        false
    }

    /// Forgets all records; their room is kept.
    pub(super) fn clear(&mut self) {
        self.bytes.clear();
        self.steps = 0;
    }

    /// The first step, with its first field, in which two ledgers differ; nothing if they are the same bit for bit.
    #[must_use]
    pub fn first_difference(&self, other: &Self) -> Option<(usize, &'static str)> {
        let mut steps = 0..self.len().max(other.len());
        let found = steps.find_map(|step| Some((step, self.field_that_differs(step, other, step)?)));
        found.or_else(|| (self.steps() != other.steps()).then_some((self.len(), "number of steps")))
    }

    /// The first field in which a step differs from a step of another ledger.
    pub(super) fn field_that_differs(&self, step: usize, other: &Self, other_step: usize) -> Option<&'static str> {
        match (self.record_bytes(step), other.record_bytes(other_step)) {
            (Some(own), Some(others)) if own == others => None,
            (Some(own), Some(others)) => {
                let at = own.iter().zip(others).position(|(a, b)| a != b).unwrap_or(own.len());
                Some(first_field(at, self.leg_of(step).0))
            }
            (None, None) => None,
            _ => Some("number of steps"),
        }
    }

    fn add_fired(&mut self, fired: &[Option<f64>]) {
        for chunk in fired.chunks(64) {
            let set = chunk.iter().enumerate().fold(0_u64, |set, (bit, value)| set | u64::from(value.is_some()) << bit);
            self.bytes.extend_from_slice(&set.to_le_bytes());
        }
        for (value, fixed) in fired.iter().zip(self.shape.values()) {
            if fixed.is_none() {
                self.bytes.extend_from_slice(&value.unwrap_or(0.0).to_le_bytes());
            }
        }
    }

    /// The bytes of one record.
    #[must_use]
    pub fn record_bytes(&self, step: usize) -> Option<&[u8]> {
        let (shape, bytes, step) = self.leg_of(step);
        bytes.get(step * shape.bytes()..)?.get(..shape.bytes())
    }

    /// One step's record.
    #[must_use]
    pub fn record(&self, step: usize) -> Option<Record> {
        Some(Record::from_bytes(self.record_bytes(step)?.first_chunk()?))
    }

    /// What was drawn for the attempt of a step; nothing in a run that does not vary.
    #[must_use]
    pub fn attempt(&self, step: usize) -> Option<Attempt> {
        self.leg_of(step).0.attempt(self.record_bytes(step)?)
    }

    /// The number of the world in which a step was done.
    #[must_use]
    pub fn world(&self, step: usize) -> usize {
        self.attempt(step).map_or(0, |attempt| attempt.world)
    }

    /// Every record, first to last.
    pub fn records(&self) -> impl Iterator<Item = Record> + '_ {
        let records = self.legs().flat_map(|(shape, bytes)| bytes.chunks_exact(shape.bytes()));
        records.filter_map(|bytes| bytes.first_chunk()).map(Record::from_bytes)
    }

    /// The rules that fired in one step, by their number in the script of its leg, each with what it added.
    pub fn fired(&self, step: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let shape = self.leg_of(step).0;
        let tail = self.record_bytes(step).and_then(|bytes| bytes.get(FIXED_BYTES..)).unwrap_or_default();
        let (words, own) = tail.split_at((8 * shape.words()).min(tail.len()));
        let mut own = own.chunks_exact(8);
        let rules = if tail.is_empty() { &[] } else { shape.values() };
        rules.iter().enumerate().filter_map(move |(rule, fixed)| {
            let value = match fixed {
                Some(value) => *value,
                None => f64::from_le_bytes(own.next()?.try_into().ok()?),
            };
            let set = words.get(rule / 8).copied().unwrap_or(0);
            (set >> (rule % 8) & 1 == 1).then_some((rule, value))
        })
    }
}

impl<R: Robot> Observer<R> for Ledger {
    fn stepped(&mut self, cycle: &Cycle<R>, step: &Step) -> ControlFlow<()> {
        self.add(cycle, step);
        ControlFlow::Continue(())
    }
}
