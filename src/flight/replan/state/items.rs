//! The items that a vehicle has on board, and those that it flies from where it is.

use super::VehicleState;
use crate::geodesy::{LocalFrame, PlanPoint};
use crate::mission::{Home, Item, command, frame};

impl VehicleState {
    /// Items that it flies from where it is, with altitudes AMSL instead of above home, each with its
    /// row: the speed that it was commanded, the rest of a takeoff under way, the items ahead. One
    /// that does not fly its mission stays where it is, or where it returns to.
    pub(in crate::flight::replan) fn items_ahead(&self, frame: &LocalFrame) -> Vec<(usize, Item)> {
        if !self.in_mission() {
            let params = [0.0, 0.0, self.stay_radius_m, 0.0];
            let at = self.doing.stays_at(self.here);
            let stay = item_at(frame, command::NAV_LOITER_UNLIM, params, at);
            return vec![(self.at + 1, stay)];
        }
        let is_speed = |item: &&Item| item.command == command::DO_CHANGE_SPEED;
        let flown = self.held.items.iter().take(self.at);
        let speed = flown.rev().find(is_speed);
        let speed = speed.map(|item| (self.at + 1, *item));
        let ahead = self.held.items.iter().enumerate().skip(self.at);
        let ahead = ahead.filter(|(_, item)| item.command != command::NAV_DELAY);
        let ahead = ahead.map(|(index, item)| {
            let item = match self.ahead.first() {
                Some((_, top)) if is_takeoff(item) => {
                    item_at(frame, command::NAV_WAYPOINT, [0.0; 4], *top)
                }
                _ => with_amsl(item, &self.held.home),
            };
            (index + 1, item)
        });
        speed.into_iter().chain(ahead).collect()
    }
}

/// Index of the first item after a waypoint that is more than something done there.
pub(super) fn after_actions(items: &[Item], waypoint: usize) -> usize {
    let rest = items.iter().skip(waypoint + 1);
    let is_action = |item: &&Item| {
        item.command > command::NAV_LAST || item.command == command::NAV_PAYLOAD_PLACE
    };
    waypoint + 1 + rest.take_while(is_action).count()
}

/// Whether an item is a takeoff.
pub(in crate::flight::replan) fn is_takeoff(item: &Item) -> bool {
    [command::NAV_TAKEOFF, command::NAV_VTOL_TAKEOFF].contains(&item.command)
}

/// An item at a point, with an altitude AMSL.
pub(in crate::flight::replan) fn item_at(
    frame: &LocalFrame,
    command: u16,
    params: [f32; 4],
    point: PlanPoint,
) -> Item {
    let place = frame.from_plan(point.at);
    #[expect(
        clippy::cast_possible_truncation,
        reason = "degrees in 1e-7 and metres as missions have them"
    )]
    Item {
        command,
        frame: crate::mission::frame::GLOBAL,
        params,
        x: (place.lat_deg * 1e7).round() as i32,
        y: (place.lon_deg * 1e7).round() as i32,
        z: point.amsl.0 as f32,
        autocontinue: true,
    }
}

/// An item with its altitude AMSL, if it has one above home.
pub(super) fn with_amsl(item: &Item, home: &Home) -> Item {
    let mut item = *item;
    if item.place().is_some() && frame::canonical(item.frame) == frame::GLOBAL_RELATIVE_ALT {
        item.frame = frame::GLOBAL;
        item.z += home.amsl_m;
    }
    item
}
