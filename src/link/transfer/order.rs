//! The order of one transfer.

use crate::mission::VehicleMission;

/// A mission and the vehicle that must hold it.
#[derive(Clone, Debug)]
pub struct Order<'a> {
    /// Id in the spec.
    pub vehicle: &'a str,
    /// System id in the spec.
    pub sysid: u8,
    /// The mission to transfer.
    pub mission: &'a VehicleMission,
    /// Whether refusals are overridden.
    pub force: bool,
    /// System ids that others expect on the same link.
    pub others: Vec<u8>,
}
