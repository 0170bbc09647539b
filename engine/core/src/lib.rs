//! A fixed engine that learns robot behaviours which other people write as scripts.
//!
//! Data goes one way, and the rooms stand in its order:
//!
//! ```text
//!   world -> sensors -> filter -> state -> learner -> (action) -> robot -> world
//!                                   \-> judge: the rules of the script ->/
//! ```
//!
//! `experiment` is the loop around them, `store` and `report` are what a run leaves, `settings`, `diagnostic`, `digest`,
//! `stats`, `random` and `geometry` are what all share. ARCHITECTURE.md says what each room never knows.

#![deny(unsafe_code)] // but for filter/native.rs, where libraries are called

pub mod diagnostic;
pub mod digest;
pub mod geometry;
pub mod random;
pub mod saved;
pub mod settings;
pub mod stats;

pub mod world;

pub mod sensors;

pub mod filter;

pub mod state;

pub mod judge;

pub mod script;

pub mod learner;

pub mod robot;

pub mod experiment;
