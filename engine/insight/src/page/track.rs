//! The steps of one phase, quantised for the page.

use serde::Serialize;

use super::shot::{Shot, ShotMaker};
use crate::markup::base64;
use engine::diagnostic::Result;
use engine::experiment::{Ledger, Phase, Plan, Playback, Recall, RecordedMovers, StepReasons};
use engine::geometry::Pose;

/// The most steps of a track; of more, the first and the last half of as many are kept.
pub const MOST_TRACK_STEPS: usize = 12_000;
/// Scans and pictures come from playing the steps again; at most this many are played, starting with the first.
pub(super) const MOST_PLAYED: usize = 20_000;

/// Which steps bring pictures with them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Moments {
    /// Steps of each phase with pictures: half of them evenly over the phase, half where rules fired.
    pub shots: usize,
    /// Whether scans are kept.
    pub scans: bool,
    /// How many seeds bring their steps, starting with the first; `None` for the worst seed and then as many as fit.
    pub seeds: Option<usize>,
}

/// How the laser's beams stand in a track.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ScanShape {
    /// Beams of the laser.
    pub beams: usize,
    /// Where beam 0 looks, radians from straight ahead, positive to the left.
    pub first_rad: f64,
    /// From one beam to the next, radians.
    pub apart_rad: f64,
    /// Whether they go all round.
    pub whole: bool,
    /// One beam in this many is kept, starting with beam 0.
    pub every: usize,
    /// How many are kept.
    pub kept: usize,
    /// The longest range, metres.
    pub max_range_m: f64,
    /// Place of the laser ahead of the robot's centre, metres.
    pub forward_m: f64,
    /// How far it looks down, radians.
    pub tilt_rad: f64,
}

/// The steps of one phase; the fields are described in [`super`].
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
#[allow(missing_docs, reason = "every field is documented in the table of the room")]
pub struct Track {
    pub steps: u64,
    pub spans: Vec<[usize; 2]>,
    pub x: String,
    pub y: String,
    pub yaw: String,
    pub state: String,
    pub next_state: String,
    pub action: String,
    #[serde(skip_serializing_if = "String::is_empty")]
    pub driver: String,
    pub flags: String,
    #[serde(skip_serializing_if = "String::is_empty")]
    pub world: String,
    pub reward: String,
    pub fired: String,
    pub beam: String,
    pub nearest_beam: String,
    pub nearest: String,
    pub movers: Vec<MoverTrack>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub measures: Vec<String>,
    pub scan: String,
}

/// Where one mover was, step by step.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
#[allow(missing_docs, reason = "every field is documented in the table of the room")]
pub struct MoverTrack {
    pub x: String,
    pub y: String,
    pub yaw: String,
}

/// The bytes of a track while it is filled.
#[derive(Default)]
struct Columns {
    x: Vec<u8>,
    y: Vec<u8>,
    yaw: Vec<u8>,
    state: Vec<u8>,
    next_state: Vec<u8>,
    action: Vec<u8>,
    driver: Vec<u8>,
    flags: Vec<u8>,
    world: Vec<u8>,
    reward: Vec<u8>,
    fired: Vec<u8>,
    beam: Vec<u8>,
    nearest_beam: Vec<u8>,
    nearest: Vec<u8>,
    movers: Vec<[Vec<u8>; 3]>,
    measures: Vec<Vec<u8>>,
    scan: Vec<u8>,
}

/// Where a track comes from.
pub(super) struct TrackSource<'a> {
    pub plan: &'a Plan,
    pub seed: u64,
    pub phase: Phase,
    pub ledger: &'a Ledger,
    pub unit_m: f64,
    pub scan: ScanShape,
}

