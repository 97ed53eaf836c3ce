//! How late and how early vehicles follow a commanded altitude; the figures are in
//! [`crate::autopilot::Behaviour`].

use std::slice::from_ref;

use crate::autopilot::{Autopilot, SLOPE_MIN};
use crate::mission::VehicleMission;
use crate::spec::Vehicle;

use super::items;
use crate::verify::execute::legs::Knot;
use crate::verify::execute::trajectory::AltitudeLine;

/// A lag of a descent is still there after a leg for this many times the lag.
const LASTS: f64 = 2.0;

/// Changes of altitude from one waypoint to the next that are smaller than this are flown at once
/// (`Plane::set_offset_altitude_location`), metres; 0 except on a wing of ArduPilot.
pub(crate) fn threshold_m(mission: &VehicleMission) -> f64 {
    let Some(row) = mission.facts().parameter(SLOPE_MIN[0]) else {
        return 0.0;
    };
    let held = mission.param(SLOPE_MIN[0]);
    // Stored as a whole number. With 0 there is no slope at all.
    match held.map_or(row.default_si(), f64::trunc) {
        metres if metres > 0.0 => metres,
        _ => f64::INFINITY,
    }
}

/// Lag behind a slope, seconds of the climb rate; 0 except on a wing.
pub(crate) fn lag_s(mission: &VehicleMission) -> f64 {
    let figure = mission.facts().behaviour.altitude_lag_s;
    figure.value(mission.autopilot_version)
}

/// Distance before a waypoint at which PX4 has its altitude, metres: on a wing (`FixedWingPositionControl`, the
/// altitude of a leg; assumed, not measured), and all the way on a copter with its heights at once; else 0.
pub(crate) fn early_m(vehicle: &Vehicle, mission: &VehicleMission) -> f64 {
    if (mission.facts()).has_heights_at_once(mission.autopilot_version) {
        return f64::INFINITY;
    }
    match (mission.autopilot, vehicle.wing) {
        (Autopilot::Px4, Some(wing)) => items::loiter_radius_m(mission)
            .unwrap_or(wing.loiter_radius_m)
            .max(wing.loiter_radius_m),
        _ => 0.0,
    }
}

/// How a wing comes to the end of its legs.
#[derive(Default)]
pub(crate) struct Arrival {
    /// The altitudes off the line of the last of them.
    pub(super) lines: Vec<AltitudeLine>,
    /// How far below and above its altitude it still is at the end, metres.
    pub(super) left_m: [f64; 2],
}

/// What is left on a leg of the slopes behind it. Pairs are of climbs and descents.
#[derive(Default)]
pub(super) struct Lag {
    /// How long slopes are still followed, seconds.
    lags_s: [f64; 2],
    /// The one of every wing, seconds.
    usual_s: f64,
    /// The rates of the legs behind, m/s.
    rates: Behind,
    /// What each leaves at its end, metres.
    left: Behind,
    /// The highest altitude of each, metres above the sea.
    tops: Behind,
}

/// A leg as it lags behind.
pub(super) struct Lagging {
    flown_s: f64,
    rate_mps: [f64; 2],
    left_m: [f64; 2],
    top_m: f64,
    descends: bool,
    follows: bool,
}

impl Lag {
    /// The lag of every wing, and that of a QuadPlane that comes down from its climb, seconds.
    pub(super) fn new(usual_s: f64, transition_s: f64) -> Self {
        Self {
            lags_s: [usual_s, usual_s.max(transition_s)],
            usual_s,
            ..Self::default()
        }
    }

    fn lasts_s(&self) -> [f64; 2] {
        self.lags_s.map(|lag_s| LASTS * lag_s)
    }

