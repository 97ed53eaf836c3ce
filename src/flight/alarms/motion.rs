//! Whether the positions of a vehicle can be those of one that flies.

use super::Here;
use crate::link::Position;

/// A position that stays the same for this long while the vehicle flies is frozen, seconds.
const FROZEN_S: f64 = 1.2;
/// Faster than this, up or down too, a vehicle moves, m/s.
const MOVES_MPS: f64 = 1.0;
/// A position that is farther than this from where its velocity leads has jumped, metres; and what
/// an acceleration may add, m/s^2.
const JUMP_M: f64 = 15.0;
const ACCEL_MPS2: f64 = 6.0;
/// After a longer time nothing is known of where it should be, seconds.
const UNKNOWN_S: f64 = 3.0;

/// The last positions of a vehicle.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Motion {
    last: Option<Here>,
    /// The place and altitude as they were sent, and since when they have not changed.
    still: Option<([i32; 3], f64)>,
    /// Whether it was frozen, and has not changed since.
    is_frozen: bool,
}

impl Motion {
    /// Takes in a position; in words, whether it is frozen and whether it has jumped. `moves` says
    /// whether the vehicle should be on its way.
    pub(super) fn take(
        &mut self,
        here: &Here,
        position: &Position,
        moves: bool,
    ) -> (Option<String>, Option<String>) {
        let t_s = here.fix.t_s;
        let sent = [position.x, position.y, position.amsl_mm];
        let since_s = match self.still {
            Some((before, since_s)) if before == sent => since_s,
            _ => t_s,
        };
        self.still = Some((sent, since_s));
        let [east, north, up] = here.velocity_mps;
        let (still_s, speed_mps) = (t_s - since_s, east.hypot(north).hypot(up));
        // What is frozen is so until it changes, whether the vehicle should still move or not.
        let moves = speed_mps > MOVES_MPS || moves || self.is_frozen;
        let is_frozen = still_s >= FROZEN_S && moves;
        self.is_frozen = is_frozen;
        let frozen = is_frozen.then(|| {
            format!("position frozen for {still_s:.1} s at a speed of {speed_mps:.1} m/s")
        });
        let jumped = self.last.and_then(|last| jump(&last, here));
        self.last = Some(*here);
        (frozen, jumped)
    }
}

fn jump(last: &Here, here: &Here) -> Option<String> {
    let dt_s = last.fix.passed_s(&here.fix);
    if !(0.0..=UNKNOWN_S).contains(&dt_s) {
        return None;
    }
    let mean = |axis: usize| 0.5 * (last.velocity_mps[axis] + here.velocity_mps[axis]);
    let off_m = [
        here.point.at.east_m - last.point.at.east_m - mean(0) * dt_s,
        here.point.at.north_m - last.point.at.north_m - mean(1) * dt_s,
        here.point.amsl.0 - last.point.amsl.0 - mean(2) * dt_s,
    ];
    let off_m = off_m[0].hypot(off_m[1]).hypot(off_m[2]);
    let limit_m = JUMP_M + 0.5 * ACCEL_MPS2 * dt_s * dt_s;
    (off_m > limit_m).then(|| format!("position jumped {off_m:.0} m in {dt_s:.1} s"))
}

#[cfg(test)]
mod tests {
    use super::jump;
    use crate::flight::alarms::Here;
    use crate::flight::record::Fix;
    use crate::geodesy::{Amsl, LatLon, PlanPoint};

    /// A vehicle that flies north at 10 m/s, by two clocks.
    fn here(t_s: f64, boot_ms: Option<u32>, north_m: f64) -> Here {
        Here {
            fix: Fix {
                t_s,
                place: LatLon {
                    lat_deg: 36.0,
                    lon_deg: -84.0,
                },
                amsl: Amsl(500.0),
                speed_mps: 10.0,
                item: 1,
                items: 5,
                boot_ms,
            },
            point: PlanPoint::new(0.0, north_m, Amsl(500.0)),
            velocity_mps: [0.0, 10.0, 0.0],
            agl_m: 60.0,
        }
    }

    #[test]
    fn a_step_of_the_fleets_clock_is_no_jump_and_a_jump_is_one_by_any_clock() {
        let from = here(100.0, Some(50_000), 0.0);
        // After a stall of the machine the vehicle's time lies elsewhere on the clock of the fleet.
        assert_eq!(jump(&from, &here(100.1, Some(52_000), 20.0)), None);
        assert_eq!(jump(&from, &here(102.5, Some(50_200), 2.0)), None);
        let off = jump(&from, &here(100.1, Some(52_000), 60.0));
        assert_eq!(off.as_deref(), Some("position jumped 40 m in 2.0 s"));
        // Without a clock of its own, or after it was started again.
        for boot_ms in [None, Some(10)] {
            assert_eq!(jump(&from, &here(101.0, boot_ms, 11.0)), None);
            assert!(jump(&from, &here(100.1, boot_ms, 20.0)).is_some());
        }
    }
}
