//! Zones of the checked spec.

use std::fmt;

use crate::geodesy::LatLon;
use crate::numeric::digits::plain;
use crate::spec::Placement;

/// A part of space that must not be entered.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Zone {
    /// Unique name.
    pub id: String,
    /// At least three corners, not closed (the last is not the first); of a circle, the polygon
    /// circumscribed about it.
    pub polygon: Vec<LatLon>,
    /// Parts of the polygon that do not belong to the zone, in the same form.
    pub holes: Vec<Vec<LatLon>>,
    /// Centre and radius in metres, if the zone is a circle: exact, where the polygon is wider.
    pub circle: Option<(LatLon, f64)>,
    /// Open below this; closed from the ground if absent.
    pub floor: Option<Placement>,
    /// Open from this up; closed at every height if absent.
    pub ceiling: Option<Placement>,
    /// Places from whose highest ground its ceiling above ground counts; from that under the vehicle
    /// if there are none.
    pub bases: Vec<LatLon>,
    /// Closed only from and to these times, seconds after T0, either of them possibly infinite;
    /// always if absent.
    pub active_s: Option<(f64, f64)>,
    /// Distance kept from it, metres, if that of `buffer_m` is not more.
    pub buffer_m: f64,
    /// Where the zone comes from, if not from the spec itself: file and item.
    pub source: Option<String>,
    /// The line or building of a file that it is a part of.
    pub part_of: Option<String>,
}

impl Zone {
    /// A zone closed at every height and time.
    #[must_use]
    pub fn closed(id: String, polygon: Vec<LatLon>) -> Self {
        Self {
            id,
            polygon,
            ..Self::default()
        }
    }

    /// Whether it is closed at every height, at all times.
    #[must_use]
    pub fn is_closed_throughout(&self) -> bool {
        self.floor.is_none() && self.ceiling.is_none() && self.active_s.is_none()
    }

    /// Whether it can be in a fence, which has no height, no time and no holes.
    #[must_use]
    pub fn fits_fence(&self) -> bool {
        self.is_closed_throughout() && self.holes.is_empty()
    }

    /// The corners with those of the holes, as one ring: it goes to each hole and back on the
    /// same line, so that the rules of winding number and of even and odd still hold.
    #[must_use]
    pub fn outline(&self) -> Vec<LatLon> {
        let mut ring = self.polygon.clone();
        let mut ahead: Vec<&[LatLon]> = self.holes.iter().map(Vec::as_slice).collect();
        while let Some((at, first, hole)) = nearest(&ring, &ahead) {
            join(&mut ring, at, (ahead[hole], first));
            ahead.remove(hole);
        }
        ring
    }
}

/// Heights and times at which it is closed, as a message has them: empty if always and everywhere.
impl fmt::Display for Zone {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut parts = Vec::new();
        if let Some(floor) = self.floor {
            parts.push(format!("from {}", height(floor)));
        }
        if let Some(ceiling) = self.ceiling {
            let of = match self.bases.is_empty() {
                true => height(ceiling),
                false => height(ceiling).replace("above ground", "above its highest ground"),
            };
            parts.push(format!("below {of}"));
        }
        if let Some((from_s, to_s)) = self.active_s {
            if from_s.is_finite() {
                parts.push(format!("from T0 {from_s:+.0} s"));
            }
            if to_s.is_finite() {
                parts.push(format!("until T0 {to_s:+.0} s"));
            }
        }
        f.write_str(&parts.join(", "))
    }
}

/// An altitude with its reference, to a centimetre: whole feet have two digits.
fn height(of: Placement) -> String {
    let metres = |exact_m: f64| plain((100.0 * exact_m).round() / 100.0);
    match of {
        Placement::Amsl(amsl) => format!("{} m", metres(amsl.0)),
        Placement::Agl(agl) => format!("{} m above ground", metres(agl.0)),
    }
}

/// Pairs of corners that are looked at for a line that crosses no edge.
const MAX_PAIRS: usize = 2000;

/// The corner of a ring, the corner of a hole, and the number of that hole, which are nearest to
/// each other and between which no edge lies.
fn nearest(ring: &[LatLon], holes: &[&[LatLon]]) -> Option<(usize, usize, usize)> {
    let mut pairs = Vec::new();
    for (number, hole) in holes.iter().enumerate() {
        for (first, to) in hole.iter().enumerate() {
            let all = ring.iter().enumerate();
            let near = all.min_by(|a, b| apart(*a.1, *to).total_cmp(&apart(*b.1, *to)))?;
            pairs.push((apart(*near.1, *to), (near.0, first, number)));
        }
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let rings = || std::iter::once(ring).chain(holes.iter().copied());
    let is_free = |&(at, first, hole): &(usize, usize, usize)| {
        let line = (ring[at], holes[hole][first]);
        !rings().flat_map(edges).any(|edge| cross(line, edge))
    };
    let mut shortest = pairs.iter().map(|(_, pair)| *pair).take(MAX_PAIRS);
    shortest
        .find(is_free)
        .or(pairs.first().map(|(_, pair)| *pair))
}

fn apart(a: LatLon, b: LatLon) -> f64 {
    (a.lat_deg - b.lat_deg).hypot((a.lon_deg - b.lon_deg) * a.lat_deg.to_radians().cos())
}

fn edges(ring: &[LatLon]) -> impl Iterator<Item = (LatLon, LatLon)> + '_ {
    let next = ring.iter().cycle().skip(1);
    ring.iter().copied().zip(next.copied())
}

/// Whether two segments cross within both.
fn cross((a, b): (LatLon, LatLon), (c, d): (LatLon, LatLon)) -> bool {
    let side = |from: LatLon, to: LatLon, at: LatLon| {
        (to.lon_deg - from.lon_deg) * (at.lat_deg - from.lat_deg)
            - (to.lat_deg - from.lat_deg) * (at.lon_deg - from.lon_deg)
    };
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}

/// Joins a hole, from one of its corners on, to a corner of a ring.
fn join(ring: &mut Vec<LatLon>, at: usize, (hole, first): (&[LatLon], usize)) {
    let around = hole.iter().cycle().skip(first).take(hole.len() + 1);
    let mut detour: Vec<LatLon> = around.copied().collect();
    if (doubled_area(ring) > 0.0) == (doubled_area(hole) > 0.0) {
        detour.reverse();
    }
    detour.push(ring[at]);
    ring.splice(at + 1..at + 1, detour);
}

/// Positive counter-clockwise, seen with north up.
fn doubled_area(corners: &[LatLon]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    let pairs = corners.iter().zip(next);
    pairs
        .map(|(a, b)| a.lon_deg * b.lat_deg - b.lon_deg * a.lat_deg)
        .sum()
}
