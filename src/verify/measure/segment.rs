//! Straight motions at constant velocity: what every limit is judged on.

use crate::geodesy::{Amsl, EARTH_RADIUS_M, EastNorth, LatLon, LocalFrame, PlanPoint};

use crate::verify::Moment;

/// Part of the flight; the angles of climb and descent hold on the route alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Phase {
    /// From the ground to the start of the planned path.
    Join,
    /// From start to goal.
    Route,
    /// From the goal to the ground.
    Finish,
}

/// A vertical motion, or a stay, that the least height above ground does not hold for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Column {
    /// Its lower end is on the ground.
    Ground,
    /// To and from a place of the spec below that height, where it stays in the air.
    Drop,
}

/// Heights above ground of a vehicle that follows the terrain by a surface of its autopilot, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Followed {
    /// As ordered, at both ends of the segment.
    pub(crate) agl_m: (f64, f64),
    /// The least and the greatest that it may have over the ground of the verdict.
    pub(crate) min_m: f64,
    pub(crate) max_m: f64,
    /// How far its altitude may be off that of the segment.
    pub(crate) off_m: f64,
}

/// A straight motion at constant velocity from one point to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Segment {
    /// Row of the item the vehicle flies to.
    pub(crate) row: usize,
    pub(crate) phase: Phase,
    /// Seconds after T0 at the ends; the end is infinite for a stay.
    pub(crate) from_s: f64,
    pub(crate) to_s: f64,
    pub(crate) from: PlanPoint,
    pub(crate) to: PlanPoint,
    /// The vehicle is never further than this from where the segment has it at the same time, metres.
    pub(crate) error_m: f64,
    /// Greatest distance of the path from the line of the segment, metres; 0 unless it is curved.
    pub(crate) bow_m: f64,
    /// Heights above ground where the vehicle follows the terrain.
    pub(crate) followed: Option<Followed>,
    /// Altitude of the ground from which this segment climbs out, or to which it glides, if it
    /// does, metres: height above ground is judged against that on the way.
    pub(crate) slope_from_m: Option<f64>,
    /// The column that it is part of, if it is judged by what is below that.
    pub(crate) column: Option<Column>,
    /// Where a real vehicle may be further from it than `error_m`, by so much, metres: for the
    /// separation, what is nearer to the ground is judged by unflown segments.
    pub(crate) wide_m: f64,
    /// By how much the vehicle may be late here, for the stops behind it, seconds.
    pub(crate) late_s: f64,
    /// By how much the vehicle may be early here, besides what it may be from its takeoff on, seconds.
    pub(crate) early_s: f64,
    /// Whether it is flown: the ends of a leg at a fillet are judged in space, not in time.
    pub(crate) flown: bool,
}

impl Followed {
    pub(crate) fn is_finite(self) -> bool {
        let (from_m, to_m) = self.agl_m;
        (from_m + to_m + self.min_m + self.max_m + self.off_m).is_finite()
    }
}

impl Segment {
    /// A straight line that is judged in space, not in time.
    pub(crate) fn unflown(
        (row, phase): (usize, Phase),
        (from_s, to_s): (f64, f64),
        (from, to): (PlanPoint, PlanPoint),
    ) -> Self {
        Self {
            row,
            phase,
            from_s,
            to_s,
            from,
            to,
            error_m: 0.0,
            bow_m: 0.0,
            followed: None,
            slope_from_m: None,
            column: None,
            wide_m: 0.0,
            late_s: 0.0,
            early_s: 0.0,
            flown: false,
        }
    }

    /// How far its altitude may be off by the surface that it follows, metres.
    pub(crate) fn off_m(&self) -> f64 {
        self.followed.map_or(0.0, |of| of.off_m)
    }

    /// How far a vehicle may be from it at the same time, for the separation, metres.
    pub(crate) fn reach_m(&self) -> f64 {
        self.error_m + self.wide_m + self.off_m()
    }

    /// The fraction of the segment at a time.
    pub(crate) fn fraction_at(&self, t_s: f64) -> f64 {
        let lasts_s = self.to_s - self.from_s;
        if lasts_s > 0.0 {
            ((t_s - self.from_s) / lasts_s).clamp(0.0, 1.0)
        } else {
            0.0
        }
    }

    /// The point at a fraction of the segment.
    pub(crate) fn at(&self, u: f64) -> PlanPoint {
        let mix = |a: f64, b: f64| a + (b - a) * u;
        PlanPoint::new(
            mix(self.from.at.east_m, self.to.at.east_m),
            mix(self.from.at.north_m, self.to.at.north_m),
            Amsl(mix(self.from.amsl.0, self.to.amsl.0)),
        )
    }

    /// The time at a fraction of the segment, seconds.
    pub(crate) fn time_s(&self, u: f64) -> f64 {
        if u > 0.0 {
            self.from_s + (self.to_s - self.from_s) * u
        } else {
            self.from_s
        }
    }

