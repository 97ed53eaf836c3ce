//! Sans-IO machines that transfer mission, fence and rally lists, and verify them by read-back.

pub(super) mod clear;
pub(super) mod compare;
pub(super) mod discovery;
pub(super) mod download;
pub(super) mod expected;
pub(super) mod identity;
pub(super) mod onboard;
pub(super) mod order;
pub(super) mod report;
pub(super) mod session;
pub(super) mod state_machine;
pub(super) mod upload;
