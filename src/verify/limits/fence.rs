//! The fence items of a mission, as the autopilot tests them.

use std::cell::LazyCell;

use crate::geodesy::{LatLon, bend_m};
use crate::mission::{Item, command};
use crate::numeric::geometry;

use crate::verify::measure::outline::{Cylinder, Keep, Outline, StretchBox};
use crate::verify::measure::segment::Stretch;

/// One boundary.
#[derive(Clone, Debug, PartialEq)]
enum Boundary {
    Outline(Outline),
    Cylinder(Cylinder),
}

/// Every boundary of a fence. ArduPilot wants the vehicle inside of all inclusions,
/// PX4 inside of one: all is judged, which satisfies both.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Fence {
    boundaries: Vec<(Boundary, Keep)>,
}

impl Fence {
    /// Reads fence items; a fence that cannot be read says which item is why.
    pub(crate) fn read(items: &[Item]) -> Result<Self, String> {
        let mut fence = Self::default();
        let mut index = 0;
        while let Some(item) = items.get(index) {
            let keep = match item.command {
                command::NAV_FENCE_POLYGON_VERTEX_INCLUSION
                | command::NAV_FENCE_CIRCLE_INCLUSION => Keep::Inside,
                command::NAV_FENCE_POLYGON_VERTEX_EXCLUSION
                | command::NAV_FENCE_CIRCLE_EXCLUSION => Keep::Outside,
                command::NAV_FENCE_RETURN_POINT => {
                    index += 1;
                    continue;
                }
                other => return Err(format!("fence item {index}: command {other} is none")),
            };
            let is_circle = matches!(
                item.command,
                command::NAV_FENCE_CIRCLE_INCLUSION | command::NAV_FENCE_CIRCLE_EXCLUSION
            );
            let boundary = if is_circle {
                index += 1;
                circle(item, index - 1)?
            } else {
                let corners = polygon(items, index)?;
                index += corners.len();
                Boundary::Outline(Outline::new(corners))
            };
            fence.boundaries.push((boundary, keep));
        }
        Ok(fence)
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.boundaries.is_empty()
    }

    /// The least margin of a stretch to any boundary (negative: breached), metres,
    /// and the fraction of the stretch. Boundaries that cannot be nearer than
    /// `known_m` may be left out.
    pub(crate) fn margin_m(&self, stretch: &Stretch, known_m: f64) -> (f64, f64) {
        let around = LazyCell::new(|| StretchBox::around(stretch));
        let mut least = (f64::INFINITY, 0.0);
        for (boundary, keep) in &self.boundaries {
            let found = match boundary {
                Boundary::Outline(outline) => {
                    let known_m = known_m.min(least.0).max(0.0);
                    let may_be_left_out = *keep == Keep::Outside && known_m < f64::INFINITY;
                    if may_be_left_out && outline.bound_m(&around) > known_m {
                        continue;
                    }
                    outline.margin_m(stretch, *keep)
                }
                Boundary::Cylinder(cylinder) => cylinder.margin_m(stretch, *keep),
            };
            if found.0 < least.0 || found.0.is_nan() {
                least = found;
            }
        }
        least
    }

    /// At least so far is a stretch from every boundary, metres; zero where a boundary has no box.
    pub(crate) fn bound_m(&self, around: &StretchBox) -> f64 {
        let bounds = self.boundaries.iter().map(|boundary| match boundary {
            (Boundary::Outline(outline), Keep::Outside) => outline.bound_m(around),
            _ => 0.0,
        });
        bounds.fold(f64::INFINITY, f64::min)
    }

    /// The margin of one place, metres.
    pub(crate) fn place_margin_m(&self, place: LatLon) -> f64 {
        self.margin_m(&at(place), f64::INFINITY).0
    }
}

