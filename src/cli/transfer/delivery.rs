//! What came of a transfer: the table, the sentences, the record.

use std::path::Path;

use serde_json::{Value, json};

use crate::cli::folder::replace;
use crate::cli::folder::runs;
use crate::cli::print::console::{Paint, out};
use crate::cli::print::failure::Failure;
use crate::cli::print::table::Rows;
use crate::flight::unix_ms;
use crate::link::{TransferReport, Verdict};

/// What came of a transfer to a fleet.
pub(crate) struct Delivery {
    pub(crate) reports: Vec<TransferReport>,
}

/// `on board` as one word and the figures behind it.
pub(crate) fn state(report: &TransferReport) -> String {
    match &report.verdict {
        Verdict::Verified => format!("verified, {:.1} s", report.seconds),
        Verdict::Failed(_) => "FAILED".to_owned(),
        Verdict::Refused(_) => "refused".to_owned(),
    }
}

/// What came of one transfer, in words.
pub(crate) fn sentence(report: &TransferReport) -> String {
    let why = match &report.verdict {
        Verdict::Verified => "holds exactly its mission".to_owned(),
        Verdict::Failed(failure) => failure.to_string(),
        Verdict::Refused(refusal) => format!("refused: {refusal} (--force overrides)"),
    };
    let mut text = format!("{}: {why}", report.vehicle);
    for difference in report.differences.iter().take(5) {
        text += &format!("\n  {difference}");
    }
    for said in &report.statustexts {
        text += &format!("\n  the vehicle says: {said}");
    }
    text
}

pub(crate) fn report_text(document: &Value) -> String {
    crate::report::json_text(document)
}

impl Delivery {
    /// The document of a transfer that never began.
    pub(crate) fn nothing(reason: &str) -> Value {
        json!({
            "sortie": env!("CARGO_PKG_VERSION"),
            "verdict": "refused",
            "reason": reason,
            "vehicles": [],
        })
    }

    pub(crate) fn json(&self) -> Value {
        let vehicles: Vec<Value> = self
            .reports
            .iter()
            .map(|report| {
                let (verdict, reason) = match &report.verdict {
                    Verdict::Verified => ("verified", None),
                    Verdict::Failed(failure) => ("failed", Some(failure.to_string())),
                    Verdict::Refused(refusal) => ("refused", Some(refusal.to_string())),
                };
                json!({
                    "vehicle": report.vehicle,
                    "sysid": report.sysid,
                    "autopilot": report.autopilot,
                    "version": report.version,
                    "items": report.items,
                    "fence": report.fence,
                    "rally": report.rally,
                    "attempts": report.attempts,
                    "retries": report.retries,
                    "seconds": report.seconds,
                    "hash": report.hash,
                    "plan_ids": report.plan_ids,
                    "verdict": verdict,
                    "reason": reason,
                    "differences": report.differences.iter().map(ToString::to_string).collect::<Vec<_>>(),
                    "statustexts": report.statustexts,
                })
            })
            .collect();
        let verdict = if self.is_verified() {
            "verified"
        } else {
            "failed"
        };
        json!({"sortie": env!("CARGO_PKG_VERSION"), "verdict": verdict, "vehicles": vehicles})
    }

    fn is_verified(&self) -> bool {
        !self.reports.is_empty() && self.reports.iter().all(TransferReport::is_verified)
    }

    /// Writes the record to `DIR.runs/`, under its time and as the newest.
    pub(crate) fn record(&self, target: &Path) -> Result<(), Failure> {
        let text = report_text(&self.json());
        let folder = runs::folder(target);
        replace::write_file(&runs::named(&folder, "upload", "json"), text.as_bytes())?;
        replace::write_file(&folder.join("upload.json"), text.as_bytes())?;
        Ok(())
    }

    pub(crate) fn tell(&self) -> Result<(), Failure> {
        let paint = Paint::for_stdout();
        let mut rows = Rows::new(&[
            "vehicle",
            "system",
            "says it is",
            "items",
            "fence",
            "rally",
            "on board",
            "hash",
        ]);
        rows.spare(&["hash", "system", "rally", "fence"]);
        for report in &self.reports {
            rows.add([
                report.vehicle.clone(),
                report.sysid.to_string(),
                format!("{} {}", report.autopilot, report.version)
                    .trim()
                    .to_owned(),
                report.items.to_string(),
                report.fence.to_string(),
                report.rally.to_string(),
                state(report),
                report.hash.chars().take(12).collect(),
            ]);
        }
        out(&rows.to_string())?;
        for report in self.reports.iter().filter(|report| !report.is_verified()) {
            out(&format!("{} {}", paint.bad("FAIL"), sentence(report)))?;
        }
        Ok(())
    }

    pub(crate) fn verdict(&self) -> Result<(), Failure> {
        if self.is_verified() {
            return Ok(());
        }
        let failed = self
            .reports
            .iter()
            .filter(|report| !report.is_verified())
            .count();
        let message = format!(
            "{failed} of {} vehicles do not hold their mission for certain",
            self.reports.len()
        );
        Err(Failure::new(Failure::TRANSFER, message))
    }
}

pub(crate) fn seconds_since_1970() -> u64 {
    unix_ms() / 1000
}
