//! Where a mission begins and ends: home, start, goal, finish.

use super::MissionCheck;
use crate::geodesy::{Amsl, LatLon, PlanPoint};
use crate::spec::{Airframe, Finish};
use crate::verify::execute::flight::{End, Mark};
use crate::verify::limits::fence::Fence;
use crate::verify::measure::segment::{Column, Phase, Segment};
use crate::verify::measure::worst::Worst;
use crate::verify::{Limit, Margin, Moment};
use crate::world::Terrain;

/// Home may be written this far from the ground at most, metres, however wide the tolerance.
const HOME_M: f64 = 5.0;

impl MissionCheck<'_> {
    /// The home row: where the spec says, at the height of the terrain, inside the fence. A
    /// vehicle in the air has left it.
    pub(crate) fn home(&self, home: Option<LatLon>, fence: &Fence) -> Vec<Margin> {
        if self.sites.departure.is_airborne() {
            return Vec::new();
        }
        let Some(place) = home else {
            let LatLon { lat_deg, lon_deg } = self.vehicle.home;
            let why = format!(
                "the home row holds no place; judged from home at {lat_deg:.7}, {lon_deg:.7}"
            );
            return vec![Margin::unjudged(self.id(), Limit::HomePosition, why)];
        };
        let tolerance_m = self.spec.mission.tolerance_m;
        let amsl = Amsl(f64::from(self.mission.home.amsl_m));
        let at = Moment {
            place,
            amsl,
            t_s: 0.0,
            item: 0,
        };
        // Straight through the earth: right even for a home on its other side.
        let away_m = (place.to_ecef(0.0) - self.vehicle.home.to_ecef(0.0)).norm();
        let mut position = Worst::default();
        position.at_most(away_m, tolerance_m, || at);
        let mut altitude = Worst::default();
        let near_m = tolerance_m.min(HOME_M);
        match self.world.terrain.height(place) {
            Ok(ground) => altitude.at_most((amsl.0 - ground.0).abs(), near_m, || at),
            Err(gap) => altitude.unknown(near_m, gap.to_string(), at),
        }
        let mut inside = Worst::default();
        if !fence.is_empty() {
            inside.at_least(fence.place_margin_m(place), 0.0, || at);
        }
        [
            position.margin(self.id(), Limit::HomePosition, "m"),
            altitude.margin(self.id(), Limit::HomeAltitude, "m"),
            inside.margin(self.id(), Limit::HomeFence, "m"),
        ]
        .into_iter()
        .flatten()
        .collect()
    }

    /// The lowest point of the route against home, where no terrain says more: what is not above
    /// home is in the ground where home stands, and may be anywhere else.
    pub(crate) fn above_home(&self) -> Option<Margin> {
        if self.world.terrain != Terrain::Unknown {
            return None;
        }
        let home_m = f64::from(self.mission.home.amsl_m);
        let mut worst = Worst::default();
        let segments = self.flight.segments.iter();
        // Columns, climb-outs and glides begin or end at home; heights above the ground need none.
        let is_route = |segment: &&Segment| {
            (segment.phase == Phase::Route || !self.vehicle.airframe.has_wing())
                && segment.flown
                && segment.column != Some(Column::Ground)
                && segment.followed.is_none()
                && segment.slope_from_m.is_none()
        };
        for segment in segments.filter(is_route) {
            for u in [0.0, 1.0] {
                let above_m = segment.at(u).amsl.0 - home_m;
                worst.at_least(above_m, 0.0, || segment.moment(&self.world.frame, u));
            }
        }
        // A corner may be cut short of its place, and the vehicle may come to it all the same.
        if let Some(mark) = self.flight.low_point {
            let above_m = mark.point.amsl.0 - home_m;
            worst.at_least(above_m, 0.0, || self.moment(mark.point, mark.t_s, mark.row));
        }
        let mut margin = worst.margin(self.id(), Limit::AboveHome, "m")?;
        if let Some(above_m) = self.flight.blind_landing_m {
            let side = if above_m < 0.0 { "below" } else { "above" };
            let away_m = above_m.abs();
            margin.ok = false;
            margin.note = format!(
                "lands {away_m:.1} m {side} home, and the ground there is not known: judge it over its terrain (--terrain)"
            );
            return Some(margin);
        }
        margin.ok &= margin.value > 0.0;
        if !margin.ok {
            "not above home, and the ground is not known: judge it over its terrain (--terrain)"
                .clone_into(&mut margin.note);
        }
        Some(margin)
    }

    /// The first position against the start, the last against the goal.
    pub(crate) fn route(&self) -> Vec<Margin> {
        let tolerance_m = self.spec.mission.tolerance_m;
        let near = |marks: &[Mark], site: PlanPoint, limit: Limit| {
            let mut worst = Worst::default();
            // The nearest of the candidates counts.
            let best = marks
                .iter()
                .map(|mark| (mark.point.distance_m(site), mark))
                .min_by(|a, b| a.0.total_cmp(&b.0));
            match best {
                Some((away_m, mark)) => {
                    worst.at_most(away_m, tolerance_m, || {
                        self.moment(mark.point, mark.t_s, mark.row)
                    });
                    worst.margin(self.id(), limit, "m")
                }
                None => Some(Margin::unjudged(
                    self.id(),
                    limit,
                    "the mission has no such point",
                )),
            }
        };
        let route = &self.flight.route;
        // Turns lead a wing onto its route and off it again.
        let has_wing = self.vehicle.airframe.has_wing();
        let ends = match self.vehicle.finish {
            // The goal is on the way.
            Finish::Return => route.as_slice(),
            Finish::Land | Finish::Loiter if has_wing => route.as_slice(),
            Finish::Land | Finish::Loiter => &route[route.len().saturating_sub(1)..],
        };
        let first = if has_wing {
            route.as_slice()
        } else {
            &route[..route.len().min(1)]
        };
        let mut margins: Vec<Margin> = near(first, self.sites.start, Limit::Start)
            .into_iter()
            .collect();
        if self.flight.unknown.is_none() {
            margins.extend(near(ends, self.goal(), Limit::Goal));
        }
        margins
    }

    /// Where the route ends: a vtol that lands from any direction flies its last stretch at
    /// the height that it has.
    pub(super) fn goal(&self) -> PlanPoint {
        let goal = self.sites.goal;
        let levels = self.vehicle.airframe == Airframe::Vtol
            && self.vehicle.finish == Finish::Land
            && self.sites.landing_rad.is_none();
        match self.flight.route.last() {
            Some(last) if levels => PlanPoint {
                amsl: last.point.amsl,
                ..goal
            },
            _ => goal,
        }
    }

    /// Lands, or stays, where the spec says.
    pub(crate) fn finish(&self) -> Option<Margin> {
        let end = self.flight.end?;
        let last = self.flight.segments.last()?;
        let (site, lands) = match self.vehicle.finish {
            Finish::Land => (self.sites.landing, true),
            Finish::Return => (self.sites.home.at, true),
            Finish::Loiter => (self.sites.goal.at, false),
        };
        let unjudged = |why: &str| Some(Margin::unjudged(self.id(), Limit::Finish, why));
        let at = match (end, lands) {
            (End::Landed(at), true) | (End::Stays(at), false) => at,
            (End::Landed(_), false) => {
                return unjudged("the mission lands, the spec says loiter");
            }
            (End::Repeats, _) => {
                return unjudged("the mission repeats for ever, the spec ends it");
            }
            (End::Stays(_), true) => {
                return unjudged("the mission ends in the air, the spec says land");
            }
        };
        let mut worst = Worst::default();
        let drift_m = self.flight.landing_drift_m;
        worst.at_most(
            at.distance_m(site) + drift_m,
            self.spec.mission.tolerance_m,
            || last.moment(&self.world.frame, 1.0),
        );
        let margin = worst.margin(self.id(), Limit::Finish, "m")?;
        let is_driven = drift_m > 0.0 && !margin.ok;
        let note = is_driven.then(|| self.vehicle.landing_note(None)).flatten();
        Some(Margin {
            note: note.unwrap_or_default(),
            ..margin
        })
    }
}
