//! Zones that become active or inactive while vehicles fly.
//!
//! Each vehicle is planned through all zones that may be inactive as it is there. The verdict, which
//! knows the times and how late autopilots are, says which of them it enters while they are active.
//! Where its window of departures allows that, the vehicle departs so that it passes them in time;
//! else it keeps out of them, and the fleet is planned again.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::{DETOUR, entered_in_time, keep, straight_s};
use crate::dispatch::{Dispatched, Job};
use crate::geodesy::PlanPoint;
use crate::numeric::geometry;
use crate::spec::{MissionSpec, Span, wait_less};
use crate::verify::{VerifiedTrajectory, verified_trajectories};
use crate::world::{OwnWorld, PlanZone, World};

/// Most plans of a fleet.
const MAX: usize = 8;
/// A vehicle departs at another time for one path, and once more for the next.
const MAX_DEPARTURES: usize = 3;
/// Beyond what the verdict needs, seconds.
const SPARE_S: f64 = 1.0;
/// A flight is looked at in steps of this length, metres.
const STEP_M: f64 = 10.0;

/// Which zones each vehicle is planned through, by their indices, and when it departs.
struct Choice {
    spec: MissionSpec,
    open: Vec<BTreeSet<usize>>,
    departures: Vec<usize>,
}

/// A plan that passes and in which vehicles fly through zones outside of their times. None if there is
/// none, or if no zone can be inactive as a vehicle is there. `known` is what is planned from one spec
/// for all vehicles.
pub(super) fn in_time(
    job: Job<'_>,
    known: Option<(&MissionSpec, &Dispatched)>,
    dispatch_closed: &impl Fn(Job<'_>) -> Dispatched,
) -> Option<Dispatched> {
    let mut choice = Choice::first(job);
    for _ in 0..MAX {
        if choice.open.iter().all(BTreeSet::is_empty) || job.run.is_cancelled() {
            return None;
        }
        let (spec, world) = choice.variant(job.world);
        let planned = Job {
            spec: &spec,
            world: &world,
            ..job
        };
        let is_common = world.own.iter().all(Option::is_none);
        let same = known.filter(|(known, _)| is_common && **known == spec);
        let found = same.map_or_else(|| dispatch_closed(planned), |(_, found)| found.clone());
        if found.review.passes() {
            return Some(found.with_waits_of(&spec, job.spec));
        }
        let entered = entered_in_time(planned, &found);
        if entered.is_empty() {
            return None;
        }
        choice.learn(job, &found, &entered);
    }
    None
}

impl Choice {
    /// Through all zones that are not active from the first to the last second of a flight.
    fn first(job: Job<'_>) -> Self {
        let (spec, world) = (job.spec, job.world);
        let fleet = spec.vehicles.iter().zip(&world.sites);
        let open = fleet.map(|(vehicle, sites)| {
            let departures = vehicle.departures();
            let first_s = departures.least.min(vehicle.depart_s);
            let last_s =
                departures.most.max(vehicle.depart_s) + DETOUR * straight_s(vehicle, sites);
            let may_be_open = |zone: &PlanZone| {
                let is_always = |(from_s, to_s): (f64, f64)| from_s <= first_s && last_s <= to_s;
                zone.active_s.is_some_and(|active_s| !is_always(active_s))
            };
            let zones = world.zones.iter().enumerate();
            let open = zones.filter(|(_, zone)| may_be_open(zone));
            open.map(|(index, _)| index).collect()
        });
        Self {
            open: open.collect(),
            departures: vec![0; spec.vehicles.len()],
            spec: spec.clone(),
        }
    }

    /// The spec and world that vehicles are planned from: those without the zones that all pass, and
    /// in them what single ones have instead.
    fn variant(&self, world: &World) -> (MissionSpec, World) {
        let mut sets = self.open.iter();
        let first = sets.next().cloned().unwrap_or_default();
        let common = sets.fold(first, |common, set| &common & set);
        let mut made: Vec<(&BTreeSet<usize>, Arc<OwnWorld>)> = Vec::new();
        let mut own: Vec<Option<Arc<OwnWorld>>> = Vec::new();
        for set in &self.open {
            let known = made.iter().find(|(of, _)| *of == set);
            own.push(match known {
                _ if *set == common => None,
                Some((_, same)) => Some(Arc::clone(same)),
                None => {
                    let (spec, world) = without(&self.spec, world, set);
                    let new = Arc::new(OwnWorld { spec, world });
                    made.push((set, Arc::clone(&new)));
                    Some(new)
                }
            });
        }
        let (spec, world) = without(&self.spec, world, &common);
        (spec, World { own, ..world })
    }

    /// Changes the departures of vehicles that enter zones while these are active, or closes the zones
    /// for them.
    fn learn(&mut self, job: Job<'_>, found: &Dispatched, entered: &[(usize, usize)]) {
        let missions: Vec<_> = (found.missions.iter())
            .map(|(vehicle, mission)| (*vehicle, mission))
            .collect();
        let retimed = found.plan.retimed(job.spec);
        let flown = verified_trajectories(&retimed, job.world, &missions);
        let vehicles: BTreeSet<usize> = entered.iter().map(|(vehicle, _)| *vehicle).collect();
        for vehicle in vehicles {
            let specified = &job.spec.vehicles[vehicle];
            let flight = flown.iter().find(|of| of.vehicle == specified.id);
            let open = flight
                .filter(|_| self.departures[vehicle] < MAX_DEPARTURES)
                .zip(specified.retiming.depart_s)
                .and_then(|(flight, window)| {
                    let zones = self.open[vehicle]
                        .iter()
                        .map(|&zone| &job.world.zones[zone]);
                    let times = occupied((job.spec, job.world), flight, zones);
                    let depart_s = found.plan.vehicles[vehicle].depart_s;
                    free_departures(&times, depart_s, (window, specified.depart_s))
                });
            let own = &mut self.spec.vehicles[vehicle];
            if let Some(span) = open {
                self.departures[vehicle] += 1;
                own.retiming.depart_s = Some(span);
                own.depart_s = specified.depart_s.clamp(span.least, span.most);
                own.stops.clone_from(&specified.stops);
                wait_less(&mut own.stops, own.depart_s - specified.depart_s);
                continue;
            }
            (own.retiming, own.depart_s) = (specified.retiming, specified.depart_s);
            own.stops.clone_from(&specified.stops);
            self.departures[vehicle] = 0;
            for (_, zone) in entered.iter().filter(|(of, _)| *of == vehicle) {
                self.open[vehicle].remove(zone);
            }
        }
    }
}

/// A spec and a world without some of the zones.
fn without(spec: &MissionSpec, world: &World, open: &BTreeSet<usize>) -> (MissionSpec, World) {
    let stays: Vec<bool> = (0..world.zones.len())
        .map(|zone| !open.contains(&zone))
        .collect();
    let (mut spec, mut world) = (spec.clone(), world.clone());
    keep(&mut spec.no_fly, &stays);
    keep(&mut world.zones, &stays);
    (spec, world)
}

/// By how many seconds a flight may not be shifted, one span for each time that it is in a zone: with
/// what it may be early or late there, as the verdict has it.
fn occupied<'z>(
    (spec, world): (&MissionSpec, &World),
    flight: &VerifiedTrajectory,
    zones: impl Iterator<Item = &'z PlanZone>,
) -> Vec<(f64, f64)> {
    let spare_s = spec.separation.time_slack_s + SPARE_S;
    let mut spans = Vec::new();
    for zone in zones {
        let Some((from_s, to_s)) = zone.active_s else {
            continue;
        };
        for segment in &flight.segments {
            let place = |moment: &crate::verify::Moment| PlanPoint {
                at: world.frame.to_plan(moment.place),
                amsl: moment.amsl,
            };
            let (from, to) = (place(&segment.from), place(&segment.to));
            let Some((enters, leaves)) = meets(zone, from, to) else {
                continue;
            };
            let takes_s = segment.to.t_s - segment.from.t_s;
            let (before_s, after_s) = match segment.is_flown {
                // Some stay for ever.
                true if takes_s.is_infinite() => (0.0, takes_s),
                true => (enters * takes_s, leaves * takes_s),
                // What is not flown stands for what is flown somewhere in its time.
                false => (-takes_s, 2.0 * takes_s),
            };
            let shift_s = flight.takeoff_late_s;
            let begins_s = segment.from.t_s + before_s + shift_s.least - segment.early_s;
            let ends_s = segment.from.t_s + after_s + shift_s.most + segment.late_s;
            spans.push((from_s - ends_s - spare_s, to_s - begins_s + spare_s));
        }
    }
    spans
}

