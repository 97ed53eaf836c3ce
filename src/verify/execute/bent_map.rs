//! The maps that autopilots steer by, and the plane in which legs are judged.
//!
//! ArduPilot scales longitudes by the latitude halfway to its origin: its straight lines leave the geodesic by at most
//! [`bend_m`], of the latitude where the leg is. PX4's map preserves azimuths, and straight lines of it leave the geodesic
//! only away from its origin, where it took off. Straight lines of the plane leave it by [`frame_bend_m`].

use std::collections::BTreeMap;

use super::flight::Flight;
use crate::geodesy::{EastNorth, SMALL_BEND_M, bend_m, frame_bend_m};
use crate::spec::{Autopilot, Vehicle};
use crate::world::World;

/// An azimuthal equidistant map bends by this share of what a tangent plane does (`x - x^3 / 3` and
/// `x - x^3 / 2` against `x` of one that keeps geodesics straight).
const EQUIDISTANT_SHARE: f64 = 2.0 / 3.0;

/// The longest straight way of a row: from where its first segment begins.
#[derive(Clone, Copy)]
struct Leg {
    from: EastNorth,
    to: EastNorth,
}

impl Leg {
    fn long_m(&self) -> f64 {
        self.from.distance_m(self.to)
    }

    /// How far the line through it passes from a place, metres.
    fn past_m(&self, place: EastNorth) -> f64 {
        let along = [
            self.to.east_m - self.from.east_m,
            self.to.north_m - self.from.north_m,
        ];
        let away = [
            place.east_m - self.from.east_m,
            place.north_m - self.from.north_m,
        ];
        let long_m = self.long_m();
        match long_m > 0.0 {
            true => (along[0] * away[1] - along[1] * away[0]).abs() / long_m,
            false => 0.0,
        }
    }

    /// By how much ArduPilot's map bends it, metres: by the latitude of its end that is nearer to a pole.
    fn map_bend_m(&self, world: &World) -> f64 {
        let lat_deg = |at: EastNorth| world.frame.from_plan(at).lat_deg.abs();
        bend_m(self.long_m(), lat_deg(self.from).max(lat_deg(self.to)))
    }

    /// By how much what is flown and what is judged may be apart, metres.
    fn bend_m(&self, vehicle: &Vehicle, world: &World, took_off: EastNorth) -> f64 {
        let origin = world.frame.to_plan(world.frame.origin());
        let of_plane_m = frame_bend_m(self.long_m(), self.past_m(origin));
        of_plane_m
            + match vehicle.autopilot {
                Autopilot::ArduPilot => self.map_bend_m(world),
                Autopilot::Px4 => {
                    EQUIDISTANT_SHARE * frame_bend_m(self.long_m(), self.past_m(took_off))
                }
            }
    }
}

/// The leg of each row.
fn legs(flight: &Flight) -> BTreeMap<usize, Leg> {
    let mut legs: BTreeMap<usize, Leg> = BTreeMap::new();
    for segment in &flight.segments {
        let leg = legs.entry(segment.row).or_insert(Leg {
            from: segment.from.at,
            to: segment.from.at,
        });
        if leg.from.distance_m(segment.to.at) > leg.long_m() {
            leg.to = segment.to.at;
        }
    }
    legs
}

/// The leg that the map of ArduPilot bends most: how long it is, and by how much it bends, metres.
pub(crate) fn greatest_bend(vehicle: &Vehicle, flight: &Flight, world: &World) -> (f64, f64) {
    let legs = match vehicle.autopilot {
        Autopilot::ArduPilot => legs(flight),
        Autopilot::Px4 => BTreeMap::new(),
    };
    let bends = legs
        .into_values()
        .map(|leg| (leg.long_m(), leg.map_bend_m(world)));
    bends.fold(
        (0.0, 0.0),
        |most, leg| if leg.1 > most.1 { leg } else { most },
    )
}

/// Counts bends that are not small: a vehicle may be anywhere between its leg and the line on its map.
pub(super) fn widen(vehicle: &Vehicle, flight: &mut Flight, world: &World) {
    let Some(took_off) = flight.segments.first().map(|segment| segment.from.at) else {
        return;
    };
    let legs = legs(flight).into_iter();
    let bends_m: BTreeMap<usize, f64> = legs
        .map(|(row, leg)| (row, leg.bend_m(vehicle, world, took_off)))
        .filter(|(_, by_m)| *by_m > SMALL_BEND_M)
        .collect();
    if bends_m.is_empty() {
        return;
    }
    for segment in &mut flight.segments {
        if let Some(by_m) = bends_m.get(&segment.row) {
            segment.bow_m += by_m;
            segment.wide_m += by_m;
        }
    }
}
