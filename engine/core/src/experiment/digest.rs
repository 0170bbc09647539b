//! A hash over everything that a run decided, to compare runs bit for bit.

use std::ops::ControlFlow;

use super::{Cycle, Observer, Step};
use crate::digest::hex;
use crate::geometry::Pose;
use crate::learner::Learner;
use crate::robot::Robot;
use crate::saved::{Passed, Passing, Unfit};
use sha2::digest::common::hazmat::SerializableState;
use sha2::{Digest, Sha256};

/// SHA-256 over every step (state, action, reward, failure, true pose) and the learned table.
#[derive(Debug, Clone, Default)]
pub(super) struct StateHash {
    hasher: Sha256,
}

impl StateHash {
    fn step(&mut self, step: &Step, pose: Pose) {
        let mut record = [0_u8; 48];
        let fields = [
            (step.state as u64).to_le_bytes(),
            (step.action as u64 | u64::from(step.then.is_some()) << 32).to_le_bytes(),
            step.reward.to_le_bytes(),
            pose.x_m.to_le_bytes(),
            pose.y_m.to_le_bytes(),
            pose.yaw_rad.to_le_bytes(),
        ];
        for (bytes, field) in record.chunks_exact_mut(8).zip(fields) {
            bytes.copy_from_slice(&field);
        }
        self.hasher.update(record);
    }

    /// The hash so far, to be gone on with.
    pub(super) fn pass(&mut self, by: &mut Passing<'_>) -> Passed {
        let mut state = self.hasher.serialize().to_vec();
        by.bytes(&mut state)?;
        let state = state.as_slice().try_into().map_err(|_| Unfit)?;
        self.hasher = Sha256::deserialize(state).map_err(|_| Unfit)?;
        Ok(())
    }

    /// The hash as 64 hexadecimal digits.
    pub(super) fn finish(self) -> String {
        hex(&self.hasher.finalize())
    }

    /// The hash with the numbers that a learner has learned.
    pub(super) fn finish_with(mut self, learner: &dyn Learner) -> String {
        learner.numbers(&mut |value| self.hasher.update(value.to_le_bytes()));
        self.finish()
    }
}

impl<R: Robot> Observer<R> for StateHash {
    fn stepped(&mut self, cycle: &Cycle<R>, step: &Step) -> ControlFlow<()> {
        self.step(step, cycle.robot().whereabouts().unwrap_or_default().pose);
        ControlFlow::Continue(())
    }
}
