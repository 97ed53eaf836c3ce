//! Items as a copter reads them.

use super::item::{self, Order};
use crate::autopilot::Autopilot;
use crate::geodesy::Amsl;
use crate::mission::{Item, VehicleMission, command};

/// What one item makes a copter do.
pub(crate) fn read(item: &Item, mission: &VehicleMission, home: Amsl) -> Result<Order, String> {
    let skips = mission.facts().skips;
    let is_ardupilot = mission.autopilot == Autopilot::ArduPilot;
    match item.command {
        command if skips.passing.contains(&command) => Ok(Order::Nothing),
        command if skips.at_rest.contains(&command) => Ok(Order::Stop),
        // 0 hands over to no other computer.
        command::NAV_GUIDED_ENABLE if is_ardupilot && (0.0..1.0).contains(&item.params[0]) => {
            Ok(Order::Stop)
        }
        _ => item::read(item, mission.autopilot, home),
    }
}
