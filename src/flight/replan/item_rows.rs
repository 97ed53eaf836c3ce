//! From the flight that is judged back to the one that is flown.

use super::state::VehicleState;
use crate::geodesy::Amsl;
use crate::verify::Moment;

/// What leads from a judged mission back to the vehicle in flight.
pub(super) struct Origin {
    /// Since when it is judged as it flies, and where it is then; before, it only rises to there.
    from_s: f64,
    amsl: Amsl,
    /// The row that it flies to.
    at: usize,
    /// The row on board of each judged item.
    rows: Vec<usize>,
}

impl Origin {
    pub(super) fn new(state: &VehicleState, from_s: f64, rows: Vec<usize>) -> Self {
        Self {
            from_s,
            amsl: state.here.amsl,
            at: state.at + 1,
            rows,
        }
    }

    /// A place of the judged mission as one of the flight.
    pub(super) fn moment(&self, judged: &mut Moment) {
        let row = judged.item.checked_sub(1);
        judged.item = row
            .and_then(|row| self.rows.get(row))
            .map_or(self.at, |row| *row);
        if judged.t_s < self.from_s {
            (judged.t_s, judged.amsl, judged.item) = (self.from_s, self.amsl, self.at);
        }
    }
}
