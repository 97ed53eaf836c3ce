//! Legs between two stops: fillets at the corners, speed along the way.

mod corners;

use crate::autopilot::Cornering;
use crate::geodesy::{Amsl, EastNorth, PlanPoint};
use crate::path::heading_rad;
use crate::spec::Vehicle;

use super::decode::Unknown;
use crate::verify::measure::segment::Phase;
pub(crate) use corners::turn_radius_at_m;
use corners::{Corner, arc, corners, fit};

/// Two altitudes in whole centimetres make a rise uncertain by this, metres.
pub(crate) const RISE_M: f64 = 0.02;

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
    /// Highest speed on each leg, m/s, however steep it is.
    pub(crate) peak_mps: Vec<f64>,
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
            Self::Line { from, to } => from.toward(to, fraction),
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
    (vehicle, law): (&Vehicle, Option<Cornering>),
    grounds_mps: &[f64],
    ends_mps: (f64, f64),
) -> Run {
    let legs: Vec<f64> = knots
        .windows(2)
        .map(|pair| pair[0].at.distance_m(pair[1].at))
        .collect();
    let commanded_mps = cruise_speeds(grounds_mps, &legs, law);
    let grounds_mps = as_it_climbs(&commanded_mps, knots, vehicle);
    let mut corners = corners(knots, vehicle, law, &grounds_mps);
    let rooms = fit(&mut corners, &legs);
    let passing = passing_speeds(&grounds_mps, &legs, &corners, vehicle, ends_mps);
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
        let pace = Pace {
            from_mps: speeds.0,
            to_mps: speeds.1,
            cruise_mps: grounds_mps[leg],
            accel_mps2: vehicle.accel_mps2,
        };
        line.cruise(stretch, &pace, &mut found.pieces);
        let commanded = Pace {
            cruise_mps: commanded_mps[leg],
            ..pace
        };
        found.peak_mps.push(commanded.peak_mps(stretch));
        if let Some(after) = knots.get(leg + 2) {
            let share = (1.0 - after_m / length_m, after_m / legs[leg + 1]);
            let corner = (knots[leg].at, knots[leg + 1].at, after.at);
            if let Some(shape) = arc(corner, &corners[leg + 1]) {
                found.pieces.push(Piece {
                    leg,
                    shape,
                    speed_mps: passing[leg + 1],
                    fraction: share,
                    wide_m: corners[leg + 1].cut_m(),
                    late_s: corners[leg + 1].late_s(vehicle),
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

/// The highest speed on each leg of a copter that climbs and descends no faster than it can: on a
/// steeper one it is slower along all of it (`AC_WPNav`, `SCurve::calculate_track`; PX4,
/// `PositionSmoothing::_generateVelocitySetpoint`), m/s.
fn as_it_climbs(commanded_mps: &[f64], knots: &[Knot], vehicle: &Vehicle) -> Vec<f64> {
    if vehicle.wing.is_some() {
        return commanded_mps.to_vec();
    }
    let slowed = |(pair, &speed_mps): (&[Knot], &f64)| {
        let rise_m = pair[1].amsl_m - pair[0].amsl_m;
        let rate_mps = match rise_m > 0.0 {
            true => vehicle.climb_mps,
            false => vehicle.descent_mps,
        };
        let run_m = pair[0].at.distance_m(pair[1].at);
        // Over ground that is followed each segment is judged for itself.
        let steep_m = match pair[1].agl_m {
            Some(_) => 0.0,
            None => (rise_m.abs() - RISE_M).max(0.0),
        };
        speed_mps.min(rate_mps * run_m / steep_m)
    };
    knots.windows(2).zip(commanded_mps).map(slowed).collect()
}

/// The speeds with which each corner is entered and left: no faster than its legs, and what
/// the acceleration allows. The wind carries a wing from one ground speed to the other in the
/// turn itself; anything else passes a corner at the slower one, or more slowly as its autopilot does.
fn passing_speeds(
    grounds_mps: &[f64],
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
                let slower = corner.flown.map_or(pair[0].min(pair[1]), |(law, turn)| {
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

/// One leg, for cutting pieces off it.
struct Line {
    leg: usize,
    from: EastNorth,
    to: EastNorth,
    length_m: f64,
}

/// The speeds of a leg at its ends and at most, m/s, and how fast they change.
struct Pace {
    from_mps: f64,
    to_mps: f64,
    cruise_mps: f64,
    accel_mps2: f64,
}

impl Pace {
    /// The highest speed from one distance along the leg to another, m/s.
    fn peak_mps(&self, (start_m, end_m): (f64, f64)) -> f64 {
        let squares = 0.5 * (self.from_mps * self.from_mps + self.to_mps * self.to_mps);
        self.cruise_mps
            .min((self.accel_mps2 * (end_m - start_m) + squares).sqrt())
            .max(self.from_mps)
            .max(self.to_mps)
    }
}

impl Line {
    /// Pieces from one distance along the leg to another: speed up, cruise, slow
    /// down, as far as there is room.
    fn cruise(&self, (start_m, end_m): (f64, f64), pace: &Pace, pieces: &mut Vec<Piece>) {
        let &Pace {
            from_mps,
            to_mps,
            accel_mps2,
            ..
        } = pace;
        let peak_mps = pace.peak_mps((start_m, end_m));
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
                        from: self.from.toward(self.to, fraction.0),
                        to: self.from.toward(self.to, fraction.1),
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
    }
}
