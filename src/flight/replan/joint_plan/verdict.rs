//! The verdict on a joint plan, with the item numbers that vehicles have on board.

use super::{JointPlan, Replanned};
use crate::flight::conformance::reference::ReferenceTrajectory;
use crate::flight::replan::new_mission::{NewMission, head_len};
use crate::mission::VehicleMission;
use crate::spec::Vehicle;
use crate::verify::{self, Limit, Margin};

impl JointPlan<'_> {
    /// Judges the whole fleet, and takes the times of the new plans from the verdict.
    pub(super) fn judge(self, mut new: Vec<NewMission>) -> Replanned {
        let judged: Vec<(usize, &VehicleMission)> = self.missions.iter().enumerate().collect();
        let mut review = verify::review(&self.spec, &self.world, &judged);
        // Off its place is better than through a threat; the flight is judged by where it lands.
        let fleet = &self.spec.vehicles;
        review
            .margins
            .retain(|margin| !is_driven_off(margin, fleet));
        let meets_return = !self.returns_met.is_empty();
        review.margins.splice(0..0, self.returns_met);
        review.margins.extend(self.problems);
        let others = self.missions.len() - new.len().min(self.missions.len());
        for (new, index) in new.iter_mut().zip(others..) {
            if let (Some(mission), Some(track)) =
                (self.missions.get(index), review.tracks.get(index))
            {
                let judged = ReferenceTrajectory::new(mission, track, &self.world);
                new.time(&judged, head_len(&mission.items), self.given.now_s);
            }
        }
        for margin in &mut review.margins {
            let Some(at) = &mut margin.at else { continue };
            let mut vehicles = self.spec.vehicles.iter();
            let of = vehicles.position(|vehicle| vehicle.id == margin.vehicle);
            if let Some((current, rows)) = of.and_then(|of| self.rows.get(of)) {
                let row = at.item.checked_sub(1).and_then(|row| rows.get(row));
                at.item = *row.unwrap_or(current);
            }
        }
        Replanned {
            missions: new,
            review,
            has_buffers: true,
            meets_return,
        }
    }
}

/// Whether a vehicle misses the place of its landing because the wind from behind may drive it off alone.
fn is_driven_off(margin: &Margin, fleet: &[Vehicle]) -> bool {
    let vehicle = fleet.iter().find(|vehicle| vehicle.id == margin.vehicle);
    let drift_m = vehicle.map_or(0.0, |vehicle| vehicle.landing_drift_m(None));
    let is_finish = margin.limit == Limit::Finish && !margin.ok;
    is_finish && margin.value - drift_m <= margin.bound
}
