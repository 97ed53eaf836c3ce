//! The objective: seven named terms of one path.

/// The terms of the objective as they enter the total (design: they sum to it).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CostTerms {
    /// JL, Eq. 22.
    pub length: f64,
    /// JH, Eq. 21.
    pub altitude: f64,
    /// JT, Eq. 24, with zones and the area.
    pub threat: f64,
    /// CH, Eq. 23.
    pub terrain: f64,
    /// CT, Eq. 25.
    pub turn: f64,
    /// CG, Eq. 26.
    pub climb: f64,
    /// JP, Eq. 28 to 30.
    pub collision: f64,
}

impl CostTerms {
    /// The total, summed in the order of the fields.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.length
            + self.altitude
            + self.threat
            + self.terrain
            + self.turn
            + self.climb
            + self.collision
    }

    /// Whether no limit is violated.
    #[must_use]
    pub fn is_clean(&self) -> bool {
        self.threat + self.terrain + self.turn + self.climb + self.collision <= 0.0
    }
}
