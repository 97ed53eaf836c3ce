//! Free space: where a vehicle may fly at all, and how far that is from what is closed.
//!
//! The soft fields price closed ground, so that a wall thin enough is cheaper than the way around
//! it. Here what is closed is closed, however thin: threats and zones by their exact distance
//! with the margins of the search, the ground where its floor is above the ceiling.

use rayon::prelude::*;

use super::field::{Field, Relief, dilate};
use super::grid::Grid;
use super::narrow_zones::crossed_nodes;
use crate::geodesy::EastNorth;
use crate::numeric::geometry::{Point, Ring};
use crate::plan::route_context::RouteContext;
use crate::world::PlanZone;

/// Cost per kilometre of closed ground in [`FreeSpace::field`]: beyond any detour.
const CLOSED: f64 = 1e6;
/// Length beside a wall costs more by this share: paths keep away from walls where they can, so
/// that a spline has space to bend.
const AT_WALL_SHARE: f64 = 1.0;
/// Nodes this near to an end are open, in cells: an end may lie within a margin.
const AT_ENDS_CELLS: f64 = 1.5;

/// Columns and rows of nodes that are looked at together.
const BLOCK: usize = 16;
/// More than rounding takes from a distance, metres.
const ROUNDING_M: f64 = 1e-6;

/// First and last column, first and last row of nodes.
type NodeBox = [(usize, usize); 2];

/// Which zones with a floor or a ceiling are open to a route; the others are closed at all altitudes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Passing {
    /// Those that a path has space over or under.
    Any,
    /// Those under which the lowest altitude is.
    Under,
    /// Those that reach down to it, and have to be flown over.
    Over,
}

/// The distance of every node of a grid to what is closed.
pub(crate) struct FreeSpace {
    grid: Grid,
    /// Metres, at most `reach_m`; 0 or less where flying is closed.
    clearance_m: Vec<f64>,
    reach_m: f64,
    /// The lowest altitude allowed; NaN where flying is closed by the ground.
    floor_m: Vec<f64>,
}

impl FreeSpace {
    /// The free space of a route, with distances up to `reach_m`.
    pub(crate) fn new(
        context: &RouteContext<'_>,
        (grid, reach_m): (Grid, f64),
        passing: Passing,
    ) -> Self {
        let (world, layer) = (context.world, context.layer());
        let floor_m: Vec<f64> = (0..grid.len())
            .into_par_iter()
            .map(|node| world.ground.height_m(grid.at(node)) + world.min_agl.0)
            .map(|by_agl_m| layer.floor_m(by_agl_m))
            .collect();
        let mut space = Self {
            clearance_m: vec![reach_m; grid.len()],
            grid,
            reach_m,
            floor_m,
        };
        space.close_threats(context);
        for zone in &world.zones {
            if zone.is_open_below(world.max_amsl) && space.may_pass(context, zone, passing) {
                space.raise_past(context, zone);
            } else {
                space.close_zone(context, zone);
            }
        }
        space.close_ground(context);
        space.close_outside(context);
        let near_m = AT_ENDS_CELLS * space.grid.spacing_m;
        for end in [context.ends.from.at, context.ends.to.at] {
            for node in space.nodes_around(plane(end), plane(end), near_m) {
                if space.grid.at(node).distance_m(end) < near_m {
                    space.clearance_m[node] = space.clearance_m[node].max(1e-3);
                }
            }
        }
        space
    }

    fn close_threats(&mut self, context: &RouteContext<'_>) {
        let (from, to) = context.ends_at();
        for threat in &context.world.threats {
            let nearest_m = threat
                .center
                .distance_m(from)
                .min(threat.center.distance_m(to));
            let room_m = (nearest_m - threat.radius_m).max(0.0);
            let radius_m = threat.radius_m + context.margins.threat_m.min(room_m);
            let center = threat.center;
            let box_of = |side: f64| [center.east_m + side, center.north_m + side];
            for node in self.nodes_around(box_of(-radius_m), box_of(radius_m), self.reach_m) {
                let away_m = self.grid.at(node).distance_m(center) - radius_m;
                self.clearance_m[node] = self.clearance_m[node].min(away_m);
            }
        }
    }

