//! The fence items of a mission, as the autopilot tests them.

use crate::geodesy::LatLon;
use crate::mission::{Item, command};

use crate::verify::measure::outline::{Cylinder, Keep, Outline};
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
                command::FENCE_POLYGON_INCLUSION | command::FENCE_CIRCLE_INCLUSION => Keep::Inside,
                command::FENCE_POLYGON_EXCLUSION | command::FENCE_CIRCLE_EXCLUSION => Keep::Outside,
                command::FENCE_RETURN_POINT => {
                    index += 1;
                    continue;
                }
                other => return Err(format!("fence item {index}: command {other} is none")),
            };
            let is_circle = matches!(
                item.command,
                command::FENCE_CIRCLE_INCLUSION | command::FENCE_CIRCLE_EXCLUSION
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
        let mut least = (f64::INFINITY, 0.0);
        for (boundary, keep) in &self.boundaries {
            let found = match boundary {
                Boundary::Outline(outline) => {
                    if *keep == Keep::Outside
                        && outline.bound_m(stretch) > known_m.min(least.0).max(0.0)
                    {
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

    /// The margin of one place, metres.
    pub(crate) fn place_margin_m(&self, place: LatLon) -> f64 {
        let stretch = Stretch {
            u: (0.0, 1.0),
            from: place,
            to: place,
        };
        self.margin_m(&stretch, f64::INFINITY).0
    }
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
