//! How a flight ends: landed, at home again, or in the air for ever.

use super::Pilot;
use crate::autopilot::SLOW_LANDING_M;
use crate::geodesy::{Amsl, LatLon};
use crate::mission::VehicleMission;
use crate::verify::execute::decode::Unknown;
use crate::verify::execute::flight::End;
use crate::verify::measure::segment::Phase;
use crate::world::Terrain;

impl Pilot<'_> {
    pub(crate) fn land(&mut self, row: usize, at: Option<LatLon>) -> Result<(), Unknown> {
        if let Some(place) = at {
            let last = self.last();
            let at = self.reach(row, place)?;
            let knot = self.knot(row, at, last.amsl_m, None);
            self.append(knot)?;
        }
        self.stop()?;
        self.phase = Phase::Finish;
        self.touch_down(row)
    }

    pub(crate) fn return_home(
        &mut self,
        row: usize,
        mission: &VehicleMission,
    ) -> Result<(), Unknown> {
        let refuse = |why: &str| Unknown::err(row, why);
        let Some(Amsl(return_m)) = self.vehicle.return_amsl else {
            return refuse(
                "NAV_RETURN_TO_LAUNCH, and no return altitude is given (return_amsl_m, --return-amsl)",
            );
        };
        if !mission.rally.is_empty() {
            return refuse("NAV_RETURN_TO_LAUNCH with rally points may end at one of them");
        }
        self.stop()?;
        self.phase = Phase::Finish;
        if self.last().amsl_m < return_m {
            self.climb(row, return_m);
        }
        let knot = self.knot(row, self.home.at, self.last().amsl_m, None);
        self.append(knot)?;
        self.stop()?;
        self.touch_down(row)
    }

    /// Descends to the ground.
    fn touch_down(&mut self, row: usize) -> Result<(), Unknown> {
        let at = self.last().at;
        let ground_m = match self.world.terrain {
            // Where it touches down is then not judged; when, well enough.
            Terrain::Unknown => self.home.amsl.0,
            _ => self
                .trajectory
                .ground_m(row, self.world.frame.from_plan(at))?,
        };
        let slow_mps = self.vehicle.facts().behaviour.slow_landing_mps;
        let descent_mps = self.vehicle.descent_mps;
        let slow_m = ground_m + SLOW_LANDING_M;
        if self.last().amsl_m > slow_m {
            self.lift(row, slow_m, descent_mps, true);
        }
        self.lift(row, ground_m, descent_mps.min(slow_mps), true);
        self.ended = true;
        self.flight.end = Some(End::Landed(at));
        Ok(())
    }

    /// Stays in the air for ever, unless it has landed.
    pub(crate) fn finish(&mut self, row: usize) -> Result<(), Unknown> {
        if self.ended {
            return Ok(());
        }
        if !self.airborne {
            return Unknown::err(row, "no takeoff");
        }
        if self.vehicle.airframe.has_wing() {
            return Unknown::err(row, "the mission ends in the air, and a wing does not stay");
        }
        self.stop()?;
        self.hold(row, f64::INFINITY);
        self.ended = true;
        self.flight.end = Some(End::Stays(self.last().at));
        Ok(())
    }
}
