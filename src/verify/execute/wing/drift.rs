//! A QuadPlane is driven off by the wind while it climbs on its rotors.

use crate::geodesy::{EastNorth, PlanPoint};

use crate::verify::execute::executor::Pilot;
use crate::verify::execute::legs::Knot;
use crate::verify::measure::segment::Chord;

impl Pilot<'_> {
    /// Lays the climb of a QuadPlane downwind too, to be judged in space; remembers how far off
    /// it begins its first leg.
    pub(crate) fn drift_up(&mut self, row: usize, top: PlanPoint) {
        let behaviour = &self.vehicle.facts().behaviour;
        let version = self.vehicle.autopilot_version;
        let share = behaviour.drift_share.value(version);
        let onto_leg_s = behaviour.drift_s.value(version);
        let Some(wind) = self.vehicle.carried_by().filter(|_| share > 0.0) else {
            return;
        };
        let climb_s = (top.amsl.0 - self.home.amsl.0) / self.vehicle.climb_mps;
        let [east_mps, north_mps] = wind.velocity_mps();
        let downwind = |seconds: f64| EastNorth {
            east_m: east_mps * seconds,
            north_m: north_mps * seconds,
        };
        let off = downwind(share * climb_s);
        for chord in &mut self.trajectory.chords {
            chord.wide_m = chord.wide_m.max(off.east_m.hypot(off.north_m));
        }
        let end_s = self.trajectory.t_s;
        let column = (self.home, moved(top, off));
        self.trajectory.chords.push(Chord {
            grounded: true,
            ..Chord::unflown((row, self.phase), (end_s - climb_s, end_s), column)
        });
        self.drift = Some(downwind(share * climb_s + onto_leg_s));
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
