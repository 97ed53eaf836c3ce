//! Files that hold a mission alone: the `.mission` that QGroundControl wrote before `.plan`, in two forms.

use serde_json::Value;

use super::node::Node;
use crate::formats::FormatError;

/// How a form of the file names things.
pub(super) struct Form {
    /// The key with the autopilot.
    pub(super) firmware: &'static str,
    /// The key with the number of an item that jumps name.
    pub(super) id: &'static str,
    /// What a jump may name, as a text.
    pub(super) target: &'static str,
    /// The types of items that are not complex.
    pub(super) simple: &'static [&'static str],
    /// All types, as a text.
    pub(super) types: &'static str,
    is_home_an_item: bool,
}

impl Form {
    /// That of a `.plan`, and of a `.mission` of version 2.
    pub(super) const PLAN: Self = Self {
        firmware: "firmwareType",
        id: "doJumpId",
        target: "a doJumpId of the file",
        simple: &["SimpleItem"],
        types: "SimpleItem or ComplexItem",
        is_home_an_item: false,
    };
    /// That of a `.mission` of version "1.0".
    const FIRST: Self = Self {
        firmware: "MAV_AUTOPILOT",
        id: "id",
        target: "an id of the file",
        simple: &["missionItem"],
        types: "missionItem",
        is_home_an_item: true,
    };

    /// The position of home.
    pub(super) fn home<'a>(&self, root: &Node<'a>) -> Node<'a> {
        let home = root.get("plannedHomePosition");
        if self.is_home_an_item {
            home.get("coordinate")
        } else {
            home
        }
    }
}

/// Whether a JSON document is such a file: its items are not in a part of their own.
pub(super) fn is_one(root: &Value) -> bool {
    let kind = &root["fileType"];
    (kind.is_null() || kind == "Mission") && root["items"].is_array()
}

/// The form of such a file.
///
/// # Errors
/// Another version, and complex items of the first one: what they fly is not in the file.
pub(super) fn form(root: &Node<'_>) -> Result<Form, FormatError> {
    let version = root.get("version");
    match version.value {
        Value::String(text) if text == "1.0" => {
            let complex = root.get("complexItems");
            if !complex.list()?.is_empty() {
                return Err(complex.bad("none: what they fly is not in the file"));
            }
            Ok(Form::FIRST)
        }
        value if value == 2 => Ok(Form::PLAN),
        _ => Err(version.bad("\"1.0\" or 2")),
    }
}

/// The seven numbers of an item: in one list; or four, and a `coordinate` with the others, the four in
/// a list or each with a key (`MissionItem::_convertJsonV1ToV2`, `_convertJsonV2ToV3`).
pub(super) fn numbers<'a>(node: &Node<'a>) -> Result<[Node<'a>; 7], FormatError> {
    let params = node.get("params");
    let mut numbers = if params.value.is_null() {
        ["param1", "param2", "param3", "param4"]
            .map(|key| node.get(key))
            .to_vec()
    } else {
        params.list()?
    };
    if numbers.len() == 4 {
        numbers.extend(node.get("coordinate").list()?);
    }
    let allowed = "a list of 7 numbers, or 4 and a coordinate";
    numbers.try_into().map_err(|_| params.bad(allowed))
}
