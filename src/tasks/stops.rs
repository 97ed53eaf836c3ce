//! The order of a vehicle's stops, where the spec leaves it free.
//!
//! The first costs are proven bounds of each route. The routes of the best order are planned, their
//! costs replace the bounds, and so on until the routes of the best order are all planned: then no
//! order is better, because no route that is not planned costs less than its bound.

use std::collections::BTreeSet;

use rayon::prelude::*;

use super::fleet::Assigner;
use super::order::{MAX_EXACT, best_order};
use crate::geodesy::PlanPoint;
use crate::path::route_ends;
use crate::plan::{route_bounds, route_costs};
use crate::spec::{MissionSpec, Order, Vehicle};
use crate::world::World;

/// Most orders whose routes are planned.
const ROUNDS: usize = 8;

/// The order that was found for a vehicle.
#[derive(Clone, Debug, PartialEq)]
pub struct FreeOrder {
    /// Indices of the stops of the spec, in the order in which they are visited; empty where the
    /// spec gives the order.
    pub order: Vec<usize>,
    /// No plan that keeps the limits costs less in any order.
    pub bound: f64,
}

/// The order of the stops of each vehicle; none if the spec leaves no order free.
#[must_use]
pub fn free_orders(spec: &MissionSpec, world: &World, seed: u64) -> Option<Vec<FreeOrder>> {
    let is_free = |vehicle: &Vehicle| vehicle.order == Order::Free && vehicle.stops.len() > 1;
    spec.vehicles.iter().any(is_free).then(|| {
        let vehicles = spec.vehicles.par_iter().enumerate();
        let orders = vehicles.map(|(index, vehicle)| match is_free(vehicle) {
            true => free_order(spec, world, index, seed),
            false => FreeOrder {
                order: Vec::new(),
                bound: 0.0,
            },
        });
        orders.collect()
    })
}

/// The spec and its world with the stops of each vehicle in the order that was found.
#[must_use]
pub fn in_order(spec: &MissionSpec, world: &World, orders: &[FreeOrder]) -> (MissionSpec, World) {
    let (mut spec, mut world) = (spec.clone(), world.clone());
    let fleet = spec.vehicles.iter_mut().zip(&mut world.sites);
    for ((vehicle, sites), found) in fleet.zip(orders) {
        if !found.order.is_empty() {
            let stops = found.order.iter();
            sites.stops = stops.map(|&index| sites.stops[index]).collect();
            vehicle.visit_in(&found.order);
        }
    }
    (spec, world)
}

/// The orders in which vehicles are not at their stops during the times of zones there, each with the
/// bound that holds for all orders: one for each estimate of what is flown in such zones, where it is
/// another than the one before.
#[must_use]
pub fn orders_in_time(
    spec: &MissionSpec,
    world: &World,
    (found, seed): (&[FreeOrder], u64),
) -> Vec<Vec<FreeOrder>> {
    let mut assigner = Assigner::of(spec, world, seed);
    let mut orders: Vec<Vec<FreeOrder>> = vec![found.to_vec()];
    while assigner.minds_times() {
        let fleet = found.iter().enumerate();
        let in_time = fleet.map(|(vehicle, known)| {
            let is_free = !known.order.is_empty();
            let order = is_free.then(|| assigner.order_in_time(vehicle)).flatten();
            FreeOrder {
                order: order.unwrap_or_else(|| known.order.clone()),
                bound: known.bound,
            }
        });
        let in_time: Vec<FreeOrder> = in_time.collect();
        if !orders.contains(&in_time) {
            orders.push(in_time);
        }
    }
    orders.split_off(1)
}

fn free_order(spec: &MissionSpec, world: &World, vehicle: usize, seed: u64) -> FreeOrder {
    let (own, sites) = (&spec.vehicles[vehicle], &world.sites[vehicle]);
    let mut points = vec![sites.start];
    points.extend(&sites.stops);
    points.push(sites.goal);
    let mut costs = bounds(spec, world, &points);
    let after_goal = &route_ends(own, sites)[sites.stops.len() + 1..];
    let after: f64 = route_bounds(spec, world, after_goal).iter().sum();
    let mut planned: BTreeSet<(usize, usize)> = BTreeSet::new();
    let mut found: Option<(f64, Vec<usize>)> = None;
    let mut bound: Option<f64> = None;
    for _ in 0..ROUNDS {
        let Some(sequence) = best_order(&costs) else {
            break;
        };
        bound.get_or_insert(sequence.bound + after);
        let path: Vec<usize> = std::iter::once(0)
            .chain(sequence.order.iter().map(|stop| stop + 1))
            .chain([points.len() - 1])
            .collect();
        let legs = path.windows(2).map(|pair| (pair[0], pair[1]));
        let new: Vec<(usize, usize)> = legs.filter(|leg| !planned.contains(leg)).collect();
        let ends: Vec<(PlanPoint, PlanPoint)> = new
            .iter()
            .map(|&(from, to)| (points[from], points[to]))
            .collect();
        for (&(from, to), cost) in new
            .iter()
            .zip(route_costs(spec, world, vehicle, &ends, seed))
        {
            costs[from][to] = costs[from][to].max(cost);
        }
        planned.extend(&new);
        let cost: f64 = path.windows(2).map(|pair| costs[pair[0]][pair[1]]).sum();
        if found.as_ref().is_none_or(|(best, _)| cost < *best) {
            found = Some((cost, sequence.order));
        }
        if new.is_empty() {
            break;
        }
    }
    FreeOrder {
        order: found.map_or_else(|| (0..own.stops.len()).collect(), |(_, order)| order),
        bound: bound.unwrap_or(0.0),
    }
}

/// Proven bounds between all points; of many points the straight lines.
fn bounds(spec: &MissionSpec, world: &World, points: &[PlanPoint]) -> Vec<Vec<f64>> {
    let count = points.len();
    let mut costs = vec![vec![0.0; count]; count];
    let pairs: Vec<(usize, usize)> = (0..count)
        .flat_map(|from| (from + 1..count).map(move |to| (from, to)))
        .collect();
    let ends: Vec<(PlanPoint, PlanPoint)> = pairs
        .iter()
        .map(|&(from, to)| (points[from], points[to]))
        .collect();
    let found = match count - 2 {
        0..=MAX_EXACT => route_bounds(spec, world, &ends),
        _ => {
            let straight = ends
                .iter()
                .map(|(from, to)| spec.planner.weights.length * from.distance_m(*to) / 1000.0);
            straight.collect()
        }
    };
    for (&(from, to), cost) in pairs.iter().zip(found) {
        (costs[from][to], costs[to][from]) = (cost, cost);
    }
    costs
}
