//! Where a new path branches off the present one, and what a vehicle retains before that.

use super::VehicleState;
use super::items::{after_actions, is_takeoff, with_amsl};
use super::vias::Via;
use crate::flight::replan::path_distance::comes_near;
use crate::geodesy::{Amsl, EastNorth, PlanPoint};
use crate::mission::Item;

/// Where a new path branches off the present one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Branch {
    /// The point.
    pub(in crate::flight::replan) point: PlanPoint,
    /// Waypoints of `ahead` that lie before it: the vehicle retains them.
    pub(in crate::flight::replan) retained: usize,
    /// Distance along the path to it, metres.
    pub(in crate::flight::replan) distance_m: f64,
}

impl VehicleState {
    /// The branch after a distance along its path; none beyond the end.
    pub(in crate::flight::replan) fn branch_after(&self, distance_m: f64) -> Option<Branch> {
        let mut left_m = distance_m;
        let points = self.points();
        for (retained, pair) in points.windows(2).enumerate() {
            let length_m = pair[0].distance_m(pair[1]);
            if left_m < length_m {
                let share = left_m / length_m;
                let mix = |a: f64, b: f64| a + (b - a) * share;
                let point = PlanPoint::new(
                    mix(pair[0].at.east_m, pair[1].at.east_m),
                    mix(pair[0].at.north_m, pair[1].at.north_m),
                    Amsl(mix(pair[0].amsl.0, pair[1].amsl.0)),
                );
                return Some(Branch {
                    point,
                    retained,
                    distance_m,
                });
            }
            left_m -= length_m;
        }
        None
    }

    /// Whether its path comes nearer than a distance to a place before a branch.
    pub(in crate::flight::replan) fn meets_before(
        &self,
        branch: &Branch,
        center: EastNorth,
        distance_m: f64,
    ) -> bool {
        let mut points = self.points();
        points.truncate(branch.retained + 1);
        points.push(branch.point);
        comes_near(&points, center, distance_m)
    }

    /// Whether a branch lies in the column of a drop.
    pub(in crate::flight::replan) fn drops_at(&self, branch: &Branch) -> bool {
        self.drops.get(branch.retained).is_some_and(|drops| *drops)
    }

    /// The routes to plan from a branch, end to end.
    pub(in crate::flight::replan) fn routes(&self, branch: &Branch) -> Vec<(PlanPoint, PlanPoint)> {
        let Some(&(_, last)) = self.ahead.last() else {
            return Vec::new();
        };
        let mut points = vec![branch.point];
        points.extend(self.vias_after(branch).map(|via| via.point));
        points.push(last);
        points.windows(2).map(|pair| (pair[0], pair[1])).collect()
    }

    /// The places behind a branch that a new path leads over.
    pub(in crate::flight::replan) fn vias_after(
        &self,
        branch: &Branch,
    ) -> impl Iterator<Item = &Via> {
        let retained = branch.retained;
        self.vias.iter().filter(move |via| via.first >= retained)
    }

    /// Items ahead before a branch, with altitudes AMSL: waypoints, and what is done on the way.
    pub(in crate::flight::replan) fn retained_items(&self, branch: &Branch) -> Vec<Item> {
        let end = self.retained_end(branch);
        let items = self.held.items.get(self.first_ahead(branch)..end);
        let items = items.unwrap_or_default().iter();
        items.map(|item| with_amsl(item, &self.held.home)).collect()
    }

    /// Whether the items that are retained are waypoints one after the other, and what is done there.
    pub(in crate::flight::replan) fn is_contiguous(&self, branch: &Branch) -> bool {
        let retained = self.ahead.iter().take(branch.retained);
        let indices: Vec<usize> = retained.map(|(index, _)| *index).collect();
        let mut pairs = indices.windows(2);
        pairs.all(|pair| after_actions(&self.held.items, pair[0]) == pair[1])
    }

    /// Index of the first item ahead that is retained, or of the first that is not.
    pub(in crate::flight::replan) fn first_ahead(&self, branch: &Branch) -> usize {
        let first = self.ahead.first().filter(|_| branch.retained > 0);
        first.map_or_else(|| self.retained_end(branch), |(index, _)| *index)
    }

    /// Index of the first item that is not retained.
    pub(in crate::flight::replan) fn retained_end(&self, branch: &Branch) -> usize {
        let last = branch.retained.checked_sub(1);
        let last = last.and_then(|last| self.ahead.get(last));
        let none = || {
            // A takeoff that is under way is not begun again.
            let items = self.held.items.iter().skip(self.at);
            let stays = |item: &&Item| is_takeoff(item) || item.place().is_none();
            self.at + items.take_while(stays).count()
        };
        last.map_or_else(none, |(index, _)| after_actions(&self.held.items, *index))
    }
}
