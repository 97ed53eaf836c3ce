//! Buffers: the verdict on missions satisfies limit and buffer.

use crate::support;
use crate::support::missions;
use missions::{GROUND_M, level, waypoint};
use sortie::geodesy::{Amsl, LatLon};
use sortie::mission::{Item, Parameter, VehicleMission, command, frame};
use sortie::spec::*;
use sortie::verify::{Limit, Margin, Review, review};
use sortie::world::World;
use support::{copter, empty_spec, place, world};

/// 10 km to the east at 80 m above ground, through 36.30 N 84.25 W.
fn eastward() -> (MissionSpec, VehicleMission) {
    let ends = [place(36.30, -84.30), place(36.30, -84.20)];
    let vehicle = copter("alpha", 1, ends[0], ends[1]);
    let mission = level(&vehicle, GROUND_M + 80.0, &ends);
    (empty_spec(vec![vehicle]), mission)
}

/// A place so far north of the line, metres.
fn north_of_line(metres: f64, lon_deg: f64) -> LatLon {
    place(36.30 + metres / 110_970.0, lon_deg)
}

fn judged(spec: &MissionSpec, missions: &[&VehicleMission]) -> Review {
    let pairs: Vec<(usize, &VehicleMission)> = missions.iter().copied().enumerate().collect();
    review(spec, &world(spec), &pairs)
}

fn of(review: &Review, limit: &Limit) -> Margin {
    let found = review.margins.iter().find(|margin| margin.limit == *limit);
    found.unwrap_or_else(|| panic!("{limit}")).clone()
}

/// With a buffer of 10 m to everything only `limit` fails, at 5 m from its bare value; without
/// one it holds. Returns the failed margin.
fn fails_by_its_buffer(spec: &MissionSpec, missions: &[&VehicleMission], limit: &Limit) -> Margin {
    let without = judged(spec, missions);
    assert!(
        of(&without, limit).ok,
        "{limit} without a buffer: {without:?}"
    );
    assert_eq!(of(&without, limit).buffer.to_bits(), 0.0_f64.to_bits());
    let mut spec = spec.clone();
    spec.buffers = Buffers::even(10.0);
    let with = judged(&spec, missions);
    let failed: Vec<&Limit> = with
        .margins
        .iter()
        .filter(|m| !m.ok)
        .map(|m| &m.limit)
        .collect();
    assert_eq!(failed, [limit]);
    let found = of(&with, limit);
    assert_eq!(found.buffer.to_bits(), 10.0_f64.to_bits());
    let unbuffered = of(&without, limit);
    assert!(
        (found.value - unbuffered.value).abs() < 0.01,
        "{found:?} {unbuffered:?}"
    );
    assert!(
        ((found.bound - unbuffered.bound).abs() - 10.0).abs() < 1e-9,
        "{found:?}"
    );
    found
}

#[test]
fn a_threat_within_its_buffer_fails_by_the_missing_distance() {
    let (mut spec, mission) = eastward();
    spec.threats.push(Threat {
        id: "mast".to_owned(),
        kind: "mast".to_owned(),
        place: north_of_line(305.0, -84.25),
        radius_m: 300.0,
    });
    let found = fails_by_its_buffer(&spec, &[&mission], &Limit::Threat("mast".to_owned()));
    assert!((found.value - 4.0).abs() < 1.0, "{found:?}");
}

#[test]
fn the_corner_of_a_zone_is_as_far_as_it_is() {
    // North-west of its south-east corner, which points at the line from 12.1 m: a mitred zone
    // with a buffer of 10 m would reach 14 m.
    let (mut spec, mission) = eastward();
    let zone = |away_m: f64, ceiling: Option<Placement>| Zone {
        ceiling,
        ..Zone::closed(
            "yard".to_owned(),
            vec![
                north_of_line(away_m, -84.25),
                north_of_line(away_m + 200.0, -84.2478),
                north_of_line(away_m + 400.0, -84.25),
                north_of_line(away_m + 200.0, -84.2522),
            ],
        )
    };
    spec.buffers = Buffers::even(10.0);
    spec.no_fly = vec![zone(12.1, None)];
    assert!(judged(&spec, &[&mission]).passes());
    spec.buffers = Buffers::NONE;
    spec.no_fly = vec![zone(5.0, None)];
    fails_by_its_buffer(&spec, &[&mission], &Limit::Zone("yard".to_owned()));
    // Over a zone with a height as well.
    spec.no_fly = vec![zone(-200.0, Some(Placement::Amsl(Amsl(GROUND_M + 75.0))))];
    let mut with = spec.clone();
    with.buffers = Buffers::even(10.0);
    assert!(judged(&spec, &[&mission]).passes());
    assert!(!of(&judged(&with, &[&mission]), &Limit::Zone("yard".to_owned())).ok);
}

