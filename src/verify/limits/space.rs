//! Limits on where a flight goes: ground, ceiling, threats, zones, area, fence.

use crate::geodesy::{EastNorth, LatLon};
use crate::path::takeoff_lateness_s;
use crate::spec::{MissionSpec, Span, Vehicle, Zone, zone_buffer_m};
use crate::world::{Layer, NoData, World};

use rayon::prelude::*;

use super::closed::{Closed, Times};
use super::fence::Fence;
use crate::verify::execute::flight::Flight;
use crate::verify::measure::outline::{Cylinder, Keep, Outline, Part, ZoneShape};
use crate::verify::measure::segment::{Column, Segment, Stretch, stretches};
use crate::verify::measure::surface::Surface;
use crate::verify::measure::worst::{Worst, nearest_first};
use crate::verify::{Limit, Margin, Moment};

/// Along a climb-out or glide the ground must stay this share of the height above the runway
/// below the vehicle, until that is the minimum height.
pub(crate) const SLOPE_SHARE: f64 = 0.5;

/// Everything that stands still, ready to be measured against.
pub(crate) struct Space<'a> {
    pub(crate) spec: &'a MissionSpec,
    pub(crate) world: &'a World,
    surface: Surface<'a>,
    pub(crate) threats: Vec<Cylinder>,
    pub(crate) zones: Vec<ZoneShape>,
    pub(crate) area: Outline,
}

/// The worst values of one flight so far.
#[derive(Default)]
struct Found {
    clearance: Worst,
    slope: Worst,
    contact: Worst,
    ceiling: Worst,
    height: Worst,
    low: Worst,
    threats: Vec<Worst>,
    zones: Vec<Worst>,
    area: Worst,
    fence: Worst,
}

impl<'a> Space<'a> {
    pub(crate) fn new(spec: &'a MissionSpec, world: &'a World) -> Self {
        Self {
            spec,
            world,
            surface: Surface::new(&world.terrain),
            threats: spec
                .threats
                .iter()
                .map(|threat| Cylinder::new(threat.place, threat.radius_m))
                .collect(),
            zones: spec.no_fly.iter().map(ZoneShape::new).collect(),
            area: Outline::new(spec.area.outline()),
        }
    }

    /// The margins of one flight to everything that stands still.
    pub(crate) fn margins(
        &self,
        vehicle: &Vehicle,
        layer: Layer,
        flight: &Flight,
        fence: &Fence,
    ) -> Vec<Margin> {
        let mut found = Found {
            threats: vec![Worst::default(); self.threats.len()],
            ..Found::default()
        };
        let mut way: Vec<Part<'_>> = Vec::new();
        let mut last: Option<(EastNorth, LatLon)> = None;
        let segments = flight.segments.iter().enumerate();
        for (_, segment) in segments.filter(|(index, _)| Some(*index) != flight.repetition) {
            // Most segments begin where the one before ends.
            let from = last
                .filter(|(at, _)| *at == segment.from.at)
                .unwrap_or_else(|| (segment.from.at, self.world.frame.from_plan(segment.from.at)));
            let parts = stretches(&self.world.frame, from, segment.to.at);
            last = parts.last().map(|part| (segment.to.at, part.to));
            self.judge_ground(segment, &parts, &mut found);
            self.judge_ceiling(segment, &mut found.ceiling);
            self.judge_layer(layer, segment, &parts, &mut found);
            self.judge_threats(segment, &parts, &mut found.threats);
            let part_of = |part: &Stretch| Part::new(segment, *part, segment.bow_m);
            way.extend(parts.iter().map(part_of));
            for part in &parts {
                // What is flown may be as far as its bow from the segment, to any side.
                let bow_m = segment.bow_m;
                let (area_m, w) = self.area.margin_m(part, Keep::Inside);
                let min_m = self.spec.buffers.area_m;
                found
                    .area
                    .at_least(area_m - bow_m, min_m, || moment(segment, part, w));
                if !fence.is_empty() {
                    let (fence_m, w) = fence.margin_m(part, found.fence.room() + bow_m);
                    found
                        .fence
                        .at_least(fence_m - bow_m, 0.0, || moment(segment, part, w));
                }
            }
        }
        let zones = self.spec.no_fly.par_iter().zip(&self.zones);
        let times = Times::of(flight);
        let shift_s = takeoff_lateness_s(vehicle);
        let judged = zones.map(|zone| self.judge_zone(zone, (&times, shift_s), &way));
        found.zones = judged.collect();
        self.found_margins(&vehicle.id, flight, found)
    }

