//! `NAV_PAYLOAD_PLACE` of ArduCopter: down until it feels the ground, and up again, by its sources
//! (`PayloadPlace::run`).

use super::Pilot;
use crate::geodesy::LatLon;
use crate::mission::{VehicleMission, placing_mps};
use crate::spec::RELEASE_S;
use crate::verify::execute::decode::Unknown;
use crate::verify::execute::item;
use crate::verify::measure::segment::Column;
use crate::world::Terrain;

impl Pilot<'_> {
    /// Flies to a place at the altitude that it has, descends, and rises to where it was.
    pub(crate) fn place_payload(
        &mut self,
        row: usize,
        place: LatLon,
        max_m: Option<f64>,
        mission: &VehicleMission,
    ) -> Result<(), Unknown> {
        let at = self.reach(row, place)?;
        let keeps = self.present_height(&mission.items[row - 1]);
        let (amsl_m, agl_m) = self.resolve(row, place, keeps)?;
        self.never_comes_to(row, (place, amsl_m), mission)?;
        let changes_kind = self.last().agl_m.is_some() != agl_m.is_some();
        if changes_kind && self.vehicle.facts().stops.between_altitude_kinds {
            self.stop()?;
        }
        self.append(self.knot(row, at, amsl_m, agl_m))?;
        self.stop()?;
        let top_m = self.last().amsl_m;
        let ground_m = match self.world.terrain {
            // How far down it is then is not judged.
            Terrain::Unknown => self.home.amsl.0,
            _ => self.trajectory.ground_m(row, place)?,
        };
        if ground_m >= top_m {
            return Unknown::err(row, "a place for a payload that is not below the vehicle");
        }
        let bottom_m = max_m.map_or(ground_m, |max_m| ground_m.max(top_m - max_m));
        let began_s = (self.trajectory.t_s, self.trajectory.late_s);
        let slow_mps = self.descent.slow_mps;
        let release_s = RELEASE_S + mission.param("PLDP_DELAY").unwrap_or(0.0).max(0.0);
        match placing_mps(mission) {
            Some(own_mps) => {
                let down_mps = if own_mps > 0.0 { own_mps } else { slow_mps };
                self.lift(row, bottom_m, down_mps, Some(Column::Ground));
                let below = self.here();
                self.trajectory.straight(
                    (row, self.phase),
                    (below, below),
                    release_s,
                    Some(Column::Ground),
                );
            }
            // Its parameter or the speed of a landing: down with the one, as late as with the other.
            None => {
                let down_mps = self.vehicle.descent_mps;
                let slower_s = (top_m - bottom_m) * (1.0 / slow_mps - 1.0 / down_mps);
                self.trajectory.late_s += slower_s + release_s;
                self.lift(row, bottom_m, down_mps, Some(Column::Ground));
            }
        }
        self.lift(row, top_m, self.vehicle.climb_mps, Some(Column::Ground));
        // What it does below a place belongs to its rest there.
        self.rest_since(row, began_s);
        self.mark();
        self.phase_in();
        Ok(())
    }

    /// Past a waypoint without a stop ArduCopter has the leg to the place laid already, to the altitude of the item
    /// (`ModeAuto::set_next_wp`). It flies that, waits to be at the altitude that it had, and stays there for ever.
    fn never_comes_to(
        &self,
        row: usize,
        (place, keeps_m): (LatLon, f64),
        mission: &VehicleMission,
    ) -> Result<(), Unknown> {
        let item = &mission.items[row - 1];
        if self.knots.len() < 2 || item.z == 0.0 {
            return Ok(());
        }
        let height = item::height(item, mission.autopilot, self.home.amsl);
        let height = height.map_err(|why| Unknown { row, why })?;
        let (own_m, _) = self.resolve(row, place, height)?;
        if (own_m - keeps_m).abs() <= self.accept_m {
            return Ok(());
        }
        Unknown::err(
            row,
            "NAV_PAYLOAD_PLACE at another altitude than the waypoint before it, which is flown through: ArduCopter flies to that \
             altitude and stays there for ever (give it the altitude of the waypoint, or the waypoint a hold of 1 s)",
        )
    }
}
