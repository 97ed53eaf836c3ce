//! The stops of a vehicle: each alone, and apart from the places before and after it.

use super::Checker;
use crate::geodesy::{Agl, LatLon};
use crate::numeric::digits;
use crate::spec::check::map::Map;
use crate::spec::keys;
use crate::spec::{Arrival, EndPoint, MAX_STOPS, OnWay, Order, Placement, Stop};

/// A place below the least height above ground is at least this high, metres: a PX4 copter (1.17 beta, simulated,
/// one flight) came 1.5 m lower than it was asked to.
const MIN_DROP_AGL_M: f64 = 3.0;

impl Checker {
    /// The stops of a vehicle, as far as each is whole.
    pub(super) fn stops(
        &mut self,
        path: &str,
        keys: &keys::Vehicle,
        map: Option<&Map>,
    ) -> Vec<Stop> {
        let at = |key: &str| format!("{path}.{key}");
        if keys.stops.is_empty() && keys.order.is_some() {
            self.report(&at("order"), "an order without stops", "stops");
        }
        if keys.stops.len() > MAX_STOPS {
            let found = format!("{} stops", keys.stops.len());
            self.report(&at("stops"), found, format!("at most {MAX_STOPS}"));
        }
        let ids = keys.stops.iter().map(|stop| stop.id.as_deref());
        self.unique(&at("stops"), ids);
        let stops = keys.stops.iter().enumerate();
        stops
            .filter_map(|(index, stop)| {
                self.stop(&format!("{path}.stops[{index}]"), stop, keys, map)
            })
            .collect()
    }

    fn stop(
        &mut self,
        path: &str,
        stop: &keys::Stop,
        vehicle: &keys::Vehicle,
        map: Option<&Map>,
    ) -> Option<Stop> {
        let id = self.required(path, "id", stop.id.clone());
        if let Some(id) = &id {
            self.label(&format!("{path}.id"), id);
        }
        let (lat, lon, agl_m, amsl_m) = (stop.lat, stop.lon, stop.agl_m, stop.amsl_m);
        let point = keys::EndPoint {
            lat,
            lon,
            agl_m,
            amsl_m,
        };
        let hovers = !vehicle.airframe.unwrap_or_default().has_wing();
        let end = self.end_point(path, point);
        let (end, drop_m) = self.over_drop(path, end, map.filter(|_| hovers));
        if let (Some(map), Some(end)) = (map, end) {
            self.clear(path, "stop", end.place, map);
            let altitudes = super::limits_of(vehicle, map);
            self.known_point((path, "stop"), Some(end), altitudes, false);
        }
        self.stop_speed(&format!("{path}.speed_mps"), stop, vehicle);
        if !hovers {
            self.stop_on_wing(path, stop);
        }
        let actions = self.actions(path, (&stop.actions, point), vehicle.autopilot);
        Some(Stop {
            id: id?,
            end: end?,
            drop_m,
            hold_s: stop.hold_s.unwrap_or(0.0),
            acceptance_radius_m: stop.acceptance_radius_m,
            heading_rad: stop.heading_deg.map(f64::to_radians),
            actions,
            speed_mps: stop.speed_mps,
            window_s: None,
            wait_s: 0.0,
            arrives: Arrival::Planned,
            trigger_m: None,
        })
    }

    /// The end of a path over a place, and how far down the place is: below the least height above ground it
    /// is reached straight down from that.
    pub(super) fn over_drop(
        &mut self,
        path: &str,
        end: Option<EndPoint>,
        map: Option<&Map>,
    ) -> (Option<EndPoint>, f64) {
        let (Some(end), Some(map)) = (end, map) else {
            return (end, 0.0);
        };
        let Placement::Agl(Agl(agl_m)) = end.altitude else {
            return (Some(end), 0.0);
        };
        if agl_m >= map.area.min_agl.0 {
            return (Some(end), 0.0);
        }
        if agl_m < MIN_DROP_AGL_M {
            let allowed = format!("at least {MIN_DROP_AGL_M} m: it stays in the air there");
            self.report(&format!("{path}.agl_m"), digits::plain(agl_m), allowed);
        }
        let over_m = map.area.min_agl.0 + map.buffers.terrain_m;
        let over = EndPoint {
            altitude: Placement::Agl(Agl(over_m)),
            ..end
        };
        (Some(over), over_m - agl_m)
    }

