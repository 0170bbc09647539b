//! Learning as bytes, for checkpoints.

use super::Learning;
use crate::learner::Learner;
use crate::robot::Robot;
use crate::saved::{Loading, Passed, Passing, Saving, Unfit};

impl<R: Robot, L: Learner> Learning<R, L> {
    /// All that goes on, as bytes: the same plan and seed learn on from them as if nobody had looked.
    ///
    /// # Errors
    /// If there is no such form of it: a robot that cannot be left, a failure.
    pub fn save(&mut self) -> Result<Vec<u8>, Unfit> {
        let mut by = Passing::Out(Saving::default());
        self.pass(&mut by)?;
        if let Passing::Out(saving) = by { Ok(saving.into_bytes()) } else { Err(Unfit) }
    }

    /// Becomes what was saved of the same plan under the same seed.
    ///
    /// # Errors
    /// If it does not fit: then it is good for nothing any more.
    pub fn load(&mut self, bytes: &[u8]) -> Result<(), Unfit> {
        let mut by = Passing::In(Loading::new(bytes));
        self.pass(&mut by)?;
        if let Passing::In(loading) = by { loading.end() } else { Err(Unfit) }
    }

    fn pass(&mut self, by: &mut Passing<'_>) -> Passed {
        if self.fault.is_some() {
            return Err(Unfit);
        }
        self.cycle.pass(by)?;
        self.used.pass(by)?;
        self.tally.pass(by)?;
        self.early.pass(by)?;
        self.hash.pass(by)?;
        by.list(&mut self.joined.steps, Passing::whole)?;
        match by {
            Passing::Out(saving) => self.learner.save(saving),
            Passing::In(loading) => self.learner.load(loading)?,
        }
        Ok(())
    }
}
