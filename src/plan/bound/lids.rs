//! Zones that can be flown over: what the climb over them costs at least.
//!
//! A path that crosses such a zone is above its lid there. It climbs and descends no faster than
//! its vehicle may, so that it is high before and behind the zone too, and altitude costs.

use super::closed::{is_always_closed_from_below, is_closed_throughout, zone_ring};
use crate::geodesy::PlanPoint;
use crate::numeric::geometry::{Point, Ring};
use crate::path::VehicleLimits;
use crate::spec::{MissionSpec, Placement};
use crate::world::World;

/// Most zones that are looked at, those that cost most.
const MAX: usize = 6;
/// Distances from a zone within which the ground is taken to be as high as its highest point,
/// metres: each proves something, and the best counts.
const REACHES_M: [f64; 4] = [100.0, 300.0, 900.0, 2700.0];

/// Share of a reach that counts, and least reach as a share of the way.
const COUNTED: f64 = 0.9;
const MIN_REACH: f64 = 0.01;

/// A zone that can be flown over, and not under.
pub(super) struct Lid {
    pub(super) ring: Vec<Point>,
    /// No path crosses it lower, metres above mean sea level.
    pub(super) top_m: f64,
    /// Distances around it, and how far its top is above the least height over the ground there,
    /// metres.
    heights_m: Vec<(f64, f64)>,
}

/// Steepest climb and descent of any vehicle, and what a metre of path a metre higher costs.
#[derive(Clone, Copy)]
pub(super) struct Climbs {
    slopes: (f64, f64),
    price: f64,
}

impl Climbs {
    pub(super) fn new(spec: &MissionSpec, world: &World) -> Self {
        let top_m = world.max_amsl.0;
        // The speed may be chosen lower, so that limits by vertical speed prove nothing.
        let most = |(climb, descent): (f64, f64), limits: VehicleLimits| {
            (
                climb.max(limits.climb.max_by_shape(top_m)),
                descent.max(limits.descent.max_by_shape(top_m)),
            )
        };
        let fleet = spec.vehicles.iter().map(VehicleLimits::of);
        Self {
            slopes: fleet.fold((0.0, 0.0), most),
            price: spec.planner.weights.altitude * 1e-6,
        }
    }

    /// What the altitude of a path over a lid costs at least, between two ends.
    pub(super) fn over(&self, lid: &Lid, (from, to): (PlanPoint, PlanPoint)) -> f64 {
        let ring = Ring::new(&lid.ring);
        let away_m = |end: PlanPoint| {
            let at = [end.at.east_m, end.at.north_m];
            match ring.contains(at) {
                true => 0.0,
                false => ring.boundary_distance(at),
            }
        };
        let (before_m, behind_m) = (away_m(from), away_m(to));
        // The objective reads altitudes at samples: what lies between the last two of a reach is
        // not counted.
        let min_m = MIN_REACH * from.at.distance_m(to.at);
        let of_reach = |&(reach_m, height_m): &(f64, f64)| {
            // The height falls along the path at the slope, down to where nothing is known.
            let side = |slope: f64, way_m: f64| {
                let known_m = (COUNTED * reach_m).min(way_m);
                let length_m = (height_m / slope.max(1e-9)).min(known_m);
                height_m * length_m - 0.5 * slope * length_m * length_m
            };
            side(self.slopes.0, before_m) + side(self.slopes.1, behind_m)
        };
        let reaches = lid
            .heights_m
            .iter()
            .filter(|(reach_m, _)| *reach_m >= min_m);
        let most = reaches.map(of_reach).fold(0.0, f64::max);
        self.price * most
    }
}

/// The zones that can be flown over, at most some, the highest over their ground first.
pub(super) fn lids(spec: &MissionSpec, world: &World) -> Vec<Lid> {
    let mut lids: Vec<Lid> = (world.zones.iter().zip(&spec.no_fly))
        .filter(|(zone, _)| {
            is_always_closed_from_below(zone, world) && !is_closed_throughout(zone, world)
        })
        .filter_map(|(zone, given)| {
            let ring = zone_ring(world, zone, given)?;
            let ground_m = |reach_m: f64| ground_m(world, &ring, reach_m);
            let top_m = match zone.ceiling? {
                Placement::Amsl(top) => top.0,
                Placement::Agl(agl) => ground_m(0.0).0 + agl.0,
            };
            let heights = REACHES_M.map(|reach_m| {
                let highest_m = ground_m(reach_m).1;
                (reach_m, top_m - highest_m - world.min_agl.0)
            });
            let heights_m: Vec<(f64, f64)> = (heights.into_iter())
                .filter(|(_, height_m)| *height_m > 0.0)
                .collect();
            (!heights_m.is_empty()).then_some(Lid {
                ring,
                top_m,
                heights_m,
            })
        })
        .collect();
    lids.sort_by(|a, b| b.heights_m[0].1.total_cmp(&a.heights_m[0].1));
    lids.truncate(MAX);
    lids
}

/// The lowest and the highest ground in the box around a ring and as far around it, metres: at the
/// nodes of its cells, between which the ground is not beyond them.
fn ground_m(world: &World, ring: &[Point], around_m: f64) -> (f64, f64) {
    let (low, high) = Ring::new(ring).bounds();
    let ground = &world.ground;
    let south_west = [ground.south_west.east_m, ground.south_west.north_m];
    let range = |axis: usize, count: usize| {
        let cell = |at_m: f64| (at_m - south_west[axis]) / ground.spacing_m;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "cut off at the grid"
        )]
        let index = |cell: f64| (cell.max(0.0) as usize).min(count - 1);
        let (first, last) = (low[axis] - around_m, high[axis] + around_m);
        index(cell(first).floor())..=index(cell(last).ceil())
    };
    let columns = range(0, ground.columns);
    let rows = range(1, ground.rows);
    let nodes = rows.flat_map(|row| columns.clone().map(move |column| (row, column)));
    let heights = nodes.map(|(row, column)| ground.heights_m[row * ground.columns + column]);
    heights.filter(|height_m| height_m.is_finite()).fold(
        (f64::INFINITY, f64::NEG_INFINITY),
        |(low, high), height_m| (low.min(height_m.into()), high.max(height_m.into())),
    )
}
