//! The buffers of a mission.

use super::super::keys;
use super::super::{Buffers, Objective};
use super::Checker;
use crate::autopilot::facts;

impl Checker {
    /// The buffers of a mission. Those that the spec does not state are the largest default of its
    /// vehicles; version 1 and the objective of the paper have none.
    pub(super) fn buffers(&mut self, keys: &keys::Spec) -> Buffers {
        let is_paper = keys.planner.objective == Objective::Paper;
        if keys.sortie < 2 || is_paper {
            if keys.buffer_m.is_some() {
                let (found, allowed) = match is_paper {
                    true => (
                        "a buffer with planner.objective: paper",
                        "no buffer_m, or objective: operational",
                    ),
                    false => (
                        "a buffer in a spec of version 1",
                        "no buffer_m, or sortie: 2 (`sortie migrate` rewrites a spec)",
                    ),
                };
                self.report("buffer_m", found, allowed);
            }
            return Buffers::NONE;
        }
        let given = keys.buffer_m.unwrap_or_default();
        let defaults = keys.vehicles.iter().filter_map(|vehicle| {
            let airframe = vehicle.airframe.unwrap_or_default();
            Some(facts(vehicle.autopilot?, airframe).buffer_m)
        });
        let all_m = given.all.unwrap_or_else(|| defaults.fold(0.0, f64::max));
        Buffers {
            threats_m: given.threats.unwrap_or(all_m),
            zones_m: given.zones.unwrap_or(all_m),
            area_m: given.area.unwrap_or(all_m),
            terrain_m: given.terrain.unwrap_or(all_m),
            ceiling_m: given.ceiling.unwrap_or(all_m),
            separation_m: given.separation.unwrap_or(all_m),
        }
    }
}