/// Splits fence items into boundaries: a circle is one item, a polygon as many as its first says.
pub(crate) fn boundaries(mut fence: &[Item]) -> Vec<&[Item]> {
    let mut found = Vec::new();
    while let Some(first) = fence.first() {
        let is_polygon = [
            command::NAV_FENCE_POLYGON_VERTEX_INCLUSION,
            command::NAV_FENCE_POLYGON_VERTEX_EXCLUSION,
        ]
        .contains(&first.command);
        let corners = (1_u16..)
            .zip(fence)
            .take_while(|(number, item)| {
                item.command == first.command && f32::from(*number) <= first.params[0]
            })
            .count();
        let (boundary, rest) = fence.split_at(if is_polygon { corners.max(1) } else { 1 });
        found.push(boundary);
        fence = rest;
    }
    found
}

/// Two points of a fence are the same within this, 1e-7 degrees: 5 cm.
const SAME_PLACE_E7: u32 = 5;
/// A circle may be this much smaller than the threat it keeps out of, metres.
const RADIUS_M: f32 = 0.01;

/// Whether a boundary is the required one: its corners in either direction from any of them, a
/// circle no smaller.
pub(crate) fn holds(boundary: &[Item], required: &[Item]) -> bool {
    let is = |item: &Item, required: &Item| {
        item.command == required.command
            && item.x.abs_diff(required.x) <= SAME_PLACE_E7
            && item.y.abs_diff(required.y) <= SAME_PLACE_E7
            && item.params[0] >= required.params[0] - RADIUS_M
    };
    let around = |first: usize| required.iter().cycle().skip(first).take(required.len());
    boundary.len() == required.len()
        && (0..required.len()).any(|first| {
            let mut ahead = boundary.iter().zip(around(first));
            let mut back = boundary.iter().rev().zip(around(first));
            ahead.all(|(item, corner)| is(item, corner))
                || back.all(|(item, corner)| is(item, corner))
        })
}

/// A boundary may be this far inside of what it covers, metres: both are encoded in 1e-7 degrees.
const COVER_M: f64 = 0.05;
/// Fewest parts of an edge of a polygon that are measured against a circle, in whose frame each is
/// straight; in longer edges more, so that a part leaves its straight line by a fifth of [`COVER_M`].
const EDGE_PARTS: u32 = 8;

/// Whether an exclusion boundary covers another one, both as items.
pub(crate) fn covers(boundary: &[Item], covered: &[Item]) -> bool {
    let read = |items: &[Item]| match Fence::read(items) {
        Ok(Fence { mut boundaries }) if boundaries.len() == 1 => boundaries.pop(),
        _ => None,
    };
    let (Some((wide, Keep::Outside)), Some((inner, Keep::Outside))) =
        (read(boundary), read(covered))
    else {
        return false;
    };
    let corners_of = |items: &[Item]| items.iter().filter_map(Item::place).collect::<Vec<_>>();
    let (around, within) = (corners_of(boundary), corners_of(covered));
    let is_in = |place: &LatLon| match &wide {
        Boundary::Outline(outline) => {
            let place = at(*place);
            outline.bound_m(&StretchBox::around(&place)) <= COVER_M
                && outline.margin_m(&place, Keep::Outside).0 <= COVER_M
        }
        Boundary::Cylinder(circle) => circle.margin_m(&at(*place), Keep::Inside).0 >= -COVER_M,
    };
    // Corners, or the middle of a circle.
    if !within.iter().all(is_in) {
        return false;
    }
    match (&wide, &inner) {
        // What holds a corner of a polygon and has no edge in it holds all of it.
        (Boundary::Outline(_), Boundary::Outline(outline)) => {
            edges(&around, 1).all(|edge| outline.margin_m(&edge, Keep::Outside).0 >= -COVER_M)
        }
        (Boundary::Outline(_), Boundary::Cylinder(circle)) => edges(&around, EDGE_PARTS)
            .all(|edge| circle.margin_m(&edge, Keep::Outside).0 >= -COVER_M),
        (Boundary::Cylinder(circle), Boundary::Outline(_)) => edges(&within, EDGE_PARTS)
            .all(|edge| circle.margin_m(&edge, Keep::Inside).0 >= -COVER_M),
        (Boundary::Cylinder(circle), Boundary::Cylinder(_)) => {
            let radius_m = f64::from(covered.first().map_or(0.0, |item| item.params[0]));
            let mut middles = within.iter();
            middles
                .all(|middle| circle.margin_m(&at(*middle), Keep::Inside).0 >= radius_m - COVER_M)
        }
    }
}