/// From which to which share of itself a straight motion is over or under a zone, or in it, to the
/// next step: heights are left to the verdict.
fn meets(zone: &PlanZone, from: PlanPoint, to: PlanPoint) -> Option<(f64, f64)> {
    let steps = geometry::steps(from.at.distance_m(to.at), STEP_M, (1, 1000));
    let share = |step: u16| (f64::from(step) / f64::from(steps)).min(1.0);
    let is_in = |step: &u16| zone.contains(from.toward(to, share(*step)).at);
    let first = (0..=steps).find(is_in)?;
    let last = (first..=steps).rfind(is_in)?;
    Some((share(first.saturating_sub(1)), share(last + 1)))
}

/// The departures of a window around the one nearest to the specified that no span forbids.
fn free_departures(
    forbidden: &[(f64, f64)],
    departs_s: f64,
    (window, specified_s): (Span, f64),
) -> Option<Span> {
    let mut spans: Vec<(f64, f64)> = forbidden
        .iter()
        .map(|(from_s, to_s)| (departs_s + from_s, departs_s + to_s))
        .collect();
    spans.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut free = Vec::new();
    let mut least = window.least;
    for (from_s, to_s) in spans {
        if from_s > least {
            free.push(Span {
                least,
                most: from_s.min(window.most),
            });
        }
        least = least.max(to_s);
    }
    free.push(Span {
        least,
        most: window.most,
    });
    let away_s = |span: &Span| {
        let nearest_s = specified_s.clamp(span.least, span.most);
        (nearest_s - specified_s).abs()
    };
    let usable = free.into_iter().filter(|span| span.least <= span.most);
    usable.min_by(|a, b| away_s(a).total_cmp(&away_s(b)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn free(forbidden: &[(f64, f64)], specified_s: f64) -> Option<(f64, f64)> {
        let window = Span {
            least: 0.0,
            most: 100.0,
        };
        let span = free_departures(forbidden, 10.0, (window, specified_s));
        span.map(|span| (span.least, span.most))
    }

    #[test]
    fn a_departure_is_between_all_that_is_forbidden_and_near_the_specified_one() {
        assert_eq!(free(&[], 20.0), Some((0.0, 100.0)));
        // Shifts are by the departure that is flown.
        assert_eq!(free(&[(-20.0, 10.0)], 0.0), Some((20.0, 100.0)));
        assert_eq!(
            free(&[(-20.0, 10.0), (50.0, 200.0)], 0.0),
            Some((20.0, 60.0))
        );
        assert_eq!(
            free(&[(20.0, 30.0), (5.0, 15.0)], 90.0),
            Some((40.0, 100.0))
        );
        assert_eq!(free(&[(20.0, 30.0), (5.0, 15.0)], 16.0), Some((0.0, 15.0)));
        assert_eq!(free(&[(-20.0, 60.0), (50.0, 200.0)], 0.0), None);
    }
}
