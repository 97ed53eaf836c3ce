//! `sortie upload` and `sortie download`.

pub(super) mod download;
pub(super) mod fleet_transfer;
pub(super) mod upload;
