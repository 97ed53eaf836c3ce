//! The floor under a horizontal spline: ground and zones, raised where the vehicle
//! could not climb or descend fast enough.

use geo::{BoundingRect, Contains, Point, Polygon, Rect};

use crate::world::World;

/// Steepest slopes, rise over run, both positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Slopes {
    pub climb: f64,
    pub descent: f64,
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

    /// The floor at samples of a path whose ends are at the given altitudes; also
    /// fills the horizontal lengths of the segments.
    pub(super) fn fill(
        &self,
        east_m: &[f64],
        north_m: &[f64],
        ends_m: (f64, f64),
        floor_m: &mut Vec<f64>,
        lengths_m: &mut Vec<f64>,
    ) {
        floor_m.clear();
        lengths_m.clear();
        let mut known_m = ends_m.0;
        for (k, (&east, &north)) in east_m.iter().zip(north_m).enumerate() {
            let raw_m = self.raw_m(east, north);
            // Over a void the objective judges; the floor just goes on.
            if !raw_m.is_nan() {
                known_m = raw_m;
            }
            floor_m.push(known_m);
            if k > 0 {
                lengths_m.push((east - east_m[k - 1]).hypot(north - north_m[k - 1]));
            }
        }
        self.raise(ends_m, floor_m, lengths_m);
    }

    fn raw_m(&self, east_m: f64, north_m: f64) -> f64 {
        let ground_m = self
            .world
            .ground
            .height_m(crate::geodesy::EastNorth { east_m, north_m });
        let mut floor_m = ground_m + self.clearance_m;
        for (rect, outline, below_m) in &self.zones {
            let at = Point::new(east_m, north_m);
            if rect.contains(&at) && outline.contains(&at) {
                floor_m = floor_m.max(*below_m);
            }
        }
        floor_m
    }

    /// Slope dilation: what lies ahead must be climbed to, what lies behind descended
    /// from. Never above what can be reached from the ends: demanding that would only
    /// bend the path where no altitude helps.
    fn raise(&self, ends_m: (f64, f64), floor_m: &mut [f64], lengths_m: &[f64]) {
        let Slopes { climb, descent } = self.slopes;
        let whole_m: f64 = lengths_m.iter().sum();
        let mut behind_m = f64::NEG_INFINITY;
        let mut flown_m = 0.0;
        let mut raised: Vec<f64> = floor_m.to_vec();
        for k in (0..lengths_m.len()).rev() {
            raised[k] = raised[k].max(raised[k + 1] - climb * lengths_m[k]);
        }
        for (k, floor) in floor_m.iter_mut().enumerate() {
            if k > 0 {
                flown_m += lengths_m[k - 1];
                behind_m -= descent * lengths_m[k - 1];
            }
            behind_m = behind_m.max(raised[k]);
            let reach_m =
                (ends_m.0 + climb * flown_m).min(ends_m.1 + descent * (whole_m - flown_m));
            *floor = floor.max(behind_m.min(reach_m));
        }
    }
}
