//! What the flight model takes for granted where a number can be put to it.

use crate::geodesy::{LatLon, SMALL_BEND_M};
use crate::path::lean_note;
use crate::spec::{Airframe, MissionSpec, Vehicle, Wind};
use crate::world::World;

use crate::verify::execute::bent_map;
use crate::verify::execute::flight::Flight;
use crate::verify::measure::outline::metres_per_degree;

/// Doubts about less than this are not worth a line, metres.
const WORTH_M: f64 = 0.1;

/// Where the map of an autopilot bends its legs.
pub(crate) fn bends<'a>(
    flown: impl Iterator<Item = (&'a Vehicle, &'a Flight)>,
    world: &World,
) -> Option<String> {
    let (long_m, bend_m) = flown
        .map(|(vehicle, flight)| bent_map::most_bent(vehicle, flight, world))
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

/// Distance between the posts of ArduPilot's own grid, metres: `TERRAIN_SPACING`.
const POSTS_M: f64 = 100.0;
/// Places along the way at which the two surfaces are compared are so far apart, metres.
const EVERY_M: f64 = 25.0;

/// ArduPilot follows a surface of its own, bilinear between posts 100 m apart with the
/// heights of the same source. Where the posts lie is its affair: the worst of 16 ways counts.
pub(crate) fn other_posts<'a>(
    flights: impl Iterator<Item = &'a Flight>,
    world: &World,
) -> Option<String> {
    let (mut worst_m, mut due_m) = (0.0_f64, 0.0);
    for segment in flights
        .flat_map(|flight| &flight.segments)
        .filter(|segment| segment.agl_m.is_some())
    {
        let length_m = segment.from.at.distance_m(segment.to.at);
        while due_m < length_m {
            let place = world.frame.from_plan(segment.at(due_m / length_m).at);
            worst_m = worst_m.max(apart_m(world, place));
            due_m += EVERY_M;
        }
        due_m -= length_m;
    }
    (worst_m > WORTH_M).then(|| {
        format!(
            "ArduPilot follows the terrain of its own posts, {POSTS_M:.0} m apart (TERRAIN_SPACING): from the same source they can be off by up to {worst_m:.1} m on the way"
        )
    })
}

/// How far the two surfaces can differ at a place, metres; voids are judged elsewhere.
fn apart_m(world: &World, at: LatLon) -> f64 {
    const WAYS: u32 = 4;
    let (north, east) = metres_per_degree(at.lat_deg);
    let ground_m = |east_m: f64, north_m: f64| {
        let place = LatLon {
            lat_deg: at.lat_deg + north_m / north,
            lon_deg: at.lon_deg + east_m / east,
        };
        world.terrain.height(place).ok().map(|amsl| amsl.0)
    };
    let share = |way: u32| f64::from(way) / f64::from(WAYS);
    let between = |x: f64, y: f64| {
        // The place lies at (x, y) of a cell.
        let post = |right: f64, up: f64| ground_m((right - x) * POSTS_M, (up - y) * POSTS_M);
        let south = post(0.0, 0.0)? * (1.0 - x) + post(1.0, 0.0)? * x;
        let north = post(0.0, 1.0)? * (1.0 - x) + post(1.0, 1.0)? * x;
        Some(south * (1.0 - y) + north * y)
    };
    let Some(here_m) = ground_m(0.0, 0.0) else {
        return 0.0;
    };
    (0..WAYS)
        .flat_map(|x| (0..WAYS).filter_map(move |y| between(share(x), share(y))))
        .map(|posts_m| (posts_m - here_m).abs())
        .fold(0.0, f64::max)
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
