//! What the flight model takes for granted where a number can be put to it.

use crate::geodesy::SMALL_BEND_M;
use crate::path::lean_note;
use crate::spec::{Airframe, MissionSpec, Vehicle, Wind};
use crate::world::World;

use crate::verify::execute::bent_map;
use crate::verify::execute::flight::Flight;
use crate::verify::measure::segment::Segment;

/// Doubts about less than this are not worth a line, metres.
const WORTH_M: f64 = 0.1;

/// Where the map of an autopilot bends its legs.
pub(crate) fn bends<'a>(
    flown: impl Iterator<Item = (&'a Vehicle, &'a Flight)>,
    world: &World,
) -> Option<String> {
    let (long_m, bend_m) = flown
        .map(|(vehicle, flight)| bent_map::greatest_bend(vehicle, flight, world))
        .fold(
            (0.0, 0.0),
            |most: (f64, f64), of| if of.1 > most.1 { of } else { most },
        );
    (bend_m > WORTH_M).then(|| {
        let counted = match bend_m > SMALL_BEND_M {
            true => format!(", which is counted from {SMALL_BEND_M} m on"),
            false => String::new(),
        };
        format!(
            "legs are straight on the earth: the map that ArduPilot steers by bends the longest, {:.1} km, by up to {bend_m:.1} m{counted}",
            long_m / 1000.0
        )
    })
}

/// `ArduPilot` follows a surface of its own: how far that may be off.
pub(crate) fn other_posts<'a>(flights: impl Iterator<Item = &'a Flight>) -> Option<String> {
    let segments = flights.flat_map(|flight| &flight.segments);
    let worst_m = segments.map(Segment::off_m).fold(0.0, f64::max);
    (worst_m > WORTH_M).then(|| {
        format!(
            "ArduPilot follows the terrain of its own posts (TERRAIN_SPACING, 100 m apart where no parameter says otherwise): from the \
             same source they are off by up to {worst_m:.1} m on the way, and heights and distances are judged with what they are off at each place"
        )
    })
}

/// A copter holds its ground speed in the wind (`WPNAV_SPEED` and `MPC_XY_CRUISE` are ground
/// speeds), and pays with airspeed.
pub(crate) fn windy_copters<'a>(
    flown: impl Iterator<Item = (&'a Vehicle, &'a Flight)>,
    wind: Option<Wind>,
) -> Option<String> {
    let wind = wind.filter(|wind| wind.speed_mps > 0.0)?;
    let (id, fastest_mps) = flown
        .filter(|(vehicle, _)| vehicle.airframe == Airframe::Copter)
        .map(|(vehicle, flight)| {
            let commanded = flight.cruises.iter().filter_map(|cruise| cruise.speed_mps);
            (&vehicle.id, commanded.fold(vehicle.speed_mps, f64::max))
        })
        .max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(format!(
        "copters hold their ground speed in a wind of {:.1} m/s: against it {id} must fly at {:.1} m/s through the air",
        wind.speed_mps,
        fastest_mps + wind.speed_mps
    ))
}

/// Copters that fly faster than a stock one of their autopilot was seen to.
pub(crate) fn leaning_copters<'a>(
    flown: impl Iterator<Item = (&'a Vehicle, &'a Flight)>,
    spec: &MissionSpec,
) -> Vec<String> {
    let note = |(vehicle, flight): (&Vehicle, &Flight)| {
        let commanded = flight.cruises.iter().filter_map(|cruise| cruise.speed_mps);
        lean_note(spec, vehicle, commanded.fold(vehicle.speed_mps, f64::max))
    };
    flown.filter_map(note).collect()
}

/// A wing holds its airspeed: what it makes over the ground is up to the wind.
pub(crate) fn carried_wings<'a>(mut vehicles: impl Iterator<Item = &'a Vehicle>) -> Option<String> {
    let wind = vehicles.find_map(Vehicle::carried_by)?;
    Some(format!(
        "wings hold their airspeed and crab in a steady wind of {:.1} m/s from {:.0} degrees, the same at every height: \
         over the ground they are as fast as the wind triangle says, change from leg to leg evenly along the turn, \
         and turn as widely everywhere as with the wind behind them; slopes are over the ground",
        wind.speed_mps,
        wind.from_rad.to_degrees()
    ))
}

/// ArduCopter takes rally points only so far from home.
pub(crate) fn rally_limit(furthest_m: f64) -> Option<String> {
    (furthest_m > 0.0).then(|| {
        format!(
            "RALLY_LIMIT_KM is more than {:.2}: ArduPilot leaves rally points aside that are further away (a copter comes with 0.3)",
            furthest_m / 1000.0
        )
    })
}

/// That the ground of the verdict may stand above the real one.
pub(crate) fn raised_ground(raised_m: f64) -> Option<String> {
    (raised_m > 0.0).then(|| {
        format!(
            "the ground is made of files in a projection or of several spacings: no lower than any of their nodes, with \
             what is uncertain of their places and heights on top, so that it stands up to {raised_m:.1} m above them; \
             greatest heights above ground are judged by as much more, floors of zones above ground by as much less"
        )
    })
}
