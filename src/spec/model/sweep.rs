//! Lines over the ground that a task has flown: surveys, corridors, search patterns.

use crate::geodesy::{Agl, LatLon};
use crate::spec::keys::Pattern;

/// Distances may be longer than an overlap allows by this share: rounding.
const LONGER: f64 = 1.01;

/// Lines that are flown as they are laid out, at a height above the ground.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// What is flown over.
    pub shape: SweepShape,
    /// What sees the ground; none where only the lines count.
    pub sensor: Option<Sensor>,
    /// Least height above the ground on the lines.
    pub agl: Agl,
    /// Speed on the lines, m/s; absent: that of the vehicle.
    pub speed_mps: Option<f64>,
}

/// What lines are laid out over.
#[derive(Clone, Debug, PartialEq)]
pub enum SweepShape {
    /// An area.
    Survey {
        /// Corners.
        polygon: Vec<LatLon>,
        /// Parts that need not be seen.
        holes: Vec<Vec<LatLon>>,
        /// Direction of the lines, radians clockwise from north; absent: the cheapest one.
        heading_rad: Option<f64>,
    },
    /// A strip along a line.
    Corridor {
        /// Corners.
        line: Vec<LatLon>,
        /// Width, metres.
        width_m: f64,
    },
    /// A search pattern.
    Search(SearchPattern),
}

impl SweepShape {
    /// The key of the spec.
    #[must_use]
    pub fn key(&self) -> &'static str {
        match self {
            Self::Survey { .. } => "survey",
            Self::Corridor { .. } => "corridor",
            Self::Search(_) => "search",
        }
    }
}

/// A search pattern, flown by one vehicle from its begin to its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SearchPattern {
    /// Which one.
    pub pattern: Pattern,
    /// Where it begins.
    pub at: LatLon,
    /// Direction of the first leg, radians clockwise from north.
    pub heading_rad: f64,
    /// Length of the first leg, metres.
    pub leg_m: f64,
    /// Number of legs.
    pub legs: u32,
    /// Distance between parallel tracks, metres.
    pub spacing_m: f64,
}

/// What sees the ground, straight down. Overlaps are shares.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensor {
    /// Half of the angle of view across the line, as its tangent.
    pub across: f64,
    /// The same along the line, and the overlap of pictures there; none for a sensor that sees all
    /// the time.
    pub along: Option<(f64, f64)>,
    /// Overlap of neighbouring lines.
    pub side_overlap: f64,
}

impl Sensor {
    /// How many lines see a place that has the side overlap that is asked for.
    #[must_use]
    pub fn lines(&self) -> u32 {
        times(self.side_overlap)
    }

    /// How many pictures of each of these lines show it.
    #[must_use]
    pub fn pictures(&self) -> u32 {
        self.along.map_or(1, |(_, overlap)| times(overlap))
    }

    /// How far apart neighbouring lines at a height may be, metres: as the side overlap says, and a
    /// little more for rounding.
    #[must_use]
    pub fn lines_apart_m(&self, above_m: f64) -> f64 {
        self.swath_m(above_m) * (1.0 - self.side_overlap) * LONGER
    }

    /// The same of pictures on a line; none for a sensor that sees all the time.
    #[must_use]
    pub fn pictures_apart_m(&self, above_m: f64) -> Option<f64> {
        let (_, overlap) = self.along?;
        Some(self.picture_m(above_m)? * (1.0 - overlap) * LONGER)
    }

    /// Width that is seen from a height, metres.
    #[must_use]
    pub fn swath_m(&self, above_m: f64) -> f64 {
        2.0 * self.across * above_m
    }

    /// Length of a picture from a height, metres; none for a sensor that sees all the time.
    #[must_use]
    pub fn picture_m(&self, above_m: f64) -> Option<f64> {
        self.along.map(|(tangent, _)| 2.0 * tangent * above_m)
    }
}

