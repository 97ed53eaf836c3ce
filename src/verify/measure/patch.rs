//! The ground over part of a line, as a parabola.

/// A parabola is as near to the ground as this, metres.
pub(crate) const ERROR_M: f64 = 1e-3;
/// A parabola through both ends and the middle of a piece misses by at most
/// `M L^3 / (72 sqrt 3)`, `M` the bound of the third derivative: this is `72 sqrt 3`.
pub(crate) const SHARE: f64 = 124.707_658_144_959_15;

/// The ground over part of a line: `h0 + (h1 - h0) w + 4 bulge w (1 - w)`, `w` from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Patch {
    /// Fractions of the line at the ends.
    pub(crate) w: (f64, f64),
    /// Heights above the sea at the ends, metres.
    pub(crate) height_m: (f64, f64),
    /// Height of the middle above the straight line between the ends, metres.
    pub(crate) bulge_m: f64,
    /// The ground is within this of the parabola, metres.
    pub(crate) error_m: f64,
}

impl Patch {
    /// The least height of a line above the patch, from its heights above it at
    /// the ends, and the fraction of the patch where that is.
    pub(crate) fn min_clearance_m(&self, from_m: f64, to_m: f64) -> (f64, f64) {
        let lower_end = if from_m <= to_m {
            (from_m, 0.0)
        } else {
            (to_m, 1.0)
        };
        // NaN at an end must come out as NaN.
        if !(from_m + to_m).is_finite() {
            return (f64::NAN, 0.0);
        }
        let mut least = lower_end;
        if self.bulge_m > 0.0 {
            let w = (4.0 * self.bulge_m - (to_m - from_m)) / (8.0 * self.bulge_m);
            if w > 0.0 && w < 1.0 {
                let inside_m = from_m + (to_m - from_m) * w - 4.0 * self.bulge_m * w * (1.0 - w);
                if inside_m < least.0 {
                    least = (inside_m, w);
                }
            }
        }
        (least.0 - self.error_m, least.1)
    }

    /// The greatest height of a line above the patch, likewise.
    pub(crate) fn greatest_clearance_m(&self, from_m: f64, to_m: f64) -> (f64, f64) {
        let mirrored = Self {
            bulge_m: -self.bulge_m,
            ..*self
        };
        let (min_m, w) = mirrored.min_clearance_m(-from_m, -to_m);
        (-min_m, w)
    }
}
