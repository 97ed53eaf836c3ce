//! `flight.jsonl`: one thing that happened on each line.

use serde::{Deserialize, Serialize};

use super::{Fix, Flown, Plan, PopUp};
use crate::flight::conformance::reference::{ReferenceTrajectory, Waypoint};
use crate::flight::document::rounded;
use crate::flight::event::Event;
use crate::flight::itinerary::stops::Itinerary;
use crate::geodesy::{Amsl, LatLon, LocalFrame, PlanPoint};
use crate::numeric::text::escaped_json;
use crate::spec::{Action, AlarmKind, THREAT_RADIUS_M, Threat};

/// Times are written rounded, seconds.
const ROUNDED_S: f64 = 0.01;

/// One line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Line {
    /// What was flown, when.
    Head {
        /// Version of Sortie.
        sortie: String,
        /// SHA-256 of the spec file.
        spec_sha256: String,
        /// How much faster than the wall's clock the vehicles' time went.
        speedup: f64,
        /// Ids of the vehicles in the order of the spec.
        vehicles: Vec<String>,
    },
    /// T0 on the wall's clock.
    Start {
        /// Seconds since 1970.
        t0_unix_s: u64,
    },
    /// A vehicle has a plan, the first or another one.
    Plan {
        /// Since when, seconds after T0.
        t_s: f64,
        /// Id in the spec.
        vehicle: String,
        /// The plan.
        plan: PlanLine,
    },
    /// What a vehicle does on its way.
    Itinerary {
        /// Id in the spec.
        vehicle: String,
        /// Its stops, and what they are for.
        itinerary: Itinerary,
    },
    /// A threat has come up.
    Threat {
        /// When, seconds after T0.
        t_s: f64,
        /// Which.
        threat: ThreatLine,
    },
    /// Where a vehicle was.
    Fix(FixLine),
    /// A vehicle said that it reached an item.
    Reached {
        /// When, seconds after T0.
        t_s: f64,
        /// Id in the spec.
        vehicle: String,
        /// Row of the `.waypoints` file.
        reached: usize,
    },
    /// The program that recorded the flight was stopped.
    Stop {
        /// Until when, seconds after T0.
        t_s: f64,
        /// For how long, seconds.
        stopped_s: f64,
    },
    /// A vehicle was ordered to leave its mission, or is on it again (`continue`).
    Order {
        /// When, seconds after T0.
        t_s: f64,
        /// Id in the spec.
        vehicle: String,
        /// To do what.
        order: Action,
    },
    /// How a vehicle's flight ended.
    End {
        /// Id in the spec.
        vehicle: String,
        /// In the words of [`crate::flight::End::words`].
        end: String,
        /// When, seconds after T0; none where nobody saw it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        t_s: Option<f64>,
    },
    /// An alarm that was raised, or is over, as an operator read it.
    Alarm {
        /// Seconds after T0.
        t_s: f64,
        /// Id in the spec.
        vehicle: String,
        /// The other vehicle of a separation.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        other: Option<String>,
        /// What it is about, as in `on_alarm`.
        alarm: AlarmKind,
        /// Whether it begins; else it is over.
        raised: bool,
        /// In words.
        event: String,
    },
    /// Something that an operator read.
    Event {
        /// Seconds after T0; null before it.
        t_s: Option<f64>,
        /// Whom it is about; null for all.
        vehicle: Option<String>,
        /// What.
        event: String,
    },
}

/// A plan on a line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlanLine {
    items: usize,
    end_s: f64,
    lands: bool,
    waypoints: Vec<WaypointLine>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct WaypointLine {
    item: usize,
    lat_deg: f64,
    lon_deg: f64,
    amsl_m: f64,
    t_s: f64,
    /// A wing circles around it for ever; 0 for a place that is flown to.
    #[serde(default, skip_serializing_if = "is_none")]
    radius_m: f64,
    /// What the verdict lets it be later, beyond its takeoff.
    #[serde(default, skip_serializing_if = "is_none")]
    late_s: f64,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "as serde asks")]
fn is_none(value: &f64) -> bool {
    *value <= 0.0
}

/// A threat on a line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ThreatLine {
    pub(crate) id: String,
    pub(crate) lat_deg: f64,
    pub(crate) lon_deg: f64,
    pub(crate) radius_m: f64,
}

/// A position on a line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FixLine {
    pub(crate) t_s: f64,
    pub(crate) vehicle: String,
    pub(crate) lat_deg: f64,
    pub(crate) lon_deg: f64,
    pub(crate) amsl_m: f64,
    pub(crate) speed_mps: f64,
    pub(crate) item: usize,
    #[serde(default)]
    pub(crate) items: usize,
    /// By the vehicle's own clock, milliseconds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) boot_ms: Option<u32>,
}

impl Line {
    /// Whether `replan` wrote it: a threat, or a plan that a vehicle did not take off with.
    pub(super) fn is_of_replan(&self) -> bool {
        match self {
            Self::Threat { .. } => true,
            Self::Plan { t_s, .. } => *t_s > 0.0,
            _ => false,
        }
    }

    /// The line as it is written, without its end.
    #[must_use]
    pub fn text(&self) -> String {
        // A line holds text and numbers alone.
        let text = serde_json::to_string(self).unwrap_or_default();
        escaped_json(&text).into_owned()
    }

    /// A position.
    #[must_use]
    pub fn of_fix(vehicle: &str, fix: &Fix) -> Self {
        Self::Fix(FixLine {
            t_s: rounded(fix.t_s),
            vehicle: vehicle.to_owned(),
            lat_deg: fix.place.lat_deg,
            lon_deg: fix.place.lon_deg,
            amsl_m: fix.amsl.0,
            speed_mps: fix.speed_mps,
            item: fix.item,
            items: fix.items,
            boot_ms: fix.boot_ms,
        })
    }

