//! Vehicles in a compact form, as YAML and a table have them.

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use super::{Place, Vehicle};

/// Vehicles in a compact form. They come after those of `vehicles` in priority, in the order
/// of the table or of the grid. Their starts and goals are in `csv`, in grids or in `defaults`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Fleet {
    /// Their names, such as d{n:03}: {n} is the number of the vehicle in the fleet, from 1;
    /// {n:03} the same in three digits. Absent: from the column id of the table.
    #[schemars(length(min = 1, max = 64))]
    pub id: Option<String>,
    /// System id of the first one; the others count on, past those of `vehicles`, and after 240
    /// begin again at 1. Absent: 1.
    #[schemars(range(min = 1, max = 240))]
    pub first_sysid: Option<i64>,
    /// Each takes off this much later than the one before, seconds; absent: 0.
    #[schemars(range(min = 0, max = 86400))]
    pub depart_every_s: Option<f64>,
    /// What they have in common: any key of a vehicle but id and sysid. In link, {n} is the
    /// number of the vehicle; {14550+n} and {5750+10*n} count on. depart_s is the takeoff of the
    /// first one; in a table, of that vehicle. start and goal hold what grids or a table do not.
    #[serde(default)]
    #[schemars(schema_with = "part_of_vehicle")]
    pub defaults: Vehicle,
    /// Where they start.
    pub start_grid: Option<Grid>,
    /// Where they go: the first of this grid is the goal of the first of the other.
    pub goal_grid: Option<Grid>,
    /// A table, one row for each vehicle, its path relative to this file. Its columns are named by the
    /// keys of a vehicle, with _ for the dot: id, start_lat, start_lon, goal_agl_m, speed_mps.
    /// An empty cell means the default.
    pub csv: Option<String>,
}

/// Positions in rows from west to east, the rows from south to north.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Grid {
    /// The first position.
    pub south_west: Place,
    /// Number of rows.
    #[schemars(range(min = 1, max = 10000))]
    pub rows: u64,
    /// Positions in each row.
    #[schemars(range(min = 1, max = 10000))]
    pub columns: u64,
    /// Distance between neighbours, metres.
    #[schemars(range(min = 0.1, max = 100_000))]
    pub spacing_m: f64,
}

/// The schema of a [`Vehicle`] without `id` and `sysid`, and without required keys.
fn part_of_vehicle(generator: &mut SchemaGenerator) -> Schema {
    let mut schema = Vehicle::json_schema(generator);
    let object = schema.ensure_object();
    make_optional(object);
    if let Some(Value::Object(keys)) = object.get_mut("properties") {
        keys.retain(|key, _| key != "id" && key != "sysid");
        for property in keys.values_mut() {
            refer_to_part(property, generator.definitions_mut());
        }
    }
    schema
}

fn make_optional(object: &mut Map<String, Value>) {
    for word in ["required", "minProperties", "maxProperties"] {
        object.remove(word);
    }
}

/// Points a property at a definition `PartOf...` whose keys are all optional, where that differs.
fn refer_to_part(property: &mut Value, definitions: &mut Map<String, Value>) {
    let target = match property.pointer("/anyOf/0/$ref") {
        Some(_) => property.pointer_mut("/anyOf/0/$ref"),
        None => property.pointer_mut("/$ref"),
    };
    let Some(target) = target else { return };
    let name = target.as_str().and_then(|text| text.rsplit('/').next());
    let Some(name) = name.map(str::to_owned) else {
        return;
    };
    if let Some(Value::Object(whole)) = definitions.get(&name)
        && whole.contains_key("required")
    {
        let mut part = whole.clone();
        make_optional(&mut part);
        let name = format!("PartOf{name}");
        *target = json!(format!("#/$defs/{name}"));
        definitions.insert(name, Value::Object(part));
    }
}
