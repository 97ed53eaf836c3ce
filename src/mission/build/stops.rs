//! The items of a stop: to rest there, what is done there, and on from there.

use super::{ItemWriter, float};
use crate::autopilot::{Autopilot, command};
use crate::geodesy::PlanPoint;
use crate::mission::item::Item;
use crate::spec::{EndPoint, Stop, StopAction};
use crate::world::NoData;

/// Rest before anything is done at a stop, seconds.
pub(super) const FIRST_REST_S: f64 = 1.0;

/// A picture at once and then one at each multiple of a distance; 0 m: a last one and no more.
///
/// Both autopilots take `param1` as the distance, switch pictures by distance off at 0, and take one
/// at once where `param3` is 1 (`AP_Mission` `DO_SET_CAM_TRIGG_DIST`, PX4 `camera_trigger`).
pub(super) fn trigger(distance_m: f64) -> Item {
    let params = [float(distance_m), 0.0, 1.0, 0.0];
    Item::without_place(command::DO_SET_CAM_TRIGG_DIST, params)
}

impl ItemWriter<'_> {
    /// The items of a stop at its point.
    ///
    /// ArduPilot runs commands without a location while it holds at the waypoint after them, and PX4
    /// when the hold before them ends: a stop with commands ends in a second waypoint at the same
    /// place.
    /// A drop is reached straight down from a rest above it, and left straight up to another one.
    pub(super) fn stop(&self, stop: &Stop, end: PlanPoint) -> Result<Vec<Item>, NoData> {
        let drops = stop.drop_m > 0.0;
        let above = || self.rest(stop, FIRST_REST_S, end);
        let mut items: Vec<Item> = drops.then(above).transpose()?.into_iter().collect();
        items.extend(self.done_at(stop, stop.below(end))?);
        items.extend(drops.then(above).transpose()?);
        items.extend(stop.speed_mps.map(|speed_mps| self.change_speed(speed_mps)));
        items.extend(stop.trigger_m.map(trigger));
        Ok(items)
    }

    /// The rest at a point, and what is done there.
    fn done_at(&self, stop: &Stop, point: PlanPoint) -> Result<Vec<Item>, NoData> {
        let mut turns = self.turn_to(stop);
        turns.extend(self.actions(stop)?);
        if turns.is_empty() {
            return Ok(vec![self.rest(stop, stop.rest_s(), point)?]);
        }
        let first_s = FIRST_REST_S + stop.wait_s;
        let mut items = vec![self.rest(stop, first_s, point)?];
        items.extend(turns);
        items.push(self.rest(stop, stop.rest_s() - first_s, point)?);
        Ok(items)
    }

    /// A waypoint at a stop. PX4 keeps its acceptance radius and its heading.
    fn rest(&self, stop: &Stop, hold_s: f64, point: PlanPoint) -> Result<Item, NoData> {
        let mut item = self.at(command::NAV_WAYPOINT, float(hold_s), point)?;
        if self.vehicle.autopilot == Autopilot::Px4 {
            item.params[1] = stop.acceptance_radius_m.map_or(0.0, float);
            if let Some(heading_rad) = stop.heading_rad {
                item.params[3] = float(heading_rad.to_degrees());
            }
        }
        Ok(item)
    }

    /// Turns the nose of an ArduCopter, whose waypoints keep no heading: absolute, the shorter
    /// way round.
    fn turn_to(&self, stop: &Stop) -> Vec<Item> {
        let heading_rad = stop.heading_rad;
        let is_turned = |_: &f64| self.vehicle.autopilot == Autopilot::ArduPilot;
        let turn = heading_rad.filter(is_turned).map(|heading_rad| {
            let heading_deg = float(heading_rad.to_degrees());
            Item::without_place(command::CONDITION_YAW, [heading_deg, 0.0, 0.0, 0.0])
        });
        turn.into_iter().collect()
    }

    /// The items of the actions, in their order.
    pub(super) fn actions(&self, stop: &Stop) -> Result<Vec<Item>, NoData> {
        let is_gimbal = |action: &StopAction| matches!(action, StopAction::Gimbal { .. });
        let mut items = Vec::new();
        if self.vehicle.autopilot == Autopilot::Px4 && stop.actions.iter().any(is_gimbal) {
            // PX4 turns a gimbal for whom controls it: -2 is the autopilot itself.
            let itself = [-2.0, -2.0, -1.0, -1.0];
            let configure = command::DO_GIMBAL_MANAGER_CONFIGURE;
            items.push(Item::without_place(configure, itself));
        }
        for action in &stop.actions {
            items.push(self.action(action, stop.place())?);
        }
        Ok(items)
    }

    fn action(&self, action: &StopAction, here: EndPoint) -> Result<Item, NoData> {
        let params = match *action {
            // One picture, at once.
            StopAction::Photo => [0.0, 0.0, 1.0, 0.0],
            StopAction::Roi(end) => return self.encoder.place(action.command(), end),
            StopAction::Gimbal { pitch_deg, yaw_deg } => {
                [f32::from(pitch_deg), f32::from(yaw_deg), 0.0, 0.0]
            }
            StopAction::Servo { channel, pwm_us } => {
                [f32::from(channel), f32::from(pwm_us), 0.0, 0.0]
            }
            StopAction::Relay { number, closed } => {
                [f32::from(number), f32::from(u8::from(closed)), 0.0, 0.0]
            }
            StopAction::Gripper { grabs } => [1.0, f32::from(u8::from(grabs)), 0.0, 0.0],
            // WINCH_RELATIVE_LENGTH_CONTROL.
            StopAction::Winch { length_m, rate_mps } => {
                [1.0, 1.0, float(length_m), float(rate_mps)]
            }
            StopAction::PayloadPlace { max_descent_m } => {
                let mut item = self.encoder.place(action.command(), here)?;
                item.params[0] = max_descent_m.map_or(0.0, float);
                return Ok(item);
            }
            StopAction::Video { .. } | StopAction::RoiNone => [0.0; 4],
        };
        Ok(Item::without_place(action.command(), params))
    }
}
