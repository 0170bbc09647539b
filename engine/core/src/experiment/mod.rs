//! A run as a pure function of its plan and its seed: learning, then a test of the frozen policy.
//!
//! Nothing here prints, reads a clock or writes a file.

mod base_lines;
mod by_world;
mod carrying;
mod certainty;
mod certify;
mod changes;
mod checkpoints;
mod choosers;
mod co_driver;
mod combination;
mod course;
mod cycle;
mod digest;
mod disagreement;
mod doors;
mod drive;
mod eyes;
mod learning;
mod ledger;
mod legs;
mod measured;

mod origin;
mod outlook;
mod parts;
mod plan;
mod plan_worlds;
mod playback;
mod probes;
mod reasons;
mod recall;
mod recorded_movers;
mod relay;
mod rescore;
mod run_log;
mod seed_run;
mod seeds;
mod sight;
mod snapshot;
mod spells;
mod staged;
mod step;
mod summary;
mod tally;
mod telling;
mod testing;
mod trail;
mod truth;
mod use_figures;
mod used;

pub use base_lines::{base_lines, test_untrained};
pub use by_world::WorldFigures;
pub use carrying::rejudge;
pub use certainty::CertaintyGrid;
pub use certify::{
    Aim, Asked, Certificate, CertifiedRate, CertifiedShare, DRAWS, HardDraw, MOST_DRAWS, certify, count_bounds,
    rate_bounds, share_bounds,
};
pub use checkpoints::{Checkpoints, Kept};
pub use choosers::{ByState, Frozen, Learns};
use choosers::{Recorded, Together};
pub use co_driver::Hand;
pub use combination::Member;
pub use cycle::Cycle;
pub use disagreement::{CombinationFigures, Disagreement, DisagreementFigures, Disagreements, MemberFigures};
pub use drive::{Choice, Chooser, Each, Observer, drive};
pub use eyes::{Eyes, ViewStage};
pub use learning::{BrokenOff, Learned, Learning, Progress, learn, learn_into, learn_kept};
pub use ledger::{Attempt, Ledger, LedgerLeg, MOST_STEPS, PassedOn, Record, RecordShape, Segment, StoredSegments};
pub use legs::Leg;

pub use origin::Origin;
pub use plan::{Overrides, Plan};
pub use playback::{Phase, Playback};
pub use reasons::{FactReasons, GuardReasons, PartReasons, RuleReasons, StateCells, StepReasons, UseReasons};
pub use recall::{Recall, TryReasons, ValueLink, ValueReasons};
pub use recorded_movers::RecordedMovers;
pub use rescore::{Rescored, RuleChange, RuleScore, plan_with_rules_of, rescore};
pub use run_log::{CHUNK_STEPS, DIGEST_BYTES, RunLog, chained};
pub use seed_run::{SeedRun, run_only_seed, run_seed, run_seed_kept};
pub use seeds::in_parallel;
pub use sight::Sight;
pub use snapshot::{SeenView, Snapshot};
pub use step::Step;
pub use summary::{ConditionSpread, FigureSpread, FromRun, Spread, StartJoined, Summary};
pub use tally::Tally;
pub use testing::{CombinationTest, Decider, TestRun, frozen, test, test_and_watch, test_choices, test_robot};
pub use trail::Trail;

pub use use_figures::UseFigures;
pub use used::UsedPolicy;

pub use crate::verdict::WINDOW_STEPS;
