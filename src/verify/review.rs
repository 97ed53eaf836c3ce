//! The review of a fleet's missions.

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::autopilot::{Airframe, Autopilot, facts, parameter};
use crate::geodesy::{Amsl, LatLon, PlanPoint};
use crate::mission::{Home, Item, VehicleMission, command};
use crate::path::most_shift_s;
use crate::spec::{MissionSpec, Separation, Span, Vehicle};
use crate::world::{Layer, Stations, Terrain, World};

use super::execute::executor;
use super::execute::flight::{End, Flight};
use super::execute::home;
use super::limits::assumptions;
use super::limits::fence::Fence;
use super::limits::mission::{Contract, coverage, tasks};
use super::limits::separation;
use super::limits::space::Space;
use super::measure::segment::Chord;
use super::measure::timeline::Timeline;
use super::{Limit, Margin, Moment, Review, Track};

/// One mission and the vehicle it is for.
pub(super) struct Sortie<'a> {
    vehicle: &'a Vehicle,
    stations: &'a Stations,
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
            .filter(|&(index, _)| index < spec.vehicles.len().min(world.stations.len()))
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
        let contracts: Vec<Contract<'_>> = sorties
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
        let review = Review {
            margins,
            tracks: sorties.iter().map(|sortie| sortie.track(world)).collect(),
            assumptions: assumptions(spec, world, &sorties),
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
            let (vehicle, stations) = (&spec.vehicles[index], &world.stations[index]);
            let known = known.filter(|known| known.mission == *mission);
            let (flight, margins) = known.map(|known| (known.flight, known.margins)).unzip();
            let flown = Sortie::flown((spec, world), vehicle, stations, mission, flight);
            (flown, margins)
        })
        .unzip()
    }

    /// Judges the separations of all pairs with one that is not known.
    fn separate(&mut self, sorties: &[Sortie<'_>], is_known: &[bool]) {
        let (positions, timelines): (Vec<usize>, Vec<Timeline<'_>>) = sorties
            .iter()
            .enumerate()
            .filter(|(_, sortie)| !sortie.flight.chords.is_empty())
            .map(|(position, sortie)| {
                (
                    position,
                    Timeline::new(sortie.vehicle, &sortie.flight.chords),
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
    let late_s = most_shift_s(sorties.iter().map(|sortie| {
        let chords = sortie.flight.chords.iter();
        let most = |of: fn(&Chord) -> f64| chords.clone().map(of).fold(0.0, f64::max);
        let on_its_way = Span {
            least: 0.0 - most(|chord| chord.early_s),
            most: most(|chord| chord.late_s),
        };
        (sortie.vehicle, on_its_way)
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
        world.stations.len(),
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
        stations: &'a Stations,
        mission: &'a VehicleMission,
    ) -> Self {
        Self::flown((spec, world), vehicle, stations, mission, None)
    }

    /// The same with the flight of the mission, where it is known.
    fn flown(
        (spec, world): (&MissionSpec, &World),
        vehicle: &'a Vehicle,
        stations: &'a Stations,
        mission: &'a VehicleMission,
        flight: Option<Flight>,
    ) -> Self {
        let home = home_place(&mission.home);
        // Without a home row the rest is judged as if the vehicle stood where the spec says.
        let stands = home.map_or(stations.home, |place| PlanPoint {
            at: world.frame.to_plan(place),
            amsl: standing(world, place, &mission.home),
        });
        let tolerance_m = spec.mission.tolerance_m;
        Self {
            vehicle,
            stations,
            mission,
            home,
            stands,
            fence: Fence::read(&mission.fence),
            flight: flight.unwrap_or_else(|| {
                executor::fly(vehicle, mission, world, stations, stands, tolerance_m)
            }),
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

    fn contract<'c>(&'c self, spec: &'c MissionSpec, world: &'c World) -> Contract<'c> {
        Contract {
            spec,
            world,
            vehicle: self.vehicle,
            stations: self.stations,
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
        margins.extend(space.margins(id, layer, &self.flight, fence));
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
        margins.extend(space.rally_margins(id, self.mission, self.stands.amsl, fence));
        margins
    }

    /// Whether the mission holds an item of this command.
    fn holds(&self, command: u16) -> bool {
        let mut items = self.mission.items.iter();
        items.any(|item| item.command == command)
    }

    /// The ends of every flown chord. Velocity is constant between them, so nothing is lost.
    fn track(&self, world: &World) -> Track {
        // A circle that is flown for ever is drawn once.
        let circles = self.flight.circle.map(|circle| circle.chord);
        let chords = self.flight.chords.iter().enumerate();
        let repetition = self.flight.repetition;
        let flown = chords
            .filter(|(index, chord)| chord.flown && ![circles, repetition].contains(&Some(*index)));
        let mut moments: Vec<Moment> = flown
            .flat_map(|(_, chord)| [0.0, 1.0].map(|u| chord.moment(&world.frame, u)))
            .collect();
        moments.dedup();
        Track {
            vehicle: self.vehicle.id.clone(),
            moments,
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

/// How far from home the furthest rally point of a vehicle with ArduPilot lies, metres.
fn furthest_rally_m(sorties: &[Sortie<'_>]) -> f64 {
    sorties
        .iter()
        .filter(|s| s.mission.autopilot == Autopilot::ArduPilot)
        .flat_map(|s| {
            let home = s.home.unwrap_or(s.vehicle.home);
            let points = s.mission.rally.iter().filter_map(Item::place);
            points.map(move |place| place.chord_m(home))
        })
        .fold(0.0, f64::max)
}

/// What the flight model assumes of every mission.
const ASSUMED: [&str; 4] = [
    "legs are straight in the local frame, altitude linear with distance",
    "corners are flown as arcs, on a wing at unchanged speed with the turn radius; the legs are judged as far as the corner too",
    "vehicles speed up and slow down with accel_mps2, climb and descend vertically with climb_mps and descent_mps",
    "each vehicle stands on the ground at the place of its home row when its mission starts, and takes that for home",
];

/// What the flight model assumes of some missions: the condition, and the text with figures of
/// [`crate::autopilot`] as `{vehicle.figure}` or `{PARAMETER}`.
type Assumption = (fn(&Sortie<'_>) -> bool, &'static str);

const ASSUMED_OF_SOME: &[Assumption] = &[
    (
        |s| s.vehicle.airframe != Airframe::Plane,
        "copters and vtol are up to {copter.takeoff_late_s} late from their takeoff on, all of one autopilot and airframe alike, and up to {copter.stop_late_s} more \
         after every stop: separation holds for any lateness up to that (measured on five ArduCopters 4.7.0-dev, simulated: \
         over their homes 6 s late, on their way 6 to 8.5 s, over a ridge 8 to 12 s, after a stop 4.4 s more, at most 0.9 m beside the way \
         and 1 m over or under it; of others assumed): those of one kind differ by up to 5.5 s, which time_slack_s must cover",
    ),
    (
        |s| s.mission.autopilot == Autopilot::ArduPilot && s.vehicle.airframe == Airframe::Copter,
        "ArduCopter slows down for corners as far as WPNAV_RADIUS and a jerk of 1 m/s3 ask for, cuts them within that radius, and is up to \
         {copter.corner_late_s} later after each (measured on 4.6.3, simulated, still air: speeds within 0.2 m/s, legs within 0.3 s); \
         it stops before a landing at another place and where altitudes above terrain begin or end",
    ),
    (
        |s| {
            s.holds(command::NAV_SPLINE_WAYPOINT)
                || s.holds(command::NAV_LOITER_TURNS)
                || s.holds(command::NAV_PAYLOAD_PLACE)
        },
        "splines, turns and the placing of payloads are flown as the sources of ArduCopter 4.7 say (CIRCLE_RADIUS {CIRCLE_RADIUS} m and CIRCLE_RATE {CIRCLE_RATE} degrees a second \
         where the .params file has none); none of them was measured, and each may take {copter.stop_late_s} longer",
    ),
    (
        |s| {
            let circles = [
                command::NAV_LOITER_TURNS,
                command::NAV_LOITER_TIME,
                command::NAV_LOITER_TO_ALT,
            ];
            s.vehicle.airframe.has_wing() && circles.into_iter().any(|circle| s.holds(circle))
        },
        "a wing that leaves a circle is judged anywhere between that circle and its next place, and as late as 1.25 orbits more take: ArduPlane circles until it heads for the next place, \
         PX4 leaves on any course (by their sources, not measured)",
    ),
    (
        |s| s.mission.autopilot == Autopilot::Px4 && s.vehicle.airframe == Airframe::Copter,
        "PX4 copters fly corners as arcs within NAV_ACC_RAD, at the speed that half of accel_mps2 allows across (by its sources, not measured)",
    ),
    (
        |s| s.mission.autopilot == Autopilot::Px4 && s.vehicle.airframe == Airframe::Copter,
        "PX4 copters are up to {px4_copter.leg_late_s} later after every leg, and separation holds for any lateness up to that (measured on six PX4 1.16 alpha, simulated, still air: \
         6 to 10 s late over their homes, 1 to 1.7 s more after a corner or a change of slope, 20.7 s more after 23 legs, 4.6 s with a turn back, at most 2.1 m beside \
         the way and 2.2 m over or under it); that the airframe can fly the speed of the spec, also in a descent, is assumed: one that could not was 44 s late after 7 minutes",
    ),
    (
        |s| {
            s.flight
                .cruises
                .iter()
                .any(|cruise| cruise.speed_mps.is_none())
                && s.mission.autopilot == Autopilot::Px4
        },
        "PX4 flies with the speed of the spec: MPC_XY_CRUISE (on a wing FW_AIRSPD_TRIM) as in its .params file",
    ),
    (
        |s| {
            let is_launched = executor::is_launched(s.vehicle, s.mission.autopilot);
            is_launched && s.flight.delay_s.is_none() && s.vehicle.depart_s > 0.0
        },
        "PX4 vehicles, planes and vtol are started depart_s after T0 by the station that launches them",
    ),
    (
        |s| s.holds(command::NAV_RETURN_TO_LAUNCH),
        "a return to launch climbs to return_amsl_m however near home it begins, flies straight home and lands at once: RTL_ALT, RTL_CONE_SLOPE and RTL_LOIT_TIME (PX4: RTL_RETURN_ALT, RTL_CONE_ANG and RTL_LAND_DELAY) as in the .params file of the vehicle",
    ),
    (
        |s| s.mission.autopilot == Autopilot::Px4 && s.holds(command::DO_CHANGE_SPEED),
        "PX4 obeys DO_CHANGE_SPEED: a copter was seen to stick or to drift off with it, leave it out and set MPC_XY_CRUISE",
    ),
    (
        |s| home::counts_from_home(s.mission),
        "altitudes above home count from the ground under the home row; a home that lies lower, or is measured too high, takes as much from every clearance",
    ),
    (
        |s| s.flight.follows_terrain,
        "vehicles that follow the terrain have the same elevation data and keep their height above it exactly",
    ),
    (
        |s| s.flight.takeoff_rad.is_some(),
        "a plane stands on the course of its takeoff, runs with accel_mps2 on the ground, and climbs straight at its planned speed with climb_mps, no steeper than max_climb_deg, to the height of the takeoff item",
    ),
    (
        |s| s.flight.takeoff_rad.is_some() && s.mission.autopilot == Autopilot::ArduPilot,
        "ArduPlane climbs out more steeply (4.7.0-dev, simulated: 10 m/s where 3 were planned, the height reached after {plane.climb_out_share} of the planned climb, \
         {plane.climb_out_overshoot_m} over it for some seconds) and holds its heading, so that the wind carries it off for {plane.drift_share} of the planned climb: the ceiling is judged {plane.climb_out_overshoot_m} over that height and the way on from {plane.climb_out_share} of the climb, \
         also as far downwind, separation counts with the height in between and with up to {plane.takeoff_early_s} early",
    ),
    (
        |s| s.mission.autopilot == Autopilot::ArduPilot && s.vehicle.airframe.has_wing(),
        "a wing of ArduPlane gains up to {plane.early_share} of the time since its takeoff (4.7.0-dev, simulated, up to 6 m/s of wind; airspeed sensors are off as much): separation holds for any earliness up to that",
    ),
    (
        |s| s.mission.autopilot == Autopilot::ArduPilot && s.flight.circle.is_some(),
        "ArduPlane is up to {plane.circle_wide_share} of its turn radius further out than the radius of its circle (4.7.0-dev, simulated: 46 m at 20 m/s on a circle of 80 m)",
    ),
    (
        |s| s.flight.takeoff_rad.is_some() && s.mission.autopilot == Autopilot::Px4,
        "separation counts with a plane up to {plane.takeoff_early_s} early at its start, as ArduPlane was; that a PX4 plane climbs out more steeply than planned \
         (1.16 alpha, simulated: 36 m above the planned line) is not judged",
    ),
    (
        |s| s.vehicle.airframe.has_wing(),
        "a wing flies at its planned indicated airspeed all the way, faster through thinner air as the standard atmosphere has it, on a warm day \
         by 1 % more for every 6 degrees, and turns with max_load_factor; turns of more than a right angle follow waypoints on the way around",
    ),
    (
        |s| s.mission.autopilot == Autopilot::ArduPilot && s.vehicle.airframe.has_wing(),
        "ArduPlane flies changes of altitude smaller than ALT_SLOPE_MIN (before 4.7 GLIDE_SLOPE_MIN; as in the .params file, else {ALT_SLOPE_MIN} m) at once, \
         and is {plane.altitude_lag_s} of its climb under a slope upwards and as much over one downwards (measured: 3 m at 1 m/s, 5 m at 1.6 m/s, 11 m at 2.9 m/s): \
         such legs are judged there too, but not the separation there, nor the lag over ground that is followed",
    ),
    (
        |s| {
            let is_quadplane =
                s.mission.autopilot == Autopilot::ArduPilot && s.vehicle.airframe == Airframe::Vtol;
            is_quadplane && s.vehicle.wing.is_some_and(|wing| wing.wind.is_some())
        },
        "a QuadPlane may be driven off to any side as it climbs, with {quadplane.drift_share} of the wind and {quadplane.drift_s} of it more until it is on its first leg (4.7.0-dev, simulated, up to 5 m/s): \
         climb and first leg are judged there too; its landing is not. In more than {quadplane.max_wind_mps} it was driven off by up to 267 m, and the verdict fails",
    ),
    (
        |s| s.mission.autopilot == Autopilot::ArduPilot && s.vehicle.airframe == Airframe::Vtol,
        "a QuadPlane goes on from its climb where its nose points, anywhere, and turns from there: it is judged anywhere within {quadplane.transition_m} and two turn radii of the end of its climb, and between there and its first place (4.7.0-dev, simulated, nose backwards: 180 m beside its first leg)",
    ),
    (
        |s| s.mission.autopilot == Autopilot::Px4 && s.vehicle.airframe.has_wing(),
        "PX4 on a wing is {px4_plane.altitude_lag_s} of its climb under a slope upwards and as much over one downwards, by its sources with FW_T_HRATE_FF 0.3 and FW_T_ALT_TC 5: \
         such legs are judged there too, and with the altitude of their end NAV_LOITER_RAD before it, by its sources as well (neither was measured)",
    ),
    (
        |s| s.mission.autopilot == Autopilot::ArduPilot && s.vehicle.airframe.has_wing(),
        "ArduPlane swings out of corners: it is judged along the way of its L1 law too, with NAVL1_PERIOD and NAVL1_DAMPING (default {NAVL1_PERIOD} and {NAVL1_DAMPING}), WP_RADIUS and ROLL_LIMIT_DEG, \
         at {plane.turning_share} of a coordinated turn, and separation counts with what that way is beside the legs (measured on 4.7.0-dev, simulated, at 18 m/s with a bank of 34 degrees: \
         2 m at 5 degrees, 10 m at 30, 15 m at 60, 30 m at 90, 74 m at 120, which this law gives or up to 45 % more; in still air, the wind is added as the law has it)",
    ),
    (
        |s| s.mission.autopilot == Autopilot::Px4 && s.vehicle.airframe.has_wing(),
        "a wing of PX4 keeps to its legs and arcs: what it swings out of corners was not measured and is not judged",
    ),
    (
        |s| s.flight.landing.is_some(),
        "a plane glides straight from the waypoint before its landing to the place of the landing: flare and roll are not judged; on a climb-out or glide the ground must stay half of the height above the runway below the vehicle, until that is min_agl_m",
    ),
    (
        |s| s.flight.circle.is_some(),
        "a circle is entered between its tangent and the straight way to its middle, and from then on the vehicle may be anywhere on it",
    ),
    (
        |s| s.vehicle.airframe == Airframe::Vtol,
        "a vtol climbs and lands vertically over its positions, with climb_mps and descent_mps, and speeds up and slows down on its way with accel_mps2",
    ),
    (
        |s| s.flight.end == Some(End::Repeats),
        "a mission that repeats for ever (DO_JUMP -1) is judged with one lap more; from then on the vehicle may be anywhere around that lap, for the separation; how long it lasts is not judged",
    ),
    (
        |s| matches!(s.flight.end, Some(End::Stays(_))) && s.flight.circle.is_none(),
        "a vehicle that loiters, or whose mission ends in the air, hovers there for ever",
    ),
];

/// Kinds of vehicles whose figures the texts name.
const KINDS: [(&str, Autopilot, Airframe); 5] = [
    ("copter", Autopilot::ArduPilot, Airframe::Copter),
    ("plane", Autopilot::ArduPilot, Airframe::Plane),
    ("quadplane", Autopilot::ArduPilot, Airframe::Vtol),
    ("px4_copter", Autopilot::Px4, Airframe::Copter),
    ("px4_plane", Autopilot::Px4, Airframe::Plane),
];

/// A text of an assumption with its figures: `{plane.bank_lag_s}` is the figure of that name in
/// the table of a plane, `{NAVL1_PERIOD}` the default of a parameter in SI units.
fn with_figures(text: &str) -> String {
    let (mut filled, mut rest) = (String::new(), text);
    while let Some((before, name, after)) = placeholder(rest) {
        filled += before;
        filled += &figure(name).unwrap_or_else(|| name.to_owned());
        rest = after;
    }
    filled + rest
}

/// The first name in braces, with the text before and after it.
fn placeholder(text: &str) -> Option<(&str, &str, &str)> {
    let (before, rest) = text.split_once('{')?;
    let (name, after) = rest.split_once('}')?;
    Some((before, name, after))
}

fn figure(name: &str) -> Option<String> {
    let Some((kind, name)) = name.split_once('.') else {
        return parameter(name).map(|row| row.default_si().to_string());
    };
    let (_, autopilot, airframe) = KINDS.into_iter().find(|(known, ..)| *known == kind)?;
    let figures = facts(autopilot, airframe).behaviour.figures();
    let found = figures.into_iter().find(|(known, _)| *known == name)?;
    Some(found.1.to_string())
}

/// What the flight model assumes and used.
fn assumptions(spec: &MissionSpec, world: &World, sorties: &[Sortie<'_>]) -> Vec<String> {
    let used = ASSUMED_OF_SOME
        .iter()
        .filter(|(is_used, _)| sorties.iter().any(is_used))
        .map(|(_, text)| *text);
    let unknown = (world.terrain == Terrain::Unknown)
        .then_some("the ground is not known: landings end at the altitude of home");
    let texts = ASSUMED.into_iter().chain(used).chain(unknown);
    let mut list: Vec<String> = texts.map(with_figures).collect();
    let flown = || sorties.iter().map(|s| (s.vehicle, &s.flight));
    list.extend(assumptions::raised_ground(world.terrain.raised_m()));
    list.extend(assumptions::windy_copters(flown(), spec.wind));
    list.extend(assumptions::leaning_copters(flown(), spec));
    list.extend(assumptions::carried_wings(
        sorties.iter().map(|s| s.vehicle),
    ));
    list.extend(assumptions::bent_map(flown(), world));
    list.extend(assumptions::other_posts(
        sorties.iter().map(|s| &s.flight),
        world,
    ));
    list.extend(assumptions::rally_limit(furthest_rally_m(sorties)));
    list.extend(separation::assumption(
        sorties.len(),
        &spec.buffered_separation(),
    ));
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn assumptions_state_the_figures_of_the_table() {
        let mut named = Vec::new();
        for (_, text) in ASSUMED_OF_SOME {
            let mut rest = *text;
            while let Some((_, name, after)) = placeholder(rest) {
                assert!(figure(name).is_some(), "{name}");
                named.push(name);
                rest = after;
            }
        }
        for (kind, autopilot, airframe) in KINDS {
            for (name, found) in facts(autopilot, airframe).behaviour.figures() {
                let is_named = named.contains(&format!("{kind}.{name}").as_str());
                let text = found.to_string();
                assert!(!is_named || text != "nothing", "{kind}.{name}");
            }
        }
        let texts: Vec<String> = ASSUMED_OF_SOME
            .iter()
            .map(|(_, t)| with_figures(t))
            .collect();
        for expected in [
            "up to 12 s late",
            "up to 4.5 s more",
            "up to 1.5 s later",
            "after 0.4 of the planned climb, 14 m over it",
            "with up to 10 s early",
            "else 15 m) at once",
            "is 3.3 s of its climb",
            "with 0.31 of the wind and 21 s of it more",
            "is 3.5 s of its climb",
            "default 17 and 0.75",
            "at 0.7 of a coordinated turn",
        ] {
            assert!(
                texts.iter().any(|text| text.contains(expected)),
                "{expected}"
            );
        }
    }
}
