//! `plan.json` and `review.json`.

use sortie::report::{json_text, plan_json, review_json};
use sortie::verify::Review;

use crate::facts::{IDS, facts, hilly_spec};

#[test]
fn plan_json_has_the_keys_of_the_contract() {
    let facts = facts(hilly_spec(IDS));
    let text = json_text(&plan_json(
        "ab12",
        &facts.spec,
        &facts.world,
        &facts.plan,
        false,
    ));
    assert!(text.ends_with("}\n") && text.starts_with("{\n  \"sortie\": "));
    let document: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(
        keys(&document),
        [
            "sortie",
            "spec_sha256",
            "seed",
            "verdict",
            "fleet",
            "vehicles"
        ]
        .sorted()
    );
    assert_eq!(document["verdict"], "fail");
    assert_eq!(document["seed"], 7);
    let vehicle = &document["vehicles"][1];
    let expected = [
        "id",
        "sysid",
        "depart_s",
        "speed_mps",
        "cost",
        "bound",
        "estimate",
        "gap",
        "evaluations",
        "endurance",
        "tasks",
        "plans",
        "control_points",
        "path",
    ];
    assert_eq!(keys(vehicle), expected.sorted());
    let terms = [
        "total",
        "length",
        "altitude",
        "threat",
        "terrain",
        "turn",
        "climb",
        "collision",
    ];
    assert_eq!(keys(&vehicle["cost"]), terms.sorted());
    assert_eq!(vehicle["id"], "bravo");
    let point = &vehicle["path"][300];
    assert_eq!(
        keys(point),
        ["lat_deg", "lon_deg", "amsl_m", "t_s"].sorted()
    );
    let lat_deg = point["lat_deg"].as_f64().expect("a number");
    assert!((lat_deg - 36.23).abs() < 1e-8, "{lat_deg}");
    assert_eq!(
        keys(&vehicle["control_points"][0]),
        ["lat_deg", "lon_deg", "amsl_m"].sorted()
    );
}

#[test]
fn review_json_has_the_keys_of_the_contract_and_null_for_what_is_not_known() {
    let mut facts = facts(hilly_spec(IDS));
    facts.review.margins[3].value = f64::NAN;
    facts.review.margins[3].ok = false;
    let text = json_text(&review_json(&facts.review, Some(7)));
    let document: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(
        keys(&document),
        ["verdict", "seed", "margins", "assumptions"].sorted()
    );
    let margin = &document["margins"][0];
    let expected = [
        "vehicle", "other", "what", "value", "limit", "unit", "at", "ok",
    ];
    assert_eq!(keys(margin), expected.sorted());
    assert_eq!(
        keys(&margin["at"]),
        ["lat_deg", "lon_deg", "amsl_m", "t_s", "item"].sorted()
    );
    assert!(margin["other"].is_null());
    assert!(document["margins"][3]["value"].is_null());
    assert_eq!(document["margins"][3]["ok"], false);
    let pair = document["margins"]
        .as_array()
        .and_then(|all| all.last())
        .expect("margins");
    assert_eq!(
        (&pair["vehicle"], &pair["other"]),
        (&"bravo".into(), &"charlie".into())
    );
    assert_eq!(pair["note"], "worst shift of departure: 5 s");
    assert!(document["margins"][6]["at"].is_object() || document["margins"][7]["at"].is_null());
}

#[test]
fn an_empty_review_is_no_pass() {
    let review = Review::default();
    assert_eq!(review_json(&review, None).verdict, "fail");
    let mut facts = facts(hilly_spec(IDS));
    facts.review = review;
    assert!(facts.html().contains("Nothing could be judged"));
}

#[test]
fn the_same_facts_give_the_same_bytes() {
    let (one, two) = (facts(hilly_spec(IDS)), facts(hilly_spec(IDS)));
    assert_eq!(one.html(), two.html());
    assert_eq!(one.svg(), two.svg());
    assert_eq!(
        json_text(&plan_json("", &one.spec, &one.world, &one.plan, true)),
        json_text(&plan_json("", &two.spec, &two.world, &two.plan, true))
    );
}

/// Keys of an object, sorted: `serde_json::Value` does not keep their order.
fn keys(value: &serde_json::Value) -> Vec<String> {
    value
        .as_object()
        .expect("an object")
        .keys()
        .cloned()
        .collect()
}

trait Sorted {
    fn sorted(self) -> Vec<String>;
}

impl<const N: usize> Sorted for [&str; N] {
    fn sorted(mut self) -> Vec<String> {
        self.sort_unstable();
        self.map(str::to_owned).to_vec()
    }
}

#[test]
fn the_tables_of_readme_and_guide_are_those_of_the_autopilot_module() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    for (file, table) in [
        ("README.md", sortie::autopilot::support_table()),
        (
            "src/guide/flight_model.md",
            sortie::autopilot::behaviour_table(),
        ),
    ] {
        let text = std::fs::read_to_string(root.join(file)).unwrap();
        assert!(
            text.contains(&table),
            "{file} must contain this table:\n{table}"
        );
    }
}
