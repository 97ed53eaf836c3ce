//! What flying through a zone costs.

use super::piece::{FORBIDDEN, Piece, plane};
use super::relief::Relief;
use super::{Margins, RouteEnds};
use crate::geodesy::{Agl, Amsl, PlanPoint};
use crate::numeric::geometry::{Offset, Point};
use crate::spec::Placement;
use crate::world::{PlanZone, World};

/// A zone, widened by its margin.
#[derive(Clone, Debug)]
pub(crate) struct ClosedZone {
    outline: Offset,
    /// Closed from this up.
    from: Placement,
    /// Closed below this.
    below: Placement,
}

/// No floor, and no ceiling.
const GROUND: Placement = Placement::Amsl(Amsl(f64::NEG_INFINITY));
const SKY: Placement = Placement::Amsl(Amsl(f64::INFINITY));

/// Most readings of the ground under one piece.
const MAX_READINGS: f64 = 64.0;

impl ClosedZone {
    /// The zone with margins that shrink to what the ends of a route keep.
    pub(crate) fn new(
        zone: &PlanZone,
        (world, route): (&World, &RouteEnds),
        margins: &Margins,
    ) -> Self {
        let outline = zone.away_from([plane(route.from), plane(route.to)], margins.threat_m);
        let under_m = |end: PlanPoint| {
            let (floor_m, _) = zone.closed_m(world.ground.height_m(end.at));
            match zone.contains(end.at) {
                true => (floor_m - end.amsl.0).max(0.0),
                false => f64::INFINITY,
            }
        };
        let under_m = under_m(route.from).min(under_m(route.to));
        let above = Agl(world.min_agl.0 + margins.clearance_m);
        let lower_m = (zone.margin_under_m(margins.clearance_m, above)).min(under_m);
        let higher_m = zone.margin_over_m(margins.clearance_m, world.max_amsl);
        Self {
            outline,
            from: zone.floor.map_or(GROUND, |floor| raised(floor, -lower_m)),
            below: zone
                .ceiling
                .map_or(SKY, |ceiling| raised(ceiling, higher_m)),
        }
    }

    /// What one kilometre of a segment costs for this zone.
    #[inline]
    pub(crate) fn exposure(
        &self,
        piece: &Piece,
        relief: &Relief,
        crossings: &mut Vec<(f64, i32)>,
    ) -> f64 {
        if self.outline.is_far_from(piece.a, piece.b) {
            return 0.0;
        }
        self.exposure_near(piece, relief, crossings)
    }

    /// The same for a segment whose box meets that of the zone.
    fn exposure_near(
        &self,
        piece: &Piece,
        relief: &Relief,
        crossings: &mut Vec<(f64, i32)>,
    ) -> f64 {
        let ends = (piece.a, piece.b);
        let (amsl_a_m, amsl_b_m) = (piece.amsl_a_m, piece.amsl_b_m);
        if let (Placement::Amsl(_), Placement::Amsl(_)) = (self.from, self.below) {
            // No ground is needed.
            let closed = self.part_closed((amsl_a_m, 0.0), (amsl_b_m, 0.0));
            return closed.map_or(0.0, |closed| {
                FORBIDDEN * self.outline.inside_fraction(ends, closed, crossings)
            });
        }
        let count = readings(piece, relief);
        let at = |share: f64| {
            let mix = |a: f64, b: f64| a + share * (b - a);
            let (east_m, north_m) = (mix(piece.a[0], piece.b[0]), mix(piece.a[1], piece.b[1]));
            (mix(amsl_a_m, amsl_b_m), relief.height_m(east_m, north_m))
        };
        let mut inside = 0.0;
        let mut before = (0.0, at(0.0));
        for reading in 1..=count {
            let share = f64::from(reading) / f64::from(count);
            let next = (share, at(share));
            if let Some((from, to)) = self.part_closed(before.1, next.1) {
                let along = |part: f64| before.0 + part * (next.0 - before.0);
                let closed = (along(from), along(to));
                inside += self.outline.inside_fraction(ends, closed, crossings);
            }
            before = next;
        }
        FORBIDDEN * inside
    }

    /// The part of a segment between floor and ceiling, as fractions from and to, by the
    /// altitudes of its ends and of the ground under them.
    fn part_closed(&self, a: (f64, f64), b: (f64, f64)) -> Option<(f64, f64)> {
        let of = |limit: Placement| match limit {
            Placement::Amsl(amsl) => (a.0, b.0, amsl.0),
            Placement::Agl(agl) => (a.0 - a.1, b.0 - b.1, agl.0),
        };
        let below = part_below(of(self.below))?;
        let (a, b, from_m) = of(self.from);
        let above = part_below((-a, -b, -from_m))?;
        let part = (below.0.max(above.0), below.1.min(above.1));
        (part.0 < part.1).then_some(part)
    }

    /// Least and greatest coordinates.
    pub(crate) fn bounds(&self) -> (Point, Point) {
        self.outline.bounds()
    }
}

/// A limit with more height.
fn raised(limit: Placement, by_m: f64) -> Placement {
    match limit {
        Placement::Amsl(amsl) => Placement::Amsl(Amsl(amsl.0 + by_m)),
        Placement::Agl(agl) => Placement::Agl(Agl(agl.0 + by_m)),
    }
}

/// Readings of the ground under a piece: at least one in each cell of its grid.
fn readings(piece: &Piece, relief: &Relief) -> u32 {
    let run_m = (piece.b[0] - piece.a[0]).hypot(piece.b[1] - piece.a[1]);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "clamped to a small positive count"
    )]
    let count = (run_m * relief.per_metre()).ceil().clamp(1.0, MAX_READINGS) as u32;
    count
}

/// The part of a segment where what goes from `a` to `b` is below a limit, as fractions.
fn part_below((a, b, limit): (f64, f64, f64)) -> Option<(f64, f64)> {
    match (a < limit, b < limit) {
        (true, true) => Some((0.0, 1.0)),
        (true, false) => Some((0.0, (limit - a) / (b - a))),
        (false, true) => Some(((a - limit) / (a - b), 1.0)),
        (false, false) => None,
    }
}