    /// A leg between two knots that takes so long, seconds.
    pub(super) fn leg(&self, line: &AltitudeLine, flown_s: f64, ends: &[Knot]) -> Lagging {
        let climb_m = both_ways(line.change_m());
        let rate_mps = climb_m.map(|climb_m| climb_m / flown_s);
        // How much it climbs over the ground that it follows is not looked at.
        let (left_m, top_m) = match line.follows {
            true => ([f64::INFINITY; 2], f64::INFINITY),
            false => (
                [0, 1].map(|way| climb_m[way].min(self.lags_s[way] * rate_mps[way])),
                (ends.iter()).fold(f64::NEG_INFINITY, |top_m, end| top_m.max(end.amsl_m)),
            ),
        };
        Lagging {
            flown_s,
            rate_mps,
            left_m,
            top_m,
            descends: climb_m[1] > 0.0,
            follows: line.follows,
        }
    }

    /// How far below and above its line a wing is on a leg, and how high at most, metres: it stays up, and does
    /// not climb over what it flew, but for the lag of every wing.
    pub(super) fn offsets_m(&self, leg: &Lagging) -> ([f64; 2], f64) {
        let lasts_s = self.lasts_s();
        let before = self.rates.0.last().map_or([0.0; 2], |last| last.0);
        let max_mps = [
            leg.rate_mps[0].max(before[0]),
            (self.rates.values(1, lasts_s)).fold(leg.rate_mps[1], f64::max),
        ];
        let offs_m = [0, 1].map(|way| {
            // What each leg leaves is no more than it climbs, however steep.
            let behind = self.left.values(way, lasts_s);
            let left_m = behind.fold(leg.left_m[way], |sum_m, more_m| sum_m + more_m);
            (self.lags_s[way] * max_mps[way]).min(left_m)
        });
        let tops = self.tops.values(1, lasts_s);
        let top_m = tops.fold(leg.top_m, f64::max) + self.usual_s * max_mps[1];
        (offs_m, top_m)
    }

    /// What is left below and above behind the last leg, metres.
    pub(super) fn left_m(&self, end: &Knot) -> [f64; 2] {
        let level = AltitudeLine::between(false, (end.amsl_m, end.amsl_m));
        let level = self.leg(&level, 1.0, from_ref(end));
        let ([below_m, above_m], top_m) = self.offsets_m(&level);
        [below_m, above_m.min(top_m - end.amsl_m)]
    }

    /// Flies a leg. `is_free`: nothing is known of its rate.
    pub(super) fn go_on(&mut self, leg: &Lagging, is_free: bool) {
        let lasts_s = self.lasts_s();
        if is_free || leg.follows {
            self.rates.0.clear();
        } else {
            self.rates.go_on(leg.rate_mps, leg.flown_s, lasts_s);
        }
        self.left.go_on(leg.left_m, leg.flown_s, lasts_s);
        self.tops.go_on([leg.top_m; 2], leg.flown_s, lasts_s);
        if !leg.descends && leg.flown_s > lasts_s[1] {
            self.lags_s[1] = self.usual_s;
        }
    }
}

/// A figure of the legs behind, up and down, and how long ago each ended, seconds.
#[derive(Default)]
struct Behind(Vec<([f64; 2], f64)>);

impl Behind {
    /// Adds a leg that took so long; those that ended long ago no longer count.
    fn go_on(&mut self, value: [f64; 2], flown_s: f64, lasts_s: [f64; 2]) {
        for (_, ago_s) in &mut self.0 {
            *ago_s += flown_s;
        }
        self.0.push((value, 0.0));
        self.0
            .retain(|(_, ago_s)| lasts_s.iter().any(|lasts_s| ago_s < lasts_s));
    }

    /// The figures one way: 0 up, 1 down.
    fn values(&self, way: usize, lasts_s: [f64; 2]) -> impl Iterator<Item = f64> {
        let recent = (self.0.iter()).filter(move |(_, ago_s)| *ago_s < lasts_s[way]);
        recent.map(move |(value, _)| value[way])
    }
}

/// A climb up and down: only one of them is more than 0.
fn both_ways(climb: f64) -> [f64; 2] {
    [climb.max(0.0), (-climb).max(0.0)]
}
