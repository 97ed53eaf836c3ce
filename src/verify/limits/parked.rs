//! Landings where another vehicle stands: the separation counts nothing that is on the ground.

use crate::numeric::digits::count;
use crate::numeric::tracks::{CLEARED_AFTER_S, LEVEL_M, clear_m};
use crate::verify::{Limit, Margin, Moment, Requirement, Track};

/// Places nearer to each other than this may be one, metres: within the errors of two positions.
const NEAR_M: f64 = 10.0;
/// Landings that are named one by one.
const NAMED: usize = 3;

/// A place where a vehicle stands, and when: before it takes off, or once it is down.
struct Parked<'a> {
    vehicle: &'a str,
    at: &'a Moment,
    is_down: bool,
}

/// Whether someone carries landed vehicles away.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Landed {
    /// Where two vehicles of a spec end at one place.
    CarriedAway,
    /// Nothing says that they share the place on purpose.
    Stay,
}

/// A margin for each vehicle that lands near another one that stands there then: the distance, or how long the other
/// one is down before.
#[must_use]
pub fn landings(tracks: &[Track], landed: Landed, separation_m: f64) -> Vec<Margin> {
    let mut parked: Vec<Parked<'_>> = tracks.iter().flat_map(ends).collect();
    parked.sort_by(|a, b| lat_deg(a.at).total_cmp(&lat_deg(b.at)));
    let clear_m = clear_m(separation_m);
    let landings = parked.iter().filter(|one| one.is_down);
    landings
        .filter_map(|one| margin(one, &parked, landed, clear_m))
        .collect()
}

/// What an operator must know of the landings that these margins allow: a sentence each, and one for all that are more.
#[must_use]
pub fn landings_on_parked(margins: &[Margin]) -> Vec<String> {
    let allowed = margins
        .iter()
        .filter(|margin| margin.limit == Limit::LandingPlace && margin.ok);
    let mut found: Vec<String> = allowed
        .map(|margin| {
            format!(
                "{}: what stands on the ground does not count for the separation; clear the place before",
                margin.note
            )
        })
        .collect();
    if found.len() > NAMED {
        let more = found.len() - NAMED;
        found.truncate(NAMED);
        found.push(format!("{} like these", count(more, "more landing")));
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

/// The margin of a landing to the vehicle that is most in its way; `parked` goes from south to north.
fn margin(
    landing: &Parked<'_>,
    parked: &[Parked<'_>],
    landed: Landed,
    clear_m: f64,
) -> Option<Margin> {
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
    let measured = near
        .filter(stands)
        .map(|other| (other, away_m(landing.at, other.at)))
        .filter(|(_, away_m)| *away_m < NEAR_M);
    // Who is in the way comes first, then who is nearest.
    let is_clear = |(other, away_m): &(&Parked<'_>, f64)| {
        *away_m >= clear_m || other.is_down && is_carried_away(landing, other, landed)
    };
    let (other, away_m) =
        measured.min_by(|a, b| is_clear(a).cmp(&is_clear(b)).then(a.1.total_cmp(&b.1)))?;
    let required = match other.is_down && landed == Landed::CarriedAway && away_m < clear_m {
        true => Requirement::at_least(Limit::LandingPlace, CLEARED_AFTER_S, "s").margin(
            landing.vehicle,
            landing.at.t_s - other.at.t_s,
            Some(*landing.at),
        ),
        false => Requirement::at_least(Limit::LandingPlace, clear_m, "m").margin(
            landing.vehicle,
            away_m,
            Some(*landing.at),
        ),
    };
    Some(Margin {
        other: Some(other.vehicle.to_owned()),
        note: sentence(landing, other, away_m),
        ..required
    })
}

fn is_carried_away(landing: &Parked<'_>, other: &Parked<'_>, landed: Landed) -> bool {
    landed == Landed::CarriedAway && landing.at.t_s - other.at.t_s >= CLEARED_AFTER_S
}

fn sentence(landing: &Parked<'_>, other: &Parked<'_>, away_m: f64) -> String {
    let when = if other.is_down { "from" } else { "until" };
    format!(
        "{} lands {away_m:.1} m from where {} stands {when} T0{:+.0} s{}",
        landing.vehicle,
        other.vehicle,
        other.at.t_s,
        if other.is_down { " on" } else { "" },
    )
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

    fn of(tracks: &[Track], landed: Landed) -> Vec<Margin> {
        landings(tracks, landed, 50.0)
    }

    #[test]
    fn a_landing_is_judged_where_another_vehicle_stands_at_that_time() {
        let alpha = track("alpha", (8.00, 0.0), (8.01, 100.0));
        // Down there long before, or just now, or not yet gone; and gone before, coming later, or beside it.
        for (other, is_ok) in [
            (track("bravo", (8.02, 0.0), (8.01, 60.0)), Some(true)),
            (track("bravo", (8.02, 0.0), (8.01, 90.0)), Some(false)),
            (track("bravo", (8.01, 110.0), (8.02, 200.0)), Some(false)),
            (track("bravo", (8.01, 0.0), (8.00, 100.0)), None),
            (track("bravo", (8.02, 0.0), (8.0102, 90.0)), None),
            // Five metres beside it.
            (
                track("bravo", (8.010_063, 110.0), (8.02, 200.0)),
                Some(true),
            ),
        ] {
            let found = of(&[alpha.clone(), other.clone()], Landed::CarriedAway);
            let found: Vec<bool> = found.iter().map(|margin| margin.ok).collect();
            assert_eq!(found, Vec::from_iter(is_ok), "{other:?}");
        }
        let later = track("bravo", (8.02, 0.0), (8.01, 160.0));
        let both = [alpha, later];
        let found = landings_on_parked(&of(&both, Landed::CarriedAway));
        assert!(found[0].starts_with("bravo lands 0.0 m from where alpha stands from T0+100 s on"));
        assert!(!of(&both, Landed::Stay)[0].ok);
    }

    #[test]
    fn of_a_swarm_on_one_pad_three_landings_are_named() {
        let swarm =
            (0..9).map(|k| track(&format!("v{k}"), (8.1, 0.0), (8.0, 100.0 * f64::from(k))));
        let found = of(&swarm.collect::<Vec<_>>(), Landed::CarriedAway);
        let found = landings_on_parked(&found);
        assert_eq!(found.len(), 4);
        assert_eq!(found[3], "5 more landings like these");
    }
}
