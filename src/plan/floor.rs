//! The floor under a horizontal spline: ground and zones, raised where the vehicle
//! could not climb or descend fast enough.

use geo::{BoundingRect, Contains, Point, Polygon, Rect};

use super::lowest::Demand;
use crate::geodesy::{Amsl, EastNorth};
use crate::path::VehicleLimits;
use crate::world::World;

/// Steepest slopes, rise over run, both positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Slopes {
    limits: VehicleLimits,
    /// What is used of the limits.
    share: f64,
}

impl Slopes {
    /// A share of a vehicle's limits.
    pub(super) fn new(limits: VehicleLimits, share: f64) -> Self {
        Self { limits, share }
    }

    /// Steepest climb and descent at an altitude.
    fn at(&self, amsl: Amsl) -> (f64, f64) {
        (
            self.share * self.limits.climb.at(amsl),
            self.share * self.limits.descent.at(amsl),
        )
    }
}

/// What the floor is made of.
pub(super) struct FloorMaker<'a> {
    world: &'a World,
    /// Kept above ground, metres.
    clearance_m: f64,
    /// Zones that can be flown over: box, outline, and what is closed below.
    zones: Vec<(Rect<f64>, &'a Polygon<f64>, f64)>,
    slopes: Slopes,
}

impl<'a> FloorMaker<'a> {
    /// Keeps `clearance_m` above ground, and `over_zone_m` above zones.
    pub(super) fn new(
        world: &'a World,
        clearance_m: f64,
        over_zone_m: f64,
        slopes: Slopes,
    ) -> Self {
        let zones = world
            .zones
            .iter()
            .filter_map(|zone| {
                let below_m = zone.below?.0 + over_zone_m;
                let rect = zone.outline.bounding_rect()?;
                (below_m <= world.max_amsl.0).then_some((rect, &zone.outline, below_m))
            })
            .collect();
        Self {
            world,
            clearance_m,
            zones,
            slopes,
        }
    }

    /// The demand on the altitude over samples of a path whose ends are at the given
    /// altitudes; also fills the horizontal lengths of the segments. Slope limits are
    /// those at the highest floor, where they are tightest.
    pub(super) fn fill(
        &self,
        east_m: &[f64],
        north_m: &[f64],
        ends_m: (f64, f64),
        demand: &mut Demand,
        lengths_m: &mut Vec<f64>,
    ) {
        demand.floor_m.clear();
        lengths_m.clear();
        let mut known_m = ends_m.0;
        let mut highest_m = ends_m.0.max(ends_m.1);
        for (k, (&east, &north)) in east_m.iter().zip(north_m).enumerate() {
            let raw_m = self.raw_m(east, north);
            // Over a void the objective judges; the floor just goes on.
            if !raw_m.is_nan() {
                known_m = raw_m;
            }
            highest_m = highest_m.max(known_m);
            demand.floor_m.push(known_m);
            if k > 0 {
                let (run_e, run_n) = (east - east_m[k - 1], north - north_m[k - 1]);
                lengths_m.push((run_e * run_e + run_n * run_n).sqrt());
            }
        }
        let (climb, descent) = self.slopes.at(Amsl(highest_m));
        demand.up_m.clear();
        demand.up_m.extend(lengths_m.iter().map(|l| climb * l));
        demand.down_m.clear();
        demand.down_m.extend(lengths_m.iter().map(|l| descent * l));
        raise(ends_m, demand);
    }

    fn raw_m(&self, east_m: f64, north_m: f64) -> f64 {
        let ground_m = self.world.ground.height_m(EastNorth { east_m, north_m });
        let mut floor_m = ground_m + self.clearance_m;
        for (rect, outline, below_m) in &self.zones {
            let at = Point::new(east_m, north_m);
            if rect.contains(&at) && outline.contains(&at) {
                floor_m = floor_m.max(*below_m);
            }
        }
        floor_m
    }
}

/// Slope dilation: what lies ahead must be climbed to, what lies behind descended from.
/// Never above what can be reached from the ends: demanding that would only bend the
/// path where no altitude helps. Implied by the slope limits, it saves finding them out,
/// and stands for them where they cannot be kept.
fn raise(ends_m: (f64, f64), demand: &mut Demand) {
    let Demand {
        floor_m,
        up_m,
        down_m,
        ..
    } = demand;
    let mut to_go_m: f64 = down_m.iter().sum();
    let raw_m = floor_m.clone();
    for k in (0..up_m.len()).rev() {
        floor_m[k] = floor_m[k].max(floor_m[k + 1] - up_m[k]);
    }
    let mut behind_m = f64::NEG_INFINITY;
    let mut risen_m = 0.0;
    for (k, floor) in floor_m.iter_mut().enumerate() {
        if k > 0 {
            risen_m += up_m[k - 1];
            behind_m -= down_m[k - 1];
            to_go_m -= down_m[k - 1];
        }
        behind_m = behind_m.max(*floor);
        let reach_m = (ends_m.0 + risen_m).min(ends_m.1 + to_go_m);
        *floor = raw_m[k].max(behind_m.min(reach_m));
    }
}
