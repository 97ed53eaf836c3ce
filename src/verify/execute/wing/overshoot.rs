//! Paths of wings off their legs: they overshoot corners, and climb out early.

mod early_climb;

use std::f64::consts::PI;

use crate::geodesy::{EastNorth, PlanPoint};
use crate::numeric::geometry;
use crate::path::{along, heading_rad};

use super::STEP_S;
use super::guidance::{Fix, Way};
use super::line::Line;
use crate::verify::execute::decode::Unknown;
use crate::verify::execute::executor::{Pilot, SAME_PLACE_M};
use crate::verify::execute::flight::Hull;
use crate::verify::execute::legs::{Knot, ground_speeds};
use crate::verify::execute::trajectory::AltitudeLine;
use crate::verify::measure::segment::Segment;

/// Ways nearer to their legs than this are not looked at, metres.
const TOLERANCE_M: f64 = 0.5;
/// Steps of the path from one judged point to the next, and from one straight way off it to the next.
const EVERY: usize = 10;
const EVERY_STRAIGHT: usize = 2;
/// A way is taken to be as far from a segment as it is within this of its time, seconds.
const WITHIN_S: f64 = 2.0;
/// Legs after the place at the end of a hull that a wing swings beside.
const ARRIVAL_LEGS: usize = 3;
/// Courses on which it may come to that place are no further apart, radians.
const ARRIVAL_RAD: f64 = 10.0 * PI / 180.0;

