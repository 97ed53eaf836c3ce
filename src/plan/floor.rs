//! The floor under a horizontal spline: ground and zones, raised where the vehicle
//! could not climb or descend fast enough.

use geo::{BoundingRect, Contains, Point, Polygon, Rect};

use super::lowest::Demand;
use crate::cost::Relief;
use crate::geodesy::Amsl;
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

/// A zone that can be flown over.
struct LowZone<'a> {
    rect: Rect<f64>,
    outline: &'a Polygon<f64>,
    below_m: f64,
}

/// What the floor is made of.
pub(super) struct FloorMaker<'a> {
    world: &'a World,
    /// Kept above ground beyond the minimum, metres.
    over_m: f64,
    zones: Vec<LowZone<'a>>,
    slopes: Slopes,
    /// The ground, not a number where there are no data.
    relief: Relief,
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
                (below_m <= world.max_amsl.0).then_some(LowZone {
                    rect,
                    outline: &zone.outline,
                    below_m,
                })
            })
            .collect();
        Self {
            relief: Relief::new(&world.ground, f64::NAN),
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
        let Demand {
            floor_m, ground_m, ..
        } = demand;
        self.relief.read(east_m, north_m, ground_m);
        floor_m.clear();
        let mut known_m = ends_m.0;
        let mut highest_m = ends_m.0.max(ends_m.1);
        let least_m = self.world.min_agl.0;
        let last = east_m.len() - 1;
        let kept_m = |ground_m: f64, end_m: f64| {
            (end_m - (ground_m + least_m)).clamp(0.0, self.over_m.max(0.0))
        };
        let (from_m, to_m) = (
            kept_m(ground_m[0], ends_m.0),
            kept_m(ground_m[last], ends_m.1),
        );
        for (k, ground_m) in ground_m.iter().enumerate() {
            let mut raw_m = ground_m + least_m;
            if 20 * k.min(last - k) < last {
                let ramps = (self.ramp(from_m, k, last), self.ramp(to_m, last - k, last));
                raw_m += ramps.0.min(ramps.1);
            } else {
                raw_m += self.over_m;
            }
            for zone in &self.zones {
                raw_m = zone.raised(raw_m, east_m[k], north_m[k]);
            }
            // Over a void the objective judges; the floor just goes on.
            if !raw_m.is_nan() {
                known_m = raw_m;
            }
            highest_m = highest_m.max(known_m);
            floor_m.push(known_m);
        }
        lengths_m.clear();
        let pairs = east_m.windows(2).zip(north_m.windows(2));
        lengths_m.extend(pairs.map(|(east, north)| {
            let (run_e, run_n) = (east[1] - east[0], north[1] - north[0]);
            (run_e * run_e + run_n * run_n).sqrt()
        }));
        let (climb, descent) = self.slopes.at(Amsl(highest_m));
        demand.up_m.clear();
        demand.up_m.extend(lengths_m.iter().map(|l| climb * l));
        demand.down_m.clear();
        demand.down_m.extend(lengths_m.iter().map(|l| descent * l));
        raise(ends_m, demand);
    }

    /// What is kept beyond the minimum, so many samples from an end that keeps `end_m`: it
    /// grows to the full over a twentieth of the path, as it does in the objective. A path
    /// that begins at the minimum would else have to leap.
    fn ramp(&self, end_m: f64, samples: usize, all: usize) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "thousands of samples")]
        let share = (20.0 * samples as f64 / all.max(1) as f64).min(1.0);
        end_m + (self.over_m - end_m) * share
    }
}

impl LowZone<'_> {
    /// A floor, raised to the top of the zone where it is in it.
    fn raised(&self, floor_m: f64, east_m: f64, north_m: f64) -> f64 {
        let (min, max) = (self.rect.min(), self.rect.max());
        let near = min.x <= east_m && east_m <= max.x && min.y <= north_m && north_m <= max.y;
        if near && self.outline.contains(&Point::new(east_m, north_m)) {
            floor_m.max(self.below_m)
        } else {
            floor_m
        }
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
        ground_m: raw_m,
        ..
    } = demand;
    let mut to_go_m: f64 = down_m.iter().sum();
    raw_m.clone_from(floor_m);
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