/// How often a place is seen at least where each sight overlaps the one before by a share.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "overlaps are at most 0.95"
)]
fn times(overlap: f64) -> u32 {
    (1.0 / (1.0 - overlap) + 1e-9).floor().clamp(1.0, 1000.0) as u32
}

impl SearchPattern {
    /// Its corners in order, east and north of where it begins, metres: one more than legs.
    #[must_use]
    pub fn corners(&self) -> Vec<[f64; 2]> {
        let mut at = [0.0, 0.0];
        let mut corners = vec![at];
        for leg in 0..self.legs {
            let (course_rad, length_m) = self.leg(leg);
            at = [
                at[0] + length_m * course_rad.sin(),
                at[1] + length_m * course_rad.cos(),
            ];
            corners.push(at);
        }
        corners
    }

    /// Course and length of a leg.
    fn leg(&self, leg: u32) -> (f64, f64) {
        let right = |turns: u32, deg: f64| self.heading_rad + f64::from(turns) * deg.to_radians();
        match self.pattern {
            Pattern::ExpandingSquare => (right(leg % 4, 90.0), self.leg_m * f64::from(leg / 2 + 1)),
            // The third leg of a triangle and the first of the next have one course.
            Pattern::Sector => {
                let (triangle, side) = (leg / 3, leg % 3);
                let turned_rad = f64::from(triangle / 3) * 30.0_f64.to_radians();
                (right(2 * triangle + side, 120.0) + turned_rad, self.leg_m)
            }
            Pattern::ParallelTrack => match leg % 4 {
                0 => (self.heading_rad, self.leg_m),
                2 => (right(2, 90.0), self.leg_m),
                _ => (right(1, 90.0), self.spacing_m),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corners(pattern: Pattern, legs: u32) -> Vec<[f64; 2]> {
        let search = SearchPattern {
            pattern,
            at: LatLon {
                lat_deg: 0.0,
                lon_deg: 0.0,
            },
            heading_rad: 0.0,
            leg_m: 100.0,
            legs,
            spacing_m: 40.0,
        };
        let rounded = |[east, north]: [f64; 2]| [east.round() + 0.0, north.round() + 0.0];
        search.corners().into_iter().map(rounded).collect()
    }

    #[test]
    #[allow(clippy::float_cmp, reason = "rounded before")]
    fn patterns_are_those_of_the_manual() {
        let square = corners(Pattern::ExpandingSquare, 5);
        let expected = [
            [0.0, 0.0],
            [0.0, 100.0],
            [100.0, 100.0],
            [100.0, -100.0],
            [-100.0, -100.0],
            [-100.0, 200.0],
        ];
        assert_eq!(square, expected);
        let tracks = corners(Pattern::ParallelTrack, 5);
        let expected = [
            [0.0, 0.0],
            [0.0, 100.0],
            [40.0, 100.0],
            [40.0, 0.0],
            [80.0, 0.0],
            [80.0, 100.0],
        ];
        assert_eq!(tracks, expected);
        let sector = corners(Pattern::Sector, 9);
        // Three times back over the datum, and six corners on the circle at 60 degrees.
        for leg in [3, 6, 9] {
            let [east_m, north_m] = sector[leg];
            assert!(east_m.hypot(north_m) < 1e-9);
        }
        let mut around: Vec<f64> = [1, 2, 4, 5, 7, 8]
            .map(|leg: usize| {
                sector[leg][0]
                    .atan2(sector[leg][1])
                    .to_degrees()
                    .rem_euclid(360.0)
                    .round()
            })
            .to_vec();
        around.sort_by(f64::total_cmp);
        assert_eq!(around, [0.0, 60.0, 120.0, 180.0, 240.0, 300.0]);
    }

    #[test]
    fn an_overlap_of_three_quarters_shows_each_place_four_times() {
        for (overlap, expected) in [
            (0.0, 1),
            (0.4, 1),
            (0.5, 2),
            (0.6, 2),
            (0.7, 3),
            (0.75, 4),
            (0.8, 5),
            (0.9, 10),
        ] {
            assert_eq!(times(overlap), expected, "{overlap}");
        }
    }
}
