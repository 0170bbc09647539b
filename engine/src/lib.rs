//! A fixed engine that learns robot behaviours which other people write as scripts.
#![doc = ""]
pub mod diagnostic;
pub mod filter;
pub mod geometry;
pub mod learner;
pub mod random;
pub mod settings;
pub mod state;
pub mod world {
    //! TRUTH.
    pub mod scene;
}
pub mod sensors {
    //! SENSE.
    pub mod observation;
}
pub mod reward {
    //! JUDGE.
    pub mod facts;
}