    fn close_zone(&mut self, context: &RouteContext<'_>, zone: &PlanZone) {
        let ring = Ring::around(&zone.outline);
        let (from, to) = context.ends_at();
        let room_m =
            |end: EastNorth| 0.5 * (ring.boundary_distance(plane(end)) - zone.buffer_m).max(0.0);
        let min_room_m = room_m(from).min(room_m(to));
        let margin_m = zone.buffer_m + context.margins.threat_m.min(min_room_m);
        let (low, high) = ring.bounds();
        let near = self.box_around(low, high, margin_m + self.reach_m);
        self.lower_to(near, |at| signed_distance_m(&ring, at) - margin_m);
        for node in crossed_nodes(&self.grid, zone) {
            self.clearance_m[node] = self.clearance_m[node].min(0.0);
        }
    }

    /// Whether a zone with a floor or a ceiling is passed.
    fn may_pass(&self, context: &RouteContext<'_>, zone: &PlanZone, passing: Passing) -> bool {
        let is_above = || {
            let (low, high) = Ring::around(&zone.outline).bounds();
            let nodes = self.nodes_around(low, high, zone.buffer_m);
            nodes.into_iter().all(|node| {
                let ground_m = context.world.ground.height_m(self.grid.at(node));
                self.floor_m[node] < zone.closed_m(ground_m).0
            })
        };
        match passing {
            Passing::Any => true,
            Passing::Under => is_above(),
            Passing::Over => !is_above(),
        }
    }

    /// A zone that may be flown over or under raises the floor where there is no space under it.
    fn raise_past(&mut self, context: &RouteContext<'_>, zone: &PlanZone) {
        let ring = Ring::around(&zone.outline);
        let (low, high) = ring.bounds();
        for node in self.nodes_around(low, high, zone.buffer_m) {
            let at = self.grid.at(node);
            let (from_m, below_m) = zone.closed_m(context.world.ground.height_m(at));
            if zone.contains(at) && self.floor_m[node] >= from_m {
                self.floor_m[node] = self.floor_m[node].max(below_m);
            }
        }
    }

    /// Closes the ground whose floor is above the ceiling, or not known.
    fn close_ground(&mut self, context: &RouteContext<'_>) {
        let (world, layer) = (context.world, context.layer());
        let top_m = |node: usize| match layer.max_agl_m.is_finite() {
            true => layer.ceiling_m(world.ground.height_m(self.grid.at(node)), world.max_amsl.0),
            false => world.max_amsl.0,
        };
        let floors = self.floor_m.iter().enumerate();
        let closed: Vec<bool> = floors
            .map(|(node, floor_m)| floor_m.is_nan() || *floor_m > top_m(node))
            .collect();
        if !closed.contains(&true) {
            return;
        }
        let mut nearness_m: Vec<f64> = closed
            .iter()
            .map(|&is_closed| if is_closed { 0.0 } else { -self.reach_m })
            .collect();
        dilate(&self.grid, 1.0, &mut nearness_m);
        for (node, nearness_m) in nearness_m.into_iter().enumerate() {
            self.clearance_m[node] = self.clearance_m[node].min(-nearness_m);
            if closed[node] {
                self.floor_m[node] = f64::NAN;
            }
        }
    }

    fn close_outside(&mut self, context: &RouteContext<'_>) {
        let ring = Ring::around(&context.world.area);
        let all = [(0, self.grid.columns - 1), (0, self.grid.rows - 1)];
        self.lower_to(all, |at| -signed_distance_m(&ring, at));
    }

    /// Lowers the clearance of nodes of a box to a distance that differs between two places by no more than the
    /// way between them: blocks whose middle is far enough away are passed over.
    fn lower_to(&mut self, [columns, rows]: NodeBox, away_m: impl Fn(EastNorth) -> f64 + Sync) {
        let blocks = spans(rows)
            .flat_map(|rows| spans(columns).map(move |columns| [columns, rows]))
            .collect::<Vec<NodeBox>>();
        let (grid, reach_m) = (&self.grid, self.reach_m);
        let nearer = |block: &NodeBox| {
            let nodes = nodes_of(grid, *block);
            let ends = nodes.first().zip(nodes.last());
            let Some((low, high)) = ends.map(|(first, last)| (grid.at(*first), grid.at(*last)))
            else {
                return Vec::new();
            };
            let middle = EastNorth {
                east_m: 0.5 * (low.east_m + high.east_m),
                north_m: 0.5 * (low.north_m + high.north_m),
            };
            if away_m(middle) - 0.5 * low.distance_m(high) > reach_m + ROUNDING_M {
                return Vec::new();
            }
            let nodes = nodes.into_iter();
            nodes.map(|node| (node, away_m(grid.at(node)))).collect()
        };
        let found: Vec<Vec<(usize, f64)>> = blocks.par_iter().map(nearer).collect();
        for (node, away_m) in found.into_iter().flatten() {
            self.clearance_m[node] = self.clearance_m[node].min(away_m);
        }
    }

