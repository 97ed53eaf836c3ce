//! Which velocity brings a vehicle along its leg.

use crate::autopilot::Turn;
use crate::simulator::parameters::Limits;

/// Speed for each metre that is missing, near the end, 1/s.
const GAIN: f64 = 0.8;
/// Share of the acceleration that is planned with; the rest is for what comes in between.
const SHARE: f64 = 0.7;
/// No corner is passed more slowly, m/s.
const MIN_CORNER_MPS: f64 = 0.3;
/// Legs shorter than this across go straight up or down, metres.
pub(crate) const UPRIGHT_M: f64 = 0.5;

/// A straight way from one point to another: east, north, altitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Leg {
    pub(crate) from_m: [f64; 3],
    pub(crate) to_m: [f64; 3],
}

/// A point ahead, and how fast it may be passed; 0 is a stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Gate {
    /// Way to it, metres.
    pub(crate) distance_m: f64,
    pub(crate) speed_mps: f64,
}

/// How fast to close an error that must end at rest: linear near 0, then as the
/// acceleration allows.
pub(crate) fn closing_mps(error_m: f64, accel_mps2: f64) -> f64 {
    let linear_m = accel_mps2 / (GAIN * GAIN);
    let size = error_m.abs();
    let speed = if size <= linear_m {
        size * GAIN
    } else {
        (2.0 * accel_mps2 * (size - 0.5 * linear_m)).sqrt()
    };
    speed.copysign(error_m)
}

/// The horizontal length of the way between two points, metres.
pub(crate) fn across_m(from_m: [f64; 3], to_m: [f64; 3]) -> f64 {
    (to_m[0] - from_m[0]).hypot(to_m[1] - from_m[1])
}

/// The half of the change of course where three points meet, radians.
pub(crate) fn half_turn_rad(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> f64 {
    let course = |from: [f64; 3], to: [f64; 3]| (to[1] - from[1]).atan2(to[0] - from[0]);
    let turn = (course(b, c) - course(a, b)).abs();
    0.5 * turn.min(std::f64::consts::TAU - turn)
}

/// How fast a corner may be passed at a cruise speed: as the autopilot does, or so that it is cut
/// by no more than the limits allow.
///
/// A vehicle that pushes with constant acceleration from one course to the other flies a
/// parabola, which misses the corner by `v^2 sin^2(phi/2) / (2 a)`.
pub(crate) fn corner_mps(half_turn_rad: f64, speed_mps: f64, limits: &Limits) -> f64 {
    let sin = half_turn_rad.sin();
    if sin < 1e-6 {
        return f64::INFINITY;
    }
    let turn = Turn {
        angle_rad: 2.0 * half_turn_rad,
        speed_mps,
        radius_m: limits.corner_cut_m,
    };
    limits.cornering.map_or_else(
        || (2.0 * limits.corner_accel_mps2 * limits.corner_cut_m).sqrt() / sin,
        |law| law.min_mps(&turn).max(MIN_CORNER_MPS),
    )
}

impl Leg {
    pub(crate) fn length_m(&self) -> f64 {
        across_m(self.from_m, self.to_m)
    }

    pub(crate) fn is_upright(&self) -> bool {
        self.length_m() < UPRIGHT_M
    }

    /// Direction across, distance along it so far, and cross-track error (positive left).
    fn along(&self, at_m: [f64; 3]) -> ([f64; 2], f64, f64) {
        let length_m = self.length_m();
        let unit = [0, 1].map(|axis| (self.to_m[axis] - self.from_m[axis]) / length_m);
        let gone = [at_m[0] - self.from_m[0], at_m[1] - self.from_m[1]];
        (
            unit,
            gone[0] * unit[0] + gone[1] * unit[1],
            unit[0] * gone[1] - unit[1] * gone[0],
        )
    }

    /// What is left of the way, metres; negative beyond the end.
    pub(crate) fn left_m(&self, at_m: [f64; 3]) -> f64 {
        if self.is_upright() {
            across_m(at_m, self.to_m)
        } else {
            self.length_m() - self.along(at_m).1
        }
    }

    /// Rise over run.
    pub(crate) fn slope(&self) -> f64 {
        (self.to_m[2] - self.from_m[2]) / self.length_m().max(UPRIGHT_M)
    }

    /// The velocity that follows the leg at a cruise speed, through the gates ahead.
    pub(crate) fn velocity_mps(
        &self,
        at_m: [f64; 3],
        speed_mps: f64,
        gates: &[Gate],
        limits: &Limits,
    ) -> [f64; 3] {
        if self.is_upright() {
            return hold_mps(at_m, self.to_m, limits);
        }
        let (unit, gone_m, cross_track_m) = self.along(at_m);
        let slope = self.slope();
        let vertical_mps = if slope > 0.0 {
            limits.climb_mps
        } else {
            limits.descent_mps
        };
        let by_slope = vertical_mps / slope.abs().max(1e-9);
        let planned = SHARE * limits.accel_mps2;
        let most = gates
            .iter()
            .map(|gate| {
                let left_m = gate.distance_m.max(0.0);
                if gate.speed_mps > 0.0 {
                    (gate.speed_mps * gate.speed_mps + 2.0 * planned * left_m).sqrt()
                } else {
                    closing_mps(left_m, planned)
                }
            })
            .fold(speed_mps.min(by_slope), f64::min);
        let aside =
            closing_mps(-cross_track_m, limits.corner_accel_mps2).clamp(-0.9 * most, 0.9 * most);
        let ahead = (most * most - aside * aside).max(0.0).sqrt();
        let ahead = if gone_m > self.length_m() { 0.0 } else { ahead };
        let demand_m = self.from_m[2] + slope * gone_m.min(self.length_m());
        let climb = slope * ahead + closing_mps(demand_m - at_m[2], limits.accel_z_mps2);
        [
            unit[0] * ahead - unit[1] * aside,
            unit[1] * ahead + unit[0] * aside,
            climb.clamp(-limits.descent_mps, limits.climb_mps),
        ]
    }
}

/// The velocity that goes to a point and stays there.
pub(crate) fn hold_mps(at_m: [f64; 3], to_m: [f64; 3], limits: &Limits) -> [f64; 3] {
    let error = [to_m[0] - at_m[0], to_m[1] - at_m[1]];
    let distance_m = error[0].hypot(error[1]);
    let speed = closing_mps(distance_m, SHARE * limits.accel_mps2).min(limits.speed_mps);
    let share = if distance_m > 0.0 {
        speed / distance_m
    } else {
        0.0
    };
    let climb = closing_mps(to_m[2] - at_m[2], SHARE * limits.accel_z_mps2);
    [
        error[0] * share,
        error[1] * share,
        climb.clamp(-limits.descent_mps, limits.climb_mps),
    ]
}
