//! Legs between two stops: fillets at the corners, speed along the way.

use std::f64::consts::PI;

use crate::autopilot::{Cornering, Turn};
use crate::geodesy::{Amsl, EastNorth, PlanPoint};
use crate::path::{VehicleLimits, corner_late_s, heading_rad};
use crate::spec::Vehicle;

use super::decode::Unknown;
use crate::verify::measure::segment::Phase;

/// A point of the flight where legs meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Knot {
    /// Row of the item that leads here.
    pub(crate) row: usize,
    pub(crate) at: EastNorth,
    /// Altitude above the sea, metres.
    pub(crate) amsl_m: f64,
    /// Height above the ground here if the leg that leads here follows the terrain, metres.
    pub(crate) agl_m: Option<f64>,
    /// Commanded speed on the leg that leads here, m/s: over the ground, on a wing through the air.
    pub(crate) speed_mps: f64,
    /// Whether the mission or its parameters set that speed.
    pub(crate) speed_is_known: bool,
    /// Part of the flight of the leg that leads here.
    pub(crate) phase: Phase,
    /// Altitude of the ground that the leg that leads here climbs from or glides to, metres.
    pub(crate) slope_from_m: Option<f64>,
    /// A copter accepts the place within this radius, metres.
    pub(crate) accept_m: f64,
}

/// A corner between two legs and the circle that rounds it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Corner {
    /// Change of course, radians, positive to the left.
    turn_rad: f64,
    /// What the turn radius of the spec's limits takes of each leg, `R tan(phi/2)`, metres.
    required_m: f64,
    /// What the arc takes that the vehicle flies, metres: less where the legs are short.
    taken_m: f64,
    /// How a copter flies it.
    turn: Option<Turn>,
}

/// Horizontal shape of a piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Shape {
    Line {
        from: EastNorth,
        to: EastNorth,
    },
    Arc {
        center: EastNorth,
        radius_m: f64,
        start_rad: f64,
        sweep_rad: f64,
    },
}

/// A piece of constant acceleration along a line or an arc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Piece {
    /// Which leg it belongs to: the one from knot `leg` to `leg + 1`; an arc, to the one before it.
    pub(crate) leg: usize,
    pub(crate) shape: Shape,
    /// Speeds at the ends, m/s; not both 0.
    pub(crate) speed_mps: (f64, f64),
    /// Fractions of the leg at the ends; of an arc, where it leaves one leg and joins the next.
    pub(crate) fraction: (f64, f64),
    /// How far a real vehicle may be from it, metres: a copter cuts a corner by less, or not at all.
    pub(crate) wide_m: f64,
    /// By how much the vehicle may be later at its end than at its beginning, seconds.
    pub(crate) late_s: f64,
}

/// How much of a leg its fillets leave over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Room {
    pub(crate) leg: usize,
    /// Leg length minus `R tan(phi/2)` of both ends, metres.
    pub(crate) left_m: f64,
}

/// Everything flown between two stops.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Run {
    pub(crate) pieces: Vec<Piece>,
    /// One for each leg with a corner.
    pub(crate) rooms: Vec<Room>,
    /// Highest speed on each leg, m/s.
    pub(crate) peak_mps: Vec<f64>,
}

/// The turn radius at a commanded speed and an altitude, metres: it grows with the square of
/// the greatest speed over the ground.
fn turn_radius_m(vehicle: &Vehicle, speed_mps: f64, at: Amsl) -> f64 {
    let limits = VehicleLimits::of(vehicle);
    let ratio = vehicle.fastest_at_mps(speed_mps, at) / limits.fastest_mps;
    limits.turn_radius_m * ratio * ratio
}

/// The speed over the ground on each leg, m/s.
///
/// # Errors
/// A leg whose course the wind does not let the vehicle hold.
pub(crate) fn ground_speeds(knots: &[Knot], vehicle: &Vehicle) -> Result<Vec<f64>, Unknown> {
    let legs = knots.windows(2);
    legs.map(|pair| {
        let course_rad = heading_rad(pair[0].at, pair[1].at);
        let halfway = Amsl(0.5 * (pair[0].amsl_m + pair[1].amsl_m));
        ground_speed(vehicle, &pair[1], halfway, course_rad)
    })
    .collect()
}

