//! The fast kernel: many candidates side by side, one in each vector lane.

pub(super) mod batch;
pub(super) mod block;
pub(super) mod boxes;
pub(super) mod exposure;
pub(super) mod lanes;
pub(super) mod limits;
pub(super) mod operational;
pub(super) mod paper;
pub(super) mod scratch;
pub(super) mod threats;
pub(super) mod turns;
