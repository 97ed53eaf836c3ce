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

/// A lag of a descent is still there after a leg for this many times the lag.
const LASTS: f64 = 2.0;
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
        let lines = self.offset_lines(knots, firsts)?;
        for ((pair, when), lines) in knots.windows(2).zip(self.times_s(firsts)).zip(&lines) {
            for line in lines {
                self.trajectory
                    .lay_unflown((&pair[0], &pair[1]), when, line)?;
            }
        }
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
        let mut all = self.offset_lines(knots, firsts)?;
        for (lines, pair) in all.iter_mut().zip(knots.windows(2)) {
            lines.push(self.trajectory.altitude_line(&pair[0], &pair[1])?);
        }
        Ok(all)
    }

    /// For each leg the altitudes off its own line: at that of its end where the change is
    /// small and flown at once; below or above its line where it is a slope or follows one, by
    /// the lag, which is longer downwards behind a climb on rotors until it has levelled. Over followed ground no lag
    /// was measured and none is given.
    pub(crate) fn offset_lines(
        &self,
        knots: &[Knot],
        firsts: &[usize],
    ) -> Result<Vec<Vec<AltitudeLine>>, Unknown> {
        let mut all = Vec::new();
        // Their climb rates, and the lag that each leaves at its end.
        let (mut behind, mut lagged) = (Behind::default(), Behind::default());
        // Upwards and downwards.
        let mut lags_s = [self.lag_s, self.lag_s.max(self.transition_lag_s)];
        for (pair, when) in knots.windows(2).zip(self.times_s(firsts)) {
            let mut lines = Vec::new();
            let line = self.trajectory.altitude_line(&pair[0], &pair[1])?;
            // A climb-out and a glide are always slopes, and judged by half of their height.
            let is_free = self.lag_s <= 0.0 || pair[1].slope_from_m.is_some();
            if !is_free && line.change_m().abs() < self.at_once_m {
                lines.push(line.end());
            }
            let flown_s = when.1 - when.0;
            let climb_m = both_ways(line.change_m());
            let rate_mps = climb_m.map(|climb_m| climb_m / flown_s);
            let lasts_s = lags_s.map(|lag_s| LASTS * lag_s);
            // How much it climbs over the ground that it follows is not looked at.
            let lagged_m = match line.follows {
                true => [f64::INFINITY; 2],
                false => [0, 1].map(|way| climb_m[way].min(lags_s[way] * rate_mps[way])),
            };
            if is_free || line.follows {
                behind.0.clear();
            } else {
                let [before_up_mps, _] = behind.0.last().map_or([0.0; 2], |last| last.0);
                let max_mps = [
                    rate_mps[0].max(before_up_mps),
                    behind.values(1, lasts_s).fold(rate_mps[1], f64::max),
                ];
                for (way, side) in [(0, -1.0), (1, 1.0)] {
                    // What each leg leaves is no more than it climbs, however steep.
                    let left_m = lagged
                        .values(way, lasts_s)
                        .fold(lagged_m[way], |sum_m, more_m| sum_m + more_m);
                    let offset_m = side * (lags_s[way] * max_mps[way]).min(left_m);
                    if offset_m.abs() > TOLERANCE_M {
                        let steps = geometry::steps(offset_m.abs(), APART_M, (1, 20));
                        let each_m = offset_m / f64::from(steps);
                        lines.extend((1..=steps).map(|step| line.raised(f64::from(step) * each_m)));
                    }
                }
                behind.go_on(rate_mps, flown_s, lasts_s);
            }
            lagged.go_on(lagged_m, flown_s, lasts_s);
            if climb_m[1] <= 0.0 && flown_s > lasts_s[1] {
                lags_s[1] = self.lag_s;
            }
            all.push(lines);
        }
        Ok(all)
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
