//! The fence that parameters set, against all that is flown: circles, climb-outs and corners reach
//! beyond the places of items, and a floor counts only once the vehicle was above it.

use super::MissionCheck;
use crate::mission::{AcceptanceProblem, Item, ParamFence, above_home_m, command};
use crate::verify::Moment;
use crate::verify::measure::segment::{Phase, Segment};

/// A wing that is lower than its last place by no more is at its altitude, metres.
const LEVEL_M: f64 = 0.01;

impl MissionCheck<'_> {
    /// The first place at which the flight comes to the fence of the mission's parameters. On a return, by
    /// an item or at the end of a mission in the air, a breach would change nothing.
    pub(super) fn comes_to_param_fence(&self) -> Option<(AcceptanceProblem, Moment)> {
        let fence = ParamFence::of(self.mission).filter(|fence| fence.acts)?;
        let home = self.sites.home;
        let mut was_above = false;
        self.flight.segments.iter().find_map(|segment| {
            let item = self.mission.items.get(segment.row.checked_sub(1)?)?;
            let lands = is_takeoff_or_landing(item);
            let is_end = segment.phase == Phase::Finish && !lands;
            let is_return = item.command == command::NAV_RETURN_TO_LAUNCH;
            if is_end || is_return || self.turns_back(item, segment) {
                return None;
            }
            let is_low = was_above && !lands;
            let ends = [(segment.from, 0.0), (segment.to, 1.0)];
            ends.into_iter().find_map(|(end, u)| {
                let above_m = end.amsl.0 - home.amsl.0;
                was_above |= fence.floor_counts_from(above_m);
                let away_m = end.at.distance_m(home.at) + segment.error_m;
                let low = fence.below(above_m).filter(|_| is_low);
                let found = fence.beyond(Some(above_m), Some(away_m)).or(low)?;
                let problem = AcceptanceProblem::param_fence(segment.row, found);
                Some((problem, segment.moment(&self.world.frame, u)))
            })
        })
    }

    /// Whether a segment is the turn of a wing into its return, in which it climbs from the last place on.
    fn turns_back(&self, item: &Item, segment: &Segment) -> bool {
        let next = self.mission.items.get(segment.row);
        let returns = next.is_none_or(|next| next.command == command::NAV_RETURN_TO_LAUNCH);
        let from_m = segment.from.amsl.0 - self.sites.home.amsl.0;
        let is_over = above_home_m(item, self.mission).is_some_and(|m| from_m >= m - LEVEL_M);
        let climbs = segment.to.amsl > segment.from.amsl;
        self.vehicle.airframe.has_wing() && returns && is_over && climbs
    }
}

/// Whether the floor does not count on the way to an item: autopilots switch it off as they land.
fn is_takeoff_or_landing(item: &Item) -> bool {
    [
        command::NAV_TAKEOFF,
        command::NAV_VTOL_TAKEOFF,
        command::NAV_LAND,
        command::NAV_VTOL_LAND,
    ]
    .contains(&item.command)
}
