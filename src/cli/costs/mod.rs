//! Costs of candidates, and proofs that none is lower.

pub(super) mod certify;
pub(super) mod evaluate;
