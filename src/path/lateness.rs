//! How much later than the flight model real autopilots are.
//!
//! The figures and their sources are in [`crate::autopilot::Behaviour`].

use crate::autopilot::Airframe;
use crate::geodesy::{Amsl, LatLon};
use crate::spec::{Span, Vehicle};
use crate::world::Departure;

/// By how much a stop may take longer than in the flight model, seconds.
#[must_use]
pub fn stop_late_s(vehicle: &Vehicle) -> f64 {
    let behaviour = &vehicle.facts().behaviour;
    behaviour.stop_late_s.value(vehicle.autopilot_version)
}

/// By how much a vehicle may be later at the end of a leg than at its beginning, seconds.
#[must_use]
pub fn leg_late_s(vehicle: &Vehicle) -> f64 {
    let behaviour = &vehicle.facts().behaviour;
    behaviour.leg_late_s.value(vehicle.autopilot_version)
}

/// By how much longer a leg may take besides, as a share of its time: of vehicles with their heights at once.
#[must_use]
pub fn late_share(vehicle: &Vehicle) -> f64 {
    let (facts, version) = (vehicle.facts(), vehicle.autopilot_version);
    if facts.has_heights_at_once(version) {
        facts.behaviour.late_share.value(version)
    } else {
        0.0
    }
}

/// By how much a vehicle may be later after a corner that it slows down for, seconds.
#[must_use]
pub fn corner_late_s(vehicle: &Vehicle) -> f64 {
    let behaviour = &vehicle.facts().behaviour;
    behaviour.corner_late_s.value(vehicle.autopilot_version)
}

/// Seconds after the takeoff from which [`leg_late_share`] counts. Lateness from the takeoff on was measured on flights
/// of up to eight minutes, and includes what a copter loses on its sphere in that time.
pub const COUNTS_AFTER_S: f64 = 600.0;

/// By how much longer a copter takes for a leg than in the flight model, as a share of the time; negative: less. It flies its
/// speed in metres of a sphere: at 36 degrees ArduPilot is 0.32 % late to the north and 0.13 % early to the east.
/// Wings fly a speed through the air.
#[must_use]
pub fn leg_late_share(vehicle: &Vehicle, from: LatLon, to: LatLon) -> f64 {
    let true_m = from.chord_m(to);
    if vehicle.airframe != Airframe::Copter || true_m < 1.0 {
        return 0.0;
    }
    let turn_deg = (to.lon_deg - from.lon_deg + 540.0).rem_euclid(360.0) - 180.0;
    let middle_rad = (0.5 * (from.lat_deg + to.lat_deg)).to_radians();
    let off_deg = (to.lat_deg - from.lat_deg).hypot(turn_deg * middle_rad.cos());
    vehicle.autopilot.earth_radius_m() * off_deg.to_radians() / true_m - 1.0
}

/// By how much a vehicle may be late from its takeoff on, seconds. Any lateness in the span may
/// be: a vehicle with lighter propellers, or a simulated one, is less late than those measured.
/// It is taken to be the same for two vehicles of one autopilot and airframe that take off.
#[must_use]
pub fn takeoff_lateness_s(vehicle: &Vehicle) -> Span {
    let behaviour = &vehicle.facts().behaviour;
    let value = |figure: crate::autopilot::Figure| figure.value(vehicle.autopilot_version);
    Span {
        least: 0.0 - value(behaviour.takeoff_early_s),
        most: value(behaviour.takeoff_late_s),
    }
}

