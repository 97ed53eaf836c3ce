//! Circles that a wing leaves again: `NAV_LOITER_TURNS`, `NAV_LOITER_TIME`, `NAV_LOITER_TO_ALT`.
//!
//! When it has flown its turns, its time, or has its altitude, ArduPlane circles on until it heads for
//! the next place, within 10 degrees (`Plane::verify_loiter_heading`). PX4 leaves on any course. Where on
//! its circle it is at a time is not known, and on its way on it is within the hull of the circle and the
//! next place.

use std::f64::consts::{FRAC_PI_2, TAU};

use crate::geodesy::{Amsl, EastNorth, LatLon, PlanPoint};
use crate::numeric::geometry;
use crate::path::{VehicleLimits, along, heading_rad};

use super::line::Line;
use crate::verify::execute::decode::{After, Unknown};
use crate::verify::execute::executor::Pilot;
use crate::verify::execute::flight::{Hull, Rest};
use crate::verify::execute::item::{Circling, Height, Order, Until};
use crate::verify::execute::legs::Knot;
use crate::verify::execute::trajectory::AltitudeLine;
use crate::verify::measure::segment::Segment;

/// Circles around one place that begin within this time of each other are one stay, seconds.
const SAME_STAY_S: f64 = 60.0;
/// Lines and columns that stand for a region are no further apart, metres.
const APART_M: f64 = 15.0;
/// A wing that leaves its circle on course keeps within this many radii of the middle.
const ALIGNED_REACH: f64 = 1.2;
/// A wing that comes to a circle with the wind from behind cuts inside of it by up to this share of its
/// turn radius, and is still on its climb there (4.6.3, simulated: 12 m of 96 m in 5 m/s).
const INSIDE_SHARE: f64 = 0.2;
/// What it may circle longer until it is on course, turns.
const ALIGNED_TURNS: f64 = 1.25;

