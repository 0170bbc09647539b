//! What a document holds, by hand-computed steps.
