//! Corners: what an arc takes of its legs, and its shape.

use std::f64::consts::PI;

use super::{Knot, Room, Shape};
use crate::autopilot::{Cornering, Turn};
use crate::geodesy::{Amsl, EastNorth};
use crate::path::{VehicleLimits, corner_late_s, leg_late_s};
use crate::spec::Vehicle;

/// A corner between two legs and the circle that rounds it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Corner {
    /// Change of course, radians, positive to the left.
    pub(super) turn_rad: f64,
    /// What the turn radius of the spec's limits takes of each leg, `R tan(phi/2)`, metres.
    required_m: f64,
    /// What the arc takes that the vehicle flies, metres: less where the legs are short.
    pub(super) taken_m: f64,
    /// How a copter flies it.
    pub(super) flown: Option<(Cornering, Turn)>,
}

/// The turn radius at a commanded speed and an altitude, metres: it grows with the square of
/// the greatest speed over the ground.
pub(crate) fn turn_radius_at_m(vehicle: &Vehicle, speed_mps: f64, at: Amsl) -> f64 {
    let limits = VehicleLimits::of(vehicle);
    let ratio = vehicle.fastest_at_mps(speed_mps, at) / limits.fastest_mps;
    limits.turn_radius_m * ratio * ratio
}

impl Corner {
    /// How far the arc of a copter is from the waypoint, metres.
    pub(super) fn cut_m(&self) -> f64 {
        let half_rad = (0.5 * self.turn_rad.abs()).min(89.9_f64.to_radians());
        self.flown
            .map_or(0.0, |_| self.taken_m * (0.5 * half_rad).tan())
    }

    /// By how much a vehicle may be later after it, seconds, beyond what it may be after each leg.
    pub(super) fn late_s(&self, vehicle: &Vehicle) -> f64 {
        let Some((law, turn)) = self.flown else {
            return 0.0;
        };
        let takes_s = if law.takes_time(&turn) {
            corner_late_s(vehicle)
        } else {
            0.0
        };
        takes_s + (law.late_s(&turn, self.taken_m) - leg_late_s(vehicle)).max(0.0)
    }
}

/// A corner at every knot; none at the ends.
pub(super) fn corners(
    knots: &[Knot],
    vehicle: &Vehicle,
    law: Option<Cornering>,
    grounds_mps: &[f64],
) -> Vec<Corner> {
    let none = Corner {
        turn_rad: 0.0,
        required_m: 0.0,
        taken_m: 0.0,
        flown: None,
    };
    let mut corners = vec![none; knots.len()];
    for (index, trio) in knots.windows(3).enumerate() {
        let course =
            |a: EastNorth, b: EastNorth| (b.north_m - a.north_m).atan2(b.east_m - a.east_m);
        let mut turn_rad = course(trio[1].at, trio[2].at) - course(trio[0].at, trio[1].at);
        if turn_rad > PI {
            turn_rad -= 2.0 * PI;
        } else if turn_rad < -PI {
            turn_rad += 2.0 * PI;
        }
        // The tangent of a full reversal has no end: 89.9 degrees are long enough to fail.
        let half_rad = (0.5 * turn_rad.abs()).min(89.9_f64.to_radians());
        let speed_mps = trio[1].speed_mps.max(trio[2].speed_mps);
        let at = Amsl(trio[1].amsl_m);
        let required_m = turn_radius_at_m(vehicle, speed_mps, at) * half_rad.tan();
        let turn = Turn {
            angle_rad: turn_rad.abs(),
            speed_mps: grounds_mps[index].min(grounds_mps[index + 1]),
            radius_m: trio[1].accept_m,
        };
        corners[index + 1] = Corner {
            turn_rad,
            required_m,
            taken_m: law.map_or(required_m, |law| law.taken_m(&turn)),
            flown: law.map(|law| (law, turn)),
        };
    }
    corners
}

/// Shrinks fillets that do not fit, and says what each leg has left.
pub(super) fn fit(corners: &mut [Corner], legs: &[f64]) -> Vec<Room> {
    // A little of each leg stays straight, so that a start from rest can gather speed.
    const SHARE: f64 = 0.99;
    let mut rooms = Vec::new();
    let flown_m: Vec<f64> = corners.iter().map(|corner| corner.taken_m).collect();
    for (leg, &length_m) in legs.iter().enumerate() {
        let required_m = corners[leg].required_m + corners[leg + 1].required_m;
        if required_m > 0.0 {
            rooms.push(Room {
                leg,
                left_m: length_m - required_m,
            });
        }
        let both_m = flown_m[leg] + flown_m[leg + 1];
        if both_m > SHARE * length_m {
            let scale = SHARE * length_m / both_m;
            for (corner, flown_m) in corners[leg..=leg + 1].iter_mut().zip(&flown_m[leg..]) {
                corner.taken_m = corner.taken_m.min(flown_m * scale);
            }
        }
    }
    rooms
}

/// The circle that rounds a corner, if there is one to round.
pub(super) fn arc(knots: (EastNorth, EastNorth, EastNorth), corner: &Corner) -> Option<Shape> {
    const MIN_TURN_RAD: f64 = 1e-6;
    let half_rad = 0.5 * corner.turn_rad.abs();
    let radius_m = corner.taken_m / half_rad.min(89.9_f64.to_radians()).tan();
    if half_rad < MIN_TURN_RAD || radius_m <= 0.0 {
        return None;
    }
    let (before, at, _) = knots;
    let course_rad = (at.north_m - before.north_m).atan2(at.east_m - before.east_m);
    let (sin, cos) = course_rad.sin_cos();
    // From the centre the vehicle is to the right on a left turn, and the other way round.
    let side = corner.turn_rad.signum();
    let entry = EastNorth {
        east_m: at.east_m - corner.taken_m * cos,
        north_m: at.north_m - corner.taken_m * sin,
    };
    Some(Shape::Arc {
        center: EastNorth {
            east_m: entry.east_m - side * radius_m * sin,
            north_m: entry.north_m + side * radius_m * cos,
        },
        radius_m,
        start_rad: course_rad - side * 0.5 * PI,
        sweep_rad: corner.turn_rad,
    })
}