/// The speed over the ground on a course at an altitude, as commanded on the leg that leads to
/// a knot, m/s.
///
/// # Errors
/// The wind does not let the vehicle hold that course.
pub(crate) fn ground_speed(
    vehicle: &Vehicle,
    to: &Knot,
    at: Amsl,
    course_rad: f64,
) -> Result<f64, Unknown> {
    let ground_mps = vehicle.ground_speed_mps(to.speed_mps, at, course_rad);
    ground_mps.ok_or_else(|| Unknown {
        row: to.row,
        why: format!(
            "the wind is too strong for a course of {:.0} degrees at {:.1} m/s through the air",
            course_rad.to_degrees().rem_euclid(360.0),
            to.speed_mps
        ),
    })
}

impl Knot {
    pub(crate) fn point(&self) -> PlanPoint {
        PlanPoint {
            at: self.at,
            amsl: Amsl(self.amsl_m),
        }
    }
}

impl Shape {
    pub(crate) fn length_m(&self) -> f64 {
        match *self {
            Self::Line { from, to } => from.distance_m(to),
            Self::Arc {
                radius_m,
                sweep_rad,
                ..
            } => radius_m * sweep_rad.abs(),
        }
    }

    /// The point at a fraction of the length.
    pub(crate) fn at(&self, fraction: f64) -> EastNorth {
        match *self {
            Self::Line { from, to } => mix(from, to, fraction),
            Self::Arc {
                center,
                radius_m,
                start_rad,
                sweep_rad,
            } => {
                let (sin, cos) = (start_rad + sweep_rad * fraction).sin_cos();
                EastNorth {
                    east_m: center.east_m + radius_m * cos,
                    north_m: center.north_m + radius_m * sin,
                }
            }
        }
    }
}

impl Piece {
    pub(crate) fn duration_s(&self) -> f64 {
        2.0 * self.shape.length_m() / (self.speed_mps.0 + self.speed_mps.1)
    }

    /// Acceleration along and across the path together, m/s^2.
    pub(crate) fn acceleration_mps2(&self) -> f64 {
        let along = (self.speed_mps.1 - self.speed_mps.0).abs() / self.duration_s();
        match self.shape {
            Shape::Line { .. } => along,
            Shape::Arc { radius_m, .. } => {
                let fastest = self.speed_mps.0.max(self.speed_mps.1);
                along + fastest * fastest / radius_m
            }
        }
    }

    /// The fraction of the length covered after a fraction of the duration.
    pub(crate) fn covered(&self, time_fraction: f64) -> f64 {
        let (from, to) = self.speed_mps;
        time_fraction * (2.0 * from + (to - from) * time_fraction) / (from + to)
    }
}

