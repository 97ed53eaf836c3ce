//! Zones in planning coordinates.

use geo::{BoundingRect, Contains, Intersects, Point, Polygon, Rect};

use super::{Ground, Terrain, covers};
use crate::geodesy::{Agl, Amsl, EastNorth, PlanPoint};
use crate::numeric::geometry::{Offset, Ring};
use crate::spec::{Placement, Zone};

/// A zone in planning coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanZone {
    /// Outline (x east, y north, metres), holes joined to it: see [`Zone::outline`].
    pub outline: Polygon<f64>,
    /// Open below this.
    pub floor: Option<Placement>,
    /// Open from this up.
    pub ceiling: Option<Placement>,
    /// Closed only from and to these times, seconds after T0; always if absent.
    pub active_s: Option<(f64, f64)>,
    /// Closed too within this distance of the outline, metres.
    pub buffer_m: f64,
    /// Whether it has no holes: then every edge of the outline is one of the zone.
    pub is_whole: bool,
    bounds: Option<Rect<f64>>,
    open: OpenSpace,
}

/// Height of what is open between a zone and the zones under and over it, metres; infinite where
/// there are none, or none whose distance is the same everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
struct OpenSpace {
    under_m: f64,
    over_m: f64,
}

/// Share of an open space that the margin to either side of it takes at most.
const MAX_OF_SPACE: f64 = 0.4;
/// Lower spaces are none: what parts of a threat with a shape have between them.
const MIN_SPACE_M: f64 = 0.5;

/// From where up a zone is closed over a terrain: lower by as much as that may stand above the ground, where it is
/// measured from there. A ceiling is not lower than the true one over such a terrain.
#[must_use]
pub fn floor_over(zone: &Zone, terrain: &Terrain) -> Option<Placement> {
    zone.floor.map(|floor| match floor {
        Placement::Agl(agl) => Placement::Agl(Agl(agl.0 - terrain.raised_m())),
        Placement::Amsl(_) => floor,
    })
}

impl PlanZone {
    /// The zone of an outline with the heights and times of a zone of the spec, `slack_s`
    /// longer on both sides. A ceiling above ground that has no elevation counts as none.
    #[must_use]
    pub fn new(outline: Polygon<f64>, zone: &Zone, slack_s: f64, terrain: &Terrain) -> Self {
        let from_bases = |of: Placement| match of {
            Placement::Agl(agl) if !zone.bases.is_empty() => {
                let mut highest_m = f64::NEG_INFINITY;
                for base in &zone.bases {
                    highest_m = highest_m.max(terrain.height(*base).ok()?.0);
                }
                Some(Placement::Amsl(Amsl(highest_m + agl.0)))
            }
            of => Some(of),
        };
        Self {
            is_whole: zone.holes.is_empty(),
            floor: floor_over(zone, terrain),
            ceiling: zone.ceiling.and_then(from_bases),
            active_s: zone
                .active_s
                .map(|(from_s, to_s)| (from_s - slack_s, to_s + slack_s)),
            ..Self::closed(outline)
        }
    }

    /// A zone closed at every height and time.
    #[must_use]
    pub fn closed(outline: Polygon<f64>) -> Self {
        Self {
            bounds: outline.bounding_rect(),
            outline,
            floor: None,
            ceiling: None,
            active_s: None,
            buffer_m: 0.0,
            is_whole: true,
            open: OpenSpace {
                under_m: f64::INFINITY,
                over_m: f64::INFINITY,
            },
        }
    }

    /// Zones that know what is open between them and those under and over them. Paths of specs
    /// without buffers stay as they are.
    pub(super) fn among_each_other(mut zones: Vec<Self>) -> Vec<Self> {
        let floors: Vec<Self> = (zones.iter().filter(|zone| zone.floor.is_some()))
            .cloned()
            .collect();
        for zone in zones.iter_mut().filter(|zone| zone.buffer_m > 0.0) {
            let over = floors.iter().filter_map(|floor| floor.height_over_m(zone));
            zone.open.over_m = over.fold(f64::INFINITY, f64::min);
        }
        let lids: Vec<Self> = (zones.iter().filter(|zone| zone.ceiling.is_some()))
            .cloned()
            .collect();
        for zone in zones.iter_mut().filter(|zone| zone.buffer_m > 0.0) {
            let under = lids.iter().filter_map(|lid| zone.height_over_m(lid));
            zone.open.under_m = under.fold(f64::INFINITY, f64::min);
        }
        zones
    }

