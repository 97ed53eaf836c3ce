//! `sortie upload` and `sortie download`.

pub(super) mod delivery;
pub(super) mod download;
pub(super) mod upload;
