//! Content of a `.plan` that is not flown: drawings of surveys, estimates, unknown keys.

use serde_json::Value;

use super::{altitude_mode, landing_pattern};
use crate::formats::text::number;

/// Known keys: those that the reader takes, and those that only affect the display.
const ROOT: &[&str] = &[
    "fileType",
    "version",
    "groundStation",
    "mission",
    "geoFence",
    "rallyPoints",
];
const MISSION: &[&str] = &[
    "version",
    "firmwareType",
    "vehicleType",
    "plannedHomePosition",
    "items",
    "globalPlanAltitudeMode",
    "cruiseSpeed",
    "hoverSpeed",
];
const ITEM: &[&str] = &[
    "type",
    "command",
    "frame",
    "params",
    "autoContinue",
    "doJumpId",
    "AltitudeMode",
    "Altitude",
    "AMSLAltAboveTerrain",
];
/// Besides these, in a file that holds a mission alone.
const MISSION_ALONE: &[&str] = &["fileType", "groundStation", "MAV_AUTOPILOT", "complexItems"];
const ITEM_ALONE: &[&str] = &["id", "coordinate", "param1", "param2", "param3", "param4"];
const FENCE: &[&str] = &["version", "polygons", "circles", "breachReturn"];
const POLYGON: &[&str] = &["version", "inclusion", "polygon"];
const CIRCLE: &[&str] = &["version", "inclusion", "circle"];
const ROUND: &[&str] = &["center", "radius"];
const RALLY: &[&str] = &["version", "points"];

/// Vehicle types that stand for their kind: fixed wing, quadrotor, quad-VTOL.
const KINDS: [u64; 3] = [1, 2, 20];

/// The dropped content, one sentence each.
pub(super) fn of(plan: &Value) -> Vec<String> {
    let mut dropped = Dropped::default();
    dropped.keys("", plan, ROOT);
    dropped.mission(&plan["mission"]);
    dropped.fence(&plan["geoFence"]);
    dropped.keys("rallyPoints", &plan["rallyPoints"], RALLY);
    dropped.notes
}

/// The dropped content of a file that holds a mission alone.
pub(super) fn of_mission_alone(mission: &Value) -> Vec<String> {
    let mut dropped = Dropped::default();
    dropped.keys("", mission, &[MISSION, MISSION_ALONE].concat());
    dropped.content("", mission, &[ITEM, ITEM_ALONE].concat());
    dropped.notes
}

#[derive(Default)]
struct Dropped {
    notes: Vec<String>,
}

fn list(value: &Value) -> impl Iterator<Item = (usize, &Value)> {
    value.as_array().into_iter().flatten().enumerate()
}

impl Dropped {
    fn keys(&mut self, at: &str, object: &Value, known: &[&str]) {
        let keys = object.as_object().into_iter().flat_map(|map| map.keys());
        for key in keys.filter(|key| !known.contains(&key.as_str())) {
            let dot = if at.is_empty() { "" } else { "." };
            self.notes.push(format!("{at}{dot}{key}"));
        }
    }

    fn mission(&mut self, mission: &Value) {
        self.keys("mission", mission, MISSION);
        self.content("mission.", mission, ITEM);
    }

    /// What a mission holds beside unknown keys, its path with a dot.
    fn content(&mut self, path: &str, mission: &Value, known: &[&str]) {
        for key in ["cruiseSpeed", "hoverSpeed"] {
            if let Some(speed_mps) = mission[key].as_f64() {
                self.notes.push(format!(
                    "{path}{key} {speed_mps}: the ground station's for its estimate of time"
                ));
            }
        }
        if let Some(kind) = mission["vehicleType"]
            .as_u64()
            .filter(|kind| !KINDS.contains(kind))
        {
            self.notes.push(format!(
                "{path}vehicleType {kind}: one type stands for all of its kind"
            ));
        }
        for (index, item) in list(&mission["items"]) {
            let at = format!("{path}items[{index}]");
            if item["type"] == "ComplexItem" {
                let flown = &item["TransectStyleComplexItem"]["Items"];
                let kind = item["complexItemType"].as_str().unwrap_or("complex item");
                if landing_pattern::is_one(kind) {
                    continue;
                }
                let count = list(flown).count();
                self.notes.push(format!(
                    "{at}: what the {kind} was drawn from; its {count} flown items are kept"
                ));
                for (inner, item) in list(flown) {
                    let at = format!("{at}.TransectStyleComplexItem.Items[{inner}]");
                    self.item(&at, item, known);
                }
            } else {
                self.item(&at, item, known);
            }
        }
    }

    fn item(&mut self, at: &str, item: &Value, known: &[&str]) {
        self.keys(at, item, known);
        let frame = item["frame"]
            .as_u64()
            .and_then(|frame| u8::try_from(frame).ok());
        for (index, value) in list(&item["params"]).filter(|(index, _)| (4..6).contains(index)) {
            let rounded = value.as_f64().zip(frame);
            if let Some(text) = rounded.and_then(|(value, frame)| number::rounded(frame, value)) {
                self.notes.push(format!("{at}.params[{index}]: {text}"));
            }
        }
        if item["AltitudeMode"].as_u64() == Some(altitude_mode::CALCULATED) {
            self.notes.push(format!(
                "{at}.AltitudeMode: drawn above terrain, kept as the altitude that is flown"
            ));
        }
    }

    fn fence(&mut self, fence: &Value) {
        self.keys("geoFence", fence, FENCE);
        for (index, polygon) in list(&fence["polygons"]) {
            let at = format!("geoFence.polygons[{index}]");
            self.keys(&at, polygon, POLYGON);
            let has_height = |corner: &Value| list(corner).count() > 2;
            if list(&polygon["polygon"]).any(|(_, corner)| has_height(corner)) {
                self.notes
                    .push(format!("{at}: altitudes of corners: a fence is flat"));
            }
        }
        for (index, circle) in list(&fence["circles"]) {
            let at = format!("geoFence.circles[{index}]");
            self.keys(&at, circle, CIRCLE);
            self.keys(&format!("{at}.circle"), &circle["circle"], ROUND);
        }
    }
}
