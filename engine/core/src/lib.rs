//! Learns robot behaviours that other people write as scripts: simulator, sensors, filters, states, learners, judging.
//!
//! Data goes one way, and the modules stand in its order:
//!
//! ```text
//!   world -> sensors -> filter -> state -> learner -> (action) -> robot -> world
//!                                   \-> judge: the rules of the script ->/
//! ```
//!
//! A [`script`] becomes an [`experiment::Plan`]; a plan is learned and tested under a seed, which is a pure function: the
//! same seed gives the same bytes.
//!
//! ```
//! use std::sync::{Arc, atomic::AtomicBool};
//!
//! use engine::diagnostic::SourceText;
//! use engine::experiment::{Overrides, Plan, learn, test};
//! use engine::script::Behaviour;
//!
//! let script = "world(\"room\");
//!     run(#{ steps: 400, test_steps: 100 });
//!     rule \"too close\" when laser.nearest <= 0.25 => -1 then recover;";
//! # let place = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scripts/close.rhai");
//! # /*
//! let place = "scripts/close.rhai"; // worlds are looked for beside it
//! # */
//! let behaviour = Behaviour::parse("close", SourceText::new(place, script))?;
//! let plan = Plan::new(Arc::new(behaviour), &Overrides::default())?;
//! let never = AtomicBool::new(false);
//! let learned = learn(&plan, 1, &never, &|_| ())?;
//! let tested = test(&plan, &learned.policy, 1, &never)?;
//! assert_eq!((learned.steps, tested.figures.steps), (400, 100));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Three traits are doors for what is not here: [`robot::Robot`], [`state::StateMap`] and [`learner::Learner`]. Whoever
//! chooses is an [`experiment::Chooser`], whatever looks on an [`experiment::Observer`]; [`experiment::drive`] is the one loop
//! that they meet in. Mistakes of users come back as [`diagnostic::Diagnostic`]: what, where, what to write instead.

#![deny(unsafe_code)] // but for filter/native/loaded.rs, where libraries are called

pub mod allowed;
pub mod diagnostic;
pub mod digest;
pub mod geometry;
pub mod outcome;
pub mod random;
pub mod saved;
pub mod settings;
pub mod stats;

pub mod world;

pub mod sensors;

pub mod filter;

pub mod state;

pub mod judge;

pub mod verdict;

pub mod script;

pub mod learner;

pub mod robot;

pub mod experiment;
