//! What is a conflict: one answer for resolving conflicts and for the verdict.
//!
//! [`Judge::are_in_conflict`] measures encoded missions, flown by the same model, by the same
//! function as the margins of [`super::review`]: distance, vertical rule, allowed shifts, what
//! autopilots are late, and buffers.

use crate::mission::VehicleMission;
use crate::numeric::tracks::{Ends, clear_m};
use crate::path::Departing;
use crate::spec::{MissionSpec, Separation};
use crate::world::World;

use super::execute::flight::Flight;
use super::limits::separation;
use super::limits::space::Space;
use super::measure::segment::Segment;
use super::measure::timeline::Timeline;
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
    timeline: Timeline<'a, Segment>,
    /// Where it stands on the ground before and after.
    ends: Option<Ends>,
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

    /// Whether a mission of the vehicle at an index keeps every limit that concerns its vehicle
    /// alone; not for an index that the spec does not have.
    #[must_use]
    pub fn keeps_own_limits(&self, index: usize, mission: &VehicleMission) -> bool {
        let holds = |margin: &Margin| margin.ok || margin.limit == Limit::Separation;
        self.sortie(index, mission).is_some_and(|sortie| {
            let margins = sortie.margins(self.spec, self.world, &self.space);
            margins.iter().all(holds)
        })
    }

    /// Flies a mission, whether or not it keeps the limits of its vehicle. None for an index that
    /// the spec does not have.
    #[must_use]
    pub fn fly(&self, index: usize, mission: &VehicleMission) -> Option<Executed<'a>> {
        let sortie = self.sortie(index, mission)?;
        let is_airborne = sortie.departing().is_airborne;
        let mut flight = sortie.flight;
        let ends = ends(&flight);
        flight.stay_until(HORIZON_S);
        let mut segments = flight.segments;
        segments.retain(|segment| segment.flown);
        segments.shrink_to_fit();
        let vehicle = self.spec.vehicles.get(index)?;
        Some(Executed {
            timeline: Timeline::of(
                Departing {
                    vehicle,
                    is_airborne,
                },
                segments,
            ),
            ends,
        })
    }

    fn sortie<'m>(&self, index: usize, mission: &'m VehicleMission) -> Option<Sortie<'m>>
    where
        'a: 'm,
    {
        let vehicle = self.spec.vehicles.get(index)?;
        let sites = self.world.sites.get(index)?;
        Some(Sortie::new(self.spec, self.world, vehicle, sites, mission))
    }

    /// Whether two flights break the separation, or one lands where the other stands, as the verdict judges it.
    #[must_use]
    pub fn are_in_conflict(&self, one: &Executed<'_>, other: &Executed<'_>) -> bool {
        let on_ground = || {
            let clear_m = clear_m(self.spec.separation.distance_m);
            let both = one.ends.zip(other.ends);
            both.is_some_and(|(one, other)| one.are_in_conflict(&other, clear_m, 0.0))
        };
        on_ground() || separation::are_in_conflict(&one.timeline, &other.timeline, &self.separation)
    }
}

/// Where a flight begins, and where it ends if it does.
fn ends(flight: &Flight) -> Option<Ends> {
    let mut flown = flight.segments.iter().filter(|segment| segment.flown);
    let first = flown.next()?;
    let last = flown.next_back().unwrap_or(first);
    Some(Ends {
        begin: (first.from_s, first.from.axes_m()),
        end: flight.ends().then(|| (last.to_s, last.to.axes_m())),
    })
}
