//! The fewest legs through a list of points: a dynamic program over legs.

use nalgebra::Vector3;

use super::encode::quarter_up;
use crate::geodesy::Amsl;
use crate::numeric::as_f64;
use crate::path::VehicleLimits;

/// A point of the path: east, north, height, metres.
pub(crate) type Point = Vector3<f64>;

/// The limits that waypoints must keep.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Keep {
    /// Furthest from the path, metres, positive.
    pub tolerance_m: f64,
    /// Turn radius and slopes.
    pub limits: VehicleLimits,
    /// Altitude of height 0; absent when heights are above terrain, whose slopes are not
    /// those of the flight.
    pub zero: Option<Amsl>,
}

/// What a metre of misfit costs, in legs: a tenth of a millimetre weighs as much as one.
const MISFIT_COST: f64 = 1e4;
/// Points that one leg may pass: bounds the work on a path that is rough within the
/// tolerance, where nearly every pair of points makes a leg.
const REACH: usize = 128;
/// Stands for the infinite arc of a full reversal, metres.
const FARTHEST_M: f64 = 1e7;

/// All legs between points that keep the tolerance, by where they begin.
pub(crate) struct Legs<'a> {
    from: Vec<Vec<Leg>>,
    keep: &'a Keep,
}

/// A leg that keeps the tolerance.
struct Leg {
    to: usize,
    /// Furthest that the path leaves it, metres times the strictness there.
    deviation_m: f64,
    /// Strictness at its end.
    strictness: f64,
    /// Rise beyond what the vehicle may climb or descend, as encoded, metres.
    too_steep_m: f64,
    /// In the plane, metres.
    length_m: f64,
    /// In the plane, radians from east.
    heading_rad: f64,
}

/// A way from the first point over a leg, such that no other is both cheaper and
/// leaves more of that leg.
#[derive(Clone, Copy)]
struct Way {
    /// Legs, and misfits in legs.
    cost: f64,
    /// How much of its last leg the arc at the beginning of it uses, metres.
    used_m: f64,
    /// The way that it continues; none at the first point.
    before: Option<Name>,
}

/// A way by where its last leg begins, which of the legs there it is, and which of its ways.
#[derive(Clone, Copy)]
struct Name {
    from: usize,
    leg: usize,
    way: usize,
}

impl<'a> Legs<'a> {
    /// Of points with the strictness at each. The path may be further from a leg than the points
    /// are, by `slack_m`. No leg passes a point that is needed.
    pub(crate) fn new(
        points: &[(Point, f64)],
        needed: &[bool],
        slack_m: f64,
        keep: &'a Keep,
    ) -> Self {
        let from = (0..points.len())
            .map(|from| {
                let rest = needed.iter().skip(from + 1);
                let next = rest.take_while(|is_needed| !**is_needed).count() + from + 2;
                (from + 1..points.len().min(from + 1 + REACH).min(next))
                    .filter_map(|to| Leg::new(&points[from..=to], to, slack_m, keep))
                    .collect()
            })
            .collect();
        Self { from, keep }
    }

    /// Indices of the points at the ends of the fewest legs, first and last included, and by how much
    /// these miss the limits, metres.
    pub(crate) fn fewest(&self) -> (Vec<usize>, f64) {
        let last = self.from.len().saturating_sub(1);
        let mut ways: Vec<Vec<Vec<Way>>> = self
            .from
            .iter()
            .map(|legs| vec![Vec::new(); legs.len()])
            .collect();
        if let (Some(ways), Some(legs)) = (ways.first_mut(), self.from.first()) {
            for (ways, leg) in ways.iter_mut().zip(legs) {
                ways.push(Way {
                    cost: 1.0 + MISFIT_COST * leg.too_steep_m,
                    used_m: 0.0,
                    before: None,
                });
            }
        }
        // A leg's ways are complete when all that begin before it have been continued.
        let mut best: Option<(f64, Name)> = None;
        for from in 0..last {
            for (index, leg) in self.from[from].iter().enumerate() {
                let here = std::mem::take(&mut ways[from][index]);
                let named = |way: usize| Name {
                    from,
                    leg: index,
                    way,
                };
                if leg.to == last {
                    for (number, way) in here.iter().enumerate() {
                        let cost = way.cost + MISFIT_COST * (way.used_m - leg.length_m).max(0.0);
                        if best.is_none_or(|(least, _)| cost < least) {
                            best = Some((cost, named(number)));
                        }
                    }
                } else {
                    self.continue_ways((&here, &named), leg, &mut ways[leg.to]);
                }
                ways[from][index] = here;
            }
        }
        let mut indices = vec![last];
        let mut at = best.map(|(_, name)| name);
        while let Some(name) = at {
            indices.push(name.from);
            at = ways[name.from][name.leg][name.way].before;
        }
        indices.reverse();
        let legs = as_f64(indices.len() - 1);
        let misfit_m = best.map_or(0.0, |(cost, _)| (cost - legs) / MISFIT_COST);
        (indices, misfit_m)
    }

