//! Landings where another vehicle stands: no separation counts what is on the ground.

use crate::verify::{Moment, Track};

/// Places nearer to each other than this are one, metres: within the errors of two positions.
const NEAR_M: f64 = 10.0;
/// Ends of flights whose altitudes differ by more are not both on the ground, metres.
const LEVEL_M: f64 = 3.0;
/// Landings that are named one by one.
const NAMED: usize = 3;

/// A place where a vehicle stands, and when: before it takes off, or once it is down.
struct Parked<'a> {
    vehicle: &'a str,
    at: &'a Moment,
    is_down: bool,
}

/// Which vehicles land where another one stands then: a sentence each, and one for all that are more.
#[must_use]
pub fn landings_on_parked(tracks: &[Track]) -> Vec<String> {
    let mut parked: Vec<Parked<'_>> = tracks.iter().flat_map(ends).collect();
    parked.sort_by(|a, b| lat_deg(a.at).total_cmp(&lat_deg(b.at)));
    let landings = parked.iter().filter(|one| one.is_down);
    let mut found: Vec<String> = landings.filter_map(|one| sentence(one, &parked)).collect();
    if found.len() > NAMED {
        let more = found.len() - NAMED;
        found.truncate(NAMED);
        found.push(format!("{more} more landings like these"));
    }
    found
}

fn ends(track: &Track) -> impl Iterator<Item = Parked<'_>> {
    let end = |at, is_down| Parked {
        vehicle: &track.vehicle,
        at,
        is_down,
    };
    let first = track.moments.first().map(|at| end(at, false));
    let last = track.moments.last().map(|at| end(at, true));
    first.into_iter().chain(last)
}

fn lat_deg(moment: &Moment) -> f64 {
    moment.place.lat_deg
}

/// A landing and the nearest vehicle that stands there; `parked` goes from south to north.
fn sentence(landing: &Parked<'_>, parked: &[Parked<'_>]) -> Option<String> {
    /// Metres of a degree of latitude, no more.
    const MIN_DEGREE_M: f64 = 110_000.0;
    let (lat, reach) = (lat_deg(landing.at), NEAR_M / MIN_DEGREE_M);
    let from = parked.partition_point(|other| lat_deg(other.at) < lat - reach);
    let near = parked[from..]
        .iter()
        .take_while(|other| lat_deg(other.at) <= lat + reach);
    let stands = |other: &&Parked<'_>| {
        let at_s = landing.at.t_s;
        let is_there = if other.is_down {
            other.at.t_s <= at_s
        } else {
            at_s <= other.at.t_s
        };
        is_there && other.vehicle != landing.vehicle
    };
    let away_m = |other: &Parked<'_>| away_m(landing.at, other.at);
    let nearest = near
        .filter(stands)
        .min_by(|a, b| away_m(a).total_cmp(&away_m(b)))?;
    (away_m(nearest) < NEAR_M).then(|| {
        let when = if nearest.is_down { "from" } else { "until" };
        format!(
            "{} lands {:.1} m from where {} stands {when} T0{:+.0} s{}: what stands on the ground does not count for \
             the separation; clear the place before",
            landing.vehicle,
            away_m(nearest),
            nearest.vehicle,
            nearest.at.t_s,
            if nearest.is_down { " on" } else { "" },
        )
    })
}

/// Distance on the ground, metres; infinite if one is in the air.
fn away_m(one: &Moment, other: &Moment) -> f64 {
    match (one.amsl.0 - other.amsl.0).abs() <= LEVEL_M {
        true => one.place.chord_m(other.place),
        false => f64::INFINITY,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geodesy::{Amsl, LatLon};

    /// A flight from one place to another, as degrees of longitude at 45 degrees north, by its times.
    fn track(vehicle: &str, (from, from_s): (f64, f64), (to, to_s): (f64, f64)) -> Track {
        let moment = |lon_deg, t_s| Moment {
            place: LatLon {
                lat_deg: 45.0,
                lon_deg,
            },
            amsl: Amsl(400.0),
            t_s,
            item: 1,
        };
        Track {
            vehicle: vehicle.to_owned(),
            moments: vec![moment(from, from_s), moment(to, to_s)],
            late_s: Vec::new(),
        }
    }

    #[test]
    fn a_landing_is_named_where_another_vehicle_stands_at_that_time() {
        let alpha = track("alpha", (8.00, 0.0), (8.01, 100.0));
        // Down there before, or not yet gone; and gone before, coming later, or beside it.
        for (other, is_named) in [
            (track("bravo", (8.02, 0.0), (8.01, 90.0)), true),
            (track("bravo", (8.01, 110.0), (8.02, 200.0)), true),
            (track("bravo", (8.01, 0.0), (8.00, 100.0)), false),
            (track("bravo", (8.02, 0.0), (8.0102, 90.0)), false),
        ] {
            let found = landings_on_parked(&[alpha.clone(), other.clone()]);
            assert_eq!(found.len(), usize::from(is_named), "{other:?}: {found:?}");
        }
        let later = track("bravo", (8.02, 0.0), (8.01, 110.0));
        let found = landings_on_parked(&[alpha, later]);
        assert!(found[0].starts_with("bravo lands 0.0 m from where alpha stands from T0+100 s on"));
    }

    #[test]
    fn of_a_swarm_on_one_pad_three_landings_are_named() {
        let swarm = (0..9).map(|k| track(&format!("v{k}"), (8.1, 0.0), (8.0, f64::from(k))));
        let found = landings_on_parked(&swarm.collect::<Vec<_>>());
        assert_eq!(found.len(), 4);
        assert_eq!(found[3], "5 more landings like these");
    }
}
