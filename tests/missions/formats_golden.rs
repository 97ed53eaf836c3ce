//! Files as they are on disk, and that they come back.

#![expect(clippy::float_cmp, reason = "encoded values are exact")]

use proptest::prelude::*;
use sortie::formats::{Document, Format, losses, plan, waypoints};
use sortie::mission::{Home, Item, VehicleMission, command, frame};
use sortie::spec::{Airframe, Autopilot};

fn item(command: u16, frame: u8, params: [f32; 4], x: i32, y: i32, z: f32) -> Item {
    Item {
        command,
        frame,
        autocontinue: true,
        params,
        x,
        y,
        z,
    }
}

fn corner(command: u16, param1: f32, x: i32, y: i32) -> Item {
    Item {
        autocontinue: false,
        ..item(command, frame::GLOBAL, [param1, 0.0, 0.0, 0.0], x, y, 0.0)
    }
}

fn rally(x: i32, y: i32, z: f32) -> Item {
    Item {
        autocontinue: false,
        ..item(command::NAV_RALLY_POINT, 3, [0.0; 4], x, y, z)
    }
}

fn example(autopilot: Autopilot) -> VehicleMission {
    let heading = if autopilot == Autopilot::Px4 {
        f32::NAN
    } else {
        0.0
    };
    let at = |command, hold, x, y, z| item(command, 3, [hold, 0.0, 0.0, heading], x, y, z);
    VehicleMission {
        autopilot_version: None,
        autopilot,
        airframe: Airframe::Copter,
        home: Home {
            x: 362_500_000,
            y: -843_000_001,
            amsl_m: 400.12,
        },
        items: vec![
            Item::without_place(command::NAV_DELAY, [12.5, -1.0, -1.0, -1.0]),
            at(22, 0.0, 362_500_000, -843_000_001, 80.0),
            at(16, 1.0, 363_300_000, -842_000_000, 80.25),
            Item::without_place(
                command::DO_JUMP,
                [
                    if autopilot == Autopilot::Px4 {
                        2.0
                    } else {
                        3.0
                    },
                    2.0,
                    0.0,
                    0.0,
                ],
            ),
            at(21, 0.0, -5, 1_799_999_999, -0.25),
        ],
        fence: vec![
            corner(5001, 3.0, 362_000_000, -844_000_000),
            corner(5001, 3.0, 362_000_000, -841_000_000),
            corner(5001, 3.0, 364_000_000, -842_000_000),
            corner(5004, 900.5, 363_000_000, -842_500_000),
        ],
        rally: vec![rally(362_600_000, -843_000_000, 81.0)],
        params: Vec::new(),
        is_fence_known: true,
        notes: Vec::new(),
    }
}

#[test]
fn waypoints_are_tabs_exact_degrees_and_a_home_row() {
    assert_eq!(
        waypoints::write(&example(Autopilot::Px4)),
        "QGC WPL 110\n\
         0\t1\t0\t16\t0\t0\t0\t0\t36.2500000\t-84.3000001\t400.12\t1\n\
         1\t0\t2\t93\t12.5\t-1\t-1\t-1\t0\t0\t0\t1\n\
         2\t0\t3\t22\t0\t0\t0\t0\t36.2500000\t-84.3000001\t80\t1\n\
         3\t0\t3\t16\t1\t0\t0\t0\t36.3300000\t-84.2000000\t80.25\t1\n\
         4\t0\t2\t177\t3\t2\t0\t0\t0\t0\t0\t1\n\
         5\t0\t3\t21\t0\t0\t0\t0\t-0.0000005\t179.9999999\t-0.25\t1\n"
    );
}

#[test]
fn a_plan_is_the_json_that_ground_stations_write() {
    let text = plan::write(&example(Autopilot::Px4));
    let json: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(json["fileType"], "Plan");
    assert_eq!(
        (&json["version"], &json["mission"]["version"]),
        (&1.into(), &2.into())
    );
    assert_eq!(json["mission"]["firmwareType"], 12);
    assert_eq!(json["mission"]["vehicleType"], 2);
    assert_eq!(
        json["mission"]["plannedHomePosition"],
        serde_json::json!([36.25, -84.3000001, 400.12])
    );
    assert_eq!(
        json["mission"]["items"][1],
        serde_json::json!({
            "AMSLAltAboveTerrain": null, "Altitude": 80, "AltitudeMode": 1, "autoContinue": true,
            "command": 22, "doJumpId": 2, "frame": 3,
            "params": [0, 0, 0, null, 36.25, -84.3000001, 80], "type": "SimpleItem",
        })
    );
    assert_eq!(
        json["mission"]["items"][0]["AltitudeMode"],
        serde_json::Value::Null
    );
    assert_eq!(json["mission"]["items"][3]["params"][0], 3);
    assert_eq!(json["geoFence"]["circles"][0]["circle"]["radius"], 900.5);
    assert_eq!(
        json["geoFence"]["polygons"][0]["polygon"][2],
        serde_json::json!([36.4, -84.2])
    );
    assert_eq!(
        json["rallyPoints"]["points"],
        serde_json::json!([[36.26, -84.3, 81]])
    );
    assert!(text.ends_with("}\n"));
    let empty = VehicleMission {
        fence: vec![],
        rally: vec![],
        ..example(Autopilot::ArduPilot)
    };
    let json: serde_json::Value = serde_json::from_str(&plan::write(&empty)).expect("JSON");
    assert_eq!(
        json["geoFence"],
        serde_json::json!({"circles": [], "polygons": [], "version": 2})
    );
    assert_eq!(
        json["rallyPoints"],
        serde_json::json!({"points": [], "version": 2})
    );
}