    /// How much higher its floor is than the ceiling of another zone, where one may be over the other
    /// and it is higher by the same everywhere.
    fn height_over_m(&self, lower: &Self) -> Option<f64> {
        let is_over = self.bounds?.intersects(&lower.bounds?);
        let height_m = match (self.floor?, lower.ceiling?) {
            (Placement::Amsl(floor), Placement::Amsl(ceiling)) => floor.0 - ceiling.0,
            (Placement::Agl(floor), Placement::Agl(ceiling)) => floor.0 - ceiling.0,
            _ => return None,
        };
        (is_over && height_m > MIN_SPACE_M).then_some(height_m)
    }

    /// The same zone, closed within a distance of it as well, and by as much more above and below
    /// it, metres.
    #[must_use]
    pub fn buffered(self, buffer_m: f64) -> Self {
        let higher = |of: Placement, by_m: f64| match of {
            Placement::Amsl(amsl) => Placement::Amsl(Amsl(amsl.0 + by_m)),
            Placement::Agl(agl) => Placement::Agl(Agl(agl.0 + by_m)),
        };
        let wider = |bounds: Rect<f64>| {
            let (low, high) = (bounds.min(), bounds.max());
            let (low, high) = (
                (low.x - buffer_m, low.y - buffer_m),
                (high.x + buffer_m, high.y + buffer_m),
            );
            Rect::new(low, high)
        };
        Self {
            floor: self.floor.map(|floor| higher(floor, -buffer_m)),
            ceiling: self.ceiling.map(|ceiling| higher(ceiling, buffer_m)),
            bounds: self.bounds.map(wider),
            buffer_m,
            ..self
        }
    }

    /// Whether a point of the plane lies in the outline, whose edge belongs to it, or nearer to it
    /// than the buffer.
    #[must_use]
    pub fn contains(&self, at: EastNorth) -> bool {
        self.is_near(at) && (covers(&self.outline, at) || self.buffer_m > 0.0 && self.holds(at))
    }

    /// Whether a point of the plane lies in the outline, or nearer to it than the buffer; where
    /// there is no buffer, not its edge.
    #[must_use]
    pub fn holds(&self, at: EastNorth) -> bool {
        match self.buffer_m > 0.0 {
            true => self.offset().contains([at.east_m, at.north_m]),
            false => self.outline.contains(&Point::new(at.east_m, at.north_m)),
        }
    }

    /// All that the zone closes in the plane.
    #[must_use]
    pub fn offset(&self) -> Offset {
        Offset::new(Ring::around(&self.outline), self.buffer_m)
    }

    /// What the zone closes in the plane, and as much as `by_m` around it.
    #[must_use]
    pub fn wider(&self, by_m: f64) -> Offset {
        Offset::new(Ring::around(&self.outline), self.buffer_m + by_m)
    }

    /// What a route stays out of that keeps a margin more away from the zone: less, where one of the
    /// `ends` is nearer than that.
    pub(crate) fn away_from(&self, ends: [[f64; 2]; 2], margin_m: f64) -> Offset {
        let ring = Ring::around(&self.outline);
        let room_m =
            (ends.iter().map(|end| ring.boundary_distance(*end))).fold(f64::INFINITY, f64::min);
        let wider_m = |room_m: f64| margin_m.min(room_m).max(0.0);
        if self.buffer_m > 0.0 {
            Offset::new(ring, self.buffer_m + wider_m(room_m - self.buffer_m))
        } else {
            // A mitred corner reaches up to twice the margin.
            Offset::new(ring.outset(wider_m(0.5 * room_m)), 0.0)
        }
    }

    /// The least and the greatest height of the ground in the box around it, metres.
    #[must_use]
    pub(crate) fn ground_range_m(&self, ground: &Ground) -> (f64, f64) {
        self.bounds
            .map_or((f64::NEG_INFINITY, f64::INFINITY), |bounds| {
                let at = |corner: geo::Coord<f64>| EastNorth {
                    east_m: corner.x,
                    north_m: corner.y,
                };
                ground.range_m(at(bounds.min()), at(bounds.max()))
            })
    }

