//! Zones with a shape: outlines, floors, ceilings and times.

use geo::{Contains, LineString, Polygon};
use jiff::Timestamp;

use super::super::keys;
use super::super::{Area, Placement, Zone};
use super::Checker;
use super::keep_in::outside;
use super::map::are_near;
use crate::geodesy::{Agl, Amsl, LatLon, LocalFrame, flight_level};
use crate::numeric::digits;
use crate::numeric::text::timestamp;

/// What heights and times of zones refer to.
#[derive(Clone, Copy)]
pub(super) struct References {
    pub(super) qnh: Option<keys::Qnh>,
    pub(super) t0: Option<Timestamp>,
}

impl Checker {
    /// QNH and T0 of a spec.
    pub(super) fn references(&mut self, keys: &keys::Spec) -> References {
        let qnh = keys.qnh_hpa.filter(|qnh| {
            let is_ordered = qnh.min <= qnh.max;
            if !is_ordered {
                let found = format!("{} to {}", qnh.min, qnh.max);
                self.report("qnh_hpa", found, "min not above max");
            }
            is_ordered
        });
        let t0 = keys.t0.as_deref().and_then(|text| self.time("t0", text));
        References { qnh, t0 }
    }

    /// Reports ids that two zones have, wherever they stand.
    pub(super) fn unique_zones(&mut self, keys: &keys::Spec) {
        self.unique(
            "zones",
            keys.zones.iter().map(|zone| Some(zone.id.as_str())),
        );
        for (index, zone) in keys.zones.iter().enumerate() {
            let of = keys.no_fly.iter().position(|other| other.id == zone.id);
            if let Some(other) = of {
                let found = format!(
                    "`{}`, already the id of no_fly[{other}]",
                    zone.id.escape_debug()
                );
                self.report(&format!("zones[{index}].id"), found, "unique ids");
            }
        }
    }

    fn time(&mut self, path: &str, text: &str) -> Option<Timestamp> {
        let time = timestamp(text);
        if time.is_none() {
            let found = format!("`{}`", text.escape_debug());
            let allowed = "a time such as 2026-12-01T08:00:00Z or 2026-12-01T09:00:00+01:00, with an offset of at most 23:59";
            self.report(path, found, allowed);
        }
        time
    }

    /// The zones, and what lies outside of those to stay in.
    pub(super) fn shaped_zones(
        &mut self,
        keys: &keys::Spec,
        frame: &LocalFrame,
        (area, references): (&Area, References),
    ) -> Vec<Zone> {
        let (mut zones, mut keep_in) = (Vec::new(), Vec::new());
        for (index, of) in keys.zones.iter().enumerate() {
            let zone = self.shaped_zone((index, of), frame, references);
            match (zone, of.keep_in) {
                (Some(zone), true) => {
                    keep_in.extend(self.check_keep_in(&format!("zones[{index}]"), zone));
                }
                (zone, _) => zones.extend(zone),
            }
        }
        zones.extend(outside(&keep_in, area));
        zones
    }

    /// A zone whose parts are all good.
    fn shaped_zone(
        &mut self,
        (index, keys): (usize, &keys::ShapedZone),
        frame: &LocalFrame,
        references: References,
    ) -> Option<Zone> {
        let path = format!("zones[{index}]");
        self.label(&format!("{path}.id"), &keys.id);
        let (polygon, circle) = match (&keys.polygon, keys.circle) {
            (Some(corners), None) => {
                let path = format!("{path}.polygon");
                (self.ring(&path, frame, corners)?, None)
            }
            (None, Some(circle)) => {
                let center = LatLon::new(circle.lat, circle.lon).ok()?;
                if !super::super::THREAT_RADIUS_M.contains(&circle.radius_m) {
                    return None;
                }
                let around = LocalFrame::new(center).circumscribed(circle.radius_m);
                (around, Some((center, circle.radius_m)))
            }
            _ => {
                let found = "none or both of polygon and circle";
                self.report(&path, found, "exactly one");
                return None;
            }
        };
        let floor = self.height((&path, "floor"), keys.floor, references.qnh);
        let ceiling = self.height((&path, "ceiling"), keys.ceiling, references.qnh);
        let active_s = self.active(&path, keys.active.as_ref(), references.t0);
        let holes = self.holes((&path, keys), frame, &polygon)?;
        let zone = Zone {
            holes,
            circle,
            floor: floor?,
            ceiling: ceiling?,
            active_s: active_s?,
            ..Zone::closed(keys.id.clone(), polygon)
        };
        self.is_ordered(&path, &zone).then_some(zone)
    }