    /// What flying costs per kilometre, no closer to walls than need be for `berth_m`, at slopes
    /// up to a limit; closed ground costs a million.
    pub(crate) fn field(&self, context: &RouteContext<'_>, slope: f64, berth_m: f64) -> Field {
        let prices = context.prices();
        let closed = self.clearance_m.iter().map(|&clearance_m| {
            let near = (1.0 - clearance_m / berth_m).clamp(0.0, 1.0);
            match clearance_m > 0.0 {
                true => prices.length * AT_WALL_SHARE * near * near,
                false => CLOSED,
            }
        });
        let relief = Relief::of(
            context.world,
            self.grid.clone(),
            self.floor_m.clone(),
            closed.collect(),
        );
        Field {
            rises: relief.rises(context.layer(), slope, &prices),
            climbs: None,
            ..relief.field(slope, &prices)
        }
    }

    /// Whether any path leads from one place to another through free space: every move between
    /// nodes passes only nodes beside each other.
    pub(crate) fn connects(&self, from: EastNorth, to: EastNorth) -> bool {
        const AROUND: [(isize, isize); 8] = [
            (1, 0),
            (0, 1),
            (-1, 0),
            (0, -1),
            (1, 1),
            (-1, 1),
            (1, -1),
            (-1, -1),
        ];
        let grid = &self.grid;
        let (first, last) = (grid.nearest(from), grid.nearest(to));
        let mut is_new: Vec<bool> = self.clearance_m.iter().map(|m| *m > 0.0).collect();
        let mut open = Vec::new();
        if std::mem::take(&mut is_new[first]) {
            open.push(first);
        }
        while let Some(node) = open.pop() {
            if node == last {
                return true;
            }
            for step in AROUND {
                if let Some(next) = grid.step(node, step)
                    && std::mem::take(&mut is_new[next])
                {
                    open.push(next);
                }
            }
        }
        false
    }

    /// Whether a path of a class of [`FreeSpace::field`] keeps to free space.
    pub(crate) fn is_free(&self, cost: f64) -> bool {
        cost < 0.25 * CLOSED * self.grid.spacing_m / 1000.0
    }

    /// The nodes of a box and `around_m` around it.
    fn nodes_around(&self, low: Point, high: Point, around_m: f64) -> Vec<usize> {
        nodes_of(&self.grid, self.box_around(low, high, around_m))
    }

    /// The columns and rows of a box and `around_m` around it.
    fn box_around(&self, low: Point, high: Point, around_m: f64) -> NodeBox {
        let corner = |[east_m, north_m]: Point, by_m: f64| {
            let at = EastNorth {
                east_m: east_m + by_m,
                north_m: north_m + by_m,
            };
            self.grid.column_row(self.grid.nearest(at))
        };
        let (first, last) = (corner(low, -around_m), corner(high, around_m));
        [(first.0, last.0), (first.1, last.1)]
    }
}

/// The nodes of some columns and rows, row by row.
fn nodes_of(grid: &Grid, [columns, rows]: NodeBox) -> Vec<usize> {
    (rows.0..=rows.1)
        .flat_map(|row| (columns.0..=columns.1).map(move |column| row * grid.columns + column))
        .collect()
}

/// Parts of a span of columns or rows.
fn spans((first, last): (usize, usize)) -> impl Iterator<Item = (usize, usize)> {
    let firsts = (first..=last).step_by(BLOCK);
    firsts.map(move |first| (first, (first + BLOCK - 1).min(last)))
}

/// Distance to a ring, negative inside.
fn signed_distance_m(ring: &Ring, at: EastNorth) -> f64 {
    let at = plane(at);
    let distance_m = ring.boundary_distance(at);
    if ring.contains(at) {
        -distance_m
    } else {
        distance_m
    }
}

fn plane(at: EastNorth) -> Point {
    [at.east_m, at.north_m]
}