    /// Whether the box around the outline spans a northing, metres.
    #[must_use]
    pub(crate) fn spans_north(&self, north_m: f64) -> bool {
        (self.bounds).is_some_and(|bounds| (bounds.min().y..=bounds.max().y).contains(&north_m))
    }

    /// Whether the box around the outline meets a range of eastings, metres.
    pub(crate) fn meets_east(&self, from_m: f64, to_m: f64) -> bool {
        (self.bounds).is_some_and(|bounds| bounds.min().x <= to_m && bounds.max().x >= from_m)
    }

    /// Whether a point of the plane lies in the box around the outline.
    #[must_use]
    pub fn is_near(&self, at: EastNorth) -> bool {
        let spans_east = |bounds: Rect<f64>| (bounds.min().x..=bounds.max().x).contains(&at.east_m);
        self.bounds.is_some_and(spans_east) && self.spans_north(at.north_m)
    }

    /// Whether it is closed at every height, at all times.
    #[must_use]
    pub fn is_closed_throughout(&self) -> bool {
        self.floor.is_none() && self.ceiling.is_none() && self.active_s.is_none()
    }

    /// Whether it may be open somewhere below an altitude: under it, or over it.
    pub(crate) fn is_open_below(&self, max_amsl: Amsl) -> bool {
        let is_under_it = |ceiling: Placement| match ceiling {
            Placement::Amsl(top) => top <= max_amsl,
            Placement::Agl(_) => true,
        };
        self.floor.is_some() || self.ceiling.is_some_and(is_under_it)
    }

    /// Whether its floor or ceiling is measured from the ground.
    #[must_use]
    pub fn follows_ground(&self) -> bool {
        let is_agl = |of: Option<Placement>| matches!(of, Some(Placement::Agl(_)));
        is_agl(self.floor) || is_agl(self.ceiling)
    }

    /// What a path over the zone can keep of a distance above it, metres: at most half of what is
    /// left below `max_amsl`, so that as much is left above the path, and less of what is left
    /// below another zone.
    pub(crate) fn margin_over_m(&self, over_m: f64, max_amsl: Amsl) -> f64 {
        let over_m = over_m.min(MAX_OF_SPACE * self.open.over_m);
        match self.ceiling {
            Some(Placement::Amsl(top)) if top <= max_amsl => {
                let left_m = max_amsl.0 - top.0;
                over_m.min(0.5 * left_m)
            }
            _ => over_m,
        }
    }

    /// What a path under the zone can keep of a distance below it, metres, where it is to stay
    /// `above` the ground.
    pub(crate) fn margin_under_m(&self, under_m: f64, above: Agl) -> f64 {
        let over_ground_m = match self.floor {
            Some(Placement::Agl(floor)) if self.buffer_m > 0.0 => floor.0 - above.0,
            _ => f64::INFINITY,
        };
        let left_m = over_ground_m.min(MAX_OF_SPACE * self.open.under_m);
        under_m.min(left_m.max(0.0))
    }

    /// The altitudes from which and below which it is closed over ground of a height, metres;
    /// over ground of unknown height (NaN) the widest.
    #[must_use]
    pub fn closed_m(&self, ground_m: f64) -> (f64, f64) {
        let altitude_m = |of: Option<Placement>, open_m: f64| match of {
            None => open_m,
            Some(Placement::Amsl(amsl)) => amsl.0,
            Some(Placement::Agl(agl)) if ground_m.is_finite() => ground_m + agl.0,
            Some(Placement::Agl(_)) => open_m,
        };
        (
            altitude_m(self.floor, f64::NEG_INFINITY),
            altitude_m(self.ceiling, f64::INFINITY),
        )
    }

    /// Whether the zone is closed at a point of space over ground of a height, at a time
    /// (seconds after T0; NaN where it is not known).
    #[must_use]
    pub fn is_closed_at(&self, point: PlanPoint, ground_m: f64, t_s: f64) -> bool {
        let Amsl(amsl_m) = point.amsl;
        self.is_closed_between(point.at, (amsl_m, amsl_m), ground_m, t_s)
    }

