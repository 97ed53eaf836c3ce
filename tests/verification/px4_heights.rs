//! PX4 copters since 1.18 fly height apart from the way (`PositionSmoothing`, 1ae8f2383f): soon after the beginning
//! of a leg they are at the altitude of its end, and stay there.
//!
//! Flown on 2026-11-26 with PX4 1.18 beta in its own simulator: three copters on `missions/harbour.yaml` were up to
//! 25 m above and 26 m below the lines of legs of 500 m, and 72 to 115 s late after 15 to 27 minutes.

use crate::support;
use crate::support::missions;
use missions::{GROUND_M, land, mission, takeoff, waypoint};
use sortie::autopilot::Version;
use sortie::geodesy::{Amsl, LatLon};
use sortie::mission::VehicleMission;
use sortie::spec::{Autopilot, Hill, MissionSpec, TerrainSource, Vehicle};
use sortie::verify::{Limit, Margin, review, verified_trajectories};
use support::{copter, empty_spec, place, world};

const HIGH_M: f64 = GROUND_M + 150.0;
const LOW_M: f64 = GROUND_M + 70.0;

fn ends() -> [LatLon; 3] {
    [
        place(36.30, -84.28),
        place(36.30, -84.26),
        place(36.30, -84.24),
    ]
}

fn px4(minor: Option<u8>) -> Vehicle {
    let [start, _, goal] = ends();
    Vehicle {
        autopilot: Autopilot::Px4,
        autopilot_version: minor.map(|minor| Version { major: 1, minor }),
        speed_mps: 8.0,
        ..copter("alpha", 1, start, goal)
    }
}

/// Down from 150 m to 70 m on the first of two legs of 1.8 km.
fn down(vehicle: &Vehicle) -> VehicleMission {
    let [start, middle, goal] = ends();
    let mut mission = mission(
        vehicle,
        GROUND_M,
        vec![
            takeoff(start, HIGH_M),
            waypoint(middle, LOW_M),
            waypoint(goal, LOW_M),
            land(goal),
        ],
    );
    mission.autopilot_version = vehicle.autopilot_version;
    mission
}

/// With a hill of 40 m a quarter of the way along that leg: the line is 90 m above it, the altitude of its end 30 m.
fn over_a_hill(vehicle: &Vehicle) -> MissionSpec {
    let mut spec = empty_spec(vec![vehicle.clone()]);
    spec.terrain = TerrainSource::Analytic {
        base: Amsl(GROUND_M),
        hills: vec![Hill {
            place: place(36.30, -84.275),
            height_m: 40.0,
            radius_m: 150.0,
        }],
    };
    spec
}

fn clearance(vehicle: &Vehicle) -> Margin {
    let spec = over_a_hill(vehicle);
    let review = review(&spec, &world(&spec), &[(0, &down(vehicle))]);
    let mut margins = review.margins.iter();
    margins
        .find(|margin| margin.limit == Limit::TerrainClearance)
        .expect("judged")
        .clone()
}

#[test]
fn a_px4_copter_is_judged_at_the_altitude_of_the_end_of_its_leg_all_along() {
    for minor in [Some(18), Some(19)] {
        let margin = clearance(&px4(minor));
        assert!(!margin.ok, "{minor:?}: {margin:?}");
        assert!((margin.value - 30.0).abs() < 0.5, "{margin:?}");
    }
    for vehicle in [
        px4(None),
        px4(Some(17)),
        Vehicle {
            autopilot: Autopilot::ArduPilot,
            ..px4(None)
        },
    ] {
        assert!(clearance(&vehicle).ok, "{:?}", clearance(&vehicle));
    }
}

#[test]
fn a_px4_copter_of_1_18_loses_a_tenth_of_the_time_on_its_legs() {
    let late = |minor| {
        let vehicle = px4(minor);
        let mission = down(&vehicle);
        let spec = empty_spec(vec![vehicle]);
        let all = verified_trajectories(&spec, &world(&spec), &[(0, &mission)]);
        let mut on_its_way = all[0].segments.iter().filter(|of| of.is_flown);
        let last = on_its_way.rfind(|of| of.to.item == 3);
        let last = last.expect("a leg");
        (last.late_s, last.to.t_s)
    };
    let ((later_s, ends_s), (late_s, _)) = (late(Some(18)), late(Some(17)));
    // From the end of its climb of 150 m on.
    let on_legs_s = ends_s - 30.0;
    assert!(
        (later_s - late_s - 0.1 * on_legs_s).abs() < 2.0,
        "{later_s} {late_s} {ends_s}"
    );
}

/// Crossing 30 m under another, it may be at that one's altitude.
#[test]
fn a_separation_in_height_counts_with_the_altitude_of_the_end_of_the_leg() {
    let [_, middle, _] = ends();
    let apart_m = |minor| {
        let alpha = px4(minor);
        let mut beta = copter(
            "beta",
            2,
            place(36.31, middle.lon_deg - 0.003),
            place(36.29, middle.lon_deg - 0.003),
        );
        beta.speed_mps = 8.0;
        let first = down(&alpha);
        let second = missions::level(&beta, LOW_M, &[beta.home, beta.goal.place]);
        let mut spec = empty_spec(vec![alpha, beta]);
        spec.separation.time_slack_s = 60.0;
        let review = review(&spec, &world(&spec), &[(0, &first), (1, &second)]);
        let mut margins = review.margins.iter();
        margins
            .find(|margin| margin.limit == Limit::Separation)
            .expect("judged")
            .value
    };
    let (follows_m, at_once_m) = (apart_m(Some(17)), apart_m(Some(18)));
    assert!(at_once_m < follows_m - 5.0, "{at_once_m} {follows_m}");
}
