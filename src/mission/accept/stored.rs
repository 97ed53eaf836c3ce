//! Circles and times that `ArduPilot` stores otherwise than they were sent: `AP_Mission` packs turns and radius
//! of `NAV_LOITER_TURNS` into one byte each, and holds in 16 bits.

use crate::autopilot::{Airframe, Autopilot, command};
use crate::mission::item::VehicleMission;

/// Largest value of a byte.
const MAX_BYTE: f64 = 255.0;
/// Parts of a turn that are stored below one turn.
const PARTS: f64 = 256.0;

/// The turns that are stored: whole ones up to 255, or 256ths of one.
#[must_use]
pub fn stored_turns(turns: f64) -> f64 {
    match turns {
        part if part < 1.0 => (PARTS * part).trunc() / PARTS,
        whole => whole.trunc().min(MAX_BYTE),
    }
}

/// The radius that is stored, with its sign: whole metres up to 255, or tens of metres up to 2550.
#[must_use]
pub fn stored_radius_m(radius_m: f64) -> f64 {
    let stored_m = match radius_m.abs() {
        near if near <= MAX_BYTE => near.trunc(),
        far => (far / 10.0).trunc().min(MAX_BYTE) * 10.0,
    };
    stored_m.copysign(radius_m)
}

/// The time of a waypoint or a timed circle that is stored, seconds: whole ones, modulo 65536.
#[must_use]
pub fn stored_hold_s(hold_s: f64) -> f64 {
    hold_s.trunc().rem_euclid(65536.0)
}

/// A sentence for each circle and hold that `ArduPilot` stores otherwise, with its item from 1. Only what is
/// stored is judged.
#[must_use]
pub fn stored_otherwise(mission: &VehicleMission) -> Vec<String> {
    if mission.autopilot != Autopilot::ArduPilot {
        return Vec::new();
    }
    let is_copter = mission.airframe == Airframe::Copter;
    let numbered = mission.items.iter().zip(1..);
    let sentences = numbered.filter_map(|(item, number)| {
        let parts = match item.command {
            command::NAV_LOITER_TURNS => circle(item.params),
            command::NAV_LOITER_TIME => hold(item.params),
            command::NAV_WAYPOINT if is_copter => hold(item.params),
            _ => Vec::new(),
        };
        let parts = parts.join(", ");
        (!parts.is_empty()).then(|| format!("item {number}: ArduPilot stores {parts}"))
    });
    sentences.collect()
}

fn differs(sent: f64, stored: f64) -> bool {
    sent.is_finite() && (sent - stored).abs() > 1e-9
}

fn circle([turns, _, radius_m, _]: [f32; 4]) -> Vec<String> {
    let (turned, stored_m) = (stored_turns(turns.into()), stored_radius_m(radius_m.into()));
    let turns = differs(turns.into(), turned).then(|| format!("{turned} turns instead of {turns}"));
    let radius = differs(radius_m.into(), stored_m)
        .then(|| format!("a radius of {stored_m} m instead of {radius_m} m"));
    turns.into_iter().chain(radius).collect()
}

fn hold([hold_s, ..]: [f32; 4]) -> Vec<String> {
    let stored_s = stored_hold_s(hold_s.into());
    let is_other = differs(hold_s.into(), stored_s);
    let text = is_other.then(|| format!("a hold of {stored_s} s instead of {hold_s} s"));
    text.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::autopilot::Airframe;
    use crate::mission::{Home, Item};

    #[test]
    fn circles_and_holds_that_do_not_fit_their_bytes_are_named_with_what_is_stored() {
        let circle = |turns: f32, radius_m: f32| {
            Item::without_place(command::NAV_LOITER_TURNS, [turns, 0.0, radius_m, 0.0])
        };
        let of = |autopilot| VehicleMission {
            autopilot,
            autopilot_version: None,
            airframe: Airframe::Copter,
            home: Home {
                x: 0,
                y: 0,
                amsl_m: 0.0,
            },
            items: vec![
                circle(3.0, 40.0),
                circle(300.0, -3000.0),
                circle(2.5, 1234.0),
                circle(0.5, f32::NAN),
                Item::without_place(command::NAV_LOITER_TIME, [0.9, 0.0, 0.0, 0.0]),
                Item::without_place(command::NAV_WAYPOINT, [3.5, 0.0, 0.0, 0.0]),
                Item::without_place(command::NAV_WAYPOINT, [4.0, 0.0, 0.0, 0.0]),
            ],
            fence: Vec::new(),
            is_fence_known: true,
            rally: Vec::new(),
            params: Vec::new(),
            notes: Vec::new(),
        };
        assert_eq!(
            stored_otherwise(&of(Autopilot::ArduPilot)),
            [
                "item 2: ArduPilot stores 255 turns instead of 300, a radius of -2550 m instead of -3000 m",
                "item 3: ArduPilot stores 2 turns instead of 2.5, a radius of 1230 m instead of 1234 m",
                "item 5: ArduPilot stores a hold of 0 s instead of 0.9 s",
                "item 6: ArduPilot stores a hold of 3 s instead of 3.5 s",
            ]
        );
        assert!(stored_otherwise(&of(Autopilot::Px4)).is_empty());
    }
}
