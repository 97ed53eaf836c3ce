//! Whether a vehicle does what its mode says: one that lands comes down, one that returns comes nearer.

use super::{FlightVehicle, Instruction};
use crate::flight::record::Fix;

/// A vehicle that is not seen to get on for this long is reported, seconds; a wing, which circles and
/// turns, later.
const STUCK_S: f64 = 20.0;
const WING_STUCK_S: f64 = 60.0;
/// Less than this is the noise of positions, metres: up or down, and over the ground.
const MIN_UP_M: f64 = 2.0;
const MIN_NEARER_M: f64 = 10.0;
/// A vehicle this near to where it returns to may stay over it for a time, metres and radii of its circle.
const THERE_M: f64 = 60.0;
const THERE_RADII: f64 = 2.0;

/// How far a landing or a return has got.
#[derive(Clone, Copy, Debug)]
pub(super) struct Headway {
    since_s: f64,
    amsl_m: f64,
    /// From the nearest place that it may return to, metres.
    away_m: f64,
    is_reported: bool,
}

impl FlightVehicle<'_> {
    /// Reports once that it is in the mode of its order and does not get on.
    pub(super) fn check_headway(&mut self, fix: Fix, in_mode: bool) {
        let (home_m, rally_m) = self.away_from_returns_m(fix);
        let away_m = home_m.min(rally_m);
        let now = Headway {
            since_s: fix.t_s,
            amsl_m: fix.amsl.0,
            away_m,
            is_reported: false,
        };
        let Some(before) = self.hold.headway.filter(|_| in_mode) else {
            self.hold.headway = in_mode.then_some(now);
            return;
        };
        let returns = self.instruction == Some(Instruction::Return);
        let down_m = before.amsl_m - now.amsl_m;
        let gets_on = match returns {
            // It climbs first, and comes down at the end.
            true => down_m.abs() >= MIN_UP_M || before.away_m - away_m >= MIN_NEARER_M,
            false => down_m >= MIN_UP_M,
        };
        let circle_m = self.circle_m().unwrap_or(0.0);
        let is_there = returns && away_m <= THERE_M + THERE_RADII * circle_m;
        if gets_on || is_there {
            self.hold.headway = Some(now);
            return;
        }
        let stuck_s = match self.of.mission.airframe.has_wing() {
            true => WING_STUCK_S,
            false => STUCK_S,
        };
        let since_s = fix.t_s - before.since_s;
        if before.is_reported || since_s < stuck_s {
            return;
        }
        self.hold.headway = Some(Headway {
            is_reported: true,
            ..before
        });
        let text = match returns {
            true => format!(
                "return not confirmed: it is in the mode, and has come no nearer for {since_s:.0} s ({away_m:.0} m away)"
            ),
            false => format!(
                "landing not confirmed: it is in the mode, and has not come down for {since_s:.0} s"
            ),
        };
        self.news.push_back(text);
    }
}
