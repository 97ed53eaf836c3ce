//! What a straight flight between two corners costs.

use super::{Closure, Edge, Graph, point};
use crate::geodesy::EastNorth;
use crate::numeric::as_f64;
use crate::numeric::geometry::{Point, Ring, point_segment_distance};
use crate::world::{Disc, PlanZone};

/// Length along an edge in which its altitudes are looked at, metres, and most of these.
const PIECE_M: f64 = 40.0;
const MAX_PIECES: f64 = 400.0;

/// Pieces of an edge: as long, and the ground and the lowest altitude at their ends.
struct Pieces {
    count: usize,
    length_m: f64,
    ground_m: Vec<f64>,
    base_m: Vec<f64>,
}

impl Graph<'_> {
    /// One edge.
    pub(super) fn edge(&self, [a, b]: [usize; 2]) -> Edge {
        let (p, q) = (self.nodes[a], self.nodes[b]);
        let (world, margins) = (self.context.world, &self.context.margins);
        let is_near = |threat: &Disc| {
            let distance_m = point_segment_distance(point(threat.center), p, q);
            distance_m < threat.radius_m + margins.threat_m
        };
        let is_in = |closure: &Closure<'_>| {
            closure.is_closed && !crossings(&closure.ring, (p, q)).is_empty()
        };
        if world.threats.iter().any(is_near) || self.zones.iter().any(is_in) {
            return Edge::closed();
        }
        let pieces = self.pieces([a, b]);
        let mut floor_m = pieces.base_m.clone();
        let mut crossed = Vec::new();
        let zones = self.zones.iter().enumerate();
        for (index, closure) in zones.filter(|(_, closure)| !closure.is_closed) {
            for part in crossings(&closure.ring, (p, q)) {
                match self.raise(closure.zone, &pieces, part, &mut floor_m) {
                    None => return Edge::closed(),
                    Some(true) => crossed.push(index),
                    Some(false) => {}
                }
            }
        }
        let cost = self.profile_cost(&pieces, floor_m, [a, b]);
        Edge {
            cost: if cost.is_nan() { f64::INFINITY } else { cost },
            crossed,
        }
    }

    /// The pieces of an edge.
    fn pieces(&self, [a, b]: [usize; 2]) -> Pieces {
        let (from, to) = (self.at(a), self.at(b));
        let length_m = from.distance_m(to);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "limited to hundreds"
        )]
        let count = (length_m / PIECE_M).ceil().clamp(1.0, MAX_PIECES) as usize;
        let (world, layer) = (self.context.world, self.context.layer());
        let height_m = |k: usize| {
            let share = as_f64(k) / as_f64(count);
            world.ground.height_m(EastNorth {
                east_m: from.east_m + share * (to.east_m - from.east_m),
                north_m: from.north_m + share * (to.north_m - from.north_m),
            })
        };
        let ground_m: Vec<f64> = (0..=count).map(height_m).collect();
        let min_m = world.min_agl.0 + self.context.margins.clearance_m;
        let floors = ground_m.iter().map(|m| layer.floor_m(m + min_m));
        Pieces {
            count,
            length_m: length_m / as_f64(count),
            base_m: floors.collect(),
            ground_m,
        }
    }

    /// Raises a floor over a zone between two shares of an edge; whether it is raised, none where
    /// the zone is closed.
    fn raise(
        &self,
        zone: &PlanZone,
        pieces: &Pieces,
        (from, to): (f64, f64),
        floor_m: &mut [f64],
    ) -> Option<bool> {
        let (world, layer) = (self.context.world, self.context.layer());
        let over_m = self.context.margins.clearance_m;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "shares of hundreds"
        )]
        let node = |share: f64| (share * as_f64(pieces.count)) as usize;
        let mut is_raised = false;
        let nodes = node(from)..=(node(to) + 1).min(pieces.count);
        for (k, floor_m) in nodes.clone().zip(&mut floor_m[nodes]) {
            let (from_m, below_m) = zone.closed_m(pieces.ground_m[k]);
            if pieces.base_m[k] <= from_m - over_m {
                continue;
            }
            let lid_m = below_m + zone.margin_over_m(over_m, world.max_amsl);
            let top_m = layer.ceiling_m(pieces.ground_m[k], world.max_amsl.0);
            if lid_m.is_nan() || lid_m > top_m {
                return None;
            }
            is_raised = true;
            *floor_m = floor_m.max(lid_m);
        }
        Some(is_raised)
    }

    /// Cost of the lowest flight over a floor, and of the climb before it and the descent behind it
    /// where an end is over open ground.
    fn profile_cost(&self, pieces: &Pieces, mut amsl_m: Vec<f64>, ends: [usize; 2]) -> f64 {
        let (up, down) = self.slopes;
        let (last, piece_m, base_m) = (pieces.count, pieces.length_m, &pieces.base_m);
        for k in (0..last).rev() {
            amsl_m[k] = amsl_m[k].max(amsl_m[k + 1] - up * piece_m);
        }
        for k in 1..=last {
            amsl_m[k] = amsl_m[k].max(amsl_m[k - 1] - down * piece_m);
        }
        let (mut length_m, mut height_m2) = (0.0, 0.0);
        for k in 1..=last {
            length_m += piece_m.hypot(amsl_m[k] - amsl_m[k - 1]);
            height_m2 += 0.5 * piece_m * (amsl_m[k] + amsl_m[k - 1] - base_m[k] - base_m[k - 1]);
        }
        for (node, k, slope) in [(ends[0], 0, up), (ends[1], last, down)] {
            let more_m = amsl_m[k] - base_m[k];
            if !self.is_over[node] && more_m > 0.0 {
                height_m2 += 0.5 * more_m * more_m / slope;
                length_m += 0.5 * more_m * slope;
            }
        }
        self.prices.length * length_m * 1e-3 + self.prices.altitude * height_m2 * 1e-6
    }
}

