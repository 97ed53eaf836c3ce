//! The segments of one vehicle in time, and the nearest that two vehicles come.

use std::borrow::Borrow;

use nalgebra::Vector3;

use crate::numeric::approach::{self, Approach, closest_approach, closest_horizontal, min_ratio};
use crate::path::{Departing, with_stops_s};
use crate::spec::Span;

use super::segment::Segment;

/// A box in space and time around some segments.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounds {
    pub(crate) from_s: f64,
    pub(crate) to_s: f64,
    low: Vector3<f64>,
    high: Vector3<f64>,
    error_m: f64,
    pub(crate) late_s: f64,
    pub(crate) early_s: f64,
}

/// The segments of one vehicle, its own or those of a flight, and a binary tree of boxes around them.
#[derive(Clone, Debug)]
pub(crate) struct Timeline<'a, C = &'a Segment> {
    pub(crate) of: Departing<'a>,
    pub(crate) segments: Vec<C>,
    /// Heap order: the children of `n` are `2 n + 1` and `2 n + 2`.
    bounds: Vec<Option<Bounds>>,
}

/// What is measured between two vehicles, metres.
#[derive(Clone, Copy)]
pub(crate) enum Distance {
    /// In three dimensions.
    Space,
    /// Horizontally, where the vertical distance is below this.
    Horizontal(f64),
    /// Vertically.
    Vertical,
}

/// A distance, and by how much the second of two vehicles may be shifted against the first.
#[derive(Clone, Copy)]
pub(crate) struct Metric {
    pub(crate) distance: Distance,
    pub(crate) shift_s: Span,
}

/// The nearest that two vehicles come: segment indices, times, distance less the errors.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nearest {
    pub(crate) distance_m: f64,
    pub(crate) segments: (usize, usize),
    pub(crate) times_s: (f64, f64),
}

impl<'a> Timeline<'a> {
    pub(crate) fn new(of: Departing<'a>, segments: &'a [Segment]) -> Self {
        let segments = segments.iter().filter(|segment| segment.flown).collect();
        Self::of(of, segments)
    }
}

impl<'a, C: Borrow<Segment>> Timeline<'a, C> {
    /// Of segments that are all flown.
    pub(crate) fn of(of: Departing<'a>, segments: Vec<C>) -> Self {
        let leaves = segments.len().next_power_of_two();
        let mut bounds: Vec<Option<Bounds>> = vec![None; leaves - 1];
        bounds.extend(
            segments
                .iter()
                .map(|segment| Some(Bounds::of(segment.borrow()))),
        );
        bounds.resize(2 * leaves - 1, None);
        for node in (0..leaves - 1).rev() {
            bounds[node] = match (bounds[2 * node + 1], bounds[2 * node + 2]) {
                (Some(a), Some(b)) => Some(a.around(&b)),
                (one, other) => one.or(other),
            };
        }
        Self {
            of,
            segments,
            bounds,
        }
    }

    fn leaf(&self, node: usize) -> Option<usize> {
        let first = self.bounds.len() / 2;
        node.checked_sub(first)
    }

    /// The whole time in the air.
    pub(crate) fn span(&self) -> Option<Bounds> {
        self.bounds.first().copied().flatten()
    }
}

impl Bounds {
    fn of(segment: &Segment) -> Self {
        let (from, to) = (position(segment, 0.0), position(segment, 1.0));
        Self {
            from_s: segment.from_s,
            to_s: segment.to_s,
            low: from.inf(&to),
            high: from.sup(&to),
            error_m: segment.reach_m(),
            late_s: segment.late_s,
            early_s: segment.early_s,
        }
    }

    fn around(&self, other: &Self) -> Self {
        Self {
            from_s: self.from_s.min(other.from_s),
            to_s: self.to_s.max(other.to_s),
            low: self.low.inf(&other.low),
            high: self.high.sup(&other.high),
            error_m: self.error_m.max(other.error_m),
            late_s: self.late_s.max(other.late_s),
            early_s: self.early_s.max(other.early_s),
        }
    }

    /// At least so far apart is anything in the two boxes; infinite if never at the same time.
    fn apart_m(&self, other: &Self, metric: &Metric) -> f64 {
        let shift_s = with_stops_s(
            metric.shift_s,
            self.late_s + other.early_s,
            other.late_s + self.early_s,
        );
        let is_later = other.from_s - self.to_s > shift_s.most;
        let is_earlier = self.from_s - other.to_s > -shift_s.least;
        if is_later || is_earlier {
            return f64::INFINITY;
        }
        let gap = (self.low - other.high)
            .sup(&(other.low - self.high))
            .sup(&Vector3::zeros());
        let error_m = self.error_m + other.error_m;
        let apart_m = match metric.distance {
            Distance::Space => gap.norm(),
            Distance::Horizontal(level_m) if gap.z > level_m + error_m => f64::INFINITY,
            Distance::Horizontal(_) => gap.xy().norm(),
            Distance::Vertical => gap.z,
        };
        apart_m - error_m
    }
}

