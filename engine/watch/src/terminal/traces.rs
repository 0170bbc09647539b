//! What the script's measures came to over a phase: not recorded, so played again bit by bit while nothing else is asked.

use super::story::part;
use engine::diagnostic::Result;
use engine::experiment::{Ledger, Phase, Plan, Playback};

/// Parts of a phase that are told apart; no terminal is wider.
const PARTS: usize = 512;
/// Steps that are played at once.
const AT_ONCE: usize = 200;

/// The mean of each measure in each of equal parts of a phase; nothing where no step gave a number.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MeasureTraces {
    parts: Vec<Vec<Option<f64>>>,
}

impl MeasureTraces {
    /// The least and the greatest mean of a measure; nothing if it never was a number.
    pub(super) fn range(&self, measure: usize) -> Option<[f64; 2]> {
        let known = self.parts.get(measure)?.iter().flatten();
        known.fold(None, |range: Option<[f64; 2]>, value| {
            let [least, most] = range.unwrap_or([*value; 2]);
            Some([least.min(*value), most.max(*value)])
        })
    }

    /// A measure in so many equal parts: how high each lies between its least and its greatest mean, 0 to 1.
    pub(super) fn heights(&self, measure: usize, parts: usize) -> Vec<Option<f64>> {
        let Some(([least, most], all)) = self.range(measure).zip(self.parts.get(measure)) else {
            return vec![None; parts];
        };
        let height = |index: usize| {
            let (from, to) = (index * all.len() / parts, ((index + 1) * all.len()).div_ceil(parts));
            let known: Vec<f64> = all.get(from..to.max(from + 1))?.iter().flatten().copied().collect();
            let mean = known.iter().sum::<f64>() / known.len().max(1) as f64;
            (!known.is_empty()).then(|| if most > least { (mean - least) / (most - least) } else { 0.5 })
        };
        (0..parts).map(height).collect()
    }
}

/// Sums of a phase that is played again.
pub(super) struct Tracer<'a> {
    playback: Playback<'a>,
    steps: usize,
    sums: Vec<Vec<(f64, u32)>>,
}

impl<'a> Tracer<'a> {
    /// Before the first step.
    ///
    /// # Errors
    /// If the plan does not work.
    pub(super) fn new(plan: &'a Plan, seed: u64, phase: Phase, ledger: &'a Ledger) -> Result<Self> {
        let (playback, steps) = (Playback::new(plan, seed, phase, ledger)?, ledger.len());
        let parts = PARTS.min(steps.max(1));
        Ok(Self { playback, steps, sums: vec![vec![(0.0, 0); parts]; plan.behaviour.measures().count()] })
    }

    /// Plays on until `newer` is true, or to the end: then the traces.
    ///
    /// # Errors
    /// If a step cannot be played again.
    pub(super) fn go_on(&mut self, newer: impl Fn() -> bool) -> Result<Option<MeasureTraces>> {
        while !newer() {
            for _ in 0..AT_ONCE {
                let step = self.playback.done();
                if self.playback.advance()?.is_none() {
                    return Ok(Some(self.traces()));
                }
                for (sums, value) in self.sums.iter_mut().zip(self.playback.cycle().measures()) {
                    let parts = sums.len();
                    let sum = &mut sums[part(step, self.steps, parts)];
                    if value.is_finite() {
                        *sum = (sum.0 + value, sum.1 + 1);
                    }
                }
            }
        }
        Ok(None)
    }

    fn traces(&self) -> MeasureTraces {
        let mean = |(sum, count): &(f64, u32)| (*count > 0).then(|| sum / f64::from(*count));
        MeasureTraces { parts: self.sums.iter().map(|sums| sums.iter().map(mean).collect()).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_trace_lies_between_its_least_and_its_greatest_mean() {
        let traces = MeasureTraces {
            parts: vec![vec![Some(1.0), Some(3.0), None, Some(5.0)], vec![Some(2.0); 4], vec![None; 4]],
        };
        assert_eq!((traces.range(0), traces.range(1), traces.range(2)), (Some([1.0, 5.0]), Some([2.0; 2]), None));
        assert_eq!(traces.heights(0, 4), [Some(0.0), Some(0.5), None, Some(1.0)]);
        // Two parts: the mean of 1 and 3 is a quarter of the way from 1 to 5.
        assert_eq!(traces.heights(0, 2), [Some(0.25), Some(1.0)]);
        assert_eq!(traces.heights(1, 2), [Some(0.5); 2]);
        assert_eq!((traces.heights(2, 2), traces.heights(7, 1)), (vec![None; 2], vec![None]));
        assert_eq!(traces.heights(0, 8).len(), 8);
    }
}
