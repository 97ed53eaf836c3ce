//! Items that both autopilots accept and interpret differently.
//!
//! [`crate::mission::problems`] reports items that one of them rejects. Sources: ArduPilot
//! `AP_Mission::mavlink_int_to_mission_cmd`; PX4 `mission_block.cpp`.

use crate::autopilot::command;
use crate::geodesy::LatLon;
use crate::mission::item::{Item, VehicleMission};

/// Something that the two autopilots interpret differently.
struct Difference {
    commands: &'static [u16],
    /// Whether an item of these makes a difference.
    matters: fn(&VehicleMission, &Item) -> bool,
    what: &'static str,
}

/// Commands with a place that is flown to.
const FLOWN_TO: &[u16] = &[
    command::NAV_WAYPOINT,
    command::NAV_SPLINE_WAYPOINT,
    command::NAV_LOITER_UNLIM,
    command::NAV_LOITER_TURNS,
    command::NAV_LOITER_TIME,
    command::NAV_LOITER_TO_ALT,
];
/// A place of a takeoff that is further from home is another one, metres.
const AWAY_M: f64 = 10.0;

static DIFFERENCES: &[Difference] = &[
    Difference {
        commands: &[
            command::NAV_WAYPOINT,
            command::NAV_LAND,
            command::NAV_TAKEOFF,
        ],
        matters: |_, item| item.params[3].is_finite(),
        what: "param4: PX4 turns to this heading (0 is north), ArduPilot leaves it out",
    },
    Difference {
        commands: &[command::NAV_WAYPOINT],
        matters: |_, item| is_set(item.params[1]),
        what: "param2: the acceptance radius for PX4, left out by ArduCopter",
    },
    Difference {
        commands: &[command::NAV_WAYPOINT],
        matters: |_, item| is_set(item.params[2]),
        what: "param3: ArduPlane passes by at this distance, PX4 does not keep it",
    },
    Difference {
        commands: &[command::DO_CHANGE_SPEED],
        matters: |_, item| item.params[0] > 1.0,
        what: "param1: climb or descent speed for ArduPilot, PX4 changes the horizontal speed only",
    },
    Difference {
        commands: &[command::NAV_RETURN_TO_LAUNCH],
        matters: |_, _| true,
        what: "returns at the altitude that the autopilot's own parameters say",
    },
    // `ModeAuto::loc_from_cmd`: under a centimetre is none.
    Difference {
        commands: FLOWN_TO,
        matters: |_, item| (item.z * 100.0).abs() < 1.0,
        what: "altitude 0: ArduPilot keeps the altitude that it has, PX4 flies at 0",
    },
    Difference {
        commands: FLOWN_TO,
        matters: |_, item| item.x == 0 && item.y == 0,
        what: "latitude and longitude 0: ArduPilot stays where it is, PX4 flies there",
    },
    Difference {
        commands: &[command::NAV_TAKEOFF],
        matters: is_away,
        what: "takes off at a place away from home: PX4 flies there, ArduPilot climbs where it stands",
    },
];

/// Whether an item has a place that is not home.
fn is_away(mission: &VehicleMission, item: &Item) -> bool {
    let home = LatLon::new(
        f64::from(mission.home.x) / 1e7,
        f64::from(mission.home.y) / 1e7,
    );
    let place = item.place().filter(|_| item.x != 0 || item.y != 0);
    (place.zip(home.ok())).is_some_and(|(place, home)| place.chord_m(home) > AWAY_M)
}

/// Neither 0 nor NaN.
fn is_set(value: f32) -> bool {
    value.is_finite() && value.abs() > 0.0
}

impl Difference {
    fn concerns(&self, mission: &VehicleMission, item: &Item) -> bool {
        self.commands.contains(&item.command) && (self.matters)(mission, item)
    }
}

/// The differences that a mission has, each with its items (from 1).
#[must_use]
pub fn read_differently(mission: &VehicleMission) -> Vec<(&'static str, Vec<usize>)> {
    let items = |difference: &Difference| -> Vec<usize> {
        let numbered = mission.items.iter().zip(1..);
        let concerned = numbered.filter(|(item, _)| difference.concerns(mission, item));
        concerned.map(|(_, number)| number).collect()
    };
    let all = DIFFERENCES
        .iter()
        .map(|difference| (difference.what, items(difference)));
    all.filter(|(_, items)| !items.is_empty()).collect()
}
