//! What a fleet does at an alarm in flight: the keys, which are the checked values too.

use std::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::words;

/// What an alarm in flight is about.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "lowercase")]
pub enum AlarmKind {
    /// Two vehicles are too near, or will be.
    Separation,
    /// Too low over the ground.
    Clearance,
    /// Inside a threat or a closed zone.
    Threat,
    /// Outside of the tube around the plan that was verified.
    Corridor,
    /// No position, one that stands still or jumps, no position fix, or the GPS is not reported any more.
    Position,
    /// The battery is below its reserve, or is not reported any more.
    Battery,
    /// The position estimate of the autopilot is bad, or is not reported any more.
    Ekf,
    /// A text of critical severity.
    Text,
    /// The fence on board is breached.
    Fence,
    /// The mission on board is another one, or the vehicle skips items of it.
    Mission,
    /// The flight mode is another one, and nobody here ordered it.
    Mode,
    /// Nothing is heard of the vehicle.
    Link,
    /// Later than the verdict assumed, or taken off earlier.
    Late,
}

/// What is done at each alarm; absent: the fleet continues.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct OnAlarm {
    /// Two vehicles are nearer than the separation, or will be by what they fly.
    pub separation: Option<Answer>,
    /// Lower over the ground than the area allows.
    pub clearance: Option<Answer>,
    /// Inside a threat, one that came up in flight too, or a closed zone.
    pub threat: Option<Answer>,
    /// Outside of the tube around the plan that was verified.
    pub corridor: Option<Answer>,
    /// No position, one that stands still or jumps, no position fix, or the GPS is not reported any more.
    pub position: Option<Answer>,
    /// The battery is below its reserve, or is not reported any more.
    pub battery: Option<Answer>,
    /// The position estimate of the autopilot is bad, or is not reported any more.
    pub ekf: Option<Answer>,
    /// A text of critical severity.
    pub text: Option<Answer>,
    /// The fence on board is breached.
    pub fence: Option<Answer>,
    /// The mission on board is another one, or the vehicle skips items of it.
    pub mission: Option<Answer>,
    /// The flight mode is another one, and nobody here ordered it.
    pub mode: Option<Answer>,
    /// Nothing is heard of the vehicle; `on_link_loss` is another word for it.
    pub link: Option<Answer>,
    /// Later than the verdict assumed, or taken off earlier.
    pub late: Option<Answer>,
}

/// Who does what at an alarm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Answer {
    /// Who does it: the vehicle of the alarm (of a separation both), the others, or all.
    #[serde(default)]
    pub who: Who,
    /// What is done. A wing holds on a circle that is judged first; a return is flown only where
    /// it is verified at that moment.
    #[serde(rename = "do")]
    pub action: Action,
}

/// Who acts at an alarm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
#[schemars(transform = words)]
pub enum Who {
    /// The vehicle of the alarm.
    #[default]
    Vehicle,
    /// All but the vehicle of the alarm.
    Others,
    /// All.
    All,
}

/// What is done at an alarm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
#[schemars(transform = words)]
pub enum Action {
    /// Nothing.
    #[default]
    Continue,
    /// Stays where it is; a wing circles there.
    Hold,
    /// Lands where it is.
    Land,
    /// Returns to launch.
    Return,
}

impl AlarmKind {
    /// Its key in `on_alarm`.
    #[must_use]
    pub fn key(self) -> &'static str {
        match self {
            Self::Separation => "separation",
            Self::Clearance => "clearance",
            Self::Threat => "threat",
            Self::Corridor => "corridor",
            Self::Position => "position",
            Self::Battery => "battery",
            Self::Ekf => "ekf",
            Self::Text => "text",
            Self::Fence => "fence",
            Self::Mission => "mission",
            Self::Mode => "mode",
            Self::Link => "link",
            Self::Late => "late",
        }
    }
}

impl fmt::Display for AlarmKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.key())
    }
}

impl OnAlarm {
    /// What is done at an alarm.
    #[must_use]
    pub fn answer(&self, kind: AlarmKind) -> Answer {
        let of = self.answers().find(|(of, _)| *of == kind);
        of.map(|(_, answer)| answer).unwrap_or_default()
    }

    /// Every answer that is given, with its key.
    pub fn answers(&self) -> impl Iterator<Item = (AlarmKind, Answer)> {
        let kinds = [
            (AlarmKind::Separation, self.separation),
            (AlarmKind::Clearance, self.clearance),
            (AlarmKind::Threat, self.threat),
            (AlarmKind::Corridor, self.corridor),
            (AlarmKind::Position, self.position),
            (AlarmKind::Battery, self.battery),
            (AlarmKind::Ekf, self.ekf),
            (AlarmKind::Text, self.text),
            (AlarmKind::Fence, self.fence),
            (AlarmKind::Mission, self.mission),
            (AlarmKind::Mode, self.mode),
            (AlarmKind::Link, self.link),
            (AlarmKind::Late, self.late),
        ];
        let given = |(kind, answer): (AlarmKind, Option<Answer>)| Some((kind, answer?));
        kinds.into_iter().filter_map(given)
    }
}
