//! One row for each claim: numbers, verdict, reason, command.

use serde::Serialize;

use insight::words::with_commas;

use super::campaign::{JobResult, Measured, Options, QUICK};
use super::claims::Claim;
use super::commands::command;
use super::job::{Learn, Metric, Trial};
use super::verdict::{RowSpread, Verdict};

/// All rows, as `reproduce.json` holds them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Reproduction {
    /// The first seed.
    pub seed: u64,
    /// How many seeds, for jobs without a limit of their own.
    pub seeds: u64,
    /// True for a quick check, in which no verdict means anything.
    pub quick: bool,
    /// A row for every claim.
    pub rows: Vec<Row>,
}

/// One claim beside what was measured.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// The short name.
    pub id: &'static str,
    /// The section of the paper; "-" is ours.
    pub section: &'static str,
    /// The claim.
    pub claim: &'static str,
    /// The paper's number.
    pub paper: &'static str,
    /// Our numbers; null if nothing was measured.
    pub ours: Option<Numbers>,
    /// The numbers that it is compared with; null without a reference.
    pub reference: Option<Numbers>,
    /// The verdict.
    pub verdict: Verdict,
    /// The rule behind it.
    pub rule: String,
    /// A sentence that says why.
    pub reason: String,
    /// The command that gives this row.
    pub command: String,
}

/// Numbers over the seeds. Null stands for never.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Numbers {
    /// The unit.
    pub unit: &'static str,
    /// The upper median.
    pub median: Option<f64>,
    /// The lower quartile.
    pub quartile_low: Option<f64>,
    /// The upper quartile.
    pub quartile_high: Option<f64>,
    /// The worst seed.
    pub worst: Option<f64>,
    /// How many seeds are good.
    pub good: usize,
    /// Of how many.
    pub seeds: usize,
    /// What good means.
    pub good_means: &'static str,
    /// By seed.
    pub values: Vec<Option<f64>>,
    /// For people: the median, or the share of good seeds.
    pub text: String,
}

/// Judges every claim that was asked for.
#[must_use]
pub fn rows(measured: &Measured) -> Reproduction {
    let Options { seed, seeds, quick, .. } = measured.options;
    // As many as were really run.
    let seeds = if quick { seeds.min(QUICK.0) } else { seeds };
    Reproduction { seed, seeds, quick, rows: measured.options.claims().map(|claim| row(claim, measured)).collect() }
}

fn row(claim: &Claim, measured: &Measured) -> Row {
    let found = spread(measured, claim.metric, claim.learn, claim.trial);
    let reference = claim.against.map(|(learn, trial)| spread(measured, claim.metric, learn, trial));
    let (verdict, ours, reference, reason) = match (found, reference) {
        (Err(reason), _) | (Ok(_), Some(Err(reason))) => (reason.0, None, None, reason.1),
        (Ok(ours), reference) => {
            let reference = reference.and_then(Result::ok);
            let verdict = claim.rule.judge(&ours, reference.as_ref());
            let (numbers, reference) = (numbers(claim.metric, &ours), reference.map(|r| numbers(claim.metric, &r)));
            let reason = reason(claim, &numbers, reference.as_ref(), measured);
            (verdict, Some(numbers), reference, reason)
        }
    };
    Row {
        id: claim.id,
        section: claim.section,
        claim: claim.said,
        paper: claim.paper,
        ours,
        reference,
        verdict,
        rule: claim.rule.words(),
        reason,
        command: command(claim, &measured.options),
    }
}

type Missing = (Verdict, String);

