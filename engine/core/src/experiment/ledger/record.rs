//! One record of a ledger, and how its bytes lie.

use crate::experiment::Plan;
use crate::geometry::Pose;
use crate::outcome::{Destination, Ending, Then};
use crate::settings::RecoverTo;

/// Bytes of a record before the words of the rules.
pub(super) const FIXED_BYTES: usize = 72;
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
/// Of the flags, the lower of the two bits that hold the word after `then`: its number in [`Then::ALL`].
const THEN_BIT: u16 = 5;
/// Of the flags, the lowest of those that hold where the next attempt begins: 0 as `recovery` says, then the words of recovery in
/// their order, then the world's starts in theirs. A start beyond the last number is not told apart from 0.
const TO_BIT: u16 = 7;

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
    /// The action, by its place among the plan's motions.
    pub action: u16,
    /// The use under which a learned policy chose it; nothing if the script's own choice was it.
    pub driver: Option<u8>,
    /// What the script said if the attempt ended: the next step begins somewhere else.
    pub then: Option<Then>,
    /// Where it does, if the script said so.
    pub to: Option<Destination>,
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
    /// Of a run that varies: how many values are drawn for each attempt.
    drawn: Option<usize>,
}

/// What was drawn for the attempt to which a step belongs.
#[derive(Debug, Clone, PartialEq)]
pub struct Attempt {
    /// The number of the world; 0 is the home world.
    pub world: usize,
    /// The attempt was broken off after this step.
    pub hop: bool,
    /// The values of `randomise`, in its order; of words and flags, which of them it is.
    pub drawn: Vec<f64>,
}

impl RecordShape {
    /// The shape for rules with these fixed values.
    #[must_use]
    pub(super) fn new(values: Vec<Option<f64>>) -> Self {
        Self { values, drawn: None }
    }

    /// The shape for a behaviour.
    #[must_use]
    pub fn of(plan: &Plan) -> Self {
        let values = (0..plan.behaviour.rules().len()).map(|rule| plan.behaviour.fixed_value(rule)).collect();
        Self { drawn: plan.varies().then_some(plan.settings.randomise.len()), ..Self::new(values) }
    }

    /// Bytes of one record: 72, 8 for each 64 rules, 8 for each value that is not fixed; of a run that varies 8 for the world,
    /// and 8 for each value that is drawn.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.judged_bytes() + 8 * self.drawn.map_or(0, |values| 1 + values)
    }

    /// Those of them before what was drawn.
    fn judged_bytes(&self) -> usize {
        FIXED_BYTES + 8 * (self.words() + self.values.iter().filter(|value| value.is_none()).count())
    }

    /// Whether records hold the world and what was drawn.
    pub(super) fn varies(&self) -> bool {
        self.drawn.is_some()
    }

    /// The bytes of an attempt at the end of a record: the world's number and whether a hop follows as 4 bytes each, then the
    /// drawn values.
    pub(super) fn attempt(&self, record: &[u8]) -> Option<Attempt> {
        self.drawn?;
        let (words, _) = record.get(self.judged_bytes()..)?.as_chunks::<8>();
        let (first, drawn) = words.split_first()?;
        let [world, hop] =
            [0, 4].map(|at| u32::from_le_bytes([first[at], first[at + 1], first[at + 2], first[at + 3]]));
        Some(Attempt {
            world: world as usize,
            hop: hop == 1,
            drawn: drawn.iter().map(|word| f64::from_le_bytes(*word)).collect(),
        })
    }

    /// The fixed values.
    #[must_use]
    pub fn values(&self) -> &[Option<f64>] {
        &self.values
    }

    /// Words of 64 rules, a bit for each.
    pub(super) fn words(&self) -> usize {
        self.values.len().div_ceil(64)
    }
}

impl Record {
    /// How the attempt ended, if it did.
    #[must_use]
    pub fn ending(&self) -> Option<Ending> {
        self.then.map(|then| then.ending(self.reward))
    }

    pub(super) fn to_bytes(self) -> [u8; FIXED_BYTES] {
        let prey = self.prey.unwrap_or_default();
        let flags = [self.then.is_some(), self.contact, self.fallen, self.explored, self.prey.is_some()];
        let flags = flags.iter().enumerate().fold(0_u16, |set, (bit, flag)| set | u16::from(*flag) << bit);
        let word = Then::ALL.iter().position(|(_, then)| Some(*then) == self.then).unwrap_or(0) as u16;
        let flags = flags | word << THEN_BIT | code(self.to) << TO_BIT;
        let mut bytes = [0; FIXED_BYTES];
        let wide = [self.reward, self.pose.x_m, self.pose.y_m, self.pose.yaw_rad].map(f64::to_le_bytes);
        bytes[0..32].copy_from_slice(wide.as_flattened());
        bytes[32..40].copy_from_slice([self.state, self.next_state].map(u32::to_le_bytes).as_flattened());
        // The upper byte of the action was always 0: there are at most 64.
        let action = self.action & 0xff | self.driver.map_or(0, |driver| (u16::from(driver) + 1) << 8);
        let small = [action, flags, self.beam.unwrap_or(NO_BEAM), self.nearest_beam].map(u16::to_le_bytes);
        bytes[40..48].copy_from_slice(small.as_flattened());
        let narrow = [self.nearest_m, self.z_m, prey[0], prey[1], prey[2], self.coverage].map(f32::to_le_bytes);
        bytes[48..72].copy_from_slice(narrow.as_flattened());
        bytes
    }

    pub(super) fn from_bytes(bytes: &[u8; FIXED_BYTES]) -> Self {
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
            action: action & 0xff,
            driver: (action >> 8).checked_sub(1).map(|driver| driver as u8),
            then: flag(0).then(|| Then::ALL[usize::from(flags >> THEN_BIT & 3)].1),
            to: destination(flags >> TO_BIT),
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

fn code(to: Option<Destination>) -> u16 {
    let number = match to {
        None => 0,
        Some(Destination::Word(word)) => 1 + RecoverTo::ALL.iter().position(|own| *own == word).unwrap_or(0),
        Some(Destination::Start(start)) => 1 + RecoverTo::ALL.len() + start,
    };
    if number >> (16 - TO_BIT) == 0 { number as u16 } else { 0 }
}

fn destination(code: u16) -> Option<Destination> {
    let number = usize::from(code).checked_sub(1)?;
    let word = RecoverTo::ALL.get(number).copied().map(Destination::Word);
    Some(word.unwrap_or_else(|| Destination::Start(number - RecoverTo::ALL.len())))
}

/// The name of the field that the byte `at` of a record belongs to.
pub(super) fn first_field(at: usize, shape: &RecordShape) -> &'static str {
    if (FIXED_BYTES..FIXED_BYTES + 8 * shape.words()).contains(&at) {
        return "rules that fired";
    }
    if at >= shape.judged_bytes() {
        return "world and draws";
    }
    FIELDS.iter().rev().find(|(from, _)| *from <= at).map_or("size", |(_, name)| name)
}
