//! The lists that a vehicle must hold, as they are sent and as they are compared.

use super::compare::{Difference, differences};
use crate::link::message::MissionType;
use crate::mission::{Item, VehicleMission, command, frame};
use crate::spec::Autopilot;

/// The lists for one vehicle, by the rules of its autopilot.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Expected<'a> {
    pub(crate) mission: &'a VehicleMission,
    pub(crate) autopilot: Autopilot,
}

impl<'a> Expected<'a> {
    /// The items of a list, without home.
    pub(crate) fn items(&self, list: MissionType) -> &'a [Item] {
        match list {
            MissionType::Mission => &self.mission.items,
            MissionType::Fence => &self.mission.fence,
            MissionType::Rally => &self.mission.rally,
        }
    }

    /// The items as they are sent: with home in front for ArduPilot, and exactly one
    /// mission item marked as current (MAVSDK refuses a mission otherwise).
    pub(crate) fn rows(&self, list: MissionType) -> Vec<(Item, u8)> {
        let mut rows: Vec<(Item, u8)> = Vec::new();
        if self.has_home(list) {
            rows.push((self.home_row(), 0));
        }
        rows.extend(self.items(list).iter().map(|item| (*item, 0)));
        if let (MissionType::Mission, Some((_, current))) = (list, rows.first_mut()) {
            *current = 1;
        }
        rows
    }

    /// Removes home from the items read, because the vehicle puts its own there, and
    /// compares the rest.
    pub(crate) fn compare(&self, list: MissionType, read: &mut Vec<Item>) -> Vec<Difference> {
        if self.has_home(list) && !read.is_empty() {
            read.remove(0);
        }
        differences(
            self.autopilot,
            self.mission.airframe,
            list,
            self.items(list),
            read,
        )
    }

    /// How many there are of [`Expected::rows`].
    pub(crate) fn row_count(&self, list: MissionType) -> usize {
        self.items(list).len() + usize::from(self.has_home(list))
    }

    fn has_home(&self, list: MissionType) -> bool {
        list == MissionType::Mission && self.autopilot.conventions().counts_home
    }

    /// Sequence number 0 of an ArduPilot mission.
    fn home_row(&self) -> Item {
        let home = self.mission.home;
        Item {
            command: command::NAV_WAYPOINT,
            frame: frame::GLOBAL,
            autocontinue: true,
            params: [0.0; 4],
            x: home.x,
            y: home.y,
            z: home.amsl_m,
        }
    }
}