impl Metric {
    /// The closest approach of two segments, less what the segments may be off.
    fn measure(&self, a: &Segment, b: &Segment) -> Option<Approach> {
        let error_m = a.reach_m() + b.reach_m();
        let shift_s = with_stops_s(self.shift_s, a.late_s + b.early_s, b.late_s + a.early_s);
        let (middle_s, slack_s) = (
            0.5 * (shift_s.least + shift_s.most),
            0.5 * (shift_s.most - shift_s.least),
        );
        let (p, q) = (motion(a), moved(motion(b), -middle_s));
        let found = match self.distance {
            Distance::Space => closest_approach(&p, &q, slack_s),
            Distance::Horizontal(level_m) => closest_horizontal(&p, &q, slack_s, level_m + error_m),
            // Beside an endless horizontal limit only the vertical distance counts, here in metres.
            Distance::Vertical => min_ratio(&p, &q, slack_s, f64::INFINITY, 1.0),
        }?;
        let less_m = found.value - error_m;
        Some(Approach {
            // Not `max`, which would take a NaN for 0.
            value: if less_m < 0.0 { 0.0 } else { less_m },
            u_s: found.u_s + middle_s,
            ..found
        })
    }
}

fn position(segment: &Segment, u: f64) -> Vector3<f64> {
    let point = segment.at(u);
    Vector3::new(point.at.east_m, point.at.north_m, point.amsl.0)
}

pub(crate) fn motion(segment: &Segment) -> approach::Segment {
    let end = |t_s, u| (t_s, position(segment, u).into());
    approach::Segment::between(end(segment.from_s, 0.0), end(segment.to_s, 1.0))
}

/// The same motion at another time.
fn moved(motion: approach::Segment, by_s: f64) -> approach::Segment {
    approach::Segment {
        t0_s: motion.t0_s + by_s,
        t1_s: motion.t1_s + by_s,
        ..motion
    }
}

/// The nearest that two vehicles come, if nearer than `below_m`.
pub(crate) fn nearest(
    a: &Timeline<'_>,
    b: &Timeline<'_>,
    metric: &Metric,
    below_m: f64,
) -> Option<Nearest> {
    nearest_until(a, b, metric, (below_m, f64::NEG_INFINITY))
}

/// Whether two vehicles come nearer than `below_m`.
pub(crate) fn come_nearer(
    a: &Timeline<'_, Segment>,
    b: &Timeline<'_, Segment>,
    metric: &Metric,
    below_m: f64,
) -> bool {
    nearest_until(a, b, metric, (below_m, below_m)).is_some()
}

/// The nearest that two vehicles come, if nearer than `below_m`; one that is nearer than `enough_m`
/// will do. A walk down both trees at once, nearer pairs of boxes first.
fn nearest_until<C: Borrow<Segment>>(
    a: &Timeline<'_, C>,
    b: &Timeline<'_, C>,
    metric: &Metric,
    (below_m, enough_m): (f64, f64),
) -> Option<Nearest> {
    let mut best: Option<Nearest> = None;
    let mut limit_m = below_m;
    let apart = |x: usize, y: usize| match (a.bounds.get(x), b.bounds.get(y)) {
        (Some(Some(p)), Some(Some(q))) => p.apart_m(q, metric),
        _ => f64::INFINITY,
    };
    let mut open = vec![(apart(0, 0), 0, 0)];
    while let Some((apart_m, x, y)) = open.pop() {
        if apart_m >= limit_m {
            continue;
        }
        if let (Some(i), Some(j)) = (a.leaf(x), b.leaf(y)) {
            let Some(found) = metric.measure(a.segments[i].borrow(), b.segments[j].borrow()) else {
                continue;
            };
            if found.value < limit_m {
                limit_m = found.value;
                best = Some(Nearest {
                    distance_m: found.value,
                    segments: (i, j),
                    times_s: (found.t_s, found.u_s),
                });
            }
            if found.value < enough_m {
                break;
            }
            continue;
        }
        // The box that lasts longer is opened.
        let lasts = |bounds: Option<&Option<Bounds>>| match bounds {
            Some(Some(bounds)) => bounds.to_s - bounds.from_s,
            _ => 0.0,
        };
        let opens_a = b.leaf(y).is_some()
            || (a.leaf(x).is_none() && lasts(a.bounds.get(x)) >= lasts(b.bounds.get(y)));
        let pairs = if opens_a {
            [(2 * x + 1, y), (2 * x + 2, y)]
        } else {
            [(x, 2 * y + 1), (x, 2 * y + 2)]
        };
        let mut children = pairs.map(|(x, y)| (apart(x, y), x, y));
        if children[0].0 < children[1].0 {
            children.swap(0, 1);
        }
        open.extend(children.iter().filter(|child| child.0 < limit_m));
    }
    best
}
