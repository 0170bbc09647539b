//! The ledger: one small record for each step, kept in memory while a robot learns or is tested.
//!
//! A record says what was decided and why it was rewarded, not what was seen: frame, scan and mask come back exactly by
//! driving the recorded actions again ([`super::Playback`]). Reading one: [`Ledger::record`] and [`Ledger::fired`].

use super::{Cycle, Plan, Step};
use crate::geometry::Pose;
use crate::robot::SimulatedRobot;

/// The most steps that a ledger keeps: of a longer run it holds the beginning.
pub const MOST_STEPS: u64 = 1 << 20;
/// Bytes of a record before the words of the rules.
const FIXED_BYTES: usize = 72;
/// Where each field of a record begins.
const FIELDS: &[(usize, &str)] = &[
    (0, "reward"),
    (8, "x"),
    (16, "y"),
    (24, "yaw"),
    (32, "state"),
    (36, "next state"),
    (40, "action"),
    (42, "flags"),
    (44, "beam of the rule"),
    (46, "nearest beam"),
    (48, "nearest range"),
    (52, "height"),
    (56, "prey"),
    (68, "coverage"),
    (FIXED_BYTES, "values of the rules"),
];
const NO_BEAM: u16 = u16::MAX;

/// One step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Record {
    /// The sum of what the rules added.
    pub reward: f64,
    /// The true pose at the end of the step, before any recovery.
    pub pose: Pose,
    /// The height of the robot's own ground at the end, metres.
    pub z_m: f32,
    /// The true pose of the prey at the end: metres, metres, radians.
    pub prey: Option<[f32; 3]>,
    /// The state in which the action was chosen.
    pub state: u32,
    /// The state at the end.
    pub next_state: u32,
    /// The action.
    pub action: u16,
    /// The script asked for recovery: the next step begins somewhere else.
    pub recover: bool,
    /// The body touched something.
    pub contact: bool,
    /// The robot lost its footing.
    pub fallen: bool,
    /// The action was not the best known one of its state.
    pub explored: bool,
    /// The beam behind the last rule that fired.
    pub beam: Option<u16>,
    /// The beam with the least range.
    pub nearest_beam: u16,
    /// The least range, metres.
    pub nearest_m: f32,
    /// Share of the image that the filters left, 0 to 1.
    pub coverage: f32,
}

/// How the records of one behaviour lie in memory and in the log file.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordShape {
    /// For each rule, and `fn reward` last, what it adds whenever it fires; nothing where each record holds its own value.
    values: Vec<Option<f64>>,
}

impl RecordShape {
    /// The shape for rules with these fixed values.
    #[must_use]
    pub fn new(values: Vec<Option<f64>>) -> Self {
        Self { values }
    }

    /// The shape for a behaviour.
    #[must_use]
    pub fn of(plan: &Plan) -> Self {
        Self::new((0..plan.behaviour.rules().len()).map(|rule| plan.behaviour.fixed_value(rule)).collect())
    }

    /// Bytes of one record: 72, 8 for each 64 rules, 8 for each value that is not fixed.
    #[must_use]
    pub fn bytes(&self) -> usize {
        FIXED_BYTES + 8 * (self.words() + self.values.iter().filter(|value| value.is_none()).count())
    }

    /// The fixed values.
    #[must_use]
    pub fn values(&self) -> &[Option<f64>] {
        &self.values
    }

    fn words(&self) -> usize {
        self.values.len().div_ceil(64)
    }
}

/// The records of one phase: learning, or a test.
#[derive(Debug, Clone, PartialEq)]
pub struct Ledger {
    shape: RecordShape,
    bytes: Vec<u8>,
    most: usize,
    steps: u64,
}

impl Ledger {
    /// An empty ledger with room for `steps` steps; nothing is allocated later.
    #[must_use]
    pub fn new(plan: &Plan, steps: u64) -> Self {
        let shape = RecordShape::of(plan);
        let most = steps.min(MOST_STEPS) as usize * shape.bytes();
        Self { shape, bytes: Vec::with_capacity(most), most, steps: 0 }
    }

    /// A ledger that keeps nothing.
    #[must_use]
    pub fn off() -> Self {
        Self { shape: RecordShape::new(Vec::new()), bytes: Vec::new(), most: 0, steps: 0 }
    }

    /// A ledger from records that were stored; nothing if they are not whole, or more than the steps.
    #[must_use]
    pub fn from_bytes(shape: RecordShape, bytes: Vec<u8>, steps: u64) -> Option<Self> {
        let (count, rest) = (bytes.len() / shape.bytes(), bytes.len() % shape.bytes());
        let fits = rest == 0 && count as u64 <= steps;
        fits.then_some(Self { most: bytes.len(), shape, bytes, steps })
    }