/// By how much earlier or later a landing on rotors is where its slow end begins at its height above home and not above
/// the ground, seconds: that depends on a rangefinder or terrain data on board (`Mode::get_alt_above_ground_m`,
/// `FlightTask::_evaluateDistanceToGround`). It descends from the top to the ground, fast and below that height slowly.
#[must_use]
pub fn landing_shift_s(
    (top, home, ground): (Amsl, Amsl, Amsl),
    slow_below_m: f64,
    (fast_mps, slow_mps): (f64, f64),
) -> Span {
    let within = |amsl_m: f64| amsl_m.min(top.0).max(ground.0);
    let more_m = within(home.0 + slow_below_m) - within(ground.0 + slow_below_m);
    let late_s = more_m * (1.0 / slow_mps - 1.0 / fast_mps);
    Span {
        least: late_s.min(0.0),
        most: late_s.max(0.0),
    }
}

/// By how much longer a flight may last for its takeoff than in the flight model, seconds: a vehicle that begins in
/// the air has none.
#[must_use]
pub fn longer_for_takeoff_s(vehicle: &Vehicle, departure: Departure) -> f64 {
    match departure {
        Departure::Ground => takeoff_lateness_s(vehicle).most,
        Departure::Airborne { .. } => 0.0,
    }
}

/// A vehicle, and whether it is in the air already.
#[derive(Clone, Copy, Debug)]
pub struct Departing<'a> {
    /// The vehicle.
    pub vehicle: &'a Vehicle,
    /// Whether its path begins in the air.
    pub is_airborne: bool,
}

impl Departing<'_> {
    fn is_of_kind_of(&self, other: &Self) -> bool {
        let kind = |of: &Self| (of.vehicle.autopilot, of.vehicle.airframe);
        kind(self) == kind(other)
    }

    /// Whether two vehicles are late alike: of one autopilot and airframe, and both on the ground or both in the air.
    fn is_late_alike(&self, other: &Self) -> bool {
        self.is_of_kind_of(other) && self.is_airborne == other.is_airborne
    }

    /// By how much it may be early or late against another that is not late alike. Of one kind, the one in the air has its
    /// takeoff behind it. Of others it counts there as well: the figures include what they lose on their ways.
    fn lateness_against_s(&self, other: &Self) -> Span {
        if self.is_airborne && self.is_of_kind_of(other) {
            return Span {
                least: 0.0,
                most: 0.0,
            };
        }
        takeoff_lateness_s(self.vehicle)
    }
}

/// By how much the second of two vehicles may be shifted against the first without any shift of
/// departures, seconds: by the lateness of both where they are not late alike.
#[must_use]
pub fn takeoff_shift_s(a: Departing<'_>, b: Departing<'_>) -> Span {
    if a.is_late_alike(&b) {
        return Span {
            least: 0.0,
            most: 0.0,
        };
    }
    let (late, other) = (a.lateness_against_s(&b), b.lateness_against_s(&a));
    Span {
        least: late.least - other.most,
        most: late.most - other.least,
    }
}

/// That, with the stops behind each of them.
#[must_use]
pub fn with_stops_s(shift_s: Span, late_s: f64, other_late_s: f64) -> Span {
    Span {
        least: shift_s.least - other_late_s,
        most: shift_s.most + late_s,
    }
}

/// The most that two of these may be shifted against each other by what autopilots are late or
/// early, seconds; each comes with what its stops make it late by, and its way early (negative).
#[must_use]
pub fn max_shift_s<'a>(fleet: impl Iterator<Item = (Departing<'a>, Span)>) -> f64 {
    let (mut min_s, mut max_s) = (0.0_f64, 0.0_f64);
    let (mut late_s, mut early_s) = (0.0_f64, 0.0_f64);
    let (mut first, mut are_alike) = (None, true);
    for (one, on_its_way) in fleet {
        let late = takeoff_lateness_s(one.vehicle);
        (min_s, max_s) = (min_s.min(late.least), max_s.max(late.most));
        late_s = late_s.max(on_its_way.most);
        early_s = early_s.max(-on_its_way.least);
        are_alike &= first.get_or_insert(one).is_late_alike(&one);
    }
    let alike_s = late_s + early_s;
    if are_alike {
        alike_s
    } else {
        alike_s + max_s - min_s
    }
}
