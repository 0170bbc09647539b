//! Native rules and interpreted ones give the same, and cost what they may.
