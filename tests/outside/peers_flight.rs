//! Ground stations that are not ours arm simulated vehicles and start their missions.

use crate::support::peers;
use std::path::Path;

use sortie::mission::Home;
use sortie::simulator::{Profile, Simulated, Surroundings, spawn_in};

const HOME: Home = Home {
    x: 363_000_000,
    y: -842_500_000,
    amsl_m: 400.5,
};

#[test]
fn mavsdk_and_pymavlink_arm_the_simulated_vehicles_and_start_their_missions() {
    let Some(python) = peers::python() else {
        return;
    };
    // At the pace of the clock: sped up, the vehicles would ask again for an item sooner
    // than a busy machine sends it. All at once, because it takes half a minute.
    std::thread::scope(|scope| {
        for (profile, name) in [(Profile::ArduPilot, "ardupilot"), (Profile::Px4, "px4")] {
            for tool in ["mavsdk", "pymavlink"] {
                let python = &python;
                scope.spawn(move || starts(python, profile, name, tool));
            }
        }
    });
}

fn starts(python: &Path, profile: Profile, name: &str, tool: &str) {
    let simulated = Simulated::on_loopback(profile, 3, Some(HOME));
    let vehicle = spawn_in(&simulated, Surroundings::default(), 1.0).expect("a port");
    let port = vehicle.address().port().to_string();
    let result = peers::run(python, "vehicle_start.py", &[tool, name, &port]);
    assert!(result["error"].is_null(), "{name} {tool}: {result}");
    assert_eq!(result["armed"], true, "{name} {tool}: {result}");
    let height_m = result["height_m"].as_f64().expect("metres");
    assert!((29.0..31.5).contains(&height_m), "{name} {tool}: {result}");
    let item = result["item"].as_u64().expect("an item");
    assert!(
        item > u64::from(name == "ardupilot"),
        "{name} {tool}: {result}"
    );
}
