//! Small changes of altitude, which ArduPlane does not spread along the leg.

use crate::mission::{ALTITUDE_SLOPE_MIN, VehicleMission};
use crate::spec::Autopilot;

use super::decode::Unknown;
use super::legs::Knot;
use super::pilot::Pilot;

/// Default of `ALT_SLOPE_MIN` (`ArduPlane/Parameters.cpp`, 4.7.0-dev of December 2025), metres.
const DEFAULT_M: f64 = 15.0;

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
    /// Where a small change of altitude is flown at once, the vehicle is somewhere between the
    /// slope and the altitude at the end of the leg: that altitude is judged in space too.
    /// `firsts` are the first chords of the legs.
    pub(super) fn lay_at_once(&mut self, knots: &[Knot], firsts: &[usize]) -> Result<(), Unknown> {
        let begin_s = |leg: usize, chords: &[super::chord::Chord], end_s: f64| {
            let first = firsts.get(leg).and_then(|first| chords.get(*first));
            first.map_or(end_s, |chord| chord.from_s)
        };
        let times: Vec<f64> = (0..=firsts.len())
            .map(|leg| begin_s(leg, &self.ribbon.chords, self.ribbon.t_s))
            .collect();
        for (leg, pair) in knots.windows(2).enumerate() {
            let (from, to) = (&pair[0], &pair[1]);
            let line = self.ribbon.altitude_line(from, to)?;
            // A climb-out and a glide are always slopes.
            if line.change_m().abs() < self.at_once_m && to.slope_from_m.is_none() {
                self.ribbon
                    .lay_unflown((from, to), (times[leg], times[leg + 1]), &line.end())?;
            }
        }
        Ok(())
    }
}