    /// The corners of one ring of a zone.
    fn ring(
        &mut self,
        path: &str,
        frame: &LocalFrame,
        corners: &[[f64; 2]],
    ) -> Option<Vec<LatLon>> {
        let corners = self.ring_corners(path, corners)?;
        let is_good = are_near(&corners, frame.origin()) && self.polygon(path, frame, &corners);
        is_good.then_some(corners)
    }

    /// The holes, all within the polygon and apart from each other.
    fn holes(
        &mut self,
        (path, keys): (&str, &keys::ShapedZone),
        frame: &LocalFrame,
        polygon: &[LatLon],
    ) -> Option<Vec<Vec<LatLon>>> {
        let mut holes: Vec<Vec<LatLon>> = Vec::new();
        let outer = frame.outline(polygon);
        for (index, corners) in keys.holes.iter().enumerate() {
            let path = format!("{path}.holes[{index}]");
            let hole = self.ring(&path, frame, corners)?;
            let shape = frame.outline(&hole);
            let is_alone = holes.iter().all(|other| {
                let other = frame.outline(other);
                !geo::Intersects::intersects(&other, &shape)
            });
            if !holds(&outer, &shape) || !is_alone {
                let found = "a hole that is not inside the polygon, or meets another hole";
                self.report(&path, found, "holes inside, apart from each other");
                return None;
            }
            holes.push(hole);
        }
        Some(holes)
    }

    /// A floor or ceiling in metres; of a flight level, the least or greatest altitude that it
    /// can be, so that the zone is never smaller than the real one.
    #[expect(clippy::option_option, reason = "absent is good, wrong is not")]
    fn height(
        &mut self,
        (path, key): (&str, &str),
        keys: Option<keys::Height>,
        qnh: Option<keys::Qnh>,
    ) -> Option<Option<Placement>> {
        let Some(keys) = keys else { return Some(None) };
        let path = format!("{path}.{key}");
        let placement = match (keys.amsl_m, keys.agl_m, keys.fl) {
            (Some(amsl_m), None, None) => Placement::Amsl(Amsl(amsl_m)),
            (None, Some(agl_m), None) => Placement::Agl(Agl(agl_m)),
            (None, None, Some(level)) => {
                let Some(qnh) = qnh else {
                    let found = format!("flight level {} without qnh_hpa", digits::plain(level));
                    let allowed = "qnh_hpa: {min: 995, max: 1030} of the day, or amsl_m";
                    self.report(&path, found, allowed);
                    return None;
                };
                let at_hpa = if key == "floor" { qnh.min } else { qnh.max };
                Placement::Amsl(flight_level(level, at_hpa))
            }
            _ => {
                let found = "none or several of amsl_m, agl_m and fl";
                self.report(&path, found, "exactly one");
                return None;
            }
        };
        Some(Some(placement))
    }

    /// Seconds after T0; without T0, always.
    #[expect(clippy::option_option, reason = "absent is good, wrong is not")]
    fn active(
        &mut self,
        path: &str,
        keys: Option<&keys::Active>,
        t0: Option<Timestamp>,
    ) -> Option<Option<(f64, f64)>> {
        let Some(keys) = keys else { return Some(None) };
        let mut end = |key: &str, text: &Option<String>, absent_s: f64| match text {
            Some(text) => {
                let time = self.time(&format!("{path}.active.{key}"), text)?;
                Some(t0.map_or(absent_s, |t0| time.duration_since(t0).as_secs_f64()))
            }
            None => Some(absent_s),
        };
        let from_s = end("from", &keys.from, f64::NEG_INFINITY);
        let to_s = end("to", &keys.to, f64::INFINITY);
        let (from_s, to_s) = (from_s?, to_s?);
        if from_s >= to_s {
            let found = "a period that ends before it begins";
            self.report(&format!("{path}.active"), found, "from before to");
            return None;
        }
        Some((from_s.is_finite() || to_s.is_finite()).then_some((from_s, to_s)))
    }

    /// Whether the ceiling is above the floor, where both have the same reference.
    fn is_ordered(&mut self, path: &str, zone: &Zone) -> bool {
        let (low_m, high_m) = match (zone.floor, zone.ceiling) {
            (Some(Placement::Amsl(low)), Some(Placement::Amsl(high))) => (low.0, high.0),
            (Some(Placement::Agl(low)), Some(Placement::Agl(high))) => (low.0, high.0),
            _ => return true,
        };
        if low_m < high_m {
            return true;
        }
        let found = format!("a ceiling at {high_m:.1} m and a floor at {low_m:.1} m");
        self.report(
            &format!("{path}.ceiling"),
            found,
            "a ceiling above the floor",
        );
        false
    }
}

/// Whether a polygon holds all of another one.
fn holds(outer: &Polygon<f64>, inner: &Polygon<f64>) -> bool {
    let ring: &LineString<f64> = inner.exterior();
    outer.contains(ring)
}
