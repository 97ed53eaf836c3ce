//! Distances from stretches of a flight to polygons and circles on the earth.
//!
//! Edges of a polygon are straight in latitude and longitude, as the fences of
//! both autopilots take them (the parallel of an area 25 km wide leaves the
//! straight line of a tangent plane by 9 m). Distances are measured with the
//! scale of the latitude where the flight is.

use crate::geodesy::{EastNorth, LatLon, LocalFrame, on_earth_m};
use crate::spec::Zone;

use super::segment::{Segment, Stretch};

/// Metres in a degree of latitude and of longitude, WGS84 (series in the NGA handbook, to a centimetre).
pub(crate) fn metres_per_degree(lat_deg: f64) -> (f64, f64) {
    let lat = lat_deg.to_radians();
    let north = 111_132.92 - 559.82 * (2.0 * lat).cos() + 1.175 * (4.0 * lat).cos()
        - 0.0023 * (6.0 * lat).cos();
    let east = 111_412.84 * lat.cos() - 93.5 * (3.0 * lat).cos() + 0.118 * (5.0 * lat).cos();
    (north, east)
}

/// On which side of a boundary the flight belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Keep {
    Inside,
    Outside,
}

/// A polygon, perhaps with holes; the last corner of each ring joins the first.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Outline {
    rings: Vec<Vec<LatLon>>,
    /// Least and greatest latitude and longitude, degrees; the longitude counts on across the date line.
    low: LatLon,
    high: LatLon,
}

/// Where a stretch runs, for bounds: made once, held against many polygons.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StretchBox {
    from: LatLon,
    /// Half of its way, metres east and north.
    half: Flat,
    /// Unit vector across it; zero for a point.
    across: Flat,
    /// Metres in a degree of latitude and of longitude, as the stretch measures polygons.
    per_degree_m: (f64, f64),
}

impl StretchBox {
    pub(crate) fn around(stretch: &Stretch) -> Self {
        let (from, to) = (stretch.from, stretch.to);
        let (north_m, east_m) = metres_per_degree(0.5 * (from.lat_deg + to.lat_deg));
        let half = (
            0.5 * short_way_deg(from, to) * east_m,
            0.5 * (to.lat_deg - from.lat_deg) * north_m,
        );
        let length_m = half.0.hypot(half.1);
        Self {
            from,
            half,
            across: match length_m > 0.0 {
                true => (-half.1 / length_m, half.0 / length_m),
                false => (0.0, 0.0),
            },
            per_degree_m: (north_m, east_m),
        }
    }
}

/// A straight part of a flight, or of a way back from it.
pub(crate) struct Part<'a> {
    pub(crate) segment: &'a Segment,
    pub(crate) stretch: Stretch,
    pub(crate) around: StretchBox,
    /// What is flown may be nearer to anything by so much, metres.
    pub(crate) slack_m: f64,
}

impl<'a> Part<'a> {
    pub(crate) fn new(segment: &'a Segment, stretch: Stretch, slack_m: f64) -> Self {
        Self {
            segment,
            around: StretchBox::around(&stretch),
            stretch,
            slack_m,
        }
    }
}

/// A bound is less than a distance by so much: more than what both lose by rounding, metres.
const ROUNDING_M: f64 = 1e-6;

/// Degrees of longitude from a place to another, the short way round the date line.
fn short_way_deg(from: LatLon, to: LatLon) -> f64 {
    let turned_deg = to.lon_deg - from.lon_deg + 540.0;
    // The same remainder to the last bit, and sooner.
    if (360.0..720.0).contains(&turned_deg) {
        return turned_deg - 360.0 - 180.0;
    }
    turned_deg.rem_euclid(360.0) - 180.0
}

/// The shape of a zone: a circle is measured as one.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ZoneShape {
    outline: Outline,
    circle: Option<Cylinder>,
}

impl ZoneShape {
    pub(crate) fn new(zone: &Zone) -> Self {
        Self {
            outline: Outline::with_holes(zone.polygon.clone(), &zone.holes),
            circle: zone
                .circle
                .map(|(center, radius_m)| Cylinder::new(center, radius_m)),
        }
    }

    /// At least so far is a stretch from the zone, metres: a cheap bound by boxes.
    pub(crate) fn bound_m(&self, around: &StretchBox) -> f64 {
        self.outline.bound_m(around)
    }

    /// The least distance of a stretch outside, negative inside, metres; and the fraction of
    /// the stretch where that is.
    pub(crate) fn margin_m(&self, stretch: &Stretch) -> (f64, f64) {
        match &self.circle {
            Some(circle) => circle.margin_m(stretch, Keep::Outside),
            None => self.outline.margin_m(stretch, Keep::Outside),
        }
    }
}

