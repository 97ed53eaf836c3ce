//! Commands: arming, modes, the mission's start, messages and parameters on request.

use super::{POSITION_MS, Transfer, Vehicle};
use crate::link::{Address, Command, CommandResult, FlightMessage, Message, MissionType, Time};
use crate::simulator::mode::Mode;
use crate::simulator::profile::Profile;

/// `MAV_MODE_FLAG_CUSTOM_MODE_ENABLED`.
const CUSTOM_MODE_ENABLED: u8 = 1;
/// Message ids that are sent on request.
const HOME_POSITION: f32 = 242.0;
const GLOBAL_POSITION_INT: f32 = 33.0;
/// Numbers of the messages that report health.
const HEALTH: [f32; 6] = [1.0, 24.0, 147.0, 162.0, 193.0, 230.0];
const MISSION_CURRENT: f32 = 42.0;
const AUTOPILOT_VERSION: f32 = 148.0;

impl Vehicle {
    /// A command, or a request about parameters or the mission's current item.
    pub(crate) fn flight(&mut self, now: Time, from: Address, message: &FlightMessage) {
        let is_ours = |target: &Address| [self.us.system, 0].contains(&target.system);
        match message {
            FlightMessage::Command { target, order } if is_ours(target) => {
                let result = self.obey(now, order);
                self.tell(FlightMessage::CommandAck {
                    target: from,
                    command: order.command,
                    result,
                });
                self.report();
            }
            FlightMessage::SetMode {
                system,
                base_mode,
                custom_mode,
            } if *system == self.us.system && base_mode & CUSTOM_MODE_ENABLED != 0 => {
                self.set_mode(*custom_mode);
                self.report();
            }
            FlightMessage::TimeSync {
                target,
                answer_ns: 0,
                asked_ns,
            } if is_ours(target) => self.tell(FlightMessage::TimeSync {
                target: from,
                answer_ns: i64::from(self.boot_ms(now)) * 1_000_000,
                asked_ns: *asked_ns,
            }),
            FlightMessage::SetCurrent { target, seq } if is_ours(target) => {
                let is_idle = matches!(self.transfer, Transfer::Idle);
                if self.profile == Profile::Px4 && !is_idle {
                    self.warn("WPM: IGN WP CURR CMD: Busy");
                    return;
                }
                self.set_current(*seq);
                self.tell_current();
            }
            FlightMessage::ParamRead { target, name } if is_ours(target) => self.tell_param(name),
            FlightMessage::ParamSet {
                target,
                name,
                value,
            } if is_ours(target) => {
                if let Some(pilot) = &mut self.pilot {
                    pilot.settings.take_wire(name, *value);
                }
                self.tell_param(name);
            }
            _ => {}
        }
    }

    fn obey(&mut self, now: Time, order: &Command) -> CommandResult {
        let accepted = |done: bool| {
            if done {
                CommandResult::ACCEPTED
            } else {
                CommandResult::DENIED
            }
        };
        match order.command {
            Command::REQUEST_MESSAGE => return self.give_message(now, order.params[0]),
            Command::GET_HOME_POSITION => return self.give_message(now, HOME_POSITION),
            Command::SET_MESSAGE_INTERVAL => return self.set_interval(order.params),
            _ if self.pilot.is_none() => return CommandResult::UNSUPPORTED,
            _ => {}
        }
        match order.command {
            Command::COMPONENT_ARM_DISARM => self.arm_or_disarm(now, order.params[0] > 0.5),
            Command::DO_SET_MODE => match self.mode_of(order.params) {
                Some(custom_mode) => accepted(self.set_mode(custom_mode)),
                None => CommandResult::DENIED,
            },
            Command::MISSION_START if !self.is_armed() => CommandResult::FAILED,
            Command::MISSION_START => {
                let items = self.items(MissionType::Mission).to_vec();
                let begun = self.pilot.as_mut().map(|pilot| pilot.start_mission(&items));
                accepted(begun.unwrap_or(false))
            }
            // PX4 has the message alone.
            Command::DO_SET_MISSION_CURRENT if self.profile != Profile::Px4 => {
                let seq = whole(order.params[0]);
                let is_done = seq.is_some_and(|seq| self.set_current(seq));
                self.tell_current();
                accepted(is_done)
            }
            Command::NAV_LOITER_UNLIM => accepted(self.set_named(Mode::Hold)),
            Command::NAV_LAND => accepted(self.set_named(Mode::Land)),
            Command::NAV_RETURN_TO_LAUNCH => accepted(self.set_named(Mode::Return)),
            _ => CommandResult::UNSUPPORTED,
        }
    }

