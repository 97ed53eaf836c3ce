//! A QuadPlane is driven off by the wind while it climbs on its rotors.

use crate::geodesy::{EastNorth, PlanPoint};
use crate::spec::{Airframe, Autopilot};

use crate::verify::execute::executor::Pilot;
use crate::verify::execute::legs::Knot;
use crate::verify::measure::segment::Chord;

/// Share of the wind with which it drifts as it climbs, and for how long it drifts with all of it
/// until it has turned onto its first leg, seconds: one QuadPlane of ArduPilot's simulator
/// (ArduPlane 4.7.0-dev of December 2025) in 5 m/s was 41 m downwind after a planned climb of 27 s, and
/// began its first leg 59 m off it.
const SHARE: f64 = 0.31;
const ONTO_LEG_S: f64 = 3.6;

impl Pilot<'_> {
    /// Lays the climb of a QuadPlane downwind too, to be judged in space; remembers how far off
    /// it begins its first leg.
    pub(crate) fn drift_up(&mut self, row: usize, top: PlanPoint) {
        let wind = match (self.vehicle.autopilot, self.vehicle.airframe) {
            (Autopilot::ArduPilot, Airframe::Vtol) => self.vehicle.wing.and_then(|wing| wing.wind),
            _ => None,
        };
        let Some(wind) = wind.filter(|wind| wind.speed_mps > 0.0) else {
            return;
        };
        let climb_s = (top.amsl.0 - self.home.amsl.0) / self.vehicle.climb_mps;
        let downwind = |seconds: f64| EastNorth {
            east_m: -wind.from_rad.sin() * wind.speed_mps * seconds,
            north_m: -wind.from_rad.cos() * wind.speed_mps * seconds,
        };
        let off = downwind(SHARE * climb_s);
        for chord in &mut self.trajectory.chords {
            chord.wide_m = chord.wide_m.max(off.east_m.hypot(off.north_m));
        }
        let end_s = self.trajectory.t_s;
        let column = (self.home, moved(top, off));
        self.trajectory.chords.push(Chord {
            grounded: true,
            ..Chord::unflown((row, self.phase), (end_s - climb_s, end_s), column)
        });
        self.drift = Some(downwind(SHARE * climb_s + ONTO_LEG_S));
    }

    /// Lays the first leg from where the wind has driven it, to be judged in space; for the
    /// separation, widens the chords of that leg by as much.
    pub(crate) fn drift_onto(&mut self, knots: &[Knot], firsts: &[usize]) {
        let (Some(off), [from, to, ..]) = (self.drift.take(), knots) else {
            return;
        };
        let (first, end) = (firsts.first().copied(), firsts.get(1).copied());
        let end = end.unwrap_or(self.trajectory.chords.len());
        for chord in &mut self.trajectory.chords[first.unwrap_or(end)..end] {
            chord.wide_m = chord.wide_m.max(off.east_m.hypot(off.north_m));
        }
        let (begin_s, leg) = (self.trajectory.t_s, (moved(from.point(), off), to.point()));
        let chord = Chord::unflown((to.row, to.phase), (begin_s, begin_s), leg);
        self.trajectory.chords.push(chord);
    }
}

fn moved(point: PlanPoint, by: EastNorth) -> PlanPoint {
    PlanPoint {
        at: EastNorth {
            east_m: point.at.east_m + by.east_m,
            north_m: point.at.north_m + by.north_m,
        },
        ..point
    }
}