/// A vertical cylinder, measured in the frame of its own axis.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Cylinder {
    frame: LocalFrame,
    radius_m: f64,
}

/// A point or vector in metres east and north.
type Flat = (f64, f64);

impl Cylinder {
    pub(crate) fn new(axis: LatLon, radius_m: f64) -> Self {
        Self {
            frame: LocalFrame::new(axis),
            radius_m,
        }
    }

    /// The least distance on the right side of the boundary, negative on the
    /// wrong side, metres; and the fraction of the stretch where that is.
    pub(crate) fn margin_m(&self, stretch: &Stretch, keep: Keep) -> (f64, f64) {
        let flat = |place: LatLon| {
            let EastNorth { east_m, north_m } = self.frame.to_plan(place);
            (east_m, north_m)
        };
        let (from, to) = (flat(stretch.from), flat(stretch.to));
        match keep {
            Keep::Outside => {
                let ((east_m, north_m), w) = nearest((0.0, 0.0), from, to);
                (east_m.hypot(north_m) - self.radius_m, w)
            }
            Keep::Inside => {
                // Places of the tangent plane are nearer than they are on the earth.
                let [a, b] = [from, to].map(|(east_m, north_m)| on_earth_m(east_m.hypot(north_m)));
                let (distance_m, w) = if a >= b { (a, 0.0) } else { (b, 1.0) };
                (self.radius_m - distance_m, w)
            }
        }
    }
}

impl Outline {
    pub(crate) fn new(corners: Vec<LatLon>) -> Self {
        // Beyond 180 degrees where corners are on both sides of the date line.
        let first = corners.first().copied();
        let whole = |corner: &LatLon| LatLon {
            lon_deg: first.map_or(0.0, |first| first.lon_deg + short_way_deg(first, *corner)),
            ..*corner
        };
        let of = |pick: fn(f64, f64) -> f64, start: f64| {
            let corners = corners.iter().map(whole);
            corners.fold(
                LatLon {
                    lat_deg: start,
                    lon_deg: start,
                },
                |known, corner| LatLon {
                    lat_deg: pick(known.lat_deg, corner.lat_deg),
                    lon_deg: pick(known.lon_deg, corner.lon_deg),
                },
            )
        };
        Self {
            low: of(f64::min, f64::INFINITY),
            high: of(f64::max, f64::NEG_INFINITY),
            rings: vec![corners],
        }
    }

    /// The polygon without what lies in any of its holes.
    fn with_holes(corners: Vec<LatLon>, holes: &[Vec<LatLon>]) -> Self {
        let mut outline = Self::new(corners);
        outline.rings.extend_from_slice(holes);
        outline
    }

    /// At least so far is a stretch from the polygon, metres: the box of the polygon against that of
    /// the stretch, and against its line.
    pub(crate) fn bound_m(&self, around: &StretchBox) -> f64 {
        let (north_m, east_m) = around.per_degree_m;
        let middle = LatLon {
            lat_deg: 0.5 * (self.low.lat_deg + self.high.lat_deg),
            lon_deg: 0.5 * (self.low.lon_deg + self.high.lon_deg),
        };
        let half = (
            0.5 * (self.high.lon_deg - self.low.lon_deg) * east_m,
            0.5 * (self.high.lat_deg - self.low.lat_deg) * north_m,
        );
        // From the middle of the stretch.
        let away = (
            short_way_deg(around.from, middle) * east_m - around.half.0,
            (middle.lat_deg - around.from.lat_deg) * north_m - around.half.1,
        );
        let gap = (
            (away.0.abs() - half.0 - around.half.0.abs()).max(0.0),
            (away.1.abs() - half.1 - around.half.1.abs()).max(0.0),
        );
        let of_line = |(east, north): Flat| east * around.across.0 + north * around.across.1;
        let reach_m = half.0 * around.across.0.abs() + half.1 * around.across.1.abs();
        (gap.0 * gap.0 + gap.1 * gap.1)
            .sqrt()
            .max(of_line(away).abs() - reach_m)
            - ROUNDING_M
    }

    /// The least distance on the right side of the boundary, negative on the
    /// wrong side, metres; and the fraction of the stretch where that is.
    ///
    /// The sign is exact; how deep a stretch is on the wrong side is sampled.
    pub(crate) fn margin_m(&self, stretch: &Stretch, keep: Keep) -> (f64, f64) {
        const SAMPLES: u32 = 8;
        let view = View::new(self, stretch);
        let mut worst = (f64::INFINITY, 0.0);
        for pair in view.crossings().windows(2) {
            let (w0, w1) = (pair[0], pair[1]);
            let inside = view.contains(view.at(0.5 * (w0 + w1)));
            if inside == (keep == Keep::Inside) {
                continue;
            }
            for sample in 0..=SAMPLES {
                let w = w0 + (w1 - w0) * f64::from(sample) / f64::from(SAMPLES);
                let deep_m = view.boundary_m(view.at(w));
                if -deep_m < worst.0 {
                    worst = (-deep_m, w);
                }
            }
        }
        if worst.0.is_finite() {
            return worst;
        }
        view.nearest_edge()
    }
}