#[test]
fn a_plan_comes_back_whole() {
    for autopilot in [Autopilot::ArduPilot, Autopilot::Px4] {
        let mission = example(autopilot);
        let document = plan::read(&plan::write(&mission)).expect("readable");
        assert_eq!(
            (document.autopilot, &document.repairs),
            (Some(autopilot), &Vec::new())
        );
        assert_eq!(
            document.into_mission(autopilot, Airframe::Copter),
            Ok(mission)
        );
    }
}

#[test]
fn what_the_waypoints_format_loses_is_told() {
    let told = losses(&example(Autopilot::Px4), Format::Waypoints);
    assert_eq!(told.len(), 4, "{told:?}");
    assert!(told[0].contains("written as 0 in 3 items"));
    assert_eq!(losses(&example(Autopilot::Px4), Format::Plan), [""; 0]);
}

#[test]
fn a_file_without_home_or_for_another_autopilot_is_no_mission() {
    let text = waypoints::write(&example(Autopilot::ArduPilot)).replace("WPL 110", "WPL 120");
    let document = waypoints::read(&text).expect("readable");
    let error = document
        .into_mission(Autopilot::ArduPilot, Airframe::Copter)
        .expect_err("no home");
    assert_eq!(error.to_string(), "the file has no home position");
    let document = plan::read(&plan::write(&example(Autopilot::Px4))).expect("readable");
    let error = document
        .into_mission(Autopilot::ArduPilot, Airframe::Copter)
        .expect_err("PX4");
    assert!(error.to_string().contains("PX4"), "{error}");
}

/// A plan with these items and nothing else.
fn plan_of(items: &str) -> String {
    format!(
        r#"{{"fileType":"Plan","version":1,"UUID":"x","mission":{{"version":2,"firmwareType":12,"vehicleType":2,
        "plannedHomePosition":[47.39,8.54,488],"items":[{items}]}},
        "geoFence":{{"version":2}},"rallyPoints":{{"version":2}}}}"#
    )
}

const SIMPLE: &str = r#"{"type":"SimpleItem","command":16,"frame":3,"doJumpId":7,"MISSION_ITEM_ID":"1",
    "params":[0,0,0,null,47.4,8.55,50],"Altitude":50,"AltitudeMode":1}"#;

#[test]
fn the_flown_items_of_a_survey_are_read_and_jumps_follow_their_ids() {
    let survey = format!(
        r#"{{"type":"ComplexItem","complexItemType":"survey","TransectStyleComplexItem":{{"Items":[{SIMPLE},{SIMPLE}]}}}}"#
    );
    let jump = r#"{"type":"SimpleItem","command":177,"frame":2,"doJumpId":9,"params":[9,1,null,null,null,null,null]}"#;
    let document = plan::read(&plan_of(&format!("{survey},{jump}"))).expect("readable");
    assert_eq!(document.items.len(), 3);
    assert!(document.items[0].params[3].is_nan());
    assert_eq!(document.items[2].params[0], 3.0);
}

#[test]
fn what_a_plan_cannot_say_is_refused_with_the_item() {
    let refused = |items: &str| {
        plan::read(&plan_of(items))
            .expect_err("refused")
            .to_string()
    };
    let scan = r#"{"type":"ComplexItem","complexItemType":"StructureScan"}"#;
    let told = refused(&format!("{SIMPLE},{scan}"));
    assert!(
        told.starts_with("mission.items[1].complexItemType"),
        "{told}"
    );
    let waiting = SIMPLE
        .replace("8.55,50]", "8.55,null]")
        .replace("\"AltitudeMode\":1", "\"AltitudeMode\":3");
    assert!(refused(&waiting).contains("computed from terrain"));
    let wrong = SIMPLE.replace("\"AltitudeMode\":1", "\"AltitudeMode\":2");
    assert!(refused(&wrong).contains("reference of the item's frame"));
    // QGroundControl shows the mode and sends the frame, so that people and vehicle differ.
    let sea = SIMPLE.replace("\"frame\":3", "\"frame\":0");
    assert!(refused(&sea).contains("reference of the item's frame"));
    // What it computes from terrain is above the sea.
    let computed = SIMPLE.replace("\"AltitudeMode\":1", "\"AltitudeMode\":3");
    assert!(refused(&computed).contains("reference of the item's frame"));
    let computed = computed.replace("\"frame\":3", "\"frame\":0");
    assert!(plan::read(&plan_of(&computed)).is_ok());
    assert!(refused(&SIMPLE.replace("null,47.4", "47.4")).contains("a list of 7 numbers"));
    let jump =
        r#"{"type":"SimpleItem","command":177,"frame":2,"doJumpId":1,"params":[5,1,0,0,0,0,0]}"#;
    assert!(refused(jump).contains("a doJumpId of the file"));
    let differs = SIMPLE.replace("\"Altitude\":50", "\"Altitude\":70");
    let document = plan::read(&plan_of(&differs)).expect("readable");
    assert_eq!(document.repairs.len(), 1);
    let error = plan::read("{\n  \"fileType\": oops")
        .expect_err("no JSON")
        .to_string();
    assert!(error.starts_with("line 2, column"), "{error}");
    assert!(plan::read("[1, 2]").is_err());
}

