//! The ledger: one small record for each step, kept in memory while a robot learns or is tested.
//!
//! A record says what was decided and why it was rewarded, not what was seen: frame, scan and mask come back exactly by
//! driving the recorded actions again ([`super::Playback`]). Reading one: [`Ledger::record`] and [`Ledger::fired`].

//! A ledger has room for [`MOST_STEPS`] records. Those of a longer run are passed on (`tail.rs`), and read back from where they
//! were kept (`pages.rs`).

mod pages;
mod reading;
mod record;
mod tail;

use std::borrow::Cow;
use std::ops::ControlFlow;
use std::sync::Arc;

use super::run_log::{CHUNK_STEPS, DIGEST_BYTES, chained};
use super::{Cycle, Observer, Plan, Step};
use crate::diagnostic::Result;
use crate::robot::Robot;

use pages::Pages;
pub use pages::StoredSegments;
pub use record::{Attempt, Record, RecordShape};
use tail::Tail;
pub use tail::{PassedOn, Segment};

/// The most steps that a ledger keeps in memory, and those of a segment of a log.
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
    /// The records that come after, if there is no room for all.
    tail: Tail,
    pages: Option<Pages>,
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
        let empty = Self::from_leg(LedgerLeg { shape, bytes: Vec::with_capacity(most), steps: 0 });
        Self { most, ..empty }
    }

    /// An empty ledger of a plan without earlier legs that has no end: what it has no room for is passed on.
    #[must_use]
    pub(super) fn without_end(plan: &Plan, steps: u64) -> Self {
        let ledger = Self::new(plan, steps);
        let more = steps.saturating_sub(MOST_STEPS);
        if more == 0 { ledger } else { Self { tail: Tail::new(ledger.shape.bytes(), more), ..ledger } }
    }

    /// This ledger with the segments that followed its records.
    #[must_use]
    pub fn followed_by(self, segments: Vec<Segment>) -> Self {
        Self { tail: Tail::of(segments), ..self }
    }

    /// This ledger with so many records of the segments that follow, which are read where they lie.
    #[must_use]
    pub fn with_pages(self, stored: Arc<dyn StoredSegments>, records: u64) -> Self {
        Self { pages: Some(Pages::new(stored, records)), ..self }
    }

    /// The segments that follow what it holds itself.
    #[must_use]
    pub fn segments(&self) -> &[Segment] {
        &self.tail.segments
    }

    /// Whether steps that it has no room for are in its digest.
    #[must_use]
    pub fn has_no_end(&self) -> bool {
        self.tail.is_on()
    }

    /// How many steps can be done before records must be passed on.
    pub(super) fn room(&self) -> u64 {
        if !self.tail.is_on() {
            return u64::MAX;
        }
        let bytes = self.shape.bytes();
        ((self.most - self.bytes.len()) / bytes) as u64 + self.tail.room(bytes)
    }

    /// Passes on what it has no room for: whole chunks or, at the end, all.
    ///
    /// # Errors
    /// What `to` fails with.
    pub(super) fn pass_on(&mut self, at_the_end: bool, to: &mut dyn FnMut(PassedOn<'_>) -> Result<()>) -> Result<()> {
        let (bytes, own) = (self.shape.bytes(), &self.bytes);
        let first = || own.chunks(CHUNK_STEPS * bytes).fold([0; DIGEST_BYTES], |before, chunk| chained(&before, chunk));
        self.tail.pass_on(bytes, first, at_the_end, to)
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
        let (tail, pages) = (Tail::default(), None);
        Self { earlier: Vec::new(), first: 0, most: bytes.len(), shape, bytes, steps, kept: Vec::new(), tail, pages }
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
        self.tail = Tail::default();
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

    /// Steps that were done in the last leg, and how many of them it holds itself.
    #[must_use]
    pub fn last_leg(&self) -> (u64, usize) {
        (self.steps, self.bytes.len() / self.shape.bytes())
    }

    /// The legs before the last one.
    #[must_use]
    pub fn earlier(&self) -> &[LedgerLeg] {
        &self.earlier
    }

    /// How many records there are, from the first step on without a gap.
    #[must_use]
    pub fn len(&self) -> usize {
        self.held() + self.pages.as_ref().map_or(0, Pages::len)
    }

    /// How many it holds itself.
    fn held(&self) -> usize {
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
        let to = match () {
            () if self.bytes.len() < self.most => &mut self.bytes,
            () if self.tail.is_on() => self.tail.waiting_mut(),
            () => return,
        };
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
        to.extend_from_slice(&record.to_bytes());
        add_fired(&self.shape, cycle.fired(), to);
        if self.shape.varies() {
            let attempt = [robot.world_index() as u32, u32::from(step.hop)].map(u32::to_le_bytes);
            to.extend_from_slice(attempt.as_flattened());
            robot.drawn().iter().for_each(|drawn| to.extend_from_slice(&drawn.to_le_bytes()));
        }
    }

    /// All records as they are stored, those of each leg after those of the one before.
    #[must_use]
    pub fn stored(&self) -> Cow<'_, [u8]> {
        if self.earlier.is_empty() {
            return Cow::Borrowed(&self.bytes);
        }
        Cow::Owned(self.legs().flat_map(|(_, bytes)| bytes).copied().collect())
    }

    /// Goes on after the records of so many steps of its leg, which stand at the front of `records`, see [`Ledger::stored`].
    /// False if they do not fit: then it is as it was.
    #[must_use]
    pub(super) fn take_up(&mut self, records: &mut &[u8], steps: u64) -> bool {
        let wanted = steps.saturating_mul(self.shape.bytes() as u64).min(self.most as u64);
        let Some((own, rest)) = records.split_at_checked(wanted as usize).filter(|_| self.bytes.is_empty()) else {
            return false;
        };
        self.bytes.extend_from_slice(own);
        (self.steps, *records) = (steps, rest);
        true
    }

    /// What a checkpoint needs besides the records that it holds itself; empty if it holds all.
    pub(super) fn stored_tail(&self) -> Vec<u8> {
        if self.tail.is_empty() { Vec::new() } else { self.tail.save() }
    }

    /// Goes on with what follows the records that it took up, see [`Ledger::stored_tail`]; whether that fits.
    #[must_use]
    pub(super) fn take_up_tail(&mut self, tail: &[u8]) -> bool {
        let after = self.steps - self.last_leg().1 as u64;
        match tail.is_empty() {
            true => after == 0 || !self.tail.is_on(),
            false => self.tail.is_on() && self.tail.load(tail, self.shape.bytes(), after).is_ok(),
        }
    }

    /// Forgets all records; their room is kept.
    pub(super) fn clear(&mut self) {
        self.bytes.clear();
        self.steps = 0;
    }
}

fn add_fired(shape: &RecordShape, fired: &[Option<f64>], to: &mut Vec<u8>) {
    for chunk in fired.chunks(64) {
        let set = chunk.iter().enumerate().fold(0_u64, |set, (bit, value)| set | u64::from(value.is_some()) << bit);
        to.extend_from_slice(&set.to_le_bytes());
    }
    for (value, fixed) in fired.iter().zip(shape.values()) {
        if fixed.is_none() {
            to.extend_from_slice(&value.unwrap_or(0.0).to_le_bytes());
        }
    }
}

impl<R: Robot> Observer<R> for Ledger {
    fn stepped(&mut self, cycle: &Cycle<R>, step: &Step) -> ControlFlow<()> {
        self.add(cycle, step);
        ControlFlow::Continue(())
    }
}
