//! The legs ahead as knots: where a vehicle last stopped, and the points that it flies to from there.

use super::{Pilot, SAME_PLACE_M};
use crate::geodesy::{Agl, Amsl, EastNorth, LatLon, PlanPoint};
use crate::verify::execute::decode::Unknown;
use crate::verify::execute::flight::Mark;
use crate::verify::execute::item::Height;
use crate::verify::execute::legs::Knot;
use crate::verify::measure::segment::Phase;

/// Places further from the origin than this are beyond the local frame.
const REACH_M: f64 = 500_000.0;

impl Pilot<'_> {
    /// Adds a leg to a place at a height.
    pub(super) fn head_for(
        &mut self,
        row: usize,
        place: LatLon,
        height: Height,
    ) -> Result<(), Unknown> {
        let at = self.reach(row, place)?;
        let (amsl_m, agl_m) = self.resolve(row, place, height)?;
        let knot = self.knot(row, at, amsl_m, agl_m);
        let changes_kind = self.last().agl_m.is_some() != agl_m.is_some();
        if changes_kind && self.vehicle.facts().stops.between_altitude_kinds {
            self.stop()?;
        }
        self.is_doubled = at.distance_m(self.last().at) <= SAME_PLACE_M;
        if self.is_doubled && self.phase == Phase::Route && self.vehicle.airframe.has_wing() {
            let why = "a second waypoint at the place of the one before: a wing can neither stop nor climb there";
            return Unknown::err(row, why);
        }
        self.append(knot)?;
        self.phase_in();
        Ok(())
    }

    /// The first place after the takeoff is the start of the route.
    pub(crate) fn phase_in(&mut self) {
        if self.phase == Phase::Join {
            self.phase = Phase::Route;
        }
    }

    pub(crate) fn append(&mut self, knot: Knot) -> Result<(), Unknown> {
        let last = self.last();
        if knot.agl_m.is_none() && knot.phase != Phase::Finish {
            self.flight.note_low(Mark {
                point: knot.point(),
                row: knot.row,
                t_s: self.trajectory.t_s,
            });
        }
        if knot.at.distance_m(last.at) > SAME_PLACE_M {
            self.knots.push(knot);
        } else if (knot.amsl_m - last.amsl_m).abs() > SAME_PLACE_M {
            self.stop()?;
            self.climb(knot.row, knot.amsl_m);
            self.mark();
        } else if knot.phase == Phase::Join || !self.vehicle.airframe.has_wing() {
            // At the place of the takeoff the route begins; copters of both autopilots stop at a waypoint that is
            // there twice.
            self.stop()?;
            self.mark();
        }
        Ok(())
    }

    /// Altitude above the sea, and above the ground if the item says so.
    pub(crate) fn resolve(
        &self,
        row: usize,
        place: LatLon,
        height: Height,
    ) -> Result<(f64, Option<f64>), Unknown> {
        match height {
            Height::Sea(Amsl(amsl_m)) => Ok((amsl_m, None)),
            Height::Ground(Agl(agl_m)) => {
                Ok((self.trajectory.ground_m(row, place)? + agl_m, Some(agl_m)))
            }
            Height::Keep { follows: false } => Ok((self.last().amsl_m, None)),
            Height::Keep { follows: true } => {
                let last = self.last();
                let agl_m = match last.agl_m {
                    Some(agl_m) => agl_m,
                    None => {
                        let below = self.world.frame.from_plan(last.at);
                        last.amsl_m - self.trajectory.ground_m(row, below)?
                    }
                };
                Ok((self.trajectory.ground_m(row, place)? + agl_m, Some(agl_m)))
            }
        }
    }

    /// Planning coordinates of a place that is near enough to have any.
    pub(crate) fn reach(&self, row: usize, place: LatLon) -> Result<EastNorth, Unknown> {
        let origin = self.world.frame.origin();
        let away_m = (place.to_ecef(0.0) - origin.to_ecef(0.0)).norm();
        if away_m <= REACH_M {
            Ok(self.world.frame.to_plan(place))
        } else {
            let why = format!("a place {:.0} km from the origin", away_m / 1000.0);
            Unknown::err(row, why)
        }
    }

    pub(crate) fn knot(&self, row: usize, at: EastNorth, amsl_m: f64, agl_m: Option<f64>) -> Knot {
        Knot {
            row,
            at,
            amsl_m,
            agl_m,
            speed_mps: self.speed_mps.unwrap_or(self.vehicle.speed_mps),
            speed_is_known: self.speed_mps.is_some(),
            phase: self.phase,
            slope_from_m: None,
            accept_m: self.accept_m,
        }
    }

    pub(crate) fn last(&self) -> Knot {
        self.knots
            .last()
            .copied()
            .unwrap_or_else(|| self.knot(0, self.home.at, self.home.amsl.0, None))
    }

    pub(crate) fn here(&self) -> PlanPoint {
        self.last().point()
    }

    /// Notes where the vehicle is as a point of the route.
    pub(crate) fn mark(&mut self) {
        let last = self.last();
        self.flight.route.push(Mark {
            point: last.point(),
            row: last.row,
            t_s: self.trajectory.t_s,
        });
    }
}