/// A place as a stretch.
fn at(place: LatLon) -> Stretch {
    Stretch {
        u: (0.0, 1.0),
        from: place,
        to: place,
    }
}

/// The edges of a polygon, each in parts.
fn edges(corners: &[LatLon], parts: u32) -> impl Iterator<Item = Stretch> + '_ {
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).flat_map(move |(from, to)| {
        let bend_m = bend_m(from.chord_m(*to), from.lat_deg.abs().max(to.lat_deg.abs()));
        let finer = geometry::steps(bend_m.sqrt(), (0.2 * COVER_M).sqrt(), (1, 10_000));
        let parts = if parts > 1 {
            parts.max(finer.into())
        } else {
            1
        };
        let along = move |part: u32| {
            let share = f64::from(part) / f64::from(parts);
            LatLon {
                lat_deg: from.lat_deg + (to.lat_deg - from.lat_deg) * share,
                lon_deg: from.lon_deg + (to.lon_deg - from.lon_deg) * share,
            }
        };
        (0..parts).map(move |part| Stretch {
            u: (0.0, 1.0),
            from: along(part),
            to: along(part + 1),
        })
    })
}

fn corner(item: &Item, index: usize) -> Result<LatLon, String> {
    item.place()
        .ok_or_else(|| format!("fence item {index} has no place"))
}

fn circle(item: &Item, index: usize) -> Result<Boundary, String> {
    let radius_m = f64::from(item.params[0]);
    if radius_m > 0.0 && radius_m.is_finite() {
        Ok(Boundary::Cylinder(Cylinder::new(
            corner(item, index)?,
            radius_m,
        )))
    } else {
        Err(format!("fence item {index}: a radius of {radius_m} m"))
    }
}

/// The corners of the polygon that begins at `first`: `param1` of each says how many there are.
fn polygon(items: &[Item], first: usize) -> Result<Vec<LatLon>, String> {
    let head = items
        .get(first)
        .ok_or_else(|| format!("no fence item {first}"))?;
    let declared = head.params[0];
    let corners = items[first..]
        .iter()
        .take_while(|item| {
            item.command == head.command && item.params[0].to_bits() == declared.to_bits()
        })
        .enumerate()
        .take_while(|(count, _)| {
            f64::from(u32::try_from(*count).unwrap_or(u32::MAX)) < f64::from(declared)
        })
        .map(|(count, item)| corner(item, first + count))
        .collect::<Result<Vec<_>, _>>()?;
    let count = f64::from(u32::try_from(corners.len()).unwrap_or(u32::MAX));
    if corners.len() < 3 || (count - f64::from(declared)).abs() > 0.0 {
        return Err(format!(
            "fence item {first}: a polygon of {declared} corners has {}",
            corners.len()
        ));
    }
    if crosses_itself(&corners) {
        return Err(format!("fence item {first}: the polygon crosses itself"));
    }
    Ok(corners)
}

/// Whether two sides that do not meet at a corner cross. More corners than any autopilot
/// holds are not looked at: such a fence is refused for their number.
fn crosses_itself(corners: &[LatLon]) -> bool {
    const MAX_CORNERS: usize = 1000;
    let count = corners.len();
    if count > MAX_CORNERS {
        return false;
    }
    let side = |index: usize| (corners[index], corners[(index + 1) % count]);
    (0..count).any(|first| {
        (first + 2..count)
            .filter(|&second| (second + 1) % count != first)
            .any(|second| cross(side(first), side(second)))
    })
}

/// Whether two sides cross within both.
fn cross((a, b): (LatLon, LatLon), (c, d): (LatLon, LatLon)) -> bool {
    let left_of = |from: LatLon, to: LatLon, at: LatLon| {
        (to.lon_deg - from.lon_deg) * (at.lat_deg - from.lat_deg)
            - (to.lat_deg - from.lat_deg) * (at.lon_deg - from.lon_deg)
    };
    left_of(a, b, c) * left_of(a, b, d) < 0.0 && left_of(c, d, a) * left_of(c, d, b) < 0.0
}