impl Pilot<'_> {
    /// The radius of a circle as it is flown, metres; its sign is the direction. One that begins higher is
    /// the wider there.
    pub(crate) fn flown_radius_m(
        &self,
        (row, place, height): (usize, LatLon, Height),
        stated_m: f64,
    ) -> Result<f64, Unknown> {
        let Some(widening) = self.widening else {
            return Ok(stated_m);
        };
        let (amsl_m, _) = self.resolve(row, place, height)?;
        let airspeed_mps = self.speed_mps.unwrap_or(self.vehicle.speed_mps);
        let highest = Amsl(amsl_m.max(self.last().amsl_m));
        Ok(widening.radius_m(stated_m, highest, airspeed_mps))
    }

    /// Circles for a while, then goes on.
    pub(crate) fn circle_a_while(
        &mut self,
        (row, place, height): (usize, LatLon, Height),
        circle: Circling,
        next: &After<'_>,
    ) -> Result<(), Unknown> {
        let from = self.last();
        let radius_m = self.flown_radius_m((row, place, height), circle.radius_m)?;
        let (middle, rim) = self.enter_circle((row, place, height), radius_m)?;
        let rim_m = radius_m.abs();
        let (begin_s, first) = (self.trajectory.t_s, self.trajectory.segments.len());
        self.orbit(row, middle, rim, radius_m)?;
        let orbit_s = self.trajectory.t_s - begin_s;
        let is_aligned = circle.leaves_aligned && self.goes_elsewhere(next, middle, rim_m);
        let reach_m = self.reach_of_circle_m(rim_m, is_aligned);
        let (needed_s, more_s) = match circle.until {
            Until::Turns(turns) => (turns * orbit_s, 0.0),
            Until::Seconds(seconds) => (seconds, 0.0),
            Until::Altitude => (0.0, self.climb_s(rim.amsl_m - from.amsl_m)),
        };
        // It may leave from the side of its circle that is nearest to the next place.
        let sooner_s = orbit_s * reach_m / (TAU * rim_m);
        let lasts_s = (needed_s - sooner_s).max(0.0);
        for segment in &mut self.trajectory.segments[first..] {
            // One orbit in space; in time it is somewhere on it.
            (segment.flown, segment.from_s, segment.to_s) = (false, begin_s, begin_s + needed_s);
        }
        self.trajectory.t_s = begin_s;
        let late_s =
            ALIGNED_TURNS * orbit_s + 2.0 * sooner_s + more_s + (sooner_s - needed_s).max(0.0);
        let over = PlanPoint {
            at: middle,
            amsl: Amsl(rim.amsl_m),
        };
        self.note_circle(row, over, (begin_s, needed_s));
        self.trajectory.late_s += late_s;
        let stay = self.trajectory.segments.len();
        self.trajectory
            .straight((row, self.phase), (over, over), lasts_s, None);
        self.widen_from(stay, reach_m);
        let hull = Hull {
            middle: over,
            reach_m,
            from_s: begin_s,
            until_s: begin_s + needed_s + late_s,
            any_course: false,
        };
        let times_s = (hull.from_s, hull.until_s);
        if circle.until == Until::Altitude {
            self.lay_columns((row, over), reach_m, from.amsl_m, times_s);
        }
        if !is_aligned {
            self.lay_disc(row, over, reach_m, times_s);
        } else if self.circle_wide_m() > 0.0 {
            let off_m = self.off_at_rim_m(&from, middle, (rim.amsl_m, rim_m));
            self.lay_rings((row, over), [rim_m, reach_m - rim_m], off_m, times_s);
        }
        self.leave(Knot { at: middle, ..rim }, hull);
        Ok(())
    }

    /// Notes that it stays around a place; circles there that follow each other are one stay.
    fn note_circle(&mut self, row: usize, over: PlanPoint, (from_s, needed_s): (f64, f64)) {
        match self.flight.rests.last_mut() {
            Some(last) if last.point == over && from_s - last.until_s < SAME_STAY_S => {
                (last.until_s, last.rows.1) = (last.until_s + needed_s, row);
            }
            _ => self.flight.rests.push(Rest {
                point: over,
                from_s,
                until_s: from_s + needed_s,
                late_s: self.trajectory.late_s,
                early_s: self.trajectory.early_s,
                rows: (row, row),
            }),
        }
    }

    /// How far from its middle a wing is at most that leaves a circle on course or not, metres.
    fn reach_of_circle_m(&self, rim_m: f64, is_aligned: bool) -> f64 {
        match is_aligned {
            true => (ALIGNED_REACH * rim_m).max(rim_m + self.circle_wide_m()),
            false => self.wide_reach_m(rim_m),
        }
    }

    /// Goes on from a circle, which the knot at its middle stands for.
    fn leave(&mut self, middle: Knot, hull: Hull) {
        (self.knots, self.moving_mps) = (vec![middle], middle.speed_mps);
        self.hull = Some(hull);
        self.mark();
        self.phase_in();
    }

    /// Whether the next place is one that it can head for from its circle.
    fn goes_elsewhere(&self, next: &After<'_>, middle: EastNorth, rim_m: f64) -> bool {
        let After::Step(step) = next else {
            return false;
        };
        let (Order::Fly { at: Some(at), .. }
        | Order::Stay { at: Some(at), .. }
        | Order::Circle { at: Some(at), .. }
        | Order::Land { at: Some(at) }) = step.order
        else {
            return false;
        };
        self.reach(step.row, at)
            .is_ok_and(|at| at.distance_m(middle) > rim_m)
    }

    /// How long a climb or descent takes, seconds: the one by the slower of the two rates.
    fn climb_s(&self, climb_m: f64) -> f64 {
        climb_m.abs() / self.vehicle.climb_mps.min(self.vehicle.descent_mps)
    }

    /// How far from its middle a wing may be that comes to a circle or leaves it on any course,
    /// metres: it turns outside of it at worst.
    pub(crate) fn wide_reach_m(&self, rim_m: f64) -> f64 {
        rim_m + 2.0 * VehicleLimits::of(self.vehicle).turn_radius_m
    }

    /// Widens the segments from one on by a distance, for the separation.
    pub(crate) fn widen_from(&mut self, first: usize, by_m: f64) {
        for segment in &mut self.trajectory.segments[first..] {
            if segment.flown {
                segment.wide_m = segment.wide_m.max(by_m);
            }
        }
    }

    /// Lays a disc, to be judged in space: lines across it.
    pub(crate) fn lay_disc(
        &mut self,
        row: usize,
        middle: PlanPoint,
        radius_m: f64,
        times_s: (f64, f64),
    ) {
        for (aside_m, half_m) in slices(radius_m) {
            let line = along(middle.at, 0.0, aside_m);
            let ends = [-half_m, half_m].map(|half_m| PlanPoint {
                at: along(line, FRAC_PI_2, half_m),
                ..middle
            });
            let segment = Segment::unflown((row, self.phase), times_s, (ends[0], ends[1]));
            self.trajectory.segments.push(segment);
        }
    }

    /// How much further out than its radius a wing may be on a circle, metres.
    pub(super) fn circle_wide_m(&self) -> f64 {
        let share = self.vehicle.facts().behaviour.circle_wide_share;
        let turn_radius_m = VehicleLimits::of(self.vehicle).turn_radius_m;
        share.value(self.vehicle.autopilot_version) * turn_radius_m
    }

    /// How far off its altitude a wing may be on a circle, metres.
    pub(super) fn circle_level_m(&self) -> f64 {
        let figure = self.vehicle.facts().behaviour.circle_level_m;
        figure.value(self.vehicle.autopilot_version)
    }

    /// Lays rings around a circle, to be judged in space, from inside of it to a distance beyond its radius, at its
    /// altitude and where the wing may be below and above that, metres.
    pub(super) fn lay_rings(
        &mut self,
        at: (usize, PlanPoint),
        radii_m: [f64; 2],
        [low_m, high_m]: [f64; 2],
        times_s: (f64, f64),
    ) {
        let ((row, over), [rim_m, wide_m]) = (at, radii_m);
        let turn_radius_m = VehicleLimits::of(self.vehicle).turn_radius_m;
        let radius_m = (rim_m - INSIDE_SHARE * turn_radius_m).max(0.0);
        let wide_m = wide_m + rim_m - radius_m;
        let rings = steps(wide_m);
        for up_m in [0.0, -low_m, high_m] {
            let over = over.raised(up_m);
            for ring in 0..=rings {
                let ring_m = radius_m + wide_m * f64::from(ring) / f64::from(rings);
                let count = steps(TAU * ring_m).max(12);
                let step_rad = TAU / f64::from(count);
                let at = |step: u16| PlanPoint {
                    at: along(over.at, step_rad * f64::from(step), ring_m),
                    ..over
                };
                for step in 0..count {
                    let ends = (at(step), at(step + 1));
                    let segment = Segment::unflown((row, self.phase), times_s, ends);
                    self.trajectory.segments.push(segment);
                }
            }
        }
    }

    /// Lays columns around a circle, to be judged in space: there it climbs or descends.
    fn lay_columns(
        &mut self,
        (row, over): (usize, PlanPoint),
        radius_m: f64,
        from_m: f64,
        times_s: (f64, f64),
    ) {
        let steps = steps(TAU * radius_m);
        for step in 0..steps {
            let course_rad = TAU * f64::from(step) / f64::from(steps);
            let top = PlanPoint {
                at: along(over.at, course_rad, radius_m),
                ..over
            };
            let foot = PlanPoint {
                amsl: Amsl(from_m),
                ..top
            };
            let segment = Segment::unflown((row, self.phase), times_s, (foot, top));
            self.trajectory.segments.push(segment);
        }
        let foot = PlanPoint {
            amsl: Amsl(from_m),
            ..over
        };
        self.lay_disc(row, foot, radius_m, times_s);
    }

    /// Lays the hull of a circle and the first leg from it, and of further ones that begin within the
    /// circle, to be judged in space; for the separation, widens the segments of those legs by as much.
    ///
    /// What is left, and the last of those legs.
    pub(crate) fn leave_hull(
        &mut self,
        knots: &[Knot],
        firsts: &[usize],
    ) -> Result<Option<(Hull, usize)>, Unknown> {
        let Some(hull) = self.hull.take().filter(|_| knots.len() > 1) else {
            return Ok(None);
        };
        let mut last = 0;
        let flown = self.trajectory.segments.len();
        let lines = self.leg_lines(knots, firsts)?;
        for (leg, (pair, lines)) in knots.windows(2).zip(&lines).enumerate() {
            let is_within = pair[0].at.distance_m(hull.middle.at) < hull.reach_m;
            if leg > 0 && !is_within {
                break;
            }
            last = leg;
            let first = firsts.get(leg).copied().unwrap_or(flown);
            let end = firsts.get(leg + 1).copied().unwrap_or(flown);
            for segment in &mut self.trajectory.segments[first.min(end)..end] {
                segment.wide_m = segment.wide_m.max(hull.reach_m);
            }
            self.lay_hull(&hull, &pair[1]);
            for line in lines {
                self.lay_hull_along(&hull, (&pair[0], &pair[1]), line)?;
            }
        }
        Ok(Some((hull, last)))
    }

    /// Lays the hull of a circle and the end of a leg at the altitudes of that leg, which count by how far
    /// along it the wing is: abeam of its beginning and before that it has the altitude there.
    fn lay_hull_along(
        &mut self,
        hull: &Hull,
        (from, to): (&Knot, &Knot),
        line: &AltitudeLine,
    ) -> Result<(), Unknown> {
        let times_s = (hull.from_s, hull.until_s.max(self.trajectory.t_s));
        let leg = Line::new(from.at, to.at);
        let mut lay = |ends: [EastNorth; 2], shares: (f64, f64)| {
            let [back, on] = ends.map(|at| PlanPoint { at, ..hull.middle });
            let segment = Segment::unflown((to.row, to.phase), times_s, (back, on));
            self.trajectory.lay_aside(segment, shares, line)
        };
        for at in rim(hull, to.at) {
            let gone = leg.share(at);
            if gone >= 0.0 {
                lay([at, to.at], (gone.min(1.0), 1.0))?;
                continue;
            }
            let to_abeam = -gone / (1.0 - gone);
            let [back, end] = [at, to.at].map(|at| PlanPoint { at, ..hull.middle });
            let abeam = back.toward(end, to_abeam).at;
            lay([at, abeam], (0.0, 0.0))?;
            lay([abeam, to.at], (0.0, 1.0))?;
        }
        Ok(())
    }

    /// Lays the hull of a circle and a place.
    fn lay_hull(&mut self, hull: &Hull, to: &Knot) {
        let times_s = (hull.from_s, hull.until_s.max(self.trajectory.t_s));
        // It may begin a descent late, from above.
        let over_m = self.circle_level_m();
        for at in rim(hull, to.at) {
            let back = PlanPoint { at, ..hull.middle };
            let segment = Segment::unflown((to.row, to.phase), times_s, (back, to.point()));
            self.trajectory.segments.push(segment);
            let late = PlanPoint {
                at: to.at,
                ..back.raised(over_m)
            };
            if to.amsl_m < late.amsl.0 {
                let ends = (back.raised(over_m), late);
                let segment = Segment::unflown((to.row, to.phase), times_s, ends);
                self.trajectory.segments.push(segment);
            }
        }
    }
}

