//! What a wider fence must stay clear of: the path of a vehicle, its pads, its way back.

use crate::geodesy::{LatLon, LocalFrame, bend_m};
use crate::numeric::geometry::cover::{
    distance_between, distance_to_segment, enclosing_circle, is_inside,
};
use crate::numeric::geometry::{Point, distance, point_segment_distance};

/// Corners of the polygon that stands for a circle.
const CIRCLE_CORNERS: u32 = 24;
/// A circle is wider than what it covers by this, metres: its radius is float32, its place 1e-7 degrees.
const ROUNDING_M: f64 = 0.2;

/// A boundary in the plane.
#[derive(Clone, Debug)]
pub(super) enum Shape {
    Circle(Point, f64),
    /// Counter-clockwise.
    Polygon(Vec<Point>),
}

impl Shape {
    /// Fence items that it needs.
    pub(super) fn items(&self) -> usize {
        match self {
            Self::Circle(..) => 1,
            Self::Polygon(corners) => corners.len(),
        }
    }

    /// Corners whose hull holds it.
    pub(super) fn corners(&self) -> Vec<Point> {
        match self {
            Self::Polygon(corners) => corners.clone(),
            Self::Circle(center, radius) => {
                let step = std::f64::consts::TAU / f64::from(CIRCLE_CORNERS);
                let reach = radius / (0.5 * step).cos();
                (0..CIRCLE_CORNERS)
                    .map(|corner| {
                        let (sin, cos) = (f64::from(corner) * step).sin_cos();
                        [center[0] + reach * cos, center[1] + reach * sin]
                    })
                    .collect()
            }
        }
    }

    fn to_segment(&self, (a, b): (Point, Point)) -> f64 {
        match self {
            Self::Circle(center, radius) => {
                (point_segment_distance(*center, a, b) - radius).max(0.0)
            }
            Self::Polygon(corners) => distance_to_segment(corners, (a, b)),
        }
    }

    fn to_triangle(&self, triangle: &[Point; 3]) -> f64 {
        match self {
            Self::Circle(center, _) if is_inside(triangle, *center) => 0.0,
            Self::Circle(..) => {
                let [a, b, c] = *triangle;
                let sides = [(a, b), (b, c), (c, a)].map(|side| self.to_segment(side));
                sides.into_iter().fold(f64::INFINITY, f64::min)
            }
            Self::Polygon(corners) => distance_between(corners, triangle),
        }
    }
}

/// A plane in which straight lines of latitude and longitude are straight, metres; distances are
/// as good as [`Plane::stretch`] says.
#[derive(Clone, Debug)]
pub(super) struct Plane {
    origin: LatLon,
    /// Metres of a degree east and north.
    scale: Point,
    /// Greatest relative error of a distance.
    error: f64,
    /// Latitude furthest from the equator, degrees.
    steepest_deg: f64,
}

impl Plane {
    /// The plane around the middle of an area from one corner to the other.
    pub(super) fn new(south_west: LatLon, north_east: LatLon) -> Self {
        const STEP_DEG: f64 = 0.01;
        let middle = |a: f64, b: f64| 0.5 * (a + b);
        let origin = LatLon {
            lat_deg: middle(south_west.lat_deg, north_east.lat_deg),
            lon_deg: middle(south_west.lon_deg, north_east.lon_deg),
        };
        let frame = LocalFrame::new(origin);
        let moved = |north: f64, east: f64| LatLon {
            lat_deg: origin.lat_deg + north,
            lon_deg: origin.lon_deg + east,
        };
        let north_m = frame.to_plan(moved(STEP_DEG, 0.0)).north_m;
        let east_m = frame.to_plan(moved(0.0, STEP_DEG)).east_m;
        let half_rad = 0.5 * (north_east.lat_deg - south_west.lat_deg).to_radians();
        let steepest = origin.lat_deg.abs().to_radians() + half_rad;
        Self {
            origin,
            scale: [east_m / STEP_DEG, north_m / STEP_DEG],
            // How much the length of a degree of longitude changes towards the edges.
            error: 1e-3 + half_rad * steepest.min(1.5).tan(),
            steepest_deg: steepest.to_degrees(),
        }
    }

    pub(super) fn flat(&self, place: LatLon) -> Point {
        [
            (place.lon_deg - self.origin.lon_deg) * self.scale[0],
            (place.lat_deg - self.origin.lat_deg) * self.scale[1],
        ]
    }

    pub(super) fn place(&self, at: Point) -> LatLon {
        LatLon {
            lat_deg: self.origin.lat_deg + at[1] / self.scale[1],
            lon_deg: self.origin.lon_deg + at[0] / self.scale[0],
        }
    }

