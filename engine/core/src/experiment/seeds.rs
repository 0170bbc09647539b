//! Many seeds over the cores.

use rayon::prelude::*;

use crate::diagnostic::{Diagnostic, Result};

/// Runs `job` for every seed on at most `threads` threads (0: one for each core). Results keep the order of the seeds,
/// and no job knows of another, so the number of threads changes nothing but the time.
///
/// # Errors
/// The first seed's error, if any failed.
pub fn in_parallel<T: Send>(seeds: &[u64], threads: usize, job: impl Fn(u64) -> Result<T> + Sync) -> Result<Vec<T>> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|error| Box::new(Diagnostic::new("E-THREADS", format!("cannot start {threads} threads: {error}"))))?;
    let results: Vec<Result<T>> = pool.install(|| seeds.par_iter().map(|seed| job(*seed)).collect());
    results.into_iter().collect()
}
