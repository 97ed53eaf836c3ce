//! Items go out, and lists are cleared.

use super::{Transfer, Vehicle};
use crate::link::{Address, Body, MISSION_TYPE_ALL, MissionResult, MissionType, Time};
use crate::mission::{Home, Item, command, frame};
use crate::simulator::profile::Profile;

impl Vehicle {
    pub(crate) fn request_list(&mut self, now: Time, from: Address, list: MissionType) {
        if matches!(self.transfer, Transfer::Receiving { .. }) {
            match self.profile {
                Profile::ArduPilot => self.acknowledge(from, list, MissionResult::DENIED),
                Profile::Px4 => self.warn("Mission download request ignored, already active"),
                Profile::Generic => {}
            }
            return;
        }
        let count = u16::try_from(self.rows(list).len()).unwrap_or(u16::MAX);
        if self.profile != Profile::ArduPilot && count > 0 {
            self.transfer = Transfer::Giving {
                partner: from,
                list,
                next: 0,
                heard: now,
            };
        }
        let opaque_id = self.opaque_id(list);
        self.say(from, list.mission_type(), Body::Count { count, opaque_id });
    }

    pub(crate) fn request(
        &mut self,
        now: Time,
        from: Address,
        list: MissionType,
        seq: u16,
        integer: bool,
    ) {
        if self.profile == Profile::Generic && !integer {
            return self.acknowledge(from, list, MissionResult::UNSUPPORTED);
        }
        if self.profile != Profile::ArduPilot {
            match &mut self.transfer {
                Transfer::Giving {
                    partner,
                    list: given,
                    next,
                    heard,
                } if *partner == from && *given == list => {
                    let is_in_step = seq == *next || seq + 1 == *next;
                    if self.profile == Profile::Px4 && !is_in_step {
                        self.transfer = Transfer::Idle;
                        return self.acknowledge(from, list, MissionResult::ERROR);
                    }
                    if seq > *next {
                        return;
                    }
                    (*next, *heard) = ((*next).max(seq + 1), now);
                }
                _ => return,
            }
        }
        let Some(item) = self.row(list, seq) else {
            return self.acknowledge(from, list, MissionResult::ERROR);
        };
        let current = u8::from(list == MissionType::Mission && seq == 0);
        let body = if integer {
            Body::ItemInt { seq, current, item }
        } else {
            Body::Item { seq, current, item }
        };
        self.say(from, list.mission_type(), body);
    }

    /// One stored row as it is given out: ArduPilot's first is always its own home.
    fn row(&self, list: MissionType, seq: u16) -> Option<Item> {
        let row = *self.rows(list).get(usize::from(seq))?;
        if (self.profile, list, seq) != (Profile::ArduPilot, MissionType::Mission, 0) {
            return Some(row);
        }
        let home = self.home.unwrap_or(Home {
            x: 0,
            y: 0,
            amsl_m: 0.0,
        });
        Some(Item {
            command: command::NAV_WAYPOINT,
            frame: frame::GLOBAL,
            autocontinue: true,
            params: [0.0; 4],
            x: home.x,
            y: home.y,
            z: home.amsl_m,
        })
    }

    pub(crate) fn acknowledged(
        &mut self,
        from: Address,
        about: MissionType,
        result: MissionResult,
    ) {
        match self.transfer {
            Transfer::Giving { partner, list, .. } if partner == from && list == about => {
                self.transfer = Transfer::Idle;
            }
            Transfer::Receiving { partner, .. }
                if self.profile == Profile::Px4
                    && partner == from
                    && result == MissionResult::OPERATION_CANCELLED =>
            {
                self.transfer = Transfer::Idle;
            }
            _ => {}
        }
    }

    pub(crate) fn clear(&mut self, from: Address, list: MissionType) {
        match (self.profile, &self.transfer) {
            (Profile::ArduPilot, Transfer::Receiving { .. }) => {
                return self.acknowledge(from, list, MissionResult::ERROR);
            }
            (Profile::Px4, Transfer::Receiving { .. } | Transfer::Giving { .. }) => {
                return self.warn("Mission clear ignored, busy");
            }
            (Profile::Generic, Transfer::Receiving { .. }) => return,
            _ => {}
        }
        if self.profile == Profile::ArduPilot
            && list == MissionType::Mission
            && self.is_flying_mission()
        {
            return self.acknowledge(from, list, MissionResult::ERROR);
        }
        self.lists.insert(list, Vec::new());
        if list == MissionType::Mission {
            self.mission_replaced();
        }
        self.acknowledge(from, list, MissionResult::ACCEPTED);
    }

    pub(crate) fn clear_all(&mut self, from: Address) {
        let result = match (self.profile, &self.transfer) {
            (Profile::ArduPilot, _) => MissionResult::UNSUPPORTED,
            (Profile::Px4 | Profile::Generic, Transfer::Idle) => {
                self.lists.values_mut().for_each(Vec::clear);
                self.mission_replaced();
                MissionResult::ACCEPTED
            }
            _ => return,
        };
        let opaque_id = 0;
        self.say(from, MISSION_TYPE_ALL, Body::Ack { result, opaque_id });
    }
}