#[test]
fn area_ground_and_ceiling_have_their_buffers() {
    let (mut spec, mission) = eastward();
    spec.area.north_east = north_of_line(5.0, -84.14);
    fails_by_its_buffer(&spec, &[&mission], &Limit::Area);
    let (mut spec, mission) = eastward();
    spec.area.min_agl.0 = 75.0;
    fails_by_its_buffer(&spec, &[&mission], &Limit::TerrainClearance);
    let (mut spec, mission) = eastward();
    spec.area.max_amsl = Amsl(GROUND_M + 85.0);
    fails_by_its_buffer(&spec, &[&mission], &Limit::Ceiling);
}

#[test]
fn two_vehicles_keep_the_separation_and_its_buffer() {
    let (mut spec, mission) = eastward();
    let ends = [north_of_line(105.0, -84.30), north_of_line(105.0, -84.20)];
    let other = copter("bravo", 2, ends[0], ends[1]);
    let second = level(&other, GROUND_M + 80.0, &ends);
    spec.vehicles.push(other);
    let found = fails_by_its_buffer(&spec, &[&mission, &second], &Limit::Separation);
    assert!((found.bound - 110.0).abs() < 1e-9, "{found:?}");
}

/// A fence of ArduPilot around it all, as items.
fn fenced(mission: &VehicleMission, radius_m: f32, margin_m: Option<f32>) -> VehicleMission {
    let corner = |lat_deg: f64, lon_deg: f64| Item {
        params: [4.0, 0.0, 0.0, 0.0],
        z: 0.0,
        ..missions::at(
            command::NAV_FENCE_POLYGON_VERTEX_INCLUSION,
            frame::GLOBAL,
            place(lat_deg, lon_deg),
            0.0,
            4.0,
        )
    };
    let parameter = |name: &str, value: f32| Parameter {
        name: name.to_owned(),
        value,
        why: String::new(),
    };
    let mut params = vec![parameter("WPNAV_RADIUS", 100.0 * radius_m)];
    params.extend(margin_m.map(|margin_m| parameter("FENCE_MARGIN", margin_m)));
    let mut items = mission.items.clone();
    items.insert(2, waypoint(place(36.30, -84.25), GROUND_M + 80.0));
    VehicleMission {
        items,
        params,
        fence: vec![
            corner(36.21, -84.36),
            corner(36.21, -84.14),
            corner(36.39, -84.14),
            corner(36.39, -84.36),
        ],
        ..mission.clone()
    }
}

#[test]
fn a_waypoint_radius_above_the_fence_margin_fails() {
    let (mut spec, mission) = eastward();
    let is_ok = |spec: &MissionSpec, mission: VehicleMission| {
        let review = judged(spec, &[&mission]);
        let mut margins = review.margins.iter();
        margins
            .find(|m| m.limit == Limit::FenceMargin)
            .map(|m| m.ok)
    };
    assert_eq!(
        is_ok(&spec, fenced(&mission, 5.0, None)),
        None,
        "no buffer, no margin"
    );
    spec.buffers = Buffers::even(10.0);
    assert_eq!(is_ok(&spec, mission.clone()), None, "no fence");
    assert_eq!(is_ok(&spec, fenced(&mission, 5.0, None)), Some(true));
    assert_eq!(is_ok(&spec, fenced(&mission, 11.0, None)), Some(false));
    assert_eq!(is_ok(&spec, fenced(&mission, 5.0, Some(4.0))), Some(false));
    assert_eq!(is_ok(&spec, fenced(&mission, 3.0, Some(4.0))), Some(true));
}

#[test]
fn the_world_of_a_flight_has_the_limits_without_their_buffers() {
    let (mut spec, _) = eastward();
    spec.threats.push(Threat {
        id: "mast".to_owned(),
        kind: "mast".to_owned(),
        place: north_of_line(600.0, -84.25),
        radius_m: 300.0,
    });
    let limits = world(&spec);
    spec.buffers = Buffers::even(10.0);
    let planned = world(&spec);
    let radius_m = |world: &World| world.threats[0].radius_m;
    assert!((radius_m(&planned) - radius_m(&limits) - 10.0).abs() < 1e-9);
    assert!((planned.min_agl.0 - 70.0).abs() < 1e-9 && (planned.max_amsl.0 - 1490.0).abs() < 1e-9);
    let flown = planned.without_buffers(&spec);
    assert_eq!(
        (&flown.threats, &flown.zones),
        (&limits.threats, &limits.zones)
    );
    assert_eq!((&flown.area, flown.min_agl), (&limits.area, limits.min_agl));
    assert_eq!(flown.max_amsl, limits.max_amsl);
}
