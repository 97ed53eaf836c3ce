//! What is a conflict: one answer for resolving conflicts and for the verdict.
//!
//! [`Judge::conflicts`] flies encoded missions by the same model, and measures them by the same
//! function as the margins of [`super::review`]: distance, vertical rule, allowed shifts, what
//! autopilots are late, and buffers.

use crate::mission::VehicleMission;
use crate::spec::{MissionSpec, Separation, Vehicle};
use crate::world::World;

use super::execute::flight::Flight;
use super::limits::separation::{self, Traffic};
use super::limits::space::Space;
use super::review::Sortie;
use super::{Limit, Margin};

/// Later than any flight, seconds: a stay lasts until then.
const HORIZON_S: f64 = 1e6;

/// Judges single missions of one spec, and pairs of them.
pub struct Judge<'a> {
    spec: &'a MissionSpec,
    world: &'a World,
    space: Space<'a>,
    separation: Separation,
}

/// The flight that an encoded mission makes in the model of the verdict.
#[derive(Clone, Debug)]
pub struct Executed<'a> {
    vehicle: &'a Vehicle,
    flight: Flight,
}

/// Executed flights, ready for many questions.
pub struct Others<'a> {
    traffic: Traffic<'a>,
}

/// A conflict with another vehicle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conflict {
    /// Which of the others, by its position.
    pub other: usize,
    /// Where the two are nearest, seconds after T0.
    pub t_s: f64,
}

impl<'a> Judge<'a> {
    /// A judge of the missions of a spec.
    #[must_use]
    pub fn new(spec: &'a MissionSpec, world: &'a World) -> Self {
        Self {
            spec,
            world,
            space: Space::new(spec, world),
            separation: spec.buffered_separation(),
        }
    }

    /// Flies a mission of the vehicle at an index. None where it breaks a limit that concerns its
    /// vehicle alone, and for an index that the spec does not have.
    #[must_use]
    pub fn execute(&self, index: usize, mission: &VehicleMission) -> Option<Executed<'a>> {
        let sortie = self.sortie(index, mission)?;
        let margins = sortie.margins(self.spec, self.world, &self.space);
        let holds = |margin: &Margin| margin.ok || margin.limit == Limit::Separation;
        if !margins.iter().all(holds) {
            return None;
        }
        let mut flight = sortie.flight;
        flight.stay_until(HORIZON_S);
        let vehicle = self.spec.vehicles.get(index)?;
        Some(Executed { vehicle, flight })
    }

    fn sortie<'m>(&self, index: usize, mission: &'m VehicleMission) -> Option<Sortie<'m>>
    where
        'a: 'm,
    {
        let vehicle = self.spec.vehicles.get(index)?;
        let stations = self.world.stations.get(index)?;
        Some(Sortie::new(
            self.spec, self.world, vehicle, stations, mission,
        ))
    }

    /// The others of some flights, in their order.
    #[must_use]
    pub fn others<'e>(&self, flights: &'e [&'e Executed<'a>]) -> Others<'e> {
        let flights = flights
            .iter()
            .map(|executed| (executed.vehicle, &executed.flight.chords[..]));
        Others {
            traffic: Traffic::new(flights),
        }
    }

    /// The conflicts of a flight with others, in their order.
    #[must_use]
    pub fn conflicts(&self, own: &Executed<'_>, others: &Others<'_>) -> Vec<Conflict> {
        let own = (own.vehicle, &own.flight.chords[..]);
        let found =
            separation::conflicts(own, &others.traffic, &self.separation, &self.world.frame);
        found
            .into_iter()
            .map(|(other, t_s)| Conflict { other, t_s })
            .collect()
    }
}
