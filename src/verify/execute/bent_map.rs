//! The map that ArduPilot steers by.
//!
//! It scales longitudes by the latitude halfway to its origin. Its straight lines leave the geodesic by at most
//! [`bend_m`]; PX4's map preserves azimuths and has no such bend.

use std::collections::BTreeMap;

use super::flight::Flight;
use crate::geodesy::{EastNorth, SMALL_BEND_M, bend_m};
use crate::spec::{Autopilot, Vehicle};
use crate::world::World;

/// The greatest distance from where the first chord of each row begins to where another of it ends, metres.
fn legs_m(flight: &Flight) -> BTreeMap<usize, f64> {
    let mut legs: BTreeMap<usize, (EastNorth, f64)> = BTreeMap::new();
    for chord in &flight.chords {
        let (begin, long_m) = legs.entry(chord.row).or_insert((chord.from.at, 0.0));
        *long_m = long_m.max(begin.distance_m(chord.to.at));
    }
    let legs = legs.into_iter();
    legs.map(|(row, (_, long_m))| (row, long_m)).collect()
}

/// The longest leg, and by how much it bends, metres.
pub(crate) fn longest(vehicle: &Vehicle, flight: &Flight, world: &World) -> (f64, f64) {
    let longest_m = match vehicle.autopilot {
        Autopilot::ArduPilot => legs_m(flight).into_values().fold(0.0, f64::max),
        Autopilot::Px4 => 0.0,
    };
    (longest_m, bend_m(longest_m, world.frame.origin().lat_deg))
}

/// Counts bends that are not small: a vehicle may be anywhere between its leg and the line on its map.
pub(super) fn widen(vehicle: &Vehicle, flight: &mut Flight, world: &World) {
    if longest(vehicle, flight, world).1 <= SMALL_BEND_M {
        return;
    }
    let legs_m = legs_m(flight);
    for chord in &mut flight.chords {
        let long_m = legs_m.get(&chord.row).copied().unwrap_or_default();
        let by_m = bend_m(long_m, world.frame.origin().lat_deg);
        if by_m > SMALL_BEND_M {
            chord.bow_m += by_m;
            chord.wide_m += by_m;
        }
    }
}
