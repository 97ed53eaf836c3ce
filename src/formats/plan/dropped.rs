//! Content of a `.plan` that is not flown: drawings of surveys, estimates, unknown keys.

use serde_json::Value;

use super::{altitude_mode, landing_pattern};

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
        for key in ["cruiseSpeed", "hoverSpeed"] {
            if let Some(speed_mps) = mission[key].as_f64() {
                self.notes.push(format!(
                    "mission.{key} {speed_mps}: the ground station's for its estimate of time"
                ));
            }
        }
        if let Some(kind) = mission["vehicleType"]
            .as_u64()
            .filter(|kind| !KINDS.contains(kind))
        {
            self.notes.push(format!(
                "mission.vehicleType {kind}: one type stands for all of its kind"
            ));
        }
        for (index, item) in list(&mission["items"]) {
            let at = format!("mission.items[{index}]");
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
                    self.item(
                        &format!("{at}.TransectStyleComplexItem.Items[{inner}]"),
                        item,
                    );
                }
            } else {
                self.item(&at, item);
            }
        }
    }

    fn item(&mut self, at: &str, item: &Value) {
        self.keys(at, item, ITEM);
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