    /// The margins of what was found.
    fn found_margins(&self, id: &str, flight: &Flight, found: Found) -> Vec<Margin> {
        let threats = self.spec.threats.iter();
        let threats = threats.map(|threat| Limit::Threat(threat.id.clone()));
        let margin = |worst: Worst, limit: Limit| worst.margin(id, limit, "m");
        // Nothing but a column up and down is no mission whose height is known to be good.
        let clearance = margin(found.clearance, Limit::TerrainClearance).or_else(|| {
            let why = "the vehicle leaves the ground and flies nowhere";
            let unjudged = || Margin::unjudged(id, Limit::TerrainClearance, why);
            (!flight.segments.is_empty() && !flight.begins_in_column).then(unjudged)
        });
        [
            clearance,
            margin(found.slope, Limit::TakeoffLandingClearance),
            margin(found.contact, Limit::GroundContact),
            margin(found.ceiling, Limit::Ceiling),
            margin(found.height, Limit::MaxHeight),
            margin(found.low, Limit::MinAltitude),
        ]
        .into_iter()
        .chain((threats.zip(found.threats)).map(|(limit, worst)| margin(worst, limit)))
        .chain(self.zone_margins(id, found.zones))
        .chain([
            margin(found.area, Limit::Area),
            margin(found.fence, Limit::Fence),
        ])
        .flatten()
        .collect()
    }

    /// The margins of zones; those from files cite file and item.
    fn zone_margins(&self, id: &str, found: Vec<Worst>) -> Vec<Option<Margin>> {
        let zones = self.spec.no_fly.iter().zip(found);
        let margins = zones.map(|(zone, worst)| {
            let mut margin = worst.margin(id, Limit::Zone(zone.id.clone()), "m")?;
            if margin.note.is_empty() {
                margin.note = zone.source.clone().unwrap_or_default();
            }
            Some(margin)
        });
        margins.collect()
    }

    /// Height above ground. On the route it must be the minimum. The column of a takeoff or
    /// landing begins or ends on the ground and is judged at its upper end, that of a drop at its lower end. A climb-out and a
    /// glide have a limit of their own.
    fn judge_ground(&self, segment: &Segment, parts: &[Stretch], found: &mut Found) {
        let min_m = self.world.min_agl.0;
        if let Some(column) = segment.column {
            if let Some(part) = parts.first() {
                self.judge_contact(segment, column, part, &mut found.contact);
            }
        } else if let Some(followed) = segment.followed {
            let (_, u) = lower_end(followed.agl_m);
            let at = || segment.moment(&self.world.frame, u);
            found.clearance.at_least(followed.min_m, min_m, at);
        } else if let Some(ground_m) = segment.slope_from_m {
            let share_m = |amsl_m: f64| SLOPE_SHARE * (amsl_m - ground_m);
            self.judge_clearance(segment, parts, &share_m, &mut found.slope);
        } else {
            self.judge_clearance(segment, parts, &|_| min_m, &mut found.clearance);
        }
    }

