//! `upload.json`: what each vehicle of a fleet holds after a transfer.

use schemars::JsonSchema;
use serde::Serialize;

/// How a transfer to a fleet ended: `upload.json`.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct UploadDocument {
    /// Version of Sortie.
    pub sortie: &'static str,
    /// `verified` where every vehicle holds exactly its mission, `failed`, `refused` where the missions do not pass, or
    /// `not sent` where nothing was to be sent.
    pub verdict: &'static str,
    /// Why nothing was sent; absent where something was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// One for each vehicle; with `--dry-run` what would be sent.
    pub vehicles: Vec<UploadedVehicle>,
}

/// One vehicle of `upload.json`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct UploadedVehicle {
    /// Id in the spec.
    pub vehicle: String,
    /// MAVLink system id.
    pub sysid: u8,
    /// Autopilot and type from its heartbeat; empty where it was not heard.
    pub autopilot: String,
    /// Version of its software as it says; empty if unknown.
    pub version: String,
    /// Mission items read back, without home; with `--dry-run` those that would be sent.
    pub items: usize,
    /// Fence items, likewise.
    pub fence: usize,
    /// Rally points, likewise.
    pub rally: usize,
    /// How often a list was sent from its beginning.
    pub attempts: u32,
    /// Messages that had to be repeated.
    pub retries: u32,
    /// From the first heartbeat sent to the verdict.
    pub seconds: f64,
    /// SHA-256 over the items held; empty unless verified.
    pub hash: String,
    /// How far the vehicle stands from the home of its mission, metres; null if it did not say.
    pub from_home_m: Option<f64>,
    /// The vehicle's own ids of mission, fence and rally; 0 where it has none.
    pub plan_ids: [u32; 3],
    /// `verified`, `failed`, `refused` or `not sent`.
    pub verdict: &'static str,
    /// Why it is not verified.
    pub reason: Option<String>,
    /// Every difference between the items sent and read back.
    pub differences: Vec<String>,
    /// Texts of the vehicle during the transfer.
    pub statustexts: Vec<String>,
}

impl UploadDocument {
    /// Of a transfer that never began, with the verdict `refused` or `not sent`.
    #[must_use]
    pub fn not_begun(verdict: &'static str, reason: &str, vehicles: Vec<UploadedVehicle>) -> Self {
        Self {
            sortie: env!("CARGO_PKG_VERSION"),
            verdict,
            reason: Some(reason.to_owned()),
            vehicles,
        }
    }
}
