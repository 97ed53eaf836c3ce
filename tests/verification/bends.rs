//! Long legs: where autopilots steer and the plane in which the verdict measures bend them.

use crate::support;
use crate::support::missions;
use missions::{GROUND_M, level};
use sortie::geodesy::{LatLon, LocalFrame};
use sortie::spec::*;
use sortie::verify::{Limit, review};
use support::{copter, empty_spec, place, threat, world};

/// How far a copter keeps from a mast of 300 m, metres.
fn away_m(origin: LatLon, autopilot: Autopilot, places: &[LatLon], mast: LatLon) -> f64 {
    let mut vehicle = copter("alpha", 1, places[0], places[places.len() - 1]);
    vehicle.autopilot = autopilot;
    let mission = level(&vehicle, GROUND_M + 80.0, places);
    let mut spec = empty_spec(vec![vehicle]);
    spec.frame = LocalFrame::new(origin);
    spec.threats = vec![threat("mast", mast, 300.0)];
    let review = review(&spec, &world(&spec), &[(0, &mission)]);
    let mut margins = review.margins.iter();
    let found = margins.find(|margin| matches!(margin.limit, Limit::Threat(_)));
    found.expect("judged").value
}

#[test]
fn a_leg_is_bent_by_the_latitude_where_it_is() {
    // 30.1 km at 78.2 N, 268 km north of the middle of the area:.
    let legs = |lat_deg: f64| [place(lat_deg, 15.0), place(lat_deg, 16.32)];
    let of = |autopilot| {
        let mast = place(78.22, 15.66);
        away_m(place(75.8, 15.66), autopilot, &legs(78.2), mast)
    };
    let long_m: f64 = 30_130.0;
    let tan_lat = 78.2_f64.to_radians().tan();
    let bend_m = long_m * long_m * tan_lat / (8.0 * 6_371_000.0);
    let less_m = of(Autopilot::Px4) - of(Autopilot::ArduPilot);
    assert!((less_m - bend_m).abs() < 2.0, "{less_m} m, not {bend_m}");
}

#[test]
fn a_leg_far_from_the_origin_is_where_it_is_on_the_earth() {
    // Along a meridian 200 km east of the origin: 390 km at once, or from place to place on it.
    let along = |legs: u32| -> Vec<LatLon> {
        let share = |index: u32| f64::from(index) / f64::from(legs);
        (0..=legs)
            .map(|index| place(-1.74 + 3.53 * share(index), 1.8))
            .collect()
    };
    let origin = place(0.0, 0.0);
    let of = |legs: u32| away_m(origin, Autopilot::Px4, &along(legs), place(0.0, 1.83));
    let (at_once_m, by_places_m) = (of(1), of(8));
    // In the plane it would be 94 m further off.
    assert!(at_once_m <= by_places_m + 0.1, "{at_once_m} {by_places_m}");
    assert!(at_once_m > by_places_m - 3.0, "{at_once_m} {by_places_m}");
}
