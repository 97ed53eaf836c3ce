//! Where a vehicle stands, starts and is to arrive.

use super::{MIN_START_TO_GOAL_M, limits_of, may_drop};
use crate::geodesy::{Agl, Amsl, LatLon};
use crate::numeric::digits;
use crate::spec::check::Checker;
use crate::spec::check::map::Map;
use crate::spec::{EndPoint, KnownPlace, PlaceKind, Placement, keys};

/// Where a vehicle stands, and the ends of its planned path; none where broken.
pub(super) struct Ends {
    pub(super) home: Option<LatLon>,
    pub(super) start: Option<EndPoint>,
    pub(super) goal: Option<EndPoint>,
    /// From a home of its own, metres.
    pub(super) home_to_start_m: Option<f64>,
}

impl Checker {
    /// Home, start and goal: apart, and where something may stand.
    pub(super) fn ends(&mut self, path: &str, keys: &keys::Vehicle, map: Option<&Map>) -> Ends {
        let at = |key: &str| format!("{path}.{key}");
        let start = self.required(path, "start", keys.start.as_ref());
        let start = start.and_then(|end| self.end_point(&at("start"), end.point()));
        let is_round = keys.goal.is_none() && !keys.stops.is_empty();
        let goal = if is_round {
            start
        } else {
            if keys.goal.is_none() {
                let allowed = format!(
                    "a goal at least {MIN_START_TO_GOAL_M} m from start; only with stops of its own a vehicle comes back to its start"
                );
                self.missing(path, "goal", allowed);
            }
            let goal = keys.goal.as_ref();
            goal.and_then(|end| self.end_point(&at("goal"), end.point()))
        };
        let own_home = keys.home.and_then(|home| self.place(&at("home"), home));
        let goal_point = goal;
        let (from, to) = (start.map(|end| end.place), goal.map(|end| end.place));
        if keys.stops.is_empty() {
            self.start_to_goal(&at("goal"), from, to);
        }
        if let Some(map) = map {
            let goal = to.filter(|_| !is_round);
            for (key, place) in [("start", from), ("goal", goal), ("home", own_home)] {
                if let Some(place) = place {
                    self.clear(&at(key), key, place, map);
                }
            }
            let altitudes = limits_of(keys, map);
            self.known_point((&at("start"), "start"), start, altitudes, false);
            let goal = goal_point.filter(|_| !is_round);
            self.known_point((&at("goal"), "goal"), goal, altitudes, may_drop(keys));
            if let Some(home) = own_home.or(from.filter(|_| keys.home.is_none())) {
                self.sites.push(KnownPlace {
                    path: at("home"),
                    kind: PlaceKind::Home(home),
                });
            }
        }
        Ends {
            home: own_home.or(from.filter(|_| keys.home.is_none())),
            start,
            goal,
            home_to_start_m: from.zip(own_home).map(|(start, home)| start.chord_m(home)),
        }
    }

    /// There must be a path to plan between start and goal.
    fn start_to_goal(&mut self, path: &str, start: Option<LatLon>, goal: Option<LatLon>) {
        let (Some(start), Some(goal)) = (start, goal) else {
            return;
        };
        let apart_m = (start.to_ecef(0.0) - goal.to_ecef(0.0)).norm();
        if apart_m < MIN_START_TO_GOAL_M {
            let found = format!(
                "{} m from start",
                digits::distinct_from(apart_m, MIN_START_TO_GOAL_M, 1)
            );
            self.report(
                path,
                found,
                format!("at least {MIN_START_TO_GOAL_M} m from start"),
            );
        }
    }

    pub(in crate::spec::check) fn end_point(
        &mut self,
        path: &str,
        keys: keys::EndPoint,
    ) -> Option<EndPoint> {
        let (lat, lon) = (keys.lat, keys.lon);
        let place = self.place(path, keys::Place { lat, lon });
        let altitude = match (keys.agl_m, keys.amsl_m) {
            (Some(agl), None) => Placement::Agl(Agl(agl)),
            (None, Some(amsl)) => Placement::Amsl(Amsl(amsl)),
            (None, None) | (Some(_), Some(_)) => {
                let found = match keys.agl_m {
                    Some(_) => "two altitudes",
                    None => "no altitude",
                };
                self.report(path, found, "either agl_m or amsl_m");
                return None;
            }
        };
        place.map(|place| EndPoint { place, altitude })
    }
}
