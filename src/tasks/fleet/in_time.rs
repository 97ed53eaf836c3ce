//! Stops and tasks whose places lie in zones with times.
//!
//! When a vehicle is in such a zone on its way to a place and from it is estimated: first that it crosses
//! as little of the zone as there is between the place and its edge, then twice as much, and so on.

use super::{Assigner, PER_SECOND, visits, whole};
use crate::geodesy::PlanPoint;
use crate::numeric::geometry::{self, Ring};
use crate::tasks::assignment::{Assignment, Carrier, Form, Job};
use crate::world::PlanZone;

/// As often estimates of what is crossed are doubled.
const MAX_DOUBLED: u8 = 2;
/// Lines are looked at in steps of this length, metres.
const STEP_M: f64 = 10.0;

/// The zones with times that places lie in.
#[derive(Clone, Debug)]
pub(super) struct InTime {
    doubled: u8,
    /// For each place the index of each zone, and how far it is to its edge, metres.
    zones: Vec<Vec<(usize, f64)>>,
}

impl Assigner<'_> {
    /// From now on no vehicle is at a place in a zone during its time; with each call it stays further
    /// from these times. False where no place lies in such a zone, or after the last.
    pub fn minds_times(&mut self) -> bool {
        if let Some(known) = &mut self.in_time {
            known.doubled += 1;
            return known.doubled <= MAX_DOUBLED;
        }
        let mut zones: Vec<Vec<(usize, f64)>> = self
            .points
            .iter()
            .map(|point| self.timed_zones(*point))
            .collect();
        for unit in self.units.iter().filter(|unit| unit.line.is_some()) {
            let corners = unit.sites.windows(2);
            let crossed = corners.flat_map(|pair| self.timed_zones_between(pair[0], pair[1]));
            let mut crossed: Vec<(usize, f64)> = crossed.map(|zone| (zone, 0.0)).collect();
            crossed.sort_by_key(|(zone, _)| *zone);
            crossed.dedup_by_key(|(zone, _)| *zone);
            for &site in &unit.sites {
                zones[site].clone_from(&crossed);
            }
        }
        if zones.iter().all(Vec::is_empty) {
            return false;
        }
        self.in_time = Some(InTime { doubled: 0, zones });
        true
    }

    /// The zones with times that a point lies in, by their indices, and how far it is to their edges, metres.
    fn timed_zones(&self, point: PlanPoint) -> Vec<(usize, f64)> {
        let ground = self.world.terrain.height_at(&self.world.frame, point.at);
        let ground_m = ground.map_or(f64::NAN, |ground| ground.0);
        let zones = self.world.zones.iter().enumerate();
        let timed = zones.filter(|(_, zone)| {
            zone.active_s.is_some() && zone.is_closed_at(point, ground_m, f64::NAN)
        });
        timed
            .map(|(index, zone)| (index, depth_m(zone, point)))
            .collect()
    }

    /// Those that a straight line between two places passes, in steps.
    fn timed_zones_between(&self, from: usize, to: usize) -> Vec<usize> {
        let (from, to) = (self.points[from], self.points[to]);
        let steps = geometry::steps(from.at.distance_m(to.at), STEP_M, (1, 1000));
        let along = (0..=steps).map(|step| from.toward(to, f64::from(step) / f64::from(steps)));
        let zones = along.flat_map(|point| self.timed_zones(point));
        zones.map(|(zone, _)| zone).collect()
    }

    /// The zone of the spec that one of these places is in, and its time; none where times are not minded.
    pub(super) fn timed_zone_at(&self, sites: &[usize]) -> Option<(&str, (f64, f64))> {
        let known = self.in_time.as_ref()?;
        let (zone, _) = *sites.iter().find_map(|&site| known.zones[site].first())?;
        let zone = self.spec.no_fly.get(zone)?;
        Some((&zone.id, zone.active_s?))
    }

    /// When a vehicle may not be at each of its places.
    pub(super) fn closed(&self, vehicle: usize) -> Vec<Vec<(u64, u64)>> {
        let Some(known) = &self.in_time else {
            return Vec::new();
        };
        let own = &self.spec.vehicles[vehicle];
        let units = |s: f64| u64::from(whole(s * PER_SECOND));
        let span = |&(zone, depth_m): &(usize, f64)| {
            let (from_s, to_s) = self.world.zones[zone].active_s?;
            let crossed_s = depth_m * f64::from(1_u32 << known.doubled) / own.speed_mps;
            Some((units(from_s - crossed_s), units(to_s + crossed_s)))
        };
        let spans = |site: usize| known.zones[site].iter().filter_map(span).collect();
        self.sites(vehicle).into_iter().map(spans).collect()
    }

    /// The soonest order of a vehicle's own stops in which it is at none during the time of a zone there,
    /// by their indices.
    #[must_use]
    pub fn order_in_time(&self, vehicle: usize) -> Option<Vec<usize>> {
        let own = &self.spec.vehicles[vehicle];
        let (ways, closed) = (self.ways(vehicle), self.closed(vehicle));
        let carrier = Carrier {
            own: None,
            budget: u64::MAX,
            ..self.carrier(vehicle, &ways, &closed)
        };
        let first = self.own_first() + 1;
        let jobs: Vec<Job> = (own.stops.iter().enumerate())
            .map(|(index, stop)| Job {
                visits: visits(std::slice::from_ref(stop), first + index.., &|stop| {
                    own.stay_s(stop)
                }),
                form: Form::Open,
                vehicles: vec![true],
            })
            .collect();
        let assignment = Assignment {
            vehicles: &[carrier],
            jobs: &jobs,
        };
        let found = assignment.assign(self.seed)?;
        let visits = found.visits.first()?;
        (found.left.is_empty()).then(|| visits.iter().map(|(job, _)| *job).collect())
    }
}

/// How far a place in a zone is from its edge, metres.
fn depth_m(zone: &PlanZone, point: PlanPoint) -> f64 {
    let ring = Ring::around(&zone.outline);
    ring.boundary_distance([point.at.east_m, point.at.north_m]) + zone.buffer_m
}
