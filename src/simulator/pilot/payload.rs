//! `NAV_PAYLOAD_PLACE` of ArduCopter: down to the ground, release, and up again.

use super::{Doing, Event, Pilot, REACHED_M};
use crate::link::Time;
use crate::mission::Item;
use crate::simulator::dynamics::steering;
use crate::simulator::parameters::Limits;

/// What release and the measurement of the thrust take, milliseconds.
const RELEASE_MS: u64 = 5000;
/// Height above ground at which the load is down, metres.
const TOUCHES_M: f64 = 0.05;

/// A load that is being placed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Placing {
    /// Where it comes down from, and rises to.
    pub(crate) top_m: [f64; 3],
    /// Most that it comes down, metres.
    max_m: f64,
    stage: Stage,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Stage {
    Lowering,
    Releasing { until: Time },
    Rising,
}

impl Placing {
    pub(crate) fn new(item: &Item, top_m: [f64; 3]) -> Self {
        let max_m = f64::from(item.params[0]);
        Self {
            top_m,
            max_m: if max_m > 0.0 { max_m } else { f64::INFINITY },
            stage: Stage::Lowering,
        }
    }
}

impl Pilot {
    /// Begins to place a load at the end of a leg.
    pub(crate) fn place_payload(&mut self, items: &[Item], top_m: [f64; 3]) {
        if let Some(item) = items.get(self.at) {
            self.doing = Doing::Placing(Placing::new(item, top_m));
        }
    }

    /// The velocity of a vehicle that places a load.
    pub(crate) fn step_placing(
        &mut self,
        mut placing: Placing,
        at_m: [f64; 3],
        items: &[Item],
        limits: &Limits,
    ) -> [f64; 3] {
        let top_m = placing.top_m;
        let mut up_mps = 0.0;
        match placing.stage {
            Stage::Lowering if at_m[2] - self.ground_m(at_m) <= TOUCHES_M => {
                let until = self.clock + RELEASE_MS;
                placing.stage = Stage::Releasing { until };
                self.events
                    .push(Event::Says("PayloadPlace: landed, releasing"));
            }
            Stage::Lowering if top_m[2] - at_m[2] >= placing.max_m => {
                placing.stage = Stage::Rising;
                self.events
                    .push(Event::Says("PayloadPlace: reached maximum descent"));
            }
            Stage::Lowering => up_mps = -limits.placing_mps,
            Stage::Releasing { until } if self.clock >= until => placing.stage = Stage::Rising,
            Stage::Releasing { .. } => {}
            Stage::Rising => {
                let left_m = top_m[2] - at_m[2];
                let rise_mps = steering::closing_mps(left_m, 0.7 * limits.accel_z_mps2);
                up_mps = rise_mps.clamp(0.0, limits.climb_mps);
                if left_m < REACHED_M {
                    self.doing = Doing::Placing(placing);
                    self.complete(items);
                    return [0.0, 0.0, up_mps];
                }
            }
        }
        self.doing = Doing::Placing(placing);
        let [east, north, _] = steering::hold_mps(at_m, [top_m[0], top_m[1], at_m[2]], limits);
        [east, north, up_mps]
    }
}