    /// How a flight ended.
    #[must_use]
    pub fn of_end(vehicle: &str, flown: &Flown) -> Self {
        Self::End {
            vehicle: vehicle.to_owned(),
            end: flown.end.words().to_owned(),
            t_s: flown.until_s.map(rounded),
        }
    }

    /// Something that happened.
    #[must_use]
    pub fn of_event(event: &Event) -> Self {
        if let (Some(alarm), Some(t_s), Some(vehicle)) = (&event.alarm, event.t_s, &event.vehicle) {
            return Self::Alarm {
                t_s: rounded(t_s),
                vehicle: vehicle.clone(),
                other: alarm.other.clone(),
                alarm: alarm.kind,
                raised: alarm.is_raised,
                event: event.text.clone(),
            };
        }
        Self::Event {
            t_s: event.t_s.map(rounded),
            vehicle: event.vehicle.clone(),
            event: event.text.clone(),
        }
    }

    /// A plan.
    #[must_use]
    pub fn of_plan(vehicle: &str, t_s: f64, plan: &Plan) -> Self {
        let reference = &plan.reference;
        let waypoint = |waypoint: &Waypoint| {
            let place = reference.frame().from_plan(waypoint.point.at);
            WaypointLine {
                item: waypoint.item,
                lat_deg: place.lat_deg,
                lon_deg: place.lon_deg,
                amsl_m: waypoint.point.amsl.0,
                t_s: rounded(waypoint.t_s),
                radius_m: waypoint.radius_m,
                late_s: rounded(waypoint.late_s),
            }
        };
        Self::Plan {
            t_s: rounded(t_s),
            vehicle: vehicle.to_owned(),
            plan: PlanLine {
                items: plan.items,
                end_s: rounded(reference.end_s),
                lands: reference.lands,
                waypoints: reference.waypoints.iter().map(waypoint).collect(),
            },
        }
    }

    /// A threat that has come up.
    #[must_use]
    pub fn of_popup(popup: &PopUp) -> Self {
        Self::Threat {
            t_s: rounded(popup.from_s),
            threat: ThreatLine {
                id: popup.threat.id.clone(),
                lat_deg: popup.threat.place.lat_deg,
                lon_deg: popup.threat.place.lon_deg,
                radius_m: popup.threat.radius_m,
            },
        }
    }
}

impl ThreatLine {
    /// Its name, size and place, in words.
    #[must_use]
    pub fn words(&self) -> String {
        format!(
            "{}: {} m around {:.6} {:.6}",
            self.id, self.radius_m, self.lat_deg, self.lon_deg
        )
    }

    /// The threat, come up at a time in seconds after T0.
    ///
    /// # Errors
    /// Its place is none on earth, its radius or time cannot be, in words.
    pub fn popup(self, t_s: f64) -> Result<PopUp, String> {
        if !THREAT_RADIUS_M.contains(&self.radius_m) || t_s < 0.0 {
            let (id, radius_m) = (&self.id, self.radius_m);
            return Err(format!(
                "the threat {id} of {radius_m} m at {t_s} s (allowed: {} to {} m, from 0 s on)",
                THREAT_RADIUS_M.start(),
                THREAT_RADIUS_M.end()
            ));
        }
        Ok(PopUp {
            from_s: t_s,
            threat: Threat {
                place: place(self.lat_deg, self.lon_deg)?,
                id: self.id,
                kind: "popup".to_owned(),
                radius_m: self.radius_m,
            },
        })
    }
}

impl PlanLine {
    pub(crate) fn plan(self, frame: LocalFrame, from_s: f64) -> Result<Plan, String> {
        let waypoint = |line: WaypointLine| {
            let place = place(line.lat_deg, line.lon_deg)?;
            Ok(Waypoint {
                item: line.item,
                point: PlanPoint {
                    at: frame.to_plan(place),
                    amsl: Amsl(line.amsl_m),
                },
                t_s: line.t_s,
                radius_m: line.radius_m,
                late_s: line.late_s,
            })
        };
        let waypoints = self.waypoints.into_iter().map(waypoint);
        let waypoints = waypoints.collect::<Result<Vec<_>, String>>()?;
        if waypoints.len() < 2 {
            return Err("a plan leads from one place to another at least".to_owned());
        }
        if waypoints.windows(2).any(|pair| pair[1].item < pair[0].item) {
            return Err("the items of a plan go up".to_owned());
        }
        if waypoints.windows(2).any(|pair| pair[1].t_s < pair[0].t_s) {
            return Err("the times of a plan go up".to_owned());
        }
        let last_s = waypoints.last().map_or(0.0, |last| last.t_s);
        if (self.end_s - last_s).abs() > ROUNDED_S {
            return Err(format!(
                "`end_s` {} is when the last waypoint is reached, {last_s}",
                self.end_s
            ));
        }
        if waypoints.iter().any(|waypoint| waypoint.radius_m < 0.0) {
            return Err("the radius of a circle is not negative".to_owned());
        }
        Ok(Plan {
            items: self.items,
            reference: ReferenceTrajectory::of_waypoints(
                waypoints,
                (self.end_s, self.lands),
                frame,
            ),
            from_s,
        })
    }
}

pub(crate) fn place(lat_deg: f64, lon_deg: f64) -> Result<LatLon, String> {
    LatLon::new(lat_deg, lon_deg).map_err(|error| error.to_string())
}