    /// What is done at start and goal, and along the way.
    pub(super) fn on_way(&mut self, path: &str, keys: &keys::Vehicle) -> OnWay {
        let mut at_end = |key: &str, station: Option<&keys::Station>| {
            let listed = station.map_or(&[][..], |station| station.actions.as_slice());
            let at = station.map(keys::Station::point).unwrap_or_default();
            self.actions(&format!("{path}.{key}"), (listed, at), keys.autopilot)
        };
        let start = at_end("start", keys.start.as_ref());
        let goal = at_end("goal", keys.goal.as_ref());
        let has_wing = keys.airframe.unwrap_or_default().has_wing();
        let ends = [("start", &keys.start), ("goal", &keys.goal)];
        for (key, station) in ends.into_iter().filter(|_| has_wing) {
            let listed = station.as_ref().map_or(&[][..], |of| of.actions.as_slice());
            self.hovers(&format!("{path}.{key}"), listed);
        }
        let camera = keys.camera.as_ref();
        let trigger_m = camera.and_then(|camera| {
            let path = format!("{path}.camera");
            self.required(&path, "trigger_distance_m", camera.trigger_distance_m)
        });
        OnWay {
            start,
            goal,
            trigger_m,
        }
    }

    /// A wing does not hover: its nose points where it flies.
    fn stop_on_wing(&mut self, path: &str, stop: &keys::Stop) {
        if stop.heading_deg.is_some() {
            let found = "a heading, on a wing: it flies past a stop, or around it";
            self.report(&format!("{path}.heading_deg"), found, "no heading_deg");
        }
        if stop.speed_mps.is_some() {
            let found = "a speed from a stop on, on a wing";
            self.report(
                &format!("{path}.speed_mps"),
                found,
                "speed_mps of the vehicle",
            );
        }
        self.hovers(path, &stop.actions);
    }

    /// A speed from a stop on needs a known order, and is no choice of the planner.
    fn stop_speed(&mut self, path: &str, stop: &keys::Stop, vehicle: &keys::Vehicle) {
        if stop.speed_mps.is_none() {
            return;
        }
        if vehicle.order == Some(Order::Free) {
            let found = "a speed from a stop on, and order: free";
            self.report(path, found, "order: fixed, or speed_mps of the vehicle");
        }
        if vehicle.speed_range_mps.is_some() {
            let found = "a speed from a stop on, and speed_range_mps";
            self.report(path, found, "one of them");
        }
    }

    /// There must be a path to plan from each place to the next: in a free order from each to
    /// each.
    pub(super) fn stops_apart(
        &mut self,
        path: &str,
        keys: &keys::Vehicle,
        (start, goal): (LatLon, LatLon),
        (stops, min_m): (&[Stop], f64),
    ) {
        if stops.len() != keys.stops.len() {
            // A broken one is reported already.
            return;
        }
        let is_free = keys.order == Some(Order::Free);
        let names = |index: usize| format!("stop `{}`", stops[index].id.escape_debug());
        for (index, stop) in stops.iter().enumerate() {
            let mut before: Vec<(String, LatLon)> = Vec::new();
            if is_free || index == 0 {
                before.push(("start".to_owned(), start));
            }
            if (is_free || index + 1 == stops.len()) && keys.goal.is_some() {
                before.push(("goal".to_owned(), goal));
            }
            let first = if is_free { 0 } else { index.saturating_sub(1) };
            let others = (first..index).map(|other| (names(other), stops[other].end.place));
            before.extend(others);
            for (what, place) in before {
                let apart_m = stop.end.place.chord_m(place);
                if apart_m < min_m {
                    let found =
                        format!("{} m from {what}", digits::distinct_from(apart_m, min_m, 1));
                    let allowed = format!("at least {min_m} m from {what}");
                    self.report(&format!("{path}.stops[{index}]"), found, allowed);
                }
            }
        }
    }
}
