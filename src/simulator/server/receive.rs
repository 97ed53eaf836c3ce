//! Items come in: `MISSION_COUNT`, requests, items, `MISSION_ACK`.

use super::{Transfer, Vehicle};
use crate::link::{Address, Body, MissionResult, MissionType, Time, stored_form};
use crate::mission::Item;
use crate::simulator::profile::Profile;
use crate::simulator::rules;

impl Vehicle {
    /// Asks for the item that is next.
    pub(crate) fn ask(&mut self, now: Time) {
        let Transfer::Receiving {
            partner,
            list,
            next: seq,
            ref mut asked,
            ..
        } = self.transfer
        else {
            return;
        };
        *asked = now;
        // ArduPilot asks with the old message, and means MISSION_ITEM_INT nevertheless.
        let body = match self.profile {
            Profile::ArduPilot => Body::Request { seq },
            Profile::Px4 | Profile::Generic => Body::RequestInt { seq },
        };
        self.say(partner, list.mission_type(), body);
    }

    pub(crate) fn give_up(&mut self, partner: Address, list: MissionType) {
        self.transfer = Transfer::Idle;
        match self.profile {
            Profile::ArduPilot => {
                self.warn("Mission upload timeout");
                self.acknowledge(partner, list, MissionResult::OPERATION_CANCELLED);
            }
            Profile::Px4 => self.warn("Operation timeout"),
            Profile::Generic => {}
        }
    }

    pub(crate) fn count(&mut self, now: Time, from: Address, list: MissionType, count: u16) {
        let busy_with = match self.transfer {
            Transfer::Idle => None,
            Transfer::Receiving { partner, next, .. } => Some((partner, next)),
            Transfer::Giving { partner, .. } => match self.profile {
                Profile::Px4 => Some((partner, 1)),
                Profile::ArduPilot | Profile::Generic => None,
            },
        };
        match (self.profile, busy_with) {
            (Profile::ArduPilot, Some((partner, _))) if partner != from => {
                return self.acknowledge(from, list, MissionResult::DENIED);
            }
            (Profile::Px4, Some((partner, 0))) if partner == from => return self.ask(now),
            (Profile::Px4, Some(_)) => {
                return self.acknowledge(from, list, MissionResult::ERROR);
            }
            (Profile::Generic, Some(_)) => return,
            (Profile::ArduPilot, Some(_)) | (_, None) => {}
        }
        let is_starting = self.profile == Profile::ArduPilot && self.is_booting(now);
        let stated = self.fence_points.filter(|_| list == MissionType::Fence);
        let capacity = stated.unwrap_or_else(|| self.profile.capacity(list, self.airframe));
        if usize::from(count) > capacity || is_starting {
            return self.acknowledge(from, list, MissionResult::NO_SPACE);
        }
        if let (Profile::ArduPilot, MissionType::Mission, Some(rows)) =
            (self.profile, list, self.lists.get_mut(&list))
        {
            rows.truncate(usize::from(count));
        }
        self.last = None;
        self.transfer = Transfer::Receiving {
            partner: from,
            list,
            count,
            staged: Vec::new(),
            next: 0,
            asked: now,
            heard: now,
        };
        if count == 0 {
            self.complete();
        } else {
            self.ask(now);
        }
    }

    pub(crate) fn item(
        &mut self,
        now: Time,
        from: Address,
        list: MissionType,
        seq: u16,
        item: Item,
    ) {
        let Transfer::Receiving {
            partner,
            list: expected_list,
            count,
            next,
            ..
        } = self.transfer
        else {
            return self.uninvited(from, list, seq);
        };
        if partner != from || list != expected_list {
            return;
        }
        if seq != next {
            match self.profile {
                Profile::ArduPilot => {
                    self.acknowledge(from, list, MissionResult::INVALID_SEQUENCE);
                }
                Profile::Px4 if seq < next => self.ask(now),
                Profile::Px4 => {}
                Profile::Generic => self.put_off(now),
            }
            return;
        }
        let checked = match self.profile {
            Profile::ArduPilot => rules::ardupilot(list, &item, seq, count),
            Profile::Px4 => rules::px4(list, &item),
            Profile::Generic => Ok(()),
        };
        if let Err(result) = checked {
            self.transfer = Transfer::Idle;
            return self.acknowledge(from, list, result);
        }
        self.store(now, list, seq, item);
        if seq + 1 == count {
            self.complete();
        } else {
            self.ask(now);
        }
    }

    /// MAVSDK waits anew after any item, also one that it has.
    fn put_off(&mut self, now: Time) {
        if let Transfer::Receiving { asked, heard, .. } = &mut self.transfer {
            (*asked, *heard) = (now, now);
        }
    }

    /// Takes the item that was asked for.
    fn store(&mut self, now: Time, list: MissionType, seq: u16, item: Item) {
        let item = match self.profile.known() {
            Some(autopilot) => stored_form(autopilot, self.airframe, list, &item),
            None => item,
        };
        let Transfer::Receiving {
            staged,
            next,
            heard,
            ..
        } = &mut self.transfer
        else {
            return;
        };
        (*next, *heard) = (seq + 1, now);
        match (self.profile, list, self.lists.get_mut(&list)) {
            (Profile::ArduPilot, MissionType::Mission, Some(rows)) => {
                match rows.get_mut(usize::from(seq)) {
                    Some(row) => *row = item,
                    None => rows.push(item),
                }
            }
            _ => staged.push(item),
        }
    }

    /// The last item is here.
    fn complete(&mut self) {
        let Transfer::Receiving {
            partner,
            list,
            count,
            staged,
            ..
        } = std::mem::replace(&mut self.transfer, Transfer::Idle)
        else {
            return;
        };
        if !(self.profile == Profile::ArduPilot && list == MissionType::Mission) {
            if self.profile == Profile::ArduPilot
                && list == MissionType::Fence
                && !rules::fence_is_consistent(&staged)
            {
                return self.acknowledge(partner, list, MissionResult::ERROR);
            }
            self.lists.insert(list, staged);
        }
        if list == MissionType::Mission {
            self.mission_replaced();
            if self.is_flying_mission() {
                self.tell_current();
            }
        }
        self.last = count.checked_sub(1).map(|seq| (partner, list, seq));
        self.acknowledge(partner, list, MissionResult::ACCEPTED);
    }

    /// An item while none is expected: ArduPilot complains, PX4 confirms its last one again.
    fn uninvited(&mut self, from: Address, list: MissionType, seq: u16) {
        match self.profile {
            Profile::ArduPilot => self.acknowledge(from, list, MissionResult::ERROR),
            Profile::Px4 if self.last == Some((from, list, seq)) => {
                self.acknowledge(from, list, MissionResult::ACCEPTED);
            }
            Profile::Px4 | Profile::Generic => {}
        }
    }
}
