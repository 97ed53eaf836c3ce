//! What a path must not cross: threats, zones, the edge of the area.

mod zone_cells;

use geo::Polygon;

use super::closed_zone::ClosedZone;
use super::piece::plane;
pub(crate) use super::piece::{FORBIDDEN, Piece};
use super::relief::Relief;
use super::{Margins, RouteEnds};
use crate::numeric::geometry::{Point, Ring, disc_chord};
use crate::world::{Disc, PlanZone, World};
use zone_cells::ZoneCells;

/// A threat, widened by its margin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Threat {
    pub(crate) center: Point,
    pub(crate) radius_m: f64,
    pub(crate) radius_sq: f64,
    /// One over the radius, 1/m.
    pub(crate) per_radius: f64,
    /// What is further away than this is outside for certain, whatever rounding does: also
    /// that of a piece of up to a million kilometres.
    pub(crate) reach_m: f64,
    /// The box of all within reach.
    pub(crate) low: Point,
    pub(crate) high: Point,
}

/// The allowed area.
#[derive(Clone, Debug)]
pub(crate) struct Bounds {
    ring: Ring,
    /// A box inside the area: a segment that stays in it needs no closer look.
    pub(crate) low: Point,
    pub(crate) high: Point,
}

/// Everything forbidden that does not move.
#[derive(Clone, Debug)]
pub(crate) struct Hazards {
    pub(crate) threats: Vec<Threat>,
    pub(crate) zones: Vec<ClosedZone>,
    cells: Option<ZoneCells>,
    pub(crate) bounds: Bounds,
    /// What floors and ceilings above ground are measured from.
    pub(crate) relief: Relief,
}

impl Hazards {
    pub(crate) fn new(
        (world, relief): (&World, &Relief),
        route: &RouteEnds,
        margins: &Margins,
    ) -> Self {
        let ends = [plane(route.from), plane(route.to)];
        let widest = |room_m: f64| margins.threat_m.min(room_m).max(0.0);
        let threat = |disc: &Disc| {
            let center = [disc.center.east_m, disc.center.north_m];
            let room_m = ends
                .iter()
                .map(|end| (end[0] - center[0]).hypot(end[1] - center[1]) - disc.radius_m)
                .fold(f64::INFINITY, f64::min);
            Threat::new(center, disc.radius_m + widest(room_m))
        };
        let zone = |zone: &PlanZone| ClosedZone::new(zone, (world, route), margins);
        let zones: Vec<ClosedZone> = world.zones.iter().map(zone).collect();
        Self {
            threats: world.threats.iter().map(threat).collect(),
            cells: ZoneCells::new(&zones),
            zones,
            bounds: Bounds::new(&world.area),
            relief: relief.clone(),
        }
    }
}

impl Hazards {
    /// The boxes around the zones that may meet a box.
    #[inline]
    pub(crate) fn zone_boxes(&self, low: Point, high: Point, mut visit: impl FnMut(Point, Point)) {
        let mut of = |zone: &ClosedZone| {
            let (zone_low, zone_high) = zone.bounds();
            visit(zone_low, zone_high);
        };
        match self
            .cells
            .as_ref()
            .and_then(|cells| cells.in_box(low, high))
        {
            Some(near) => near.for_each(|index| of(&self.zones[index as usize])),
            None => self.zones.iter().for_each(of),
        }
    }

    /// An exposure and what one kilometre of a segment costs for zones and area.
    pub(crate) fn add_polygons(
        &self,
        piece: &Piece,
        mut exposure: f64,
        crossings: &mut Vec<(f64, i32)>,
    ) -> f64 {
        let near = self.cells.as_ref();
        match near.and_then(|cells| cells.near(piece.a, piece.b)) {
            // In the same order, so that the sum is the same.
            Some(near) => {
                for &index in near {
                    exposure += self.zones[index as usize].exposure(piece, &self.relief, crossings);
                }
            }
            None => {
                for zone in &self.zones {
                    exposure += zone.exposure(piece, &self.relief, crossings);
                }
            }
        }
        exposure + self.bounds.exposure(piece, crossings)
    }
}

