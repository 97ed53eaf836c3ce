//! Takeoffs on rotors.

use crate::geodesy::{Amsl, EastNorth, LatLon};
use crate::mission::VehicleMission;
use crate::spec::{Airframe, Autopilot};
use crate::verify::execute::decode::Unknown;
use crate::verify::execute::item::Height;
use crate::verify::measure::segment::{Column, Phase};

use super::{Pilot, SAME_PLACE_M, is_launched};

/// Default of PX4's `MIS_TAKEOFF_ALT`, metres.
const MIN_TAKEOFF_M: f64 = 2.5;
/// ArduCopter climbs by this at least (`ModeAuto::takeoff_start`), metres.
const MIN_CLIMB_M: f64 = 1.0;
/// Default of PX4's `MPC_LAND_ALT1`, metres.
const SLOW_TAKEOFF_M: f64 = 10.0;
/// From so far on the course to the place of its takeoff is known in spite of the errors of positions, metres.
const MIN_AHEAD_M: f64 = 20.0;

/// How far PX4 climbs at least on rotors, metres (`Mission::calculate_takeoff_altitude`).
fn min_takeoff_m(mission: &VehicleMission) -> f64 {
    let held = mission.param("MIS_TAKEOFF_ALT").filter(|m| m.is_finite());
    held.unwrap_or(MIN_TAKEOFF_M)
}

/// How much longer than at its climb rate PX4 takes on rotors for its first metres, seconds (`MPC_TKO_SPEED` below
/// `MPC_LAND_ALT1`). Plans set both rates alike; what was measured of their takeoffs does not have it.
fn slow_takeoff_s(mission: &VehicleMission, climb_mps: f64) -> f64 {
    if mission.autopilot != Autopilot::Px4 || mission.airframe == Airframe::Plane {
        return 0.0;
    }
    let takeoff_mps = mission.param_or_default_si("MPC_TKO_SPEED");
    let takeoff_mps = takeoff_mps.map_or(climb_mps, |mps| mps.max(0.1).min(climb_mps));
    SLOW_TAKEOFF_M / takeoff_mps - SLOW_TAKEOFF_M / climb_mps
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
        let min_m = self.home.amsl.0 + min_takeoff_m(mission);
        self.take_off(row, None, Height::Sea(Amsl(amsl_m.max(min_m))), mission)
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
            (Airframe::Copter, Autopilot::ArduPilot) => amsl_m.max(home.amsl.0 + MIN_CLIMB_M),
            (Airframe::Copter | Airframe::Vtol, Autopilot::Px4) => {
                amsl_m.max(home.amsl.0 + min_takeoff_m(mission))
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
        // A slower climb is late on its way up already.
        let behaviour = &self.vehicle.facts().behaviour;
        self.trajectory.late_s += slow_takeoff_s(mission, self.rotors.climb_mps)
            + behaviour.climb_late_s.value(self.vehicle.autopilot_version);
        self.lift(row, amsl_m, self.rotors.climb_mps, Some(Column::Ground));
        let aside = at.map(|at| self.reach(row, at)).transpose()?;
        let aside = aside.filter(|at| at.distance_m(home.at) > SAME_PLACE_M);
        if self.vehicle.airframe == Airframe::Vtol {
            self.transition(row, aside, amsl_m)?;
        } else if let Some(at) = aside {
            let knot = self.knot(row, at, amsl_m, None);
            self.append(knot)?;
            self.stop()?;
            // That was still the takeoff, not the route.
            self.flight.route.clear();
        }
        self.begin_route();
        Ok(())
    }

    /// From the top of its climb a VTOL flies on where its nose points. PX4 turns it to the place of its takeoff
    /// first (`Mission::handleTakeoff`), and passes that on its wing: a nearer one within its transition.
    fn transition(
        &mut self,
        row: usize,
        aside: Option<EastNorth>,
        amsl_m: f64,
    ) -> Result<(), Unknown> {
        let ahead = aside.filter(|at| at.distance_m(self.home.at) >= MIN_AHEAD_M);
        if ahead.is_none() {
            self.drift_up(row, self.here());
        }
        if let Some(at) = ahead {
            self.begin_route();
            let knot = self.knot(row, at, amsl_m, None);
            self.append(knot)?;
        }
        Ok(())
    }

    /// The route begins at its start, if the vehicle is there.
    fn begin_route(&mut self) {
        if self.here().distance_m(self.sites.start) <= self.tolerance_m {
            self.phase = Phase::Route;
            self.mark();
        }
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
