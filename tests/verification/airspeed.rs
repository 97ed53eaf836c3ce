//! Speed through the air: what the lean angle of a copter allows, leg by leg in the wind.
#![allow(clippy::cast_possible_truncation)]

use crate::support;
use crate::support::missions;
use missions::{GROUND_M, level};
use sortie::mission::{Item, Parameter, VehicleMission, command};
use sortie::spec::*;
use sortie::verify::{Limit, Margin, review};
use support::{copter, empty_spec, place, world};

/// 9 km at a ground speed to the east, or to the west, in a spec of version 2.
fn flown_at(speed_mps: f64, is_east: bool) -> (MissionSpec, VehicleMission) {
    let mut ends = [place(36.30, -84.30), place(36.30, -84.20)];
    if !is_east {
        ends.reverse();
    }
    let mut vehicle = copter("alpha", 1, ends[0], ends[1]);
    vehicle.speed_mps = speed_mps;
    let mut mission = level(&vehicle, GROUND_M + 80.0, &ends);
    let items = mission.items.iter_mut();
    for item in items.filter(|item| item.command == command::DO_CHANGE_SPEED) {
        item.params[1] = speed_mps as f32;
    }
    let mut spec = empty_spec(vec![vehicle]);
    spec.version = 2;
    (spec, mission)
}

fn airspeed(spec: &MissionSpec, mission: &VehicleMission) -> Option<Margin> {
    let review = review(spec, &world(spec), &[(0, mission)]);
    let mut margins = review.margins.into_iter();
    margins.find(|margin| margin.limit == Limit::FlyableSpeed)
}

fn lean(name: &str, value: f32) -> Parameter {
    Parameter {
        name: name.to_owned(),
        value,
        why: String::new(),
    }
}

#[test]
fn a_copter_is_held_against_what_its_lean_angle_allows() {
    for (speed_mps, params, max_mps) in [
        (9.5, vec![], 9.5),
        (12.0, vec![], 9.5),
        (12.0, vec![lean("ANGLE_MAX", 4300.0)], 12.07),
        (12.0, vec![lean("ATC_ANGLE_MAX", 43.0)], 12.07),
        // No more than 50 degrees are believed.
        (15.0, vec![lean("ANGLE_MAX", 8000.0)], 13.65),
        (9.0, vec![lean("ANGLE_MAX", 2000.0)], 7.54),
    ] {
        let (spec, mut mission) = flown_at(speed_mps, true);
        mission.params.extend(params);
        let found = airspeed(&spec, &mission).expect("judged");
        assert!((found.bound - max_mps).abs() < 0.01, "{found:?}");
        assert_eq!(found.ok, speed_mps <= max_mps + 0.01, "{found:?}");
    }
    let (mut spec, mission) = flown_at(15.0, true);
    spec.vehicles[0].max_airspeed_mps = Some(16.0);
    assert!(airspeed(&spec, &mission).is_some_and(|found| found.ok && found.bound > 15.9));
    spec.version = 1;
    assert_eq!(airspeed(&spec, &mission), None);
}

#[test]
fn a_wind_counts_on_each_leg_as_it_blows_there() {
    // From the west, with the wind and against it; from the north, across.
    for (from_deg, is_east, through_mps, max_over_ground) in [
        // Faster than that it hovers in it.
        (270.0_f64, true, 5.0, None),
        (270.0, false, 14.0, Some("4.5 at most")),
        (0.0, true, 9.0_f64.hypot(5.0), Some("8.0 at most")),
    ] {
        let (mut spec, mission) = flown_at(9.0, is_east);
        spec.wind = Some(Wind {
            from_rad: from_deg.to_radians(),
            speed_mps: 5.0,
        });
        let found = airspeed(&spec, &mission).expect("judged");
        assert!(
            (found.value - through_mps).abs() < 0.02,
            "{from_deg}: {found:?}"
        );
        assert_eq!(found.ok, through_mps < 9.5, "{from_deg}: {found:?}");
        let named = max_over_ground.unwrap_or_default();
        assert!(found.note.ends_with(named), "{from_deg}: {found:?}");
    }
}

#[test]
fn a_copter_must_hold_all_of_the_wind_where_it_hovers() {
    // With the wind from behind it flies its legs at 3 m/s through the air.
    let (mut spec, mission) = flown_at(9.0, true);
    spec.wind = Some(Wind {
        from_rad: 270_f64.to_radians(),
        speed_mps: 12.0,
    });
    let found = airspeed(&spec, &mission).expect("judged");
    assert!(!found.ok && (found.value - 12.0).abs() < 1e-9, "{found:?}");
    assert!(found.note.contains("hover"), "{found:?}");
    spec.vehicles[0].autopilot = Autopilot::Px4;
    let mut px4 = mission.clone();
    px4.autopilot = Autopilot::Px4;
    let found = airspeed(&spec, &px4).expect("judged");
    assert!(!found.ok, "{found:?}");
}

#[test]
fn a_copter_is_held_against_the_wind_at_the_speed_of_its_circle() {
    let (mut spec, mut mission) = flown_at(9.0, true);
    spec.wind = Some(Wind {
        from_rad: 270_f64.to_radians(),
        speed_mps: 4.0,
    });
    // 10 m: 3.5 m/s, and not the 9 m/s of its legs.
    let circle = Item {
        params: [2.0, 0.0, 10.0, 0.0],
        ..missions::waypoint(place(36.30, -84.25), GROUND_M + 80.0)
    };
    let circle = Item {
        command: command::NAV_LOITER_TURNS,
        ..circle
    };
    mission.items.insert(2, circle);
    let found = airspeed(&spec, &mission).expect("judged");
    assert!(found.ok && (found.value - 7.5).abs() < 0.2, "{found:?}");
}

#[test]
fn parameters_allow_the_lean_that_the_planned_speed_needs() {
    let held = |spec: &MissionSpec, name: &str| {
        let vehicle = &spec.vehicles[0];
        let params = sortie::mission::parameters(
            vehicle,
            &spec.mission,
            &[],
            0.0,
            None,
            spec.airspeed_mps(vehicle),
        );
        params
            .into_iter()
            .find(|param| param.name == name)
            .map(|param| param.value)
    };
    let (mut spec, _) = flown_at(9.0, true);
    assert_eq!(held(&spec, "ANGLE_MAX"), Some(3000.0));
    spec.vehicles[0].speed_mps = 12.0;
    assert_eq!(
        (held(&spec, "ANGLE_MAX"), held(&spec, "ATC_ANGLE_MAX")),
        (Some(4300.0), Some(43.0))
    );
    spec.wind = Some(Wind {
        from_rad: 0.0,
        speed_mps: 5.0,
    });
    assert_eq!(held(&spec, "ANGLE_MAX"), Some(5000.0));
    spec.vehicles[0].max_airspeed_mps = Some(20.0);
    assert_eq!(held(&spec, "ANGLE_MAX"), None);
    spec.vehicles[0] = Vehicle {
        autopilot: Autopilot::Px4,
        max_airspeed_mps: None,
        speed_mps: 5.0,
        ..spec.vehicles[0].clone()
    };
    assert_eq!(held(&spec, "MPC_TILTMAX_AIR"), Some(47.0));
    spec.version = 1;
    assert_eq!(held(&spec, "MPC_TILTMAX_AIR"), None);
}
