//! Any text as a `.waypoints` file: no panic, and what is read is written and read the same.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sortie::formats::{self, waypoints};
use sortie::mission::VehicleMission;
use sortie::spec::{Airframe, Autopilot};

fn mission(text: &str, autopilot: Autopilot) -> Option<VehicleMission> {
    let mut document = waypoints::read(text).ok()?;
    document.autopilot = None;
    document.into_mission(autopilot, Airframe::Copter).ok()
}

fuzz_target!(|data: &[u8]| {
    let text = String::from_utf8_lossy(data);
    for autopilot in [Autopilot::ArduPilot, Autopilot::Px4] {
        let Some(read) = mission(&text, autopilot) else {
            continue;
        };
        let _ = formats::losses(&read, formats::Format::Waypoints);
        let written = waypoints::write(&read);
        let Some(again) = mission(&written, autopilot) else {
            panic!("what was written cannot be read:\n{written}");
        };
        // A second writing has nothing left to repair.
        assert_eq!(waypoints::write(&again), written);
    }
});
