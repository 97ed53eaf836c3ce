//! What a ground station orders: motors, modes, another item, another mission.

use super::{Doing, Hold, Pilot};
use crate::geodesy::LatLon;
use crate::link::Time;
use crate::mission::Item;
use crate::simulator::dynamics::steering::Leg;
use crate::simulator::mode::Mode;
use crate::simulator::profile::Profile;

impl Pilot {
    /// Starts the motors, or says why not.
    pub(in crate::simulator) fn arm(&mut self, now: Time) -> Result<(), &'static str> {
        if self.armed {
            return Ok(());
        }
        // ArduPlane does arm in AUTO, and goes.
        let copter = !self.airframe.has_wing();
        if self.profile == Profile::ArduPilot && copter && self.mode() == Mode::Mission {
            return Err("Arm: Mode not armable");
        }
        self.armed = true;
        (self.clock, self.armed_at) = (now, now);
        self.doing = Doing::Standing;
        Ok(())
    }

    /// Stops the motors, or says why not.
    pub(in crate::simulator) fn disarm(&mut self) -> Result<(), &'static str> {
        if self.airborne {
            return Err("Disarm: not landed");
        }
        self.armed = false;
        self.stand();
        Ok(())
    }

    /// Changes the mode. A mission must be there to be flown.
    pub(in crate::simulator) fn set_mode(&mut self, custom_mode: u32, items: &[Item]) -> bool {
        let mode = Mode::of(self.profile, self.airframe, custom_mode);
        if mode == Mode::Mission && items.is_empty() {
            return false;
        }
        let was = self.mode();
        self.custom_mode = custom_mode;
        if self.armed && (mode != was || mode == Mode::Mission && !self.under_way) {
            self.enter(mode, items);
        }
        true
    }

    /// Takes the mission up where it is, or from its beginning.
    pub(in crate::simulator) fn start_mission(&mut self, items: &[Item]) -> bool {
        self.set_mode(self.number(Mode::Mission), items)
    }

    /// Goes on with another item.
    pub(in crate::simulator) fn set_current(&mut self, index: usize, items: &[Item]) -> bool {
        if index >= items.len() {
            return false;
        }
        self.at = index;
        if self.armed && self.under_way && self.mode() == Mode::Mission {
            self.begin(items, None);
        }
        true
    }

    /// A new mission is on board. PX4 begins it at once; ArduPilot goes on with its leg
    /// and takes up the new items after it.
    pub(in crate::simulator) fn mission_replaced(&mut self, items: &[Item]) {
        let in_flight = self.airborne && self.under_way;
        if self.profile != Profile::ArduPilot || !in_flight {
            self.at = 0;
            if in_flight && self.mode() == Mode::Mission {
                self.begin(items, None);
            }
        }
    }

    /// Takes in where its rally points are.
    pub(in crate::simulator) fn set_rally(&mut self, points: &[Item]) {
        let at = points.iter().map(|point| {
            let at = self.frame.to_plan(LatLon::of_e7(point.x, point.y));
            [at.east_m, at.north_m]
        });
        self.rally_m = at.collect();
    }

    fn enter(&mut self, mode: Mode, items: &[Item]) {
        let here = self.sensed();
        match mode {
            Mode::Mission => {
                if !self.under_way {
                    self.at = if self.at < items.len() { self.at } else { 0 };
                    self.under_way = true;
                    self.speed_mps = None;
                }
                self.begin(items, None);
            }
            _ if !self.airborne => self.doing = Doing::Standing,
            _ if self.airframe.has_wing() => self.enter_winged(mode),
            Mode::Hold => {
                let at_m = self.stopping_point();
                self.doing = Doing::Holding { at_m, until: None };
            }
            Mode::Land => {
                let at_m = self.stopping_point();
                self.doing = Doing::Sinking { at_m };
            }
            Mode::Return => self.return_home(here),
        }
    }

    /// Where the vehicle comes to rest if it brakes now.
    pub(crate) fn stopping_point(&self) -> [f64; 3] {
        let (limits, [east, north, up]) = (self.settings.limits(), self.body.velocity_mps);
        let speed = east.hypot(north);
        let brake_s = 0.5 * speed / (0.7 * limits.accel_mps2) + 0.3;
        let rise_s = 0.5 * up.abs() / limits.accel_z_mps2;
        let here = self.sensed();
        [
            here[0] + east * brake_s,
            here[1] + north * brake_s,
            here[2] + up * rise_s,
        ]
    }

    /// Home or the rally point that is nearer, at the altitude of a return, or at the present one if that
    /// is higher.
    pub(crate) fn return_home(&mut self, here: [f64; 3]) {
        let amsl_m = here[2].max(self.home_m + self.settings.limits().return_m);
        let away_m = |of: &[f64; 2]| (of[0] - here[0]).hypot(of[1] - here[1]);
        let ends = self.rally_m.iter().copied().chain([[0.0; 2]]);
        let nearest = ends.min_by(|a, b| away_m(a).total_cmp(&away_m(b)));
        let [east_m, north_m] = nearest.unwrap_or_default();
        let leg = Leg {
            from_m: [here[0], here[1], amsl_m],
            to_m: [east_m, north_m, amsl_m],
        };
        let hold = Hold::Land;
        self.doing = Doing::Flying { leg, hold };
    }
}