    /// The upper end of a vertical takeoff or landing, and the lower end of a drop, above the ground.
    fn judge_contact(&self, segment: &Segment, column: Column, part: &Stretch, worst: &mut Worst) {
        let rises = segment.to.amsl.0 > segment.from.amsl.0;
        let u = f64::from(u8::from(rises == (column == Column::Ground)));
        let amsl = segment.at(u).amsl;
        match self.surface.height_m(part.from) {
            Ok(ground_m) => worst.at_least(amsl.0 - ground_m, 0.0, || Moment {
                place: part.from,
                amsl,
                t_s: segment.time_s(u),
                item: segment.row,
            }),
            Err(gap) => no_data(worst, 0.0, segment, gap),
        }
    }

    /// Height above the ground under a segment, and the height required at an altitude.
    fn judge_clearance(
        &self,
        segment: &Segment,
        parts: &[Stretch],
        required_m: &dyn Fn(f64) -> f64,
        worst: &mut Worst,
    ) {
        for part in parts {
            let patches = match self.surface.under(part.from, part.to) {
                Ok(patches) => patches,
                Err(gap) => return no_data(worst, self.world.min_agl.0, segment, gap),
            };
            let amsl_m = |w: f64| segment.at(part.along(w)).amsl.0;
            for patch in patches {
                let over_m = |w: f64, ground_m: f64| amsl_m(w) - ground_m - required_m(amsl_m(w));
                let (over_m, v) = patch.min_clearance_m(
                    over_m(patch.w.0, patch.height_m.0),
                    over_m(patch.w.1, patch.height_m.1),
                );
                let w = patch.w.0 + (patch.w.1 - patch.w.0) * v;
                let rise_m = self.surface.bow_rise_m(segment, part, (&patch, w));
                let bound_m = required_m(amsl_m(w));
                let min_m = over_m + bound_m - rise_m;
                worst.at_least(min_m, bound_m, || moment(segment, part, w));
            }
        }
    }

    fn judge_ceiling(&self, segment: &Segment, worst: &mut Worst) {
        let u = f64::from(u8::from(segment.to.amsl.0 > segment.from.amsl.0));
        let slack_m = followed_off_m(segment);
        let highest_m = segment.at(u).amsl.0 + slack_m;
        worst.at_most(highest_m, self.world.max_amsl.0, || {
            segment.moment(&self.world.frame, u)
        });
    }

    /// The greatest height above ground everywhere, and the least altitude on the way: not in the
    /// columns and slopes of takeoff and landing.
    fn judge_layer(&self, layer: Layer, segment: &Segment, parts: &[Stretch], found: &mut Found) {
        if layer.max_agl_m.is_finite() {
            match segment.followed {
                Some(followed) => {
                    let (from_m, to_m) = followed.agl_m;
                    let (_, u) = lower_end((-from_m, -to_m));
                    let at = || segment.moment(&self.world.frame, u);
                    found.height.at_most(followed.max_m, layer.max_agl_m, at);
                }
                None => self.judge_height(layer.max_agl_m, segment, parts, &mut found.height),
            }
        }
        if layer.min_amsl_m.is_finite()
            && segment.column.is_none()
            && segment.slope_from_m.is_none()
        {
            let ends_m = (segment.from.amsl.0, segment.to.amsl.0);
            let (min_m, u) = lower_end(ends_m);
            let slack_m = followed_off_m(segment);
            let at = || segment.moment(&self.world.frame, u);
            found.low.at_least(min_m - slack_m, layer.min_amsl_m, at);
        }
    }

    /// Height above the lowest ground under a segment.
    fn judge_height(&self, max_m: f64, segment: &Segment, parts: &[Stretch], worst: &mut Worst) {
        for part in parts {
            let patches = match self.surface.under(part.from, part.to) {
                Ok(patches) => patches,
                Err(gap) => return no_data(worst, max_m, segment, gap),
            };
            for patch in patches {
                let over_m = |w: f64, ground_m: f64| segment.at(part.along(w)).amsl.0 - ground_m;
                let (over_m, v) = patch.greatest_clearance_m(
                    over_m(patch.w.0, patch.height_m.0),
                    over_m(patch.w.1, patch.height_m.1),
                );
                let w = patch.w.0 + (patch.w.1 - patch.w.0) * v;
                let fall_m = self.surface.bow_rise_m(segment, part, (&patch, w));
                worst.at_most(over_m + fall_m, max_m, || moment(segment, part, w));
            }
        }
    }

