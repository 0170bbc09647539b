//! Verdicts: computed from numbers by a rule that stands beside the claim.

use engine::stats::Sorted;
use serde::Serialize;

/// What came of a claim.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// As the paper says.
    Reproduced,
    /// Better than the paper says.
    Better,
    /// Not as good as the paper says.
    Worse,
    /// Numbers that do not answer the claim.
    NotComparable,
    /// A script or a world is missing, or every seed failed.
    NotMeasured,
}

impl Verdict {
    /// The word for people.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Reproduced => "reproduced",
            Self::Better => "better",
            Self::Worse => "worse",
            Self::NotComparable => "not comparable",
            Self::NotMeasured => "not measured",
        }
    }
}

/// The rule by which numbers become a verdict.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Rule {
    /// The size of the median is within a factor of the paper's: reproduced; smaller still: better; else worse.
    Near(f64, f64),
    /// The median is at most this far from the paper's: reproduced; else worse.
    Within(f64, f64),
    /// The median is at most this: reproduced; else worse.
    AtMost(f64),
    /// The median is at least this: reproduced; else worse.
    AtLeast(f64),
    /// At least this share of the seeds is good: reproduced; else worse.
    Share(f64),
    /// At least this share of the seeds is not good, as the paper says: reproduced; else better.
    Loses(f64),
    /// The median is at most the reference's plus this: reproduced; else worse.
    NoWorse(f64),
    /// The median is above the reference's by more than this, as the paper says of a loss: reproduced; else better.
    Degrades(f64),
    /// The median is the reference's or more, and this share of the seeds learned: reproduced; below it: better.
    Slower(f64),
    /// Fewer steps than the reference or more seeds that learned, and neither the other way round: better; neither:
    /// worse; one of each: not comparable.
    Beats,
    /// The numbers do not answer the claim.
    None,
}

/// Numbers of all seeds.
#[derive(Debug, Clone, PartialEq)]
pub struct RowSpread {
    /// By seed, in the order of the seeds; infinite stands for never.
    pub values: Vec<f64>,
    /// How many are good.
    pub good: usize,
    low_is_good: bool,
}

impl RowSpread {
    /// The spread of all values that are numbers; `None` without any.
    #[must_use]
    pub fn new(values: &[f64], good: impl Fn(f64) -> bool, low_is_good: bool) -> Option<Self> {
        let values: Vec<f64> = values.iter().copied().filter(|value| !value.is_nan()).collect();
        let count = values.iter().filter(|value| good(**value)).count();
        (!values.is_empty()).then_some(Self { values, good: count, low_is_good })
    }

    /// The value that this share of the seeds stays below; the upper one of two in the middle. 0 to 1.
    #[must_use]
    pub fn quantile(&self, share: f64) -> f64 {
        // There is at least one value.
        self.values.iter().copied().collect::<Sorted>().upper_quantile(share).unwrap_or(f64::NAN)
    }

    /// The upper median.
    #[must_use]
    pub fn median(&self) -> f64 {
        self.quantile(0.5)
    }

    /// The worst seed's value.
    #[must_use]
    pub fn worst(&self) -> f64 {
        self.quantile(if self.low_is_good { 1.0 } else { 0.0 })
    }

    /// The share of good seeds.
    #[must_use]
    pub fn share(&self) -> f64 {
        self.good as f64 / self.values.len() as f64
    }

    fn beats(&self, reference: &Self) -> Verdict {
        let (fewer, more) = (self.median() < reference.median(), self.share() > reference.share());
        let (later, less) = (self.median() > reference.median(), self.share() < reference.share());
        match (fewer || more, later || less) {
            (true, false) => Verdict::Better,
            (true, true) => Verdict::NotComparable,
            (false, _) => Verdict::Worse,
        }
    }
}

impl Rule {
    /// The verdict on numbers, and on those that they are compared with.
    #[must_use]
    pub fn judge(self, ours: &RowSpread, reference: Option<&RowSpread>) -> Verdict {
        let median = ours.median();
        let or_worse = |fine: bool| if fine { Verdict::Reproduced } else { Verdict::Worse };
        let compared = |rule: &dyn Fn(f64) -> Verdict| reference.map_or(Verdict::NotComparable, |r| rule(r.median()));
        match self {
            Self::Near(paper, factor) if median.abs() < paper.abs() / factor => Verdict::Better,
            Self::Near(paper, factor) => or_worse(median.abs() <= paper.abs() * factor),
            Self::Within(paper, margin) => or_worse((median - paper).abs() <= margin),
            Self::AtMost(limit) => or_worse(median <= limit),
            Self::AtLeast(limit) => or_worse(median >= limit),
            Self::Share(share) => or_worse(ours.share() >= share),
            Self::Loses(share) if 1.0 - ours.share() < share => Verdict::Better,
            Self::Loses(_) => Verdict::Reproduced,
            Self::NoWorse(margin) => compared(&|reference| or_worse(median <= reference + margin)),
            Self::Degrades(margin) => compared(&|reference| {
                if median > reference + margin { Verdict::Reproduced } else { Verdict::Better }
            }),
            Self::Slower(_) if reference.is_some_and(|reference| median < reference.median()) => Verdict::Better,
            Self::Slower(share) => compared(&|_| or_worse(ours.share() >= share)),
            Self::Beats => reference.map_or(Verdict::NotComparable, |reference| ours.beats(reference)),
            Self::None => Verdict::NotComparable,
        }
    }

    /// The rule in words.
    #[must_use]
    pub fn words(self) -> String {
        match self {
            Self::Near(paper, factor) => {
                format!("reproduced within a factor of {factor} of {paper}, better below that")
            }
            Self::Within(paper, 0.0) => format!("reproduced if the median is {paper}"),
            Self::Within(paper, margin) => format!("reproduced if the median is within {margin} of {paper}"),
            Self::AtMost(limit) => format!("reproduced if the median is at most {limit}"),
            Self::AtLeast(limit) => format!("reproduced if the median is at least {limit}"),
            Self::Share(share) => format!("reproduced if that holds for {:.0} % of the seeds", 100.0 * share),
            Self::Loses(share) => {
                format!("reproduced if {:.0} % of the seeds or more do not manage, else better", 100.0 * share)
            }
            Self::NoWorse(0.0) => "reproduced if the median is no more than the reference's".to_owned(),
            Self::NoWorse(margin) => format!("reproduced if the median is at most {margin} above the reference's"),
            Self::Degrades(margin) => {
                format!("the loss is reproduced if the median is more than {margin} above the reference's, else better")
            }
            Self::Slower(share) => format!(
                "reproduced if the median is no earlier than the reference's and {:.0} % of the seeds learn; better if earlier",
                100.0 * share
            ),
            Self::Beats => {
                "better if fewer steps or more seeds that learn, and neither the other way round; worse if neither"
                    .to_owned()
            }
            Self::None => "no number here answers it".to_owned(),
        }
    }
}