    /// The fraction of the segment at which it is nearest to a point.
    pub(crate) fn nearest(&self, point: PlanPoint) -> f64 {
        let (from, to) = (self.from, self.to);
        let along = [
            to.at.east_m - from.at.east_m,
            to.at.north_m - from.at.north_m,
            to.amsl.0 - from.amsl.0,
        ];
        let gone = [
            point.at.east_m - from.at.east_m,
            point.at.north_m - from.at.north_m,
            point.amsl.0 - from.amsl.0,
        ];
        let square: f64 = along.iter().map(|part| part * part).sum();
        let dot: f64 = along.iter().zip(gone).map(|(a, b)| a * b).sum();
        if square > 0.0 {
            (dot / square).clamp(0.0, 1.0)
        } else {
            0.0
        }
    }

    /// The moment at a fraction of the segment.
    pub(crate) fn moment(&self, frame: &LocalFrame, u: f64) -> Moment {
        let point = self.at(u);
        Moment {
            place: frame.from_plan(point.at),
            amsl: point.amsl,
            t_s: self.time_s(u),
            item: self.row,
        }
    }
}

/// A stretch is this near to the line of its segment, metres.
pub(crate) const DEVIATION_M: f64 = 1e-3;

/// A stretch of a segment that is straight in latitude and longitude to a millimetre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stretch {
    /// Fractions of the segment at the ends.
    pub(crate) u: (f64, f64),
    pub(crate) from: LatLon,
    pub(crate) to: LatLon,
}

impl Stretch {
    /// The place at a fraction of the stretch.
    pub(crate) fn place(&self, w: f64) -> LatLon {
        let east_deg = self.to.lon_deg - self.from.lon_deg;
        let lon_deg = match east_deg.abs() > 180.0 {
            // The short way round, across the date line.
            true => {
                let lon_deg = self.from.lon_deg + (east_deg - 360.0_f64.copysign(east_deg)) * w;
                (lon_deg + 180.0).rem_euclid(360.0) - 180.0
            }
            false => self.from.lon_deg + east_deg * w,
        };
        LatLon {
            lat_deg: self.from.lat_deg + (self.to.lat_deg - self.from.lat_deg) * w,
            lon_deg,
        }
    }

    /// The fraction of the segment at a fraction of the stretch.
    pub(crate) fn along(&self, w: f64) -> f64 {
        self.u.0 + (self.u.1 - self.u.0) * w
    }
}

/// Splits the straight line from one point of the plane, whose place is known, to
/// another into stretches.
///
/// A straight line of the plane leaves the straight line between the latitudes
/// and longitudes of its ends by at most `L^2 (2 tan(lat) + L0 / R) / (8 R)`,
/// `L0` the distance from the origin.
pub(crate) fn stretches(
    frame: &LocalFrame,
    (from, first): (EastNorth, LatLon),
    to: EastNorth,
) -> Vec<Stretch> {
    let length_m = from.distance_m(to);
    if length_m <= 0.0 {
        return vec![Stretch {
            u: (0.0, 1.0),
            from: first,
            to: first,
        }];
    }
    let tan_lat = first.lat_deg.abs().min(89.0).to_radians().tan();
    let bend = (2.0 * tan_lat + 0.1) / (8.0 * EARTH_RADIUS_M * DEVIATION_M);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to a small positive count"
    )]
    let count = (length_m * bend.sqrt()).ceil().clamp(1.0, 1e5) as u32;
    let mut found = Vec::new();
    let mut last = (0.0, first);
    for index in 1..=count {
        let u = f64::from(index) / f64::from(count);
        let place = frame.from_plan(EastNorth {
            east_m: from.east_m + (to.east_m - from.east_m) * u,
            north_m: from.north_m + (to.north_m - from.north_m) * u,
        });
        found.push(Stretch {
            u: (last.0, u),
            from: last.1,
            to: place,
        });
        last = (u, place);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::{LatLon, Stretch};

    #[test]
    fn a_place_on_a_stretch_across_the_date_line_is_between_its_ends() {
        let at = |lon_deg: f64| LatLon {
            lat_deg: 10.0,
            lon_deg,
        };
        for (from_deg, to_deg, share, lon_deg) in [
            (179.99, -179.99, 0.25, 179.995),
            (179.99, -179.99, 0.75, -179.995),
            (-179.99, 179.99, 0.25, -179.995),
            (99.0, 101.0, 0.5, 100.0),
        ] {
            let stretch = Stretch {
                u: (0.0, 1.0),
                from: at(from_deg),
                to: at(to_deg),
            };
            let found = stretch.place(share);
            assert!((found.lon_deg - lon_deg).abs() < 1e-9, "{found:?}");
        }
    }
}
