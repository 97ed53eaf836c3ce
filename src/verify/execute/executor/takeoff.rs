//! Takeoffs on rotors.

use crate::geodesy::{Amsl, LatLon};
use crate::mission::VehicleMission;
use crate::spec::{Airframe, Autopilot};
use crate::verify::execute::decode::Unknown;
use crate::verify::execute::item::Height;
use crate::verify::measure::segment::Phase;

use super::{Pilot, is_launched};

/// Default of PX4's `MIS_TAKEOFF_ALT`, metres.
const LEAST_TAKEOFF_M: f64 = 2.5;
/// ArduCopter climbs by this at least (`ModeAuto::takeoff_start`), metres.
const LEAST_CLIMB_M: f64 = 1.0;

/// How far PX4 climbs at least on rotors, metres (`Mission::calculate_takeoff_altitude`).
fn least_takeoff_m(mission: &VehicleMission) -> f64 {
    let held = mission.param("MIS_TAKEOFF_ALT").filter(|m| m.is_finite());
    held.unwrap_or(LEAST_TAKEOFF_M)
}

impl Pilot<'_> {
    /// PX4 climbs over its home, to the altitude of the first item and `MIS_TAKEOFF_ALT` at least,
    /// before it flies there (`Mission::do_need_vertical_takeoff`).
    pub(crate) fn lift_itself(
        &mut self,
        row: usize,
        height: Height,
        mission: &VehicleMission,
    ) -> Result<(), Unknown> {
        let place = self.world.frame.from_plan(self.home.at);
        let (amsl_m, _) = self.resolve(row, place, height)?;
        let least_m = self.home.amsl.0 + least_takeoff_m(mission);
        self.take_off(row, None, Height::Sea(Amsl(amsl_m.max(least_m))), mission)
    }

    pub(crate) fn take_off(
        &mut self,
        row: usize,
        at: Option<LatLon>,
        height: Height,
        mission: &VehicleMission,
    ) -> Result<(), Unknown> {
        let autopilot = mission.autopilot;
        // The encoded delay is the departure.
        self.trajectory.t_s = match (self.flight.delay_s, autopilot) {
            (Some(delay_s), _) => delay_s,
            (None, autopilot) if is_launched(self.vehicle, autopilot) => self.vehicle.depart_s,
            (None, _) => 0.0,
        };
        let home = self.home;
        let place = self.world.frame.from_plan(home.at);
        let (amsl_m, _) = self.resolve(row, place, height)?;
        let amsl_m = match (self.vehicle.airframe, autopilot) {
            (Airframe::Copter, Autopilot::ArduPilot) => amsl_m.max(home.amsl.0 + LEAST_CLIMB_M),
            (Airframe::Copter | Airframe::Vtol, Autopilot::Px4) => {
                amsl_m.max(home.amsl.0 + least_takeoff_m(mission))
            }
            _ => amsl_m,
        };
        if amsl_m <= home.amsl.0 || home.amsl.0.is_nan() {
            let home_m = home.amsl.0;
            let why = format!("takeoff to {amsl_m:.2} m AMSL, not above home at {home_m:.2} m");
            return Unknown::err(row, why);
        }
        self.airborne = true;
        self.knots = vec![self.knot(row, home.at, home.amsl.0, None)];
        self.lift(row, amsl_m, self.vehicle.climb_mps, true);
        self.drift_up(row, self.here());
        if let Some(at) = at {
            let at = self.reach(row, at)?;
            if at.distance_m(home.at) > self.tolerance_m {
                let knot = self.knot(row, at, amsl_m, None);
                self.append(knot)?;
                self.stop()?;
                // That was still the takeoff, not the route.
                self.flight.route.clear();
            }
        }
        let start = self.stations.start;
        if self.here().distance_m(start) <= self.tolerance_m {
            self.phase = Phase::Route;
            self.mark();
        }
        Ok(())
    }

    /// A takeoff in the air: ArduCopter climbs where it is, and never descends for it.
    pub(crate) fn climb_again(
        &mut self,
        row: usize,
        height: Height,
        autopilot: Autopilot,
    ) -> Result<(), Unknown> {
        if (self.vehicle.airframe, autopilot) != (Airframe::Copter, Autopilot::ArduPilot) {
            return Unknown::err(row, "a second takeoff");
        }
        self.stop()?;
        let last = self.last();
        let place = self.world.frame.from_plan(last.at);
        let (amsl_m, _) = self.resolve(row, place, height)?;
        if amsl_m > last.amsl_m {
            self.climb(row, amsl_m);
        }
        self.mark();
        Ok(())
    }
}
