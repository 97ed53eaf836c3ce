//! Places of a spec in zones with heights, or too near to one.

use super::Check;
use crate::geodesy::{Amsl, LatLon, PlanPoint};
use crate::numeric::digits;
use crate::numeric::geometry::Ring;
use crate::spec::{BufferedLimit, Zone, zone_buffer_key, zone_buffer_m};
use crate::world::{self, PlanZone};

impl Check<'_> {
    /// Zones with a height; those without are checked with the spec alone. Whether a zone is
    /// active when a vehicle comes there shows only in its plan.
    pub(super) fn zones(&mut self, path: &str, what: &str, place: LatLon, amsl: Amsl) {
        let spec = &self.file.spec;
        let at = spec.frame.to_plan(place);
        let ground_m = self
            .terrain
            .height(place)
            .map_or(f64::NAN, |ground| ground.0);
        let has_height = |zone: &&Zone| zone.floor.is_some() || zone.ceiling.is_some();
        let always = spec.no_fly.iter().filter(|zone| zone.active_s.is_none());
        let closed: Vec<String> = always
            .filter(has_height)
            .filter(|zone| {
                let outline = spec.frame.outline(&zone.outline());
                let shape = PlanZone::new(outline, zone, 0.0, self.terrain);
                shape.is_closed_at(PlanPoint { at, amsl }, ground_m, f64::NAN)
            })
            .map(|zone| {
                let id = &zone.id;
                format!(
                    "{what} at {:.1} m is inside no-fly zone `{id}`, closed {zone}",
                    amsl.0
                )
            })
            .collect();
        if closed.is_empty() {
            self.near_zones(path, what, PlanPoint { at, amsl }, ground_m);
        }
        for found in closed {
            self.report(path, found, "outside, above or below".to_owned());
        }
    }

    /// Zones with a height from which a point is away by less than the buffer, in the plane and
    /// in height.
    fn near_zones(&mut self, path: &str, what: &str, point: PlanPoint, ground_m: f64) {
        let spec = &self.file.spec;
        let always = spec.no_fly.iter().filter(|zone| zone.active_s.is_none());
        let with_height = always.filter(|zone| zone.floor.is_some() || zone.ceiling.is_some());
        let near = with_height.filter_map(|zone| {
            let buffer_m = zone_buffer_m(&spec.buffers, zone);
            let outline = spec.frame.outline(&zone.outline());
            let away_m = match world::covers(&outline, point.at) {
                true => 0.0,
                false => Ring::around(&outline).boundary_distance(world::point(point.at)),
            };
            let shape = PlanZone::new(outline, zone, 0.0, self.terrain);
            let (from_m, below_m) = shape.closed_m(ground_m);
            let past_m = (from_m - point.amsl.0).max(point.amsl.0 - below_m);
            // Either is enough.
            let value_m = away_m.max(past_m);
            let limit = BufferedLimit {
                key: zone_buffer_key(zone),
                of: "its outline or height",
                limit_m: 0.0,
                buffered_m: buffer_m,
            };
            (value_m < buffer_m).then(|| {
                let value = digits::distinct_from(value_m, buffer_m, 1);
                let found = format!(
                    "{what} is {value} m from no-fly zone `{}`, closed {zone}",
                    zone.id
                );
                (found, limit.allowed(value_m))
            })
        });
        let near: Vec<(String, String)> = near.collect();
        for (found, allowed) in near {
            self.report(path, found, allowed);
        }
    }
}