impl Threat {
    fn new(center: Point, radius_m: f64) -> Self {
        let reach_m = radius_m * (1.0 + 1e-9) + 1e-6;
        Self {
            center,
            radius_m,
            radius_sq: radius_m * radius_m,
            per_radius: 1.0 / radius_m,
            reach_m,
            low: center.map(|middle_m| middle_m - reach_m),
            high: center.map(|middle_m| middle_m + reach_m),
        }
    }

    /// What one kilometre of a segment costs for this threat: exact share of it
    /// inside the disc times (1.1 - closest distance / R).
    #[inline]
    pub(crate) fn exposure(&self, piece: &Piece) -> f64 {
        disc_chord(piece.a, piece.b, self.center, self.radius_m).map_or(0.0, |chord| {
            chord.fraction * (FORBIDDEN - chord.closest * self.per_radius)
        })
    }
}

impl Bounds {
    fn new(area: &Polygon<f64>) -> Self {
        let ring = Ring::around(area);
        let (low, high) = inner_box(&ring).unwrap_or(([1.0, 1.0], [-1.0, -1.0]));
        Self { ring, low, high }
    }

    /// Whether a box lies in the area for certain.
    #[inline]
    pub(crate) fn holds_box(&self, low: Point, high: Point) -> bool {
        self.low[0] <= low[0]
            && high[0] <= self.high[0]
            && self.low[1] <= low[1]
            && high[1] <= self.high[1]
    }

    /// What one kilometre of a segment costs for leaving the area.
    pub(crate) fn exposure(&self, piece: &Piece, crossings: &mut Vec<(f64, i32)>) -> f64 {
        let (a, b) = (piece.a, piece.b);
        let low = [a[0].min(b[0]), a[1].min(b[1])];
        let high = [a[0].max(b[0]), a[1].max(b[1])];
        if self.holds_box(low, high) {
            return 0.0;
        }
        let inside = self.ring.inside_fraction((a, b), (0.0, 1.0), crossings);
        FORBIDDEN * (1.0 - inside).max(0.0)
    }
}

/// A large box inside the ring: its bounding box, shrunk about the middle until no
/// edge reaches in. `None` where the middle is outside or hardly anything is left.
fn inner_box(ring: &Ring) -> Option<(Point, Point)> {
    let (low, high) = ring.bounds();
    let middle = [0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])];
    let shrunk = |share: f64| {
        let corner = |axis: usize, end: f64| middle[axis] + share * (end - middle[axis]);
        (
            [corner(0, low[0]), corner(1, low[1])],
            [corner(0, high[0]), corner(1, high[1])],
        )
    };
    let holds = |share: f64| {
        let (low, high) = shrunk(share);
        !ring.edges().any(|(a, b)| crosses_box(a, b, low, high))
    };
    // Bisection between a box that fits and one that does not.
    let (mut fits, mut too_large) = (0.0, 1.0);
    for _ in 0..20 {
        let share = 0.5 * (fits + too_large);
        if holds(share) {
            fits = share
        } else {
            too_large = share
        }
    }
    (fits > 0.1 && ring.contains(middle)).then(|| shrunk(fits))
}

/// Whether any point of the segment from `a` to `b` lies in the box (Liang and Barsky 1984).
fn crosses_box(a: Point, b: Point, low: Point, high: Point) -> bool {
    let (mut enters, mut leaves) = (0.0_f64, 1.0_f64);
    for axis in 0..2 {
        let along = b[axis] - a[axis];
        let (to_low, to_high) = (low[axis] - a[axis], high[axis] - a[axis]);
        if along.abs() > 0.0 {
            let (one, other) = (to_low / along, to_high / along);
            enters = enters.max(one.min(other));
            leaves = leaves.min(one.max(other));
        } else if to_low > 0.0 || to_high < 0.0 {
            return false;
        }
    }
    enters <= leaves
}
