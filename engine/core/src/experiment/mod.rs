//! A run as a pure function of its plan and its seed: learning, then a test of the frozen policy.
//!
//! Nothing here prints, reads a clock or writes a file.

mod certainty;
mod combination;
mod cycle;
mod digest;
mod disagreement;
mod eyes;
mod learning;
mod ledger;
mod legs;
mod outlook;
mod parts;
mod plan;
mod playback;
mod reasons;
mod rescore;
mod seeds;
mod summary;
mod tally;
mod testing;
mod trail;
mod truth;

pub use certainty::CertaintyGrid;
pub use combination::Member;
pub use cycle::{Cycle, Step};
pub use disagreement::{CombinationFigures, Disagreement, DisagreementFigures, Disagreements, MemberFigures};
pub use eyes::Eyes;
pub use learning::{Learned, Learning, Progress, learn, learn_into};
pub use ledger::{Ledger, LedgerLeg, MOST_STEPS, Record, RecordShape};
pub use legs::Leg;
pub use plan::{Overrides, Plan};
pub use playback::{Phase, Playback};
pub use reasons::{FactReasons, PartReasons, RuleReasons, StateCells, StepReasons, beam_angle_deg};
pub use rescore::{Rescored, RuleChange, RuleScore, plan_with_rules_of, rescore};
pub use seeds::in_parallel;
pub use summary::{RuleTotal, Spread, Summary, TestFigures, learned_at};
pub use tally::{Tally, WINDOW_STEPS, Window};
pub use testing::{
    CombinedRun, Snapshot, TestRun, Watch, test, test_and_watch, test_choices, test_combined, test_into,
};
pub use trail::Trail;
pub use truth::{Spells, Truth};
