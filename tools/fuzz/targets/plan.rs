//! Any text as a `.plan` file: no panic, and what is read is written and read the same.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sortie::formats::{self, plan};
use sortie::mission::VehicleMission;
use sortie::spec::{Airframe, Autopilot};

fn mission(text: &str, autopilot: Autopilot) -> Option<VehicleMission> {
    let mut document = plan::read(text).ok()?;
    document.autopilot = None;
    document.into_mission(autopilot, Airframe::Copter).ok()
}

fuzz_target!(|data: &[u8]| {
    let text = String::from_utf8_lossy(data);
    for autopilot in [Autopilot::ArduPilot, Autopilot::Px4] {
        let Some(read) = mission(&text, autopilot) else {
            continue;
        };
        let _ = formats::losses(&read, formats::Format::Plan);
        let written = plan::write(&read);
        let Some(again) = mission(&written, autopilot) else {
            panic!("what was written cannot be read:\n{written}");
        };
        // A second writing has nothing left to repair.
        assert_eq!(plan::write(&again), written);
    }
});