    /// A distance that is at least a true one of this length, metres.
    pub(super) fn at_least_m(&self, true_m: f64) -> f64 {
        true_m * (1.0 + self.error)
    }

    /// How far the straight line on the earth leaves one of this plane, metres.
    pub(super) fn bend_m(&self, length_m: f64) -> f64 {
        bend_m(self.at_least_m(length_m), self.steepest_deg)
    }

    /// A disc that holds a circle of the earth, whatever the scale at its latitude.
    pub(super) fn disc(&self, center: LatLon, radius_m: f64) -> Shape {
        Shape::Circle(self.flat(center), self.at_least_m(radius_m))
    }

    /// A circle around corners, over the earth.
    pub(super) fn circle(&self, corners: &[Point]) -> Shape {
        let (center, radius) = enclosing_circle(corners);
        Shape::Circle(center, self.at_least_m(radius) + ROUNDING_M)
    }
}

/// Where one vehicle flies, and may fly back.
#[derive(Clone, Debug)]
pub(super) struct Clear {
    legs: Vec<(Point, Point)>,
    /// Straight ways back to home from everywhere on a leg.
    returns: Vec<[Point; 3]>,
    /// Distance that a wider shape keeps from legs, metres.
    keep_m: f64,
    /// How far legs and ways back leave the lines of the plane, metres.
    pub(super) bend_m: f64,
}

impl Clear {
    /// `route` in order of flight, from home on; `pads` apart from them.
    pub(super) fn new(route: &[Point], pads: &[Point], plane: &Plane, keep_m: f64) -> Self {
        let mut legs: Vec<(Point, Point)> = pads.iter().map(|&pad| (pad, pad)).collect();
        legs.extend(route.windows(2).map(|pair| (pair[0], pair[1])));
        let home = route.first().copied().unwrap_or_default();
        let longest = |lines: &mut dyn Iterator<Item = (Point, Point)>| {
            lines.fold(0.0, |most, (a, b)| distance(a, b).max(most))
        };
        let leg_m = longest(&mut legs.iter().copied());
        let back_m = longest(&mut route.iter().map(|&at| (at, home)));
        let is_leg = |pair: &&[Point]| distance(pair[0], pair[1]) > 0.0;
        let returns = route.windows(2).filter(is_leg);
        Self {
            returns: returns.map(|pair| [home, pair[0], pair[1]]).collect(),
            legs,
            keep_m: keep_m + plane.bend_m(leg_m),
            bend_m: plane.bend_m(leg_m.max(back_m)),
        }
    }

    /// Least distance of a shape to legs and pads, metres.
    fn to_path_m(&self, shape: &Shape) -> f64 {
        let gaps = self.legs.iter().map(|leg| shape.to_segment(*leg));
        gaps.fold(f64::INFINITY, f64::min)
    }

    /// Least distance of a shape to the ways back, metres.
    fn to_returns_m(&self, shape: &Shape) -> f64 {
        let gaps = self.returns.iter().map(|back| shape.to_triangle(back));
        gaps.fold(f64::INFINITY, f64::min)
    }

    /// Least distances of a shape to legs and pads or to a way back, and to a way back, metres.
    pub(super) fn distances_m(&self, shape: &Shape) -> (f64, f64) {
        let back_m = self.to_returns_m(shape);
        (self.to_path_m(shape).min(back_m), back_m)
    }

    /// Whether a wider shape may be there, for what is `back_m` from the ways back.
    pub(super) fn allows(&self, shape: &Shape, back_m: f64) -> bool {
        self.to_path_m(shape) >= self.keep_m
            && (back_m <= 0.0 || self.to_returns_m(shape) >= self.keep_m.min(back_m))
    }
}

#[cfg(test)]
mod tests {
    use super::{LocalFrame, Plane};
    use crate::geodesy::LatLon;

    /// A degree of longitude is 1.1 % shorter at the northern edge than in the middle, and as much
    /// longer at the southern one.
    #[test]
    fn what_stands_for_a_circle_holds_it_also_at_the_edge_of_a_tall_area() {
        let at = |lat_deg: f64, lon_deg: f64| LatLon { lat_deg, lon_deg };
        let plane = Plane::new(at(46.6, 7.8), at(47.8, 9.2));
        for center in [at(46.6, 8.0), at(47.2, 8.5), at(47.8, 9.0)] {
            let frame = LocalFrame::new(center);
            let corners = plane.disc(center, 700.0).corners();
            for (a, b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
                let middle = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
                let away = frame.to_plan(plane.place(middle));
                let away_m = away.east_m.hypot(away.north_m);
                assert!((700.0..721.0).contains(&away_m), "{center:?}: {away_m}");
            }
        }
    }
}
