//! The floor under a horizontal spline: ground and zones, raised where the vehicle
//! could not climb or descend fast enough.

use fearless_simd::{Level, dispatch};

use super::Demand;
use crate::cost::{Relief, RouteEnds};
use crate::geodesy::{Agl, Amsl, EastNorth};
use crate::numeric::geometry::Offset;
use crate::numeric::order::{larger, smaller};
use crate::path::VehicleLimits;
use crate::spec::Placement;
use crate::world::{Layer, PlanZone, World};

/// What is kept beyond the minimum grows to the full over one part in this many of the path.
const RAMP: usize = 20;

/// How many times the distance over a zone near the ceiling that the objective asks for is kept.
const AIM: f64 = 1.1;

/// Steepest slopes, rise over run, both positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Slopes {
    limits: VehicleLimits,
    /// What is used of the limits.
    share: f64,
}

impl Slopes {
    /// A share of a vehicle's limits.
    pub(crate) fn new(limits: VehicleLimits, share: f64) -> Self {
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

/// A zone that can be flown over or under.
pub(super) struct LowZone<'a> {
    pub(super) closed: Offset,
    zone: &'a PlanZone,
    /// Kept above it, and below it, metres.
    over_m: f64,
    under_m: f64,
}

/// Samples of a path in the plane, and the altitudes of its ends, metres.
pub(crate) struct SampledLine<'a> {
    pub east_m: &'a [f64],
    pub north_m: &'a [f64],
    pub ends_m: (f64, f64),
}

/// What the floor is made of.
pub(crate) struct FloorMaker<'a> {
    pub(super) world: &'a World,
    pub(super) layer: Layer,
    /// Kept above ground beyond the minimum, metres.
    over_m: f64,
    /// Kept below the greatest height above ground, metres.
    under_m: f64,
    pub(super) zones: Vec<LowZone<'a>>,
    /// Whether paths are over zones from edge to edge, between samples too.
    at_edges: bool,
    slopes: Slopes,
    /// The ground, not a number where there are no data.
    relief: Relief,
    level: Level,
}