impl Pilot<'_> {
    /// Lays the path that a wing flies off its legs, to be judged in space. For the
    /// separation, widens the segments of the legs by its distance and adds the time it takes longer.
    pub(crate) fn lay_overshoot(
        &mut self,
        knots: &[Knot],
        grounds_mps: &[f64],
        firsts: &[usize],
    ) -> Result<(), Unknown> {
        let Some(guidance) = self.guidance else {
            return Ok(());
        };
        self.leave_early(knots, (grounds_mps, firsts))?;
        if knots.len() < 3 {
            return Ok(());
        }
        let before_s = self.trajectory.late_s;
        let mut late_s = before_s;
        let version = self.vehicle.autopilot_version;
        for way in guidance.ways(version, |guidance| guidance.follow(knots, grounds_mps)) {
            self.trajectory.late_s = before_s;
            self.widen(knots, firsts, &way);
            late_s = late_s.max(self.trajectory.late_s);
            let lines = self.leg_lines(knots, firsts)?;
            self.lay_way(knots, (&lines, &self.times_s(firsts)), &way.fixes)?;
        }
        self.trajectory.late_s = late_s;
        Ok(())
    }

    /// Lays the way on from a place within a hull or at its end, to be judged in space, for a wing that comes
    /// to it from either side of the hull; for the separation, widens the segments of the legs by as much.
    pub(crate) fn lay_arrivals(
        &mut self,
        (hull, leg): (&Hull, usize),
        knots: &[Knot],
        grounds_mps: &[f64],
        firsts: &[usize],
    ) -> Result<(), Unknown> {
        let guidance = self.guidance.filter(|_| hull.any_course);
        let (Some(guidance), Some([before, place, next, ..])) = (guidance, knots.get(leg..)) else {
            return Ok(());
        };
        let course_rad = heading_rad(hull.middle.at, place.at);
        let away_m = hull.middle.at.distance_m(place.at);
        let max_rad = (hull.reach_m / away_m).min(1.0).asin();
        let steps = i32::from(geometry::steps(max_rad, ARRIVAL_RAD, (1, 9)));
        let on = leg + 1;
        let end = (on + ARRIVAL_LEGS).min(knots.len() - 1);
        let turn_rad = Line::new(before.at, place.at).turn_rad(&Line::new(place.at, next.at));
        // The lag of the leg to the place is still there on those after it.
        let (lines, times) = (self.leg_lines(knots, firsts)?, self.times_s(firsts));
        for step in -steps..=steps {
            let off_rad = max_rad * f64::from(step) / f64::from(steps);
            let from = along(place.at, course_rad + PI + off_rad, away_m.max(1.0));
            let along = Line::new(from, place.at);
            let (knots_on, grounds_mps) = (&knots[on..=end], &grounds_mps[on..end]);
            let ways = guidance.ways(self.vehicle.autopilot_version, |guidance| {
                guidance.arrive((along, turn_rad), knots_on, grounds_mps)
            });
            for way in ways {
                self.widen_by(&firsts[on..], &way.fixes);
                self.lay_way(knots_on, (&lines[on..end], &times[on..end]), &way.fixes)?;
            }
        }
        Ok(())
    }

    /// Widens the segments of legs, whose first ones are given, by the distance of a way from them.
    fn widen_by(&mut self, firsts: &[usize], fixes: &[Fix]) {
        for fix in fixes {
            let first = firsts[fix.leg];
            let next = firsts.get(fix.leg + 1).copied();
            let next = next.unwrap_or(self.trajectory.segments.len());
            for segment in &mut self.trajectory.segments[first.min(next)..next] {
                if segment.flown {
                    segment.wide_m = segment.wide_m.max(fix.cross_track_m);
                }
            }
        }
    }

    /// Places off its leg at which a wing may be once it has turned towards a place: to a circle one of ArduPilot
    /// flies straight from there (`Plane::update_loiter`), and not along the leg.
    pub(crate) fn turned_towards(&self, place: EastNorth) -> Result<Vec<EastNorth>, Unknown> {
        let from = self.last();
        let Some(guidance) = self
            .guidance
            .filter(|_| from.at.distance_m(place) > SAME_PLACE_M)
        else {
            return Ok(Vec::new());
        };
        let mut knots = self.knots.clone();
        knots.push(Knot { at: place, ..from });
        let Some(leg) = knots.len().checked_sub(2).filter(|leg| *leg > 0) else {
            return Ok(Vec::new());
        };
        let speeds = ground_speeds(&knots, self.vehicle)?;
        let off = |fix: &Fix| fix.leg == leg && fix.cross_track_m > TOLERANCE_M;
        let version = self.vehicle.autopilot_version;
        let ways = guidance.ways(version, |guidance| guidance.follow(&knots, &speeds));
        let on_it = |way: Way| way.fixes.into_iter().filter(off).step_by(EVERY_STRAIGHT);
        Ok(ways.into_iter().flat_map(on_it).map(|fix| fix.at).collect())
    }

    /// Lays a way along legs, as far as it is off them, at the altitudes of each leg and at its times.
    fn lay_way(
        &mut self,
        knots: &[Knot],
        (lines, times): (&[Vec<AltitudeLine>], &[(f64, f64)]),
        fixes: &[Fix],
    ) -> Result<(), Unknown> {
        for (index, pair) in fixes
            .iter()
            .step_by(EVERY)
            .zip(fixes.iter().step_by(EVERY).skip(1))
            .enumerate()
        {
            let (from, to) = pair;
            let passed = &fixes[index * EVERY..=(index + 1) * EVERY];
            let cross_track_m = passed
                .iter()
                .map(|fix| fix.cross_track_m)
                .fold(0.0, f64::max);
            if cross_track_m < TOLERANCE_M {
                continue;
            }
            let leg = to.leg;
            let (begin, end) = (&knots[leg], &knots[leg + 1]);
            let at = |fix: &Fix| PlanPoint {
                at: fix.at,
                amsl: end.point().amsl,
            };
            let straight_m = chord_error_m(passed);
            let segment = Segment {
                bow_m: straight_m,
                error_m: straight_m,
                slope_from_m: end.slope_from_m,
                ..Segment::unflown((end.row, end.phase), times[leg], (at(from), at(to)))
            };
            let share = |fix: &Fix| share(begin.at, end.at, fix.at);
            for line in &lines[leg] {
                self.trajectory
                    .lay_aside(segment, (share(from), share(to)), line)?;
            }
        }
        Ok(())
    }

    /// Widens the segments of the legs by the distance of the path from them, and makes them late by
    /// the time that the path takes longer, unless it is flown slower.
    fn widen(&mut self, knots: &[Knot], firsts: &[usize], way: &Way) {
        let fixes = &way.fixes;
        let mut starts_s = None;
        let (before_s, mut late_s) = (self.trajectory.late_s, 0.0_f64);
        for (leg, pair) in knots.windows(2).enumerate() {
            let first = firsts[leg];
            let end = firsts.get(leg + 1).copied();
            let end = end.unwrap_or(self.trajectory.segments.len());
            let half = |at: EastNorth| share(pair[0].at, pair[1].at, at) >= 0.5;
            let segments = &self.trajectory.segments[first.min(end)..end];
            let planned = segments
                .iter()
                .find(|segment| segment.flown && half(segment.to.at));
            let mut of_leg = fixes.iter().filter(|fix| fix.leg == leg);
            let flown = of_leg
                .clone()
                .find(|fix| half(fix.at))
                .or(of_leg.next_back());
            let (Some(planned), Some(flown)) = (planned, flown) else {
                continue;
            };
            // Halfway along the leg: the way against the model, and both against the first leg.
            let planned_s = planned.time_s(halfway(planned, pair));
            let shift_s = planned_s - flown.t_s;
            let starts_s = *starts_s.get_or_insert(shift_s);
            late_s = match way.is_slower {
                true => 0.0,
                false => late_s.max(starts_s - shift_s),
            };
            let late_at_s = before_s + late_s;
            for segment in &mut self.trajectory.segments[first..end] {
                if !segment.flown {
                    continue;
                }
                let within = (
                    segment.from_s - shift_s - WITHIN_S,
                    segment.to_s - shift_s + WITHIN_S,
                );
                let near = fixes[step(within.0).min(fixes.len())..].iter();
                let near = near.take_while(|fix| fix.t_s <= within.1);
                let wide_m = near.map(|fix| fix.cross_track_m).fold(0.0, f64::max);
                segment.wide_m = segment.wide_m.max(wide_m);
                segment.late_s = segment.late_s.max(late_at_s);
            }
        }
        self.trajectory.late_s = before_s + late_s;
    }
}

