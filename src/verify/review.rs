//! The review of a fleet's missions.

mod assumed;

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::geodesy::{Amsl, LatLon, PlanPoint};
use crate::mission::{Home, VehicleMission};
use crate::path::{Departing, max_shift_s};
use crate::spec::{MissionSpec, Separation, Span, Vehicle};
use crate::world::{Layer, VehicleSites, World};

use super::execute::executor;
use super::execute::flight::Flight;
use super::execute::home;
use super::limits::fence::Fence;
use super::limits::mission::{MissionCheck, coverage, tasks};
use super::limits::parked::{Landed, landings, landings_on_parked};
use super::limits::separation;
use super::limits::space::Space;
use super::measure::segment::Segment;
use super::measure::timeline::Timeline;
use super::{Limit, Margin, Moment, Review, Track};

/// One mission and the vehicle it is for.
pub(super) struct Sortie<'a> {
    vehicle: &'a Vehicle,
    sites: &'a VehicleSites,
    mission: &'a VehicleMission,
    /// Place of the home row, if it holds one.
    home: Option<LatLon>,
    /// Where it takes off, and the altitude that altitudes above home are measured from.
    stands: PlanPoint,
    fence: Result<Fence, String>,
    pub(super) flight: Flight,
}

/// Judges encoded missions of any source against a spec.
///
/// Each mission comes with the index of its vehicle in the spec. A vehicle without a mission
/// fails, and so does a limit that cannot be judged. The ground is `world.terrain`; `world.ground`
/// is never read.
#[must_use]
pub fn review(spec: &MissionSpec, world: &World, missions: &[(usize, &VehicleMission)]) -> Review {
    Reviewer::new(spec, world).review(missions)
}

/// Judges the missions of one spec again and again. It remembers what it found of each mission
/// until the next review, so that only those that changed are judged anew. Every review is that
/// of [`review`].
pub struct Reviewer<'a> {
    spec: &'a MissionSpec,
    world: &'a World,
    /// Indices of the vehicles of the last review.
    fleet: Vec<usize>,
    /// What is known of its missions, in their order.
    known: Vec<Option<Known>>,
    /// Separations by the positions of two missions.
    pairs: BTreeMap<(usize, usize), Margin>,
}

/// A mission, its flight, and the margins of its own.
struct Known {
    mission: VehicleMission,
    flight: Flight,
    margins: Vec<Margin>,
}

impl<'a> Reviewer<'a> {
    /// One that has judged nothing yet.
    #[must_use]
    pub fn new(spec: &'a MissionSpec, world: &'a World) -> Self {
        Self {
            spec,
            world,
            fleet: Vec::new(),
            known: Vec::new(),
            pairs: BTreeMap::new(),
        }
    }

    /// The review of a fleet's missions.
    #[must_use]
    pub fn review(&mut self, missions: &[(usize, &VehicleMission)]) -> Review {
        let (spec, world) = (self.spec, self.world);
        let mut margins = roll_call(spec, missions);
        margins.extend(other_world(spec, world));
        let missions: Vec<(usize, &VehicleMission)> = (missions.iter().copied())
            .filter(|&(index, _)| index < spec.vehicles.len().min(world.sites.len()))
            .collect();
        let (mut sorties, mut own) = self.sorties(&missions);
        let is_known: Vec<bool> = own.iter().map(Option::is_some).collect();
        // How long a stay is judged depends on the other flights.
        let ends: Vec<bool> = sorties.iter().map(|sortie| sortie.flight.ends()).collect();
        stay_long_enough(&mut sorties, &spec.buffered_separation());
        let space = Space::new(spec, world);
        (sorties.par_iter().zip(&mut own))
            .filter(|(_, own)| own.is_none())
            .for_each(|(sortie, own)| *own = Some(sortie.margins(spec, world, &space)));
        let own: Vec<Vec<Margin>> = own.into_iter().flatten().collect();
        margins.extend(own.iter().flatten().cloned());
        let contracts: Vec<MissionCheck<'_>> = sorties
            .iter()
            .map(|sortie| sortie.contract(spec, world))
            .collect();
        margins.extend(tasks::margins(spec, world, &contracts));
        margins.extend(coverage::margins(spec, world, &contracts));
        self.separate(&sorties, &is_known);
        margins.extend(self.pairs.values().cloned());
        for margin in &mut margins {
            margin.buffer += match margin.limit {
                // Zones of files may have buffers of their own, and all of the bound is one.
                Limit::Zone(_) if margin.bound.is_finite() => margin.bound,
                _ => margin.limit.buffer_of(&spec.buffers, margin.unit),
            };
        }
        let tracks = sorties.par_iter().map(|sortie| sortie.track(world));
        let tracks: Vec<Track> = tracks.collect();
        let separation_m = spec.separation.distance_m;
        margins.extend(landings(&tracks, Landed::CarriedAway, separation_m));
        let mut assumptions = assumed::of_sorties(spec, world, &sorties);
        assumptions.extend(landings_on_parked(&margins));
        let review = Review {
            margins,
            tracks,
            assumptions,
        };
        let known = sorties.into_iter().zip(own).zip(ends);
        self.known = known
            .map(|((sortie, margins), ends)| ends.then(|| sortie.known(margins)))
            .collect();
        self.fleet = missions.iter().map(|(index, _)| *index).collect();
        review
    }