impl<'a> FloorMaker<'a> {
    /// Keeps `over_m` more than the minimum above ground, as much above zones, and `under_m` less
    /// than the greatest height above ground.
    pub(crate) fn new(
        (world, layer): (&'a World, Layer),
        (over_m, under_m): (f64, f64),
        slopes: Slopes,
    ) -> Self {
        let zones = world
            .zones
            .iter()
            .filter_map(|zone| {
                let above = Agl(world.min_agl.0 + over_m);
                let under_m = zone.margin_under_m(over_m, above);
                let over_m = over_m.min(AIM * zone.margin_over_m(over_m, world.max_amsl));
                let has_room = match (zone.floor, zone.ceiling) {
                    (None, None) => false,
                    (None, Some(Placement::Amsl(top))) => top.0 + over_m <= world.max_amsl.0,
                    _ => true,
                };
                has_room.then(|| LowZone {
                    closed: zone.offset(),
                    zone,
                    over_m,
                    under_m,
                })
            })
            .collect();
        Self {
            relief: Relief::new(&world.ground, f64::NAN),
            world,
            layer,
            over_m,
            under_m,
            zones,
            at_edges: false,
            slopes,
            level: Level::new(),
        }
    }

    /// The same where zones that have a buffer begin `margin_m` before it, as they do in the objective of
    /// a route; paths of specs without buffers stay as they are.
    pub(crate) fn with_margin(mut self, ends: &RouteEnds, margin_m: f64) -> Self {
        let ends = [ends.from.at, ends.to.at].map(|at| [at.east_m, at.north_m]);
        for low in self.zones.iter_mut().filter(|low| low.zone.buffer_m > 0.0) {
            low.closed = low.zone.away_from(ends, margin_m);
        }
        self
    }

    /// The same where paths are over zones from edge to edge, margins included, between samples too.
    pub(crate) fn over_edges(mut self, ends: &RouteEnds, margin_m: f64) -> Self {
        let ends = [ends.from.at, ends.to.at].map(|at| [at.east_m, at.north_m]);
        for low in &mut self.zones {
            low.closed = low.zone.away_from(ends, margin_m);
        }
        self.at_edges = true;
        self
    }

    /// The demand on the altitude over a track; also fills the horizontal lengths of its
    /// segments. Slope limits are those at the highest floor, where they are tightest.
    pub(crate) fn fill(
        &self,
        line: &SampledLine<'_>,
        demand: &mut Demand,
        lengths_m: &mut Vec<f64>,
    ) {
        self.relief
            .read(line.east_m, line.north_m, &mut demand.ground_m);
        dispatch!(self.level, _simd => self.fill_over(line, demand, lengths_m));
    }

    /// The same where the ground is known.
    #[inline(always)]
    fn fill_over(&self, line: &SampledLine<'_>, demand: &mut Demand, lengths_m: &mut Vec<f64>) {
        let &SampledLine {
            east_m,
            north_m,
            ends_m,
        } = line;
        self.over_ground(ends_m, demand);
        self.under_ceiling(ends_m, demand);
        for zone in &self.zones {
            let floors_m = demand.floor_m.iter_mut().zip(&demand.ground_m);
            for ((floor_m, ground_m), at) in floors_m.zip(east_m.iter().zip(north_m)) {
                let top_m = self.layer.ceiling_m(*ground_m, self.world.max_amsl.0);
                if zone.is_near((*at.0, *at.1)) && self.is_in(zone, (*at.0, *at.1)) {
                    *floor_m = zone.raised(*floor_m, *ground_m, top_m);
                }
            }
        }
        // Over a void the objective judges; the floor just goes on.
        let mut known_m = ends_m.0;
        let mut highest_m = larger(ends_m.0, ends_m.1);
        for floor_m in &mut demand.floor_m {
            known_m = if floor_m.is_nan() { known_m } else { *floor_m };
            highest_m = larger(known_m, highest_m);
            *floor_m = known_m;
        }
        let last = east_m.len() - 1;
        lengths_m.resize(last, 0.0);
        let east = east_m[..last].iter().zip(&east_m[1..]);
        let north = north_m[..last].iter().zip(&north_m[1..]);
        for ((length_m, east), north) in lengths_m.iter_mut().zip(east).zip(north) {
            let (run_e, run_n) = (east.1 - east.0, north.1 - north.0);
            *length_m = (run_e * run_e + run_n * run_n).sqrt();
        }
        let (climb, descent) = self.slopes.at(Amsl(highest_m));
        for (slope, max_m) in [(climb, &mut demand.up_m), (descent, &mut demand.down_m)] {
            max_m.resize(last, 0.0);
            for (max_m, length_m) in max_m.iter_mut().zip(&*lengths_m) {
                *max_m = slope * length_m;
            }
        }
        if self.at_edges {
            self.raise_at_edges(line, demand);
        }
        raise(ends_m, demand);
    }

    /// Whether a zone holds a place near it.
    #[inline(always)]
    fn is_in(&self, zone: &LowZone<'_>, at: (f64, f64)) -> bool {
        match self.at_edges {
            true => zone.closed.contains([at.0, at.1]),
            false => zone.holds(at),
        }
    }

    /// The highest altitudes of a path at those of its samples that are under a zone, `amsl_m` at
    /// present, and under the ceiling everywhere, metres.
    pub(crate) fn roofs_m(&self, (east_m, north_m): (&[f64], &[f64]), amsl_m: &[f64]) -> Vec<f64> {
        let roof_m = |((east_m, north_m), amsl_m): ((&f64, &f64), &f64)| {
            let ground_m = (self.world.ground).height_m(EastNorth {
                east_m: *east_m,
                north_m: *north_m,
            });
            let top_m = self.layer.ceiling_m(ground_m, self.world.max_amsl.0);
            let zones = self.zones.iter();
            let under_m =
                zones.filter_map(|zone| zone.above((*east_m, *north_m), *amsl_m, ground_m));
            under_m.fold(top_m, f64::min)
        };
        let line = east_m.iter().zip(north_m);
        line.zip(amsl_m).map(roof_m).collect()
    }

    /// The floor of the ground alone, with what is kept over it.
    #[inline(always)]
    fn over_ground(&self, ends_m: (f64, f64), demand: &mut Demand) {
        let min_m = self.world.min_agl.0;
        let Demand {
            floor_m, ground_m, ..
        } = demand;
        let last = ground_m.len() - 1;
        floor_m.resize(last + 1, 0.0);
        for (floor_m, ground_m) in floor_m.iter_mut().zip(&*ground_m) {
            *floor_m = ground_m + min_m;
        }
        if self.layer.min_amsl_m.is_finite() {
            for floor_m in &mut *floor_m {
                *floor_m = self.layer.floor_m(*floor_m);
            }
        }
        let margin_m =
            |floor_m: f64, end_m: f64| (end_m - floor_m).clamp(0.0, self.over_m.max(0.0));
        let from_m = margin_m(floor_m[0], ends_m.0);
        let to_m = margin_m(floor_m[last], ends_m.1);
        let ramped = last.div_ceil(RAMP);
        let full = ramped..=last - ramped;
        let ramp = |end_m: f64, samples: usize| ramp((end_m, self.over_m), samples, last);
        for k in (0..ramped).chain(full.end() + 1..=last) {
            floor_m[k] += ramp(from_m, k).min(ramp(to_m, last - k));
        }
        for floor_m in &mut floor_m[full] {
            *floor_m += self.over_m;
        }
    }

    /// The ceiling over the ground, less what is kept below it; none where no height is limited.
    fn under_ceiling(&self, ends_m: (f64, f64), demand: &mut Demand) {
        demand.ceiling_m.clear();
        let max_m = self.layer.max_agl_m;
        if max_m.is_infinite() {
            return;
        }
        let ground_m = &demand.ground_m;
        let last = ground_m.len() - 1;
        let spare_m = |at: usize, end_m: f64| {
            // Over unknown ground there is nothing to spare.
            (ground_m[at] + max_m - end_m).clamp(0.0, self.under_m.max(0.0))
        };
        let (from_m, to_m) = (spare_m(0, ends_m.0), spare_m(last, ends_m.1));
        let ramp = |end_m: f64, samples: usize| ramp((end_m, self.under_m), samples, last);
        let ceilings = ground_m.iter().enumerate().map(|(k, ground_m)| {
            let under_m = ramp(from_m, k).min(ramp(to_m, last - k));
            let top_m = self
                .layer
                .ceiling_m(ground_m - under_m, self.world.max_amsl.0);
            // The objective judges voids.
            if ground_m.is_nan() {
                f64::INFINITY
            } else {
                top_m
            }
        });
        demand.ceiling_m.extend(ceilings);
    }
}

/// Margin beyond a limit, `samples` samples from an end with the margin `end_m`: it grows to the
/// full over a twentieth of the path, as it does in the objective. A path that begins at the limit
/// would else have to leap.
fn ramp((end_m, full_m): (f64, f64), samples: usize, all: usize) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "thousands of samples")]
    let share = ((RAMP * samples) as f64 / all.max(1) as f64).min(1.0);
    end_m + (full_m - end_m) * share
}