/// A polygon in metres around the start of a stretch, and the stretch itself.
struct View {
    rings: Vec<Vec<Flat>>,
    end: Flat,
}

impl View {
    fn new(outline: &Outline, stretch: &Stretch) -> Self {
        let middle_deg = 0.5 * (stretch.from.lat_deg + stretch.to.lat_deg);
        let (north, east) = metres_per_degree(middle_deg);
        let flat = |place: &LatLon| {
            let away_deg = short_way_deg(stretch.from, *place);
            (
                away_deg * east,
                (place.lat_deg - stretch.from.lat_deg) * north,
            )
        };
        Self {
            rings: (outline.rings.iter())
                .map(|ring| ring.iter().map(flat).collect())
                .collect(),
            end: flat(&stretch.to),
        }
    }

    fn at(&self, w: f64) -> Flat {
        (self.end.0 * w, self.end.1 * w)
    }

    fn edges(&self) -> impl Iterator<Item = (Flat, Flat)> + '_ {
        self.rings.iter().flat_map(|ring| {
            let next = ring.iter().cycle().skip(1);
            ring.iter().copied().zip(next.copied())
        })
    }

    /// 0, 1 and where the stretch crosses edges, in order.
    fn crossings(&self) -> Vec<f64> {
        let mut cuts = vec![0.0, 1.0];
        for (a, b) in self.edges() {
            let edge = (b.0 - a.0, b.1 - a.1);
            let across = cross(self.end, edge);
            // Parallel edges are crossed at their ends, by the adjacent edges.
            if across.abs() > 0.0 {
                let w = cross(a, edge) / across;
                let v = cross(a, self.end) / across;
                if w > 0.0 && w < 1.0 && (0.0..=1.0).contains(&v) {
                    cuts.push(w);
                }
            }
        }
        cuts.sort_by(f64::total_cmp);
        cuts.dedup();
        cuts
    }

    /// Even-odd rule.
    fn contains(&self, at: Flat) -> bool {
        self.edges().fold(false, |inside, (a, b)| {
            let spans = (a.1 > at.1) != (b.1 > at.1);
            let left = spans && at.0 < a.0 + (b.0 - a.0) * (at.1 - a.1) / (b.1 - a.1);
            inside != left
        })
    }

    fn boundary_m(&self, at: Flat) -> f64 {
        self.edges()
            .map(|(a, b)| nearest(at, a, b).0)
            .map(|(east_m, north_m)| east_m.hypot(north_m))
            .fold(f64::INFINITY, f64::min)
    }

    /// The least distance from the stretch to an edge: at an end of one of the two.
    fn nearest_edge(&self) -> (f64, f64) {
        let start = (0.0, 0.0);
        let mut least = (f64::INFINITY, (f64::INFINITY, 0.0), 0.0);
        let mut offer = |away: Flat, w: f64| {
            let square = square(away);
            if square < least.0 || square.is_nan() {
                least = (square, away, w);
            }
        };
        for (a, b) in self.edges() {
            offer(nearest(start, a, b).0, 0.0);
            offer(nearest(self.end, a, b).0, 1.0);
            let (away, w) = nearest(a, start, self.end);
            offer(away, w);
        }
        let (_, (east_m, north_m), w) = least;
        (east_m.hypot(north_m), w)
    }
}

fn cross(a: Flat, b: Flat) -> f64 {
    a.0 * b.1 - a.1 * b.0
}

fn square(away: Flat) -> f64 {
    away.0 * away.0 + away.1 * away.1
}

