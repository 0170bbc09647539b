//! `report.html`, beside every run: the page with all of the run in it.

use std::path::Path;

use engine::diagnostic::{Diagnostic, Result};
use engine::experiment::{Ledger, Plan};
use insight::lint::Report;
use insight::page::{Document, Moments, SeedData, page};
use insight::report::write_atomic;
use insight::store::{LOG_FILE, RunLog, read_log, read_stored};

use super::folder::SeedResult;

/// Moments of each phase that the page shows in pictures.
const SHOTS: usize = 60;
/// Seeds whose steps can stand in one page.
const MOST_SEEDS: usize = 3;

/// Writes the page of a run that learned; of many seeds, the worst bring their steps.
pub(super) fn write_page(folder: &Path, plan: &Plan, results: &[SeedResult], checked: Option<&Report>) -> Result<()> {
    let mut order: Vec<usize> = (0..results.len()).collect();
    order.sort_by(|a, b| {
        let failures = |index: usize| results[index].summary.test.failures_per_1000;
        failures(*b).total_cmp(&failures(*a))
    });
    order.truncate(MOST_SEEDS);
    let mut read = Vec::new();
    for index in order {
        if results[index].log.is_none() {
            let seed = results[index].summary.seed;
            read.push((index, read_back(&folder.join(seed.to_string()), plan, seed)?));
        }
    }
    let none = Ledger::off();
    let data = results.iter().enumerate().map(|(index, result)| {
        let log = result.log.as_ref().or_else(|| read.iter().find(|(at, _)| *at == index).map(|(_, log)| log));
        SeedData {
            seed: result.summary.seed,
            tally: Some(&result.learned.tally),
            policy: Some(&result.learned.policy),
            test: Some(&result.tested.figures),
            learning: log.map_or(&none, |log| &log.learning),
            tested: log.map_or(&none, |log| &log.test),
        }
    });
    write(folder, plan, &data.collect::<Vec<_>>(), checked)
}

/// Writes the page of what is known of some seeds.
pub(super) fn write(folder: &Path, plan: &Plan, seeds: &[SeedData<'_>], checked: Option<&Report>) -> Result<()> {
    let mut document = Document::new(plan, seeds, Moments { shots: SHOTS, scans: true, seeds: None })?;
    if let Some(report) = checked {
        document = document.with_check(report);
    }
    write_atomic(&folder.join("report.html"), page(Some(&document))?.html.as_bytes())
}

/// The log that a seed of many left in its folder.
fn read_back(folder: &Path, plan: &Plan, seed: u64) -> Result<RunLog> {
    let path = folder.join(LOG_FILE);
    let bytes = std::fs::read(&path).map_err(|error| Box::new(Diagnostic::disk("read", &path, &error)))?;
    read_log(&bytes, plan, seed, &read_stored(&folder.join("run.toml"))?.text)
}
