//! A plane that has the height of its takeoff early goes on from there: ArduPlane straight at the next place, with no leg
//! to keep to (`Plane::verify_takeoff`), and along its legs from there.

use std::f64::consts::FRAC_PI_2;

use crate::geodesy::{Amsl, EastNorth, PlanPoint};
use crate::path::heading_rad;

use super::{ARRIVAL_LEGS, cross_track_m};
use crate::verify::execute::decode::Unknown;
use crate::verify::execute::executor::Pilot;
use crate::verify::execute::flight::EarlyTop;
use crate::verify::execute::legs::{Knot, ground_speed};
use crate::verify::execute::trajectory::AltitudeLine;
use crate::verify::execute::wing::drift::carried_points;
use crate::verify::execute::wing::guidance::Way;
use crate::verify::measure::segment::{Phase, Segment};

/// Steps from where it may have its height first to where it has it at the latest.
const LATER_STEPS: u8 = 3;

/// The legs of a mission that begins with a climb-out, and which of their knots are the top and the next place.
struct Departing<'a> {
    knots: &'a [Knot],
    grounds_mps: &'a [f64],
    firsts: &'a [usize],
    top: usize,
    next: usize,
}

impl Pilot<'_> {
    /// Share of the planned climb after which a plane may have its height, and how far it may
    /// exceed that, metres.
    pub(crate) fn climb_out_figures(&self) -> (f64, f64) {
        let behaviour = &self.vehicle.facts().behaviour;
        let version = self.vehicle.autopilot_version;
        (
            behaviour.climb_out_share.value(version),
            behaviour.climb_out_overshoot_m.value(version),
        )
    }

    /// Lays where a plane may be that is early at the height of its takeoff.
    pub(super) fn leave_early(
        &mut self,
        knots: &[Knot],
        (grounds_mps, firsts): (&[f64], &[usize]),
    ) -> Result<(), Unknown> {
        let Some(early) = self.early_top.take() else {
            return Ok(());
        };
        let is_join = |knot: &Knot| knot.phase == Phase::Join;
        let next = knots.iter().position(|knot| !is_join(knot));
        let top = knots.iter().rposition(is_join);
        let (Some(next), Some(top)) = (next, top) else {
            return Ok(());
        };
        let (aims_at, t_s) = (knots[next], self.trajectory.t_s);
        let behaviour = &self.vehicle.facts().behaviour;
        let (early_share, overshoot_m) = self.climb_out_figures();
        let off_m = early.off.east_m.hypot(early.off.north_m);
        let rise_m = early.point.amsl.0 - knots[0].amsl_m;
        let aside_m = cross_track_m(early.point.at, aims_at.at, knots[top].at);
        let first = firsts.first().copied().unwrap_or_default();
        for segment in &mut self.trajectory.segments[first..] {
            if segment.phase == Phase::Join {
                segment.wide_m = ((1.0 - early_share) * rise_m).max(overshoot_m).max(off_m);
            } else if segment.row == aims_at.row {
                segment.wide_m = aside_m + off_m;
            }
        }
        let level = PlanPoint {
            at: knots[top].at,
            ..early.point
        };
        let last_share = behaviour
            .climb_out_last_share
            .value(self.vehicle.autopilot_version);
        let later_share = (last_share - early_share).max(0.0) / (1.0 - early_share);
        let share = |step: u8| later_share * f64::from(step) / f64::from(LATER_STEPS);
        let tops = (0..=LATER_STEPS).map(|step| early.point.toward(level, share(step)));
        let tops = tops.flat_map(|point| carried_points(EarlyTop { point, ..early }));
        let tops: Vec<PlanPoint> = tops.collect();
        for &point in &tops {
            let ends = (point, aims_at.point());
            let segment = Segment::unflown((aims_at.row, aims_at.phase), (t_s, t_s), ends);
            self.trajectory.segments.push(segment);
        }
        let departing = Departing {
            knots,
            grounds_mps,
            firsts,
            top,
            next,
        };
        self.turn_off_early(&departing, early.point, &tops)
    }

    /// Lays the ways of `ArduPlane` from where it may have its height, and makes it as early as the shortest of them is
    /// against the planned way.
    fn turn_off_early(
        &mut self,
        departing: &Departing<'_>,
        early: PlanPoint,
        tops: &[PlanPoint],
    ) -> Result<(), Unknown> {
        let guidance = self
            .guidance
            .filter(|guidance| guidance.flies_straight_on());
        let (Some(guidance), Some(course_rad)) = (guidance, self.flight.takeoff_rad) else {
            return Ok(());
        };
        let &Departing {
            knots,
            grounds_mps,
            firsts,
            next,
            ..
        } = departing;
        let earlier_s = self.cuts_off_s(departing, early)?;
        let end = (next + ARRIVAL_LEGS).min(knots.len() - 1);
        let (lines, times) = (self.leg_lines(knots, firsts)?, self.times_s(firsts));
        let times = &times[next - 1..end];
        let first = firsts[next - 1];
        let mut wide_m = 0.0_f64;
        for &point in tops {
            let mut on = vec![Knot {
                at: point.at,
                amsl_m: point.amsl.0,
                ..knots[departing.top]
            }];
            on.extend(&knots[next..=end]);
            let mut speeds_mps = vec![self.over_ground_mps(&on[0], &on[1])?];
            speeds_mps.extend(&grounds_mps[next..end]);
            let mut altitudes = vec![self.lines_from(&on[0], &on[1])];
            altitudes.extend(lines[next..end].iter().cloned());
            let heading_rad = FRAC_PI_2 - course_rad;
            let ways = guidance.ways(self.vehicle.autopilot_version, |guidance| {
                guidance.leave(heading_rad, &on, &speeds_mps)
            });
            for way in ways {
                let straight_m = way.fixes.iter().filter(|fix| fix.leg == 0);
                let bow_m = straight_m.map(|fix| fix.cross_track_m);
                wide_m = bow_m.fold(wide_m, f64::max);
                self.widen_climb(departing, early, (&way, earlier_s));
                self.widen_by(&firsts[next - 1..], &way.fixes);
                self.lay_way(&on, (&altitudes, times), &way.fixes)?;
            }
        }
        for segment in &mut self.trajectory.segments[first..] {
            segment.early_s += earlier_s;
            if segment.flown && segment.row == knots[next].row {
                segment.wide_m += wide_m;
            }
        }
        self.trajectory.early_s += earlier_s;
        Ok(())
    }

    /// By how much the straight way from an early top to the next place is shorter than the planned one, seconds.
    fn cuts_off_s(&self, departing: &Departing<'_>, early: PlanPoint) -> Result<f64, Unknown> {
        let (top, next) = (
            &departing.knots[departing.top],
            &departing.knots[departing.next],
        );
        let early = Knot {
            at: early.at,
            ..*top
        };
        let takes_s = |from: &Knot, to: &Knot| {
            let length_m = from.at.distance_m(to.at);
            Ok(length_m / self.over_ground_mps(from, &Knot { at: to.at, ..*next })?)
        };
        let planned_s = takes_s(&early, top)? + takes_s(top, next)?;
        Ok((planned_s - takes_s(&early, next)?).max(0.0))
    }

    /// The speed over the ground from one place to another, m/s.
    fn over_ground_mps(&self, from: &Knot, to: &Knot) -> Result<f64, Unknown> {
        let course_rad = heading_rad(from.at, to.at);
        let halfway = Amsl(0.5 * (from.amsl_m + to.amsl_m));
        ground_speed(self.vehicle, to, halfway, course_rad)
    }

    /// The altitudes from an early top to the next place: small changes are flown at once.
    fn lines_from(&self, from: &Knot, to: &Knot) -> Vec<AltitudeLine> {
        let line = AltitudeLine::between(false, (from.amsl_m, to.amsl_m));
        let is_small = line.change_m().abs() < self.at_once_m;
        let level = is_small.then(|| line.end());
        std::iter::once(line).chain(level).collect()
    }

    /// For the separation, widens the climb by where it has turned off while the planned one is still on its way up.
    fn widen_climb(
        &mut self,
        departing: &Departing<'_>,
        early: PlanPoint,
        (way, earlier_s): (&Way, f64),
    ) {
        let top = &departing.knots[departing.top];
        let behaviour = &self.vehicle.facts().behaviour;
        let early_s = behaviour
            .takeoff_early_s
            .value(self.vehicle.autopilot_version)
            + earlier_s;
        let climbs_s = early.at.distance_m(top.at) / departing.grounds_mps[departing.top - 1];
        let (from, to): (EastNorth, EastNorth) = (early.at, top.at);
        let before = way.fixes.iter().filter(|fix| fix.leg == 0);
        let before = before.take_while(|fix| fix.t_s + early_s < climbs_s);
        let off_m = before.map(|fix| cross_track_m(from, to, fix.at));
        let off_m = off_m.fold(0.0, f64::max);
        let first = departing.firsts.first().copied().unwrap_or_default();
        for segment in &mut self.trajectory.segments[first..] {
            if segment.flown && segment.phase == Phase::Join {
                segment.wide_m = segment.wide_m.max(off_m);
            }
        }
    }
}
