//! Altitudes of wings off the line of a leg: their altitude and speed controller (TECS)
//! follows a slope late, and to ArduPlane small changes of altitude are no slopes.

use crate::geodesy::{EastNorth, PlanPoint};

use crate::verify::execute::decode::Unknown;
use crate::verify::execute::executor::Pilot;
use crate::verify::execute::legs::Knot;
use crate::verify::execute::trajectory::AltitudeLine;
use crate::verify::measure::segment::Chord;

/// Legs that are flown faster have no length to speak of, seconds.
const MIN_FLOWN_S: f64 = 1e-3;
/// A lag of a descent is still there after a leg for this many times the lag.
const LASTS: f64 = 2.0;
/// Offsets that are not looked at, metres: less than the altitude is encoded to.
const TOLERANCE_M: f64 = 0.01;

impl Pilot<'_> {
    /// Lays the legs also where a wing may be over or under their lines, to be judged in
    /// space. `firsts` are the first chords of the legs.
    pub(crate) fn lay_altitude_offsets(
        &mut self,
        knots: &[Knot],
        firsts: &[usize],
    ) -> Result<(), Unknown> {
        let lines = self.offset_lines(knots, firsts)?;
        for ((pair, when), lines) in knots.windows(2).zip(self.times_s(firsts)).zip(&lines) {
            for line in lines {
                self.trajectory
                    .lay_unflown((&pair[0], &pair[1]), when, line)?;
            }
        }
        if self.early_m > 0.0 {
            for (pair, when) in knots.windows(2).zip(self.times_s(firsts)) {
                self.lay_early(&pair[0], &pair[1], when)?;
            }
        }
        Ok(())
    }

    /// Lays a leg that has the altitude of its end before it.
    fn lay_early(&mut self, from: &Knot, to: &Knot, when: (f64, f64)) -> Result<(), Unknown> {
        let line = self.trajectory.altitude_line(from, to)?;
        let length_m = from.at.distance_m(to.at);
        // A climb-out and a glide are flown as they are.
        let is_free = to.slope_from_m.is_some() || length_m < TOLERANCE_M;
        if is_free || line.follows || line.change_m().abs() < TOLERANCE_M {
            return Ok(());
        }
        let sloping = (1.0 - self.early_m / length_m).max(0.0);
        let there = |at: EastNorth| PlanPoint {
            at,
            amsl: to.point().amsl,
        };
        let level_at = EastNorth {
            east_m: from.at.east_m + sloping * (to.at.east_m - from.at.east_m),
            north_m: from.at.north_m + sloping * (to.at.north_m - from.at.north_m),
        };
        let chord = |from: EastNorth, to_at: EastNorth| {
            Chord::unflown((to.row, to.phase), when, (there(from), there(to_at)))
        };
        if sloping > 0.0 {
            let slope = line.steeper(sloping);
            self.trajectory
                .lay_aside(chord(from.at, level_at), (0.0, sloping), &slope)?;
        }
        self.trajectory
            .lay_aside(chord(level_at, to.at), (1.0, 1.0), &line)
    }

    /// When each leg begins and ends, seconds.
    pub(crate) fn times_s(&self, firsts: &[usize]) -> Vec<(f64, f64)> {
        let chords = &self.trajectory.chords;
        let end_s = self.trajectory.t_s;
        let begin_s = |leg: usize| {
            let first = firsts.get(leg).and_then(|first| chords.get(*first));
            first.map_or(end_s, |chord| chord.from_s)
        };
        (0..firsts.len())
            .map(|leg| (begin_s(leg), begin_s(leg + 1)))
            .collect()
    }

    /// For each leg its own line and those off it.
    pub(crate) fn leg_lines(
        &self,
        knots: &[Knot],
        firsts: &[usize],
    ) -> Result<Vec<Vec<AltitudeLine>>, Unknown> {
        let mut all = self.offset_lines(knots, firsts)?;
        for (lines, pair) in all.iter_mut().zip(knots.windows(2)) {
            lines.push(self.trajectory.altitude_line(&pair[0], &pair[1])?);
        }
        Ok(all)
    }

    /// For each leg the altitudes off its own line: at that of its end where the change is
    /// small and flown at once; below or above its line where it is a slope or follows one, by
    /// the lag. Over followed ground no lag was measured and none is given.
    pub(crate) fn offset_lines(
        &self,
        knots: &[Knot],
        firsts: &[usize],
    ) -> Result<Vec<Vec<AltitudeLine>>, Unknown> {
        let mut all = Vec::new();
        // Climb rates of the legs behind, and how long ago each ended, seconds.
        let mut behind: Vec<(f64, f64)> = Vec::new();
        for (pair, when) in knots.windows(2).zip(self.times_s(firsts)) {
            let mut lines = Vec::new();
            let line = self.trajectory.altitude_line(&pair[0], &pair[1])?;
            // A climb-out and a glide are always slopes, and judged by half of their height.
            let is_free = self.lag_s <= 0.0 || pair[1].slope_from_m.is_some();
            if !is_free && line.change_m().abs() < self.at_once_m {
                lines.push(line.end());
            }
            let flown_s = when.1 - when.0;
            // A leg without length is no slope.
            if is_free || line.follows || flown_s < MIN_FLOWN_S {
                behind.clear();
                all.push(lines);
                continue;
            }
            let climb_mps = line.change_m() / flown_s;
            let before_mps = behind.last().map_or(0.0, |(rate_mps, _)| *rate_mps);
            let most_mps = climb_mps.max(before_mps);
            let rates = behind.iter().map(|(rate_mps, _)| *rate_mps);
            let least_mps = rates.fold(climb_mps.min(before_mps), f64::min);
            for lag_mps in [most_mps.max(0.0), least_mps.min(0.0)] {
                let offset_m = -self.lag_s * lag_mps;
                if offset_m.abs() > TOLERANCE_M {
                    lines.push(line.raised(offset_m));
                }
            }
            behind.push((climb_mps, -flown_s));
            for (_, ago_s) in &mut behind {
                *ago_s += flown_s;
            }
            behind.retain(|(_, ago_s)| *ago_s < LASTS * self.lag_s);
            all.push(lines);
        }
        Ok(all)
    }
}