/// The way from the nearest point of a segment to a point, and the fraction of the segment where
/// that is.
fn nearest(point: Flat, from: Flat, to: Flat) -> (Flat, f64) {
    let along = (to.0 - from.0, to.1 - from.1);
    let away = (point.0 - from.0, point.1 - from.1);
    let length_sq = square(along);
    let w = if length_sq > 0.0 {
        ((away.0 * along.0 + away.1 * along.1) / length_sq).clamp(0.0, 1.0)
    } else {
        0.0
    };
    ((away.0 - along.0 * w, away.1 - along.1 * w), w)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::{Cylinder, Keep, LatLon, Outline, Stretch, StretchBox};

    fn place(lat_deg: f64, lon_deg: f64) -> LatLon {
        LatLon { lat_deg, lon_deg }
    }

    /// A U open to the north, arms 0.01 degrees wide.
    fn horseshoe() -> Outline {
        Outline::new(vec![
            place(36.00, -84.00),
            place(36.00, -83.97),
            place(36.03, -83.97),
            place(36.03, -83.98),
            place(36.01, -83.98),
            place(36.01, -83.99),
            place(36.03, -83.99),
            place(36.03, -84.00),
        ])
    }

    fn margin_m(from: LatLon, to: LatLon, keep: Keep) -> (f64, f64) {
        let stretch = Stretch {
            u: (0.0, 1.0),
            from,
            to,
        };
        horseshoe().margin_m(&stretch, keep)
    }

    #[test]
    fn a_stretch_between_the_arms_is_outside_and_one_across_them_is_not() {
        // The middle of the gap: half of 0.01 degrees of longitude at 36.02 N, 450.8 m (WGS84).
        let (inside_m, _) = margin_m(place(36.025, -83.985), place(36.02, -83.985), Keep::Outside);
        assert!((inside_m - 450.8).abs() < 0.5, "{inside_m}");
        let across = (place(36.02, -84.005), place(36.02, -83.965));
        assert!(margin_m(across.0, across.1, Keep::Outside).0 < -440.0);
        assert!(margin_m(across.0, across.1, Keep::Inside).0 < -440.0);
        // Cutting a corner by a metre is seen, although both ends are outside.
        let (cut_m, w) = margin_m(
            place(35.99999, -83.9701),
            place(36.0001, -83.96999),
            Keep::Outside,
        );
        assert!(cut_m < 0.0 && w > 0.0 && w < 1.0, "{cut_m} at {w}");
    }

    #[test]
    fn a_bound_holds_for_a_polygon_with_corners_on_both_sides_of_the_date_line() {
        let at = |lat_deg: f64, lon_deg: f64| place(lat_deg, lon_deg);
        let west_deg = 179.998_483;
        let corners = vec![at(0.0, west_deg), at(0.0, -179.951_986), at(0.01, west_deg)];
        let outline = Outline::new(corners);
        let (from, to) = (at(0.226_357, west_deg), at(0.0, -179.802_833));
        let stretch = Stretch {
            u: (0.0, 1.0),
            from,
            to,
        };
        let (margin_m, _) = outline.margin_m(&stretch, Keep::Outside);
        let bound_m = outline.bound_m(&StretchBox::around(&stretch));
        assert!(bound_m <= margin_m, "{bound_m} of {margin_m}");
    }

    proptest! {
        #[test]
        fn no_polygon_is_nearer_than_its_bound_on_either_side_of_the_date_line(
            corners in proptest::collection::vec((-0.05..0.05_f64, -0.05..0.05_f64), 3..7),
            (lat, lon) in (-80.0..80.0_f64, prop_oneof![179.8..180.2_f64, -1.0..1.0_f64]),
            ends in [(-0.3..0.3_f64, -0.3..0.3_f64), (-0.3..0.3_f64, -0.3..0.3_f64)],
            shape in 0..4_u8,
        ) {
            let at = |(north, east): (f64, f64)| {
                place(lat + north, (lon + east + 180.0).rem_euclid(360.0) - 180.0)
            };
            let outline = Outline::new(corners.into_iter().map(at).collect());
            let [from, mut to] = ends;
            match shape {
                0 => to = from,
                1 => to.0 = from.0,
                2 => to.1 = from.1,
                _ => {}
            }
            let stretch = Stretch { u: (0.0, 1.0), from: at(from), to: at(to) };
            let (margin_m, _) = outline.margin_m(&stretch, Keep::Outside);
            let bound_m = outline.bound_m(&StretchBox::around(&stretch));
            prop_assert!(margin_m < 0.0 && bound_m <= 0.0 || bound_m <= margin_m, "{bound_m} of {margin_m}");
        }
    }

    #[test]
    fn a_place_outside_of_a_wide_circle_is_not_inside_of_it() {
        // 250,040 m along a meridian, which are 249,976 m in the tangent plane of the middle.
        let circle = Cylinder::new(place(47.1, 8.5), 250_000.0);
        let away = place(49.348_668_9, 8.5);
        let stretch = Stretch {
            u: (0.0, 1.0),
            from: away,
            to: away,
        };
        let (margin_m, _) = circle.margin_m(&stretch, Keep::Inside);
        assert!((-45.0..-38.0).contains(&margin_m), "{margin_m}");
    }

    #[test]
    fn a_stretch_along_the_base_is_inside_by_its_distance_to_the_edge() {
        let (margin_m, _) = margin_m(place(36.005, -83.99), place(36.004, -83.98), Keep::Inside);
        // 0.004 degrees of latitude: 443.9 m (WGS84).
        assert!((margin_m - 443.9).abs() < 0.2, "{margin_m}");
    }
}