fn spread(measured: &Measured, metric: Metric, learn: Learn, trial: Option<Trial>) -> Result<RowSpread, Missing> {
    let none = |reason: &str| (Verdict::NotMeasured, sentence(reason));
    let job = measured.job(learn).ok_or_else(|| none("it was not asked for"))?;
    let plan = job.plan.as_ref().map_err(|reason| none(reason))?;
    let at = trial.and_then(|trial| job.trials.iter().position(|(known, _)| *known == trial));
    if let Some((_, Err(reason))) = at.map(|at| &job.trials[at]) {
        return Err(none(reason));
    }
    let states = plan.grid().map_err(|error| none(&error.message))?.states();
    let values = values(job, metric, states, at);
    let manner = metric.manner();
    RowSpread::new(&values, |value| metric.good(value).0, manner.low_is_good)
        .ok_or_else(|| (Verdict::NotComparable, "No seed met what this number is about.".to_owned()))
}

fn values(job: &JobResult, metric: Metric, states: usize, trial: Option<usize>) -> Vec<f64> {
    let value = |outcome: &super::campaign::Outcome| match trial {
        None => metric.of(&outcome.summary, states, &outcome.tested.figures, None),
        Some(at) => match &outcome.trials[at] {
            Some((figures, seen)) => metric.of(&outcome.summary, states, figures, Some(seen)),
            None => f64::NAN,
        },
    };
    job.outcomes.iter().map(value).collect()
}

fn numbers(metric: Metric, spread: &RowSpread) -> Numbers {
    let manner = metric.manner();
    let finite = |value: f64| value.is_finite().then_some(value);
    let (good, seeds) = (spread.good, spread.values.len());
    let text = match metric {
        Metric::NeverLost => format!("{good} of {seeds}"),
        _ if spread.median().is_infinite() => shown(spread.median(), 0),
        _ => format!("{} {}", shown(spread.median(), manner.decimals), manner.unit).trim_end().to_owned(),
    };
    Numbers {
        unit: manner.unit,
        median: finite(spread.median()),
        quartile_low: finite(spread.quantile(0.25)),
        quartile_high: finite(spread.quantile(0.75)),
        worst: finite(spread.worst()),
        good,
        seeds,
        good_means: metric.good(spread.median()).1,
        values: spread.values.iter().map(|value| finite(*value)).collect(),
        text,
    }
}

/// A number for people; infinite is never.
pub(super) fn shown(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        return "never".to_owned();
    }
    with_commas(value, decimals)
}

fn reason(claim: &Claim, ours: &Numbers, reference: Option<&Numbers>, measured: &Measured) -> String {
    let mut text = match claim.metric {
        Metric::NeverLost => format!("{} of {} seeds were {}", ours.good, ours.seeds, ours.good_means),
        Metric::LearnedAt | Metric::LastWindows | Metric::Failures | Metric::NetSpeed => {
            format!("Median {}; {} of {} seeds {}", ours.text, ours.good, ours.seeds, ours.good_means)
        }
        _ => format!("Median {} over {} seeds", ours.text, ours.seeds),
    };
    if let Some(reference) = reference {
        text.push_str(&format!("; the reference has {}", reference.text));
        if claim.metric == Metric::LearnedAt {
            text.push_str(&format!(", {} of {} seeds", reference.good, reference.seeds));
        }
    }
    if matches!(claim.metric, Metric::CommonestChoice | Metric::CommonerSide) {
        let [left, ahead, right] = choices(claim, measured);
        text.push_str(&format!("; all seeds went left {left}, straight on {ahead} and right {right} times"));
    }
    text.push('.');
    if !claim.note.is_empty() {
        text.push(' ');
        text.push_str(claim.note);
    }
    text
}

fn choices(claim: &Claim, measured: &Measured) -> [u64; 3] {
    let mut all = [0; 3];
    let Some(job) = measured.job(claim.learn) else { return all };
    let at = job.trials.iter().position(|(trial, _)| Some(*trial) == claim.trial);
    for (_, seen) in job.outcomes.iter().filter_map(|outcome| outcome.trials.get(at?)?.as_ref()) {
        for (sum, count) in all.iter_mut().zip(seen.choices) {
            *sum += count;
        }
    }
    all
}

/// With a capital letter and a full stop.
fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().map(|first| first.to_uppercase().to_string()).unwrap_or_default();
    format!("{first}{}.", letters.as_str().trim_end_matches('.'))
}
