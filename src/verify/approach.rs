//! Closest approach of two motions under a relative shift in time.

use nalgebra::Vector3;

/// A motion at constant velocity over an interval of time, metres and seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Motion {
    pub(super) from_s: f64,
    pub(super) to_s: f64,
    pub(super) from: Vector3<f64>,
    pub(super) velocity: Vector3<f64>,
}

/// Times of both vehicles, each on its own clock, and their distance then.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Approach {
    pub(super) distance_m: f64,
    pub(super) times_s: (f64, f64),
}

/// A pair of times, one of each vehicle, relative to the starts of the motions.
type Times = (f64, f64);

/// `a s + b t <= c` over a pair of times.
#[derive(Clone, Copy)]
struct HalfPlane {
    normal: Times,
    bound: f64,
}

/// The least distance of two motions over all pairs of times at most `slack_s`
/// apart, as far as the vertical distance is below `level_m`.
///
/// The squared distance is a convex quadratic of the two times, the allowed
/// pairs form a convex polygon: the minimum is where the gradient vanishes, or
/// on an edge, where it is the closest approach of a point to a line.
/// `weights` scale the axes of the distance (0 leaves one out).
pub(super) fn closest(
    a: &Motion,
    b: &Motion,
    slack_s: f64,
    level_m: Option<f64>,
    weights: Vector3<f64>,
) -> Option<Approach> {
    let offset_s = a.from_s - b.from_s;
    // A microsecond more, so that rounding cannot empty the strip of no slack at all.
    let slack_s = slack_s + 1e-6;
    let (last_a, last_b) = (a.to_s - a.from_s, b.to_s - b.from_s);
    let mut planes = vec![
        HalfPlane {
            normal: (1.0, -1.0),
            bound: slack_s - offset_s,
        },
        HalfPlane {
            normal: (-1.0, 1.0),
            bound: slack_s + offset_s,
        },
    ];
    let apart = a.from - b.from;
    if let Some(level_m) = level_m {
        let rates = (a.velocity.z, -b.velocity.z);
        planes.push(HalfPlane {
            normal: rates,
            bound: level_m - apart.z,
        });
        planes.push(HalfPlane {
            normal: (-rates.0, -rates.1),
            bound: level_m + apart.z,
        });
    }
    let mut corners: Vec<Times> = vec![(0.0, 0.0), (last_a, 0.0), (last_a, last_b), (0.0, last_b)];
    for plane in &planes {
        corners = clip(&corners, plane);
        if corners.is_empty() {
            return None;
        }
    }
    let gap = Gap {
        apart: apart.component_mul(&weights),
        rate_a: a.velocity.component_mul(&weights),
        rate_b: -b.velocity.component_mul(&weights),
    };
    let is_allowed = |at: Times| {
        (0.0..=last_a).contains(&at.0)
            && (0.0..=last_b).contains(&at.1)
            && planes.iter().all(|plane| plane.over(at) <= 0.0)
    };
    let level = gap.level_point().filter(|at| is_allowed(*at));
    let (distance_m, at) = gap.least(&corners, level);
    Some(Approach {
        distance_m,
        times_s: (a.from_s + at.0, b.from_s + at.1),
    })
}

impl HalfPlane {
    /// By how much a pair of times is beyond.
    fn over(&self, at: Times) -> f64 {
        self.normal.0 * at.0 + self.normal.1 * at.1 - self.bound
    }
}

/// The part of a convex polygon in a half plane (Sutherland and Hodgman).
fn clip(corners: &[Times], plane: &HalfPlane) -> Vec<Times> {
    let mut kept = Vec::with_capacity(corners.len() + 1);
    for (index, &here) in corners.iter().enumerate() {
        let before = corners[(index + corners.len() - 1) % corners.len()];
        let (over_before, over_here) = (plane.over(before), plane.over(here));
        if (over_before > 0.0) != (over_here > 0.0) {
            let share = over_before / (over_before - over_here);
            kept.push((
                before.0 + (here.0 - before.0) * share,
                before.1 + (here.1 - before.1) * share,
            ));
        }
        if over_here <= 0.0 {
            kept.push(here);
        }
    }
    kept
}

/// The vector from one vehicle to the other: `apart + rate_a s + rate_b t`.
struct Gap {
    apart: Vector3<f64>,
    rate_a: Vector3<f64>,
    rate_b: Vector3<f64>,
}

impl Gap {
    fn at(&self, times: Times) -> Vector3<f64> {
        self.apart + self.rate_a * times.0 + self.rate_b * times.1
    }

    /// The least length on the edges of a polygon, or at a level point inside.
    fn least(&self, corners: &[Times], level: Option<Times>) -> (f64, Times) {
        let mut least = (f64::INFINITY, (0.0, 0.0));
        let mut offer = |at: Times| {
            let distance_m = self.at(at).norm();
            if distance_m < least.0 || distance_m.is_nan() {
                least = (distance_m, at);
            }
        };
        if let Some(at) = level {
            offer(at);
        }
        for (index, &from) in corners.iter().enumerate() {
            let to = corners[(index + 1) % corners.len()];
            let (start, end) = (self.at(from), self.at(to));
            let along = end - start;
            let square = along.norm_squared();
            let share = if square > 0.0 {
                (-start.dot(&along) / square).clamp(0.0, 1.0)
            } else {
                0.0
            };
            offer((
                from.0 + (to.0 - from.0) * share,
                from.1 + (to.1 - from.1) * share,
            ));
        }
        least
    }

    /// Where the gradient vanishes, unless the motions are parallel: then the
    /// minimum is on the boundary too.
    fn level_point(&self) -> Option<Times> {
        let (aa, ab, bb) = (
            self.rate_a.norm_squared(),
            self.rate_a.dot(&self.rate_b),
            self.rate_b.norm_squared(),
        );
        let determinant = aa * bb - ab * ab;
        if determinant <= 1e-12 * aa * bb {
            return None;
        }
        let (pa, pb) = (self.apart.dot(&self.rate_a), self.apart.dot(&self.rate_b));
        Some((
            (ab * pb - bb * pa) / determinant,
            (ab * pa - aa * pb) / determinant,
        ))
    }
}
