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
/// A jump is undone where positions are as near as this to where they led before it, metres; after another jump as near
/// as [`JUMP_M`].
const BACK_M: f64 = 7.5;

/// The last positions of a vehicle.
#[derive(Clone, Debug, Default)]
pub(super) struct Motion {
    last: Option<Here>,
    /// The place and altitude as they were sent, and since when they have not changed.
    still: Option<([i32; 3], f64)>,
    /// Whether it was frozen, and has not changed since.
    is_frozen: bool,
    /// The height above home as it was sent, millimetres, and since when it has not changed.
    level: Option<(i32, f64)>,
    /// A jump that was not undone: nobody knows whether the positions before it or those after it are right.
    jumped: Option<Jumped>,
}

/// How far positions are from where they led before a jump: to the east, the north and up, metres; and the jump in words.
#[derive(Clone, Debug)]
struct Jumped {
    off_m: [f64; 3],
    text: String,
}

/// A position that is off where the one before it leads, metres, and after how long, seconds.
#[derive(Clone, Copy, Debug)]
struct Step {
    off_m: [f64; 3],
    dt_s: f64,
}

impl Step {
    /// None after a time in which nothing is known.
    fn of(last: &Here, here: &Here) -> Option<Self> {
        let dt_s = last.fix.passed_s(&here.fix);
        let mean = |axis: usize| 0.5 * (last.velocity_mps[axis] + here.velocity_mps[axis]);
        let off_m = [
            here.point.at.east_m - last.point.at.east_m - mean(0) * dt_s,
            here.point.at.north_m - last.point.at.north_m - mean(1) * dt_s,
            here.point.amsl.0 - last.point.amsl.0 - mean(2) * dt_s,
        ];
        (0.0..=UNKNOWN_S)
            .contains(&dt_s)
            .then_some(Self { off_m, dt_s })
    }

    fn jump(&self) -> Option<String> {
        let (off_m, dt_s) = (length_m(self.off_m), self.dt_s);
        let limit_m = JUMP_M + 0.5 * ACCEL_MPS2 * dt_s * dt_s;
        (off_m > limit_m).then(|| format!("position jumped {off_m:.0} m in {dt_s:.1} s"))
    }
}

fn length_m([east_m, north_m, up_m]: [f64; 3]) -> f64 {
    east_m.hypot(north_m).hypot(up_m)
}

impl Motion {
    /// Whether its height is as frozen as its place: an autopilot without a place may still say how high it is.
    pub(super) fn is_height_frozen(&self) -> bool {
        let last_s = self.last.map_or(0.0, |last| last.fix.t_s);
        let level_s = self.level.map_or(last_s, |(_, level_s)| level_s);
        self.is_frozen && last_s - level_s >= FROZEN_S
    }

    /// Takes in a position; in words, whether it is frozen and whether it has jumped, until that is undone. `moves` says
    /// whether the vehicle should be on its way, `is_up` whether it is in the air: on the ground its position
    /// may still settle.
    pub(super) fn take(
        &mut self,
        here: &Here,
        position: &Position,
        (moves, is_up): (bool, bool),
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
        let level_s = match self.level {
            Some((before, level_s)) if before == position.above_home_mm => level_s,
            _ => t_s,
        };
        self.level = Some((position.above_home_mm, level_s));
        let frozen = is_frozen.then(|| {
            format!("position frozen for {still_s:.1} s at a speed of {speed_mps:.1} m/s")
        });
        // One that is repeated does not show where it should be.
        let step = self.last.filter(|_| still_s <= 0.0);
        let step = step.and_then(|last| Step::of(&last, here));
        self.take_step(step.filter(|_| is_up), is_up);
        self.last = Some(*here);
        (frozen, self.jumped.as_ref().map(|of| of.text.clone()))
    }

    fn take_step(&mut self, step: Option<Step>, is_up: bool) {
        self.jumped = self.jumped.take().filter(|_| is_up);
        let Some(step) = step else { return };
        let jump = step.jump();
        match (&mut self.jumped, jump) {
            (Some(jumped), jump) => {
                for (off_m, by_m) in jumped.off_m.iter_mut().zip(step.off_m) {
                    *off_m += by_m;
                }
                let back_m = if jump.is_some() { JUMP_M } else { BACK_M };
                if length_m(jumped.off_m) <= back_m {
                    self.jumped = None;
                }
            }
            (None, Some(text)) => {
                let off_m = step.off_m;
                self.jumped = Some(Jumped { off_m, text });
            }
            (None, None) => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Motion, Step};
    use crate::flight::alarms::Here;
    use crate::flight::record::Fix;
    use crate::geodesy::{Amsl, LatLon, PlanPoint};
    use crate::link::Position;

    fn jump(last: &Here, here: &Here) -> Option<String> {
        Step::of(last, here)?.jump()
    }

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

    /// Whether an alarm stands after each position of a vehicle that flies north at 10 m/s and whose positions are off
    /// by so much to the north, in metres, five a second.
    fn stands(off_m: impl IntoIterator<Item = f64>) -> Vec<bool> {
        let mut motion = Motion::default();
        let positions = off_m.into_iter().enumerate();
        let take = |(index, off_m): (usize, f64)| {
            let index = u32::try_from(index).expect("few");
            let t_s = 0.2 * f64::from(index);
            let here = here(t_s, Some(200 * index), 10.0 * t_s + off_m);
            let x = i32::try_from(index).expect("few");
            let sent = Position {
                x,
                ..Position::default()
            };
            motion.take(&here, &sent, (true, true)).1.is_some()
        };
        positions.map(take).collect()
    }

    #[test]
    fn a_jump_stands_until_it_is_undone() {
        let noise_m = |index: u32| 1.5 * f64::from(index % 3) - 1.5;
        // For four minutes; an outlier; there and back in steps; a walk that is none.
        let stays = stands((0..1300).map(|at| if at < 50 { 0.0 } else { 67.0 } + noise_m(at)));
        assert!(
            stays[..50].iter().all(|stands| !stands) && stays[50..].iter().all(|stands| *stands)
        );
        let outlier = stands((0..100).map(|at| if at == 50 { 67.0 } else { 0.0 } + noise_m(at)));
        assert_eq!(outlier.iter().filter(|stands| **stands).count(), 1);
        let steps = [
            0.0, 40.0, 80.0, 80.0, 70.0, 60.0, 50.0, 40.0, 30.0, 20.0, 10.0, 5.0, 0.0,
        ];
        let back = stands(steps);
        assert!(
            back[1..11].iter().all(|stands| *stands) && !back[11] && !back[12],
            "{back:?}"
        );
        assert!(!stands((0..100).map(|at| 10.0 * f64::from(at))).contains(&true));
    }
}