    fn arm_or_disarm(&mut self, now: Time, arm: bool) -> CommandResult {
        if self.is_booting(now) {
            return CommandResult::TEMPORARILY_REJECTED;
        }
        let Some(pilot) = &mut self.pilot else {
            return CommandResult::UNSUPPORTED;
        };
        let done = if arm { pilot.arm(now) } else { pilot.disarm() };
        if let Err(why) = done {
            self.warn(why);
            return match self.profile {
                Profile::Px4 => CommandResult::TEMPORARILY_REJECTED,
                Profile::ArduPilot | Profile::Generic => CommandResult::FAILED,
            };
        }
        // PX4 goes at once if it is armed in a mode that flies.
        if arm && self.profile == Profile::Px4 {
            let mode = self.pilot.as_ref().map_or(0, |pilot| pilot.custom_mode);
            self.set_mode(mode);
        }
        CommandResult::ACCEPTED
    }

    /// The mode of a `MAV_CMD_DO_SET_MODE`: PX4 has main and sub mode in two parameters.
    fn mode_of(&self, params: [f32; 7]) -> Option<u32> {
        let base_mode = whole(params[0])?;
        if base_mode & u16::from(CUSTOM_MODE_ENABLED) == 0 {
            return None;
        }
        let (main, sub) = (u32::from(whole(params[1])?), u32::from(whole(params[2])?));
        match self.profile {
            Profile::Px4 => Some(main << 16 | sub << 24),
            Profile::ArduPilot | Profile::Generic => Some(main),
        }
    }

    fn set_mode(&mut self, custom_mode: u32) -> bool {
        let [items, rally] =
            [MissionType::Mission, MissionType::Rally].map(|list| self.items(list).to_vec());
        let pilot = self.pilot.as_mut();
        pilot.is_some_and(|pilot| {
            pilot.set_rally(&rally);
            pilot.set_mode(custom_mode, &items)
        })
    }

    fn set_named(&mut self, mode: Mode) -> bool {
        self.set_mode(mode.number(self.profile, self.airframe))
    }

    /// ArduPilot counts home as 0.
    fn set_current(&mut self, seq: u16) -> bool {
        let first = u16::from(self.profile == Profile::ArduPilot);
        let items = self.items(MissionType::Mission).to_vec();
        let index = seq.checked_sub(first).map(usize::from);
        match (&mut self.pilot, index) {
            (Some(pilot), Some(index)) => pilot.set_current(index, &items),
            _ => false,
        }
    }

    fn give_message(&mut self, now: Time, id: f32) -> CommandResult {
        if id.to_bits() == HOME_POSITION.to_bits() && self.home.is_some() {
            self.tell_home();
        } else if id.to_bits() == GLOBAL_POSITION_INT.to_bits() && self.pilot.is_some() {
            self.tell_position(now);
        } else if id.to_bits() == MISSION_CURRENT.to_bits() {
            self.tell_current();
        } else if id.to_bits() == AUTOPILOT_VERSION.to_bits() {
            let flight_software = self.profile.flight_software();
            self.outbox.push_back(Message::AutopilotVersion {
                capabilities: self.profile.capabilities(),
                flight_software,
            });
        } else {
            return CommandResult::UNSUPPORTED;
        }
        CommandResult::ACCEPTED
    }

    /// Only positions have an interval of their own; 0 is the default, -1 none. Reports of health begin.
    fn set_interval(&mut self, params: [f32; 7]) -> CommandResult {
        let is = |id: &f32| params[0].to_bits() == id.to_bits();
        if HEALTH.iter().any(is) && self.pilot.is_some() {
            self.reports_health = true;
            return CommandResult::ACCEPTED;
        }
        if params[0].to_bits() != GLOBAL_POSITION_INT.to_bits() {
            return CommandResult::UNSUPPORTED;
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped to a positive count of milliseconds"
        )]
        let asked_ms = (params[1] / 1000.0).clamp(20.0, 3.6e6) as u64;
        self.position_ms = match params[1] {
            interval if interval < 0.0 => u64::MAX,
            interval if interval > 0.0 => asked_ms,
            _ => POSITION_MS,
        };
        CommandResult::ACCEPTED
    }

    fn tell_param(&mut self, name: &str) {
        let held = self.pilot.as_ref().map(|pilot| &pilot.settings);
        if let Some(value) = held.and_then(|settings| settings.on_wire(name)) {
            let name = name.to_owned();
            self.tell(FlightMessage::Param { name, value });
        }
    }

    pub(crate) fn tell(&mut self, message: FlightMessage) {
        self.outbox.push_back(Message::Flight(message));
    }
}

/// A parameter that must be a small whole number.
fn whole(value: f32) -> Option<u16> {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "checked to be within 16 bits"
    )]
    (0.0..65536.0).contains(&value).then_some(value as u16)
}
