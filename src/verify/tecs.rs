//! Altitudes beside the line of a leg, which ArduPlane flies: its altitude and speed controller
//! (TECS) follows a slope late, and small changes of altitude are no slopes.

use crate::mission::{ALTITUDE_SLOPE_MIN, VehicleMission};
use crate::spec::Autopilot;

use super::decode::Unknown;
use super::legs::Knot;
use super::pilot::Pilot;

/// Default of `ALT_SLOPE_MIN` (`ArduPlane/Parameters.cpp`, 4.7.0-dev of December 2025), metres.
const DEFAULT_M: f64 = 15.0;

/// So many seconds of its climb a vehicle is below an upward slope, and above a downward one
/// (`TECS_HDEM_TCONST` is 3): measured on one plane and one QuadPlane, ArduPlane 4.7.0-dev of
/// December 2025, simulated, 3.1 to 3.7 m at 1.15 m/s, 5.2 m at 1.6 m/s, 10.9 m at 2.9 m/s,
/// and most of it still on the next leg.
const LAG_S: f64 = 3.3;
/// Legs that are flown faster have no length to speak of, seconds.
const LEAST_S: f64 = 1e-3;
/// Offsets that are not looked at, metres: less than the altitude is encoded to.
const HAIR_M: f64 = 0.01;

/// Changes of altitude from one waypoint to the next that are smaller than this are flown at once
/// (`Plane::set_offset_altitude_location`), metres; none but on a wing of ArduPilot.
pub(super) fn threshold_m(mission: &VehicleMission) -> f64 {
    if mission.autopilot != Autopilot::ArduPilot || !mission.airframe.has_wing() {
        return 0.0;
    }
    let held = mission
        .params
        .iter()
        .find(|param| ALTITUDE_SLOPE_MIN.contains(&param.name.as_str()));
    // Kept as a whole number. With 0 there is no slope at all.
    match held.map_or(DEFAULT_M, |param| f64::from(param.value).trunc()) {
        metres if metres > 0.0 => metres,
        _ => f64::INFINITY,
    }
}

impl Pilot<'_> {
    /// Lays the legs also where ArduPlane may be beside their lines, to be judged in space: at
    /// the altitude of its end a leg with a small change, flown at once; below or above its line
    /// one that is a slope or follows one, by the lag. Over followed ground no lag was measured
    /// and none is laid. `firsts` are the first chords of the legs.
    pub(super) fn lay_beside(&mut self, knots: &[Knot], firsts: &[usize]) -> Result<(), Unknown> {
        if self.at_once_m <= 0.0 {
            return Ok(());
        }
        let begin_s = |leg: usize, chords: &[super::chord::Chord], end_s: f64| {
            let first = firsts.get(leg).and_then(|first| chords.get(*first));
            first.map_or(end_s, |chord| chord.from_s)
        };
        let times: Vec<f64> = (0..=firsts.len())
            .map(|leg| begin_s(leg, &self.ribbon.chords, self.ribbon.t_s))
            .collect();
        let mut before_mps = 0.0;
        for (leg, pair) in knots.windows(2).enumerate() {
            let ends = (&pair[0], &pair[1]);
            let when = (times[leg], times[leg + 1]);
            let line = self.ribbon.altitude_line(ends.0, ends.1)?;
            // A climb-out and a glide are always slopes, and judged by half of their height.
            if ends.1.slope_from_m.is_some() {
                before_mps = 0.0;
                continue;
            }
            if line.change_m().abs() < self.at_once_m {
                self.ribbon.lay_unflown(ends, when, &line.end())?;
            }
            let flown_s = when.1 - when.0;
            // A leg without length is no slope.
            if line.follows || flown_s < LEAST_S {
                before_mps = 0.0;
                continue;
            }
            let climb_mps = line.change_m() / flown_s;
            let (most_mps, least_mps) = (climb_mps.max(before_mps), climb_mps.min(before_mps));
            for offset_m in [-LAG_S * most_mps.max(0.0), -LAG_S * least_mps.min(0.0)] {
                if offset_m.abs() > HAIR_M {
                    self.ribbon
                        .lay_unflown(ends, when, &line.raised(offset_m))?;
                }
            }
            before_mps = climb_mps;
        }
        Ok(())
    }
}
