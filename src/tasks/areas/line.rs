//! Lines over the ground, and how near they are to each other.

use crate::geodesy::EastNorth;

/// A line to be flown over the ground.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepLine {
    /// Where it begins, its corners, where it ends.
    pub points: Vec<EastNorth>,
    /// Whether it may be flown the other way round.
    pub is_reversible: bool,
}

impl SweepLine {
    /// Length over the ground, metres.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        let legs = self.points.windows(2);
        legs.map(|pair| pair[0].distance_m(pair[1])).sum()
    }
}

/// Distances of lines and of pictures, metres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spacing {
    pub(super) lines_m: f64,
    pub(super) pictures_m: Option<f64>,
}