    /// The same of a column: closed anywhere between two altitudes above the sea, metres, the lower first.
    #[must_use]
    pub fn is_closed_between(
        &self,
        at: EastNorth,
        (lower_m, upper_m): (f64, f64),
        ground_m: f64,
        t_s: f64,
    ) -> bool {
        let (from_m, below_m) = self.closed_m(ground_m);
        let is_active = self
            .active_s
            .is_none_or(|(from_s, to_s)| t_s.is_nan() || (from_s <= t_s && t_s <= to_s));
        is_active && from_m <= upper_m && lower_m < below_m && self.contains(at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(side_m: f64) -> PlanZone {
        let corners = vec![(0.0, 0.0), (side_m, 0.0), (side_m, side_m), (0.0, side_m)];
        PlanZone::closed(Polygon::new(corners.into(), Vec::new()))
    }

    #[test]
    fn the_rim_of_a_zone_is_closed() {
        let at = |east_m, north_m| EastNorth { east_m, north_m };
        let zone = square(10.0);
        for inside in [at(5.0, 5.0), at(10.0, 5.0), at(0.0, 0.0)] {
            assert!(zone.contains(inside), "{inside:?}");
        }
        assert!(!zone.contains(at(10.1, 5.0)));
    }

    #[test]
    fn a_zone_is_open_below_its_floor_and_from_its_ceiling_on() {
        let over = |amsl_m| PlanPoint::new(5.0, 5.0, Amsl(amsl_m));
        let mut zone = square(10.0);
        let closed = |zone: &PlanZone, amsl_m| zone.is_closed_at(over(amsl_m), 50.0, 0.0);
        assert!(closed(&zone, 1e9));
        zone.ceiling = Some(Placement::Amsl(Amsl(100.0)));
        assert!(closed(&zone, 99.9) && !closed(&zone, 100.0));
        assert!(!zone.is_closed_at(PlanPoint::new(11.0, 5.0, Amsl(0.0)), 50.0, 0.0));
        zone.floor = Some(Placement::Agl(Agl(20.0)));
        assert!(closed(&zone, 70.0) && !closed(&zone, 69.9));
        // Where the ground is unknown a zone may reach down to anywhere.
        assert!(zone.is_closed_at(over(0.0), f64::NAN, 0.0));
    }

    #[test]
    fn a_zone_is_open_outside_of_its_time() {
        let mut zone = square(10.0);
        zone.active_s = Some((10.0, 20.0));
        let at = PlanPoint::new(5.0, 5.0, Amsl(0.0));
        let closed = |t_s| zone.is_closed_at(at, 0.0, t_s);
        assert!(closed(10.0) && closed(20.0) && closed(f64::NAN));
        assert!(!closed(9.9) && !closed(20.1));
    }

    #[test]
    fn margins_leave_a_way_between_a_zone_and_what_is_under_and_over_it() {
        let agl = |height_m| Some(Placement::Agl(Agl(height_m)));
        let (mut reserve, mut control) = (square(10.0), square(10.0));
        (reserve.ceiling, control.floor) = (agl(55.0), agl(91.0));
        let (reserve, control) = (reserve.buffered(15.0), control.buffered(15.0));
        let zones = PlanZone::among_each_other(vec![reserve, control]);
        let over_m = zones[0].margin_over_m(5.0, Amsl(900.0));
        let under_m = zones[1].margin_under_m(5.0, Agl(40.0));
        assert!(over_m + under_m < 6.0 && over_m > 1.0 && under_m > 1.0);
        // What reaches to two metres below it from the ground leaves two.
        assert!((zones[1].margin_under_m(5.0, Agl(74.0)) - 2.0).abs() < 1e-9);
        // Altitudes above the sea and above the ground are not compared.
        let mut control = square(10.0);
        control.floor = Some(Placement::Amsl(Amsl(91.0)));
        let zones = PlanZone::among_each_other(vec![zones[0].clone(), control]);
        assert!((zones[0].margin_over_m(5.0, Amsl(900.0)) - 5.0).abs() < 1e-9);
    }
}
