//! Orders one by one: what a vehicle does for each, on the ground and in the air.

use super::Pilot;
use crate::geodesy::LatLon;
use crate::mission::{
    Item, VehicleMission, acceptance_m, first_speed_mps, frame, within_speeds_mps,
};
use crate::spec::{Airframe, Autopilot};
use crate::verify::execute::decode::{After, Step, Unknown};
use crate::verify::execute::item::{self, Height, Order};

impl Pilot<'_> {
    pub(super) fn obey(
        &mut self,
        step: &Step,
        next: &After<'_>,
        mission: &VehicleMission,
    ) -> Result<(), Unknown> {
        let row = step.row;
        let unknown = |why: &str| Unknown::err(row, why);
        self.accept_m = acceptance_m(mission, row);
        if let (false, Order::Fly { height, .. } | Order::Stay { height, .. }) =
            (self.airborne, step.order)
            && !mission.facts().acceptance.needs_takeoff
        {
            self.lift_itself(row, height, mission)?;
        }
        let stops = self.vehicle.facts().stops;
        if self.airborne && stops.before.contains(&mission.items[row - 1].command) {
            self.stop()?;
        }
        match step.order {
            Order::Nothing => {}
            Order::Speed { .. } | Order::OwnSpeed if self.is_on_rotors(mission) => {}
            Order::Speed { speed_mps } => {
                self.speed_mps = Some(within_speeds_mps(mission, speed_mps));
            }
            Order::OwnSpeed => {
                self.speed_mps = first_speed_mps(mission, self.vehicle.speed_mps);
            }
            Order::Wait { hold_s } if !self.airborne => {
                let all_s = self.flight.delay_s.unwrap_or(0.0) + hold_s;
                self.flight.delay_s = Some(all_s);
                if let Some(after) = disarms_after(mission, all_s) {
                    return unknown(&after);
                }
            }
            Order::Wait { .. } if self.vehicle.airframe.has_wing() => {
                return unknown("a wait in the air, on a wing");
            }
            Order::Wait { hold_s } => {
                self.stop()?;
                self.hold(row, hold_s);
            }
            Order::Takeoff { height, .. } if self.airborne => {
                self.climb_again(row, height, mission.autopilot)?;
            }
            Order::Takeoff { at, height } if self.vehicle.airframe == Airframe::Plane => {
                self.climb_out(row, at, height)?;
            }
            Order::Takeoff { at, height } => self.take_off(row, at, height, mission)?,
            _ if !self.airborne => return unknown("no takeoff before it"),
            _ => self.navigate(step, next, mission)?,
        }
        Ok(())
    }

    /// Whether a change of speed is for the rotors: a VTOL of PX4 is on them until its takeoff is over
    /// (`Navigator::set_cruising_speed`).
    fn is_on_rotors(&self, mission: &VehicleMission) -> bool {
        let is_px4_vtol =
            mission.autopilot == Autopilot::Px4 && self.vehicle.airframe == Airframe::Vtol;
        is_px4_vtol && !self.airborne
    }

    /// Obeys an order that moves a vehicle in the air.
    fn navigate(
        &mut self,
        step: &Step,
        next: &After<'_>,
        mission: &VehicleMission,
    ) -> Result<(), Unknown> {
        let row = step.row;
        match step.order {
            Order::Nothing
            | Order::Speed { .. }
            | Order::OwnSpeed
            | Order::OnWing
            | Order::Wait { .. }
            | Order::Takeoff { .. } => {}
            Order::Stop => self.stop()?,
            Order::Fly { at, height, hold_s } => {
                self.turns_by_itself(row, &mission.items[row - 1])?;
                self.head_for(row, self.or_here(at), height)?;
                if let Some(hold_s) = hold_s {
                    self.stop()?;
                    self.hold(row, hold_s);
                }
            }
            Order::Stay {
                at,
                height,
                radius_m: Some(radius_m),
            } => {
                let at = self.or_here(at);
                self.circle(row, at, height, radius_m)?;
            }
            Order::Stay { at, height, .. } => {
                self.head_for(row, self.or_here(at), height)?;
                self.finish(row, mission)?;
            }
            Order::Spline { at, height, hold_s } => {
                self.spline((row, self.or_here(at), height), hold_s, (next, mission))?;
            }
            Order::Circle { at, height, circle } if self.vehicle.airframe.has_wing() => {
                self.circle_a_while((row, self.or_here(at), height), circle, next)?;
            }
            Order::Circle { at, height, circle } => {
                self.circle_on_rotors((row, self.or_here(at), height), circle, mission)?;
            }
            Order::Place { at, max_m } => {
                self.place_payload(row, self.or_here(at), max_m, mission)?
            }
            Order::Land { at: Some(at) } if self.vehicle.airframe == Airframe::Plane => {
                let item = &mission.items[row - 1];
                let height = item::height(item, mission.autopilot, self.home.amsl);
                let height = height.map_err(|why| Unknown { row, why })?;
                self.glide(row, at, height)?;
            }
            Order::Land { at } => {
                self.land(row, at, mission)?;
            }
            Order::Return => self.return_home(row, mission)?,
        }
        Ok(())
    }

    /// The altitude with which a copter flies to a place where it descends: the one that it has, above
    /// the ground where the item has one above terrain (`ModeAuto::shift_alt_to_current_alt`).
    pub(super) fn present_height(&self, item: &Item) -> Height {
        let follows = frame::canonical(item.frame) == frame::GLOBAL_TERRAIN_ALT;
        Height::Keep {
            follows: follows && !self.vehicle.airframe.has_wing(),
        }
    }

    /// The place, or the present one.
    fn or_here(&self, at: Option<LatLon>) -> LatLon {
        at.unwrap_or_else(|| self.world.frame.from_plan(self.last().at))
    }
}

/// Why a vehicle does not take off that waits so long on the ground, seconds: it disarms itself before.
fn disarms_after(mission: &VehicleMission, waits_s: f64) -> Option<String> {
    let row = mission.facts().disarms_after()?;
    let after_s = mission.param_or_default_si(row.name)?;
    (after_s > 0.0 && waits_s > after_s).then(|| {
        format!(
            "it waits for {waits_s} s on the ground, and disarms itself after {after_s} s there ({}; 0 or below: never)",
            row.name
        )
    })
}
