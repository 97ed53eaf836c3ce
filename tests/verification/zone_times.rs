//! Zones with times, and where a vehicle may be in them at another time than its planned one.

use std::path::Path;

use crate::support;
use sortie::dispatch::dispatch;
use sortie::geodesy::LatLon;
use sortie::mission::VehicleMission;
use sortie::spec::{Finish, MissionSpec, SpecFile, Zone};
use sortie::verify::{Limit, review};
use support::{copter, empty_spec, place, world};

/// The mission of the only vehicle, planned without zones.
fn planned(spec: &MissionSpec) -> VehicleMission {
    let open = MissionSpec {
        no_fly: Vec::new(),
        ..spec.clone()
    };
    let done = dispatch(&open, &world(&open), 1, &|_| ());
    assert!(done.review.passes(), "{:?}", done.review.margins);
    done.missions[0].1.clone()
}

/// Whether the mission breaks no zone that is active from one second to another.
fn keeps_out(spec: &MissionSpec, mission: &VehicleMission, active_s: Option<(f64, f64)>) -> bool {
    let mut spec = spec.clone();
    for zone in &mut spec.no_fly {
        zone.active_s = active_s;
    }
    let review = review(&spec, &world(&spec), &[(0, mission)]);
    let mut margins = review.margins.iter();
    !margins.any(|margin| matches!(margin.limit, Limit::Zone(_)) && !margin.ok)
}

#[test]
fn a_vehicle_that_stays_in_the_air_is_in_a_zone_that_becomes_active_there_later() {
    let goal = place(36.30, -84.20);
    let mut vehicle = copter("alpha", 1, place(36.30, -84.25), goal);
    vehicle.finish = Finish::Loiter;
    let mut spec = empty_spec(vec![vehicle]);
    let circle = |at: LatLon| Zone {
        id: "later".to_owned(),
        circle: Some((at, 150.0)),
        ..Zone::default()
    };
    spec.no_fly = vec![circle(goal)];
    let mission = planned(&spec);
    assert!(!keeps_out(&spec, &mission, Some((3600.0, 7200.0))));
    assert!(keeps_out(&spec, &mission, Some((0.0, 60.0))));
    spec.no_fly = vec![circle(place(36.30, -84.25))];
    assert!(keeps_out(&spec, &mission, Some((3600.0, 7200.0))));
}

#[test]
fn a_plane_that_overshoots_its_takeoff_does_so_when_it_climbs_out() {
    let text = "\
sortie: 1
name: heron
area: {south_west: {lat: -35.400, lon: 149.120}, north_east: {lat: -35.320, lon: 149.200}, min_agl_m: 30, max_amsl_m: 804}
terrain: {flat: {amsl_m: 584}}
vehicles:
  - {id: heron, sysid: 1, autopilot: ardupilot, airframe: plane, link: sim, home: {lat: -35.3633, lon: 149.1500},
     takeoff_heading_deg: 90, start: {lat: -35.3633, lon: 149.1560, agl_m: 80}, goal: {lat: -35.3400, lon: 149.1500, agl_m: 80},
     landing: {heading_deg: 270, glide_deg: 6}, finish: land, loiter_radius_m: 80, speed_mps: 18, max_load_factor: 1.4,
     max_climb_deg: 10, max_descent_deg: 8, climb_mps: 3, descent_mps: 3}
separation: {distance_m: 50, time_slack_s: 5}
planner: {seed: 1, evaluations: 3000}
";
    let file = SpecFile::parse(Path::new("heron.yaml"), text.to_owned());
    let mut spec = file.unwrap_or_else(|error| panic!("{error}")).spec;
    spec.no_fly = vec![Zone {
        id: "over".to_owned(),
        circle: Some((place(-35.3633, 149.1545), 40.0)),
        floor: Some(sortie::spec::Placement::Amsl(sortie::geodesy::Amsl(671.0))),
        ..Zone::default()
    }];
    let mission = planned(&spec);
    assert!(!keeps_out(&spec, &mission, None));
    // It is there some 25 s after its takeoff.
    assert!(!keeps_out(&spec, &mission, Some((20.0, 3600.0))));
    assert!(!keeps_out(&spec, &mission, Some((0.0, 30.0))));
    assert!(keeps_out(&spec, &mission, Some((3000.0, 3600.0))));
}