    /// The missions as they are flown, and their own margins, as far as those are known.
    fn sorties<'m>(
        &mut self,
        missions: &[(usize, &'m VehicleMission)],
    ) -> (Vec<Sortie<'m>>, Vec<Option<Vec<Margin>>>)
    where
        'a: 'm,
    {
        let (spec, world) = (self.spec, self.world);
        let mut known = std::mem::take(&mut self.known);
        let is_same_fleet = (self.fleet.iter()).eq(missions.iter().map(|(index, _)| index));
        if !is_same_fleet {
            known.clear();
            self.pairs.clear();
        }
        known.resize_with(missions.len(), || None);
        let each = missions.par_iter().zip(known);
        each.map(|(&(index, mission), known)| {
            let (vehicle, sites) = (&spec.vehicles[index], &world.sites[index]);
            let known = known.filter(|known| known.mission == *mission);
            let (flight, margins) = known.map(|known| (known.flight, known.margins)).unzip();
            let flown = Sortie::flown((spec, world), vehicle, sites, mission, flight);
            (flown, margins)
        })
        .unzip()
    }

    /// Judges the separations of all pairs with one that is not known.
    fn separate(&mut self, sorties: &[Sortie<'_>], is_known: &[bool]) {
        let (positions, timelines): (Vec<usize>, Vec<Timeline<'_>>) = sorties
            .iter()
            .enumerate()
            .filter(|(_, sortie)| !sortie.flight.segments.is_empty())
            .map(|(position, sortie)| {
                (
                    position,
                    Timeline::new(sortie.departing(), &sortie.flight.segments),
                )
            })
            .unzip();
        let known: Vec<bool> = positions
            .iter()
            .map(|&position| is_known[position])
            .collect();
        let separation = self.spec.buffered_separation();
        let found = separation::margins(&timelines, &known, &separation, &self.world.frame);
        self.pairs.retain(|&(a, b), _| is_known[a] && is_known[b]);
        let found = found.into_iter();
        (self.pairs).extend(found.map(|((a, b), margin)| ((positions[a], positions[b]), margin)));
    }
}

/// Lets those that stay in the air do so until every shift of the others still meets them.
fn stay_long_enough(sorties: &mut [Sortie<'_>], separation: &Separation) {
    let last_s = sorties
        .iter()
        .map(|sortie| sortie.flight.last_s())
        .fold(0.0, f64::max);
    let late_s = max_shift_s(sorties.iter().map(|sortie| {
        let segments = sortie.flight.segments.iter();
        let most = |of: fn(&Segment) -> f64| segments.clone().map(of).fold(0.0, f64::max);
        let on_its_way = Span {
            least: 0.0 - most(|segment| segment.early_s),
            most: most(|segment| segment.late_s),
        };
        (sortie.departing(), on_its_way)
    }));
    for sortie in sorties {
        sortie
            .flight
            .stay_until(last_s + separation.time_slack_s + late_s + 1.0);
    }
}

/// A world of another spec, whose threats, zones or vehicles would be paired wrongly.
fn other_world(spec: &MissionSpec, world: &World) -> Option<Margin> {
    let of_spec = [
        spec.vehicles.len(),
        spec.threats.len(),
        spec.no_fly.len(),
        spec.tasks.len(),
    ];
    let of_world = [
        world.sites.len(),
        world.threats.len(),
        world.zones.len(),
        world.tasks.len(),
    ];
    (of_spec != of_world).then(|| {
        let why = "the world is that of another spec: numbers of vehicles, threats, zones or tasks differ";
        Margin::unjudged("", Limit::Mission, why.to_owned())
    })
}

/// Every vehicle has one mission, every mission a vehicle.
fn roll_call(spec: &MissionSpec, missions: &[(usize, &VehicleMission)]) -> Vec<Margin> {
    let mut counts = vec![0_usize; spec.vehicles.len()];
    let mut margins = Vec::new();
    for (index, _) in missions {
        match counts.get_mut(*index) {
            Some(count) => *count += 1,
            None => {
                let why = format!("a mission for vehicle {index}, which the spec does not have");
                margins.push(Margin::unjudged("", Limit::Mission, why));
            }
        }
    }
    for (vehicle, count) in spec.vehicles.iter().zip(counts) {
        let why = match count {
            0 => "mission missing".to_owned(),
            1 => continue,
            _ => format!("{count} missions for one vehicle"),
        };
        margins.push(Margin::unjudged(&vehicle.id, Limit::Mission, why));
    }
    margins
}

impl<'a> Sortie<'a> {
    pub(super) fn new(
        spec: &MissionSpec,
        world: &World,
        vehicle: &'a Vehicle,
        sites: &'a VehicleSites,
        mission: &'a VehicleMission,
    ) -> Self {
        Self::flown((spec, world), vehicle, sites, mission, None)
    }

    /// The same with the flight of the mission, where it is known.
    fn flown(
        (spec, world): (&MissionSpec, &World),
        vehicle: &'a Vehicle,
        sites: &'a VehicleSites,
        mission: &'a VehicleMission,
        flight: Option<Flight>,
    ) -> Self {
        let home = home_place(&mission.home);
        // Without a home row the rest is judged as if the vehicle stood where the spec says.
        let stands = home.map_or(sites.home, |place| PlanPoint {
            at: world.frame.to_plan(place),
            amsl: standing(world, place, &mission.home),
        });
        Self {
            vehicle,
            sites,
            mission,
            home,
            stands,
            fence: Fence::read(&mission.fence),
            flight: flight
                .unwrap_or_else(|| executor::fly(vehicle, mission, spec, world, sites, stands)),
        }
    }

    pub(super) fn departing(&self) -> Departing<'a> {
        Departing {
            vehicle: self.vehicle,
            is_airborne: self.sites.departure.is_airborne(),
        }
    }

    /// What a later review needs not find again.
    fn known(self, margins: Vec<Margin>) -> Known {
        Known {
            mission: self.mission.clone(),
            flight: self.flight,
            margins,
        }
    }

    fn contract<'c>(&'c self, spec: &'c MissionSpec, world: &'c World) -> MissionCheck<'c> {
        MissionCheck {
            spec,
            world,
            vehicle: self.vehicle,
            sites: self.sites,
            mission: self.mission,
            flight: &self.flight,
        }
    }

    pub(super) fn margins(
        &self,
        spec: &MissionSpec,
        world: &World,
        space: &Space<'_>,
    ) -> Vec<Margin> {
        let id = &self.vehicle.id;
        let none = Fence::default();
        let fence = self.fence.as_ref().unwrap_or(&none);
        let contract = self.contract(spec, world);
        let mut margins = contract.margins(self.home, fence);
        let layer = Layer::of(self.vehicle.altitudes, &spec.buffers);
        let layer = layer.over_lower_ground(world.terrain.raised_m());
        margins.extend(space.margins(self.vehicle, layer, &self.flight, fence));
        if home::counts_from_home(self.mission) {
            home::note_cost(&mut margins, self.stands.amsl);
        }
        if let Err(why) = &self.fence {
            margins.push(Margin::unjudged(id, Limit::Fence, why.clone()));
        }
        let wind = spec.wind.filter(|wind| wind.speed_mps > 0.0);
        if self.vehicle.airframe.has_wing() && self.vehicle.carried_by() != wind {
            let why = "the wind of the spec is not the one that carries this wing";
            margins.push(Margin::unjudged(id, Limit::Wind, why));
        }
        margins.extend(space.rally_margins((id, layer), self.mission, self.stands.amsl, fence));
        margins
    }

    /// Whether the mission holds an item of this command.
    fn holds(&self, command: u16) -> bool {
        let mut items = self.mission.items.iter();
        items.any(|item| item.command == command)
    }

    /// The ends of every flown segment. Velocity is constant between them, so nothing is lost.
    fn track(&self, world: &World) -> Track {
        // A circle that is flown for ever is drawn once.
        let circles = self.flight.circle.map(|circle| circle.segment);
        let segments = self.flight.segments.iter().enumerate();
        let repetition = self.flight.repetition;
        let flown = segments.filter(|(index, segment)| {
            segment.flown && ![circles, repetition].contains(&Some(*index))
        });
        let mut ends: Vec<(Moment, f64)> = flown
            .flat_map(|(_, segment)| {
                [0.0, 1.0].map(|u| (segment.moment(&world.frame, u), segment.late_s))
            })
            .collect();
        ends.dedup_by(|next, end| {
            let is_same = next.0 == end.0;
            if is_same {
                end.1 = end.1.max(next.1);
            }
            is_same
        });
        let (moments, late_s) = ends.into_iter().unzip();
        Track {
            vehicle: self.vehicle.id.clone(),
            moments,
            late_s,
        }
    }
}

/// The place of a home row; a blank one (0, 0) is none.
fn home_place(home: &Home) -> Option<LatLon> {
    if home.x == 0 && home.y == 0 {
        return None;
    }
    LatLon::new(f64::from(home.x) / 1e7, f64::from(home.y) / 1e7).ok()
}

/// The altitude at which a vehicle stands at the place of its home row: that of the
/// ground. Autopilots take home from where they are, not from a file; what the row
/// says only stands in where the ground is not known, and then that fails.
fn standing(world: &World, place: LatLon, row: &Home) -> Amsl {
    world
        .terrain
        .height(place)
        .unwrap_or(Amsl(f64::from(row.amsl_m)))
}