/// The flight along knots at a ground speed on each leg, with given speeds at the first knot
/// and the last (0 at rest); legs are longer than 0.
pub(crate) fn run(
    knots: &[Knot],
    vehicle: &Vehicle,
    grounds_mps: &[f64],
    ends_mps: (f64, f64),
) -> Run {
    let legs: Vec<f64> = knots
        .windows(2)
        .map(|pair| pair[0].at.distance_m(pair[1].at))
        .collect();
    let law = vehicle.facts().corners;
    let law = law.map(|law| Cornering::new(law, vehicle.accel_mps2));
    let grounds_mps = cruise_speeds(grounds_mps, &legs, law);
    let mut corners = corners(knots, vehicle, law, &grounds_mps);
    let rooms = fit(&mut corners, &legs);
    let passing = passing_speeds((&grounds_mps, law), &legs, &corners, vehicle, ends_mps);
    let mut found = Run {
        pieces: Vec::new(),
        rooms,
        peak_mps: Vec::with_capacity(legs.len()),
    };
    for (leg, &length_m) in legs.iter().enumerate() {
        let (before_m, after_m) = (corners[leg].taken_m, corners[leg + 1].taken_m);
        let stretch = (before_m, length_m - after_m);
        let speeds = (passing[leg].1, passing[leg + 1].0);
        let line = Line {
            leg,
            from: knots[leg].at,
            to: knots[leg + 1].at,
            length_m,
        };
        let cruise_mps = grounds_mps[leg];
        found.peak_mps.push(line.cruise(
            stretch,
            speeds,
            cruise_mps,
            vehicle.accel_mps2,
            &mut found.pieces,
        ));
        if let Some(after) = knots.get(leg + 2) {
            let share = (1.0 - after_m / length_m, after_m / legs[leg + 1]);
            let corner = (knots[leg].at, knots[leg + 1].at, after.at);
            if let Some(shape) = arc(corner, &corners[leg + 1]) {
                let flown = law.zip(corners[leg + 1].turn);
                let is_slowed = flown.is_some_and(|(law, turn)| law.takes_time(&turn));
                found.pieces.push(Piece {
                    leg,
                    shape,
                    speed_mps: passing[leg + 1],
                    fraction: share,
                    wide_m: corners[leg + 1].cut_m(),
                    late_s: if is_slowed {
                        corner_late_s(vehicle)
                    } else {
                        0.0
                    },
                });
            }
        }
    }
    found
}

/// The highest speed on each leg, m/s. Legs without corners are as fast as the acceleration allows.
fn cruise_speeds(grounds_mps: &[f64], legs: &[f64], law: Option<Cornering>) -> Vec<f64> {
    let pairs = grounds_mps.iter().zip(legs);
    match law {
        Some(law) if legs.len() > 1 => pairs
            .map(|(&speed_mps, &length_m)| law.cruise_mps(length_m, speed_mps))
            .collect(),
        _ => grounds_mps.to_vec(),
    }
}

impl Corner {
    /// How far the arc of a copter is from the waypoint, metres.
    fn cut_m(&self) -> f64 {
        let half_rad = (0.5 * self.turn_rad.abs()).min(89.9_f64.to_radians());
        self.turn
            .map_or(0.0, |_| self.taken_m * (0.5 * half_rad).tan())
    }
}

/// A corner at every knot; none at the ends.
fn corners(
    knots: &[Knot],
    vehicle: &Vehicle,
    law: Option<Cornering>,
    grounds_mps: &[f64],
) -> Vec<Corner> {
    let none = Corner {
        turn_rad: 0.0,
        required_m: 0.0,
        taken_m: 0.0,
        turn: None,
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
        let required_m = turn_radius_m(vehicle, speed_mps, at) * half_rad.tan();
        let turn = law.map(|_| Turn {
            angle_rad: turn_rad.abs(),
            speed_mps: grounds_mps[index].min(grounds_mps[index + 1]),
            radius_m: trio[1].accept_m,
        });
        let flown_m = law.zip(turn).map(|(law, turn)| law.taken_m(&turn));
        corners[index + 1] = Corner {
            turn_rad,
            required_m,
            taken_m: flown_m.unwrap_or(required_m),
            turn,
        };
    }
    corners
}

