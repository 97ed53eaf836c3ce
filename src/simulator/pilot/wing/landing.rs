//! How a wing comes to the ground.

use super::{STANDS_MPS, Winged};
use crate::simulator::dynamics::steering::Leg;
use crate::simulator::mode::Mode;
use crate::simulator::parameters::{Follows, WingLimits};
use crate::simulator::pilot::{Doing, Event, Hold, Pilot, STEP_S};

/// The way that a VTOL brakes is no shorter, metres.
const SHORTEST_M: f64 = 1.0;

impl Pilot {
    /// From wing to rotors, which bring it to a stop over a place.
    pub(crate) fn onto_rotors(&self, to_m: [f64; 3]) -> Doing {
        let from_m = self.sensed();
        let leg = Leg {
            from_m,
            to_m: [to_m[0], to_m[1], to_m[2]],
        };
        if leg.length_m() < SHORTEST_M {
            Doing::Sinking { at_m: leg.to_m }
        } else {
            let hold = Hold::Land;
            Doing::Flying { leg, hold }
        }
    }

    /// Down a straight line, then, near the ground, out of it.
    pub(crate) fn glide(
        &mut self,
        leg: Leg,
        flare: Option<(f64, f64)>,
        at_m: [f64; 3],
        limits: &WingLimits,
    ) {
        let across_mps2 = self.motion(at_m).along(&leg, limits);
        let sink_mps = -self.wing.map_or(0.0, |wing| wing.climb_mps());
        let above_m = at_m[2] - self.ground_m(at_m);
        let flares = above_m <= limits.flare_m.max(limits.flare_s * sink_mps);
        let flare = flare.or(flares.then_some((above_m, sink_mps)));
        match flare {
            Some((from_m, before_mps)) => {
                let done = (1.0 - above_m / from_m.max(0.1)).clamp(0.0, 1.0);
                let sink_mps = before_mps * (1.0 - done) + limits.flare_sink_mps * done;
                let sink_mps = sink_mps.max(limits.flare_sink_mps);
                // With the motor off it slows down on its way.
                self.fly_on(across_mps2, -sink_mps, limits.min_airspeed_mps);
            }
            None => {
                let amsl_m = self.glide_m(&leg, at_m, limits);
                self.fly_at(across_mps2, amsl_m, at_m, true);
            }
        }
        self.doing = Doing::OnWing(Winged::Gliding { leg, flare });
        if self.body.at_m[2] <= self.ground_m(self.body.at_m) {
            self.touch_down();
        }
    }

    /// The altitude of the glide: that of the line; ArduPlane's passes so far above a point so
    /// far before its end that the flare ends there.
    fn glide_m(&self, leg: &Leg, at_m: [f64; 3], limits: &WingLimits) -> f64 {
        let (length_m, drop_m) = (leg.length_m(), leg.from_m[2] - leg.to_m[2]);
        let gone_m = length_m - leg.left_m(at_m);
        if !matches!(limits.follows, Follows::Filtered { .. }) {
            return leg.from_m[2] - drop_m * (gone_m / length_m).clamp(0.0, 1.0);
        }
        let speed = self.motion(at_m).speed_mps().max(1.0);
        let sink_mps = (drop_m * speed / length_m).max(0.1);
        let aim_m = (limits.flare_s * sink_mps).min(2.0 * limits.flare_m);
        let before_m = (aim_m / sink_mps * speed).min(0.5 * length_m);
        let slope = (drop_m - aim_m) / (length_m - before_m);
        leg.from_m[2] - slope * gone_m.max(0.0)
    }

    pub(crate) fn touch_down(&mut self) {
        self.airborne = false;
        self.under_way = false;
        self.body.at_m[2] = self.ground_m(self.body.at_m);
        self.body.velocity_mps[2] = 0.0;
        self.doing = Doing::OnWing(Winged::RunningOut);
        if self.mode() == Mode::Mission {
            self.events.push(Event::Reached(self.at));
        }
    }

    pub(crate) fn run_out(&mut self) {
        let air_mps = self.air_mps();
        if let Some(wing) = &mut self.wing {
            wing.roll(&mut self.body, 0.0, air_mps, STEP_S);
        }
        self.body.at_m[2] = self.ground_m(self.body.at_m);
        let [east, north, _] = self.body.velocity_mps;
        if east.hypot(north) < STANDS_MPS {
            self.body.velocity_mps = [0.0; 3];
            self.wing = None;
            self.doing = Doing::Landed { at: self.clock };
        }
    }
}
