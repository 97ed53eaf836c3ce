//! The new mission of a vehicle in flight, and the plan that its flight is judged by.

use super::state::{Branch, VehicleState, is_takeoff, item_at};
use crate::flight::conformance::reference::{ReferenceTrajectory, Waypoint};
use crate::flight::record::Plan;
use crate::geodesy::{Amsl, PlanPoint};
use crate::mission::{Item, VehicleMission, command};
use crate::spec::Autopilot;
use crate::world::World;

/// The new mission of a vehicle.
#[derive(Debug)]
pub struct NewMission {
    /// Its index in the spec.
    pub vehicle: usize,
    /// The mission as it is sent.
    pub mission: VehicleMission,
    /// Index of the first item ahead, and of the first that is new.
    pub(super) ahead: usize,
    pub(super) new: usize,
    /// Items of the mission before, and the index of the first of them that is in this one.
    pub(super) held: (usize, usize),
    /// Where the leg to the first item ahead begins.
    pub(super) origin: PlanPoint,
    /// The plan that its flight is judged by from then on.
    pub(super) plan: Plan,
}

impl NewMission {
    /// The new mission as it is sent; none if the retained items are not one after the other. To
    /// ArduPilot it begins with the items flown so far, so that the current item keeps its number;
    /// to PX4 it begins with the current item.
    pub(super) fn new(
        state: &VehicleState,
        branch: &Branch,
        head: &VehicleMission,
        new: &mut Vec<Item>,
        world: &World,
    ) -> Option<Self> {
        let (held, retained_end) = (&state.held, state.retained_end(branch));
        let begin = match held.autopilot {
            Autopilot::ArduPilot => 0,
            Autopilot::Px4 => state.at,
        };
        let first = state.first_ahead(branch);
        let is_contiguous = state.is_contiguous(branch);
        let before = held.items.get(begin..retained_end)?;
        if before.len() + new.len() == held.items.len() {
            // A record identifies the plan that a vehicle flies by its number of items.
            split(new, state, branch, world);
        }
        let mission = VehicleMission {
            home: held.home,
            items: before.iter().chain(new.iter()).copied().collect(),
            ..head.clone()
        };
        let frame = world.frame;
        let items = mission.items.len();
        (is_contiguous && first >= begin).then(|| Self {
            vehicle: state.vehicle,
            mission,
            ahead: first - begin,
            new: retained_end - begin,
            held: (held.items.len(), begin),
            origin: state.origin,
            plan: Plan {
                items,
                reference: ReferenceTrajectory::of_waypoints(Vec::new(), (0.0, state.lands), frame),
                from_s: 0.0,
            },
        })
    }

    /// Takes the times of its plan from the flight that was verified. The first `head` items of
    /// that go nowhere; `now_s` is now, seconds after T0.
    pub(super) fn time(&mut self, judged: &ReferenceTrajectory, head: usize, now_s: f64) {
        let ahead = judged.waypoints.iter().filter(|w| w.item > head);
        let ahead = ahead.map(|waypoint| Waypoint {
            item: waypoint.item - head + self.ahead,
            ..*waypoint
        });
        let origin = Waypoint {
            item: self.ahead,
            point: self.origin,
            t_s: now_s,
            radius_m: 0.0,
            late_s: 0.0,
        };
        self.plan.from_s = now_s;
        self.plan.reference = ReferenceTrajectory::of_waypoints(
            std::iter::once(origin).chain(ahead).collect(),
            (judged.end_s, judged.lands),
            *judged.frame(),
        );
    }
}

/// Number of items before the first to which a vehicle in the air flies.
pub(super) fn head_len(items: &[Item]) -> usize {
    let is_head = |item: &&Item| is_takeoff(item) || item.place().is_none();
    items.iter().take_while(is_head).count()
}

/// Inserts a waypoint in the middle of the first new leg.
fn split(new: &mut Vec<Item>, state: &VehicleState, branch: &Branch, world: &World) {
    let before = state.points().get(branch.retained).copied();
    let (Some(before), Some(&first)) = (before, new.first()) else {
        return;
    };
    let Some(place) = first.place() else { return };
    let (a, b) = (before.at, world.frame.to_plan(place));
    let middle = PlanPoint::new(
        0.5 * (a.east_m + b.east_m),
        0.5 * (a.north_m + b.north_m),
        Amsl(0.5 * (before.amsl.0 + f64::from(first.z))),
    );
    let params = [0.0, first.params[1], first.params[2], first.params[3]];
    let item = item_at(&world.frame, command::NAV_WAYPOINT, params, middle);
    new.insert(0, item);
}
