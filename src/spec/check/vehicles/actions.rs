//! The actions at a stop.

use super::Checker;
use crate::autopilot::{Autopilot, command_name};
use crate::spec::keys;
use crate::spec::{EndPoint, StopAction};

const KEYS: &str = "one of photo, video, gimbal, roi, roi_none, servo, relay, gripper, winch, payload_place in each item";

impl Checker {
    /// The actions of a stop that are whole and that the autopilot runs.
    pub(super) fn actions(
        &mut self,
        path: &str,
        (listed, at): (&[keys::StopAction], keys::EndPoint),
        autopilot: Option<Autopilot>,
    ) -> Vec<StopAction> {
        let mut actions = Vec::new();
        for (index, keys) in listed.iter().enumerate() {
            let path = format!("{path}.actions[{index}]");
            let mut found = self.action(&path, keys);
            if found.len() > 1 || (found.is_empty() && *keys == keys::StopAction::default()) {
                self.report(&path, format!("{} actions", found.len()), KEYS);
                continue;
            }
            let Some(action) = found.pop() else { continue };
            self.runs(&path, &action, autopilot);
            self.comes_down(&path, &action, at);
            actions.push(action);
        }
        actions
    }

    /// An autopilot must not refuse the command of an action.
    fn runs(&mut self, path: &str, action: &StopAction, autopilot: Option<Autopilot>) {
        let Some(autopilot) = autopilot else { return };
        if !action.is_run_by(autopilot) {
            let name = command_name(action.command()).unwrap_or_default();
            let found = format!(
                "{}, and {} refuses {name} in a mission",
                action.key(),
                autopilot.name()
            );
            self.report(&format!("{path}.{}", action.key()), found, "another action");
        }
    }

    /// A load is placed from a known height above ground, and within the descent that is allowed.
    fn comes_down(&mut self, path: &str, action: &StopAction, at: keys::EndPoint) {
        let StopAction::PayloadPlace { max_descent_m } = *action else {
            return;
        };
        let path = format!("{path}.payload_place");
        match (at.agl_m, max_descent_m) {
            // Out of its range it is reported already.
            (Some(agl_m), Some(max_m)) if (1.0..agl_m).contains(&max_m) => {
                let found = format!("{max_m} m, and the ground is {agl_m} m below");
                let allowed = "at least agl_m, or no limit";
                self.report(&format!("{path}.max_descent_m"), found, allowed);
            }
            (None, _) if at.amsl_m.is_some() => {
                let found = "a load is placed, at a place with amsl_m";
                self.report(&path, found, "agl_m: how far the vehicle comes down");
            }
            _ => {}
        }
    }

    /// A wing does not hover for these actions.
    pub(super) fn hovers(&mut self, path: &str, listed: &[keys::StopAction]) {
        for (index, action) in listed.iter().enumerate() {
            let keys = [
                ("winch", action.winch.is_some()),
                ("payload_place", action.payload_place.is_some()),
            ];
            for (key, _) in keys.into_iter().filter(|(_, is_given)| *is_given) {
                let path = format!("{path}.actions[{index}].{key}");
                let found = format!("{key}, on a wing, which does not hover");
                self.report(&path, found, "another action");
            }
        }
    }

    /// All actions that one item has; broken ones are reported.
    fn action(&mut self, path: &str, keys: &keys::StopAction) -> Vec<StopAction> {
        let mut found = Vec::new();
        found.extend(keys.photo.map(|_| StopAction::Photo));
        found.extend(keys.video.map(|video| StopAction::Video {
            starts: video == keys::Video::Start,
        }));
        found.extend(keys.gimbal.and_then(|gimbal| self.gimbal(path, gimbal)));
        found.extend(keys.roi.and_then(|roi| self.roi(path, roi)));
        found.extend(keys.roi_none.map(|_| StopAction::RoiNone));
        found.extend(keys.servo.and_then(|servo| self.servo(path, servo)));
        found.extend(keys.relay.and_then(|relay| self.relay(path, relay)));
        found.extend(keys.gripper.map(|gripper| StopAction::Gripper {
            grabs: gripper == keys::Gripper::Grab,
        }));
        found.extend(keys.winch.and_then(|winch| self.winch(path, winch)));
        found.extend(keys.payload_place.map(|place| StopAction::PayloadPlace {
            max_descent_m: place.max_descent_m,
        }));
        found
    }

    fn gimbal(&mut self, path: &str, keys: keys::Gimbal) -> Option<StopAction> {
        let pitch_deg = self.required(&format!("{path}.gimbal"), "pitch_deg", keys.pitch_deg)?;
        Some(StopAction::Gimbal {
            pitch_deg: i16::try_from(pitch_deg).ok()?,
            yaw_deg: i16::try_from(keys.yaw_deg.unwrap_or(0)).ok()?,
        })
    }

    fn roi(&mut self, path: &str, keys: keys::EndPoint) -> Option<StopAction> {
        let path = format!("{path}.roi");
        let end: EndPoint = self.end_point(&path, keys)?;
        if let Some(origin) = self.origin {
            self.is_near(&path, end.place, origin);
        }
        Some(StopAction::Roi(end))
    }

    fn servo(&mut self, path: &str, keys: keys::Servo) -> Option<StopAction> {
        let path = format!("{path}.servo");
        let channel = self.required(&path, "channel", keys.channel);
        let pwm_us = self.required(&path, "pwm_us", keys.pwm_us);
        Some(StopAction::Servo {
            channel: u8::try_from(channel?).ok()?,
            pwm_us: u16::try_from(pwm_us?).ok()?,
        })
    }

    fn relay(&mut self, path: &str, keys: keys::Relay) -> Option<StopAction> {
        let path = format!("{path}.relay");
        let number = self.required(&path, "number", keys.number);
        let closed = self.required(&path, "closed", keys.closed);
        Some(StopAction::Relay {
            number: u8::try_from(number?).ok()?,
            closed: closed?,
        })
    }

    fn winch(&mut self, path: &str, keys: keys::Winch) -> Option<StopAction> {
        let path = format!("{path}.winch");
        let length_m = self.required(&path, "length_m", keys.length_m);
        let rate_mps = self.required(&path, "rate_mps", keys.rate_mps);
        Some(StopAction::Winch {
            length_m: length_m?,
            rate_mps: rate_mps?,
        })
    }
}
