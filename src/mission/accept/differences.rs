//! Parameters that both autopilots accept and interpret differently.
//!
//! [`crate::mission::problems`] reports items that one of them rejects. Sources: ArduPilot
//! `AP_Mission::mavlink_int_to_mission_cmd`; PX4 `mission_block.cpp`.

use crate::autopilot::command;
use crate::mission::item::{Item, VehicleMission};

/// A parameter that the two autopilots interpret differently.
struct Difference {
    commands: &'static [u16],
    /// From 0; none for the command as a whole.
    param: Option<usize>,
    /// Whether a value makes a difference.
    matters: fn(f32) -> bool,
    what: &'static str,
}

static DIFFERENCES: &[Difference] = &[
    Difference {
        commands: &[
            command::NAV_WAYPOINT,
            command::NAV_LAND,
            command::NAV_TAKEOFF,
        ],
        param: Some(3),
        matters: f32::is_finite,
        what: "param4: PX4 turns to this heading (0 is north), ArduPilot leaves it out",
    },
    Difference {
        commands: &[command::NAV_WAYPOINT],
        param: Some(1),
        matters: is_set,
        what: "param2: the acceptance radius for PX4, left out by ArduCopter",
    },
    Difference {
        commands: &[command::NAV_WAYPOINT],
        param: Some(2),
        matters: is_set,
        what: "param3: ArduPlane passes by at this distance, PX4 does not keep it",
    },
    Difference {
        commands: &[command::DO_CHANGE_SPEED],
        param: Some(0),
        matters: |kind| kind > 1.0,
        what: "param1: climb or descent speed for ArduPilot, PX4 changes the horizontal speed only",
    },
    Difference {
        commands: &[command::NAV_RETURN_TO_LAUNCH],
        param: None,
        matters: |_| true,
        what: "returns at the altitude that the autopilot's own parameters say",
    },
];

/// Neither 0 nor NaN.
fn is_set(value: f32) -> bool {
    value.is_finite() && value.abs() > 0.0
}

impl Difference {
    fn concerns(&self, item: &Item) -> bool {
        let value = self.param.map_or(0.0, |index| item.params[index]);
        self.commands.contains(&item.command) && (self.matters)(value)
    }
}

/// The differences that a mission has, each with its items (from 1).
#[must_use]
pub fn read_differently(mission: &VehicleMission) -> Vec<(&'static str, Vec<usize>)> {
    let items = |difference: &Difference| -> Vec<usize> {
        let numbered = mission.items.iter().zip(1..);
        let concerned = numbered.filter(|(item, _)| difference.concerns(item));
        concerned.map(|(_, number)| number).collect()
    };
    let all = DIFFERENCES
        .iter()
        .map(|difference| (difference.what, items(difference)));
    all.filter(|(_, items)| !items.is_empty()).collect()
}