/// Places on the part of the rim of a disc that a place sees through the disc, from the one tangent to
/// the other: the lines from them to the place cover the hull of both.
fn rim(hull: &Hull, place: EastNorth) -> impl Iterator<Item = EastNorth> {
    let (middle, reach_m) = (hull.middle.at, hull.reach_m);
    let course_rad = heading_rad(middle, place);
    // From a place within the disc all of its rim.
    let tangent_rad = (reach_m / middle.distance_m(place)).min(1.0).acos();
    let arc_rad = TAU - 2.0 * tangent_rad;
    let steps = steps(arc_rad * reach_m);
    (0..=steps).map(move |step| {
        let off_rad = tangent_rad + arc_rad * f64::from(step) / f64::from(steps);
        along(middle, course_rad + off_rad, reach_m)
    })
}

/// Lines across a disc: how far each is aside of the middle, and half its length, metres.
fn slices(radius_m: f64) -> impl Iterator<Item = (f64, f64)> {
    let steps = steps(2.0 * radius_m);
    (0..=steps).map(move |step| {
        let aside_m = radius_m * (2.0 * f64::from(step) / f64::from(steps) - 1.0);
        let half_m = (radius_m * radius_m - aside_m * aside_m).max(0.0).sqrt();
        (aside_m, half_m)
    })
}

/// Into how many steps a length is cut.
pub(super) fn steps(length_m: f64) -> u16 {
    geometry::steps(length_m, APART_M, (2, 10_000))
}