    /// How many steps were done; more than [`Ledger::len`] if the run was longer than a ledger.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.steps
    }

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

    /// How its records lie.
    #[must_use]
    pub fn shape(&self) -> &RecordShape {
        &self.shape
    }

    /// All records as they are stored.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Adds the step that the cycle has just done; before any recovery.
    pub fn add(&mut self, cycle: &Cycle<SimulatedRobot>, step: &Step, explored: bool) {
        self.steps += 1;
        if self.bytes.len() >= self.most {
            return;
        }
        let (world, facts) = (cycle.robot().world(), cycle.facts());
        let (body, nearest_beam) = (world.body(), facts.nearest_beam());
        let record = Record {
            reward: step.reward,
            pose: body.pose,
            z_m: body.z_m as f32,
            prey: world.prey().map(|prey| [prey.x_m as f32, prey.y_m as f32, prey.yaw_rad as f32]),
            state: step.state as u32,
            next_state: step.next_state as u32,
            action: step.action as u16,
            recover: step.recover,
            contact: step.contact,
            fallen: facts.fallen,
            explored,
            beam: cycle.fired_beam().map(|beam| beam as u16),
            nearest_beam: nearest_beam as u16,
            nearest_m: facts.ranges_m.get(nearest_beam).copied().unwrap_or(0.0),
            coverage: facts.coverage as f32,
        };
        self.bytes.extend_from_slice(&record.to_bytes());
        self.add_fired(cycle.fired());
    }

    /// Forgets all records; their room is kept.
    pub(super) fn clear(&mut self) {
        self.bytes.clear();
        self.steps = 0;
    }

    /// The first step, with its first field, in which two ledgers differ; nothing if they are the same bit for bit.
    #[must_use]
    pub fn first_difference(&self, other: &Self) -> Option<(usize, &'static str)> {
        let steps = 0..self.len().max(other.len());
        let found = steps.into_iter().find_map(|step| Some((step, self.field_that_differs(step, other, step)?)));
        found.or_else(|| (self.steps != other.steps).then_some((self.len(), "number of steps")))
    }

    /// The first field in which a step differs from a step of another ledger.
    pub(super) fn field_that_differs(&self, step: usize, other: &Self, other_step: usize) -> Option<&'static str> {
        match (self.record_bytes(step), other.record_bytes(other_step)) {
            (Some(own), Some(others)) if own == others => None,
            (Some(own), Some(others)) => {
                let at = own.iter().zip(others).position(|(a, b)| a != b).unwrap_or(own.len());
                let field = FIELDS.iter().rev().find(|(from, _)| *from <= at);
                let rules = FIXED_BYTES..FIXED_BYTES + 8 * self.shape.words();
                Some(if rules.contains(&at) { "rules that fired" } else { field.map_or("size", |(_, name)| name) })
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
        for (value, fixed) in fired.iter().zip(&self.shape.values) {
            if fixed.is_none() {
                self.bytes.extend_from_slice(&value.unwrap_or(0.0).to_le_bytes());
            }
        }
    }

    /// The bytes of one record.
    #[must_use]
    pub fn record_bytes(&self, step: usize) -> Option<&[u8]> {
        let size = self.shape.bytes();
        self.bytes.get(step.checked_mul(size)?..)?.get(..size)
    }

    /// One step's record.
    #[must_use]
    pub fn record(&self, step: usize) -> Option<Record> {
        Some(Record::from_bytes(self.record_bytes(step)?.first_chunk()?))
    }

    /// Every record, first to last.
    pub fn records(&self) -> impl Iterator<Item = Record> + '_ {
        let fixed = self.bytes.chunks_exact(self.shape.bytes()).filter_map(|bytes| bytes.first_chunk());
        fixed.map(Record::from_bytes)
    }

    /// The rules that fired in one step, by number, each with what it added.
    pub fn fired(&self, step: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let tail = self.record_bytes(step).and_then(|bytes| bytes.get(FIXED_BYTES..)).unwrap_or_default();
        let (words, own) = tail.split_at((8 * self.shape.words()).min(tail.len()));
        let mut own = own.chunks_exact(8);
        let rules = if tail.is_empty() { &[] } else { self.shape.values.as_slice() };
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

impl Record {
    fn to_bytes(self) -> [u8; FIXED_BYTES] {
        let prey = self.prey.unwrap_or_default();
        let flags = [self.recover, self.contact, self.fallen, self.explored, self.prey.is_some()];
        let flags = flags.iter().enumerate().fold(0_u16, |set, (bit, flag)| set | u16::from(*flag) << bit);
        let mut bytes = [0; FIXED_BYTES];
        let wide = [self.reward, self.pose.x_m, self.pose.y_m, self.pose.yaw_rad].map(f64::to_le_bytes);
        bytes[0..32].copy_from_slice(wide.as_flattened());
        bytes[32..40].copy_from_slice([self.state, self.next_state].map(u32::to_le_bytes).as_flattened());
        let small = [self.action, flags, self.beam.unwrap_or(NO_BEAM), self.nearest_beam].map(u16::to_le_bytes);
        bytes[40..48].copy_from_slice(small.as_flattened());
        let narrow = [self.nearest_m, self.z_m, prey[0], prey[1], prey[2], self.coverage].map(f32::to_le_bytes);
        bytes[48..72].copy_from_slice(narrow.as_flattened());
        bytes
    }

    fn from_bytes(bytes: &[u8; FIXED_BYTES]) -> Self {
        let (wide, _) = bytes[0..32].as_chunks();
        let [reward, x_m, y_m, yaw_rad] = [0, 1, 2, 3].map(|index| f64::from_le_bytes(wide[index]));
        let (states, _) = bytes[32..40].as_chunks();
        let (small, _) = bytes[40..48].as_chunks();
        let [action, flags, beam, nearest_beam] = [0, 1, 2, 3].map(|index| u16::from_le_bytes(small[index]));
        let (narrow, _) = bytes[48..72].as_chunks();
        let [nearest_m, z_m, x, y, yaw, coverage] = [0, 1, 2, 3, 4, 5].map(|index| f32::from_le_bytes(narrow[index]));
        let flag = |bit: u16| flags >> bit & 1 == 1;
        Self {
            reward,
            pose: Pose { x_m, y_m, yaw_rad },
            z_m,
            prey: flag(4).then_some([x, y, yaw]),
            state: u32::from_le_bytes(states[0]),
            next_state: u32::from_le_bytes(states[1]),
            action,
            recover: flag(0),
            contact: flag(1),
            fallen: flag(2),
            explored: flag(3),
            beam: (beam != NO_BEAM).then_some(beam),
            nearest_beam,
            nearest_m,
            coverage,
        }
    }
}