impl Edge {
    /// An edge over closed ground.
    pub(super) fn closed() -> Self {
        Self {
            cost: f64::INFINITY,
            crossed: Vec::new(),
        }
    }
}

/// The parts of a segment inside a ring, as shares.
fn crossings(ring: &Ring, (a, b): (Point, Point)) -> Vec<(f64, f64)> {
    if ring.is_far_from(a, b) {
        return Vec::new();
    }
    let minus = |p: Point, q: Point| [p[0] - q[0], p[1] - q[1]];
    let cross = |p: Point, q: Point| p[0] * q[1] - p[1] * q[0];
    let along = minus(b, a);
    let (low, high) = ring.bounds();
    let corners = [low, [high[0], low[1]], high, [low[0], high[1]]];
    let sides = corners.map(|corner| cross(along, minus(corner, a)));
    let is_aside = sides.iter().all(|side| *side > 0.0) || sides.iter().all(|side| *side < 0.0);
    if is_aside {
        return Vec::new();
    }
    let mut shares = vec![0.0, 1.0];
    for (c, d) in ring.edges() {
        let edge = minus(d, c);
        let turn = cross(along, edge);
        if turn.abs() > 0.0 {
            let to = minus(c, a);
            let (share, on_edge) = (cross(to, edge) / turn, cross(to, along) / turn);
            if (0.0..=1.0).contains(&share) && (0.0..=1.0).contains(&on_edge) {
                shares.push(share);
            }
        }
    }
    shares.sort_by(f64::total_cmp);
    let pairs = shares.windows(2).map(|pair| (pair[0], pair[1]));
    let is_inside = |&(from, to): &(f64, f64)| {
        let middle = 0.5 * (from + to);
        to > from && ring.contains([a[0] + middle * along[0], a[1] + middle * along[1]])
    };
    pairs.filter(is_inside).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_segment_is_inside_a_ring_from_edge_to_edge() {
        let ring = Ring::new(&[
            [0.0, 0.0],
            [10.0, 0.0],
            [10.0, 10.0],
            [5.0, 2.0],
            [0.0, 10.0],
        ]);
        let parts = |a, b| crossings(&ring, (a, b));
        assert_eq!(parts([-10.0, 1.0], [30.0, 1.0]), [(0.25, 0.5)]);
        assert_eq!(parts([5.0, 1.0], [5.0, -1.0]), [(0.0, 0.5)]);
        assert!(parts([-10.0, 11.0], [30.0, 11.0]).is_empty());
        // Past the notch it is inside twice.
        assert_eq!(parts([-10.0, 6.0], [20.0, 6.0]).len(), 2);
    }
}