    /// Offers the ways over a leg, by their names, to every leg that begins where it ends.
    fn continue_ways(
        &self,
        (here, named): (&[Way], &impl Fn(usize) -> Name),
        leg: &Leg,
        onward_ways: &mut [Vec<Way>],
    ) {
        for (onward, ways) in self.from[leg.to].iter().zip(onward_ways) {
            let corner = Corner::between(leg, onward, self.keep.limits.turn_radius_m);
            let too_far_m = leg.strictness * corner.cut_m + leg.deviation_m.max(onward.deviation_m)
                - self.keep.tolerance_m;
            for (number, way) in here.iter().enumerate() {
                let too_long_m = way.used_m + corner.used_m - leg.length_m;
                let misfit_m = too_long_m.max(0.0) + too_far_m.max(0.0) + onward.too_steep_m;
                offer(
                    ways,
                    Way {
                        cost: way.cost + 1.0 + MISFIT_COST * misfit_m,
                        used_m: corner.used_m,
                        before: Some(named(number)),
                    },
                );
            }
        }
    }
}

impl Leg {
    /// The leg between the first and the last point, if it keeps the tolerance to those
    /// between; neighbours always do.
    fn new(points: &[(Point, f64)], to: usize, slack_m: f64, keep: &Keep) -> Option<Self> {
        let [(first, _), between @ .., (last, strictness)] = points else {
            return None;
        };
        let mut deviation_m = slack_m;
        for &(point, strictness) in between {
            deviation_m = deviation_m.max(slack_m + strictness * distance_m(point, *first, *last));
            if deviation_m > keep.tolerance_m {
                return None;
            }
        }
        let along = last - first;
        let length_m = along.x.hypot(along.y);
        Some(Self {
            to,
            deviation_m,
            strictness: *strictness,
            too_steep_m: too_steep_m(first.z, last.z, length_m, keep),
            length_m,
            heading_rad: along.y.atan2(along.x),
        })
    }
}

/// Distance of a point from a segment, metres.
pub(crate) fn distance_m(point: Point, from: Point, to: Point) -> f64 {
    let along = to - from;
    let length_sq = along.norm_squared();
    let at = if length_sq > 0.0 {
        ((point - from).dot(&along) / length_sq).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (point - from - along * at).norm()
}

/// How much more a leg rises or falls than the vehicle may over its length, with its
/// ends as they are encoded.
fn too_steep_m(from_m: f64, to_m: f64, length_m: f64, keep: &Keep) -> f64 {
    let Some(zero) = keep.zero else {
        return 0.0;
    };
    let (from_m, to_m) = (f64::from(quarter_up(from_m)), f64::from(quarter_up(to_m)));
    let limit = if to_m > from_m {
        keep.limits.climb
    } else {
        keep.limits.descent
    };
    let at = |height_m: f64| limit.at(Amsl(zero.0 + height_m));
    let steepest = at(from_m).min(at(to_m));
    ((to_m - from_m).abs() - steepest * length_m).max(0.0)
}

/// The arc at a waypoint.
pub(crate) struct Corner {
    /// How much of each leg it uses, metres.
    pub(crate) used_m: f64,
    /// How far it passes from the waypoint, metres.
    pub(crate) cut_m: f64,
}

impl Corner {
    fn between(leg: &Leg, onward: &Leg, radius_m: f64) -> Self {
        // A vertical leg has no heading: the vehicle stops in the plane, there is no arc.
        if leg.length_m <= 0.0 || onward.length_m <= 0.0 {
            return Self {
                used_m: 0.0,
                cut_m: 0.0,
            };
        }
        Self::of(onward.heading_rad - leg.heading_rad, radius_m)
    }

    /// The arc of a turn.
    pub(crate) fn of(turn_rad: f64, radius_m: f64) -> Self {
        let half_rad = turn_rad.sin().atan2(turn_rad.cos()).abs() / 2.0;
        Self {
            used_m: (radius_m * half_rad.tan()).clamp(0.0, FARTHEST_M),
            cut_m: (radius_m * (1.0 / half_rad.cos() - 1.0)).clamp(0.0, FARTHEST_M),
        }
    }
}

/// Keeps a way unless another is at least as good in both respects.
fn offer(ways: &mut Vec<Way>, new: Way) {
    let covers = |a: &Way, b: &Way| a.cost <= b.cost && a.used_m <= b.used_m;
    if ways.iter().any(|way| covers(way, &new)) {
        return;
    }
    ways.retain(|way| !covers(&new, way));
    ways.push(new);
}