impl TrackSource<'_> {
    /// The track, with the moments that have pictures.
    pub(super) fn track(&self, moments: Moments, recall: &mut Option<Recall>) -> Result<(Track, Vec<Shot>)> {
        let spans = spans(self.ledger.len());
        let mut columns = Columns::default();
        let names = self.names_of_legs();
        let mut movers = RecordedMovers::new(self.plan, self.seed, self.phase);
        for step in spans.iter().flat_map(|[from, to]| *from..*to) {
            let places = names.iter().rev().find(|(from, _)| *from <= step).map(|(_, places)| places.as_slice());
            columns.add(self, step, places.unwrap_or_default());
            movers.seek(self.ledger, step);
            columns.add_movers(movers.poses(), self.unit_m);
        }
        let shots = self.play(moments, &spans, &mut columns, recall)?;
        Ok((columns.finish(self.ledger.steps(), spans), shots))
    }

    /// By leg of the phase: its first step, and where each of its rules stands among the plan's own.
    fn names_of_legs(&self) -> Vec<(usize, Vec<Option<usize>>)> {
        let own = self.plan.behaviour.rules();
        let place = |name: &str| own.iter().position(|rule| rule.name == name);
        let places = |plan: &Plan| plan.behaviour.rules().iter().map(|rule| place(&rule.name)).collect();
        if self.phase == Phase::Test {
            return vec![(0, places(self.plan))];
        }
        let swaps = self.plan.swaps().map(|(from, _, plan, _)| (from as usize, places(plan)));
        std::iter::once((0, places(self.plan.first_leg()))).chain(swaps).collect()
    }

    /// Plays the steps again for what is not recorded: scans and pictures. What learned goes on from learning to the test.
    fn play(
        &self,
        moments: Moments,
        spans: &[[usize; 2]],
        columns: &mut Columns,
        recall: &mut Option<Recall>,
    ) -> Result<Vec<Shot>> {
        let wanted = wanted(self.ledger, moments.shots);
        let scans = if moments.scans { self.ledger.len() } else { 0 };
        let until = scans.max(wanted.last().map_or(0, |last| last + 1)).min(MOST_PLAYED);
        let maker = ShotMaker { plan: self.plan, seed: self.seed, phase: self.phase };
        let mut playback = Playback::new(self.plan, self.seed, self.phase, self.ledger)?.with_recall(recall.take());
        if moments.shots > 0 {
            playback = playback.recalling()?;
        }
        let (mut shots, mut wanted) = (Vec::new(), wanted.into_iter().peekable());
        for step in 0..until {
            if wanted.next_if_eq(&step).is_some() {
                let Some(reasons) = StepReasons::of_next(&mut playback)? else { break };
                shots.push(maker.shot(&playback, reasons)?);
            } else if playback.advance()?.is_none() {
                break;
            }
            if step < scans && spans.iter().any(|[from, to]| (*from..*to).contains(&step)) {
                let ranges_m = &playback.cycle().observation().scan.ranges_m;
                let kept = ranges_m.iter().step_by(self.scan.every).take(self.scan.kept);
                let most_m = self.scan.max_range_m as f32;
                columns.scan.extend(kept.map(|range_m| (range_m / most_m * 255.0).round().clamp(0.0, 255.0) as u8));
                columns.add_measures(playback.cycle().measures());
            }
        }
        if self.phase == Phase::Learning && self.ledger.len() <= MOST_PLAYED {
            *recall = playback.into_recall()?;
        }
        Ok(shots)
    }
}

impl Columns {
    fn add(&mut self, source: &TrackSource<'_>, step: usize, places: &[Option<usize>]) {
        let Some(record) = source.ledger.record(step) else { return };
        let place = |metres: f64| short(metres / source.unit_m);
        self.x.extend(place(record.pose.x_m));
        self.y.extend(place(record.pose.y_m));
        self.yaw.extend(short(1000.0 * record.pose.yaw_rad));
        self.state.extend(record.state.to_le_bytes());
        self.next_state.extend(record.next_state.to_le_bytes());
        self.action.push(record.action as u8);
        if source.plan.behaviour.hands_over() {
            self.driver.push(record.driver.map_or(0, |driver| driver + 1));
        }
        let attempt = source.ledger.attempt(step);
        let hop = attempt.as_ref().is_some_and(|attempt| attempt.hop);
        let flags = [record.then.is_some(), record.contact, record.fallen, record.explored, hop];
        self.flags.push(flags.iter().enumerate().fold(0, |set, (bit, flag)| set | u8::from(*flag) << bit));
        if let Some(attempt) = attempt.filter(|_| !source.plan.worlds.further().is_empty()) {
            self.world.extend((attempt.world as u16).to_le_bytes());
        }
        self.reward.extend((record.reward as f32).to_le_bytes());
        let from = self.fired.len();
        self.fired.resize(from + source.plan.behaviour.rules().len().div_ceil(8), 0);
        let rules = source.ledger.fired(step).filter_map(|(rule, _)| *places.get(rule)?);
        for rule in rules {
            self.fired[from + rule / 8] |= 1 << (rule % 8);
        }
        self.beam.extend(record.beam.unwrap_or(u16::MAX).to_le_bytes());
        self.nearest_beam.extend(record.nearest_beam.to_le_bytes());
        let nearest_mm = (record.nearest_m * 1000.0).round().clamp(0.0, 65_535.0) as u16;
        self.nearest.extend(nearest_mm.to_le_bytes());
    }

