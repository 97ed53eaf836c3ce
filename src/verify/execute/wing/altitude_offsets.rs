//! Altitudes off the line of a leg: the altitude and speed controller of wings (TECS) follows a slope late, to ArduPlane
//! small changes of altitude are no slopes, and PX4 has the altitude of a waypoint before it.

use std::ops::Range;

use crate::geodesy::{EastNorth, PlanPoint};
use crate::numeric::geometry;

use crate::verify::execute::decode::Unknown;
use crate::verify::execute::executor::Pilot;
use crate::verify::execute::legs::Knot;
use crate::verify::execute::trajectory::AltitudeLine;
use crate::verify::measure::segment::Segment;

use super::altitude_lag::{Arrival, Lag};

/// A vehicle may be anywhere between a leg and the line off it: lines in between are so far apart at most, metres.
const APART_M: f64 = 20.0;
/// Offsets that are not looked at, metres: less than the altitude is encoded to.
const TOLERANCE_M: f64 = 0.01;

impl Pilot<'_> {
    /// Lays the legs also where the vehicle may be over or under their lines, to be judged in
    /// space. `firsts` are the first segments of the legs.
    pub(crate) fn lay_altitude_offsets(
        &mut self,
        knots: &[Knot],
        firsts: &[usize],
    ) -> Result<(), Unknown> {
        let (mut lines, left_m) = self.offset_lines(knots, firsts)?;
        for ((pair, when), lines) in knots.windows(2).zip(self.times_s(firsts)).zip(&lines) {
            for line in lines {
                self.trajectory
                    .lay_unflown((&pair[0], &pair[1]), when, line)?;
            }
        }
        self.arrival = Arrival {
            lines: lines.pop().unwrap_or_default(),
            left_m,
        };
        if self.early_m > 0.0 {
            let last = self.trajectory.segments.len();
            for ((leg, pair), when) in knots.windows(2).enumerate().zip(self.times_s(firsts)) {
                self.lay_early(&pair[0], &pair[1], when)?;
                let next = firsts.get(leg + 1).copied().unwrap_or(last);
                self.widen_early(firsts[leg]..next, pair);
            }
        }
        Ok(())
    }

    /// Lays a way beside the last leg from a share of it, where the vehicle may be over or under its line.
    pub(super) fn lay_arrival(&mut self, segment: Segment, share: f64) -> Result<(), Unknown> {
        for line in &self.arrival.lines {
            self.trajectory.lay_aside(segment, (share, 1.0), line)?;
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
        let segment = |from: EastNorth, to_at: EastNorth| {
            Segment::unflown((to.row, to.phase), when, (there(from), there(to_at)))
        };
        if sloping > 0.0 {
            let slope = line.steeper(sloping);
            self.trajectory
                .lay_aside(segment(from.at, level_at), (0.0, sloping), &slope)?;
        }
        self.trajectory
            .lay_aside(segment(level_at, to.at), (1.0, 1.0), &line)
    }

    /// A copter may be at the altitude of the end of a leg wherever it is on it: for the separation.
    fn widen_early(&mut self, of_leg: Range<usize>, leg: &[Knot]) {
        if self.early_m.is_finite() {
            return;
        }
        let rise_m = (leg[1].amsl_m - leg[0].amsl_m).abs();
        for segment in &mut self.trajectory.segments[of_leg] {
            segment.wide_m = segment.wide_m.max(rise_m);
        }
    }

    /// The altitudes of a leg to a circle of PX4 that takes so long, seconds: it climbs or descends at once, and no slope leads
    /// there (`FixedWingPositionControl::control_auto_loiter`). Those between that and its line.
    fn at_once(&self, line: &AltitudeLine, lasts_s: f64) -> Vec<AltitudeLine> {
        let change_m = line.change_m();
        let rate_mps = match change_m > 0.0 {
            true => self.vehicle.climb_mps,
            false => self.vehicle.descent_mps,
        };
        let share = change_m.abs() / rate_mps / lasts_s;
        if line.follows || change_m.abs() < TOLERANCE_M || !(0.0..1.0).contains(&share) {
            return Vec::new();
        }
        let steps = geometry::steps((1.0 - share) * change_m.abs(), APART_M, (1, 20));
        let shares = (1..=steps).map(|step| f64::from(step) / f64::from(steps));
        let lines = shares.map(|of_all| line.hastened(1.0 - of_all * (1.0 - share)));
        lines.collect()
    }

    /// When each leg begins and ends, seconds.
    pub(crate) fn times_s(&self, firsts: &[usize]) -> Vec<(f64, f64)> {
        let segments = &self.trajectory.segments;
        let end_s = self.trajectory.t_s;
        let begin_s = |leg: usize| {
            let first = firsts.get(leg).and_then(|first| segments.get(*first));
            first.map_or(end_s, |segment| segment.from_s)
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
        let mut all = self.offset_lines(knots, firsts)?.0;
        for (lines, pair) in all.iter_mut().zip(knots.windows(2)) {
            lines.push(self.trajectory.altitude_line(&pair[0], &pair[1])?);
        }
        Ok(all)
    }

    /// For each leg the altitudes off its own line: at that of its end where the change is
    /// small and flown at once; below or above its line where it is a slope or follows one, by
    /// the lag, which is longer downwards behind a climb on rotors until it has levelled. Over followed ground no lag
    /// was measured and none is given. Besides, how far below and above its altitude it still is behind them, metres.
    pub(crate) fn offset_lines(
        &self,
        knots: &[Knot],
        firsts: &[usize],
    ) -> Result<(Vec<Vec<AltitudeLine>>, [f64; 2]), Unknown> {
        let mut all = Vec::new();
        let mut lag = Lag::new(self.lag_s, self.transition_lag_s);
        for (pair, when) in knots.windows(2).zip(self.times_s(firsts)) {
            let mut lines = Vec::new();
            let line = self.trajectory.altitude_line(&pair[0], &pair[1])?;
            // A climb-out and a glide are always slopes, and judged by half of their height.
            let is_free = self.lag_s <= 0.0 || pair[1].slope_from_m.is_some();
            if !is_free && line.change_m().abs() < self.at_once_m {
                lines.push(line.end());
            }
            let leg = lag.leg(&line, when.1 - when.0, pair);
            if !is_free && !line.follows {
                let (offs_m, top_m) = lag.offsets_m(&leg);
                for off_m in [-offs_m[0], offs_m[1]] {
                    if off_m.abs() > TOLERANCE_M {
                        let steps = geometry::steps(off_m.abs(), APART_M, (1, 20));
                        let each_m = off_m / f64::from(steps);
                        lines.extend((1..=steps).map(|step| {
                            let raised = line.raised(f64::from(step) * each_m);
                            raised.below(top_m)
                        }));
                    }
                }
            }
            if self.is_onto_circle && self.early_m > 0.0 && all.len() + 2 == knots.len() {
                lines.extend(self.at_once(&line, when.1 - when.0));
            }
            lag.go_on(&leg, is_free);
            all.push(lines);
        }
        let left_m = knots.last().map_or([0.0; 2], |end| lag.left_m(end));
        Ok((all, left_m))
    }
}
