//! Parameter files as ground stations load them.

use crate::mission::VehicleMission;
use crate::spec::Autopilot;

/// The parameters that the verdict assumes.
///
/// ArduPilot: `NAME,VALUE` lines with `#` comments. PX4: QGroundControl's table of
/// vehicle, component, name, value and `MAV_PARAM_TYPE` (6 int32, 9 float).
#[must_use]
pub fn write(mission: &VehicleMission) -> String {
    let mut text = String::from("# What the verdict on this mission assumes of the vehicle.\n");
    for note in &mission.notes {
        text.push_str(&format!("# Note: {}\n", note.replace(['\r', '\n'], " ")));
    }
    if mission.autopilot == Autopilot::Px4 {
        text.push_str("# Vehicle-Id Component-Id Name Value Type\n");
    }
    for parameter in &mission.params {
        let (name, value) = (&parameter.name, parameter.value);
        text.push_str(&match mission.autopilot {
            Autopilot::ArduPilot => format!("# {}\n{name},{value}\n", parameter.why),
            Autopilot::Px4 => {
                let kind = if is_int32(name) { 6 } else { 9 };
                format!("# {}\n1\t1\t{name}\t{value}\t{kind}\n", parameter.why)
            }
        });
    }
    text
}

/// PX4 parameters that are whole numbers; a loader refuses the other type.
fn is_int32(name: &str) -> bool {
    ["GF_ACTION"].contains(&name)
}
