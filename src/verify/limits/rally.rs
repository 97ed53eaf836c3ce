//! Rally points: where a vehicle goes, and may land, when something is wrong.
//!
//! From where it comes is not known, so only the point itself is judged: it keeps
//! the minimum height and the ceiling, and lies in the area and the fence and outside of
//! threats and zones, at whatever height these end: the vehicle lands there.

use crate::geodesy::Amsl;
use crate::mission::VehicleMission;
use crate::spec::{Placement, Zone, zone_buffer_m};

use super::fence::Fence;
use super::space::Space;
use crate::verify::execute::item;
use crate::verify::measure::outline::Keep;
use crate::verify::measure::segment::Stretch;
use crate::verify::measure::worst::Worst;
use crate::verify::{Limit, Margin, Moment};
use crate::world::{Layer, floor_over};

impl Space<'_> {
    /// The margins of the rally points of a mission.
    pub(crate) fn rally_margins(
        &self,
        (id, layer): (&str, Layer),
        mission: &VehicleMission,
        home: Amsl,
        fence: &Fence,
    ) -> Vec<Margin> {
        let mut margins = Vec::new();
        let unjudged = |margins: &mut Vec<Margin>, number: usize, why: String| {
            margins.push(Margin::unjudged(id, Limit::RallyClearance(number), why));
        };
        for (index, point) in mission.rally.iter().enumerate() {
            let number = index + 1;
            match item::rally(point, mission.autopilot, home, self.world) {
                Ok((place, amsl, agl_m)) => {
                    let at = Moment {
                        place,
                        amsl,
                        t_s: 0.0,
                        item: 0,
                    };
                    let known_m = agl_m.as_ref().ok().copied();
                    margins.extend(self.rally_ceiling((id, number), at, known_m, layer));
                    match agl_m {
                        Ok(agl_m) => {
                            margins.extend(self.rally_point((id, number), at, agl_m, fence));
                        }
                        Err(why) => unjudged(&mut margins, number, why),
                    }
                }
                Err(why) => unjudged(&mut margins, number, why),
            }
        }
        margins
    }

    /// The vehicle flies there at the altitude of the point.
    fn rally_ceiling(
        &self,
        (id, number): (&str, usize),
        at: Moment,
        agl_m: Option<f64>,
        layer: Layer,
    ) -> Option<Margin> {
        let over_ground_m =
            agl_m.map_or(f64::INFINITY, |agl_m| at.amsl.0 - agl_m + layer.max_agl_m);
        let mut worst = Worst::default();
        worst.at_most(at.amsl.0, self.world.max_amsl.0.min(over_ground_m), || at);
        worst.margin(id, Limit::RallyCeiling(number), "m")
    }

    fn rally_point(
        &self,
        (id, number): (&str, usize),
        at: Moment,
        agl_m: f64,
        fence: &Fence,
    ) -> Vec<Margin> {
        let here = Stretch {
            u: (0.0, 1.0),
            from: at.place,
            to: at.place,
        };
        let margin = |value: f64, bound: f64, limit: Limit| {
            let mut worst = Worst::default();
            worst.at_least(value, bound, || at);
            worst.margin(id, limit, "m")
        };
        let threats = self.spec.threats.iter().zip(&self.threats);
        // The vehicle lands there, from no more than the height of the point.
        let ground_m = at.amsl.0 - agl_m;
        let buffers = self.spec.buffers;
        let zone_m = |zone: &Zone| zone_buffer_m(&buffers, zone);
        let is_under = |zone: &Zone| match floor_over(zone, &self.world.terrain) {
            None => false,
            Some(Placement::Amsl(floor)) => at.amsl.0 < floor.0 - zone_m(zone),
            Some(Placement::Agl(floor)) => at.amsl.0 - ground_m < floor.0 - zone_m(zone),
        };
        let zones = self.spec.no_fly.iter().zip(&self.zones);
        let zones = zones.filter(|(zone, _)| !is_under(zone));
        let threats = threats.map(|(threat, cylinder)| {
            let margin_m = cylinder.margin_m(&here, Keep::Outside).0;
            (&threat.id, margin_m, buffers.threats_m)
        });
        let zones = zones.map(|(zone, shape)| (&zone.id, shape.margin_m(&here).0, zone_m(zone)));
        let nearest = threats
            .chain(zones)
            .min_by(|a, b| (a.1 - a.2).total_cmp(&(b.1 - b.2)));
        let clear = nearest.and_then(|(of, margin_m, min_m)| {
            let found = margin(margin_m, min_m, Limit::RallyObstacles(number))?;
            Some(Margin {
                note: format!("nearest: {of}"),
                buffer: min_m,
                ..found
            })
        });
        let area_m = self.area.margin_m(&here, Keep::Inside).0;
        let fenced = (!fence.is_empty()).then(|| fence.place_margin_m(at.place));
        [
            margin(agl_m, self.world.min_agl.0, Limit::RallyClearance(number)),
            clear,
            margin(area_m, buffers.area_m, Limit::RallyArea(number)),
            fenced.and_then(|fence_m| margin(fence_m, 0.0, Limit::RallyFence(number))),
        ]
        .into_iter()
        .flatten()
        .collect()
    }
}