    fn add_movers(&mut self, poses: impl Iterator<Item = Pose>, unit_m: f64) {
        for (number, pose) in poses.enumerate() {
            if self.movers.len() == number {
                self.movers.push(Default::default());
            }
            let values = [short(pose.x_m / unit_m), short(pose.y_m / unit_m), short(1000.0 * pose.yaw_rad)];
            self.movers[number].iter_mut().zip(values).for_each(|(column, value)| column.extend(value));
        }
    }

    fn add_measures(&mut self, values: impl Iterator<Item = f64>) {
        for (number, value) in values.enumerate() {
            if self.measures.len() == number {
                self.measures.push(Vec::new());
            }
            self.measures[number].extend((value as f32).to_le_bytes());
        }
    }

    fn finish(self, steps: u64, spans: Vec<[usize; 2]>) -> Track {
        Track {
            steps,
            spans,
            x: base64(&self.x),
            y: base64(&self.y),
            yaw: base64(&self.yaw),
            state: base64(&self.state),
            next_state: base64(&self.next_state),
            action: base64(&self.action),
            driver: base64(&self.driver),
            flags: base64(&self.flags),
            world: base64(&self.world),
            reward: base64(&self.reward),
            fired: base64(&self.fired),
            beam: base64(&self.beam),
            nearest_beam: base64(&self.nearest_beam),
            nearest: base64(&self.nearest),
            movers: self
                .movers
                .iter()
                .map(|[x, y, yaw]| MoverTrack { x: base64(x), y: base64(y), yaw: base64(yaw) })
                .collect(),
            measures: self.measures.iter().map(|measure| base64(measure)).collect(),
            scan: base64(&self.scan),
        }
    }
}

impl Track {
    /// Its approximate size in the page, bytes.
    #[must_use]
    pub(super) fn bytes(&self) -> usize {
        let columns =
            [&self.x, &self.y, &self.yaw, &self.state, &self.next_state, &self.action, &self.driver, &self.flags];
        let others =
            [&self.world, &self.reward, &self.fired, &self.beam, &self.nearest_beam, &self.nearest, &self.scan];
        let movers = self.movers.iter().flat_map(|mover| [&mover.x, &mover.y, &mover.yaw]);
        columns.into_iter().chain(others).chain(movers).chain(&self.measures).map(String::len).sum()
    }
}

fn short(value: f64) -> [u8; 2] {
    (value.round().clamp(f64::from(i16::MIN), f64::from(i16::MAX)) as i16).to_le_bytes()
}

/// Which steps a track holds: all, or the beginning and the end.
fn spans(steps: usize) -> Vec<[usize; 2]> {
    const HALF: usize = MOST_TRACK_STEPS / 2;
    if steps <= MOST_TRACK_STEPS { vec![[0, steps]] } else { vec![[0, HALF], [steps - HALF, steps]] }
}

/// The steps with pictures, in order: half of them evenly over the phase, half where rules fired.
fn wanted(ledger: &Ledger, shots: usize) -> Vec<usize> {
    let played = ledger.len().min(MOST_PLAYED);
    let evenly = |steps: &[usize], count: usize| -> Vec<usize> {
        let count = count.min(steps.len());
        (0..count).map(|index| steps[index * (steps.len() - 1) / (count - 1).max(1)]).collect()
    };
    let all: Vec<usize> = (0..played).collect();
    let rewarded: Vec<usize> = (0..played)
        .filter(|step| ledger.record(*step).is_some_and(|record| record.then.is_some() || record.contact))
        .collect();
    let mut wanted = evenly(&rewarded, shots / 2);
    wanted.extend(evenly(&all, shots - wanted.len()));
    wanted.sort_unstable();
    wanted.dedup();
    wanted
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_track_holds_its_beginning_and_its_end() {
        assert_eq!(spans(12_000), [[0, 12_000]]);
        assert_eq!(spans(100_000), [[0, 6_000], [94_000, 100_000]]);
        assert_eq!(spans(0), [[0, 0]]);
    }

    #[test]
    fn places_are_rounded_and_never_wrap() {
        assert_eq!(i16::from_le_bytes(short(-1.6)), -2);
        assert_eq!(i16::from_le_bytes(short(1e9)), i16::MAX);
    }
}