    fn judge_threats(&self, segment: &Segment, parts: &[Stretch], worst: &mut [Worst]) {
        let min_m = self.spec.buffers.threats_m;
        for ((disc, cylinder), worst) in self.world.threats.iter().zip(&self.threats).zip(worst) {
            // Distances in the plane differ from those around the threat by far less than this.
            let around_m = disc.center.distance_m(segment.at(0.5).at)
                - 0.5 * segment.from.at.distance_m(segment.to.at);
            if 0.999 * around_m - disc.radius_m - 1.0 - segment.bow_m > worst.room() {
                continue;
            }
            for part in parts {
                let (margin_m, w) = cylinder.margin_m(part, Keep::Outside);
                worst.at_least(margin_m - segment.bow_m, min_m, || moment(segment, part, w));
            }
        }
    }

    /// The room to a zone for a vehicle that may be early or late from its takeoff on. Inside its box
    /// nothing is known of that but that it may be negative.
    fn judge_zone(
        &self,
        (zone, shape): (&Zone, &ZoneShape),
        (times, shift_s): (&Times<'_>, Span),
        way: &[Part<'_>],
    ) -> Worst {
        let min_m = zone_buffer_m(&self.spec.buffers, zone);
        let slack_s = self.spec.separation.time_slack_s;
        let shift_s = Span {
            least: shift_s.least - slack_s,
            most: shift_s.most + slack_s,
        };
        let closed = Closed::new(zone, &self.surface, (times, shift_s));
        let closed = closed.widened(min_m);
        let judge = |part: &Part<'_>, worst: &mut Worst| {
            for stretch in closed.parts(part.segment, &part.stretch) {
                let (margin_m, w) = shape.margin_m(&stretch);
                worst.at_least(margin_m - part.slack_m, min_m, || {
                    moment(part.segment, &stretch, w)
                });
            }
        };
        nearest_first(
            way,
            |part| shape.bound_m(&part.around) - part.slack_m - min_m,
            -min_m,
            judge,
        )
    }
}

/// The lower of two heights and the fraction of the segment there; NaN is lower than any.
fn lower_end((from_m, to_m): (f64, f64)) -> (f64, f64) {
    if from_m <= to_m || from_m.is_nan() {
        (from_m, 0.0)
    } else {
        (to_m, 1.0)
    }
}

/// How far a segment that follows the terrain may be off in altitude, metres.
fn followed_off_m(segment: &Segment) -> f64 {
    segment
        .followed
        .map_or(0.0, |of| segment.error_m + of.off_m)
}

fn moment(segment: &Segment, part: &Stretch, w: f64) -> Moment {
    let u = part.along(w);
    Moment {
        place: part.place(w),
        amsl: segment.at(u).amsl,
        t_s: segment.time_s(u),
        item: segment.row,
    }
}

fn no_data(worst: &mut Worst, limit_m: f64, segment: &Segment, gap: NoData) {
    let at = Moment {
        place: gap.place,
        amsl: segment.from.amsl,
        t_s: segment.from_s,
        item: segment.row,
    };
    worst.unknown(limit_m, gap.to_string(), at);
}

#[cfg(test)]
mod tests {
    use super::lower_end;

    #[test]
    fn a_height_that_is_not_a_number_at_either_end_is_the_lower_one() {
        assert!(lower_end((f64::NAN, 50.0)).0.is_nan());
        assert!(lower_end((50.0, f64::NAN)).0.is_nan());
        assert_eq!(lower_end((50.0, 40.0)).1.to_bits(), 1.0_f64.to_bits());
        assert_eq!(lower_end((40.0, 50.0)).1.to_bits(), 0.0_f64.to_bits());
    }
}