/// The first of the places of a way that is not before a time.
fn step(t_s: f64) -> usize {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "not below 0, and a way has far fewer than 2^32 places"
    )]
    let step = (t_s / STEP_S - 1.0).max(0.0) as usize;
    step
}

/// How far along the straight line between two places a third lies: 0 at the first, 1 at the last.
pub(super) fn share(from: EastNorth, to: EastNorth, at: EastNorth) -> f64 {
    let (east_m, north_m) = (to.east_m - from.east_m, to.north_m - from.north_m);
    let along = (at.east_m - from.east_m) * east_m + (at.north_m - from.north_m) * north_m;
    (along / (east_m * east_m + north_m * north_m)).clamp(0.0, 1.0)
}

/// Where on a segment its leg is half over.
fn halfway(segment: &Segment, leg: &[Knot]) -> f64 {
    let at = |place: EastNorth| share(leg[0].at, leg[1].at, place);
    let (from, to) = (at(segment.from.at), at(segment.to.at));
    if to > from {
        ((0.5 - from) / (to - from)).clamp(0.0, 1.0)
    } else {
        1.0
    }
}

/// Distance of a place from the segment between two others, metres.
fn cross_track_m(from: EastNorth, to: EastNorth, at: EastNorth) -> f64 {
    let share = share(from, to, at);
    at.distance_m(EastNorth {
        east_m: from.east_m + (to.east_m - from.east_m) * share,
        north_m: from.north_m + (to.north_m - from.north_m) * share,
    })
}

/// How far the places between the first and the last are from the straight line, metres.
fn chord_error_m(passed: &[Fix]) -> f64 {
    let (Some(first), Some(last)) = (passed.first(), passed.last()) else {
        return 0.0;
    };
    let off = passed
        .iter()
        .map(|fix| cross_track_m(first.at, last.at, fix.at));
    off.fold(0.0, f64::max)
}
