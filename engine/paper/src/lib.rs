//! The paper's figures and claims beside what is measured here.
//!
//! [`CLAIMS`] is one table of data: what was claimed, which jobs measure it, by which rule it is judged. [`Campaign`]
//! does every distinct job once, [`rows`] judges, [`figures`] draws, [`page`] and [`markdown`] write.

mod campaign;
mod claims;
mod commands;
mod figures;
mod job;
mod looks;
mod markdown;
mod page;
mod row;
mod strip;
mod verdict;

pub use campaign::{Campaign, JobResult, Measured, Options, Outcome};
pub use claims::{CLAIMS, Claim};
pub use figures::{Figure, figures};
pub use job::{Learn, Metric, Trial};
pub use looks::{Look, Seen};
pub use markdown::markdown;
pub use page::page;
pub use row::{Reproduction, Row, rows};
pub use verdict::{RowSpread, Rule, Verdict};

#[cfg(test)]
mod tests;
