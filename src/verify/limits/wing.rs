//! What the spec says of a wing (a plane or VTOL): the course of its takeoff, its glide, its circle.

use std::f64::consts::{PI, TAU};

use super::mission::MissionCheck;
use crate::verify::measure::segment::Segment;
use crate::verify::measure::worst::Worst;
use crate::verify::{Limit, Margin, Moment};

/// A course may differ from the planned one by this, degrees.
const COURSE_DEG: f64 = 2.0;
/// A glide may be steeper than the planned one by this, degrees: altitudes are encoded in
/// quarters of a metre.
const GLIDE_DEG: f64 = 0.5;

impl MissionCheck<'_> {
    /// The wind of the spec, against the greatest in which the flight model holds.
    fn wind_allowed(&self, at: Moment) -> Option<Margin> {
        let figure = self.vehicle.facts().behaviour.max_wind_mps;
        let most = figure.of(self.vehicle.autopilot_version)?;
        let wind = self.spec.wind.filter(|wind| wind.speed_mps > 0.0)?;
        let mut worst = Worst::default();
        worst.at_most(wind.speed_mps, most.value, || at);
        let margin = worst.margin(self.id(), Limit::Wind, most.unit)?;
        let note = self.vehicle.too_much_wind().filter(|_| !margin.ok);
        let note = note.unwrap_or_default();
        Some(Margin { note, ..margin })
    }

    /// Takeoff, landing and circle of a plane or vtol, as far as there are any.
    pub(crate) fn wing(&self) -> Vec<Margin> {
        let Some(wing) = self.vehicle.wing else {
            return Vec::new();
        };
        let (flight, frame) = (self.flight, &self.world.frame);
        let (Some(first), Some(last)) = (flight.segments.first(), flight.segments.last()) else {
            return Vec::new();
        };
        let mut margins = Vec::new();
        margins.extend(self.wind_allowed(first.moment(frame, 0.0)));
        let mut course = |is_rad: f64, planned_rad: f64, limit: Limit, at| {
            let off_rad = (is_rad - planned_rad + PI).rem_euclid(TAU) - PI;
            let mut worst = Worst::default();
            worst.at_most(off_rad.abs().to_degrees(), COURSE_DEG, || at);
            margins.extend(worst.margin(self.id(), limit, "deg"));
        };
        if let Some((is_rad, planned_rad)) = flight.takeoff_rad.zip(wing.takeoff_heading_rad) {
            let liftoff = first.moment(frame, 0.0);
            course(is_rad, planned_rad, Limit::TakeoffHeading, liftoff);
        }
        if let Some(((is_rad, glide_rad), landing)) = flight.landing.zip(wing.landing) {
            let touchdown = last.moment(frame, 1.0);
            if let Some(planned_rad) = self.sites.landing_rad.or(landing.heading_rad) {
                course(is_rad, planned_rad, Limit::LandingHeading, touchdown);
            }
            let mut glide = Worst::default();
            let limit_deg = landing.glide_rad.to_degrees() + GLIDE_DEG;
            glide.at_most(glide_rad.to_degrees(), limit_deg, || touchdown);
            margins.extend(glide.margin(self.id(), Limit::GlideAngle, "deg"));
        }
        margins.extend(self.circles(wing.loiter_radius_m, last));
        margins
    }

    /// The circles: none tighter than the vehicle turns at its speed, and the last no tighter than planned.
    fn circles(&self, planned_m: f64, last: &Segment) -> Option<Margin> {
        let (flight, frame) = (self.flight, &self.world.frame);
        let at = |segment: usize| {
            flight
                .segments
                .get(segment)
                .unwrap_or(last)
                .moment(frame, 0.0)
        };
        let mut radius = Worst::default();
        if let Some(circle) = flight.circle {
            radius.at_least(circle.radius_m, planned_m, || at(circle.segment));
        }
        let mut is_too_tight = false;
        for round in &flight.rounds {
            is_too_tight |= round.radius_m < round.min_m;
            radius.at_least(round.radius_m, round.min_m, || at(round.segment));
        }
        let margin = radius.margin(self.id(), Limit::LoiterRadius, "m")?;
        let note = match is_too_tight {
            true if !margin.ok => {
                "it cannot turn so tightly at its speed and greatest bank".to_owned()
            }
            _ => margin.note,
        };
        Some(Margin { note, ..margin })
    }
}
