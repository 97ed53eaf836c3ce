//! The progress of the transfers to a fleet, in one line.

use std::collections::BTreeMap;
use std::fmt;

use crate::link::Progress;

/// The latest progress of each vehicle.
#[derive(Debug)]
pub(crate) struct Overview {
    vehicles: usize,
    at: BTreeMap<String, Progress>,
}

impl Overview {
    /// No progress yet, of a number of vehicles.
    pub(crate) fn of(vehicles: usize) -> Self {
        Self {
            vehicles,
            at: BTreeMap::new(),
        }
    }

    /// Sets the progress of one vehicle.
    pub(crate) fn note(&mut self, id: &str, at: Progress) {
        match self.at.get_mut(id) {
            Some(known) => *known = at,
            None => drop(self.at.insert(id.to_owned(), at)),
        }
    }
}

/// One vehicle with its items; of a fleet the number of vehicles in each stage, so that
/// the line stays short.
impl fmt::Display for Overview {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let (1, Some((id, at))) = (self.vehicles, self.at.first_key_value()) {
            return write!(f, "{id}: {} {} of {}", at.stage, at.done, at.total);
        }
        let count = |stage: &str| self.at.values().filter(|at| at.stage == stage).count();
        write!(f, "{} of {} vehicles done", count("done"), self.vehicles)?;
        for stage in ["waiting", "sending", "clearing", "reading"] {
            if let some @ 1.. = count(stage) {
                write!(f, ", {stage} {some}")?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(stage: &'static str, done: usize) -> Progress {
        Progress {
            lists: 0,
            stage,
            done,
            total: 200,
        }
    }

    #[test]
    fn one_vehicle_shows_its_items_and_a_fleet_a_line_of_80_columns() {
        let mut one = Overview::of(1);
        one.note("alpha", at("sending", 12));
        assert_eq!(one.to_string(), "alpha: sending 12 of 200");
        let mut many = Overview::of(100);
        for n in 0..100 {
            let stage = ["waiting", "sending", "clearing", "reading", "done"][n % 5];
            many.note(&format!("v{n}"), at("waiting", 0));
            many.note(&format!("v{n}"), at(stage, n));
        }
        assert_eq!(
            many.to_string(),
            "20 of 100 vehicles done, waiting 20, sending 20, clearing 20, reading 20"
        );
    }
}
