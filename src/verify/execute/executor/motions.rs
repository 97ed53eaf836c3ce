//! Motions between two places, and stays.

use std::ops::Range;

use crate::geodesy::{Amsl, PlanPoint};
use crate::path::{
    COUNTS_AFTER_S, heading_rad, late_share, leg_late_s, leg_late_share, stop_late_s,
};
use crate::verify::execute::decode::Unknown;
use crate::verify::execute::flight::{Legs, Rest, Slope};
use crate::verify::execute::legs::{self, Knot, Run};
use crate::verify::execute::trajectory::AltitudeLine;
use crate::verify::execute::wing::altitude_lag::Arrival;
use crate::verify::measure::segment::Column;
use crate::world::Departure;

use super::Pilot;

/// A vehicle may come so far below a place of the spec, metres: the rest of a rounded altitude.
const BELOW_DROP_M: f64 = 0.5;

impl Pilot<'_> {
    /// Climbs or descends to an altitude.
    pub(crate) fn climb(&mut self, row: usize, to_m: f64) {
        let rise_m = to_m - self.last().amsl_m;
        let rate_mps = if rise_m > 0.0 {
            self.vehicle.climb_mps
        } else {
            self.vehicle.descent_mps
        };
        let low_m = to_m.min(to_m - rise_m);
        let rests = self.flight.rests.last();
        let is_at_rest = rests
            .is_some_and(|rest| rest.until_s >= self.trajectory.t_s && rest.point == self.here());
        if is_at_rest && self.is_at_drop(low_m) {
            self.trajectory.late_s += stop_late_s(self.vehicle);
            self.lift(row, to_m, rate_mps, Some(Column::Drop));
            return;
        }
        self.flight.slopes.push(Slope {
            segment: self.trajectory.segments.len(),
            phase: self.phase,
            run_m: 0.0,
            rise_m,
            speed_mps: 0.0,
            top_m: to_m.max(to_m - rise_m),
        });
        self.lift(row, to_m, rate_mps, None);
    }

    /// Whether an altitude here is one that a place of the spec below the least height above ground asks for.
    pub(super) fn is_at_drop(&self, amsl_m: f64) -> bool {
        let at = self.last().at;
        self.drops.iter().any(|drop| {
            let is_over = drop.top.at.distance_m(at) <= self.tolerance_m;
            is_over && amsl_m < drop.top.amsl.0 && amsl_m >= drop.low.0 - BELOW_DROP_M
        })
    }

    /// A vertical motion at a given rate.
    pub(crate) fn lift(&mut self, row: usize, to_m: f64, rate_mps: f64, column: Option<Column>) {
        let from = self.here();
        let to = PlanPoint {
            at: from.at,
            amsl: Amsl(to_m),
        };
        let duration_s = (to_m - from.amsl.0).abs() / rate_mps;
        self.trajectory
            .straight((row, self.phase), (from, to), duration_s, column);
        (self.moving_mps, self.tangent) = (0.0, None);
        self.knots = vec![self.knot(row, to.at, to_m, None)];
    }

    pub(crate) fn hold(&mut self, row: usize, hold_s: f64) {
        let (here, from_s) = (self.here(), self.trajectory.t_s);
        let late_s = self.trajectory.late_s;
        let is_low = self.is_at_drop(here.amsl.0);
        let column = is_low.then_some(Column::Drop);
        self.trajectory
            .straight((row, self.phase), (here, here), hold_s, column);
        self.rest_since(row, (from_s, late_s));
    }

    /// Notes a rest where the vehicle is, since a time and by how much later that may be, or that the one before
    /// goes on.
    pub(crate) fn rest_since(&mut self, row: usize, (from_s, late_s): (f64, f64)) {
        let (point, until_s) = (self.here(), self.trajectory.t_s);
        match self.flight.rests.last_mut() {
            Some(last) if last.until_s >= from_s && last.point == point => {
                (last.until_s, last.rows.1) = (until_s, row);
            }
            _ => self.flight.rests.push(Rest {
                point,
                from_s,
                until_s,
                late_s,
                early_s: self.trajectory.early_s,
                rows: (row, row),
            }),
        }
    }

    /// Flies the legs that were gathered, to a stop at the last knot.
    pub(crate) fn stop(&mut self) -> Result<(), Unknown> {
        self.fly_to_last(0.0)
    }

    /// Flies the legs that were gathered, and has a speed at the last knot.
    pub(crate) fn fly_to_last(&mut self, last_mps: f64) -> Result<(), Unknown> {
        let first_mps = self.moving_mps;
        self.arrival = Arrival::default();
        let knots = std::mem::take(&mut self.knots);
        if let Some(&last) = knots.last() {
            self.knots = vec![last];
        }
        if knots.len() < 2 {
            return Ok(());
        }
        self.moving_mps = last_mps;
        self.tangent = None;
        let grounds_mps = legs::ground_speeds(&knots, self.vehicle)?;
        // At its ends the wind carries it as on the leg there.
        let carried = |speed_mps: f64, leg: usize| {
            if speed_mps > 0.0 {
                speed_mps * (grounds_mps[leg] / knots[leg + 1].speed_mps)
            } else {
                speed_mps
            }
        };
        let first_mps = match self.initial_mps(&knots) {
            Some(initial_mps) => initial_mps.min(grounds_mps[0]),
            None => carried(first_mps, 0),
        };
        let ends_mps = (first_mps, carried(last_mps, knots.len() - 2));
        let run = legs::run(&knots, (self.vehicle, self.law), &grounds_mps, ends_mps);
        let lines = knots
            .windows(2)
            .map(|pair| self.trajectory.altitude_line(&pair[0], &pair[1]))
            .collect::<Result<Vec<_>, _>>()?;
        let (firsts, braking) = self.lay_legs(&run, &knots, &lines)?;
        let legs = Legs {
            knots: &knots,
            lines: &lines,
            run: &run,
            firsts: &firsts,
        };
        self.flight
            .take_stock(&legs, &self.trajectory.segments, self.trajectory.t_s);
        self.lay_altitude_offsets(&knots, &firsts)?;
        self.lay_overshoot(&knots, &grounds_mps, &firsts)?;
        if let Some((hull, last)) = self.leave_hull(&knots, &firsts)? {
            // Places within the hull are passed, too, on any course.
            for leg in 0..=last {
                self.lay_arrivals((&hull, leg), &knots, &grounds_mps, &firsts)?;
            }
        }
        self.transition_lag_s = 0.0;
        if last_mps <= 0.0 {
            // What a stop takes longer it may have lost as it brakes for it.
            let late_s = stop_late_s(self.vehicle);
            for segment in &mut self.trajectory.segments[braking] {
                segment.late_s += late_s;
            }
            self.trajectory.late_s += late_s;
        }
        Ok(())
    }

    /// Lays what is flown along legs. Returns the first segment of each leg, and those of the last piece.
    fn lay_legs(
        &mut self,
        run: &Run,
        knots: &[Knot],
        lines: &[AltitudeLine],
    ) -> Result<(Vec<usize>, Range<usize>), Unknown> {
        let mut firsts = vec![self.trajectory.segments.len(); lines.len()];
        let mut last = self.trajectory.segments.len();
        for pieces in run.pieces.chunk_by(|one, other| one.leg == other.leg) {
            let leg = pieces[0].leg;
            let lasts_s = pieces.iter().map(legs::Piece::duration_s).sum();
            self.trajectory.late_s += leg_late_s(self.vehicle) + lasts_s * late_share(self.vehicle);
            self.count_on_sphere(&knots[leg..=leg + 1], lasts_s);
            firsts[leg] = self.trajectory.segments.len();
            for piece in pieces {
                last = self.trajectory.segments.len();
                self.trajectory.lay_piece(piece, knots, lines)?;
            }
        }
        Ok((firsts, last..self.trajectory.segments.len()))
    }

    /// By how much a leg makes the vehicle late or early, because the autopilot counts metres on a sphere: from
    /// [`COUNTS_AFTER_S`] on.
    fn count_on_sphere(&mut self, leg: &[Knot], lasts_s: f64) {
        let frame = self.trajectory.frame;
        let [from, to] = [&leg[0], &leg[1]].map(|knot| frame.from_plan(knot.at));
        let (begins_s, first) = (self.trajectory.t_s, self.trajectory.segments.first());
        let counts_s = first.map_or(begins_s, |segment| segment.from_s) + COUNTS_AFTER_S;
        let counted_s = (begins_s + lasts_s - counts_s).clamp(0.0, lasts_s);
        let late_s = counted_s * leg_late_share(self.vehicle, from, to);
        self.trajectory.late_s += late_s.max(0.0);
        self.trajectory.early_s += (-late_s).max(0.0);
    }

    /// The ground speed of an airborne departure along the first leg, m/s; none on later legs.
    pub(crate) fn initial_mps(&self, knots: &[Knot]) -> Option<f64> {
        let Departure::Airborne {
            course_rad,
            speed_mps,
            ..
        } = self.sites.departure
        else {
            return None;
        };
        let turn_rad = heading_rad(knots[0].at, knots[1].at) - course_rad;
        let is_first = self.trajectory.segments.is_empty();
        is_first.then(|| speed_mps * turn_rad.cos().max(0.0))
    }
}