fn whole_float() -> impl Strategy<Value = f32> {
    any::<u32>()
        .prop_map(f32::from_bits)
        .prop_filter("finite", |value| value.is_finite())
}

fn any_item() -> impl Strategy<Value = Item> {
    (
        prop::sample::select(vec![16_u16, 17, 19, 20, 21, 22, 93, 178]),
        prop::sample::select(vec![0_u8, 2, 3, 5, 6, 10, 11]),
        any::<bool>(),
        prop::array::uniform4(whole_float()),
        -900_000_000..=900_000_000_i32,
        -1_800_000_000..=1_800_000_000_i32,
        whole_float(),
    )
        .prop_map(|(command, frame, autocontinue, params, x, y, z)| Item {
            command,
            frame,
            autocontinue,
            params,
            x,
            y,
            z,
        })
}

#[test]
fn a_plan_for_another_kind_of_vehicle_or_autopilot_is_read_and_says_so() {
    let text = plan::write(&example(Autopilot::Px4));
    let repairs = |text: &str| {
        let repairs = plan::read(text).expect("a plan").repairs;
        repairs.into_iter().map(|repair| repair.what).collect()
    };
    let none: Vec<String> = repairs(&text);
    assert_eq!(none, [""; 0]);
    let rover = text.replace("\"vehicleType\": 2", "\"vehicleType\": 10");
    let told: Vec<String> = repairs(&rover);
    assert!(told.len() == 1 && told[0].contains("10 is no multicopter"));
    let plane = text.replace("\"vehicleType\": 2", "\"vehicleType\": 1");
    let plane = plan::read(&plane).expect("a plan");
    let mission = plane.into_mission(Autopilot::Px4, Airframe::Copter);
    let notes = mission.expect("a mission").notes;
    assert_eq!(
        notes,
        ["the file is for a plane: read as a mission of a copter"]
    );
    let other = text.replace("\"firmwareType\": 12", "\"firmwareType\": 0");
    let told: Vec<String> = repairs(&other);
    assert!(told.len() == 1 && told[0].contains("0 is neither"));
}

fn any_mission() -> impl Strategy<Value = VehicleMission> {
    (
        prop::sample::select(vec![Autopilot::ArduPilot, Autopilot::Px4]),
        prop::collection::vec(any_item(), 0..20),
        (1..=900_000_000_i32, any::<i32>(), whole_float()),
        prop::collection::vec(
            (-900_000_000..=900_000_000_i32, any::<i32>(), whole_float()),
            0..5,
        ),
    )
        .prop_map(
            |(autopilot, items, (x, y, amsl_m), places)| VehicleMission {
                items,
                home: Home { x, y, amsl_m },
                fence: places
                    .iter()
                    .map(|&(x, y, radius)| corner(5003, radius, x, y))
                    .collect(),
                rally: places.iter().map(|&(x, y, z)| rally(x, y, z)).collect(),
                ..example(autopilot)
            },
        )
}

proptest! {
    #[test]
    fn waypoints_come_back_exactly(mission in any_mission()) {
        let text = waypoints::write(&mission);
        let document = waypoints::read(&text).expect("our own file");
        let expected = Document {
            home: Some(mission.home),
            items: mission.items.clone(),
            ..Document::default()
        };
        prop_assert_eq!(document, expected);
        prop_assert!(!text.contains(['e', 'N', ',']));
    }

    #[test]
    fn plans_come_back_exactly(mission in any_mission(), open in 0..4_usize) {
        let mut mission = mission;
        for item in &mut mission.items {
            item.params[open] = f32::NAN;
        }
        let document = plan::read(&plan::write(&mission)).expect("our own file");
        let autopilot = mission.autopilot;
        prop_assert_eq!(document.into_mission(autopilot, Airframe::Copter), Ok(mission));
    }

    #[test]
    fn a_damaged_plan_never_panics(mission in any_mission(), at in any::<prop::sample::Index>(), byte in any::<u8>()) {
        let mut bytes = plan::write(&mission).into_bytes();
        let index = at.index(bytes.len());
        bytes[index] = byte;
        let _ = plan::read(&String::from_utf8_lossy(&bytes));
    }
}
