//! Where the camera of a vehicle points, as far as its items say: straight down until one turns it.

use super::MissionCheck;
use crate::autopilot::Autopilot;
use crate::mission::{Item, command, command_name};
use crate::verify::measure::segment::Segment;

/// Angles may differ from those of a camera that looks straight down by this, degrees.
const ANGLE_DEG: f64 = 5.0;
/// Mode of `DO_MOUNT_CONTROL` in which its angles count.
const MAV_MOUNT_MODE_MAVLINK_TARGETING: f32 = 2.0;

/// Commands that turn the camera.
const AIMS: [u16; 7] = [
    command::DO_GIMBAL_MANAGER_PITCHYAW,
    command::DO_MOUNT_CONTROL,
    command::DO_MOUNT_CONFIGURE,
    command::DO_SET_ROI_NONE,
    command::DO_SET_ROI_LOCATION,
    command::DO_SET_ROI_WPNEXT_OFFSET,
    command::DO_SET_ROI,
];

/// Which items, as indices, turned the camera away.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Aim {
    /// The last one that pointed the gimbal elsewhere.
    turned: Option<usize>,
    /// The one that set the active region of interest.
    roi: Option<usize>,
    /// The one that turns the nose on the leg to the next waypoint.
    nose: Option<usize>,
    /// Whether an item set the gimbal: the end of a region of interest does not set it again.
    is_steered: bool,
    /// Whether an item took control of the gimbal, without which PX4 does not turn it.
    is_controlled: bool,
    /// Row that is flown to.
    row: usize,
}

impl MissionCheck<'_> {
    /// The aim on the leg of a motion, from that on the motion before it.
    pub(super) fn aim_on(&self, mut aim: Aim, row: usize) -> Aim {
        let items = &self.mission.items;
        let is_jump =
            |item: &Item| [command::DO_JUMP, command::DO_JUMP_TAG].contains(&item.command);
        let last = aim.row.saturating_sub(1);
        if row > aim.row {
            self.follow(&mut aim, last..row - 1);
        } else if row < aim.row {
            // Back by a jump: what comes before it, and the commands on the leg.
            let rest = items.get(aim.row..).unwrap_or_default();
            let jump = rest.iter().position(is_jump).unwrap_or(0) + aim.row;
            self.follow(&mut aim, last..jump);
            let before = items.get(..row - 1).unwrap_or_default();
            let waypoint = before
                .iter()
                .rposition(|item| item.command <= command::NAV_LAST);
            self.follow(&mut aim, waypoint.map_or(0, |index| index + 1)..row - 1);
        }
        aim.row = row;
        aim
    }

    fn follow(&self, aim: &mut Aim, indices: std::ops::Range<usize>) {
        for index in indices {
            if let Some(item) = self.mission.items.get(index) {
                self.turn(aim, index, item);
            }
        }
    }

    fn turn(&self, aim: &mut Aim, index: usize, item: &Item) {
        let px4 = self.mission.autopilot == Autopilot::Px4;
        let [first, second, third, _] = item.params.map(f64::from);
        let steer = |aim: &mut Aim, is_down: bool| {
            aim.turned = (!is_down).then_some(index);
            aim.is_steered = true;
        };
        if AIMS.contains(&item.command) && self.held_up_by(index).is_some() {
            // Until it is turned anew nobody knows.
            return steer(aim, false);
        }
        match item.command {
            // ArduCopter turns its nose again to where it flies with each waypoint.
            command if command <= command::NAV_LAST => aim.nose = None,
            command::CONDITION_YAW if !self.mission.airframe.has_wing() => aim.nose = Some(index),
            command::DO_GIMBAL_MANAGER_CONFIGURE => aim.is_controlled = true,
            command::DO_GIMBAL_MANAGER_PITCHYAW => {
                let is_down = is_down(first) && is_along(second) && item.x == 0;
                steer(aim, is_down && (aim.is_controlled || !px4));
            }
            command::DO_MOUNT_CONTROL => {
                let is_targeting = !px4 || item.z == MAV_MOUNT_MODE_MAVLINK_TARGETING;
                let is_level = second.abs() <= ANGLE_DEG;
                let is_down = is_down(first) && is_level && is_along(third);
                steer(aim, is_down && is_targeting);
            }
            command::DO_MOUNT_CONFIGURE => steer(aim, false),
            command::DO_SET_ROI_NONE => aim.roi = None,
            command::DO_SET_ROI_LOCATION
            | command::DO_SET_ROI_WPNEXT_OFFSET
            | command::DO_SET_ROI => {
                let is_ended = match px4 {
                    true => item.command == command::DO_SET_ROI && first == 0.0,
                    // ArduPilot ends it with a location of zeros.
                    false => (item.x, item.y) == (0, 0) && item.z == 0.0,
                };
                aim.roi = (!is_ended).then_some(index);
                if aim.is_steered && !is_ended {
                    aim.turned = Some(index);
                }
            }
            _ => {}
        }
    }

    /// Index of the item that is why the camera does not look straight down, with its long
    /// side across, on a motion.
    pub(super) fn turned_by(&self, aim: &Aim, segment: &Segment) -> Option<usize> {
        let nose = aim.nose.filter(|&index| {
            let [heading_deg, _, _, relative] = self.mission.items[index].params.map(f64::from);
            let [east_m, north_m] = [
                segment.to.at.east_m - segment.from.at.east_m,
                segment.to.at.north_m - segment.from.at.north_m,
            ];
            let course_deg = east_m.atan2(north_m).to_degrees();
            relative != 0.0 || !is_along(heading_deg - course_deg)
        });
        aim.roi.or(aim.turned).or(nose)
    }

    /// Why pictures do not count.
    pub(super) fn turned_away(&self, index: usize) -> String {
        let command = self.mission.items[index].command;
        let name = command_name(command).map_or_else(|| command.to_string(), str::to_owned);
        format!(
            "item {} of {} ({name}) turns the camera away from straight down, and pictures do not count",
            index + 1,
            self.id()
        )
    }
}

/// Whether a pitch is straight down.
fn is_down(pitch_deg: f64) -> bool {
    (pitch_deg + 90.0).abs() <= ANGLE_DEG
}

/// Whether a camera that looks down has its long side across the leg with this yaw.
fn is_along(yaw_deg: f64) -> bool {
    let off_deg = yaw_deg.rem_euclid(180.0);
    off_deg.min(180.0 - off_deg) <= ANGLE_DEG
}
