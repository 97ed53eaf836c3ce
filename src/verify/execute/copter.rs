//! Items as a copter reads them.

use super::item::{self, Order};
use crate::autopilot::Autopilot;
use crate::geodesy::Amsl;
use crate::mission::{Item, VehicleMission, command};

/// `MissionBlock::is_mission_item_reached_or_completed` of PX4, as of January 2026: it comes at the altitude that it
/// has, and the radius counts on rotors too.
const PX4_LOITER_TO_ALT: &str = "NAV_LOITER_TO_ALT on a copter of PX4 is not modelled: within its radius \
     (NAV_LOITER_RAD, 80 m, unless it has one) it climbs or descends, and goes on from wherever it is then";

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
        command::NAV_LOITER_TO_ALT if !is_ardupilot => Err(PX4_LOITER_TO_ALT.to_owned()),
        _ => item::read(item, mission.autopilot, home),
    }
}
