//! The new mission of a vehicle in flight, and the plan that its flight is judged by.

use super::state::{Branch, VehicleState, is_takeoff};
use crate::flight::conformance::reference::{Reference, Waypoint};
use crate::flight::record::Plan;
use crate::geodesy::{EastNorth, PlanPoint};
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
    /// Where the leg to the first item ahead begins.
    pub(super) origin: PlanPoint,
    /// The plan that its flight is judged by from then on.
    pub(super) plan: Plan,
}

impl NewMission {
    /// The new mission as the vehicle is sent it. ArduPilot keeps the items that it has
    /// flown, and with them its place in the list; PX4 gets what lies ahead.
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
        let first = retained_end - branch.retained;
        let is_contiguous = state
            .ahead
            .first()
            .is_none_or(|(index, _)| branch.retained == 0 || *index == first);
        let before = held.items.get(begin..retained_end)?;
        if before.len() + new.len() == held.items.len() {
            // Another number of items tells the vehicle's plans apart.
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
            origin: state.origin,
            plan: Plan {
                items,
                reference: Reference::of_waypoints(Vec::new(), (0.0, state.lands), frame),
            },
        })
    }

    /// Takes the times of its plan from the flight that was verified, whose first items up to
    /// `head` stand for where the vehicle is; `shift_s` leads from its clock to T0.
    pub(super) fn time(
        &mut self,
        judged: &Reference,
        head: usize,
        (now_s, shift_s): (f64, f64),
        world: &World,
    ) {
        let ahead = judged.waypoints.iter().filter(|w| w.item > head);
        let ahead = ahead.map(|waypoint| Waypoint {
            item: waypoint.item - head + self.ahead,
            t_s: waypoint.t_s + shift_s,
            ..*waypoint
        });
        let origin = Waypoint {
            item: self.ahead,
            point: self.origin,
            t_s: now_s,
            radius_m: 0.0,
        };
        self.plan.reference = Reference::of_waypoints(
            std::iter::once(origin).chain(ahead).collect(),
            (judged.end_s + shift_s, judged.lands),
            world.frame,
        );
    }
}

/// Items before the first that is flown to after a takeoff.
pub(super) fn head_len(items: &[Item]) -> usize {
    let is_head = |item: &&Item| is_takeoff(item) || item.place().is_none();
    items.iter().take_while(is_head).count()
}

/// Puts a waypoint into the middle of the first new leg, on it.
fn split(new: &mut Vec<Item>, state: &VehicleState, branch: &Branch, world: &World) {
    let before = state.points().get(branch.retained).copied();
    let (Some(before), Some(&first)) = (before, new.first()) else {
        return;
    };
    let Some(place) = first.place() else { return };
    let (a, b) = (before.at, world.frame.to_plan(place));
    let middle = world.frame.from_plan(EastNorth {
        east_m: 0.5 * (a.east_m + b.east_m),
        north_m: 0.5 * (a.north_m + b.north_m),
    });
    #[expect(
        clippy::cast_possible_truncation,
        reason = "degrees in 1e-7 and metres as missions have them"
    )]
    let item = Item {
        command: command::NAV_WAYPOINT,
        params: [0.0, first.params[1], first.params[2], first.params[3]],
        x: (middle.lat_deg * 1e7).round() as i32,
        y: (middle.lon_deg * 1e7).round() as i32,
        z: (0.5 * (before.amsl.0 + f64::from(first.z))) as f32,
        ..first
    };
    new.insert(0, item);
}
