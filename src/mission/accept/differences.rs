//! What both autopilots take and each reads in its own way.
//!
//! What one of them refuses is told by [`crate::mission::problems`]. Sources: ArduPilot
//! `AP_Mission::mavlink_int_to_mission_cmd`; PX4 `mission_block.cpp`.

use crate::mission::item::{Item, VehicleMission, command};

/// A parameter that the two read differently.
struct Reading {
    commands: &'static [u16],
    /// From 0; none for the command as a whole.
    param: Option<usize>,
    /// At which values it matters.
    matters: fn(f32) -> bool,
    what: &'static str,
}

static READINGS: &[Reading] = &[
    Reading {
        commands: &[
            command::NAV_WAYPOINT,
            command::NAV_LAND,
            command::NAV_TAKEOFF,
        ],
        param: Some(3),
        matters: f32::is_finite,
        what: "param4: PX4 turns to this heading (0 is north), ArduPilot leaves it out",
    },
    Reading {
        commands: &[command::NAV_WAYPOINT],
        param: Some(1),
        matters: says_something,
        what: "param2: the acceptance radius for PX4, left out by ArduCopter",
    },
    Reading {
        commands: &[command::NAV_WAYPOINT],
        param: Some(2),
        matters: says_something,
        what: "param3: ArduPlane passes by at this distance, PX4 does not keep it",
    },
    Reading {
        commands: &[command::DO_CHANGE_SPEED],
        param: Some(0),
        matters: |kind| kind > 1.0,
        what: "param1: climb or descent speed for ArduPilot, PX4 changes the horizontal speed only",
    },
    Reading {
        commands: &[command::NAV_RETURN_TO_LAUNCH],
        param: None,
        matters: |_| true,
        what: "returns at the altitude that the autopilot's own parameters say",
    },
];

/// Neither 0 nor NaN: something is asked for.
fn says_something(value: f32) -> bool {
    value.is_finite() && value.abs() > 0.0
}

impl Reading {
    fn concerns(&self, item: &Item) -> bool {
        let value = self.param.map_or(0.0, |index| item.params[index]);
        self.commands.contains(&item.command) && (self.matters)(value)
    }
}

/// What means one thing to ArduPilot and another to PX4, each with its items (from 1).
#[must_use]
pub fn read_differently(mission: &VehicleMission) -> Vec<(&'static str, Vec<usize>)> {
    let items = |reading: &Reading| -> Vec<usize> {
        let numbered = mission.items.iter().zip(1..);
        let concerned = numbered.filter(|(item, _)| reading.concerns(item));
        concerned.map(|(_, number)| number).collect()
    };
    let all = READINGS
        .iter()
        .map(|reading| (reading.what, items(reading)));
    all.filter(|(_, items)| !items.is_empty()).collect()
}
