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
    /// Kept above ground beyond the minimum, metres.
    over_m: f64,
    /// Zones that can be flown over: box, outline, and what is closed below.
    zones: Vec<(Rect<f64>, &'a Polygon<f64>, f64)>,
    slopes: Slopes,
}

impl<'a> FloorMaker<'a> {
    /// Keeps `over_m` more than the minimum above ground, and as much above zones.
    pub(super) fn new(world: &'a World, over_m: f64, slopes: Slopes) -> Self {
        let zones = world
            .zones
            .iter()
            .filter_map(|zone| {
                let below_m = zone.below?.0 + over_m;
                let rect = zone.outline.bounding_rect()?;
                (below_m <= world.max_amsl.0).then_some((rect, &zone.outline, below_m))
            })
            .collect();
        Self {
            world,
            over_m,
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
        let last = east_m.len() - 1;
        let kept_m = |k: usize, end_m: f64| {
            let kept_m = end_m - self.least_m(east_m[k], north_m[k]);
            kept_m.clamp(0.0, self.over_m.max(0.0))
        };
        let (from_m, to_m) = (kept_m(0, ends_m.0), kept_m(last, ends_m.1));
        for (k, (&east, &north)) in east_m.iter().zip(north_m).enumerate() {
            let over_m = self
                .ramp(from_m, k, last)
                .min(self.ramp(to_m, last - k, last));
            let raw_m = self.raw_m(east, north, over_m);
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

    /// The least altitude over the ground.
    fn least_m(&self, east_m: f64, north_m: f64) -> f64 {
        let at = EastNorth { east_m, north_m };
        self.world.ground.height_m(at) + self.world.min_agl.0
    }

    /// What is kept beyond the minimum, so many samples from an end that keeps `end_m`: it
    /// grows to the full over a twentieth of the path, as it does in the objective. A path
    /// that begins at the minimum would else have to leap.
    fn ramp(&self, end_m: f64, samples: usize, all: usize) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "thousands of samples")]
        let share = (20.0 * samples as f64 / all.max(1) as f64).min(1.0);
        end_m + (self.over_m - end_m) * share
    }

    fn raw_m(&self, east_m: f64, north_m: f64, over_m: f64) -> f64 {
        let mut floor_m = self.least_m(east_m, north_m) + over_m;
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
