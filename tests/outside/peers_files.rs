//! Files that we write, read by other people's readers: item by item the same.
//!
//! Peers: pymavlink 2.4.50 (`mavwp.MAVWPLoader`), MAVSDK 4.1.0 (`mission_raw` importers).

use crate::support;

use std::path::Path;

use serde_json::Value;
use sortie::formats::{plan, waypoints};
use sortie::geodesy::{Agl, Amsl, PlanPoint};
use sortie::mission::{self, Home, Item, VehicleMission};
use sortie::path::TimedPoint;
use sortie::spec::*;
use support::{copter, empty_spec, peers, place, world};

/// A mission with everything that these files hold: a delay, waypoints, a fence, a rally point.
fn example(autopilot: Autopilot, altitude: AltitudeReference) -> VehicleMission {
    let mut vehicle = copter(
        "alpha",
        1,
        place(36.25, -84.300_000_1),
        place(36.33, -84.20),
    );
    vehicle.autopilot = autopilot;
    vehicle.depart_s = 12.3;
    let mut spec = empty_spec(vec![vehicle]);
    spec.mission.altitude = altitude;
    spec.terrain = TerrainSource::Flat(Amsl(400.12));
    spec.threats = vec![Threat {
        id: "radar".to_owned(),
        kind: "radar".to_owned(),
        place: place(36.35, -84.32),
        radius_m: 900.5,
    }];
    let triangle = vec![
        place(36.30, -84.28),
        place(36.31, -84.28),
        place(36.30, -84.27),
    ];
    spec.no_fly = vec![Zone {
        id: "town".to_owned(),
        polygon: triangle,
        ..Zone::default()
    }];
    spec.rally = vec![Rally {
        place: place(36.26, -84.30),
        agl: Agl(80.0),
    }];
    let world = world(&spec);
    let (start, goal) = (world.sites[0].start, world.sites[0].goal);
    let route: Vec<TimedPoint> = (0..=200)
        .map(|step| {
            let share = f64::from(step) / 200.0;
            let wave_m = 400.0 * (share * 6.0).sin() * share * (1.0 - share);
            let mix = |from: f64, to: f64| from + (to - from) * share;
            TimedPoint {
                point: PlanPoint::new(
                    mix(start.at.east_m, goal.at.east_m) + wave_m,
                    mix(start.at.north_m, goal.at.north_m) - wave_m,
                    Amsl(mix(start.amsl.0, goal.amsl.0) + 20.0 * share * (1.0 - share)),
                ),
                t_s: 100.0 * share,
            }
        })
        .collect();
    let mission = mission::build(&spec, &world, 0, &[route]).expect("a mission");
    assert!(mission.items.len() > 6 && mission.fence.len() == 8 && mission.rally.len() == 1);
    mission
}

/// A number as the peers print it, NaN as a string.
fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| {
        assert_eq!(value, "NaN");
        f64::NAN
    })
}

/// What a peer found, as items; coordinates are integers already or degrees.
fn items(found: &Value, in_degrees: bool) -> Vec<Item> {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a peer's numbers"
    )]
    let item = |row: &Value| {
        let field = |index: usize| number(&row[index]);
        let frame = field(1) as u8;
        let scale = if in_degrees && frame != 2 { 1e7 } else { 1.0 };
        Item {
            command: field(0) as u16,
            frame,
            autocontinue: field(2) > 0.5,
            params: [3, 4, 5, 6].map(|index| field(index) as f32),
            x: (field(7) * scale).round() as i32,
            y: (field(8) * scale).round() as i32,
            z: field(9) as f32,
        }
    };
    found.as_array().expect("a list").iter().map(item).collect()
}

fn home_item(home: Home, frame: u8) -> Item {
    Item {
        command: 16,
        frame,
        autocontinue: true,
        params: [0.0; 4],
        x: home.x,
        y: home.y,
        z: home.amsl_m,
    }
}

/// The items as the `.waypoints` format keeps them: NaN is 0.
fn without_nan(items: &[Item]) -> Vec<Item> {
    let plain = |value: f32| if value.is_nan() { 0.0 } else { value };
    items
        .iter()
        .map(|item| Item {
            params: item.params.map(plain),
            ..*item
        })
        .collect()
}

fn file(folder: &Path, name: &str, text: &str) -> String {
    let path = folder.join(name);
    std::fs::write(&path, text).expect("a temporary file");
    path.display().to_string()
}

/// Every autopilot and altitude reference that makes a mission.
fn examples() -> Vec<VehicleMission> {
    use AltitudeReference::{Amsl, Relative, Terrain};
    [
        (Autopilot::ArduPilot, Amsl),
        (Autopilot::ArduPilot, Relative),
        (Autopilot::ArduPilot, Terrain),
        (Autopilot::Px4, Amsl),
        (Autopilot::Px4, Relative),
    ]
    .into_iter()
    .map(|(autopilot, reference)| example(autopilot, reference))
    .collect()
}

fn mav_autopilot(mission: &VehicleMission) -> &'static str {
    match mission.autopilot {
        Autopilot::ArduPilot => "3",
        Autopilot::Px4 => "12",
    }
}

#[test]
fn pymavlink_reads_our_waypoints() {
    let Some(python) = peers::python() else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    for mission in examples() {
        let path = file(
            folder.path(),
            "alpha.waypoints",
            &waypoints::write(&mission),
        );
        let found = peers::run(&python, "import_mission.py", &["pymavlink", &path]);
        let mut expected = vec![home_item(mission.home, 0)];
        expected.extend(without_nan(&mission.items));
        assert_eq!(items(&found["mission"], true), expected);
    }
}

#[test]
fn mavsdk_reads_our_waypoints() {
    let Some(python) = peers::python() else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    for mission in examples() {
        let path = file(
            folder.path(),
            "alpha.waypoints",
            &waypoints::write(&mission),
        );
        let reader = format!("mavsdk-waypoints-{}", mav_autopilot(&mission));
        let found = peers::run(&python, "import_mission.py", &[&reader, &path]);
        let mut expected = vec![home_item(mission.home, 0)];
        expected.extend(without_nan(&mission.items));
        if mission.autopilot == Autopilot::ArduPilot {
            // It inserts a home of its own before ours.
            expected.insert(0, home_item(mission.home, 5));
        }
        assert_eq!(items(&found["mission"], false), expected);
    }
}

#[test]
fn mavsdk_reads_our_plan_with_fence_and_rally() {
    let Some(python) = peers::python() else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    for mission in examples() {
        let path = file(folder.path(), "alpha.plan", &plan::write(&mission));
        let reader = format!("mavsdk-plan-{}", mav_autopilot(&mission));
        let found = peers::run(&python, "import_mission.py", &[&reader, &path]);
        let mut expected = mission.items.clone();
        if mission.autopilot == Autopilot::ArduPilot {
            expected.insert(0, home_item(mission.home, 5));
        }
        assert_eq!(items(&found["mission"], false), expected);
        assert_eq!(items(&found["fence"], false), mission.fence);
        assert_eq!(items(&found["rally"], false), mission.rally);
    }
}
