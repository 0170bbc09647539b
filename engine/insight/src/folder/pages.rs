//! `report.html`, beside every run: the page with all of the run in it.

use std::path::Path;

use super::SeedResult;
use crate::disk::write_atomic;
use crate::lint::Report;
use crate::page::{Document, Moments, SeedData, median_seed, page};
use crate::store::{LOG_FILE, RUN_FILE, read_log, read_stored};
use engine::diagnostic::{Diagnostic, Result};
use engine::experiment::{Ledger, Plan, RunLog};

/// Moments of each phase that the page shows in pictures.
const SHOTS: usize = 60;
/// Seeds whose steps can stand in one page.
const MOST_SEEDS: usize = 3;

/// The page in a run's folder.
pub(super) const PAGE_FILE: &str = "report.html";

/// Writes the page of a run; of many seeds, the median one and the worst bring their steps, from their logs in `logs`.
pub(super) fn write_page(
    folder: &Path,
    logs: &Path,
    plan: &Plan,
    results: &[SeedResult],
    checked: Option<&Report>,
) -> Result<()> {
    let mut order: Vec<usize> = (0..results.len()).collect();
    let failures = failures(results);
    order.sort_by(|a, b| failures[*b].total_cmp(&failures[*a]));
    order.truncate(MOST_SEEDS - 1);
    order.extend(median_seed(&failures, |_| true).filter(|median| !order.contains(median)));
    let mut read = Vec::new();
    for index in order {
        if results[index].log.is_none() {
            let seed = results[index].run.summary.seed;
            // The page of one seed of many stands in the seed's own folder.
            let own = if results.len() == 1 { logs.to_owned() } else { logs.join(seed.to_string()) };
            let mut log = read_back(&own, plan, seed)?;
            log.learning.set_out_from(&plan.kept_before(seed)?);
            log.test.set_out_from(results[index].run.learned.as_ref().map_or(&[], |learned| learned.policy.kept()));
            read.push((index, log));
        }
    }
    let none = Ledger::off();
    let data: Vec<SeedData<'_>> = (results.iter().enumerate())
        .map(|(index, SeedResult { run, log })| {
            let log = log.as_ref().or_else(|| read.iter().find(|(at, _)| *at == index).map(|(_, log)| log));
            SeedData {
                seed: run.summary.seed,
                tally: run.learned.as_ref().map(|learned| &learned.tally),
                policy: run.learned.as_ref().map(|learned| &learned.policy),
                test: Some(&run.summary.test),
                lines: Some(&run.summary.base_lines),
                learning: log.map_or(&none, |log| &log.learning),
                tested: log.map_or(&none, |log| &log.test),
            }
        })
        .collect();
    let mut document = Document::new(plan, &data, Moments { shots: SHOTS, scans: true, seeds: None })?;
    if let Some(report) = checked {
        document = document.with_check(report);
    }
    write_atomic(&folder.join(PAGE_FILE), page(Some(&document))?.html.as_bytes())
}

/// Failures of each seed in 1,000 steps of its test.
pub(super) fn failures(results: &[SeedResult]) -> Vec<f64> {
    results.iter().map(|result| result.run.summary.test.failures_per_1000).collect()
}

/// The log that a seed of many left in its folder.
fn read_back(folder: &Path, plan: &Plan, seed: u64) -> Result<RunLog> {
    let path = folder.join(LOG_FILE);
    let bytes = std::fs::read(&path).map_err(|error| Box::new(Diagnostic::disk("read", &path, &error)))?;
    read_log(&bytes, plan, seed, &read_stored(&folder.join(RUN_FILE))?.text)
}
