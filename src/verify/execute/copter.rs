//! Items as a copter reads them.

use super::item::{self, Order};
use crate::autopilot::Autopilot;
use crate::geodesy::Amsl;
use crate::mission::{Item, command};

/// What one item makes a copter do.
pub(crate) fn read(item: &Item, autopilot: Autopilot, home: Amsl) -> Result<Order, String> {
    if autopilot == Autopilot::ArduPilot {
        // `ModeAuto::start_command` goes on to the next command.
        match item.command {
            command if SKIPPED.contains(&command) => return Ok(Order::Nothing),
            // It stops at the waypoint before a command for which it cannot look ahead
            // (`ModeAuto::set_next_wp`). 0 hands over to no other computer.
            command if SKIPPED_AT_REST.contains(&command) => {
                return Ok(Order::Stop);
            }
            command::NAV_GUIDED_ENABLE if (0.0..1.0).contains(&item.params[0]) => {
                return Ok(Order::Stop);
            }
            _ => {}
        }
    }
    item::read(item, autopilot, home)
}

/// Commands that ArduCopter stores and does not start, or that set limits of another mode:
/// `DO_GO_AROUND`, `DO_PAUSE_CONTINUE`, `DO_SET_REVERSE`, `DO_INVERTED_FLIGHT`, `DO_GUIDED_LIMITS`.
const SKIPPED: [u16; 5] = [191, 193, 194, 210, 222];
/// Such commands that navigate elsewhere: `NAV_CONTINUE_AND_CHANGE_ALT`, `NAV_ALTITUDE_WAIT`,
/// `NAV_SET_YAW_SPEED`.
const SKIPPED_AT_REST: [u16; 3] = [30, 83, 213];