impl LowZone<'_> {
    /// Altitude under which a path stays that passes under the zone, metres; none where it does
    /// not.
    fn above(&self, at: (f64, f64), amsl_m: f64, ground_m: f64) -> Option<f64> {
        let (from_m, _) = self.zone.closed_m(ground_m);
        let is_under = amsl_m < from_m && self.is_near(at) && self.holds(at);
        is_under.then_some(from_m - self.under_m)
    }

    fn is_near(&self, at: (f64, f64)) -> bool {
        let (min, max) = self.closed.bounds();
        min[0] <= at.0 && at.0 <= max[0] && min[1] <= at.1 && at.1 <= max[1]
    }

    fn holds(&self, at: (f64, f64)) -> bool {
        match self.zone.buffer_m > 0.0 {
            true => self.closed.contains([at.0, at.1]),
            false => self.zone.holds(EastNorth {
                east_m: at.0,
                north_m: at.1,
            }),
        }
    }

    /// A floor in the zone, raised to its top; left alone where it is below the zone, and where the
    /// zone reaches up to the ceiling at `max_m`.
    fn raised(&self, floor_m: f64, ground_m: f64, max_m: f64) -> f64 {
        match self.lid_m(floor_m, ground_m, max_m) {
            Some(lid_m) => floor_m.max(lid_m),
            None => floor_m,
        }
    }

    /// What a path at a floor has to be above in the zone.
    pub(super) fn lid_m(&self, floor_m: f64, ground_m: f64, max_m: f64) -> Option<f64> {
        let (from_m, below_m) = self.zone.closed_m(ground_m);
        let top_m = below_m + self.over_m;
        (floor_m > from_m - self.under_m && top_m <= max_m).then_some(top_m)
    }
}

/// Slope dilation: what lies ahead must be climbed to, what lies behind descended from.
/// Never above what can be reached from the ends: demanding that would only bend the
/// path where no altitude helps. Implied by the slope limits, it saves finding them out,
/// and stands for them where they cannot be kept.
#[inline(always)]
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
    if let Some((end_m, before_m)) = floor_m.split_last_mut() {
        let mut ahead_m = *end_m;
        for (floor_m, up_m) in before_m.iter_mut().zip(&*up_m).rev() {
            ahead_m = larger(*floor_m, ahead_m - up_m);
            *floor_m = ahead_m;
        }
    }
    let held_m = |raw_m: f64, behind_m: f64, risen_m: f64, to_go_m: f64| {
        let reach_m = smaller(ends_m.0 + risen_m, ends_m.1 + to_go_m);
        larger(raw_m, smaller(behind_m, reach_m))
    };
    let (mut behind_m, mut risen_m) = (floor_m[0], 0.0);
    floor_m[0] = held_m(raw_m[0], behind_m, risen_m, to_go_m);
    let steps = up_m.iter().zip(&*down_m);
    let later = floor_m[1..].iter_mut().zip(&raw_m[1..]);
    for ((floor_m, raw_m), (up_m, down_m)) in later.zip(steps) {
        risen_m += up_m;
        to_go_m -= down_m;
        behind_m = larger(behind_m - down_m, *floor_m);
        *floor_m = held_m(*raw_m, behind_m, risen_m, to_go_m);
    }
}