/// Shrinks fillets that do not fit, and says what each leg has left.
fn fit(corners: &mut [Corner], legs: &[f64]) -> Vec<Room> {
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

/// The speeds with which each corner is entered and left: no faster than its legs, and what
/// the acceleration allows. The wind carries a wing from one ground speed to the other in the
/// turn itself; anything else passes a corner at the slower one, or more slowly as its autopilot does.
fn passing_speeds(
    (grounds_mps, law): (&[f64], Option<Cornering>),
    legs: &[f64],
    corners: &[Corner],
    vehicle: &Vehicle,
    ends_mps: (f64, f64),
) -> Vec<(f64, f64)> {
    let is_carried = vehicle.carried_by().is_some();
    let mut speeds = vec![(ends_mps.0, ends_mps.0)];
    speeds.extend(
        grounds_mps
            .windows(2)
            .zip(&corners[1..])
            .map(|(pair, corner)| {
                let flown = law.zip(corner.turn);
                let slower = flown.map_or(pair[0].min(pair[1]), |(law, turn)| {
                    law.arc_mps(&turn, corner.taken_m)
                });
                if is_carried {
                    (pair[0], pair[1])
                } else {
                    (slower, slower)
                }
            }),
    );
    speeds.push((ends_mps.1, ends_mps.1));
    let straight_m = |leg: usize| legs[leg] - corners[leg].taken_m - corners[leg + 1].taken_m;
    let reach = |speed: f64, leg: usize| {
        (speed * speed + 2.0 * vehicle.accel_mps2 * straight_m(leg)).sqrt()
    };
    // Who enters a corner more slowly leaves it no faster, and the other way round.
    for leg in 0..legs.len() {
        let most = reach(speeds[leg].1, leg);
        if speeds[leg + 1].0 > most {
            speeds[leg + 1] = (most, speeds[leg + 1].1.min(most));
        }
    }
    for leg in (0..legs.len()).rev() {
        let most = reach(speeds[leg + 1].0, leg);
        if speeds[leg].1 > most {
            speeds[leg] = (speeds[leg].0.min(most), most);
        }
    }
    speeds
}

/// The circle that rounds a corner, if there is one to round.
fn arc(knots: (EastNorth, EastNorth, EastNorth), corner: &Corner) -> Option<Shape> {
    const LEAST_TURN_RAD: f64 = 1e-6;
    let half_rad = 0.5 * corner.turn_rad.abs();
    let radius_m = corner.taken_m / half_rad.min(89.9_f64.to_radians()).tan();
    if half_rad < LEAST_TURN_RAD || radius_m <= 0.0 {
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

/// One leg, for cutting pieces off it.
struct Line {
    leg: usize,
    from: EastNorth,
    to: EastNorth,
    length_m: f64,
}

impl Line {
    /// Pieces from one distance along the leg to another: speed up, cruise, slow
    /// down, as far as there is room. Returns the highest speed, m/s.
    fn cruise(
        &self,
        (start_m, end_m): (f64, f64),
        (from_mps, to_mps): (f64, f64),
        cruise_mps: f64,
        accel_mps2: f64,
        pieces: &mut Vec<Piece>,
    ) -> f64 {
        let length_m = end_m - start_m;
        let squares = 0.5 * (from_mps * from_mps + to_mps * to_mps);
        let peak_mps = cruise_mps
            .min((accel_mps2 * length_m + squares).sqrt())
            .max(from_mps)
            .max(to_mps);
        let ramp_m = |speed: f64| (peak_mps * peak_mps - speed * speed) / (2.0 * accel_mps2);
        let up_m = (start_m + ramp_m(from_mps)).min(end_m);
        let down_m = (end_m - ramp_m(to_mps)).max(up_m);
        let mut cut = |a_m: f64, b_m: f64, speed_mps: (f64, f64)| {
            // Lengths within rounding are no pieces.
            if b_m - a_m > 1e-9 {
                let fraction = (a_m / self.length_m, b_m / self.length_m);
                pieces.push(Piece {
                    leg: self.leg,
                    shape: Shape::Line {
                        from: mix(self.from, self.to, fraction.0),
                        to: mix(self.from, self.to, fraction.1),
                    },
                    speed_mps,
                    fraction,
                    wide_m: 0.0,
                    late_s: 0.0,
                });
            }
        };
        cut(start_m, up_m, (from_mps, peak_mps));
        cut(up_m, down_m, (peak_mps, peak_mps));
        cut(down_m, end_m, (peak_mps, to_mps));
        peak_mps
    }
}

fn mix(from: EastNorth, to: EastNorth, fraction: f64) -> EastNorth {
    EastNorth {
        east_m: from.east_m + (to.east_m - from.east_m) * fraction,
        north_m: from.north_m + (to.north_m - from.north_m) * fraction,
    }
}
